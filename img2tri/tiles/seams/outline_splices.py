r"""Where outlines go on beyond the border of finished pieces: chains of constraints for the gap between these and a new mesh.

Both have coarse outlines of the same image, so that they have the same topology there, though not the same vertices. At the border of the
finished pieces each outline ends in a *stub*. It is spliced into the outline of the new mesh that passes there: from the stub to the first
vertex that stays, leaving out vertices too near to the stub::

      finished   |  gap          new mesh              F  a stub, a vertex of the finished pieces
     ------------F- - - -o- - - -o=======o=======      o  vertices of the new mesh; along === it stays
          x    x |
        left out |
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.tiles.seams.piece_seams import SeamError, Sides, Stubs

REACH = 3.0  # px: how far a stub may be from the outline it belongs to, beside the tolerance
BENT = 0.4  # segments: a vertex of the outline nearer to a stub does not shape the curve
CORNER = 0.5  # segments: a corner nearer to a stub is left out
BEHIND = 2  # edges behind a stub of which it may not be clear that finished pieces have them
SHARP = np.cos(np.radians(50))  # where an outline turns by more, its vertex is a corner, and stays


@dataclass(frozen=True, eq=False)
class Ways:
    """The outlines of a mesh as directed edges, the lower region on their left, and which follows which.

    Attributes
    ----------
    start, stop, low, high
        (e,) int64, vertices, and codes of the regions on the left and right.
    after, before
        (e,) int64, the next edge of the same outline and the one before; -1 at junctions.
    edge
        (e,) int64, which edge of the mesh each is.
    """

    start: Ints
    stop: Ints
    low: Ints
    high: Ints
    after: Ints
    before: Ints
    edge: Ints

    @classmethod
    def of(cls, sides: Sides, codes: Ints, n: int) -> Ways:
        """Find the outlines among the edges of a mesh."""
        left, right = sides.codes(codes)
        part = np.flatnonzero(left != right)
        turned = left[part] > right[part]
        start = np.where(turned, sides.high[part], sides.low[part])
        stop = np.where(turned, sides.low[part], sides.high[part])
        low, high = np.minimum(left, right)[part], np.maximum(left, right)[part]
        after, before = np.full(len(part), -1), np.full(len(part), -1)
        leaves, arrives = np.full(n, -1), np.full(n, -1)
        leaves[start], arrives[stop] = np.arange(len(part)), np.arange(len(part))
        once = (np.bincount(start, minlength=n) == 1) & (np.bincount(stop, minlength=n) == 1)
        v = np.flatnonzero(once)
        one, other = arrives[v], leaves[v]
        same = (low[one] == low[other]) & (high[one] == high[other])
        after[one[same]], before[other[same]] = other[same], one[same]
        return cls(start, stop, low, high, after, before, part)

    def sharp(self, z: Points) -> Bools:
        """Tell which vertices (n,) are corners of outlines."""
        result = np.zeros(len(z), bool)
        one = np.flatnonzero(self.after >= 0)
        a, b = (z[self.stop] - z[self.start])[one], (z[self.stop] - z[self.start])[self.after[one]]
        result[self.stop[one]] = (a.conj() * b).real < SHARP * np.abs(a) * np.abs(b)
        return result


def splice(
    z: Points, ways: Ways, stubs: Stubs, lengths: Floats, stays: Bools, settled: Bools, tolerance: float
) -> tuple[Points, Ints, Ints, Ints]:
    """Continue stubs along the outlines of a mesh to vertices that stay, or to other stubs.

    Parameters
    ----------
    z, ways, stubs
        All vertices, the outlines of the new mesh, the ends of those of the finished pieces.
    lengths
        (k,) float64, how long edges from each stub on are to be, for what is usual there.
    stays
        (n,) bool, vertices of triangles of the new mesh that stay.
    settled
        (e,) bool, edges of outlines that have a triangle that stays, or lie within finished pieces.
    tolerance
        How far outlines may be from those of the image, px.

    Returns
    -------
    added : (a,) complex
        Vertices to be added at the end.
    segments : (k, 2) int64
        Edges of outlines through the gap, the lower region on their left.
    low, high : (k,) int64
        Codes of the regions on their left and right.

    Raises
    ------
    SeamError
        If the outlines do not correspond.
    """
    edge, along = _nearest(z, ways, stubs, REACH + 2 * tolerance)
    # Those that have their outline's edges in common, in order along them.
    order = np.lexsort((stubs.away, along, edge))
    on = np.split(order, np.flatnonzero(np.diff(edge[order])) + 1) if len(order) else []
    stops: dict[int, list[int]] = {int(edge[group[0]]): group.tolist() for group in on}
    sharp = ways.sharp(z)
    used = np.zeros(len(ways.start), bool)
    chains = []
    for k in range(len(stubs.at)):
        chains.append(_outwards(z, ways, stubs, k, int(edge[k]), stops, stays, used))
        _inwards(ways, stubs, k, int(edge[k]), stops, settled, used)
    # What no stub leads to is as it was.
    rest = np.flatnonzero(~used & ~settled)
    segments = [np.stack([ways.start[rest], ways.stop[rest]], axis=1)]
    low, high = [ways.low[rest]], [ways.high[rest]]
    added: list[Points] = []
    n = len(z)
    for k, chain in enumerate(chains):
        if len(chain) < 2:
            continue
        if chain[0] == chain[-1]:
            raise SeamError("an outline ends where it begins", z[chain[:1]])
        between = _spaced(z, chain, sharp, float(lengths[k]))
        numbers = np.array([chain[0], *range(n, n + len(between)), chain[-1]])
        n += len(between)
        added.append(between)
        pairs = np.stack([numbers[:-1], numbers[1:]], axis=1)
        segments.append(pairs if stubs.away[k] else pairs[::-1, ::-1])
        low.append(np.full(len(pairs), stubs.low[k]))
        high.append(np.full(len(pairs), stubs.high[k]))
    return np.concatenate([np.zeros(0, np.complex128), *added]), np.concatenate(segments), np.concatenate(low), np.concatenate(high)


def _nearest(z: Points, ways: Ways, stubs: Stubs, reach: float) -> tuple[Ints, Floats]:
    """Find the edge of the right outline that is nearest to each stub, and how far along the edge that is."""
    from scipy.spatial import cKDTree

    if not len(stubs.at):
        return np.zeros(0, np.int64), np.zeros(0)
    if not len(ways.start):
        raise SeamError("outlines of the finished pieces end where the new mesh has none")
    a, b = z[ways.start], z[ways.stop]
    middle = (a + b) / 2
    tree = cKDTree(np.stack([middle.real, middle.imag], axis=1))
    p = z[stubs.at]
    lists = tree.query_ball_point(np.stack([p.real, p.imag], axis=1), reach + np.abs(b - a).max() / 2)
    of = np.repeat(np.arange(len(p)), [len(found) for found in lists])
    e = np.concatenate([np.asarray(found, np.int64) for found in lists])
    fits = (ways.low[e] == stubs.low[of]) & (ways.high[e] == stubs.high[of])
    ahead = (b - a)[e] * np.where(stubs.away[of], 1, -1)
    fits &= (ahead * stubs.heading[of].conj()).real > -0.5 * np.abs(ahead)
    of, e = of[fits], e[fits]
    share = np.clip((((p[of] - a[e]) * (b - a)[e].conj()).real) / np.abs((b - a)[e]) ** 2, 0, 1)
    distance = np.abs(a[e] + share * (b - a)[e] - p[of])
    # Of two edges that meet in the nearest place take the one that leads out.
    outer = np.where(stubs.away[of], -share, share)
    order = np.lexsort((-outer, np.round(distance, 9), of))
    first = order[np.flatnonzero(np.diff(of[order], prepend=-1))]
    if len(first) != len(p) or (distance[first] > reach).any():
        lost = np.ones(len(p), bool)
        lost[of[first]] = distance[first] > reach
        raise SeamError("an outline of the finished pieces ends where the new mesh has none", p[lost])
    return e[first], share[first]


def _outwards(z: Points, ways: Ways, stubs: Stubs, k: int, edge: int, stops: dict[int, list[int]], stays: Bools, used: Bools) -> list[int]:
    """Vertices from a stub to the first that stays, or to another stub."""
    away = bool(stubs.away[k])
    here, chain, e = stops[edge], [int(stubs.at[k])], edge
    place = here.index(k) + (1 if away else -1)
    for _ in range(len(ways.start) + 1):
        used[e] = True
        group = stops.get(e, [])
        if e != edge:
            place = 0 if away else len(group) - 1
        if 0 <= place < len(group):
            met = group[place]
            if stubs.away[met] == away:
                raise SeamError("outlines of the finished pieces and of the new mesh do not alternate", z[stubs.at[[k, met]]])
            return [*chain, int(stubs.at[met])] if away else chain[:1]  # or else the other stub finds the same chain
        v = int(ways.stop[e] if away else ways.start[e])
        chain.append(v)
        e = int(ways.after[e] if away else ways.before[e])
        if stays[v] or e < 0:
            return chain
        if e == edge:
            break
    raise SeamError("an outline leads to no place that stays", z[stubs.at[[k]]])


def _inwards(ways: Ways, stubs: Stubs, k: int, edge: int, stops: dict[int, list[int]], settled: Bools, used: Bools) -> None:
    """Mark the edges behind a stub that belong to it: up to the next that surely lies in finished pieces."""
    away, e = bool(stubs.away[k]), edge
    group = stops[edge]
    place = group.index(k) + (-1 if away else 1)
    if 0 <= place < len(group):
        return
    for _ in range(BEHIND):
        used[e] = True
        e = int(ways.before[e] if away else ways.after[e])
        if e < 0 or e in stops or settled[e]:
            return


def _spaced(z: Points, chain: list[int], sharp: Bools, factor: float) -> Points:
    """Places between the ends of a chain, spaced as its vertices are; corners stay where they are, unless they are too near to an end."""
    part = z[chain]
    steps = np.abs(np.diff(part))
    # In segments of the chain: the first and last may be parts of one, as long as the next to them.
    shares = np.ones(len(steps))
    if len(steps) > 1:
        shares[0], shares[-1] = min(1.0, steps[0] / steps[1]), min(1.0, steps[-1] / steps[-2])
    way = np.concatenate([[0], np.cumsum(shares)])
    stops = [i for i in range(1, len(chain) - 1) if sharp[chain[i]] and min(way[i], way[-1] - way[i]) > CORNER]
    # The vertex next to a stub may be so near that it would bend the curve.
    kept = [i for i in range(len(chain)) if i in (0, len(chain) - 1) or min(way[i], way[-1] - way[i]) > BENT]
    places = []
    for first, last in pairwise([0, *stops, len(chain) - 1]):
        inside = [i for i in kept if first <= i <= last]
        count = max(1, round((way[last] - way[first]) / factor))
        at = way[first] + (way[last] - way[first]) * np.arange(1, count + (last < len(chain) - 1)) / count
        places.append(_on_curve(part[inside], way[inside], at))
    return np.concatenate(places)


def _on_curve(part: Points, way: Floats, at: Floats) -> Points:
    """Places on the Catmull-Rom spline through points, the line between two."""
    if len(part) == 2 or not len(at):
        return np.asarray(part[0] + (part[-1] - part[0]) * (at - way[0]) / (way[-1] - way[0]))
    slope = np.gradient(part, way)
    i = np.minimum(np.searchsorted(way, at, side="right") - 1, len(way) - 2)
    h = (way[1:] - way[:-1])[i]
    t, a, b = (at - way[i]) / h, part[i], part[i + 1]
    bend = t * (1 - t) ** 2 * slope[i] + t * t * (t - 1) * slope[i + 1]
    return np.asarray((1 + 2 * t) * (1 - t) ** 2 * a + t * t * (3 - 2 * t) * b + h * bend)
