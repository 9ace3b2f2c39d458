"""NumPy's own files, .npy and .npz -> values. Nothing in them is run: arrays of Python objects are refused.

The header is read and checked first, so that no more is made room for than one plane. Of a .npz with several arrays one is named,
as in ``labels.npz:/mask``.
"""

from __future__ import annotations

import math
import zipfile
from typing import BinaryIO

from numpy.lib import format as npy

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page
from img2tri.raster.files.volumes import planes_of, read_plane

NPY_START, ZIP_START = b"\x93NUMPY", b"PK\x03\x04"


def decode_npy(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one plane of a .npy file; pages run along the first axes."""
    with source.open() as file:
        return _decode(file, source, page, max_pixels, "NPY")


def decode_npz(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one plane of an array in a .npz file: of the only one, or of the one named."""
    with source.open() as whole, zipfile.ZipFile(whole) as archive:
        names = [name for name in archive.namelist() if name.endswith(".npy")]
        wanted = f"{source.inner.strip('/')}.npy" if source.inner else names[0] if len(names) == 1 else ""
        if wanted not in names:
            listed = ", ".join(name.removesuffix(".npy") for name in names[:20])
            raise FileError(
                f"image: expected the name of an array, as in '{source.name}:/NAME', of {str(source)!r}; it has {listed or 'none'}"
            )
        with archive.open(wanted) as file:
            return _decode(file, source, page, max_pixels, "NPZ")  # type: ignore[arg-type]


def _decode(file: BinaryIO, source: Source, page: int, max_pixels: int, kind: str) -> DecodedImage:
    version = npy.read_magic(file)
    read_header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}.get(version)
    if read_header is None:
        raise FileError(f"image: {str(source)!r} is of version {version} of NumPy's format, for arrays of records")
    shape, by_columns, dtype = read_header(file)
    if dtype.hasobject or dtype.kind not in "buif":
        raise ImageError(f"image: expected an array of bool, integer or floating point values, found an array of type {dtype}")
    planes = planes_of(tuple(reversed(shape)) if by_columns else shape, source)
    if by_columns:
        # Values run along the first axis first; few files are so, and the whole array is turned.
        check_page(source, 0, 1, math.prod(shape), 1, 4 * max_pixels)
        whole = read_plane(file, source, dtype, planes_of((math.prod(shape), 1), source), 0).reshape(shape, order="F")
        planes = planes_of(shape, source)
        values = whole.reshape(planes.shape)[planes.index(min(page, planes.pages - 1))]
    notes = {"format": kind} | check_page(source, page, planes.pages, planes.width, planes.height, max_pixels)
    if not by_columns:
        values = read_plane(file, source, dtype, planes, page)
    return DecodedImage(values, notes)
