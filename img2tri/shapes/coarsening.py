"""Dense outlines -> outlines with the wanted spacing, the topology kept.

A chain of many crossings is replaced by few *pieces*: chords between *breaks*, each standing for the run of dense points
between them. Coarsening is optimistic, and checked:

1. breaks are set evenly along each chain, then moved sideways so that the chords enclose the area of the outline;
2. a piece whose run leaves its chord by more than the tolerance is split where it is farthest;
3. pieces that come too near to each other, or meet at too sharp an angle, are split too.

Where a piece is down to two neighbouring crossings and still too near to another one, its points go back to the middles of
their links. That is the safe end of the loop: chains with all crossings in the middle are half a pixel apart and turn by
at most a right angle at a time.

Why this keeps the topology: a chord and its run lie within the run's bulge of the chord; pieces are farther apart than
their bulges together, but for neighbours on a chain, which together turn no loop. So the runs can be pulled straight one
by one without one passing through another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from img2tri.records import Bools, Floats, Ints, Outlines
from img2tri.shapes.links import Links, pixel_areas
from img2tri.shapes.unrolling import Points, cross

GAP = 0.25  # px, the least distance kept between pieces, over their bulges
SHARP = np.radians(50.0)  # pieces that meet at less are split
SHORT = 0.3  # px, pieces shorter than this are not left
AREA = 0.003  # of the smaller region beside a chain: what it may lack before it gets another break
SMALL = 16  # pixels: the area of smaller regions is not looked after
RING = 8  # a ring keeps at least so many pieces, or all its crossings


@dataclass(frozen=True, eq=False)
class Draft:
    """Outlines in coarsening.

    Attributes
    ----------
    outlines, links
        The dense outlines, and what the places of their points may be.
    dense
        (n,) complex, the dense points; those reset lie in the middle of their links.
    reset
        (n,) bool, the points that went back to the middle.
    kept
        (n,) bool, corners that must not.
    breaks
        (k,) bool, the entries of `outlines.indices` that are breaks.
    moved
        (k,) complex, how far a break lies from its dense point.
    measured, tested
        (k,) int64, the last entry of the piece that begins at an entry and whose bulge is known, that passed all tests.
    bulge
        (k,) float64, at the first entry of each measured piece the greatest distance between the run and its chord.
    """

    outlines: Outlines
    links: Links
    dense: Points
    reset: Bools
    kept: Bools
    breaks: Bools
    moved: Points
    measured: Ints
    tested: Ints
    bulge: Floats

    @property
    def pieces(self) -> tuple[Ints, Ints]:
        """First and last entry of each piece."""
        at = np.flatnonzero(self.breaks)
        chain = self.links.chain[at]
        same = chain[1:] == chain[:-1]
        return at[:-1][same], at[1:][same]

    @property
    def places(self) -> Points:
        """(k,) where the entries lie, breaks where they were moved to."""
        return self.dense[self.outlines.indices] + self.moved

    def coarse(self) -> Outlines:
        """Return the outlines made of the breaks only."""
        o, at = self.outlines, np.flatnonzero(self.breaks)
        points, first, index = np.unique(o.indices[at], return_index=True, return_inverse=True)
        place = self.places[at[first]]
        starts = np.searchsorted(at, o.starts)
        return Outlines(np.stack([place.real, place.imag], axis=1), index, starts, o.left, o.right, o.labels)


def draft(outlines: Outlines, links: Links, *, spacing: float, keep_corners: bool = False) -> Draft:
    """Set breaks evenly along each chain, about `spacing` px apart.

    With `keep_corners` no corner of an outline is ever blunted.
    """
    dense = outlines.points[:, 0] + 1j * outlines.points[:, 1]
    k, chain, starts = len(outlines.indices), links.chain, outlines.starts
    z = dense[outlines.indices]
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[starts[:-1]] = 0
    arc = np.cumsum(step)
    begin, length = arc[starts[:-1]], arc[starts[1:] - 1] - arc[starts[:-1]]
    size = np.diff(starts) - 1
    least = np.where(links.rings, np.minimum(RING, size), 1)
    count = np.clip(np.round(length / spacing).astype(np.int64), least, size)

    # Even places along the arc; each is taken by the nearest dense point, moved there.
    which = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    wanted = begin[which] + length[which] * number / count[which]
    after = np.clip(np.searchsorted(arc, wanted), starts[which] + 1, starts[which + 1] - 1)
    at = after - (wanted - arc[after - 1] < arc[after] - wanted)
    share = (wanted - arc[after - 1]) / np.maximum(arc[after] - arc[after - 1], 1e-12)
    place = z[after - 1] + share * (z[after] - z[after - 1])
    breaks, moved = np.zeros(k, bool), np.zeros(k, np.complex128)
    inner = (number > 0) & (at > starts[which]) & (at < starts[which + 1] - 1)
    moved[at[inner]] = (place - z[at])[inner]
    breaks[at[inner]] = True
    breaks[starts[:-1]] = breaks[starts[1:] - 1] = True
    kept = links.corner if keep_corners else np.zeros(len(dense), bool)
    return Draft(outlines, links, dense, np.zeros(len(dense), bool), kept, breaks, moved, np.full(k, -1), np.full(k, -1), np.zeros(k))


def settle(d: Draft, *, tolerance: float) -> Draft:
    """Split pieces until each is within `tolerance` px of its run, clear of the others, and not too sharp."""
    d = _copied(d)
    while True:
        _split_bulging(d, tolerance)
        first, last = d.pieces
        fresh = d.tested[first] != last
        if not fresh.any():
            return d
        conflicting = _crowded(d, first, last, fresh) | _sharp(d, first, last)
        short = np.abs(d.places[last] - d.places[first]) < SHORT
        d.tested[first] = last
        divisible = last - first > 1
        _split(d, first[conflicting & divisible], last[conflicting & divisible])
        stuck = (conflicting | short) & ~divisible
        _reset(d, np.concatenate([first[stuck], last[stuck]]))


def refine(d: Draft, places: Points, *, within: float) -> Draft:
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
    _reset(d, np.concatenate([first[stuck], last[stuck]]))
    return d


def _copied(d: Draft) -> Draft:
    """Return a draft whose arrays may be changed."""
    names = ("dense", "reset", "breaks", "moved", "measured", "tested", "bulge")
    return replace(d, **{name: getattr(d, name).copy() for name in names})


def _split_bulging(d: Draft, tolerance: float) -> None:
    """Measure new pieces, and split those that leave the tolerance, until there are none."""
    z = d.dense[d.outlines.indices]
    while True:
        first, last = d.pieces
        fresh = d.measured[first] != last
        first, last = first[fresh], last[fresh]
        if not len(first):
            return
        place = z + d.moved
        a, b = place[first], place[last]
        inner = last - first - 1
        which = np.repeat(np.arange(len(first)), inner)
        at = first[which] + 1 + np.arange(len(which)) - np.repeat(np.cumsum(inner) - inner, inner)
        distance = _to_segment(z[at], a[which], b[which])
        d.bulge[first] = np.maximum(np.abs(d.moved[first]), np.abs(d.moved[last]))
        d.measured[first] = last
        some = np.flatnonzero(inner)
        if not len(some):
            return
        worst = np.maximum.reduceat(distance, (np.cumsum(inner) - inner)[some])
        d.bulge[first[some]] = np.maximum(d.bulge[first[some]], worst)
        highest = np.zeros(len(first))
        highest[some] = worst
        split = at[(distance == highest[which]) & (highest[which] > tolerance)]
        d.breaks[split] = True


def _split(d: Draft, first: Ints, last: Ints) -> None:
    """Split pieces in the middle."""
    d.breaks[(first + last) // 2] = True


def _reset(d: Draft, entries: Ints) -> None:
    """Put points back to the middle of their links, and forget what was known of the pieces they are part of."""
    points = np.unique(d.outlines.indices[entries])
    points = points[~d.reset[points] & ~d.kept[points]]
    if not len(points):
        return
    d.reset[points] = True
    d.dense[points] = d.links.middle[points]
    touched = np.isin(d.outlines.indices, points)
    d.moved[touched] = 0
    first, last = d.pieces
    count = np.concatenate([[0], np.cumsum(touched)])
    stale = first[count[last + 1] > count[first]]
    d.measured[stale] = d.tested[stale] = -1


def _sharp(d: Draft, first: Ints, last: Ints) -> Bools:
    """Tell which pieces meet another one at a sharp angle."""
    n, place = len(first), d.places
    point = d.outlines.indices[np.concatenate([first, last])]
    heading = np.angle(np.concatenate([place[last] - place[first], place[first] - place[last]]))
    order = np.lexsort((heading, point))
    point, heading = point[order], heading[order]
    begin = np.flatnonzero(np.diff(point, prepend=-1))
    after = np.arange(1, 2 * n + 1)
    after[np.append(begin[1:], 2 * n) - 1] = begin
    turn = np.mod(heading[after] - heading, 2 * np.pi)
    pair = np.flatnonzero((turn < SHARP) & (after != np.arange(2 * n)))
    sharp = np.zeros(n, bool)
    sharp[order[pair] % n] = sharp[order[after[pair]] % n] = True
    return sharp


def _crowded(d: Draft, first: Ints, last: Ints, fresh: Bools) -> Bools:
    """Tell which pieces come too near to another one that is not their neighbour, at least one of the two being fresh."""
    import shapely

    place, at = d.places, d.outlines.indices
    a, b = place[first], place[last]
    bulge = d.bulge[first]
    chords = shapely.linestrings(np.stack([np.stack([a.real, a.imag], 1), np.stack([b.real, b.imag], 1)], axis=1))
    reach = GAP + bulge[fresh] + bulge.max()
    i, j = shapely.STRtree(chords).query(chords[fresh], predicate="dwithin", distance=reach)
    i = np.flatnonzero(fresh)[i]
    apart = (at[first[i]] != at[first[j]]) & (at[first[i]] != at[last[j]]) & (at[last[i]] != at[first[j]]) & (at[last[i]] != at[last[j]])
    i, j = i[apart], j[apart]
    distance = shapely.distance(chords[i], chords[j])
    near = distance < GAP + bulge[i] + bulge[j]
    # Along the same chain two pieces are only near if the way between them is long for that.
    way = _way_between(d, first, last, i, j)
    near &= way > np.maximum(4 * distance, 1.0)
    crowded = np.zeros(len(first), bool)
    crowded[i[near]] = crowded[j[near]] = True
    return crowded


def _way_between(d: Draft, first: Ints, last: Ints, i: Ints, j: Ints) -> Floats:
    """Length of the chain between two pieces, infinite if they lie on different chains."""
    z, starts, chain = d.dense[d.outlines.indices], d.outlines.starts, d.links.chain
    arc = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    early, late = np.minimum(first[i], first[j]), np.maximum(first[i], first[j])
    end = np.where(first[i] < first[j], last[i], last[j])
    way = arc[late] - arc[end]
    on = chain[early]
    around = arc[starts[on + 1] - 1] - arc[starts[on]] - (arc[np.maximum(last[i], last[j])] - arc[early])
    way = np.where(d.links.rings[on], np.minimum(way, around), way)
    return np.where(chain[early] == chain[late], way, np.inf)


def _to_segment(p: Points, a: Points, b: Points) -> Floats:
    """Distance of points to segments."""
    along = b - a
    share = np.clip(((p - a) * along.conj()).real / np.maximum(np.abs(along) ** 2, 1e-300), 0, 1)
    return np.abs(p - a - share * along)


def keep_areas(d: Draft, *, tolerance: float) -> Draft:
    """Move breaks sideways so that the chords enclose what the outlines enclose, chain by chain.

    A chord on a curve cuts a lens off. Each break takes up half of the lenses beside it; what then is missing of a chain, since
    some breaks cannot move, is shared evenly by the others. No break moves by more than half the tolerance at a time. Where
    that leaves a small region with too much or too little, a break is added, to be moved the next time.
    """
    first, last = d.pieces
    place, z = d.places, (d.outlines.points[:, 0] + 1j * d.outlines.points[:, 1])[d.outlines.indices]
    swept = np.concatenate([[0], np.cumsum(cross(z[:-1], z[1:]) / 2)])
    lens = swept[last] - swept[first] - cross(place[first], place[last]) / 2
    lens += (cross(place[first], z[first]) + cross(z[last], place[last])) / 2
    k, ring = len(z), d.links.rings
    begin, end = d.outlines.starts[:-1][ring], d.outlines.starts[1:][ring] - 1
    length = np.abs(place[last] - place[first])
    area = np.bincount(first, lens, k) + np.bincount(last, lens, k)
    width = np.bincount(first, length, k) + np.bincount(last, length, k)
    ahead, behind = np.zeros(k, np.complex128), np.zeros(k, np.complex128)
    ahead[first], behind[last] = place[last], place[first]
    # The two ends of a ring are one break.
    area[begin], width[begin], behind[begin] = area[begin] + area[end], width[begin] + width[end], behind[end]
    movable = d.breaks & ~d.reset[d.outlines.indices] & (d.links.axis[d.outlines.indices] != 0) & (width > 0)
    movable[end] = False

    # Moving a break sideways by s sweeps s * width / 2.
    shift = np.divide(area, width, out=np.zeros(k), where=movable)
    chain = d.links.chain
    missing = np.bincount(chain[first], lens, len(ring)) - np.bincount(chain, shift * width / 2, len(ring))
    share = np.bincount(chain, np.where(movable, width / 2, 0), len(ring))
    shift += np.where(movable, np.divide(missing, share, out=np.zeros_like(share), where=share > 0)[chain], 0)
    outwards = -1j * (ahead - behind)
    step = np.clip(shift, -tolerance / 2, tolerance / 2)
    moves = step * outwards / np.maximum(np.abs(outwards), 1e-12)
    moves[end] = moves[begin]

    lacking = np.abs(np.bincount(chain[first], lens, len(ring)) - np.bincount(chain, step * width / 2, len(ring)))
    breaks = d.breaks.copy()
    breaks[_middles(d, first, last, np.abs(lens), lacking > AREA * _smaller_side(d))] = True
    return replace(d, breaks=breaks, moved=d.moved + moves, measured=np.full(k, -1), tested=np.full(k, -1))


def area_error(d: Draft) -> float:
    """Greatest relative difference between what chords and outlines enclose, over the regions of more than `SMALL` pixels."""
    first, last = d.pieces
    z, chain = d.outlines.points[:, 0] + 1j * d.outlines.points[:, 1], d.links.chain
    dense = z[d.outlines.indices]
    runs = np.concatenate([[0], np.cumsum(cross(dense[:-1], dense[1:]) / 2)])
    difference = cross(d.places[first], d.places[last]) / 2 - (runs[last] - runs[first])
    size = len(d.outlines.labels)
    found = np.bincount(d.outlines.left[chain[first]], difference, size) - np.bincount(d.outlines.right[chain[first]], difference, size)
    areas = pixel_areas(d.links)
    big = np.flatnonzero(areas > SMALL)
    big = big[big > 0]
    return float(np.max(np.abs(found[big]) / areas[big], initial=0.0))


def _smaller_side(d: Draft) -> Floats:
    """Area (c,) of the smaller of the two regions beside each chain."""
    areas = pixel_areas(d.links)
    areas[0] = np.inf
    return np.asarray(np.minimum(areas[d.outlines.left], areas[d.outlines.right]))


def _middles(d: Draft, first: Ints, last: Ints, lens: Floats, chosen: Bools) -> Ints:
    """Middle entry of the piece with the greatest lens, in each of the chosen chains that have one to split."""
    chain = d.links.chain[first]
    able = np.flatnonzero(chosen[chain] & (last - first > 1))
    able = able[np.lexsort((-lens[able], chain[able]))]
    able = able[np.flatnonzero(np.diff(chain[able], prepend=-1))]
    return (first[able] + last[able]) // 2
