"""Polyline simplification within a tolerance, the topology kept: chords are split until each is good enough.

Simplification is optimistic, and checked:

1. vertices are kept evenly along each chain, then offset along the normal so that the chords enclose the area of the outline;
2. a chord whose arc leaves it by more than the tolerance is moved towards the arc, see `vertex_offsets`; if that is not enough, it is
   split where the arc is farthest, as Douglas and Peucker do ("Algorithms for the reduction of the number of points required to
   represent a digitized line or its caricature", 1973, DOI 10.3138/FM57-6770-U75U-7727);
3. chords that come too near to each other, or meet at too sharp an angle, are split too.

Where a chord is down to two neighbouring crossings and still too near to another one, its points are *snapped*: they go back to the
middles of their crack edges. That is the safe end of the loop: chains with all crossings in the middle are half a pixel apart and turn
by at most a right angle at a time.

Why this keeps the topology: a chord and its arc lie within the arc's deviation from the chord; chords are farther apart than
their deviations together, but for neighbours on a chain, which together turn no loop. So the arcs can be pulled straight one
by one without one passing through another.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows, runs
from img2tri.errors import bounded
from img2tri.shapes.simplify.clearance import crowded_chords, sharp_chords, to_segment
from img2tri.shapes.simplify.simplification import SAME_PLACE, Simplification
from img2tri.shapes.simplify.vertex_offsets import offset_towards_arcs

LEANS, ENOUGH = 4, 0.95  # how often chords are moved towards their arcs at first, to come within this share of the tolerance
LEAST_MOVE = 1e-4  # px: vertices that would move by less stay
SHORTEST_PART = 1.0  # px, conflicting chords are split into shorter parts only after their ends are snapped
SHORTEST_CHORD = 0.3  # px, chords shorter than this are not left
MOST_ROUNDS = 1000  # of splitting; thirty are many


def enforce_tolerance(s: Simplification, *, tolerance: float, passed: Simplification | None = None) -> Simplification:
    """Split chords until each is within `tolerance` px of its arc, clear of the others, and not too sharp.

    Parameters
    ----------
    s
        What is to be made good enough.
    tolerance
        In px.
    passed
        A result of this function for the same outlines: chords that it has too are not tested again, but against new ones.
    """
    return _Loop(s, tolerance, passed).run()


def split_near(s: Simplification, places: Points, *, within: float, tolerance: float) -> Simplification:
    """Split the chords within `within` px of some places; the ends of those that cannot be split are snapped."""
    from scipy.spatial import cKDTree

    first, last = s.chords
    distance, _ = cKDTree(as_rows(places)).query(as_rows(s.places), distance_upper_bound=within)
    hit = _any_between(np.isfinite(np.asarray(distance)), first, last)
    divisible = last - first > 1
    s = _split(s, first[hit & divisible], last[hit & divisible])
    stuck = hit & ~divisible
    return _snap(s, np.concatenate([first[stuck], last[stuck]]), tolerance)


def deviations(s: Simplification, first: Ints, last: Ints) -> Floats:
    """Greatest distance between each chord and its arc, in px, the dense points of its ends included."""
    found, *_ = _measure(s, first, last)
    return found


class _Loop:
    """A simplification in the making, and what is known of its chords, each by its first entry.

    Attributes
    ----------
    measured, tested
        (k,) int64, the last entry of the chord whose deviation is known, that passed all tests; -1 if there is none.
    deviation
        (k,) float64, of each measured chord.
    """

    def __init__(self, s: Simplification, tolerance: float, passed: Simplification | None) -> None:
        k = len(s.kept)
        self.s, self.tolerance, self.leans = s, tolerance, LEANS
        self.measured, self.tested, self.deviation = np.full(k, -1), np.full(k, -1), np.zeros(k)
        if passed is not None:
            first, last = _in_both(s, passed)
            self.measured[first] = self.tested[first] = last
            self.deviation[first] = deviations(s, first, last)

    def run(self) -> Simplification:
        for _ in bounded("tolerance of outlines", MOST_ROUNDS):
            self._split_deviating()
            self.leans -= 1  # so that it ends: a vertex that is moved away from its point may have to return there
            if self._return_to_points():
                continue
            s, (first, last) = self.s, self.s.chords
            fresh = self.tested[first] != last
            if not fresh.any():
                break
            conflicting = crowded_chords(s, first, last, self.deviation[first], fresh) | sharp_chords(s, first, last, fresh)
            self.tested[first] = last
            divisible = last - first > 1
            stuck = conflicting | (np.abs(s.places[last] - s.places[first]) < SHORTEST_CHORD)
            stuck &= ~divisible
            if not (conflicting | stuck).any():
                break
            early, doubtful = np.zeros((2, len(first)), bool), conflicting.nonzero()[0]
            early[:, doubtful] = self._snapped_first(first[doubtful], last[doubtful])
            split = conflicting & divisible & ~early.any(axis=0)
            self.s = _split(s, first[split], last[split])
            ends = [end[stuck | (conflicting & snapped)] for end, snapped in zip((first, last), early, strict=True)]
            self._change(_snap(self.s, np.concatenate(ends), self.tolerance))
        return self.s

    def _snapped_first(self, first: Ints, last: Ints) -> Bools:
        """Tell which ends (2, c) of chords are to be snapped before these are split, if they conflict.

        Junctions, as a wedge that is sharp where its sides meet opens half a pixel further on; and the ends of chords so short that
        pixels alone tell how they run.
        """
        s, ends = self.s, np.stack([first, last])
        middle = s.dense[(first + last) // 2]
        tiny = (np.abs(middle - s.places[ends]) < SHORTEST_PART).any(axis=0)
        point = s.chains.indices[ends]
        all_the_way = np.abs(s.dual_edges.blunt_middle[point] - s.dense[ends]) <= self.tolerance
        return np.asarray((tiny | s.dual_edges.is_junction[point]) & all_the_way & ~s.snapped[point] & ~s.pinned[point])

    def _split_deviating(self) -> None:
        """Measure new chords. Those beyond the tolerance are moved towards their arcs so often, then split, until there are none."""
        for attempt in range(max(self.leans, 0) + len(self.s.kept) + 1):  # each split shortens an arc
            s, (first, last) = self.s, self.s.chords
            fresh = self.measured[first] != last
            first, last = first[fresh], last[fresh]
            if not len(first):
                return
            self.deviation[first], which, at, distance, worst = _measure(s, first, last)
            self.measured[first] = last
            if not (worst > self.tolerance).any():
                return
            excess = worst - ENOUGH * self.tolerance
            if attempt < self.leans:
                farthest = ((distance == worst[which]) & (excess[which] > 0)).nonzero()[0]
                far = which[farthest]
                offset = offset_towards_arcs(s, first[far], last[far], at[farthest], excess[far], self.tolerance)
                if self._move(offset, first[excess > 0]):
                    continue
            kept = s.kept.copy()
            kept[at[(distance == worst[which]) & (worst[which] > self.tolerance)]] = True
            self.s = replace(s, kept=kept)

    def _move(self, offset: Points, doubtful: Ints) -> bool:
        """Move vertices; their chords, and those that begin at doubtful entries, are to be tested again. False if nothing moves."""
        far = np.abs(offset - self.s.offset) > LEAST_MOVE
        if not far.any():
            return False
        self.s = replace(self.s, offset=offset)
        first, last = self.s.chords
        self._forget(np.concatenate([first[far[first] | far[last]], doubtful]))
        return True

    def _return_to_points(self) -> bool:
        """Let vertices that were moved along their chain go back, where their own point lies too far from the chords they end."""
        s, (first, last) = self.s, self.s.chords
        at = s.kept.nonzero()[0]
        at = at[np.abs(s.offset[at]) > self.tolerance]
        at = at[~s.snapped[s.chains.indices[at]]]
        if not len(at):
            return False
        astray = np.zeros(len(s.kept), bool)
        astray[at] = True
        ends = astray[first] | astray[last]
        first, last = first[ends], last[ends]
        place, distance = s.places, np.full(len(s.dense), np.inf)
        for end in (first, last):
            distance[end] = np.minimum(distance[end], to_segment(s.dense[end], place[first], place[last]))
        back = astray & (distance > self.tolerance) & np.isfinite(distance)
        self.s = replace(s, offset=np.where(back, 0, s.offset))
        self._forget(first[back[first] | back[last]])
        return bool(back.any())

    def _change(self, s: Simplification) -> None:
        """Take over a simplification of which vertices were snapped."""
        first, last = s.chords
        if s is self.s:
            return
        new = (s.offset != self.s.offset) | (s.snapped_entries & ~self.s.snapped_entries)
        self.s = s
        self._forget(first[_any_between(new, first, last)])

    def _forget(self, first: Ints) -> None:
        self.measured[first] = self.tested[first] = -1


def _measure(s: Simplification, first: Ints, last: Ints) -> tuple[Floats, Ints, Ints, Floats, Floats]:
    """Measure chords: (c,) deviations; of all inner entries of their arcs (i,) chord, entry, distance; (c,) the greatest distance."""
    # Points on the way to the middle of their crack edge are still on it, others may have left it sideways.
    off = [np.where(s.snapped[s.chains.indices[end]], 0, np.abs(s.offset[end])) for end in (first, last)]
    inner = last - first - 1
    which, place = runs(inner)
    at = first[which] + 1 + place
    a, b = s.dense[first] + s.offset[first], s.dense[last] + s.offset[last]
    distance = to_segment(s.dense[at], a[which], b[which])
    worst, some = np.zeros(len(first)), inner.nonzero()[0]
    if len(some):
        worst[some] = np.maximum.reduceat(distance, (np.cumsum(inner) - inner)[some])
    return np.maximum(np.maximum(*off), worst), which, at, distance, worst


def _in_both(s: Simplification, other: Simplification) -> tuple[Ints, Ints]:
    """Chords that two simplifications of the same outlines share, their ends at the same places."""
    first, last = s.chords
    follows = np.full(len(s.kept), -1)
    follows[other.chords[0]] = other.chords[1]
    same: Bools = (np.abs(other.offset - s.offset) < SAME_PLACE) & (other.snapped_entries == s.snapped_entries)
    both = (follows[first] == last) & same[first] & same[last]
    return first[both], last[both]


def _split(s: Simplification, first: Ints, last: Ints) -> Simplification:
    """Split chords in the middle."""
    if not len(first):
        return s
    kept = s.kept.copy()
    kept[(first + last) // 2] = True
    return replace(s, kept=kept)


def _snap(s: Simplification, entries: Ints, tolerance: float) -> Simplification:
    """Let points go back to the middles of their crack edges, as far as the tolerance allows."""
    if not len(entries):
        return s
    indices = s.chains.indices
    chosen = np.zeros(len(s.snapped), bool)
    chosen[indices[entries]] = True
    touched = (chosen & ~s.pinned)[indices].nonzero()[0]
    at = indices[touched]
    way = s.dual_edges.blunt_middle[at] - s.dense[touched]
    whole = np.abs(way) <= tolerance
    way *= np.minimum(1, tolerance / np.maximum(np.abs(way), 1e-12))
    # Those that have gone back go on if there is more tolerance than there was, and return if they were moved since.
    moved = whole & (np.abs(way - s.offset[touched]) > LEAST_MOVE)
    farther = ~s.snapped[at] | moved | (np.abs(way) > np.abs(s.offset[touched]) + LEAST_MOVE)
    touched, way = touched[farther], way[farther]
    snapped, offset = s.snapped.copy(), s.offset.copy()
    snapped[indices[touched]] = True
    offset[touched] = way
    return replace(s, snapped=snapped, offset=offset)


def _any_between(marks: Bools, first: Ints, last: Ints) -> Bools:
    """Tell from which first to which last entry, both included, there is a mark."""
    count = np.concatenate([[0], np.cumsum(marks)])
    return np.asarray(count[last + 1] > count[first])
