"""Gray values -> where on its dual edge each crossing lies, and how surely.

Between two pixel centres the gray value is interpolated linearly; the outline passes where it reaches the level, as in marching
squares (Lorensen and Cline, "Marching cubes", 1987, DOI 10.1145/37402.37422, in two dimensions). That level
is a number where the user gave one: the outline is an iso-line. Else it is the middle between the two sides as they are
nearby: on an edge drawn by area coverage, that is where the edge is, whatever the two sides are like, while a level
found for the whole image lies off the edges of all zones but the average one.

Where an edge is sharp the gray value of a pixel is the share of its area on the one side; then the shares of a column of pixels across
the edge add up to the length that side covers, as in `colour_crossings` and in Trujillo-Pino et al. ("Accurate subpixel edge location
based on partial area effect", 2013, DOI 10.1016/j.imavis.2012.10.005). A dual edge that runs across the edge is part of such a column;
one that runs along it meets the edge where the columns through its two ends say::

    across   o o . x x x      along   x x     the edge is 0.7 px below the centre of the left pixel and
                                      . .     0.2 px above that of the right one: it meets the dual edge
                                      o o     after 7 ninths of the way

Straight edges are placed exactly so. Where an edge is hard, both pixels being what their sides are further on, the gray values say no more
than a mask: the crossing may lie anywhere between the centres. What differs from a side by no more than noise does counts as that side.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows
from img2tri.shapes.trace.dual_edges import BOUND
from img2tri.types import Frame

SURE = 0.15  # of the dual edge: how far smoothing may shift a crossing whose place the gray values tell
SURE_AREA = 0.05  # the same where areas of pixels tell it
HARD = 0.98  # contrast of two pixels, relative to that of their sides, from which an edge is hard
SHARP_EDGE = 0.4  # steepest contrast of two pixels, relative to that of their sides, from which areas of pixels tell where an edge is
COLUMN = 2  # px beyond the two beside a crossing, or to either side of them, that are asked
FARTHEST = 8  # px: how far away the sides of slow ramps are looked for
NEAR_MIDDLE = 0.1  # of the contrast: how far from the middle a level may be for areas to tell where it is
PURE = 0.95  # share from which a pixel is of one side
DIAGONAL = 0.3  # weight of what is interpolated on diagonal edges: half of the images there are draw them by distance rather than area
NOISE = 6.0  # standard deviations: what noise may do
SAMPLE = 20  # crossings, the fewest that tell noise
MOST, NORMAL = 0.75, 2.46  # of the lesser of two differences of two pixels, and standard deviations of noise to their mean


def iso_crossings(gray: NDArray[Any], level: float | Floats | None, middle: Points, vector: Points, frame: Frame) -> tuple[Floats, Floats]:
    """Place crossings by gray values.

    Parameters
    ----------
    gray
        (h, w) bool, integer or float; NaN where a pixel is not there.
    level
        The gray value of the outline, or one (k,) for each crossing; None is the middle between the two sides nearby.
    middle, vector
        (n,) middle and direction of the dual edges, from the pixel centre on the right to the one on the left; 0 where a point has none.
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
    if not len(at):
        return shift, slack
    s = _Surroundings(gray, pixels_at(middle[at] + vector[at] / 2, frame), pixels_at(middle[at] - vector[at] / 2, frame))
    wanted = s.middle if level is None else level[at] if isinstance(level, np.ndarray) else level
    place, (by_area, known) = s.interpolated(wanted), s.by_areas()
    if level is not None:  # where it is not quite in the middle, as far from there as the values between the centres have it
        known &= np.abs(wanted - s.middle) <= NEAR_MIDDLE * s.contrast
        by_area += place - s.interpolated(s.middle)
    place = np.where(known, by_area + DIAGONAL * s.slant * (place - by_area), place)
    there = ~np.isnan(s.left - s.right)  # beside a pixel that is not there, all that is known is that the edge lies between the centres
    shift[at] = np.where(there, np.clip(place, -BOUND, BOUND), 0.0)
    sure = np.where(known, SURE_AREA, SURE) + NOISE * s.noise
    slack[at] = np.where(there & ~s.hard, np.minimum(sure, BOUND), BOUND)
    return shift, slack


