"""What a file notes about its image besides the values: how to turn it upright, and the size of a pixel.

TIFF and EXIF use the same numbered tags; JFIF and PNG are brought to them.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.raster.io.pixel_arrays import Pixels

if TYPE_CHECKING:
    from PIL import Image

Size = tuple[float, float]

ORIENTATION, X_RESOLUTION, Y_RESOLUTION, RESOLUTION_UNIT = 274, 282, 283, 296
INCH, CENTIMETRE = 2, 3


def upright(values: Pixels, turn: int) -> Pixels:
    """Turn an image the way its EXIF or TIFF orientation asks for.

    1 as it is, 2 left to right, 3 by half a turn, 4 upside down, 5 rows become columns, 6 a quarter to the right, 7 rows become
    columns about the other diagonal, 8 a quarter to the left.
    """
    if turn >= 5:
        values = values.swapaxes(0, 1)
    if turn in (2, 3, 6, 7):
        values = values[:, ::-1]
    if turn in (3, 4, 7, 8):
        values = values[::-1]
    return np.ascontiguousarray(values)


def orientation(tags: Mapping[int, Any]) -> int:
    """Return how an image is to be turned, 1 to 8; 1, as it is, if nothing or nonsense is noted."""
    noted = tags.get(ORIENTATION, 1)
    return int(noted) if isinstance(noted, int) and 1 <= noted <= 8 else 1


def exif(img: Image.Image) -> Mapping[int, Any]:
    """Return the EXIF tags of an opened image; none if they cannot be read: what a camera noted is lost, the image is not."""
    try:
        return img.getexif()
    except (SyntaxError, ValueError, struct.error):
        return {}


def pixel_size(img: Image.Image) -> Size | None:
    """Return the size of a pixel in millimetres, if the file says it. Pillow's ``info["dpi"]`` may hold invented defaults."""
    if img.format == "TIFF":
        return millimetres(img.tag_v2)  # type: ignore[attr-defined]
    if img.info.get("jfif_unit"):
        x, y = img.info["jfif_density"]
        return millimetres({X_RESOLUTION: x, Y_RESOLUTION: y, RESOLUTION_UNIT: INCH if img.info["jfif_unit"] == 1 else CENTIMETRE})
    if img.format == "PNG" and "dpi" in img.info:
        return millimetres(dict(zip((X_RESOLUTION, Y_RESOLUTION), img.info["dpi"], strict=True)))
    return millimetres(exif(img)) if img.format in ("JPEG", "MPO") else None


def millimetres(tags: Mapping[int, Any]) -> Size | None:
    """Return the size of a pixel from the tags of TIFF and EXIF, None if they have no resolution or no unit for it."""
    unit = {INCH: 25.4, CENTIMETRE: 10.0}.get(tags.get(RESOLUTION_UNIT, INCH))
    if unit is None or X_RESOLUTION not in tags or Y_RESOLUTION not in tags:
        return None
    x, y = (_ratio(tags[code]) for code in (X_RESOLUTION, Y_RESOLUTION))
    return (unit / x, unit / y) if x > 0 and y > 0 else None


def _ratio(value: Any) -> float:
    """Return a resolution as a number: Pillow has its own type for fractions, tifffile a pair; 0 for anything not finite."""
    top, bottom = value if isinstance(value, tuple) else (float(value), 1)
    ratio = top / bottom if bottom else 0.0
    return ratio if np.isfinite(ratio) else 0.0
