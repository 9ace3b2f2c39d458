"""Smoothing along the arc, crossing by crossing as far as the pixels allow: the widest Gaussian that fits.

In: points on their links, and the range each may shift in. Out: shifts along the links. The points are smoothed along the arc
at several scales, the shrinkage of Gaussians taken back. Each crossing takes the widest scale at which the smooth curve,
there and nearby, passes through the ranges. On long gentle runs this averages the steps of many pixels away; at corners and
in thin parts only narrow scales fit. Last, each chain is shifted as a whole until it encloses the area it should.

Others tried on discs, ellipses and rectangles: Laplace and Taubin smoothing, least bending, one Gaussian for all. Their error
is two to four times greater, or they lose corners and small shapes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.records import Bools, Floats, Ints
from img2tri.shapes.unrolling import Points, Unrolled, convolve, cross, unshrinking, widened

SCALES = (1.0, 2.2, 4.6, 9.2)  # standard deviations of the Gaussians, in crossings (0.7 to 1 px apart)
MISFIT = 0.1  # px by which a smooth curve may miss the range of a crossing and still count as fitting


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
    indices, starts, rings
        The chains, as in `Outlines`; which of them are rings.
    """

    points: Points
    axis: Points
    low: Floats
    high: Floats
    indices: Ints
    starts: Ints
    rings: Bools

    @property
    def chain(self) -> Ints:
        """(k,) the chain of each entry of `indices`."""
        return np.repeat(np.arange(len(self.rings)), np.diff(self.starts))


def widest_fit(s: Sliding) -> Floats:
    """Shift (n,) each point along its link onto the smooth curve of the widest scale that fits."""
    shift, level = np.zeros((len(SCALES) + 1, len(s.points))), np.zeros(len(s.points), np.int64)
    size = np.diff(s.starts)
    for k, scale in enumerate(SCALES, start=1):
        long = size > 6 * scale
        if not long.any():
            break
        kernel = unshrinking(scale)
        line = Unrolled(s.indices, s.starts, s.rings, long, len(kernel) // 2 + 1)
        curve = convolve(line.points(s.points), kernel)
        slope = np.gradient(curve)
        length = np.maximum(np.abs(slope), 1e-9)
        # Slide to the tangent of the curve: (point + t axis - curve) x slope = 0.
        across = cross(s.axis[line.source], slope)
        steep = np.abs(across) > 1e-9 * length
        t = np.where(steep, cross(curve - s.points[line.source], slope) / np.where(steep, across, 1), 0)
        low, high = s.low[line.source], s.high[line.source]
        miss = np.maximum(np.maximum(low - t, t - high), 0) * np.abs(across) / length
        fits = ~widened(miss > MISFIT, int(np.ceil(3 * scale)))
        at = line.source[line.own]
        shift[k, at] = np.clip(t, low, high)[line.own]
        level[at[fits[line.own] & (level[at] == k - 1)]] = k
    return _blend(shift, level, s)


def _blend(shift: Floats, level: Ints, s: Sliding) -> Floats:
    """Pick each point's own scale, with a soft transition where neighbours took different ones."""
    if not level.any():
        return np.zeros(shift.shape[1])
    kernel = np.array([1.0, 8, 28, 56, 70, 56, 28, 8, 1]) / 256
    line = Unrolled(s.indices, s.starts, s.rings, np.diff(s.starts) > 1, len(kernel) // 2)
    at, result = line.source[line.own], np.zeros(shift.shape[1])
    for k in range(1, len(shift)):
        share = np.convolve((level[line.source] == k).astype(np.float64), kernel, "same")
        result[at] += share[line.own] * shift[k, at]
    return np.clip(result, s.low, s.high)


def keep_areas(s: Sliding, shift: Floats, wanted: Floats, *, rounds: int = 4) -> Floats:
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
        free = (s.low[at] < shift[at]) & (shift[at] < s.high[at])
        free[ring_end] = False
        gain = np.bincount(chain, np.abs(width) * free, len(wanted))
        missing = wanted - swept(moved, s)
        step = np.divide(missing, gain, out=np.zeros_like(gain), where=gain > 0.1)
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
