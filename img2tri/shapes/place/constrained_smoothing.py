"""Constrained smoothing: each crossing onto the widest smoothing spline that fits its bounds, there and nearby.

In: points on their dual edges, and the bounds each may shift within. Out: shifts. The points are smoothed along the arc at several
scales (see `smoothing_splines`). Each crossing takes the widest scale at which the spline, there and nearby, passes through the bounds
or near them; where it just misses one, it is bent towards it, gently. On long stretches this averages the steps of many pixels away;
at corners and in thin parts only narrow scales fit. Last, each chain is shifted as a whole until it encloses the area it should.

Smoothing within the bounds of the pixels is what constrained surface nets do (Gibson 1998, DOI 10.1007/BFb0056277), there by
relaxation at one scale; the choice of a scale for each point follows scale-space theory (Lindeberg, "Feature detection with automatic
scale selection", 1998, DOI 10.1023/A:1008045108935).

That a narrow scale misses says nothing of wide ones: a single pixel that sticks out at the top of a disc is a bump to the one,
and part of the disc to the other.

Others tried on discs, ellipses and rectangles: Laplace and Taubin smoothing, least bending, least change of curvature, one
scale for all: their error is two to four times greater, or they lose corners and small shapes. Gaussians with their shrinkage
taken back are as good, and take five times as long. More scales than three change nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, ChainIndex, Floats, Ints, Points, cross
from img2tri.shapes.place.along_the_arc import fade_out
from img2tri.shapes.place.padded_chains import PaddedChains
from img2tri.shapes.place.smoothing_splines import PADDING, CurvatureSpline, SmoothingSpline
from img2tri.shapes.trace.dual_edges import BOUND

NARROW, WIDE = (1.5, 4.0), (9.0, 22.0, 70.0)  # px, scales of splines smooth in x and y, and of those smooth in their curvature
BASE = 7.0  # px, the scale of the spline that the wide ones are laid along
MISFIT = 0.4  # of the slack: by how much a spline may miss the bounds of a crossing and still count as fitting
WINDOW = 3.0  # scales: how far from bounds that are missed a spline fits
FREE_ENDS = 5.0  # px, the least scale that moves the ends of chains along the frame: short chains there would lose their area
RING_SCALES = 3.0  # the least number of points of a ring that is smoothed, in scales
SHORTEST_NARROW, SHORTEST_WIDE = 3, 11  # points: open chains with no more are not smoothed
SMALLEST_NARROW, SMALLEST_WIDE = 9, 54  # points: the same for rings
AT_BOUND = 1e-9  # what lies so near to a bound lies there, up to rounding
SWEPT_ROUNDING = 4e-15  # of the square of the largest coordinate: areas are not known better
NO_STEP = 1e-12  # px, a step that changes nothing
BATCH = 1 << 15  # points of chains smoothed at a time: what is laid out for them fits the cache, and takes little memory
BENDS = 2  # how often a spline is bent towards the bounds it misses
BEND, MOST_BEND = 0.75, 12.0  # of the scale: and places at most: how far to either side a bend reaches
AREA_ROUNDS = 8  # of shifting chains for their area; two or three do


Spline = SmoothingSpline | CurvatureSpline


@dataclass(frozen=True, eq=False)
class BoundedChains:
    """Points in chains, each free to slide a little along an axis of its own.

    Attributes
    ----------
    points
        (n,) where they are.
    axis
        (n,) the axes they may slide along, as long as the dual edges; 0 for points that stay.
    low, high
        (n,) the bounds of their shifts, in lengths of the axis.
    slack
        (n,) how far they may be from where they should be, in lengths of the axis.
    chains
        The points of each chain.
    """

    points: Points
    axis: Points
    low: Floats
    high: Floats
    slack: Floats
    chains: ChainIndex

    @property
    def slides(self) -> Bools:
        """(n,) bool, the points that may slide."""
        return np.asarray(self.axis != 0)

    @property
    def movable(self) -> Bools:
        """(c,) the chains with points that may slide; those along the frame have none but at their ends."""
        return self.slides[self.chains.indices[self.chains.first + 1]]

    def batches(self) -> Iterator[tuple[slice, Ints, BoundedChains]]:
        """Yield which chains, the points (k,) of their entries, and these chains alone, where each of the entries is a point of its own."""
        for which, at, chains in _batches(self.chains):
            yield which, at, BoundedChains(self.points[at], self.axis[at], self.low[at], self.high[at], self.slack[at], chains)


def _batches(chains: ChainIndex) -> Iterator[tuple[slice, Ints, ChainIndex]]:
    """Yield some chains at a time, the points (k,) of their entries, and an index of the chains by these."""
    batch = np.cumsum(np.diff(chains.starts)) // BATCH
    bounds = np.concatenate([[0], np.flatnonzero(np.diff(batch)) + 1, [len(batch)]]).tolist()
    for first, last in pairwise(bounds):
        starts = chains.starts[first : last + 1]
        some = ChainIndex(np.arange(starts[-1] - starts[0]), starts - starts[0], chains.rings[first:last])
        begin, end = some.ring_ends
        some.indices[end] = begin
        yield slice(first, last), chains.indices[starts[0] : starts[-1]], some


@dataclass(frozen=True, eq=False)
class ChainEnds:
    """Where the splines of chains lead at their two ends, nodes being free.

    Attributes
    ----------
    place, direction
        (c, 2) complex, the end of the spline at the first and at the last node, and its unit direction there.
    scale
        (c, 2) float64, px, the scale of the spline; 0 where none fits.
    """

    place: Points
    direction: Points
    scale: Floats


def widest_fitting_spline(s: BoundedChains) -> tuple[Floats, ChainEnds]:
    """Return the shift of each point (n,) along its axis onto the smoothing spline of the widest scale that fits, and where chains lead."""
    result, ends = np.zeros(len(s.points)), _unsmoothed_ends(s)
    for chains, at, part in s.batches():
        own_ends = ChainEnds(ends.place[chains], ends.direction[chains], ends.scale[chains])
        shift = _fitted(part, own_ends)
        # Those along the frame have but the nodes in common with those that move.
        moved = part.movable[part.chains.chain]
        result[at[moved]] = shift[moved]
    return result, ends


def _fitted(s: BoundedChains, ends: ChainEnds) -> Floats:
    """Return the shift (n,) of each point of a batch of chains; write where chains lead."""
    shift, level = np.zeros((len(NARROW + WIDE) + 1, len(s.points))), np.zeros(len(s.points), np.int8)
    size, rings = np.diff(s.chains.starts), s.chains.rings
    narrow, wide = (
        s.movable & (size > np.where(rings, smallest, shortest))
        for smallest, shortest in ((SMALLEST_NARROW, SHORTEST_NARROW), (SMALLEST_WIDE, SHORTEST_WIDE))
    )
    if not narrow.any():
        return np.zeros(len(s.points))
    # Where both groups of scales are for the same chains, these are laid out once, with room for the wider one.
    same = np.array_equal(narrow, wide)
    laid = _LaidOut(s, narrow, (WIDE if same else NARROW)[-1])
    for k, scale in enumerate(NARROW, 1):
        laid.fit(k, scale, laid.narrow, shift[k], level, ends)
    if wide.any():
        laid = laid if same else _LaidOut(s, wide, WIDE[-1])
        spline = CurvatureSpline(laid.narrow, BASE)
        for k, scale in enumerate(WIDE, len(NARROW) + 1):
            laid.fit(k, scale, spline, shift[k], level, ends)
    return _blend(shift, level, s)


class _LaidOut:
    """Some chains laid out on a line, their narrow splines, and the bounds of their points there."""

    def __init__(self, s: BoundedChains, chosen: Bools, widest: float) -> None:
        """Lay out the chosen (c,) chains, with padding for scales up to the widest."""
        line = self.line = PaddedChains(s.chains, chosen, max(PADDING, math.ceil(3 * _bend(widest)) + 2))
        self.narrow = SmoothingSpline(line, line.points(s.points))
        self.axis, self.low, self.high = line.sign * s.axis[line.source], s.low[line.source], s.high[line.source]
        slack = s.slack[line.source]
        self.misfit = MISFIT * slack * np.abs(self.axis)
        # Bounds keep away from pixel centres: of a place that is known, that says nothing.
        self.spare = np.where(slack < BOUND, 0.5 - BOUND, 0.0)
        which = np.flatnonzero(chosen)
        self.size = np.where(line.ring, np.diff(s.chains.starts)[which[line.chain]], np.inf)
        # Where on the line the two ends of each open chain are.
        self.node, self.opened = np.flatnonzero(line.node).reshape(-1, 2), which[~s.chains.rings[which]]

    def fit(self, k: int, scale: float, spline: Spline, shift: Floats, level: NDArray[np.int8], ends: ChainEnds) -> None:
        """Slide to the spline of one scale: write shifts (n,), k to the level (n,) of points where it fits, and where chains end."""
        line, axis, low, high = self.line, self.axis, self.low, self.high
        off, direction = spline.smoothed(scale)
        # Slide to the tangent of the spline.
        across = cross(axis, direction)
        steep, nothing = np.abs(across) > 1e-9, np.zeros(len(axis))
        t = np.divide(cross(off, direction), across, out=nothing.copy(), where=steep)[line.original]
        # How far bounds are missed counts across the spline: along dual edges that run nearly as it does, it says little.
        miss = (t - np.clip(t, low - self.spare, high + self.spare)) * across
        fits = self.narrow.arc.farther_than((np.abs(miss) > self.misfit) & ~line.node, WINDOW * scale)
        fits &= self.size > RING_SCALES * scale
        bent = fits & ~line.node
        for _ in range(BENDS):
            miss *= bent
            if not miss.any():
                break
            t -= np.divide(fade_out(line, miss, _bend(scale)), across, out=nothing.copy(), where=steep)
            miss = (t - np.clip(t, low - self.spare, high + self.spare)) * across
        own = line.source[line.own]
        shift[own] = np.where(line.node & (scale < FREE_ENDS), 0, np.clip(t, low, high))[line.own]
        level[own[fits[line.own]]] = k
        chain, end = np.nonzero(fits[self.node])
        there, of = self.node[chain, end], self.opened[chain]
        ends.place[of, end] = (self.narrow.points + off)[there]
        ends.direction[of, end] = direction[there]
        ends.scale[of, end] = scale


def _bend(scale: float) -> float:
    """How far to either side a spline of this scale is bent towards a bound it misses, in places."""
    return min(BEND * scale, MOST_BEND)


def _unsmoothed_ends(s: BoundedChains) -> ChainEnds:
    """Tell where chains lead as they are: from the crossing beside each node on, as the next point does."""
    at, first, last = s.chains.indices, s.chains.first, s.chains.last
    beside = s.points[at[np.stack([first + 1, last - 1], axis=1)]]
    next_one, one_before = s.points[at[first + 2]], s.points[at[last - 2]]
    direction = np.stack([next_one - beside[:, 0], beside[:, 1] - one_before], axis=1)
    unit = np.where(direction == 0, 1, direction) / np.maximum(np.abs(direction), 1e-12)
    return ChainEnds(beside, np.asarray(unit, np.complex128), np.zeros(beside.shape))


def _blend(shift: Floats, level: NDArray[np.int8], s: BoundedChains) -> Floats:
    """Pick each point's own scale, with a soft transition where neighbours took different ones."""
    if not level.any():
        return np.zeros(shift.shape[1])
    kernel = np.array([1.0, 8, 28, 56, 70, 56, 28, 8, 1]) / 256
    line = PaddedChains(s.chains, s.movable, len(kernel) // 2)
    at, result = line.source[line.own], np.zeros(shift.shape[1])
    # A node has no scale of its own: in each chain that of the crossing beside it.
    own_level, node = level[line.source], np.flatnonzero(line.node)
    own_level[node] = own_level[np.where(line.own[node + 1], node + 1, node - 1)]
    own_level = own_level[line.original]
    for k in range(1, len(shift)):
        share = np.convolve((own_level == k).astype(np.float64), kernel, "same")
        result[at] += share[line.own] * shift[k, at]
    begin, end = s.chains.ring_ends
    result[end] = result[begin]
    return np.clip(result, s.low, s.high)


def restore_swept_areas(s: BoundedChains, shift: Floats, wanted: Floats) -> Floats:
    """Shift each chain sideways until it sweeps the `wanted` area (c,), seen from the origin, if not NaN; return the new shifts."""
    rounding, missing, step = rounding_of_areas(s), np.empty(len(wanted)), np.empty(len(wanted))
    once = list(s.batches()) if len(s.points) <= BATCH else None  # what is small is taken apart once
    for _ in range(AREA_ROUNDS):
        moved = shift.copy()
        for chains, at, part in once or s.batches():
            (begin, end), chain, t = part.chains.ring_ends, part.chains.chain, shift[at]
            z = part.points + t * part.axis
            width = swept_widths(z, part)
            missing[chains] = np.nan_to_num(wanted[chains] - _swept(z, part.chains))
            # A point at one of its bounds may still go back.
            free = np.where(missing[chains][chain] * width > 0, t < part.high - AT_BOUND, part.low + AT_BOUND < t)
            gain = np.bincount(chain, np.abs(width) * free, len(part.chains.rings))
            step[chains] = np.divide(missing[chains], gain, out=np.zeros_like(gain), where=gain > 0.1)
            t = np.clip(t + np.clip(step[chains], -0.25, 0.25)[chain] * np.sign(width) * free, part.low, part.high)
            t[end] = t[begin]
            moved[at] = t
        if np.abs(step).max(initial=0) < NO_STEP or (np.abs(missing) <= rounding).all():
            break
        shift = moved
    return shift


def rounding_of_areas(s: BoundedChains) -> float:
    """Return how well swept areas are known: they are seen from the origin, which may be far away."""
    return float(SWEPT_ROUNDING * np.abs(s.points).max(initial=0.0) ** 2)


def swept_areas(z: Points, s: BoundedChains) -> Floats:
    """Area (c,) each chain sweeps as seen from the origin, its points being at these places (n,)."""
    return np.concatenate([np.zeros(0), *(_swept(z[at], chains) for _, at, chains in _batches(s.chains))])


def _swept(p: Points, chains: ChainIndex) -> Floats:
    """Area (c,) each chain sweeps, its entries being at these places (k,)."""
    area = np.zeros(len(p))
    area[:-1] = cross(p[:-1], p[1:]) / 2
    area[chains.last] = 0
    return np.asarray(np.bincount(chains.chain, area, len(chains.rings)), np.float64)


def swept_widths(z: Points, s: BoundedChains) -> Floats:
    """Width (k,) of each entry of a batch, the points being at these places: a step dt along its axis sweeps the area dt width."""
    ahead, behind = np.roll(z, -1), np.roll(z, 1)
    begin, end = s.chains.ring_ends
    behind[begin], ahead[end] = z[end - 1], z[begin + 1]  # the last entry of a ring follows its first
    width = cross(s.axis, ahead - behind) / 2
    width[end] = 0
    return width
