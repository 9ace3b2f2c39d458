"""Smoothing splines along chains of points: the smooth curve of a scale, and what else follows the arc.

A discrete smoothing spline, or Whittaker smoother of order three (Whittaker, "On a new method of graduation", 1923, DOI
10.1017/S0013091500077853; Eilers, "A perfect smoother", 2003, DOI 10.1021/ac034173t): the curve has the least sum of its squared
distances from the points, each weighted by its share of the arc, and of ``(WIDTH scale)^6`` times the integral of its squared third
derivative. Straight lines and parabolas cost nothing, so arcs hardly shrink. It is the solution of one banded system of equations,
as quick for a wide scale as for a narrow one, which a Gaussian is not.

Arc length is measured along the points smoothed a little: the steps of pixels make a line longer, by up to the root of two, and by how
much depends on its direction.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.shapes.place.padded_chains import PaddedChains, convolve

WIDTH = 0.4775  # of the scale: waves three scales long are left with half of their height
ARC_BLUR = 2.2  # places: the Gaussian that takes the steps of pixels out of the length of a line
LEAST_STEP = 1e-3  # px
HELD = 1e12  # weight of a node that stays, relative to all that pulls at it
PADDING = 11  # places of padding that chains need: 3 for the third derivative, the rest for the Gaussian


class SmoothingSpline:
    """Smoothing splines through the points of chains; nodes stay where they are, or are not counted at all if they are free.

    Attributes
    ----------
    steps
        (k - 1,) float64, the way along the arc from each place on the line to the next, in px; without meaning between chains.
    """

    def __init__(self, line: PaddedChains, points: Points, free: Bools) -> None:
        """Prepare what does not depend on the scale.

        Parameters
        ----------
        line, points
            Chains with a padding of `PADDING` places or more, and (k,) its points, from `PaddedChains.points`.
        free
            (n,) bool, the points that are free if they are nodes: there the curve goes on as the rest of the chain has it.
        """
        self.steps = np.maximum(np.abs(np.diff(convolve(points, _gaussian(ARC_BLUR)))), LEAST_STEP)
        self._line, self._points, loose = line, points, free[line.end]
        self._loose = np.flatnonzero(line.node & loose)
        places, factors = _third_derivatives(line, self.steps, loose)
        self._unknown, size = _folded(line), int(line.own.sum())
        at, third = self._unknown[places], (factors * points[places]).sum(axis=0)
        factors = factors * line.sign[places]  # a place that repeats another one turned moves the other way

        # The lower half of D' D by diagonals, entry (i, j) of it at [i - j, j].
        # Where two of four places stand for one unknown, both halves count.
        i, j = np.tril_indices(4)
        both = 1 + ((i != j)[:, None] & (at[i] == at[j]))
        entry = np.abs(at[i] - at[j]) * size + np.minimum(at[i], at[j])
        self._bending = np.bincount(entry.ravel(), (both * factors[i] * factors[j]).ravel(), 7 * size).reshape(7, size)
        pull = -third * factors
        self._pull = np.stack([np.bincount(at.ravel(), part.ravel(), size) for part in (pull.real, pull.imag)], axis=1)

        own = np.flatnonzero(line.own)
        fixed, self._share = np.flatnonzero(line.node & ~loose), np.zeros(size)
        self._share[self._unknown[own]] = (self.steps[own - 1] + self.steps[own]) / 2
        self._share[self._unknown[self._loose]] /= HELD
        self._fixed = self._unknown[fixed]

    def smoothed(self, scale: float) -> tuple[Points, Points]:
        """Smooth the chains along their arc.

        Parameters
        ----------
        scale
            In px: waves of half that length vanish, half is left of those of three scales, and all of those longer than six.

        Returns
        -------
        off : (k,) complex
            From each place on the line to the smooth curve.
        direction : (k,) complex
            The unit direction the curve goes on in.
        """
        from scipy.linalg import solveh_banded

        # The curve is S points = (S + stiffness D' D) curve; what is solved for is how far it is off the points.
        stiffness = (WIDTH * scale) ** 6
        band = stiffness * self._bending
        band[0] += self._share
        band[0, self._fixed] *= HELD
        found: Floats = solveh_banded(band, stiffness * self._pull, lower=True, overwrite_ab=True, overwrite_b=True, check_finite=False)
        off: Points = self._line.sign * (found[:, 0] + 1j * found[:, 1])[self._unknown]
        slope = np.gradient(self._points + off)
        # At a free node the curve goes on as it is at its neighbour.
        slope[self._loose] = slope[np.where(self._line.own[self._loose + 1], self._loose + 1, self._loose - 1)]
        return off, slope / np.maximum(np.abs(slope), 1e-12)


def _third_derivatives(line: PaddedChains, steps: Floats, free: Bools) -> tuple[Ints, Floats]:
    """Four places in a row (4, m), and their factors in the third derivative there, times the root of the stretch it stands for.

    Of a ring all rows count once, of an open chain those with their middle between its ends, but none that goes beyond a free end.
    """
    own, ring, real = line.own, line.ring, line.own | ~free
    places = np.flatnonzero(np.where(ring[:-3], own[:-3], own[1:-2] & own[2:-1] & real[:-3] & real[3:])) + np.arange(4)[:, None]
    a, b, c = steps[places[:3]]
    # One over the product of the distances to the other three, the sign of which alternates.
    factors = np.stack([-1 / (a * (a + b) * (a + b + c)), 1 / (a * b * (b + c)), -1 / ((a + b) * b * c), 1 / ((a + b + c) * (b + c) * c)])
    return places, 6 * np.sqrt((a + b + c) / 3) * factors


def _folded(line: PaddedChains) -> Ints:
    """Give each place (k,) the number of its unknown, such that neighbours are near: open chains in order, rings folded flat.

    ::

        a b c      numbers  0 2 4
        e d                 1 3
    """
    own = np.flatnonzero(line.own)
    chain = line.chain[own]
    size = np.bincount(chain)
    first = (np.cumsum(size) - size)[chain]
    along = np.arange(len(own)) - first
    back = size[chain] - along
    number = np.zeros(len(line.own), np.int64)
    number[own] = first + np.where(line.ring[own], np.where(along < back, 2 * along, 2 * back - 1), along)
    return np.asarray(number[line.original])


def farther_than(line: PaddedChains, steps: Floats, marks: Bools, distance: float) -> Bools:
    """Tell which places (k,) lie farther than `distance` px along the arc from all marked places of their chain."""
    own = np.flatnonzero(line.own)
    chain, ring, at = line.chain[own], line.ring[own], marks[own]
    first = np.flatnonzero(np.diff(chain, prepend=-1))
    length = np.add.reduceat(steps[own], first)
    along = np.cumsum(steps[own]) - steps[own]
    along -= along[first][chain]
    # Chains are laid out one after the other, out of each other's reach. In a ring there are marks before its start and after its end.
    arc = along + (np.cumsum(length + 3 * distance) - length)[chain]
    before, after = at & ring & (length[chain] - along <= distance), at & ring & (along <= distance)
    marked = np.concatenate([[-np.inf], arc[at], arc[before] - length[chain[before]], arc[after] + length[chain[after]], [np.inf]])
    marked.sort()
    next_one = np.searchsorted(marked, arc)
    far = np.zeros(len(line.own), bool)
    far[own] = np.minimum(arc - marked[next_one - 1], marked[next_one] - arc) > distance
    return np.asarray(far[line.original])


def fade_out(line: PaddedChains, values: Floats, width: float) -> Floats:
    """Let each value (k,) other than 0 fade to both sides, over about `width` places; those near each other do not add up."""
    fading = _gaussian(width)
    fading /= fading.max()
    crowd = np.convolve((values != 0).astype(np.float64), fading, "same")[line.original]
    return np.asarray(np.convolve(values / np.maximum(crowd, 1), fading, "same")[line.original])


def _gaussian(scale: float) -> Floats:
    """Return a Gaussian of standard deviation `scale` as a kernel; its sum is 1."""
    reach = int(np.ceil(3 * scale))
    g = np.exp(-0.5 * (np.arange(-reach, reach + 1) / scale) ** 2)
    return np.asarray(g / g.sum())
