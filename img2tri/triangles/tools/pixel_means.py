r"""Values of pixels -> means over triangles, each pixel by the area it shares with the triangle: exact, and without clipping a polygon.

A pixel image f is constant on unit squares, so its integral over a triangle is a sum along the triangle's sides (Green's theorem): with
F(x, y) the integral of f along the row from 0 to x, it is the closed integral of F dy. A side is cut where it crosses rows and columns;
on each piece F is linear, so its value in the middle times the step in y is exact. Each side is walked once for both its triangles::

        |   /|           . cuts of one side: every column and row it crosses
     ---+--.-+---
        | /  |           F at the middle of a piece: the sum of the pixels on its left in that row, and a part of its own
     ---+.---+---
        |    |

Cost follows the length of all sides in pixels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, runs, unique_edges


def pixel_means(points: Floats, triangles: Ints, values: NDArray[np.generic]) -> Floats:
    """Return the mean of an image over each triangle.

    Parameters
    ----------
    points
        (n, 2) float64, column and row, the first pixel being the square from (0, 0) to (1, 1); within the image.
    triangles
        (m, 3) int64, of any orientation.
    values
        (h, w) numbers, NaN where there are none.

    Returns
    -------
    numpy.ndarray
        (m,) float64, over the part of each triangle that has numbers; NaN where none has.

    Examples
    --------
    A pixel of 1 beside one of 3, and a triangle that covers 3 / 4 of their first half and 1 / 4 of the other:

    >>> pixel_means(np.array([[0, 0], [2, 0], [0, 1.0]]), np.array([[0, 1, 2]]), np.array([[1, 3]]))
    array([1.5])
    """
    numbers = np.asarray(values, np.float64)
    known = np.isfinite(numbers)
    middle = float(numbers[known].mean()) if known.any() else 0.0  # sums along a row stay small, and so does their rounding
    edges, sides = unique_edges(triangles)
    # A side runs with its edge, or against it.
    ahead = np.where(triangles < np.roll(triangles, -1, axis=1), 1.0, -1.0)

    def integral(image: Floats) -> Floats:
        along = _along(points[edges[:, 0]], points[edges[:, 1]], image)
        return np.asarray((ahead * along[sides]).sum(axis=1))

    corners = points[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2
    total = integral(np.where(known, numbers - middle, 0.0))
    covered = area if known.all() else integral(known.astype(np.float64))
    none = np.abs(covered) <= 1e-9 * np.abs(area)
    return np.asarray(np.where(none, np.nan, middle + total / np.where(none, 1.0, covered)))


def _along(start: Floats, end: Floats, image: Floats) -> Floats:
    """Integrate F dy along segments from and to (e, 2) -> (e,)."""
    h, w = image.shape
    sums = np.zeros((h, w + 1))
    np.cumsum(image, axis=1, out=sums[:, 1:])
    segment, at = _cuts(start, end)
    # Pieces lie between two cuts that follow each other on one segment.
    same = segment[1:] == segment[:-1]
    owner, low, high = segment[1:][same], at[:-1][same], at[1:][same]
    step = end[owner] - start[owner]
    middle = start[owner] + ((low + high) / 2)[:, None] * step
    column = np.clip(np.floor(middle[:, 0]).astype(np.int64), 0, w - 1)
    row = np.clip(np.floor(middle[:, 1]).astype(np.int64), 0, h - 1)
    inner = sums[row, column] + image[row, column] * (np.clip(middle[:, 0], 0, w) - column)
    return np.asarray(np.bincount(owner, inner * (high - low) * step[:, 1], len(start)), np.float64)


def _cuts(start: Floats, end: Floats) -> tuple[Ints, Floats]:
    """Return where segments begin, end, and cross rows and columns: their numbers, and the fractions of their lengths, both rising."""
    number = np.arange(len(start))
    segments, fractions = [number, number], [np.zeros(len(start)), np.ones(len(start))]
    for axis in (0, 1):
        low, high = np.minimum(start[:, axis], end[:, axis]), np.maximum(start[:, axis], end[:, axis])
        first = np.floor(low).astype(np.int64) + 1
        which, place = runs(np.maximum(np.ceil(high).astype(np.int64) - first, 0))
        segments.append(which)
        fractions.append((first[which] + place - start[which, axis]) / (end[which, axis] - start[which, axis]))
    segment, fraction = np.concatenate(segments), np.concatenate(fractions)
    order = np.argsort(segment + fraction / 2)  # one key sorts several times as fast as two
    return segment[order], fraction[order]
