"""The active cells of Poisson-disk sampling: squares in which there may be room for a point, split in four and sifted again and again.

In: a polygon, boundary points, and the distance to keep from these. Out: the squares, ever smaller, that reach into the polygon and are
not within reach of one boundary point altogether. Squares found to be free of both need no further look, so that the work follows
the length of the boundary, not the area. `poisson_disk` throws its darts into these squares.

The method is that of Ebeida, Mitchell, Patney, Davidson and Owens (2012), "A simple algorithm for maximal Poisson-disk sampling in high
dimensions", Computer Graphics Forum 31, https://doi.org/10.1111/j.1467-8659.2012.03059.x. Places are complex numbers x + iy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely import MultiPolygon, Polygon

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.errors import ParameterError

ROUND_OFF = 1 + 1e-9  # a square is dropped only when that cannot be due to rounding


@dataclass(frozen=True, eq=False)
class Squares:
    """Squares of one size: number (column, row) of a lattice that starts at the lower corner of the domain.

    `inside` says that a square lies inside the polygon altogether, `clear` that it is beyond the reach of all boundary points.

        +--------+        +----+----+
        |        |        | 23 | 33 |
        |   11   |   ->   +----+----+      column, row
        |        |        | 22 | 32 |
        +--------+        +----+----+
    """

    column: Ints
    row: Ints
    inside: Bools
    clear: Bools
    size: float

    @classmethod
    def one(cls, size: float) -> Squares:
        """Make one square, at the origin."""
        zero, no = np.zeros(1, np.int64), np.zeros(1, np.bool_)
        return cls(zero, zero, no, no, size)

    def __len__(self) -> int:
        return len(self.column)

    def only(self, kept: Bools | Ints) -> Squares:
        """Keep those named by a mask or by their numbers."""
        return Squares(self.column[kept], self.row[kept], self.inside[kept], self.clear[kept], self.size)

    def split(self) -> Squares:
        """Make four squares of each, next to each other in memory."""
        column = (2 * self.column[:, None] + np.array([0, 1, 0, 1])).ravel()
        row = (2 * self.row[:, None] + np.array([0, 0, 1, 1])).ravel()
        return Squares(column, row, np.repeat(self.inside, 4), np.repeat(self.clear, 4), self.size / 2)


@dataclass(frozen=True, eq=False)
class Domain:
    """A polygon to be in, and boundary points to keep further away from than `distance`."""

    polygon: Polygon | MultiPolygon
    edge: shapely.Geometry
    boundary: shapely.STRtree
    distance: float

    @classmethod
    def of(cls, region: Polygon | MultiPolygon | ArrayLike, boundary_points: ArrayLike, distance: float) -> Domain:
        """Check what is given, and make ready for many questions."""
        shape = isinstance(region, Polygon | MultiPolygon)
        polygon: Any = region if shape else Polygon(_finite_points("region", region, least=3))
        if not polygon.is_valid:
            raise ParameterError(f"region: expected a valid polygon, found one with this fault: {shapely.is_valid_reason(polygon)}")
        edge = polygon.boundary
        shapely.prepare(polygon)
        shapely.prepare(edge)
        return cls(polygon, edge, shapely.STRtree(shapely.points(_finite_points("boundary_points", boundary_points))), distance)

    def places(self, squares: Squares, within: Points | complex) -> Points:
        """Find places in each square: `within` runs from 0 to 1 + i, from its lower corner to the opposite one."""
        return complex(*self.polygon.bounds[:2]) + squares.size * (squares.column + 1j * squares.row + within)

    def with_room(self, squares: Squares) -> Squares:
        """Drop the squares without room, and find out which of the others are free altogether."""
        half = squares.size * math.sqrt(0.5)  # from the centre of a square to its corners
        centres = self.places(squares, 0.5 + 0.5j)
        room, inside, clear = np.ones(len(squares), np.bool_), squares.inside.copy(), squares.clear.copy()
        # A square that the edge does not pass through is all inside or all outside, as its centre is.
        ask = np.flatnonzero(~inside)
        crossed = shapely.dwithin(self.edge, shapely.points(centres.real[ask], centres.imag[ask]), half * ROUND_OFF)
        whole = ask[~crossed]
        inside[whole] = room[whole] = shapely.contains_xy(self.polygon, centres.real[whole], centres.imag[whole])
        # Within reach of a boundary point altogether, in part, or not at all: the distance of the centre to the nearest one tells.
        ask = np.flatnonzero(~clear & room)
        near = self._nearest(centres[ask], self.distance + half * ROUND_OFF)
        clear[ask] = np.isinf(near)
        room[ask] = near * ROUND_OFF > self.distance - half
        return Squares(squares.column, squares.row, inside, clear, squares.size).only(room)

    def accepts(self, darts: Points, squares: Squares) -> Bools:
        """Tell of each dart, thrown into its square, whether it is inside the polygon and far enough from all boundary points."""
        good = np.ones(len(darts), np.bool_)
        ask = np.flatnonzero(~squares.inside)
        good[ask] = shapely.contains_xy(self.polygon, darts.real[ask], darts.imag[ask])
        ask = np.flatnonzero(~squares.clear & good)
        good[ask] = self._nearest(darts[ask], self.distance * ROUND_OFF) > self.distance
        return good

    def _nearest(self, places: Points, reach: float) -> Floats:
        """Distance from each place to the nearest boundary point; infinite when there is none within `reach`."""
        distance = np.full(len(places), np.inf)
        if len(places) and len(self.boundary) and reach > 0:
            points = shapely.points(places.real, places.imag)
            (asked, _), near = self.boundary.query_nearest(points, max_distance=reach, return_distance=True, all_matches=False)
            distance[asked] = near
        return distance


def _finite_points(name: str, points: ArrayLike, *, least: int = 0) -> Floats:
    p = np.asarray(points, np.float64)
    p = p.reshape(0, 2) if p.size == 0 else p
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < least or not np.isfinite(p).all():
        raise ParameterError(f"{name}: expected at least {least} finite points (k, 2), found an array of shape {p.shape}")
    return p
