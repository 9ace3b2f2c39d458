"""Gray values -> where on its dual edge each crossing lies, and how surely.

Between two pixel centres the gray value is interpolated linearly; the outline passes where it reaches the level, as in marching
squares (Lorensen and Cline, "Marching cubes", 1987, DOI 10.1145/37402.37422, in two dimensions). That level
is a number where the user gave one: the outline is an iso-line. Else it is the middle between the two sides as they are
nearby: on an edge drawn by area coverage, that is where the edge is, whatever the two sides are like, while a level
found for the whole image lies off the edges of all zones but the average one.

Where an edge is hard, both pixels being what their sides are further on, the gray values say no more than a mask: the
crossing may lie anywhere between the centres. Where a pixel is in between, the place is known to about a tenth of a pixel.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, Points, as_rows
from img2tri.shapes.trace.dual_edges import BOUND
from img2tri.types import Frame

SURE = 0.15  # of the dual edge: how far smoothing may shift a crossing whose place the gray values tell
HARD = 0.98  # contrast of two pixels, relative to that of their sides, from which an edge is hard


def iso_crossings(gray: NDArray[Any], level: float | Floats | None, middle: Points, vector: Points, frame: Frame) -> tuple[Floats, Floats]:
    """Place crossings by gray values.

    Parameters
    ----------
    gray
        (h, w) bool, integer or float; NaN where a pixel is not there.
    level
        The gray value of the outline, or one (k,) for each crossing; None is the middle between the two sides nearby.
    middle, axis
        (n,) middle and direction of the dual_edges, from the pixel centre on the right to the one on the left; 0 where a point has none.
    frame
        Where the image lies; dual edges are in its plane.

    Returns
    -------
    shift : (n,) float64
        Place of each crossing on its dual edge, from its middle, in lengths of the dual edge.
    slack : (n,) float64
        How far smoothing may shift it from there.
    """
    shift, slack = np.zeros(len(middle)), np.full(len(middle), BOUND)
    at = np.flatnonzero(vector)
    left, right = pixels_at(middle[at] + vector[at] / 2, frame), pixels_at(middle[at] - vector[at] / 2, frame)
    a, b = _values(gray, left), _values(gray, right)
    rising = a > b
    # The sides as they are nearby: the brightest around the brighter pixel, the darkest around the darker one.
    extremes = [[_around(gray, pixels, pick) for pixels in (left, right)] for pick in (np.fmax, np.fmin)]
    bright = np.where(rising, extremes[0][0], extremes[0][1])
    dark = np.where(rising, extremes[1][1], extremes[1][0])
    wanted = (bright + dark) / 2 if level is None else level[at] if isinstance(level, np.ndarray) else level
    contrast = np.where(a != b, a - b, 1.0)
    s = np.where(a != b, (wanted - b) / contrast - 0.5, 0.0)
    there = ~np.isnan(a - b)  # beside a pixel that is not there, all that is known is that the edge lies between the centres
    shift[at] = np.where(there, np.clip(s, -BOUND, BOUND), 0.0)
    slack[at] = np.where(there & (np.abs(a - b) < HARD * (bright - dark)), SURE, BOUND)
    return shift, slack


def pixels_at(centres: Points, frame: Frame) -> tuple[Ints, Ints]:
    """Row and column of the pixels with these centres."""
    rows, columns = frame.row_column(frame.world(as_rows(centres)))
    return rows.astype(np.int64), columns.astype(np.int64)


def _values(gray: NDArray[Any], pixels: tuple[Ints, Ints]) -> Floats:
    return gray[pixels].astype(np.float64)


def _around(gray: NDArray[Any], pixels: tuple[Ints, Ints], pick: np.ufunc) -> Floats:
    """Greatest or least value of the 3 x 3 pixels around."""
    h, w = gray.shape
    result = _values(gray, pixels)
    for dr in (-1, 0, 1):
        for dc in (-1, 0, 1):
            beside = np.clip(pixels[0] + dr, 0, h - 1), np.clip(pixels[1] + dc, 0, w - 1)
            result = pick(result, _values(gray, beside))
    return result
