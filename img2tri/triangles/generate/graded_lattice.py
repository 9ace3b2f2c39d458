"""How long the edges should be at each place, and the nodes that make a lattice finer where they should be shorter.

In: the wanted edge length, and places where something shorter is needed: short segments, points with a size of their own, a field.
Out: the wanted edge length anywhere, growing by `gradation` per unit of distance from such places, and nodes of nested lattices
that follow it.

A hexagonal lattice of pitch a and the centres of its triangles are together a hexagonal lattice of pitch a / sqrt 3, turned by
30 degrees. So each lattice contains all coarser ones, and a node has three children: itself, and the centres of two of its
triangles. Where one lattice ends and a coarser one goes on, the nodes of both fit: none has to be dropped.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from img2tri.triangles.generate.hexagonal_lattice import Complex, Lattice
from img2tri.types import Bools, Floats, Ints

FINER = 3**0.5  # ratio of pitches from one lattice to the next
LONGEST = 1.36  # a lattice is used where the wanted length is less than this times its pitch: FINER halved by ratio


@dataclass(frozen=True)
class Sizes:
    """The wanted edge length as a function of the place.

    Attributes
    ----------
    largest
        Wanted where nothing else is.
    gradation
        By how much the wanted length may grow per unit of distance.
    sources, lengths
        Places where something shorter than `largest` is wanted, and what.
    field
        A function of places (k, 2) that returns lengths (k,). It should itself grow no faster than `gradation`.
    """

    largest: float
    gradation: float
    sources: Complex
    lengths: Floats
    field: Callable[[Floats], Floats] | None = None

    @classmethod
    def near(
        cls, places: Complex, lengths: Floats, largest: float, gradation: float, field: Callable[[Floats], Floats] | None = None
    ) -> Sizes:
        """Take those places as sources where the length is short enough to call for a finer lattice."""
        short = lengths < largest * LONGEST / FINER
        return cls(largest, gradation, places[short], lengths[short], field)

    @property
    def reach(self) -> float:
        """How far from a source a finer lattice may be needed."""
        return ((LONGEST + self.gradation) / FINER * self.largest - float(self.lengths.min(initial=self.largest))) / self.gradation

    @property
    def uniform(self) -> bool:
        """Whether the wanted length is the same everywhere."""
        return not len(self.sources) and self.field is None

    def at(self, points: Complex) -> Floats:
        """Return the wanted edge length at points."""
        wanted = np.full(len(points), self.largest)
        if self.field is not None:
            wanted = np.minimum(wanted, self.field(pairs(points)))
        # Least of length + gradation * distance over all sources, found as the nearest source among those of about equal length.
        for sources, lengths in self._classes:
            least = lengths.min()
            open_ = np.flatnonzero(wanted > least)
            distance, nearest = _nearest(sources, points[open_], (self.largest - least) / self.gradation)
            near = np.flatnonzero(nearest < len(lengths))
            open_, nearest = open_[near], nearest[near]
            wanted[open_] = np.minimum(wanted[open_], lengths[nearest] + self.gradation * distance[near])
        return wanted

    @cached_property
    def _classes(self) -> list[tuple[cKDTree, Floats]]:
        """Sources with lengths within a factor of two, and these; the shortest first."""
        level: Ints = np.floor(np.log2(self.largest / self.lengths)).astype(np.int64)
        return [(cKDTree(pairs(self.sources[level == k])), self.lengths[level == k]) for k in np.unique(level)[::-1]]


def nearest_of(sources: Complex, points: Complex, reach: float = np.inf) -> tuple[Floats, Ints]:
    """Return the distance of each point to the nearest source within reach, and its number, or the count of sources if there is none."""
    return _nearest(cKDTree(pairs(sources)), points, reach)


def _nearest(sources: cKDTree, points: Complex, reach: float) -> tuple[Floats, Ints]:
    distance, nearest = sources.query(pairs(points), distance_upper_bound=reach)
    return np.asarray(distance, np.float64), np.asarray(nearest, np.int64)


def pairs(points: Complex) -> Floats:
    """Turn x + iy into (x, y), without copying: both are two numbers side by side."""
    return np.ascontiguousarray(points).view(np.float64).reshape(-1, 2)


def finer(lattice: Lattice, nodes: Ints, sizes: Sizes) -> tuple[Ints, Complex, Floats]:
    """Find the nodes of finer lattices that are needed among those given of the coarsest.

    Returns
    -------
    busy : (b,) int64
        The given nodes that have finer ones around.
    points : (p,) complex
        The finer nodes.
    wanted : (p,) float64
        Wanted edge length at each.
    """
    pitch, turn = lattice.pitch, np.exp(1j * np.pi / 6)
    points = lattice.positions(nodes)
    wanted = sizes.at(points)
    divided = _divided(wanted, pitch, sizes)
    busy = nodes[divided]
    needed, lengths = [np.zeros(0, np.complex128)], [np.zeros(0)]
    while divided.any():
        points, wanted = points[divided], wanted[divided]
        # The next lattice: the same nodes, and the centres of two triangles at each.
        pitch /= FINER
        children = (points[:, None] + pitch * turn * np.array([1, np.exp(1j * np.pi / 3)])).ravel()
        turn *= np.exp(1j * np.pi / 6)
        theirs = sizes.at(children)
        kept = theirs < LONGEST * pitch
        needed.append(children[kept])
        lengths.append(theirs[kept])
        points, wanted = np.concatenate([points, children]), np.concatenate([wanted, theirs])
        divided = _divided(wanted, pitch, sizes)
    return busy, np.concatenate(needed), np.concatenate(lengths)


def _divided(wanted: Floats, pitch: float, sizes: Sizes) -> Bools:
    """Which nodes may have children that are needed: these lie pitch / FINER away, where the wanted length is little less."""
    divided: Bools = wanted < (LONGEST + sizes.gradation) * pitch / FINER
    return divided
