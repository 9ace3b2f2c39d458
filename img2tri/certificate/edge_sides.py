"""The edges of a mesh with the triangles on their sides, found once for all that is judged by them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints, runs, sorted_sides


@dataclass(frozen=True, eq=False)
class EdgeSides:
    """Edges of a mesh, and the sides of triangles at each: side ``3 i + k`` from corner k of triangle i to the next.

    Attributes
    ----------
    sides
        (s,) integer, those of one edge follow each other, in their order.
    starts
        (e + 1,) integer: edge i has ``sides[starts[i]:starts[i + 1]]``.
    lower, higher
        (e,) integer, the vertices at its ends.
    """

    sides: NDArray[np.integer[Any]]
    starts: NDArray[np.integer[Any]]
    lower: NDArray[np.integer[Any]]
    higher: NDArray[np.integer[Any]]

    @classmethod
    def of(cls, triangles: Ints) -> EdgeSides:
        """Find the edges of triangles (m, 3)."""
        sides, lower, higher = sorted_sides(triangles)
        new = np.ones(len(sides) + 1, bool)
        np.not_equal(lower[1:], lower[:-1], out=new[1:-1])
        new[1:-1] |= higher[1:] != higher[:-1]
        starts = new.nonzero()[0].astype(sides.dtype)
        return cls(sides, starts, lower.take(starts[:-1]), higher.take(starts[:-1]))

    @property
    def edges(self) -> Ints:
        """(e, 2) int64, lower vertex first."""
        return np.stack([self.lower, self.higher], axis=1).astype(np.int64)

    @property
    def counts(self) -> NDArray[np.integer[Any]]:
        """(e,) how many sides each edge has."""
        return np.diff(self.starts)

    @property
    def edge(self) -> Ints:
        """(s,) the edge of each side."""
        return np.arange(len(self.lower)).repeat(self.counts)

    def at_both_ends(self) -> tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]]]:
        """Return the first and the last side (e,) at each edge: its only two, but where more than two triangles meet."""
        return self.sides.take(self.starts[:-1]), self.sides.take(self.starts[1:] - 1)

    def curves(self, regions: Ints) -> Bools:
        """Tell which edges bound the mesh or part two regions (m,), or have more than two triangles."""
        found = self.counts != 2
        if regions.min(initial=0) < regions.max(initial=0):
            first, last = self.at_both_ends()
            found |= regions[first // 3] != regions[last // 3]
        return np.asarray(found)

    def among(self, chosen: Bools) -> EdgeSides:
        """Return the chosen (e,) edges alone."""
        at, counts = chosen.nonzero()[0], self.counts[chosen]
        edge, place = runs(counts.astype(np.int64))
        sides = self.sides[self.starts[at][edge] + place]
        return EdgeSides(sides, np.append(np.cumsum(counts) - counts, len(sides)), self.lower[at], self.higher[at])
