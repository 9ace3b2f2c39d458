"""Pixels that are not square: dense outlines -> the same with more points, where long crack edges turn.

In the safe end of simplification outlines run through the middles of crack edges, and turn by right angles at most where pixels are
square. Where a pixel is five times as wide as high, the tip of a row of them would be as sharp as 22 degrees. So each long crack edge gets
one more point half a small side of a pixel before each corner of pixels at which the outline turns::

    +----------x----------+          +-o--------x--------o-+
                          x    ->                          x       x middles, o the points that are added
    +----------x----------+          +-o--------x--------o-+

And where an outline runs along the long sides of pixels, its segments are divided, so that there are points enough to refine it by. The
outline itself stays as it is: added points lie on its segments.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import ChainIndex, Points, as_complex, as_rows, runs
from img2tri.shapes.trace.dual_edges import DualEdges
from img2tri.types import Outlines

LONG = 1.2  # small sides of a pixel, from which a crack edge is long
SHORT = 1.5  # small sides of a pixel: segments up to that are not divided
INNER = 0.1  # of a segment: an added point comes no nearer to its ends


def with_turning_points(outlines: Outlines, dual_edges: DualEdges, *, on_frame: bool = True) -> tuple[Outlines, DualEdges]:
    """Return outlines and dual edges with points added where long crack edges turn; the same where pixels are square.

    Without `on_frame` none are added along the frame of the image.
    """
    small = min(dual_edges.pixel.real, dual_edges.pixel.imag)
    if max(dual_edges.pixel.real, dual_edges.pixel.imag) <= LONG * small or not len(dual_edges.crossed):
        return outlines, dual_edges
    chains, n, k = dual_edges.chains, len(dual_edges.middle), len(dual_edges.crossed)
    at, z = chains.indices, as_complex(outlines.points)
    half = np.concatenate([dual_edges.corner_after - dual_edges.middle[:k], np.zeros(n - k)])  # of each crack edge
    long = dual_edges.slides & (np.abs(half) > LONG * small / 2)
    # An entry gets a point before it where the chain turns on the way to it from another crossing, and after it likewise.
    turns = np.abs((half[at[:-1]] * half[at[1:]].conj()).imag) > 0
    turns &= np.diff(chains.chain) == 0
    before, after = np.append(False, turns) & long[at], np.append(turns, False) & long[at]
    count = 1 + before + after
    begin = np.cumsum(count) - count
    main, first, last = begin + before, begin[before], (begin + count - 1)[after]

    # Who is at each new entry, and where it lies.
    size = int(count.sum())
    whose, middle, place = np.empty(size, np.int64), np.empty(size, np.complex128), np.empty(size, np.complex128)
    whose[main], middle[main], place[main] = at, dual_edges.middle[at], z[at]
    for new, own, other, way in ((first, before.nonzero()[0], -1, -1.0), (last, after.nonzero()[0], 1, 1.0)):
        point, beside = at[own], at[own + other]
        along: Points = np.asarray(way * half[point] / np.abs(half[point]), np.complex128)
        whose[new], middle[new] = point, dual_edges.middle[point] + way * half[point] - small / 2 * along
        place[new] = _on_segment(z[point], z[beside], middle[new], along)
    entries = ChainIndex(whose, np.append(begin, size)[chains.starts], chains.rings)
    return _renumbered(outlines, dual_edges, *_divided(entries, middle, place, small, dual_edges, on_frame))


def _divided(
    entries: ChainIndex, middle: Points, place: Points, small: float, dual_edges: DualEdges, on_frame: bool
) -> tuple[ChainIndex, Points, Points]:
    """Divide long segments into such of a small side of a pixel; what is between two nodes is left as it is."""
    slides, k = dual_edges.slides, len(dual_edges.crossed)
    step = np.abs(np.diff(place)) * (np.diff(entries.chain) == 0)
    slides_some = slides[entries.indices[:-1]] | slides[entries.indices[1:]]
    some = (np.minimum(entries.indices[:-1], entries.indices[1:]) < k) & (slides_some | on_frame)
    parts = np.append(np.where(some & (step > SHORT * small), np.ceil(step / small), 1), 1).astype(np.int64)
    entry, number = runs(parts)
    share = number / parts[entry]
    after = np.minimum(entry + 1, len(place) - 1)

    def between(z: Points) -> Points:
        return np.asarray(np.where(number == 0, z[entry], (1 - share) * z[entry] + share * z[after]))

    # Points that are added belong to the crossing at the nearer end.
    nearer = np.where((entries.indices[entry] < k) & ((share < 0.5) | (entries.indices[after] >= k)), entry, after)
    whose = entries.indices[np.where(number == 0, entry, nearer)]
    starts = np.append(np.cumsum(parts) - parts, parts.sum())[entries.starts]
    return ChainIndex(whose, starts, entries.rings), between(middle), between(place)


def _on_segment(a: Points, b: Points, target: Points, along: Points) -> Points:
    """Return the places on segments from a to b that are level with targets along a direction."""
    to_target, to_b = ((target - a) * along.conj()).real, ((b - a) * along.conj()).real
    share = np.divide(to_target, to_b, out=np.full(len(a), 1 - INNER), where=to_b > to_target)
    return np.asarray(a + np.clip(share, INNER, 1 - INNER) * (b - a))


def _renumbered(
    outlines: Outlines, dual_edges: DualEdges, entries: ChainIndex, middle: Points, place: Points
) -> tuple[Outlines, DualEdges]:
    """Give crossings new numbers, in the order of the chains, then nodes."""
    whose, k = entries.indices, len(dual_edges.crossed)
    nodes = np.arange(k, len(dual_edges.middle))
    crossing = whose < k
    crossing[entries.last[entries.rings]] = False  # a ring's first point comes again
    chosen = crossing.nonzero()[0]
    number = np.empty(len(whose), np.int64)
    number[chosen] = np.arange(len(chosen))
    number[whose >= k] = len(chosen) + whose[whose >= k] - k
    begin, end = entries.ring_ends
    number[end] = number[begin]
    source = np.concatenate([whose[chosen], nodes])

    def of_points(values: Points, own: Points) -> Points:
        return np.concatenate([own[chosen], values[nodes]])

    return (
        replace(outlines, points=as_rows(of_points(as_complex(outlines.points), place)), chains=replace(entries, indices=number)),
        replace(
            dual_edges,
            crossed=dual_edges.crossed[whose[chosen]],
            chains=replace(entries, indices=number),
            middle=of_points(dual_edges.middle, middle),
            vector=dual_edges.vector[source],
            corner_after=dual_edges.corner_after[whose[chosen]],
            bounds=dual_edges.bounds[source],
        ),
    )
