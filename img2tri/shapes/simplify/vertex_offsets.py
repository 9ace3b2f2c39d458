"""Offset the kept vertices along the normal so that few chords approximate the outline.

A chord between two points of an outline lies on one side of its bends, and it swings with every step of the pixels that its ends
happen to lie on. A vertex may leave its dense point instead, as in polyline approximation with free vertices: half of the area between
chord and arc on either side is taken up, a zigzag from vertex to vertex is smoothed, a chord is moved towards the part of its arc that
is too far from it. So a chord need not be split for what a little offset cures, and short chords beside long ones are what triangles
suffer from most.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, Points, as_rows, cross
from img2tri.shapes.simplify.simplification import Simplification

MOST_OFFSET = 0.8  # of the tolerance: how far along the normal a vertex may be offset
SNAPPED_SLACK = 0.12  # px: how far along the normal a snapped vertex may be offset
FAIRINGS = 6  # how often a zigzag is smoothed
FAIR = 0.5  # of `MOST_OFFSET`: how far a vertex may go for that
CHORD_SHARE = 0.3  # of the shorter chord beside it, times `MOST_OFFSET`: the same; else small rings would shrink to a point


def offset_vertices(s: Simplification, *, tolerance: float, keep_area: bool = True) -> Simplification:
    """Smooth zigzags of vertices; to keep areas, let each vertex take up half of the areas between the chords beside it and their arcs."""
    free, offset = NormalOffsets(s), s.offset
    most = np.minimum(FAIR * tolerance, CHORD_SHARE * free.shorter)
    for _ in range(FAIRINGS):
        offset = free.shifted(offset, free.zigzag(offset), most)
    s = replace(s, offset=offset)
    if keep_area:
        area, width = areas_beside(s)
        s = replace(s, offset=free.shifted(offset, area[free.at] / width[free.at], tolerance))
    return s


class NormalOffsets:
    """The vertices that may be offset: those on a dual edge, between two others. Both ends of a ring are one vertex, known by the first.

    The offsets of all entries (k,), as in `Simplification.offset`, are given to each method and returned anew.

    Attributes
    ----------
    at
        (b,) int64, their entries.
    behind, ahead
        (b,) int64, the vertices before and after them; rings go round.
    shorter
        (b,) float64, the distance from the dense point to that of the nearer of the two.
    """

    def __init__(self, s: Simplification, *, snapped: bool = False) -> None:
        # All by their rank among the kept entries, of which there are many times fewer than entries.
        kept = s.kept.nonzero()[0]
        first, last = kept.searchsorted(s.chains.first), kept.searchsorted(s.chains.last)
        begin, end = first[s.chains.rings], last[s.chains.rings]
        behind, ahead = np.arange(-1, len(kept) - 1), np.arange(1, len(kept) + 1)
        behind[first], ahead[last] = -1, -1
        behind[begin], ahead[end] = behind[end], ahead[begin]
        point = s.chains.indices[kept]
        may = (behind >= 0) & (ahead >= 0) & (snapped | ~s.snapped[point]) & (s.dual_edges.vector[point] != 0)
        between = may & may[behind] & may[ahead]
        moves = may[begin]
        may[end] = False
        chosen = may.nonzero()[0]
        self.at, point, self._inner = kept[chosen], point[chosen], between[chosen]
        behind_it, ahead_of_it = behind[chosen], ahead[chosen]
        self.behind, self.ahead = kept[behind_it], kept[ahead_of_it]
        self._second_behind, self._second_ahead = kept[behind[behind_it]], kept[ahead[ahead_of_it]]
        self._begin, self._end = s.chains.ring_ends
        # The dense points they lie at, and those before and after these; a ring begins after the last but one of its entries.
        before = self.at - 1
        before[np.searchsorted(self.at, self._begin[moves])] = self._end[moves] - 1
        self._dense = s.dense
        dense = self._dense[self.at]
        self._ways = self._dense[self.at + 1] - dense, self._dense[before] - dense
        self._lengths = [np.maximum(np.abs(way), 1e-12) for way in self._ways]
        self.shorter = np.minimum(*(np.abs(self._dense[beside] - dense) for beside in (self.ahead, self.behind)))
        self._snapped = s.snapped[point].nonzero()[0]
        self._rest = s.dual_edges.blunt_middle[point[self._snapped]] - dense[self._snapped]

    def zigzag(self, offset: Points) -> Floats:
        """Return how far (b,) to move to smooth a zigzag from vertex to vertex: against the fourth difference, which arcs have none of."""
        around = (self.at, self.behind, self.ahead, self._second_behind, self._second_ahead)
        here, behind, ahead, before_that, after_that = (self._dense[i] + offset[i] for i in around)
        fourth = 6 * here - 4 * (behind + ahead) + before_that + after_that
        return np.where(self._inner, -(fourth * self.right(offset).conj()).real / 16, 0)

    def right(self, offset: Points) -> Points:
        """Return the unit directions (b,) to the right of the chain."""
        right: Points = -1j * (self._dense[self.ahead] + offset[self.ahead] - self._dense[self.behind] - offset[self.behind])
        as_rows(right)[:] *= (1 / np.maximum(np.abs(right), 1e-12))[:, None]
        return right

    def shifted(self, offset: Points, step: Floats, tolerance: float | Floats) -> Points:
        """Return the offsets of all entries (k,) after steps (b,) to the right, as far as the tolerance allows these."""
        right, here, snapped = self.right(offset), offset[self.at], self._snapped
        # From where on the dense outline is a vertex offset? From a place on the way to the next point; or from where it was snapped to.
        along = (here * right.conj()).imag
        (after, before), (to_after, to_before) = self._ways, self._lengths
        start = np.where(along > 0, after, before) * np.minimum(np.abs(along) / np.where(along > 0, to_after, to_before), 1)
        limit = np.full(len(here), MOST_OFFSET * tolerance)
        most = limit.copy()
        start[snapped], most[snapped] = self._rest, SNAPPED_SLACK
        off = ((here - start) * right.conj()).real
        new = here + (np.minimum(np.maximum(off + step, -most), most) - off) * right
        if len(snapped):
            stays = snapped[np.abs(new[snapped]) > np.maximum(np.abs(here[snapped]), limit[snapped])]
            new[stays] = here[stays]
        result = offset.copy()
        result[self.at] = new
        result[self._end] = result[self._begin]
        return result


def offset_towards_arcs(s: Simplification, first: Ints, last: Ints, farthest: Ints, excess: Floats, tolerance: float) -> Points:
    """Return the offsets of all entries (k,) after chords moved towards the farthest entries of their arcs.

    A chord moves by its `excess` where that is; a vertex of two such chords by the mean of what they ask for.
    """
    along = s.places[last] - s.places[first]
    length = np.maximum(np.abs(along), 1e-12)
    off = (s.dense[farthest] - s.places[first]) * along.conj() / length
    share = np.clip(off.real / length, 0, 1)
    by = -np.sign(off.imag) * excess / (share**2 + (1 - share) ** 2)
    size = len(s.offset)
    ends = np.concatenate([first, last])
    asked = _closed(s, np.bincount(ends, np.concatenate([by * (1 - share), by * share]), size))
    asking = _closed(s, np.bincount(ends, minlength=size))
    free = NormalOffsets(s)
    return free.shifted(s.offset, (asked / np.maximum(asking, 1))[free.at], tolerance)


def areas_beside(s: Simplification) -> tuple[Floats, Floats]:
    """Return areas and widths (k,) at each vertex: the chord-arc areas of the chords beside it, and their lengths."""
    first, last = s.chords
    length = np.abs(s.places[last] - s.places[first])
    ends, size = np.concatenate([first, last]), len(s.offset)
    area, width = (np.bincount(ends, np.tile(part, 2), size) for part in (chord_arc_areas(s), length))
    return _closed(s, area), _closed(s, width)


def chord_arc_areas(s: Simplification) -> Floats:
    """Return the chord-arc areas (c,): what each chord cuts off on its right, between itself and its arc."""
    first, last = s.chords
    place, z = s.places, s.dense
    swept = np.concatenate([[0], np.cumsum(cross(z[:-1], z[1:]) / 2)])
    between = swept[last] - swept[first] - cross(place[first], place[last]) / 2
    return np.asarray(between + (cross(place[first], z[first]) + cross(z[last], place[last])) / 2)


def _closed(s: Simplification, found: NDArray[Any]) -> Floats:
    """Add up what was found at the two ends of each ring, which are one vertex."""
    begin, end = s.chains.ring_ends
    values = np.asarray(found, np.float64)
    values[begin] = values[end] = values[begin] + values[end]
    return values
