"""The size function of the mesh: how long edges should be at each place.

In: the longest length wanted, and places where something shorter is: short segments, points with a size of their own, a field of lengths.
Out: the wanted length anywhere. From such places it grows by `gradation` per unit of distance: a gradient-limited size function, as in
P.-O. Persson, Mesh size functions for implicit geometries and PDE-based gradient limiting, Engineering with Computers 22, 2006,
https://doi.org/10.1007/s00366-006-0014-1; with point sources only, the limit has a closed form, found by search trees.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Floats, Ints, Points, as_rows

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


@dataclass(frozen=True)
class SizeFunction:
    """The wanted edge length as a function of the place.

    Attributes
    ----------
    largest
        Wanted where nothing else is.
    gradation
        By how much the wanted length may grow per unit of distance.
    sources, lengths
        (k,) complex and (k,) float64: places where something shorter than `largest` is wanted, and what.
    field
        A function of places (n, 2) that returns lengths (n,). It should itself grow no faster than `gradation`.
    """

    largest: float
    gradation: float
    sources: Points
    lengths: Floats
    field: Callable[[Floats], Floats] | None = None

    @property
    def uniform(self) -> bool:
        """Whether the wanted length is the same everywhere."""
        return not len(self.sources) and self.field is None

    def at(self, points: Points) -> Floats:
        """Return the wanted edge length (n,) at points (n,)."""
        wanted = np.full(len(points), self.largest)
        if self.field is not None:
            wanted = np.minimum(wanted, self.field(as_rows(points)))
        # Least of length + gradation * distance over all sources, found as the nearest source among those of about equal length.
        for sources, lengths in self._classes:
            least = lengths.min()
            open_ = np.flatnonzero(wanted > least)
            distance, nearest = _query(sources, points[open_], (self.largest - least) / self.gradation)
            found = np.flatnonzero(nearest < len(lengths))
            open_, nearest = open_[found], nearest[found]
            wanted[open_] = np.minimum(wanted[open_], lengths[nearest] + self.gradation * distance[found])
        return wanted

    @cached_property
    def _classes(self) -> list[tuple[cKDTree, Floats]]:
        """Sources with lengths within a factor of two, and these; the shortest first."""
        if not len(self.sources):
            return []
        from scipy.spatial import cKDTree

        level: Ints = np.floor(np.log2(self.largest / self.lengths)).astype(np.int64)
        return [(cKDTree(as_rows(self.sources[level == k])), self.lengths[level == k]) for k in np.unique(level)[::-1]]


def nearest_of(sources: Points, points: Points, reach: float = np.inf) -> tuple[Floats, Ints]:
    """Return the distance (n,) of points to the nearest source within reach, and its number, or the count of sources if there is none."""
    from scipy.spatial import cKDTree

    return _query(cKDTree(as_rows(sources)), points, reach)


def _query(tree: cKDTree, points: Points, reach: float) -> tuple[Floats, Ints]:
    distance, nearest = tree.query(as_rows(points), distance_upper_bound=reach)
    return np.asarray(distance, np.float64), np.asarray(nearest, np.int64)