class _Surroundings:
    """What is around crossings.

    Attributes
    ----------
    left, right
        (k,) the gray values of the pixels on the left and right.
    middle, contrast
        (k,) of the two sides nearby.
    slant
        (k,) 0 where the edge runs along rows or columns, 1 where it runs diagonally.
    noise
        (k,) its standard deviation, relative to the contrast.
    hard
        (k,) bool, both pixels are what their sides are.
    """

    def __init__(self, gray: NDArray[Any], left: tuple[Ints, Ints], right: tuple[Ints, Ints]) -> None:
        """Look around crossings between pixels (rows, columns) on their left and right."""
        step, beside = (left[0] - right[0], left[1] - right[1]), (right[1] - left[1], left[0] - right[0])
        # Three rows of four pixels along the dual edge, both pixels amid them; higher on the left, whichever is brighter.
        near = np.stack([[_values(gray, right, k, step, j, beside) for k in (-1, 0, 1, 2)] for j in (-1, 0, 1)])
        self.left, self.right = near[1, 2].copy(), near[1, 1].copy()
        self._sign = np.where(self.left > self.right, 1.0, -1.0)
        near *= self._sign
        along, sideways = (near[:, 2] - near[:, 1]).sum(axis=0) / 3, (near[2, 1:3] - near[0, 1:3]).sum(axis=0) / 4
        less, more = np.minimum(np.abs(along), np.abs(sideways)), np.maximum(np.abs(along), np.abs(sideways))
        self.slant = np.divide(less, more, out=np.zeros(len(more)), where=more > 0)
        self._across = ~(np.abs(sideways) > np.abs(along))
        # Columns through both pixels, the way the edge rises.
        turned = np.where(sideways > 0, 1, -1)
        up = tuple(np.where(self._across, one, turned * other) for one, other in zip(step, beside, strict=True))
        steps = range(-COLUMN, COLUMN + 1)
        self._near = near
        self._of_left, self._of_right = (self._sign * np.stack([_values(gray, p, m, up) for m in steps]) for p in (left, right))
        high = np.fmax(np.fmax.reduce(near[:, 1:], axis=(0, 1)), _climbed(self._of_left[COLUMN:]))
        low = np.fmin(np.fmin.reduce(near[:, :3], axis=(0, 1)), -_climbed(-self._of_right[COLUMN::-1]))
        steepest = np.fmax(*(np.abs(np.diff(column, axis=0)).max(axis=0) for column in (self._of_left, self._of_right)))
        slow = np.flatnonzero(steepest < SHARP_EDGE * (high - low))
        if len(slow):
            up = tuple(one[slow] for one in up)
            far_left, far_right = (
                self._sign[slow] * np.stack([_values(gray, (p[0][slow], p[1][slow]), m * way, up) for m in range(FARTHEST + 1)])
                for p, way in ((left, 1), (right, -1))
            )
            high[slow], low[slow] = np.fmax(high[slow], _climbed(far_left)), np.fmin(low[slow], -_climbed(-far_right))
        self._low, self.contrast, self.middle = low, high - low, self._sign * (high + low) / 2
        self._sharp = steepest >= SHARP_EDGE * self.contrast
        self.noise = np.divide(self._deviation(), self.contrast, out=np.zeros(len(high)), where=self.contrast > 0)
        self.hard = np.abs(self.left - self.right) >= (HARD - 2 * NOISE * self.noise) * self.contrast

    def _deviation(self) -> float:
        """Return the standard deviation of noise, by how pixels two and three px beyond sharp edges differ.

        On the side where they do so less: there may be another edge on one.
        """
        differ = np.fmin(np.abs(self._of_left[-1] - self._of_left[-2]), np.abs(self._of_right[0] - self._of_right[1]))
        differ = differ[self._sharp & self._across & ~np.isnan(differ)]
        if len(differ) < SAMPLE:
            return 0.0
        # The mean of most: the median of small whole numbers would often be 0.
        return NORMAL * float(np.sort(differ)[: int(MOST * len(differ))].mean())

    def interpolated(self, level: float | Floats) -> Floats:
        """Where on the dual edge (k,) values reach a level, changing evenly from one centre to the other."""
        differ = self.left != self.right
        return np.where(differ, (level - self.right) / np.where(differ, self.left - self.right, 1.0) - 0.5, 0.0)

    def by_areas(self) -> tuple[Floats, Bools]:
        """Where on the dual edge (k,) the edge is by the areas of pixels, and for which crossings that is known."""
        left, right = self._shares(self._of_left), self._shares(self._of_right)
        reached = (left.max(axis=0) > PURE) & (right.min(axis=0) < 1 - PURE)
        # Across the edge: what does not go on as the edge does belongs to another edge.
        beyond_left, beyond_right = left[COLUMN:].copy(), right[COLUMN::-1].copy()
        beyond_left[1:][np.logical_or.accumulate(np.diff(beyond_left, axis=0) < 0, axis=0)] = 1.0
        beyond_right[1:][np.logical_or.accumulate(np.diff(beyond_right, axis=0) > 0, axis=0)] = 0.0
        across = COLUMN + 1 - beyond_left.sum(axis=0) - beyond_right.sum(axis=0)
        # The mean height over a column is that in its middle and a 24th of the second difference from column to column.
        one, two, three = self._shares(self._near).sum(axis=1)
        across -= np.where(self.hard, 0.0, 2 * two - one - three) / 24
        # Along the edge: how far the centre of the one pixel is above it, and that of the other below.
        above, below = left.sum(axis=0) - COLUMN - 0.5, right.sum(axis=0) - COLUMN - 0.5
        meets = (above > 0) & (below < 0) & (np.diff(left, axis=0) >= 0).all(axis=0) & (np.diff(right, axis=0) >= 0).all(axis=0)
        along = -below / np.where(meets, above - below, 1.0) - 0.5
        place = np.where(self._across, across, along)
        return place, self._sharp & reached & (self._across | meets) & ~np.isnan(place)

    def _shares(self, values: Floats) -> Floats:
        """Return the shares (..., k) of the left side in pixels with these values."""
        share = (values - self._low) / np.where(self.contrast > 0, self.contrast, 1.0)
        blur = np.minimum(NOISE * self.noise, 0.49)
        return np.clip(np.where(share < blur, 0.0, np.where(share > 1 - blur, 1.0, share)), 0, 1)


def _climbed(values: Floats) -> Floats:
    """Return of each sequence (m, k) the value to which it goes up from its first one, before it goes down."""
    goes_on = np.logical_and.accumulate(np.diff(values, axis=0) >= 0, axis=0)
    return np.asarray(np.where(goes_on, values[1:], values[0]).max(axis=0))


def pixels_at(centres: Points, frame: Frame) -> tuple[Ints, Ints]:
    """Row and column of the pixels with these centres."""
    rows, columns = frame.row_column(frame.world(as_rows(centres)))
    return rows.astype(np.int64), columns.astype(np.int64)


def _values(gray: NDArray[Any], pixel: Any, count: int, step: Any, times: int = 0, beside: Any = (0, 0)) -> Floats:
    """Return the gray values (k,) so many steps (rows, columns) from some pixels; beyond the frame the image goes on as it ends there."""
    rows, columns = (pixel[i] + count * step[i] + times * beside[i] for i in (0, 1))
    return np.asarray(gray[np.clip(rows, 0, gray.shape[0] - 1), np.clip(columns, 0, gray.shape[1] - 1)], np.float64)
