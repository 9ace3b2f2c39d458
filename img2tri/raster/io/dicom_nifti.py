"""DICOM and NIfTI, as scanners and segmentation programs write them -> values, notes and the size of a pixel in millimetres.

pydicom and nibabel decode; they come with extras of img2tri and are loaded for such files only. Values are those that were
measured, such as Hounsfield units: slope and intercept in the file are applied, windows for display are not.

A DICOM frame is taken as it is displayed, its first row at the top. A NIfTI array is numbered from the lower left, its first
index along x, so it is laid down as it is numbered; a page is one value of k::

    array[i, j, k]      j ^               row 0      array[:, last j, k]
                          |         ->     ...
                          +---> i         last row   array[:, 0, k]

With y up, x grows with i and y with j. In files whose axes run as is usual (RAS, and mirrored LAS) the front of the patient is
up. Nothing is turned by what a file says about the patient: slices, and labels and gray values of one scan, stay congruent, and
each axis keeps the spacing noted for it. Where the axes of a NIfTI file point is in the notes.
"""

from __future__ import annotations

import gzip
import math
from typing import Any

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.io.byte_sources import Source
from img2tri.raster.io.metadata import Size
from img2tri.raster.io.pages import Decoded, check_page
from img2tri.raster.io.pixel_arrays import Pixels

PIXEL_DATA = ("PixelData", "FloatPixelData", "DoubleFloatPixelData")
MILLIMETRES = {"meter": 1000.0, "micron": 0.001}  # all else, unknown too, is taken as what it nearly always is


def decode_dicom(source: Source, page: int, max_pixels: int) -> Decoded:
    """Decode one frame of a DICOM file.

    Parameters
    ----------
    source, page, max_pixels
        See `decoding.decode`; pages are frames.

    Returns
    -------
    values
        As stored where the file has no rescaling, or one of slope 1 and intercept 0; else float64, or the integers of
        its lookup table. Colours are RGB. MONOCHROME1, where low values are shown bright, is not inverted.
    notes
        "photometric", DICOM's word for what values mean; "palette" where they are indices; "spacing_from", the tag the
        size is from. ImagerPixelSpacing is that on the detector, where things look larger than they are.
    size
        (dx, dy) in millimetres, or None.

    Raises
    ------
    FileError
        If pydicom, or what it needs for a compression, is missing; if there is no image in the file.
    """
    try:
        import pydicom.pixels
    except ImportError as error:
        raise FileError(f"image: {str(source)!r} is DICOM, which pydicom reads; install it with  pip install 'img2tri[dicom]'") from error
    library: Any = pydicom
    data = library.dcmread(source.path or source.open(), force=True)
    if "Rows" not in data or "Columns" not in data or not any(name in data for name in PIXEL_DATA):
        raise FileError(f"image: {str(source)!r} is no DICOM file with an image in it, or it is truncated")
    pages = int(data.get("NumberOfFrames") or 1)
    notes = {"format": "DICOM"} | check_page(source, page, pages, data.Columns, data.Rows, max_pixels)
    values = _stored(library, source, data, page, pages)
    notes["photometric"] = str(data.get("PhotometricInterpretation", ""))
    if notes["photometric"] == "PALETTE COLOR":
        notes["palette"] = _palette(library, data, int(values.max()) + 1)
    elif values.ndim == 2:
        values = _measured(library, values, _of_frame(data, page, "PixelValueTransformationSequence"))
    measures = _of_frame(data, page, "PixelMeasuresSequence")
    for tag in ("PixelSpacing", "ImagerPixelSpacing"):
        # The first number is the distance of rows, which lies along y.
        dy, dx = measures.get(tag) or (0, 0)
        size = _size(dx, dy)
        if size is not None:
            return values, notes | {"spacing_from": tag}, size
    return values, notes, None


def _stored(library: Any, source: Source, data: Any, page: int, pages: int) -> Pixels:
    """Return the stored values of a frame."""
    if "TransferSyntaxUID" not in data.file_meta:  # files from before there were headers
        implicit = data.original_encoding[0]
        data.file_meta.TransferSyntaxUID = library.uid.ImplicitVRLittleEndian if implicit else library.uid.ExplicitVRLittleEndian
    decoder = library.pixels.get_decoder(data.file_meta.TransferSyntaxUID)
    if not decoder.is_available:
        needed = "; ".join(decoder.missing_dependencies)
        raise FileError(f"image: {str(source)!r} is compressed ({decoder.UID.name}), for which pydicom needs a plugin: {needed}")
    if data.get("BitsAllocated") == 1 and pages > 1:
        # Frames of a mask packed into bits may begin within a byte, where pydicom (3.0) does not reach them one by one.
        return np.asarray(library.pixels.pixel_array(data)[page])
    return np.asarray(library.pixels.pixel_array(data, index=page))


def _of_frame(data: Any, page: int, name: str) -> Any:
    """Return the data set that describes a frame: files with many frames have them in sequences, for each frame or for all."""
    for groups, index in ((data.get("PerFrameFunctionalGroupsSequence"), page), (data.get("SharedFunctionalGroupsSequence"), 0)):
        found = groups[index].get(name) if groups and index < len(groups) else None
        if found:
            return found[0]
    return data


def _measured(library: Any, values: Pixels, description: Any) -> Pixels:
    """Turn stored values into measured ones."""
    if description.get("ModalityLUTSequence"):
        return np.asarray(library.pixels.apply_modality_lut(values, description))
    slope, intercept = (description.get(name) for name in ("RescaleSlope", "RescaleIntercept"))
    factor, summand = float(1 if slope is None else slope), float(intercept or 0)
    return values if (factor, summand) == (1, 0) else values * factor + summand


def _palette(library: Any, data: Any, count: int) -> Pixels:
    colours = np.asarray(library.pixels.apply_color_lut(np.arange(count), data))
    return colours if colours.dtype == np.uint8 else (colours >> 8).astype(np.uint8)


def decode_nifti(source: Source, page: int, max_pixels: int) -> Decoded:
    """Decode one slice of a NIfTI file.

    Parameters
    ----------
    source, page, max_pixels
        See `decoding.decode`. Pages run through the third axis first, then through the fourth (time) and all others: slice k
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
    dx, dy = (scale * abs(float(str(zoom))) for zoom in noted.get_zooms()[:2])
    return np.ascontiguousarray(values.swapaxes(0, 1)[::-1]), notes, _size(dx, dy)


def _unpacked(library: Any, source: Source) -> Any:
    """Open a NIfTI file, which may be compressed."""
    if source.path:
        return library.openers.ImageOpener(str(source.path))
    file = source.open()
    return gzip.GzipFile(fileobj=file) if source.data[:2] == b"\x1f\x8b" else file


def _size(dx: Any, dy: Any) -> Size | None:
    """Return the size of a pixel, None if what is noted is none."""
    x, y = float(dx or 0), float(dy or 0)
    return (x, y) if 0 < x < math.inf and 0 < y < math.inf else None
