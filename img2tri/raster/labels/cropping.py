"""Picture -> the part of it within a box, which stays where it was in the world.

A mesh of the part lies on the mesh of the whole. Everything that is found by looking at the whole image, such as Otsu's level
and lengths in "%" of the diagonal, is then found in the part.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from img2tri.errors import ParameterError, finite, shown
from img2tri.types import Frame, Picture

SIDE_ROUNDING = 1e-6  # px: a side this close to a side of pixels is meant to lie on it


def crop(picture: Picture, box: Sequence[float] | None) -> Picture:
    """Cut a picture to the pixels a box touches.

    Parameters
    ----------
    picture
        The whole.
    box
        (left, bottom, right, top) in world units, within ``picture.frame.bounds``; `bottom` is the least y, whichever way rows
        go. Pixels the box only touches with a side are left out; those it overlaps are kept as a whole, so that the
        part is up to one pixel larger than the box on each side. None: the picture as it is.

    Returns
    -------
    Picture
        With a copy of the pixels, a frame that lies where they lay, and in its notes under "crop" the "rows" and "columns"
        that were kept, each as the first and the one after the last, and the shape "of" the whole.

    Raises
    ------
    ParameterError
        If the box is not four numbers, is empty, or reaches out of the image.

    Examples
    --------
    >>> import numpy as np
    >>> from img2tri.types import Frame
    >>> whole = Picture(np.arange(12).reshape(3, 4), Frame((3, 4)))
    >>> part = crop(whole, (1, 0, 2.5, 2))
    >>> part.values
    array([[ 5,  6], [ 9, 10]])
    >>> part.frame.bounds
    (1.0, 0.0, 3.0, 2.0)
    """
    if box is None:
        return picture
    part, rows, columns = frame_within(picture.frame, box)
    values = np.array(picture.values[slice(*rows), slice(*columns)], order="C")
    missing = None if picture.missing is None else np.array(picture.missing[slice(*rows), slice(*columns)], order="C")
    notes = picture.notes | {"crop": {"rows": rows, "columns": columns, "of": picture.frame.shape}}
    return dataclasses.replace(picture, values=values, frame=part, notes=notes, missing=missing)


def frame_within(frame: Frame, box: Sequence[float]) -> tuple[Frame, tuple[int, int], tuple[int, int]]:
    """Return where the part within a box lies, and its rows and columns, each as the first and the one after the last; see `crop`."""
    left, bottom, right, top = _numbers(box)
    if not (left < right and bottom < top):
        raise ParameterError(f"crop: expected left < right and bottom < top, found {(left, bottom, right, top)}")
    (h, w), (dx, dy), (x, y) = frame.shape, frame.spacing, frame.corner
    first_column, end_column = _touched((left - x) / dx, (right - x) / dx)
    first_up, end_up = _touched((bottom - y) / dy, (top - y) / dy)
    if min(first_column, first_up) < 0 or end_column > w or end_up > h:
        raise ParameterError(f"crop: expected a box within the image, {frame.bounds}, found {(left, bottom, right, top)}")
    rows = (h - end_up, h - first_up) if frame.upward else (first_up, end_up)
    columns = (first_column, end_column)
    part = dataclasses.replace(frame, shape=(rows[1] - rows[0], columns[1] - columns[0]), corner=(x + first_column * dx, y + first_up * dy))
    return part, rows, columns


def _numbers(box: Sequence[float]) -> tuple[float, float, float, float]:
    if isinstance(box, (str, bytes)) or getattr(box, "ndim", 1) != 1 or not hasattr(box, "__len__") or len(box) != 4:
        raise ParameterError(f"crop: expected four numbers (left, bottom, right, top), found {shown(box)}")
    left, bottom, right, top = (finite("crop", number) for number in box)
    return left, bottom, right, top


def _touched(low: float, high: float) -> tuple[int, int]:
    """Return the first and the one after the last of the pixels between two places along a row or column."""
    first = math.floor(low + SIDE_ROUNDING)
    return first, max(first + 1, math.ceil(high - SIDE_ROUNDING))
