"""The usual measures of how good a triangle is.

In: vertices and triangles. Out: one number per triangle and metric. Names and definitions are those of Verdict, which VTK and
pyvista compute too (C. Stimpson et al., The Verdict Library Reference Manual, Sandia, SAND2007-2853P), so that a figure found here
can be compared with one found there; ``q``, ``shortest_edge`` and ``longest_edge`` are added. A metric knows no orientation: a
triangle turned over measures as its mirror image.

Edge lengths and (signed) areas are those of libigl to the bit, `img2tri.triangle_angles` has angles that are exact to rounding even for
needles. All other metrics are a few products of these, and cost far less than through libigl, which finds circumcentres where only their
radius is wanted, and imports SciPy's sparse matrices.

A triangle without area has a defined measure: 0 for what lies between 0 and 1 (``q``, ``shape``, ``scaled_jacobian``), Verdict's limit
of 1e30 for what has no upper bound, and the angles it has in the limit: 0, 0, 180 for three vertices on a line, 90, 90, 0 where two
coincide.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.triangle_angles import triangle_angles

UNBOUNDED = 1e30
"""What Verdict returns in place of infinity: means stay finite, and JSON has a way to write it."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """What the metrics are computed from, each part when it is first asked for. Edge k is opposite to corner k."""

    vertices: Floats
    triangles: Ints

    @property
    def _corners(self) -> tuple[Floats, Floats]:
        """X and y (3, m) of the corners."""
        corners = self.triangles.T
        return self.vertices[:, 0][corners], self.vertices[:, 1][corners]

    @cached_property
    def lengths(self) -> Floats:
        """(m, 3) lengths of the edges."""
        x, y = self._corners
        return np.stack([np.sqrt((x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2) for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)

    @cached_property
    def areas(self) -> Floats:
        """(m,) areas, negative for triangles turned over."""
        x, y = self._corners
        return np.asarray(((x[0] - x[2]) * (y[1] - y[2]) - (y[0] - y[2]) * (x[1] - x[2])) / 2)

    @cached_property
    def angles(self) -> Floats:
        """(m, 3) angles in degrees, those of triangles without area by their limits."""
        angles: Floats = np.degrees(triangle_angles(self.vertices, self.triangles))
        flat = np.flatnonzero((self.lengths == 0).any(axis=1))
        # Two corners coincide: both angles at them tend to 90 degrees, if the two come together from any side alike.
        # All three coincide: nothing tends anywhere; 0, 0, 180 is the worst a triangle can be.
        zero = self.lengths[flat] == 0
        angles[flat] = np.where(zero.all(axis=1)[:, None], [0.0, 0.0, 180.0], np.where(zero, 0.0, 90.0))
        return angles

    @cached_property
    def size(self) -> Floats:
        """(m,) areas without their sign."""
        size: Floats = np.abs(self.areas)
        return size

    @cached_property
    def perimeter(self) -> Floats:
        """(m,) sums of the edges."""
        perimeter: Floats = self.lengths.sum(axis=1)
        return perimeter

    @cached_property
    def product(self) -> Floats:
        """(m,) products of the edges."""
        product: Floats = self.lengths.prod(axis=1)
        return product

    @cached_property
    def squares(self) -> Floats:
        """(m,) sums of the squared edges."""
        squares: Floats = np.einsum("ij,ij->i", self.lengths, self.lengths)
        return squares


@dataclass(frozen=True)
class Metric:
    """One measure of the quality of a triangle.

    Attributes
    ----------
    name
        As in Verdict and pyvista, where they have it.
    description
        One line: formula or meaning.
    unit
        "" for a plain number, "degrees", "length" or "area" (of the world).
    best
        Value of the equilateral triangle; None where that depends on its size.
    acceptable
        (low, high): the range Verdict calls acceptable (the one for `q` is ours); None where there is none.
    range
        (low, high): what values are possible.
    function
        From `Geometry` to (m,) float64.
    """

    name: str
    description: str
    unit: str
    best: float | None
    acceptable: tuple[float, float] | None
    range: tuple[float, float]
    function: Callable[[Geometry], Floats]


def _over(numerator: Floats, denominator: Floats, at_zero: float = UNBOUNDED) -> Floats:
    """Divide, with `at_zero` where the denominator is zero and nothing above `UNBOUNDED`."""
    with np.errstate(over="ignore"):
        result = np.divide(numerator, denominator, out=np.full(len(numerator), at_zero), where=denominator > 0)
    capped: Floats = np.minimum(result, UNBOUNDED)
    return capped


def _sine(t: Geometry) -> Floats:
    """Return the sine of the smallest angle: twice the area over the two longest edges."""
    longest, shortest = t.lengths.max(axis=1), t.lengths.min(axis=1)
    return _over(2 * t.size, longest * (t.perimeter - longest - shortest), 0.0)


def _relative_size(t: Geometry) -> Floats:
    """Return the area over the mean area, or its inverse where that is less, squared."""
    ratio = _over(t.size, np.full(len(t.size), t.size.mean()), 0.0)
    squared: Floats = np.minimum(ratio, _over(np.ones(len(ratio)), ratio)) ** 2
    return squared


_ROOT = np.sqrt(3.0)
_POSITIVE, _UNIT, _FROM_ONE = (0.0, np.inf), (0.0, 1.0), (1.0, np.inf)

METRICS: dict[str, Metric] = {
    m.name: m
    for m in (
        Metric(
            "q",
            "2 r / R, twice the inradius over the circumradius",
            "",
            1.0,
            (0.5, 1.0),
            _UNIT,
            lambda t: _over(16 * t.size**2, t.perimeter * t.product, 0.0),
        ),
        Metric("min_angle", "smallest angle", "degrees", 60.0, (30.0, 60.0), (0.0, 60.0), lambda t: t.angles.min(axis=1)),
        Metric("max_angle", "largest angle", "degrees", 60.0, (60.0, 90.0), (60.0, 180.0), lambda t: t.angles.max(axis=1)),
        Metric(
            "radius_ratio",
            "R / 2 r, circumradius over twice the inradius",
            "",
            1.0,
            (1.0, 3.0),
            _FROM_ONE,
            lambda t: _over(t.perimeter * t.product, 16 * t.size**2),
        ),
        Metric(
            "aspect_ratio",
            "longest edge over the inradius, over 2 sqrt(3)",
            "",
            1.0,
            (1.0, 1.3),
            _FROM_ONE,
            lambda t: _over(t.lengths.max(axis=1) * t.perimeter, 4 * _ROOT * t.size),
        ),
        Metric(
            "aspect_frobenius",
            "sum of squared edges over 4 sqrt(3) times the area",
            "",
            1.0,
            (1.0, 1.3),
            _FROM_ONE,
            lambda t: _over(t.squares, 4 * _ROOT * t.size),
        ),
        Metric(
            "condition",
            "condition number of the map from the equilateral triangle",
            "",
            1.0,
            (1.0, 1.3),
            _FROM_ONE,
            lambda t: _over(t.squares, 4 * _ROOT * t.size),
        ),
        Metric(
            "scaled_jacobian",
            "sine of the smallest angle, over that of 60 degrees",
            "",
            1.0,
            (0.5, 1.0),
            _UNIT,
            lambda t: 2 / _ROOT * _sine(t),
        ),
        Metric(
            "shape",
            "4 sqrt(3) times the area over the sum of squared edges",
            "",
            1.0,
            (0.25, 1.0),
            _UNIT,
            lambda t: _over(4 * _ROOT * t.size, t.squares, 0.0),
        ),
        Metric("relative_size_squared", "area over the mean area or its inverse, squared", "", 1.0, (0.25, 1.0), _UNIT, _relative_size),
        Metric(
            "shape_and_size",
            "shape times relative_size_squared",
            "",
            1.0,
            (0.25, 1.0),
            _UNIT,
            lambda t: _over(4 * _ROOT * t.size, t.squares, 0.0) * _relative_size(t),
        ),
        Metric("area", "area, without its sign", "area", None, None, _POSITIVE, lambda t: t.size),
        Metric("shortest_edge", "length of the shortest edge", "length", None, None, _POSITIVE, lambda t: t.lengths.min(axis=1)),
        Metric("longest_edge", "length of the longest edge", "length", None, None, _POSITIVE, lambda t: t.lengths.max(axis=1)),
    )
}
"""All metrics by name. Verdict's `distortion` is 1 for every triangle with straight edges and left out."""
