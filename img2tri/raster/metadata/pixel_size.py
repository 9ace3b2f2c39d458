"""The resolution a file notes -> the size of a pixel, (dx, dy) in millimetres.

TIFF and EXIF use the same numbered tags for the resolution; JFIF and PNG are brought to them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from img2tri.raster.metadata.exif_orientation import exif

if TYPE_CHECKING:
    from PIL import Image

PixelSize = tuple[float, float]

X_RESOLUTION, Y_RESOLUTION, RESOLUTION_UNIT = 282, 283, 296  # tags of TIFF and EXIF
INCH, CENTIMETRE = 2, 3


def pixel_size(img: Image.Image) -> PixelSize | None:
    """Return the size of a pixel in millimetres, if the file says it. Pillow's ``info["dpi"]`` may hold invented defaults."""
    if img.info.get("jfif_unit"):
        x, y = img.info["jfif_density"]
        return millimetres({X_RESOLUTION: x, Y_RESOLUTION: y, RESOLUTION_UNIT: INCH if img.info["jfif_unit"] == 1 else CENTIMETRE})
    if img.format == "PNG" and "dpi" in img.info:
        return millimetres(dict(zip((X_RESOLUTION, Y_RESOLUTION), img.info["dpi"], strict=True)))
    return millimetres(exif(img)) if img.format in ("JPEG", "MPO") else None


def millimetres(tags: Mapping[int, Any]) -> PixelSize | None:
    """Return the size of a pixel from the tags of TIFF and EXIF, None if they have no resolution or no unit for it."""
    unit = {INCH: 25.4, CENTIMETRE: 10.0}.get(tags.get(RESOLUTION_UNIT, INCH))
    if unit is None or X_RESOLUTION not in tags or Y_RESOLUTION not in tags:
        return None
    x, y = (ratio(tags[code]) for code in (X_RESOLUTION, Y_RESOLUTION))
    return (unit / x, unit / y) if x > 0 and y > 0 else None


def ratio(value: Any) -> float:
    """Return a resolution as a number: Pillow has its own type for fractions, tifffile a pair; 0 for anything not finite."""
    top, bottom = value if isinstance(value, tuple) else (float(value), 1)
    number = top / bottom if bottom else 0.0
    return number if math.isfinite(number) else 0.0


def positive_size(dx: Any, dy: Any) -> PixelSize | None:
    """Return the size of a pixel, None if what is noted is none."""
    x, y = float(dx or 0), float(dy or 0)
    return (x, y) if 0 < x < math.inf and 0 < y < math.inf else None
