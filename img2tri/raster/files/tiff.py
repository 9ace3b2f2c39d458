"""TIFFs of types Pillow has no mode for: int64, float64, int8, colours of 16 bit -> their values, by tifffile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page, turned
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.raster.metadata.exif_orientation import orientation, upright
from img2tri.raster.metadata.geotiff_imagej_ome import place_of_tiff
from img2tri.raster.metadata.nodata import gdal_nodata

MOST_SAMPLES = 4  # red, green, blue and alpha
MIN_IS_WHITE = 0  # TIFF's word for gray values of which the least is white
ASSOCIATED = 1  # TIFF's word for colours multiplied by their alpha


def decode_tiff(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode a TIFF of a type Pillow has no mode for: int64, float64, int8, colours of 16 bit."""
    try:
        import tifffile
    except ImportError as error:
        raise FileError(f"image: {str(source)!r} is a TIFF only tifffile can read; install it with  pip install 'img2tri[tiff]'") from error
    with tifffile.TiffFile(source.path or source.open()) as file:
        pages = len(file.pages)
        sheet = file.pages[min(page, pages - 1)].aspage()
        # A volume counts with all its layers.
        high = sheet.imagelength * sheet.imagedepth
        notes = {"format": "TIFF"} | check_page(source, page, pages, sheet.imagewidth, high, max_pixels)
        if sheet.samplesperpixel > MOST_SAMPLES:
            raise ImageError(f"image: expected at most {MOST_SAMPLES} values per pixel, found {sheet.samplesperpixel} in {str(source)!r}")
        values = _values_of(sheet, source)
        tags = {tag.code: tag.value for tag in sheet.tags}
        colormap, multiplied = sheet.colormap, tuple(sheet.extrasamples) == (ASSOCIATED,)
        if sheet.axes == "SYX":
            values = np.moveaxis(values, 0, 2)
    if values.ndim == 3 and values.shape[2] == 2:  # gray and alpha
        values = values[..., [0, 0, 0, 1]]
    if multiplied and values.shape[2:] == (4,):
        values = _divided(values)
    if colormap is not None:
        notes["palette"] = (np.asarray(colormap).T >> 8).astype(np.uint8)
    if sheet.photometric == MIN_IS_WHITE:
        notes["min_is_white"] = True
    turn = orientation(tags)
    return turned(of_tiff(upright(values, turn), notes, tags, turn), turn)


def _values_of(sheet: Any, source: Source) -> Pixels:
    try:
        return np.asarray(sheet.asarray())
    except ValueError as error:
        if "imagecodecs" not in str(error):
            raise
        how = f"{getattr(sheet.compression, 'name', sheet.compression)}"
        raise FileError(
            f"image: {str(source)!r} is compressed by {how}, which imagecodecs reads; install it with  pip install 'img2tri[codecs]'"
        ) from error


def of_tiff(values: Pixels, notes: dict[str, Any], tags: Mapping[int, Any], turn: int) -> DecodedImage:
    """Add what the tags of a TIFF say to its upright values, whichever library read them."""
    rows = values.shape[1] if turn >= 5 else values.shape[0]
    place = place_of_tiff(tags, rows)
    corner = place.corner if turn == 1 else None  # no program that knows of places turns images
    return DecodedImage(values, notes, place.size, place.unit, corner, gdal_nodata(tags, values))


def _divided(values: Pixels) -> Pixels:
    """Divide colours by the alpha they were multiplied with; where that is 0 they are black."""
    colours, alpha = values[..., :3], values[..., 3:].astype(np.float64)
    whole = values.dtype.kind in "iu"
    full = float(np.iinfo(values.dtype).max) if whole else 1.0
    colours = np.minimum(full, np.divide(colours * full, alpha, out=np.zeros(colours.shape), where=alpha > 0))
    return np.dstack([np.rint(colours) if whole else colours, alpha]).astype(values.dtype)
