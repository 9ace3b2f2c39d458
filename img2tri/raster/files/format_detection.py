"""A file -> the values in it, what was noted while reading, and the size of a pixel in millimetres if the file says it.

The format is told by the first bytes, or else by the suffix. Pillow decodes all common formats: it keeps palette indices and bit depth,
reports truncated files and knows EXIF. Others have decoders of their own.
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from pathlib import Path

from PIL import Image, UnidentifiedImageError

from img2tri.errors import FileError, ImageError, Img2triError
from img2tri.raster.files.byte_sources import GZIP, Source
from img2tri.raster.files.decoded_image import DecodedImage
from img2tri.raster.files.dicom import decode_dicom
from img2tri.raster.files.hdf5_zarr import HDF5_START, decode_hdf5, decode_zarr
from img2tri.raster.files.nifti import decode_nifti
from img2tri.raster.files.npy_npz import NPY_START, ZIP_START, decode_npy, decode_npz
from img2tri.raster.files.nrrd_metaimage import METAIMAGE_STARTS, NRRD_START, decode_metaimage, decode_nrrd
from img2tri.raster.files.pillow_images import decode_with_pillow, pillow_reads_tiff
from img2tri.raster.files.tiff import decode_tiff

STARTS = {
    "TIFF": (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"), "NPY": (NPY_START,), "NPZ": (ZIP_START,), "NRRD": (NRRD_START,),
    "MetaImage": METAIMAGE_STARTS, "HDF5": (HDF5_START,),
}  # fmt: skip
MEDICAL_SUFFIXES = {".dcm": "DICOM", ".dicom": "DICOM", ".nii": "NIfTI", ".nii.gz": "NIfTI"}
DECODERS = {
    "DICOM": decode_dicom, "NIfTI": decode_nifti, "NPY": decode_npy, "NPZ": decode_npz, "NRRD": decode_nrrd, "MetaImage": decode_metaimage,
    "HDF5": decode_hdf5,
}  # fmt: skip
NIFTI_START = 348
FIRST_BYTES = 1024  # that tell all formats apart, also a NIfTI file that is compressed


def decode(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one image of a file.

    Parameters
    ----------
    source
        The file.
    page
        Which image, frame or slice of a file with several, from 0.
    max_pixels
        Refuse an image with more.

    Returns
    -------
    DecodedImage
        For the notes see `reading.read`.

    Raises
    ------
    FileError
        If the file is missing, a folder, not an image, damaged or truncated; if a library it needs is.
    ImageError
        If it has more than `max_pixels`.
    ParameterError
        If it has no such page.
    """
    if source.path is not None and _is_zarr(source.path):
        return decode_zarr(source, page, max_pixels)
    start = source.start(FIRST_BYTES)
    try:
        kind = _known_start(source, start)
        if kind in DECODERS:
            return DECODERS[kind](source, page, max_pixels)
        if kind == "TIFF" and not pillow_reads_tiff(source, page):
            return decode_tiff(source, page, max_pixels)
        return decode_with_pillow(source, start, page, max_pixels)
    except Img2triError:
        raise
    except MemoryError as error:
        # Often only because of a length somewhere in a damaged file.
        raise FileError(f"image: {str(source)!r} is damaged, or needs more memory than there is") from error
    except UnidentifiedImageError as error:
        raise FileError(f"image: {str(source)!r} is not an image in a known format") from error
    except Image.DecompressionBombError as error:
        # The file holds a larger image than its header claims.
        raise ImageError(f"image: expected at most max_pixels={max_pixels} pixels, found more in {str(source)!r} ({error})") from error
    except Exception as error:
        # Decoders meet damaged data with errors of every type.
        raise FileError(f"image: {str(source)!r} is damaged or truncated ({error})") from error


def _known_start(source: Source, start: bytes) -> str | None:
    """Tell a format that is not for Pillow by its content, or by its suffix where that says nothing."""
    for kind, begins in STARTS.items():
        if start.startswith(begins):
            return kind
    if start[:3] == b"CDF":
        raise FileError(f"image: {str(source)!r} is netCDF 3; open it with xarray, and give the DataArray")
    if start[128:132] == b"DICM":
        return "DICOM"
    if start[:2] == GZIP:
        with suppress(zlib.error):
            start = zlib.decompressobj(wbits=zlib.MAX_WBITS | 16).decompress(start, NIFTI_START)
    if start[344:348] == b"n+1\0" or start[4:8] == b"n+2\0":
        return "NIfTI"
    return next((kind for suffix, kind in MEDICAL_SUFFIXES.items() if str(source).lower().endswith(suffix)), None)


def _is_zarr(path: Path) -> bool:
    """Tell whether a folder is a zarr store, or an array in one."""
    try:
        return path.is_dir() and any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))
    except (OSError, ValueError):
        return False
