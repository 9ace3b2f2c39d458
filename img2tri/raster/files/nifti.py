"""NIfTI, as segmentation programs write it -> values, notes and the size of a pixel in millimetres.

nibabel decodes; it comes with an extra of img2tri and is loaded for such files only. Values are those that were measured: the slope
and intercept in the file are applied.

An array is numbered from the lower left, its first index along x, so it is laid down as it is numbered; a page is one value of k::

    array[i, j, k]      j ^               row 0      array[:, last j, k]
                          |         ->     ...
                          +---> i         last row   array[:, 0, k]

With y up, x grows with i and y with j. In files whose axes run as is usual (RAS, and mirrored LAS) the front of the patient is
up. Nothing is turned by what a file says about the patient: slices, and labels and gray values of one scan, stay congruent, and
each axis keeps the spacing noted for it. Where the axes point is in the notes.
"""

from __future__ import annotations

import gzip
import math
from typing import Any

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import GZIP, Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page, plane_height
from img2tri.raster.metadata.pixel_size import positive_size

MILLIMETRES = {"meter": 1000.0, "micron": 0.001}  # all else, unknown too, is taken as what it nearly always is


def decode_nifti(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one slice of a NIfTI file.

    Parameters
    ----------
    source, page, max_pixels
        See `format_detection.decode`. Pages run through the third axis first, then through the fourth (time) and all others: slice k
        at time t of an array (nx, ny, nz, nt) is page k + nz * t.

    Returns
    -------
    values
        As stored where the slope is 1 and the intercept 0, or none is noted, so that labels stay integers; else float64.
    notes
        "axes", where the axes of the array point, such as "RAS": right, to the front, up.
    size
        (dx, dy) in millimetres, or None.

    Raises
    ------
    FileError
        If nibabel is missing.
    ImageError
        If the array has less than two axes, or no values.
    """
    try:
        import nibabel
    except ImportError as error:
        raise FileError(f"image: {str(source)!r} is NIfTI, which nibabel reads; install it with  pip install 'img2tri[nifti]'") from error
    library: Any = nibabel
    with _unpacked(library, source) as file:
        kind = library.Nifti2Image if file.read(8)[4:7] == b"n+2" else library.Nifti1Image
        file.seek(0)
        noted = kind.header_class.from_fileobj(file, check=False)
    holder = library.FileHolder(str(source.path)) if source.path else library.FileHolder(fileobj=_unpacked(library, source))
    with library.imageglobals.LoggingOutputSuppressor():  # else nibabel tells stderr what it mends, such as sizes of 0
        image = kind.from_file_map({"image": holder, "header": holder})
    shape = tuple(int(n) for n in image.shape)
    if len(shape) < 2 or min(shape) < 1:
        raise ImageError(f"image: expected an array of at least two axes in {str(source)!r}, found shape {shape}")
    width, height, *others = shape
    notes = {"format": "NIfTI"} | check_page(source, page, math.prod(others), width, height, max_pixels)
    notes["axes"] = "".join(code or "?" for code in library.aff2axcodes(image.affine))
    # Only what is asked for is read.
    values = np.asarray(image.dataobj[(slice(None), slice(None), *map(int, np.unravel_index(page, others, order="F")))])
    if values.dtype.names:
        values = np.stack([values[name] for name in values.dtype.names], axis=2)
    scale = MILLIMETRES.get(noted.get_xyzt_units()[0], 1.0)
    # Sizes are kept in 32 bits; the shortest number that is the same there is the one meant: 0.7, not 0.699999988.
    dx, dy, *steps = (scale * abs(float(str(zoom))) for zoom in noted.get_zooms()[:3])
    flat = math.prod(others) == (others or [1])[0]  # no other axis than z
    above = plane_height(page, steps if flat else [])
    return DecodedImage(np.ascontiguousarray(values.swapaxes(0, 1)[::-1]), notes, positive_size(dx, dy), height=above)


def _unpacked(library: Any, source: Source) -> Any:
    """Open a NIfTI file, which may be compressed."""
    if source.path:
        return library.openers.ImageOpener(str(source.path))
    file = source.open()
    return gzip.GzipFile(fileobj=file) if source.data[:2] == GZIP else file
