"""Open chains that may be straight lines -> shifts onto these lines, and where the chains lead then.

Where one straight line passes through the bounds of all crossings of a chain, a digital straight segment (Klette and Rosenfeld, "Digital
straightness: a review", Discrete Applied Mathematics 139, 2004), a line takes the place of the smoothing spline: it has two unknowns where
an arc has three, and grains, drawings and cuts have straight sides. On a circle of radius R a line passes for no more than some
sqrt(5.6 R) px, where pixels tell little of the curvature: there nothing is lost.

Which line? For a mask the mean of all that part the same pixels, all of them being as likely: their domain (Dorst and Smeulders,
"Best linear unbiased estimators for properties of digitized straight lines", IEEE Transactions on Pattern Analysis and Machine
Intelligence 8, 1986) is a small polygon, and no estimator has a smaller mean square error than its centre. The line of least squares is a
third farther off. It is right where gray values tell of each crossing, and does for short chains.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, cross, runs
from img2tri.shapes.place.constrained_smoothing import SHORTEST_WIDE, BoundedChains, ChainEnds
from img2tri.shapes.trace.dual_edges import BOUND

FEWEST = 3  # crossings: a chain with no more is as straight as it is
SLIGHT = 0.05  # of the dual edge: how far a line may miss the bounds of a crossing
OFFSETS = 12  # of possible lines that are tried, at one end of a chain
FARTHEST_LINE = 1.5  # px: two lines that part the same pixels are at most 1 px apart at these
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
    # Where pixels are all there is, and many, the line is amid those that they allow.
    chosen = (np.bincount(which, s.slack[at] < BOUND, len(able)) == 0) & (crossings[able] + 2 > SHORTEST_WIDE)
    middle, line = _mean_of_possible(s.points[at], s.axis[at], which, middle, line, chosen)
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


def _mean_of_possible(z: Points, axis: Points, which: Ints, middle: Points, line: Points, chosen: Bools) -> tuple[Points, Points]:
    """Return the middle and the direction of the mean of all lines (count,) that part the pixels beside each of the chosen groups.

    Lines are told by their offsets at two stations, a little beyond both ends of a group. For each offset at the first one those at the
    second are between two bounds; their middles are summed up, weighted by how far these are apart. Others than the chosen groups, and
    those without such a line, keep theirs.
    """
    kept = chosen[which]
    z, axis, which = z[kept], axis[kept], which[kept]
    if not len(z):
        return middle, line
    begin = np.flatnonzero(np.diff(which, prepend=-1))
    group = which[begin]
    ahead = line[which].conj()
    off, half = (z - middle[which]) * ahead, axis * ahead / 2
    half *= np.sign(half.imag)
    reach = np.maximum.reduceat(np.abs(off.real), begin) + 1
    # From one end and from the other, so that it does not matter which of them comes first.
    (one, other, there), (back, forth, too) = (_amid(off * way, half, reach, begin) for way in (1, -1))
    some = there | too
    count = np.maximum(there * 1.0 + too, 1)
    one, other = ((one * there - forth * too) / count)[some], ((other * there - back * too) / count)[some]
    at, reach = group[some], reach[some]
    middle, line = middle.copy(), line.copy()
    middle[at] += line[at] * 0.5j * (one + other)
    turned = 2 * reach + 1j * (other - one)
    line[at] *= turned / np.abs(turned)
    return middle, line


def _amid(off: Points, half: Points, reach: Floats, begin: Ints) -> tuple[Floats, Floats, Bools]:
    """Return the mean offsets (g,) of possible lines at -reach and at reach, and whether there are any.

    Of the crossings (n,), by groups that begin at some of them, there are their places along and across a line, and halves of their dual
    edges, upwards. The offsets that are tried are those at -reach.
    """
    place = np.repeat(np.arange(len(begin)), np.diff(begin, append=len(off)))
    # The bound of a second offset for a first one f is y / share - f (1 - share) / share, for each end of a dual edge.
    sides = []
    for side, extreme in ((off - half, np.maximum), (off + half, np.minimum)):
        share = (side.real / reach[place] + 1) / 2
        sides.append((side.imag / share, 1 / share - 1, extreme))
    steps = np.linspace(-1, 1, OFFSETS)[:, None]
    centre, width = np.zeros(len(begin)), np.full(len(begin), FARTHEST_LINE)
    for _ in range(2):  # where there is room at all; then there alone
        first = centre + steps * width
        bounds = [[extreme.reduceat(y - each[place] * slope, begin) for y, slope, extreme in sides] for each in first]
        low, high = np.array(bounds).transpose(1, 0, 2)
        centre, width = _range(first, high - low)
    room = np.maximum(high - low, 0)
    total = room.sum(axis=0)
    weight = room / np.where(total > 0, total, 1)
    return (weight * first).sum(axis=0), (weight * (low + high) / 2).sum(axis=0), total > 0


def _range(first: Floats, room: Floats) -> tuple[Floats, Floats]:
    """Return the middle and half the width (g,) of where there is room (k, g), or lacks least of it, and a step to either side."""
    step, there = first[1] - first[0], room >= np.minimum(room.max(axis=0), 0)
    low, high = np.where(there, first, np.inf).min(axis=0), np.where(there, first, -np.inf).max(axis=0)
    return (low + high) / 2, (high - low) / 2 + step


def _least_squares(z: Points, which: Ints, count: int) -> tuple[Points, Points]:
    """Return the middle and the direction of the line (count,) of least squares through the points of each group."""

    def sums(values: Points) -> Points:
        return np.asarray(np.bincount(which, values.real, count) + 1j * np.bincount(which, values.imag, count))

    middle = sums(z) / np.bincount(which, minlength=count)
    off = z - middle[which]
    # Half the argument of the sum of squares of complex offsets.
    return middle, np.asarray(np.exp(0.5j * np.angle(sums(off * off))))
