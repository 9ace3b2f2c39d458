"""The EXIF or TIFF orientation of an image -> the image upright.

TIFF and EXIF use the same numbered tags.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.raster.in_memory.array_checks import Pixels

if TYPE_CHECKING:
    from PIL import Image

ORIENTATION = 274  # tag of TIFF and EXIF


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
