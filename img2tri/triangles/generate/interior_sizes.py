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

FEW_PAIRS = 1 << 16  # of points and sources: for fewer no search tree is built, and SciPy's are not imported


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
            open_ = (wanted > least).nonzero()[0]
            if not len(open_):
                continue
            distance, nearest = sources.nearest(points[open_], (self.largest - least) / self.gradation)
            found = (nearest < len(lengths)).nonzero()[0]
            open_, nearest = open_[found], nearest[found]
            wanted[open_] = np.minimum(wanted[open_], lengths[nearest] + self.gradation * distance[found])
        return wanted

    @cached_property
    def _classes(self) -> list[tuple[_Sources, Floats]]:
        """Sources with lengths within a factor of two, and these; the shortest first."""
        level: Ints = np.floor(np.log2(self.largest / self.lengths)).astype(np.int64)
        return [(_Sources(self.sources[level == k]), self.lengths[level == k]) for k in np.unique(level)[::-1]]


def nearest_of(sources: Points, points: Points, reach: float = np.inf) -> tuple[Floats, Ints]:
    """Return the distance (n,) of points to the nearest source within reach, and its number, or the count of sources if there is none."""
    return _Sources(sources).nearest(points, reach)


class _Sources:
    """Places of which the nearest is asked for: of few by all distances, of many by a search tree."""

    def __init__(self, places: Points) -> None:
        self._places = places

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(as_rows(self._places))

    def nearest(self, points: Points, reach: float) -> tuple[Floats, Ints]:
        """Return what `nearest_of` does."""
        count = len(self._places)
        if not count or count * len(points) > FEW_PAIRS:
            distance, nearest = self._tree.query(as_rows(points), distance_upper_bound=reach)
            return np.asarray(distance, np.float64), np.asarray(nearest, np.int64)
        across, up = (points.real[:, None] - self._places.real), (points.imag[:, None] - self._places.imag)
        with np.errstate(over="ignore"):  # what is too far to be squared is out of reach, as it is for a search tree
            square = across * across + up * up
        place = square.argmin(axis=1)
        far = np.sqrt(square[np.arange(len(points)), place])
        near = far < reach
        return np.where(near, far, np.inf), np.where(near, place, count)
