"""Smoothing splines along chains of points: the smooth curve of a scale, and what else follows the arc.

A discrete smoothing spline, or Whittaker smoother of order three (Whittaker, "On a new method of graduation", 1923, DOI
10.1017/S0013091500077853; Eilers, "A perfect smoother", 2003, DOI 10.1021/ac034173t): the curve has the least sum of its squared
distances from the points, each weighted by its share of the arc, and of ``(WIDTH scale)^6`` times the integral of a squared third
derivative. It is the solution of one banded system of equations, as quick for a wide scale as for a narrow one, which a Gaussian is
not.

`SmoothingSpline` takes the third derivative of x and y. Wide ones shrink circles that way, and open them at the ends of a chain.
`CurvatureSpline` looks for the curve along the normals of a narrow one, and counts only the part of the third derivative across the
curve, which is how curvature varies along the arc (Moreton and Sequin, "Functional optimization for fair surface design", SIGGRAPH
1992): circles cost nothing. What is left of the steps of pixels in the narrow one is in its normals and its arc, so in all that rest on
it: on one of scale 7 rather than 4 the outlines of large discs are a third less wavy.

Nodes do not count: a chain goes on to its ends as the rest of it has it. Arc length is measured along the points smoothed a little: the
steps of pixels make a line longer, by up to the root of two, and by how much depends on its direction.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, Points, as_complex, as_rows
from img2tri.scipy_kernels import banded_cholesky
from img2tri.shapes.place.along_the_arc import ArcLengths
from img2tri.shapes.place.padded_chains import PaddedChains, convolve, gaussian

WIDTH = 0.4775  # of the scale: waves three scales long are left with half of their height
ARC_BLUR = 2.2  # places: the Gaussian that takes the steps of pixels out of the length of a line
LEAST_STEP = 0.5  # px, the least way counted from place to place: with shorter ones the equations are badly conditioned
NODE_WEIGHT = 0.01  # of a node, relative to a crossing: too little to matter, enough that rounding does not either
WELL_CONDITIONED = 1e4  # px^6, stiffness up to which solving once is enough
PADDING = 11  # places of padding that chains need: 3 for the third derivative, the rest for the Gaussian


class SmoothingSpline:
    """Smoothing splines through the points of chains.

    Attributes
    ----------
    line, points
        The chains, padded, and (k,) where their places lie.
    steps, arc
        (k - 1,) float64, the way along the arc from each place to the next, in px, without meaning between chains; and ways of any length.
    """

    def __init__(self, line: PaddedChains, points: Points) -> None:
        """Prepare what does not depend on the scale.

        Parameters
        ----------
        line, points
            Chains with a padding of `PADDING` places or more, and (k,) its points, from `PaddedChains.points`.
        """
        self.line, self.points, self.numbering = line, points, _Numbering(line)
        self.steps = np.maximum(np.abs(np.diff(convolve(points, gaussian(ARC_BLUR)))), LEAST_STEP)
        self.arc = ArcLengths(line, self.steps)
        self._known: dict[float, tuple[Points, Points]] = {}
        near = self.numbering.near
        steps, z = self.steps[near[:-1]], points[near]
        factors = self.numbering.third_derivatives(steps)
        self._equations = _Equations(self.numbering, steps, factors, _rows(factors, np.stack([z.real, z.imag])))

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
        if scale not in self._known:
            # The curve is S points = (S + stiffness D' D) curve; what is solved for is how far it is off the points.
            found = self._equations.solved((WIDTH * scale) ** 6)
            off = as_complex(np.ascontiguousarray(found.T))[self.numbering.unknown]
            as_rows(off)[:] *= self.line.sign[:, None]
            self._known[scale] = off, directions(self.line, self.points + off)
        return self._known[scale]


class CurvatureSpline:
    """Smoothing splines of least variation of curvature, along the normals of a narrow one."""

    def __init__(self, narrow: SmoothingSpline, scale: float) -> None:
        """Prepare what does not depend on the scale; `scale` is that of the narrow spline, in px."""
        self._line, self._points, self._numbering = narrow.line, narrow.points, narrow.numbering
        off, direction = narrow.smoothed(scale)
        self._base, self._normal = self._points + off, 1j * direction
        near = self._numbering.near
        base, normal = self._base[near], self._normal[near]
        steps = np.maximum(np.abs(np.diff(base)), LEAST_STEP)
        factors = self._numbering.third_derivatives(steps)
        across = normal[1:-2] + normal[2:-1]
        across /= np.maximum(np.abs(across), 1e-12)
        across = across.conj()
        count = len(across)
        third = np.zeros(count)
        for i in range(1, 4):
            third += factors[i] * ((base[i : i + count] - base[:count]) * across).real
        for i in range(4):
            factors[i] *= (normal[i : i + count] * across).real
        self._equations = _Equations(
            self._numbering, steps, factors, third[None], self._numbering.of_unknowns(-(off[near] * normal.conj()).real)
        )

    def smoothed(self, scale: float) -> tuple[Points, Points]:
        """Smooth the chains along their arc, see `SmoothingSpline.smoothed`."""
        found = self._equations.solved((WIDTH * scale) ** 6)
        curve = self._base + self._line.sign * found[0, self._numbering.unknown] * self._normal
        return curve - self._points, directions(self._line, curve)


class _Numbering:
    """Numbers for the unknowns of own places, such that the band of their equations is narrow; and where entries of D' D belong.

    Rows of D have factors for four places in a line. They are laid out along the line, own places and three more to either side,
    where rings go on; so D, D' and D' D are sums of shifted products, without a search for places::

        row             0  1  2  3  ...       factor i of row r is that of place r + i
        place           0  1  2  3  4  5  6

    Attributes
    ----------
    unknown
        (k,) int64, the unknown of each place of the line.
    near
        (c,) int64, the places along which rows are laid out.
    own
        (u,) int64, those of them that are own places, by their unknowns.
    """

    def __init__(self, line: PaddedChains) -> None:
        self.unknown, self.near = _folded(line), np.flatnonzero(line.within(3))
        own, ring, chain, at = (values[self.near] for values in (line.own, line.ring, line.chain, self.unknown))
        count = len(at) - 3
        # Of a ring all rows count, of an open chain those that do not go beyond its ends.
        self._rows = (chain[:count] == chain[3:]) & (ring[:count] | (own[:count] & own[3:]))
        places = np.flatnonzero(own)
        self.at, self.own = at, np.empty(len(places), np.int64)
        self.own[at[places]] = places
        self.nodes = at[line.node[self.near]]
        # The lower half of D' D by diagonals, entry (i, j) of it at [j, i - j], out of the products of places and those `lag` after them.
        target, source = [], []
        for lag in range(4):
            there = places if lag == 0 else places[ring[places] | own[places + lag]]
            one, other = at[there], at[there + lag]
            target.append(np.minimum(one, other) * 7 + np.abs(one - other))
            source.append(there + lag * len(at))
        self.target, self.source = np.concatenate(target), np.concatenate(source)

    def of_unknowns(self, values: Floats) -> Floats:
        """Give the unknowns (..., u) the values of their own places, out of (..., c)."""
        return values.take(self.own, axis=-1)

    def third_derivatives(self, steps: Floats) -> Floats:
        """Return the factors (4, c - 3) of third derivatives, of places so far from the next one (c - 1,).

        They are times the root of the stretch a row stands for, and 0 where there is no row.
        """
        a, b, c = steps[:-2], steps[1:-1], steps[2:]
        ab, bc = a + b, b + c
        abc = ab + c
        # One over the product of the distances to the other three, the sign of which alternates.
        factors = np.stack([-1 / (a * ab * abc), 1 / (a * b * bc), -1 / (ab * b * c), 1 / (abc * bc * c)])
        factors *= np.where(self._rows, 6 * np.sqrt(abc / 3), 0.0)
        return factors


class _Equations:
    """Least squares: S (x - wanted)^2 + stiffness (D x + third)^2, so (S + stiffness D' D) x = S wanted - stiffness D' third."""

    def __init__(self, numbering: _Numbering, steps: Floats, factors: Floats, third: Floats, wanted: Floats | float = 0.0) -> None:
        """Set up D with factors (4, c - 3) at places so far from the next one (c - 1,); third (d, c - 3), and wanted (u,) or 0."""
        self._numbering, self._factors, self._third = numbering, factors, third
        own, count = numbering.own, factors.shape[1]
        # S is diagonal: the stretch of arc each unknown stands for; nodes hardly count.
        self._share = (steps[own - 1] + steps[own]) / 2
        self._share[numbering.nodes] *= NODE_WEIGHT
        self._wanted = self._share * wanted
        self._pull = self._transposed(third)
        products = np.zeros((4, count + 3))
        for lag in range(4):
            for i, product in enumerate(factors[lag:] * factors[: 4 - lag]):
                products[lag, i : i + count] += product
        self._squares = np.zeros((len(own), 7))
        self._squares.reshape(-1)[numbering.target] = products.reshape(-1)[numbering.source]

    def _transposed(self, rows: Floats) -> Floats:
        """Return D' rows (d, u), of rows (d, c - 3)."""
        count = rows.shape[1]
        result = np.zeros((len(rows), count + 3))
        for i, factor in enumerate(self._factors):
            result[:, i : i + count] += factor * rows
        return self._numbering.of_unknowns(result)

    def solved(self, stiffness: float) -> Floats:
        """Solve for x (d, u), and once more for what rounding left: wide scales make D' D outweigh S by ten orders and more."""
        dpbtrf, dpbtrs = banded_cholesky()
        band = stiffness * self._squares
        band[:, 0] += self._share
        # Bands and right hand sides lie as LAPACK wants them: nothing is copied.
        factor, failed = dpbtrf(band.T, lower=1, overwrite_ab=1)
        if failed:
            raise np.linalg.LinAlgError("smoothing spline: the equations are not positive definite")
        x = dpbtrs(factor, (self._wanted - stiffness * self._pull).T, lower=1, overwrite_b=1)[0].T
        if stiffness < WELL_CONDITIONED:
            return np.asarray(x)
        # What is left, from the third derivatives of the curve: D x and `third` cancel before they are multiplied by what is great.
        at, count = self._numbering.at, self._factors.shape[1]
        along, rows = x.take(at, axis=1), self._third.copy()
        for i, each in enumerate(self._factors):
            rows += each * along[:, i : i + count]
        left = self._wanted - self._share * x - stiffness * self._transposed(rows)
        x += dpbtrs(factor, left.T, lower=1, overwrite_b=1)[0].T
        return np.asarray(x)


def _rows(factors: Floats, values: Floats) -> Floats:
    """Return D values (d, c - 3), of values (d, c); from the first of four places, not from afar, for the sake of rounding."""
    count = factors.shape[1]
    first, rows = values[:, :count], np.zeros((len(values), count))
    for i in range(1, 4):
        rows += factors[i] * (values[:, i : i + count] - first)
    return rows


def directions(line: PaddedChains, curve: Points) -> Points:
    """Return the unit directions (k,) of a curve at each place; at a node it goes on as it does beside it."""
    slope, node = np.empty_like(curve), np.flatnonzero(line.node)
    slope[1:-1] = curve[2:] - curve[:-2]
    slope[[0, -1]] = slope[[1, -2]]
    slope[node] = slope[np.where(line.own[node + 1], node + 1, node - 1)]
    as_rows(slope)[:] *= (1 / np.maximum(np.abs(slope), 1e-12))[:, None]
    return slope


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
