"""Smoothing splines along chains of points: the smooth curve of a scale, and what else follows the arc.

A discrete smoothing spline, or Whittaker smoother of order three (Whittaker, "On a new method of graduation", 1923, DOI
10.1017/S0013091500077853; Eilers, "A perfect smoother", 2003, DOI 10.1021/ac034173t): the curve has the least sum of its squared
distances from the points, each weighted by its share of the arc, and of ``(WIDTH scale)^6`` times the integral of a squared third
derivative. It is the solution of one banded system of equations, as quick for a wide scale as for a narrow one, which a Gaussian is
not.

`SmoothingSpline` takes the third derivative of x and y. Wide ones shrink circles that way, and open them at the ends of a chain.
`CurvatureSpline` looks for the curve along the normals of a narrow one, and counts only the part of the third derivative across the
curve, which is how curvature varies along the arc (Moreton and Sequin, "Functional optimization for fair surface design", SIGGRAPH
1992): circles cost nothing.

Nodes do not count: a chain goes on to its ends as the rest of it has it. Arc length is measured along the points smoothed a little: the
steps of pixels make a line longer, by up to the root of two, and by how much depends on its direction.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.shapes.place.padded_chains import PaddedChains, convolve

WIDTH = 0.4775  # of the scale: waves three scales long are left with half of their height
ARC_BLUR = 2.2  # places: the Gaussian that takes the steps of pixels out of the length of a line
LEAST_STEP = 0.2  # px, the least way counted from place to place: with shorter ones the equations are badly conditioned
NODE_WEIGHT = 0.01  # of a node, relative to a crossing: too little to matter, enough that rounding does not either
PADDING = 11  # places of padding that chains need: 3 for the third derivative, the rest for the Gaussian


class SmoothingSpline:
    """Smoothing splines through the points of chains.

    Attributes
    ----------
    line, points
        The chains, padded, and (k,) where their places lie.
    steps
        (k - 1,) float64, the way along the arc from each place to the next, in px; without meaning between chains.
    """

    def __init__(self, line: PaddedChains, points: Points) -> None:
        """Prepare what does not depend on the scale.

        Parameters
        ----------
        line, points
            Chains with a padding of `PADDING` places or more, and (k,) its points, from `PaddedChains.points`.
        """
        self.line, self.points = line, points
        self.steps = np.maximum(np.abs(np.diff(convolve(points, _gaussian(ARC_BLUR)))), LEAST_STEP)
        places, factors = _third_derivatives(line, self.steps)
        # Factors add up to 0: places are taken from the first of four, not from afar, for the sake of rounding.
        third = (factors * (points[places] - points[places[0]])).sum(axis=0)
        self._equations = _Equations(line, self.steps, places, factors)
        self._pull = -self._equations.transposed(np.stack([third.real, third.imag], axis=1))

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
        # The curve is S points = (S + stiffness D' D) curve; what is solved for is how far it is off the points.
        stiffness = (WIDTH * scale) ** 6
        found = self._equations.solved(stiffness, stiffness * self._pull)
        off: Points = self.line.sign * (found[:, 0] + 1j * found[:, 1])[self._equations.unknown]
        return off, directions(self.line, self.points + off)


class CurvatureSpline:
    """Smoothing splines of least variation of curvature, along the normals of a narrow one."""

    def __init__(self, narrow: SmoothingSpline, scale: float) -> None:
        """Prepare what does not depend on the scale; `scale` is that of the narrow spline, in px."""
        self._line, self._points = narrow.line, narrow.points
        off, direction = narrow.smoothed(scale)
        self._base, self._normal = self._points + off, 1j * direction
        steps = np.maximum(np.abs(np.diff(self._base)), LEAST_STEP)
        places, factors = _third_derivatives(self._line, steps)
        across = self._normal[places[1]] + self._normal[places[2]]
        across /= np.maximum(np.abs(across), 1e-12)
        third = (factors * ((self._base[places] - self._base[places[0]]) * across.conj()).real).sum(axis=0)
        factors *= (self._normal[places] * across.conj()).real
        self._equations = _Equations(self._line, steps, places, factors)
        self._pull = -self._equations.transposed(third[:, None])
        self._wanted = self._equations.of_unknowns(-(off * self._normal.conj()).real)[:, None]

    def smoothed(self, scale: float) -> tuple[Points, Points]:
        """Smooth the chains along their arc, see `SmoothingSpline.smoothed`."""
        equations, stiffness = self._equations, (WIDTH * scale) ** 6
        found = equations.solved(stiffness, stiffness * self._pull + equations.share[:, None] * self._wanted)
        curve = self._base + self._line.sign * found[equations.unknown, 0] * self._normal
        return curve - self._points, directions(self._line, curve)


class _Equations:
    """The equations (S + stiffness D' D) x = b, with unknowns for own places, numbered so that their band is narrow.

    Attributes
    ----------
    unknown
        (k,) int64, the unknown of each place.
    share
        (u,) float64, the diagonal of S: the stretch of arc each unknown stands for; nodes hardly count.
    """

    def __init__(self, line: PaddedChains, steps: Floats, places: Ints, factors: Floats) -> None:
        """Set up D of rows with factors (4, m) at four places each."""
        self._own, self.unknown = np.flatnonzero(line.own), _folded(line)
        self.share = self.of_unknowns(np.concatenate([steps[:1], steps]) + np.concatenate([steps, steps[-1:]])) / 2
        self.share[self.unknown[line.node]] *= NODE_WEIGHT
        self._at = self.unknown[places]
        self._factors = factors * line.sign[places]  # a place that repeats another one turned moves the other way
        # The lower half of D' D by diagonals, entry (i, j) of it at [i - j, j].
        # Where two of four places stand for one unknown, both halves count.
        at, size = self._at, len(self._own)
        i, j = np.tril_indices(4)
        both = 1 + ((i != j)[:, None] & (at[i] == at[j]))
        entry = np.abs(at[i] - at[j]) * size + np.minimum(at[i], at[j])
        squares = np.bincount(entry.ravel(), (both * self._factors[i] * self._factors[j]).ravel(), 7 * size)
        self._squares = np.asarray(squares, np.float64).reshape(7, size)

    def of_unknowns(self, values: Floats) -> Floats:
        """Give each unknown (u,) the value of its own place, out of (k,)."""
        result = np.zeros(len(self._own))
        result[self.unknown[self._own]] = values[self._own]
        return result

    def transposed(self, rows: Floats) -> Floats:
        """Return D' rows (u, c), of rows (m, c)."""
        of_each = [np.bincount(self._at.ravel(), (row * self._factors).ravel(), len(self._own)) for row in rows.T]
        return np.stack(of_each, axis=1)

    def solved(self, stiffness: float, b: Floats) -> Floats:
        """Solve for x (u, c), and once more for what rounding left: wide scales make D' D outweigh S by ten orders and more."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        band = stiffness * self._squares
        band[0] += self.share
        factor = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)
        x: Floats = cho_solve_banded((factor, True), b, check_finite=False)
        rows = np.stack([(self._factors * part[self._at]).sum(axis=0) for part in x.T], axis=1)
        left = b - self.share[:, None] * x - stiffness * self.transposed(rows)
        return x + np.asarray(cho_solve_banded((factor, True), left, overwrite_b=True, check_finite=False))


def directions(line: PaddedChains, curve: Points) -> Points:
    """Return the unit directions (k,) of a curve at each place; at a node it goes on as it does beside it."""
    slope, node = np.gradient(curve), np.flatnonzero(line.node)
    slope[node] = slope[np.where(line.own[node + 1], node + 1, node - 1)]
    return np.asarray(slope / np.maximum(np.abs(slope), 1e-12))


def _third_derivatives(line: PaddedChains, steps: Floats) -> tuple[Ints, Floats]:
    """Four places in a row (4, m), and their factors in the third derivative there, times the root of the stretch it stands for.

    Of a ring all rows count once, of an open chain those that do not go beyond its ends.
    """
    own, ring = line.own, line.ring
    places = np.flatnonzero(own[:-3] & (ring[:-3] | own[3:])) + np.arange(4)[:, None]
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
