"""The edges of a mesh with the triangles on their sides, found once for all that is judged by them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Ints, unique_edges


@dataclass(frozen=True, eq=False)
class EdgeSides:
    """The edges of a mesh, and what lies on their sides.

    Attributes
    ----------
    edges
        (e, 2) int64, lower vertex first.
    sides
        (3 m,) int64, the edge of each side of each triangle, side ``3 i + k`` from corner k of triangle i to the next.
    counts
        (e,) int64, how many triangles each edge has.
    first, last
        (e,) int64, the first and the last side at each edge: its only two, but where more than two triangles meet.
    """

    edges: Ints
    sides: Ints
    counts: Ints
    first: Ints
    last: Ints

    @classmethod
    def of(cls, triangles: Ints) -> EdgeSides:
        """Find the edges of triangles (m, 3)."""
        edges, found = unique_edges(triangles)
        sides, number = found.ravel(), np.arange(found.size)
        first, last = np.empty((2, len(edges)), np.int64)
        last[sides] = number
        first[sides[::-1]] = number[::-1]
        return cls(edges, sides, np.bincount(sides), first, last)

    def span(self, number: Ints) -> tuple[Ints, Ints]:
        """Return the least and the greatest of the numbers (m,) of the triangles at each edge."""
        one, other = number[self.first // 3], number[self.last // 3]
        low, high = np.minimum(one, other), np.maximum(one, other)
        crowded = np.flatnonzero((self.counts > 2)[self.sides])
        np.minimum.at(low, self.sides[crowded], number[crowded // 3])
        np.maximum.at(high, self.sides[crowded], number[crowded // 3])
        return low, high

    def curves(self, number: Ints) -> Bools:
        """Tell which edges bound the mesh or part two regions, or have more than two triangles."""
        low, high = self.span(number)
        return np.asarray((self.counts != 2) | (low < high))
