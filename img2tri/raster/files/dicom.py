"""DICOM, as scanners write it -> values, notes and the size of a pixel in millimetres.

pydicom decodes; it comes with an extra of img2tri and is loaded for such files only. Values are those that were measured, such as
Hounsfield units: slope and intercept in the file are applied, windows for display are not.

A frame is taken as it is displayed, its first row at the top. Nothing is turned by what a file says about the patient: slices, and
labels and gray values of one scan, stay congruent.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.arrays import Bools
from img2tri.errors import FileError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.raster.metadata.pixel_size import positive_size

PARALLEL = 1e-3  # by how much directions of parallel frames may differ
PIXEL_DATA = ("PixelData", "FloatPixelData", "DoubleFloatPixelData")


def decode_dicom(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one frame of a DICOM file.

    Parameters
    ----------
    source, page, max_pixels
        See `format_detection.decode`; pages are frames.

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
    missing
        Padding around what was measured, or None.

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
    missing = _padding(values, data)
    notes["photometric"] = str(data.get("PhotometricInterpretation", ""))
    if notes["photometric"] == "PALETTE COLOR":
        notes["palette"] = _palette(library, data, int(values.max()) + 1)
    elif values.ndim == 2:
        values = _measured(library, values, _of_frame(data, page, "PixelValueTransformationSequence"))
    measures = _of_frame(data, page, "PixelMeasuresSequence")
    for tag in ("PixelSpacing", "ImagerPixelSpacing"):
        # The first number is the distance of rows, which lies along y.
        dy, dx = measures.get(tag) or (0, 0)
        size = positive_size(dx, dy)
        if size is not None:
            return DecodedImage(values, notes | {"spacing_from": tag}, size, missing=missing)
    return DecodedImage(values, notes, missing=missing)


def frame_heights(path: str) -> list[float] | None:
    """Return how far each frame of a DICOM file lies from the first, along the normal of that, in millimetres.

    From the positions of frames in the patient, else from the distance of slices. None if the file says neither, if frames are not
    parallel, or if it cannot be read, which is for the reader of its pixels to tell.
    """
    try:
        import pydicom

        data: Any = pydicom.dcmread(path, force=True, stop_before_pixels=True)
        pages = int(data.get("NumberOfFrames") or 1)
        positions = [_of_frame(data, page, "PlanePositionSequence").get("ImagePositionPatient") for page in range(pages)]
        directions = [_of_frame(data, page, "PlaneOrientationSequence").get("ImageOrientationPatient") for page in range(pages)]
        if all(positions) and all(directions):
            axes = np.array(directions, np.float64)
            if np.abs(axes - axes[0]).max() > PARALLEL:
                return None
            along = (np.array(positions, np.float64) - np.array(positions[0], np.float64)) @ np.cross(axes[0, :3], axes[0, 3:])
            # One position for all is that of the file.
            if pages == 1 or np.ptp(along) > 0:
                return [float(height) for height in along]
        step = float(_of_frame(data, 0, "PixelMeasuresSequence").get("SpacingBetweenSlices") or data.get("SpacingBetweenSlices") or 0)
    except Exception:  # whatever pydicom raises of a file that is none
        return None
    return [page * step for page in range(pages)] if step else None


def _padding(stored: Pixels, data: Any) -> Bools | None:
    """Return the mask of the pixels that only pad the image to a rectangle: one stored value, or all up to a limit (C.7.5.1.1.2)."""
    value, limit = data.get("PixelPaddingValue"), data.get("PixelPaddingRangeLimit")
    if value is None or stored.ndim == 3:
        return None
    low, high = (value, value) if limit is None else sorted((int(value), int(limit)))
    missing = (stored >= low) & (stored <= high)
    return missing if missing.any() else None


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
