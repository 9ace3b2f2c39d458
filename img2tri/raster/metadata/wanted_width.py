"""Picture -> the same picture as wide as wanted: the size of a pixel follows."""

from __future__ import annotations

import dataclasses
import math

from img2tri.errors import ParameterError, finite, shown
from img2tri.types import Picture

FINEST = 1e-4  # px: how exact places in the world must be


def as_wide_as(picture: Picture, width: float | None, *, spacing: object = None) -> Picture:
    """Give an image a width.

    Parameters
    ----------
    picture
        The whole image, as read.
    width
        In world units; None leaves it as it is. Pixels keep their shape, that of a file that knows it too.
    spacing
        What was said of the size of a pixel: None or "file", as numbers would say it twice.

    Raises
    ------
    ParameterError
        If the width is not a number above 0, or the image has its size from elsewhere.

    Examples
    --------
    >>> import numpy as np
    >>> from img2tri.types import Frame
    >>> as_wide_as(Picture(np.zeros((20, 40)), Frame((20, 40))), 80).frame.bounds
    (0.0, 0.0, 80.0, 40.0)
    """
    if width is None:
        return picture
    if spacing not in (None, "file") or picture.notes.get("spacing") == "ImageData":
        found = f"spacing {shown(spacing)}" if spacing is not None else "a pyvista.ImageData, which has its own"
        raise ParameterError(f"width: expected to be left out with the size of a pixel, which says it too, found {found}")
    frame = picture.frame
    scale = finite("width", width, above=0) / (frame.shape[1] * frame.spacing[0])
    size = (frame.spacing[0] * scale, frame.spacing[1] * scale)
    if not 1e-100 <= min(size) <= max(size) <= 1e100:
        raise ParameterError(f"width: expected pixels of 1e-100 to 1e100, found {shown(width)}; choose another unit")
    wide = dataclasses.replace(frame, spacing=size, z=frame.z * scale)
    if math.ulp(max(map(abs, wide.bounds))) > FINEST * wide.pixel:
        raise ParameterError(f"width: expected pixels that numbers of 64 bits can part at {frame.corner}, found {wide.pixel:g} wide")
    notes = {name: note for name, note in picture.notes.items() if name != "units"}  # the file's are not those of the width
    return dataclasses.replace(picture, frame=wide, notes=notes | {"spacing": "width"})
