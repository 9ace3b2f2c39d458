"""HDF5 (netCDF 4 too) and zarr -> one plane of one array in them, named after the file: ``file.h5:/path``, ``store.zarr:/path``.

h5py and zarr read them; they come with extras of img2tri. A file with one array needs no name. Only the plane asked for is read.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page
from img2tri.raster.files.volumes import planes_of

HDF5_START = b"\x89HDF\r\n\x1a\n"
MOST_LISTED = 20


def decode_hdf5(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one plane of an array in an HDF5 file; pages run along the first axes."""
    try:
        import h5py
    except ImportError as error:
        raise FileError(f"image: {str(source)!r} is HDF5, which h5py reads; install it with  pip install 'img2tri[hdf5]'") from error
    with source.open() as raw, h5py.File(raw, "r") as file:
        arrays: list[str] = []
        file.visititems(lambda name, node: arrays.append(name) if isinstance(node, h5py.Dataset) and node.ndim > 1 else None)
        return _decode(source, arrays, lambda name: file[name], page, max_pixels, "HDF5")


def decode_zarr(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one plane of an array in a zarr store, a folder; pages run along the first axes."""
    try:
        import zarr
    except ImportError as error:
        raise FileError(f"image: {str(source)!r} is zarr, which zarr reads; install it with  pip install 'img2tri[zarr]'") from error
    node: Any = zarr.open(str(source.path), mode="r")
    if not hasattr(node, "members"):
        return _decode(source, [""], lambda _: node, page, max_pixels, "zarr")
    arrays = [name for name, member in node.members(max_depth=None) if getattr(member, "ndim", 0) > 1]
    return _decode(source, arrays, lambda name: node[name], page, max_pixels, "zarr")


def _decode(source: Source, arrays: list[str], opened: Callable[[str], Any], page: int, max_pixels: int, kind: str) -> DecodedImage:
    wanted = source.inner.strip("/") if source.inner else arrays[0] if len(arrays) == 1 else None
    if wanted not in arrays:
        listed = ", ".join(f"/{name}" for name in sorted(arrays)[:MOST_LISTED]) or "no array of two axes"
        raise FileError(f"image: expected the name of an array, as in '{source.name}:/NAME'; it has {listed}")
    array = opened(wanted)
    if array.dtype.kind not in "buif":
        raise ImageError(f"image: expected an array of bool, integer or floating point values, found an array of type {array.dtype}")
    planes = planes_of(tuple(array.shape), source)
    notes = {"format": kind} | check_page(source, page, planes.pages, planes.width, planes.height, max_pixels)
    # The index of the page along the axes that are kept; those of length one are taken at 0.
    index = iter(planes.index(page))
    kept = [n != 1 for n in array.shape] if len(array.shape) > len(planes.shape) else [True] * len(array.shape)
    at = tuple(0 if not keep else next(index, slice(None)) for keep in kept)
    return DecodedImage(np.asarray(array[at]).reshape(planes.plane), notes)
