"""Dense outlines -> outlines with the wanted spacing, the topology kept.

A chain of many crossings is replaced by few *pieces*: chords between *breaks*, each standing for the run of dense points
between them. Coarsening is optimistic, and checked:

1. breaks are set evenly along each chain, then moved sideways so that the chords enclose the area of the outline;
2. a piece whose run leaves its chord by more than the tolerance leans towards it, see `leaning`; if that is not enough, it
   is split where it is farthest;
3. pieces that come too near to each other, or meet at too sharp an angle, are split too.

Where a piece is down to two neighbouring crossings and still too near to another one, its points go back to the middles of
their links. That is the safe end of the loop: chains with all crossings in the middle are half a pixel apart and turn by
at most a right angle at a time.

Why this keeps the topology: a chord and its run lie within the run's bulge of the chord; pieces are farther apart than
their bulges together, but for neighbours on a chain, which together turn no loop. So the runs can be pulled straight one
by one without one passing through another.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from img2tri.shapes.place.padded_chains import Points
from img2tri.shapes.simplify.clearance import crowded_pieces, sharp_pieces, to_segment
from img2tri.shapes.simplify.simplification import Draft
from img2tri.shapes.simplify.vertex_offsets import towards_runs
from img2tri.types import Ints

LEANS, ENOUGH = 4, 0.95  # how often pieces lean towards their runs at first, to come within this share of the tolerance
LEAST_MOVE = 1e-4  # px
SHORT = 0.3  # px, pieces shorter than this are not left


def settle(d: Draft, *, tolerance: float) -> Draft:
    """Split pieces until each is within `tolerance` px of its run, clear of the others, and not too sharp."""
    d, leans = _copied(d), LEANS
    while True:
        _split_bulging(d, tolerance, leans)
        leans -= 1  # so that it ends: a break that leans away from its point may have to return there
        if _return_to_points(d, tolerance):
            continue
        first, last = d.pieces
        fresh = d.tested[first] != last
        if not fresh.any():
            return d
        conflicting = crowded_pieces(d, first, last, fresh) | sharp_pieces(d, first, last, fresh)
        short = np.abs(d.places[last] - d.places[first]) < SHORT
        d.tested[first] = last
        divisible = last - first > 1
        _split(d, first[conflicting & divisible], last[conflicting & divisible])
        stuck = (conflicting | short) & ~divisible
        _reset(d, np.concatenate([first[stuck], last[stuck]]), tolerance)


def refine(d: Draft, places: Points, *, within: float, tolerance: float) -> Draft:
    """Split the pieces within `within` px of some places; those that cannot be split go back to the middle."""
    from scipy.spatial import cKDTree

    d = _copied(d)
    first, last = d.pieces
    z = d.places
    near = np.zeros(len(z), bool)
    tree = cKDTree(np.stack([places.real, places.imag], axis=1))
    distance, _ = tree.query(np.stack([z.real, z.imag], axis=1), distance_upper_bound=within)
    near[np.isfinite(distance)] = True
    count = np.concatenate([[0], np.cumsum(near)])
    hit = count[last + 1] > count[first]
    divisible = last - first > 1
    _split(d, first[hit & divisible], last[hit & divisible])
    stuck = hit & ~divisible
    _reset(d, np.concatenate([first[stuck], last[stuck]]), tolerance)
    return d


def _copied(d: Draft) -> Draft:
    """Return a draft whose arrays may be changed."""
    names = ("reset", "breaks", "moved", "measured", "tested", "bulge")
    return replace(d, **{name: getattr(d, name).copy() for name in names})


def _split_bulging(d: Draft, tolerance: float, leans: int) -> None:
    """Measure new pieces; those that leave the tolerance lean towards their runs so often, then are split, until there are none."""
    z = d.dense[d.outlines.indices]
    for attempt in itertools.count():
        first, last = d.pieces
        fresh = d.measured[first] != last
        first, last = first[fresh], last[fresh]
        if not len(first):
            return
        # Points on the way to the middle of their link are still on it, others may have left it sideways.
        astray = [np.where(d.reset[d.outlines.indices[end]], 0, np.abs(d.moved[end])) for end in (first, last)]
        inner = last - first - 1
        which = np.repeat(np.arange(len(first)), inner)
        at = first[which] + 1 + np.arange(len(which)) - np.repeat(np.cumsum(inner) - inner, inner)
        a, b = z[first] + d.moved[first], z[last] + d.moved[last]
        distance = to_segment(z[at], a[which], b[which])
        d.bulge[first] = np.maximum(*astray)
        d.measured[first] = last
        some = np.flatnonzero(inner)
        if not len(some):
            return
        worst = np.maximum.reduceat(distance, (np.cumsum(inner) - inner)[some])
        d.bulge[first[some]] = np.maximum(d.bulge[first[some]], worst)
        highest = np.zeros(len(first))
        highest[some] = worst
        excess = highest - ENOUGH * tolerance
        if attempt < leans and (highest > tolerance).any():
            farthest = np.flatnonzero((distance == highest[which]) & (excess[which] > 0))
            far = which[farthest]
            if _moved(d, towards_runs(d, first[far], last[far], at[farthest], excess[far], tolerance), first[excess > 0]):
                continue
        split = at[(distance == highest[which]) & (highest[which] > tolerance)]
        d.breaks[split] = True


def _moved(d: Draft, moved: Points, doubtful: Ints) -> bool:
    """Move breaks; their pieces, and those that begin at doubtful entries, are to be tested again. False if nothing moves."""
    far = np.abs(moved - d.moved) > LEAST_MOVE
    if not far.any():
        return False
    d.moved[:] = moved
    first, last = d.pieces
    stale = np.concatenate([first[far[first] | far[last]], doubtful])
    d.measured[stale] = d.tested[stale] = -1
    return True


def _return_to_points(d: Draft, tolerance: float) -> bool:
    """Let breaks that were moved along their chain go back, where their own point lies too far from the pieces they end."""
    astray = (np.abs(d.moved) > tolerance) & ~d.reset[d.outlines.indices]
    first, last = d.pieces
    ends = astray[first] | astray[last]
    first, last = first[ends], last[ends]
    if not len(first):
        return False
    z, place = d.dense[d.outlines.indices], d.places
    distance = np.full(len(z), np.inf)
    for end in (first, last):
        distance[end] = np.minimum(distance[end], to_segment(z[end], place[first], place[last]))
    back = astray & (distance > tolerance) & np.isfinite(distance)
    d.moved[back] = 0
    stale = first[back[first] | back[last]]
    d.measured[stale] = d.tested[stale] = -1
    return bool(back.any())


def _split(d: Draft, first: Ints, last: Ints) -> None:
    """Split pieces in the middle."""
    d.breaks[(first + last) // 2] = True


def _reset(d: Draft, entries: Ints, tolerance: float) -> None:
    """Let points go back to the middle of their links, as far as the tolerance allows; their pieces are to be tested again."""
    chosen = np.zeros(len(d.dense), bool)
    chosen[d.outlines.indices[entries]] = True
    touched = np.flatnonzero((chosen & ~d.kept)[d.outlines.indices])
    at = d.outlines.indices[touched]
    way = d.links.middle[at] - d.dense[at]
    way *= np.minimum(1, tolerance / np.maximum(np.abs(way), 1e-12))
    # Those that have gone back go on if there is more tolerance than there was.
    farther = ~d.reset[at] | (np.abs(way) > np.abs(d.moved[touched]) + LEAST_MOVE)
    touched, way = touched[farther], way[farther]
    if not len(touched):
        return
    d.reset[d.outlines.indices[touched]] = True
    d.moved[touched] = way
    first, last = d.pieces
    new = np.zeros(len(d.moved), bool)
    new[touched] = True
    count = np.concatenate([[0], np.cumsum(new)])
    stale = first[count[last + 1] > count[first]]
    d.measured[stale] = d.tested[stale] = -1
