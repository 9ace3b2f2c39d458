"""Which chords come too near to each other, or meet at too sharp an angle.

Chords stand for arcs of dense points that deviate from them by so much. Two chords are clear of each other if they are farther apart
than both deviations, and a gap. Only pairs with at least one changed, *fresh* chord can conflict anew, so only what is beside fresh
chords is looked at.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, blocks, cross
from img2tri.cell_lists import cells, in_cells_beside, pairs_across, pairs_beside
from img2tri.shapes.simplify.simplification import Simplification

GAP = 0.25  # px, the least distance kept between chords, over their deviations
CHORDS_AT_ONCE = 1 << 12  # whose pairs are looked at together: what lies near is in the cache
FEW_BOXES = 1 << 16  # pairs of boxes: fewer are all looked at at once


def sharp_chords(s: Simplification, first: Ints, last: Ints, fresh: Bools) -> Bools:
    """Tell which chords meet another one at a sharp angle, at least one of the two being fresh."""
    n, at, place = len(first), s.chains.indices, s.places
    touched = np.zeros(len(s.snapped), bool)
    touched[at[first[fresh]]] = touched[at[last[fresh]]] = True
    # All ends of chords at these points, those at the same point one after the other.
    point = at[np.concatenate([first, last])]
    end = touched[point].nonzero()[0]
    end = end[np.argsort(point[end], kind="stable")]
    point, chord = point[end], end % n
    heading = (place[last[chord]] - place[first[chord]]) * np.where(end < n, 1, -1)
    length = np.abs(heading)
    sharp = np.zeros(n, bool)
    for step in range(1, len(end)):
        one = (point[step:] == point[:-step]).nonzero()[0]
        if not len(one):
            break
        other = one + step
        narrow = (heading[one] * heading[other].conj()).real > np.cos(np.radians(s.least_angle)) * length[one] * length[other]
        sharp[chord[one[narrow]]] = sharp[chord[other[narrow]]] = True
    return sharp


def crowded_chords(s: Simplification, first: Ints, last: Ints, deviation: Floats, fresh: Bools) -> Bools:
    """Tell which chords come too near to another one that is not their neighbour, at least one of the two being fresh."""
    at, place = s.chains.indices, s.places
    a, b = place[first], place[last]
    i, j = _within(a, b, GAP / 2 + deviation, fresh)
    head, tail = at[first], at[last]
    apart = (head[i] != head[j]) & (head[i] != tail[j]) & (tail[i] != head[j]) & (tail[i] != tail[j])
    i, j = i[apart], j[apart]
    crowded = np.zeros(len(first), bool)
    if not len(i):
        return crowded
    distance = _distance(a[i], b[i], a[j], b[j])
    near = (distance < GAP + deviation[i] + deviation[j]).nonzero()[0]
    i, j, distance = i[near], j[near], distance[near]
    # Along the same chain two chords are only near if the way between them is long for that.
    if len(i):
        long = _way_between(s, first, last, i, j) > np.maximum(4 * distance, 1.0)
        crowded[i[long]] = crowded[j[long]] = True
    return crowded


def _within(a: Points, b: Points, reach: Floats, fresh: Bools) -> tuple[Ints, Ints]:
    """Pairs of segments whose boxes, each widened by its `reach`, meet, at least one of them fresh; each pair once."""
    wide, high = np.abs((b - a).real) / 2 + reach, np.abs((b - a).imag) / 2 + reach
    middle, own = (a + b) / 2, fresh.nonzero()[0]
    x, y = middle.real.copy(), middle.imag.copy()
    if len(own) * len(a) <= FEW_BOXES:
        left, right, low, top = x - wide, x + wide, y - high, y + high
        meet = (left[own, None] <= right) & (left <= right[own, None]) & (low[own, None] <= top) & (low <= top[own, None])
        i, j = (meet & (~fresh | (own[:, None] < np.arange(len(a))))).nonzero()
        return own[i], j
    found = [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    for i, j in _near(middle, np.maximum(wide, high), fresh):
        if len(own) < len(a):
            doubtful = fresh[i] | fresh[j]
            i, j = i[doubtful], j[doubtful]
        meet = np.abs(x[i] - x[j]) <= wide[i] + wide[j]
        i, j = i[meet], j[meet]
        meet = np.abs(y[i] - y[j]) <= high[i] + high[j]
        found.append((i[meet], j[meet]))
    i, j = (np.concatenate(part) for part in zip(*found, strict=True))
    return i, j


def _near(middle: Points, half: Floats, fresh: Bools) -> Iterator[tuple[Ints, Ints]]:
    """Yield pairs of squares around their middles that may meet, one of them fresh, each pair once: found in grids of cells.

    There is a grid for each class of sizes, for pairs whose larger square is of that class; its cells are as wide as the widest pair is
    apart.
    """
    size = np.ceil(np.log2(half) / 2)  # classes of a ratio of 4
    for each in np.unique(size).tolist():
        cell, above = cells(middle, 2 * float(half[size == each].max()))
        chosen = size <= each
        if not fresh.all():
            chosen &= in_cells_beside(cell, above, fresh)
        order = chosen.nonzero()[0]
        order = order[np.argsort(cell[order])]
        large = size[order] == each
        own, smaller = order[large], order[~large]
        at, beside = cell[own], cell[smaller]
        for some in blocks(len(own), CHORDS_AT_ONCE):
            yield pairs_beside(own, at, above, some)
            if len(smaller):
                yield pairs_across(own[some], at[some], smaller, beside, above)


def _distance(a: Points, b: Points, c: Points, d: Points) -> Floats:
    """Distance between segments from a to b and from c to d; 0 where they cross."""
    crossing = cross(b - a, c - a) * cross(b - a, d - a) < 0
    crossing &= cross(d - c, a - c) * cross(d - c, b - c) < 0
    ends = to_segment(np.concatenate([a, b, c, d]), np.concatenate([c, c, a, a]), np.concatenate([d, d, b, b]))
    return np.where(crossing, 0, ends.reshape(4, -1).min(axis=0))


def to_segment(p: Points, a: Points, b: Points) -> Floats:
    """Distance of points to segments from a to b."""
    along, off = b - a, p - a
    square = np.maximum(along.real**2 + along.imag**2, 1e-300)
    share = np.minimum(np.maximum((off.real * along.real + off.imag * along.imag) / square, 0), 1)
    return np.asarray(np.abs(off - share * along))


def _way_between(s: Simplification, first: Ints, last: Ints, i: Ints, j: Ints) -> Floats:
    """Length of the chain between two chords, infinite if they lie on different chains."""
    z, starts, chain = s.dense, s.chains.starts, s.chains.chain
    arc = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    early, late = np.minimum(first[i], first[j]), np.maximum(first[i], first[j])
    end = np.where(first[i] < first[j], last[i], last[j])
    way = arc[late] - arc[end]
    on = chain[early]
    around = arc[starts[on + 1] - 1] - arc[starts[on]] - (arc[np.maximum(last[i], last[j])] - arc[early])
    way = np.where(s.chains.rings[on], np.minimum(way, around), way)
    return np.where(chain[early] == chain[late], way, np.inf)
