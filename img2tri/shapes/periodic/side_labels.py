"""The option `periodic` checked: opposite sides of a label map have to be the same."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ImageError, ParameterError, shown

DIRECTIONS = {None: (), "x": (0,), "y": (1,), "xy": (0, 1)}  # which coordinate tells a side from the one opposite to it
SIDES = {"x": (1, "column"), "y": (0, "row")}


def check_periodic(periodic: str | None, labels: NDArray[Any], *, recipe: str = "conforming", smoothing: str | None = None) -> None:
    """Check that the labels (h, w) along opposite sides are the same, and that nothing else stands against the option.

    Raises
    ------
    ParameterError
        If `periodic` is none of None, "x", "y", "xy"; if the recipe is one of the paper's, or smoothing moves the boundary.
    ImageError
        If the labels differ; it says where they first do.

    Examples
    --------
    >>> check_periodic("x", np.array([[1, 2, 1], [2, 2, 1]]))
    Traceback (most recent call last):
    ...
    img2tri.errors.ImageError: periodic: expected the same labels in the first and the last column, found 2 and 1 in row 1 (1 such); ...
    """
    if not (periodic is None or isinstance(periodic, str)) or periodic not in DIRECTIONS:
        raise ParameterError(f"periodic: expected 'x', 'y', 'xy' or None, found {shown(periodic)}")
    if periodic and (recipe != "conforming" or smoothing == "cotangent"):
        found = f"recipe {recipe!r}" if recipe != "conforming" else f"smoothing {smoothing!r}"
        raise ParameterError(f"periodic: expected None with {found}, which does not keep opposite sides alike, found {periodic!r}")
    for name in periodic or "":
        axis, line = SIDES[name]
        first, last = np.take(labels, [0, -1], axis=axis) if axis == 0 else np.take(labels, [0, -1], axis=axis).T
        differ = np.flatnonzero(first != last)
        if len(differ):
            other, at = SIDES["y" if name == "x" else "x"][1], differ[0]
            widths = "((0, 0), (0, 1))" if name == "x" else "((0, 1), (0, 0))"
            raise ImageError(
                f"periodic: expected the same labels in the first and the last {line}, found {first[at]} and {last[at]} in {other} {at} "
                f"({len(differ)} such); where an image repeats, add its first {line} once more: np.pad(image, {widths}, mode='wrap')"
            )
