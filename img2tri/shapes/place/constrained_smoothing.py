"""Smoothing along the arc, crossing by crossing as far as the pixels allow: the widest spline that fits.

In: points on their links, and the range each may shift in. Out: shifts along the links. The points are smoothed along the arc
at several scales (see `splines`). Each crossing takes the widest scale at which the smooth curve, there and nearby, passes
through the ranges or near them; where it just misses one, it is bent towards it, gently. On long runs this averages the steps
of many pixels away; at corners and in thin parts only narrow scales fit. Last, each chain is shifted as a whole until it
encloses the area it should.

That a narrow scale misses says nothing of wide ones: a single pixel that sticks out at the top of a disc is a bump to the one,
and the disc's own to the other.

Others tried on discs, ellipses and rectangles: Laplace and Taubin smoothing, least bending, least change of curvature, one
scale for all: their error is two to four times greater, or they lose corners and small shapes. Gaussians with their shrinkage
taken back are as good, and take five times as long. More scales than three change nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from img2tri.shapes.place.padded_chains import Points, Unrolled, cross
from img2tri.shapes.place.smoothing_splines import CONTINUED, Elastic, beyond, faded
from img2tri.types import Bools, Floats, Ints

SCALES = (1.5, 5.0, 16.0)  # px, see `splines.Elastic`
MISFIT = 0.4  # of the slack: by how much a smooth curve may miss the range of a crossing and still count as fitting
WINDOW = 3.0  # scales: how far from a range that is missed a curve fits
FREE = 5.0  # px, the least scale that moves the ends of chains along the frame: short chains there would lose their area
SAME = 1e-12  # px, a step that changes nothing
BENDS = 2  # how often a curve is bent towards the ranges it misses
BEND = 0.75  # of the scale: to how many places on either side a bend reaches


@dataclass(frozen=True, eq=False)
class Sliding:
    """Points in chains, each free to slide a little along its link.

    Attributes
    ----------
    points
        (n,) where they are.
    axis
        (n,) the directions they may slide in, as long as the links; 0 for those that stay.
    low, high
        (n,) the ranges they may slide in, in lengths of the link.
    slack
        (n,) how far they may be from where they should be, in lengths of the link.
    indices, starts, rings
        The chains, as in `Outlines`; which of them are rings.
    """

    points: Points
    axis: Points
    low: Floats
    high: Floats
    slack: Floats
    indices: Ints
    starts: Ints
    rings: Bools

    @property
    def chain(self) -> Ints:
        """(k,) the chain of each entry of `indices`."""
        return np.repeat(np.arange(len(self.rings)), np.diff(self.starts))

    @property
    def movable(self) -> Bools:
        """(c,) the chains with points that may slide; those along the frame have none but at their ends."""
        return np.asarray(self.axis[self.indices[self.starts[:-1] + 1]] != 0)


def widest_fit(s: Sliding) -> Floats:
    """Shift each point (n,) along its link onto the smooth curve of the widest scale that fits."""
    shift, level = np.zeros((len(SCALES) + 1, len(s.points))), np.zeros(len(s.points), np.int64)
    long = [(np.diff(s.starts) > 6 * scale) & s.movable for scale in SCALES]
    for k, scale in enumerate(SCALES, start=1):
        if not long[k - 1].any():
            break
        if k == 1 or (long[k - 1] != long[k - 2]).any():
            # The wider scales of the same chains are served, too.
            widest = max(other for other, chains in zip(SCALES, long, strict=True) if (chains == long[k - 1]).all())
            line = Unrolled(s.indices, s.starts, s.rings, long[k - 1], max(CONTINUED, math.ceil(3 * BEND * widest) + 1))
            curves = Elastic(line, line.points(s.points), s.axis != 0)
        at = line.source
        off, direction = curves.smoothed(scale)
        # Slide to the tangent of the curve.
        axis, low, high = line.sign * s.axis[at], s.low[at], s.high[at]
        across = cross(axis, direction)
        steep = np.abs(across) > 1e-9
        t = np.divide(cross(off, direction), across, out=np.zeros(len(at)), where=steep)[line.original]
        # A range is missed by what lies across the curve: along links that run nearly as it does, it says little.
        missed = np.abs((t - np.clip(t, low, high)) * across) > MISFIT * s.slack[at] * np.abs(axis)
        fits = beyond(line, curves.steps, missed & ~line.node, WINDOW * scale)
        for _ in range(BENDS):
            miss = np.where(fits & ~line.node, (t - np.clip(t, low, high)) * across, 0)
            t -= np.divide(faded(line, miss, BEND * scale), across, out=np.zeros(len(at)), where=steep)
        own = at[line.own]
        shift[k, own] = np.where(line.node & (scale < FREE), 0, np.clip(t, low, high))[line.own]
        level[own[fits[line.own]]] = k
    return _blend(shift, level, s)


def _blend(shift: Floats, level: Ints, s: Sliding) -> Floats:
    """Pick each point's own scale, with a soft transition where neighbours took different ones."""
    if not level.any():
        return np.zeros(shift.shape[1])
    kernel = np.array([1.0, 8, 28, 56, 70, 56, 28, 8, 1]) / 256
    line = Unrolled(s.indices, s.starts, s.rings, s.movable, len(kernel) // 2)
    at, result = line.source[line.own], np.zeros(shift.shape[1])
    for k in range(1, len(shift)):
        share = np.convolve((level[line.source] == k).astype(np.float64), kernel, "same")
        result[at] += share[line.own] * shift[k, at]
    return np.clip(result, s.low, s.high)


def keep_areas(s: Sliding, shift: Floats, wanted: Floats, *, rounds: int = 8) -> Floats:
    """Shift each chain sideways until it sweeps the `wanted` area (c,), seen from the origin; return the new shifts."""
    at, chain = s.indices, s.chain
    ring_start, ring_end = s.starts[:-1][s.rings], s.starts[1:][s.rings] - 1
    for _ in range(rounds):
        moved = s.points + shift * s.axis
        z = moved[at]
        ahead, behind = np.roll(z, -1), np.roll(z, 1)
        behind[ring_start], ahead[ring_end] = z[ring_end - 1], z[ring_start + 1]
        # A step dt along the link sweeps the area dt * axis x (ahead - behind) / 2.
        width = cross(s.axis[at], ahead - behind) / 2
        missing = wanted - swept(moved, s)
        # One at the end of its range may still go back.
        free = np.where(missing[chain] * width > 0, shift[at] < s.high[at], s.low[at] < shift[at])
        free[ring_end] = False
        gain = np.bincount(chain, np.abs(width) * free, len(wanted))
        step = np.divide(missing, gain, out=np.zeros_like(gain), where=gain > 0.1)
        if np.abs(step).max(initial=0) < SAME:
            break
        move = np.zeros_like(shift)
        move[at[free]] = (np.clip(step, -0.25, 0.25)[chain] * np.sign(width))[free]
        shift = np.clip(shift + move, s.low, s.high)
    return shift


def swept(z: Points, s: Sliding) -> Floats:
    """Area (c,) each chain sweeps as seen from the origin."""
    p = z[s.indices]
    area = np.zeros(len(p))
    area[:-1] = cross(p[:-1], p[1:]) / 2
    area[s.starts[1:] - 1] = 0
    return np.asarray(np.bincount(s.chain, area, len(s.rings)), np.float64)
