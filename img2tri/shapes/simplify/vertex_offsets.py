"""Breaks moved sideways, so that few pieces stand well for their runs.

A chord between two points of an outline lies on one side of its bends, and it swings with every step of the pixels that its ends
happen to sit on. A break may leave its dense point instead: half of the lenses beside it are taken up, a zigzag from break to
break is smoothed, a piece leans towards the part of its run that is too far from it. So a piece need not be split for what a
little move cures, and short pieces beside long ones are what triangles suffer from most.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.shapes.place.padded_chains import Points, cross
from img2tri.shapes.simplify.simplification import Draft
from img2tri.types import Floats, Ints

FARTHEST = 0.8  # of the tolerance: how far sideways a break may lie from its dense point
FAIRINGS = 6  # how often a zigzag is smoothed
FAIR = 0.5  # of `FARTHEST`: how far a break may go for that


def fitted(d: Draft, *, tolerance: float, keep_area: bool = True) -> Draft:
    """Move breaks sideways: zigzags are smoothed; to keep areas, each break takes up half of the lenses beside it."""
    free, moved = Sideways(d), d.moved
    for _ in range(FAIRINGS):
        moved = free.moved(moved, free.zigzag(moved), FAIR * tolerance)
    d = replace(d, moved=moved)
    if keep_area:
        area, width = lenses(d)
        d = replace(d, moved=free.moved(moved, area[free.at] / width[free.at], tolerance))
    return d


class Sideways:
    """The breaks that may move sideways: those on a link, between two others. Both ends of a ring are one break, known by the first.

    How far all entries (k,) lie from their dense points, as in `Draft.moved`, is given to each method and returned anew.

    Attributes
    ----------
    at
        (b,) int64, their entries.
    behind, ahead
        (b,) int64, the breaks before and after them; rings go round.
    """

    def __init__(self, d: Draft) -> None:
        first, last = d.pieces
        behind, ahead = np.full((2, len(d.moved)), -1)
        ahead[first], behind[last] = last, first
        self._begin, self._end = _ring_ends(d)
        behind[self._begin], ahead[self._end] = behind[self._end], ahead[self._begin]
        may = (behind >= 0) & (ahead >= 0) & ~d.reset[d.outlines.indices] & (d.links.axis[d.outlines.indices] != 0)
        fair = may & may[behind] & may[ahead]
        may[self._end] = False
        self.at = np.flatnonzero(may)
        self.behind, self.ahead = behind[self.at], ahead[self.at]
        self._inner = fair[self.at]
        self._second_behind, self._second_ahead = behind[self.behind], ahead[self.ahead]
        # The dense points they lie at, and those before and after these.
        self._dense = d.dense[d.outlines.indices]
        before, after = np.roll(self._dense, 1), np.roll(self._dense, -1)
        before[self._begin], after[self._end] = self._dense[self._end - 1], self._dense[self._begin + 1]
        self._points = self._dense[self.at], before[self.at], after[self.at]

    def zigzag(self, moved: Points) -> Floats:
        """Return how far (b,) to move to smooth a zigzag from break to break: against the fourth difference, which arcs have none of."""
        around = (self.at, self.behind, self.ahead, self._second_behind, self._second_ahead)
        here, behind, ahead, before_that, after_that = (self._dense[i] + moved[i] for i in around)
        fourth = 6 * here - 4 * (behind + ahead) + before_that + after_that
        return np.where(self._inner, -(fourth * self.right(moved).conj()).real / 16, 0)

    def right(self, moved: Points) -> Points:
        """Return the unit directions (b,) to the right of the chain."""
        right = -1j * (self._dense[self.ahead] + moved[self.ahead] - self._dense[self.behind] - moved[self.behind])
        return np.asarray(right / np.maximum(np.abs(right), 1e-12))

    def moved(self, moved: Points, step: Floats, tolerance: float) -> Points:
        """Return how far (k,) entries lie from their dense points after steps (b,) to the right, as far as there is room for these."""
        right, here = self.right(moved), moved[self.at]
        point, before, after = self._points
        # From where on the dense outline has a break been moved sideways? From a place on the way to the next point.
        along = (here * right.conj()).imag
        way = np.where(along > 0, after, before) - point
        on_outline = way * np.clip(np.abs(along) / np.maximum(np.abs(way), 1e-12), 0, 1)
        off, most = ((here - on_outline) * right.conj()).real, FARTHEST * tolerance
        result = moved.copy()
        result[self.at] += (np.clip(off + step, -most, most) - off) * right
        result[self._end] = result[self._begin]
        return result


def towards_runs(d: Draft, first: Ints, last: Ints, farthest: Ints, excess: Floats, tolerance: float) -> Points:
    """Return how far (k,) from their dense points entries lie after pieces leant towards the entries of their runs that are farthest.

    A piece moves by its `excess` where that is; a break of two such pieces by the mean of what they ask for.
    """
    along = d.places[last] - d.places[first]
    length = np.maximum(np.abs(along), 1e-12)
    off = (d.dense[d.outlines.indices[farthest]] - d.places[first]) * along.conj() / length
    share = np.clip(off.real / length, 0, 1)
    by = -np.sign(off.imag) * excess / (share**2 + (1 - share) ** 2)
    size = len(d.moved)
    ends = np.concatenate([first, last])
    asked = _closed(d, np.bincount(ends, np.concatenate([by * (1 - share), by * share]), size))
    asking = _closed(d, np.bincount(ends, minlength=size))
    free = Sideways(d)
    return free.moved(d.moved, (asked / np.maximum(asking, 1))[free.at], tolerance)


def lenses(d: Draft) -> tuple[Floats, Floats]:
    """Return areas and widths (k,) at each break: the lenses that the pieces beside it cut off on their right, and their lengths."""
    first, last = d.pieces
    length = np.abs(d.places[last] - d.places[first])
    ends, size = np.concatenate([first, last]), len(d.moved)
    area, width = (np.bincount(ends, np.tile(part, 2), size) for part in (cut_off(d), length))
    return _closed(d, area), _closed(d, width)


def cut_off(d: Draft) -> Floats:
    """Return the areas (p,) that the pieces cut off on their right: what is between them and their runs."""
    first, last = d.pieces
    place, z = d.places, d.dense[d.outlines.indices]
    swept = np.concatenate([[0], np.cumsum(cross(z[:-1], z[1:]) / 2)])
    lens = swept[last] - swept[first] - cross(place[first], place[last]) / 2
    return np.asarray(lens + (cross(place[first], z[first]) + cross(z[last], place[last])) / 2)


def _closed(d: Draft, found: NDArray[Any]) -> Floats:
    """Add up what was found at the two ends of each ring, which are one break."""
    begin, end = _ring_ends(d)
    values = np.asarray(found, np.float64)
    values[begin] = values[end] = values[begin] + values[end]
    return values


def _ring_ends(d: Draft) -> tuple[Ints, Ints]:
    ring = d.links.rings
    return d.outlines.starts[:-1][ring], d.outlines.starts[1:][ring] - 1
