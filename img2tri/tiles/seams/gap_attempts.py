"""Which way of filling a gap is tried where: the next one only around the places at which the one before did not do.

Nearly everywhere the first does. Ways differ in how wide the gap is, how long edges of outlines are in it, and at last in how many of the
finished triangles around are given up too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows

# Of the longest edge at a vertex: a triangle nearer to the border gives way. And how long edges of outlines are in the gap, for what is
# usual there. The first does nearly everywhere; where it does not, the others are tried.
WIDTHS = (1.4, 2.0, 0.8, 1.4, 1.4, 1.4, 1.4, 2.0, 1.4)
SEGMENT_LENGTHS = (1.0, 1.0, 1.0, 1.4, 1.0, 1.0, 1.0, 1.0, 1.0)
# Of the margin: how far around such places finished triangles are given up, too.
EATEN = (0.0, 0.0, 0.0, 0.0, 0.15, 0.22, 0.3, 0.38, 0.45)
# Of the shortest edge there: a vertex of the new mesh that is nearer to one of the finished pieces takes its place, at first.
ALIKE = (0.12, 0.0)
MOST_ATTEMPTS = 16


@dataclass(frozen=True, eq=False)
class Attempt:
    """Which way of filling the gap is tried where.

    Attributes
    ----------
    least
        The number of the way everywhere.
    troubles
        Places (k,) at which the ways before did not do, for each attempt.
    reach
        How far from these the next is tried.
    """

    least: int
    troubles: list[Points]
    reach: float

    @property
    def count(self) -> int:
        """How many ways have been tried."""
        return self.least + len(self.troubles)

    def raised(self, at: Points) -> Attempt:
        """Try the next way around some places; everywhere if there are none."""
        return Attempt(self.least, [*self.troubles, at], self.reach) if len(at) else Attempt(self.least + 1, self.troubles, self.reach)

    def of(self, ways: Sequence[float], places: Points) -> Floats:
        """Return the value of the way tried at each place."""
        from scipy.spatial import cKDTree

        number: Ints = np.full(len(places), self.least)
        for trouble in self.troubles:
            number = number + (cKDTree(as_rows(trouble)).query(as_rows(places), distance_upper_bound=self.reach)[0] < self.reach)
        result: Floats = np.asarray(ways, np.float64)[np.minimum(number, len(ways) - 1)]
        return result

    def near(self, radii: Floats, places: Points) -> Bools:
        """Tell which places are given up: within the radius of the way tried at a trouble."""
        from scipy.spatial import cKDTree

        result = np.zeros(len(places), bool)
        if self.troubles and len(places):
            trouble = np.concatenate(self.troubles)
            radius = self.of(list(radii), trouble)
            for r in np.unique(radius[radius > 0]):
                distance = cKDTree(as_rows(trouble[radius == r])).query(as_rows(places), distance_upper_bound=r)[0]
                result |= distance < r
        return result
