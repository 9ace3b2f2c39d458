"""A ``SimpleITK.Image`` -> `Picture`, lying where the image lies in space.

It is recognised by its module, so SimpleITK is never imported here. ITK counts pixels from the origin, x first, and places them
by their centres; y grows with the row (`Frame.upward` is False). Of a volume one slice across z is taken.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from img2tri.errors import ImageError, ParameterError, shown
from img2tri.raster.in_memory.array_checks import as_array, pixels
from img2tri.raster.metadata.nodata import present
from img2tri.types import Frame, Picture


def is_simpleitk(image: Any) -> bool:
    """Tell whether `image` is a ``SimpleITK.Image``, without importing SimpleITK."""
    return type(image).__module__.partition(".")[0] == "SimpleITK" and hasattr(image, "GetSpacing")


def from_simpleitk(image: Any, page: int = 0) -> Picture:
    """Read a ``SimpleITK.Image``, of a volume slice `page` across z.

    Raises
    ------
    ImageError
        If it has other than two or three dimensions, or is turned in space.
    ParameterError
        If it has no such slice.
    """
    library = sys.modules[type(image).__module__.partition(".")[0]]
    size, spacing, origin = image.GetSize(), image.GetSpacing(), image.GetOrigin()
    n = len(size)
    if n not in (2, 3):
        raise ImageError(f"image: expected a SimpleITK image of two or three dimensions, found {n}")
    turn = np.reshape(image.GetDirection(), (n, n))
    if not np.allclose(turn, np.eye(n)):
        raise ImageError("image: expected a SimpleITK image along the axes, found one whose direction turns it; resample it first")
    depth = size[2] if n == 3 else 1
    if page >= depth:
        raise ParameterError(f"page: expected 0 to {depth - 1}, the slices of the image, found {shown(page)}")
    whole = np.asarray(library.GetArrayViewFromImage(image))
    values, missing = present(as_array(np.array(whole[page] if n == 3 else whole)))
    (dx, dy), h, w = spacing[:2], *values.shape[:2]
    corner = (origin[0] - dx / 2, origin[1] - dy / 2)
    z = float(origin[2] + page * spacing[2]) if n == 3 else 0.0
    notes: dict[str, Any] = {"format": "SimpleITK", "spacing": "SimpleITK"} | ({"pages": depth, "page": page} if depth > 1 else {})
    return Picture(pixels(values), Frame((h, w), (dx, dy), corner, upward=False, z=z), "SimpleITK image", notes, missing)
