"""Open chains that may be straight lines -> shifts onto these lines, and where the chains lead then.

Where one straight line passes through the bounds of all crossings of a chain, a digital straight segment (Klette and Rosenfeld, "Digital
straightness: a review", Discrete Applied Mathematics 139, 2004), the line of least squares takes the place of the smoothing spline: it has
two unknowns where an arc has three, and grains, drawings and cuts have straight sides. On a circle of radius R a line passes for no more
than some sqrt(5.6 R) px, where pixels tell little of the curvature: there nothing is lost.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Floats, Ints, Points, cross, runs
from img2tri.shapes.place.constrained_smoothing import BoundedChains, ChainEnds

FEWEST = 3  # crossings: a chain with no more is as straight as it is
SLIGHT = 0.05  # of the dual edge: how far a line may miss the bounds of a crossing
STEEP = 1e-9  # px, at least across the line


def straightened(s: BoundedChains, shift: Floats, ends: ChainEnds) -> tuple[Floats, ChainEnds]:
    """Return the shifts (n,) of all points, and where chains lead, such that chains which may be straight lines are.

    Parameters
    ----------
    s, shift, ends
        The chains, shifts of their points, and where they lead, from `widest_fitting_spline`.
    """
    chains = s.chains
    if chains.rings.all():
        return shift, ends
    crossings = np.diff(chains.starts) - 2
    able = np.flatnonzero(~chains.rings & (crossings > FEWEST) & s.movable)
    if not len(able):
        return shift, ends
    which, place = runs(crossings[able])
    at = chains.indices[chains.first[able][which] + 1 + place]
    middle, line = _least_squares(s.points[at], which, len(able))
    first, last = chains.first[able], chains.last[able]
    line *= np.where(((s.points[chains.indices[last]] - s.points[chains.indices[first]]) * line.conj()).real < 0, -1, 1)
    axis, ahead = s.axis[at], line[which]
    off, across = cross(s.points[at] - middle[which], ahead), cross(axis, ahead)
    steep = np.abs(across) > STEEP
    t = np.divide(-off, across, out=np.zeros(len(at)), where=steep)
    beyond = (t < s.low[at] - SLIGHT) | (t > s.high[at] + SLIGHT) | ~steep
    straight = np.bincount(which, beyond, len(able)) == 0

    shift, moved = shift.copy(), straight[which]
    shift[at[moved]] = np.clip(t, s.low[at], s.high[at])[moved]
    able, line, middle = able[straight], line[straight], middle[straight]
    ends = replace(ends, place=ends.place.copy(), direction=ends.direction.copy(), scale=ends.scale.copy())
    for end, entry in enumerate((chains.first[able], chains.last[able])):
        node = chains.indices[entry]
        along = ((s.points[node] - middle) * line.conj()).real
        ends.place[able, end], ends.direction[able, end] = middle + along * line, line
        ends.scale[able, end] = np.maximum(ends.scale[able, end], crossings[able])
        # At the frame of the image nodes slide to where the line leads.
        across = cross(s.axis[node], line)
        slides = np.abs(across) > STEEP
        by = -cross(s.points[node] - middle, line)[slides] / across[slides]
        shift[node[slides]] = np.clip(by, s.low[node[slides]], s.high[node[slides]])
    return shift, ends


def _least_squares(z: Points, which: Ints, count: int) -> tuple[Points, Points]:
    """Return the middle and the direction of the line (count,) of least squares through the points of each group."""

    def sums(values: Points) -> Points:
        return np.asarray(np.bincount(which, values.real, count) + 1j * np.bincount(which, values.imag, count))

    middle = sums(z) / np.bincount(which, minlength=count)
    off = z - middle[which]
    # Half the argument of the sum of squares of complex offsets.
    return middle, np.asarray(np.exp(0.5j * np.angle(sums(off * off))))
