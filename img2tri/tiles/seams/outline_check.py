"""New edges along outlines, where a gap was filled: not off the outlines of the image, nor these off them.

Both ways: an edge may lie on an outline and yet leave out a corner of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Floats, Ints, Points, as_rows, runs
from img2tri.certificate.outline_distance import SAMPLE_STEP, SegmentSet
from img2tri.tiles.seams.both_meshes import Both
from img2tri.tiles.seams.piece_seams import SeamError, Sides

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

AT_ONCE = 10_000  # edges whose distances are measured at once, which bounds the memory of that
REPRESENTED = 1.5  # edges: so far from the middle of an edge are the points of outlines that it may have left out


@dataclass(frozen=True, eq=False)
class DenseOutlines:
    """The dense outlines of a window.

    Attributes
    ----------
    points, segments
        (n,) complex and (s, 2) int64.
    """

    points: Points
    segments: Ints

    @cached_property
    def _set(self) -> SegmentSet:
        return SegmentSet(as_rows(self.points), self.segments)

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(as_rows(self.points))

    def off(self, z: Points, edges: Ints) -> Floats:
        """Tell how far edges (k, 2) between places are from the outlines, px; 0 where there are none."""
        if not len(self.segments):
            return np.zeros(len(edges))
        found = [self._few_off(*z[edges[first : first + AT_ONCE]].T) for first in range(0, len(edges), AT_ONCE)]
        return np.concatenate(found) if found else np.zeros(0)

    def _few_off(self, a: Points, b: Points) -> Floats:
        count = np.maximum(np.ceil(np.abs(b - a) / SAMPLE_STEP).astype(np.int64), 1) + 1
        which, place = runs(count)
        distance = self._set.distance(as_rows(a[which] + (place / (count - 1)[which]) * (b - a)[which]))
        return np.maximum.reduceat(distance, np.cumsum(count) - count)

    def beside(self, a: Points, b: Points) -> Points:
        """Points of the outlines that edges from `a` to `b` may stand for."""
        found = self._tree.query_ball_point(as_rows((a + b) / 2), REPRESENTED * np.abs(b - a))
        return self.points[np.unique(np.concatenate([np.zeros(0, np.int64), *found]).astype(np.int64))]


def check_outlines(z: Points, triangles: Ints, code: Ints, both: Both, within: float, outlines: DenseOutlines, tolerance: float) -> None:
    """Refuse edges along new outlines that are off those of the image, or leave these off, unless the new mesh does so by itself.

    Parameters
    ----------
    z, triangles, code
        The mesh, and the codes of its regions.
    both
        What it was made of.
    within
        How far outside of its block is looked.
    outlines, tolerance
        Of the image, px.

    Raises
    ------
    SeamError
        Where they are.
    """
    n = len(z)
    own = _outline_edges(both.new, both.new_codes, n)
    edges = _outline_edges(triangles, code, n)
    edges = edges[(np.append(both.outside, np.full(n - len(both.outside), -np.inf))[edges]).max(axis=1) < within]
    known = own[both.outside[own].max(axis=1) < within]
    known = _other_than(known[~both.moved[known].any(axis=1)], both.cut, n)
    for old in (known, both.border, both.cut):
        edges = _other_than(edges, old, n)
    if not len(edges):
        return
    distance = outlines.off(z, edges)
    allowed = max(tolerance, float(outlines.off(both.z, known).max(initial=0.0)) if distance.max() > tolerance else 0.0) * (1 + 1e-9)
    if (distance > allowed).any():
        raise SeamError("an outline is off that of the image", z[edges[distance > allowed]].mean(axis=1))
    beside = outlines.beside(*z[edges].T)
    every = _outline_edges(np.concatenate([triangles, both.old]), np.concatenate([code, both.old_codes]), n)
    missed = beside[SegmentSet(as_rows(z), every).distance(as_rows(beside)) > allowed]
    if len(missed):
        missed = missed[SegmentSet(as_rows(both.z), own).distance(as_rows(missed)) <= allowed]
    if len(missed):
        raise SeamError("an outline of the image is left out", missed)


def _outline_edges(triangles: Ints, code: Ints, n: int) -> Ints:
    """Return the edges (k, 2) between different regions, and between a region and nothing."""
    sides = Sides.of(triangles, n)
    left, right = sides.codes(code)
    edges: Ints = np.stack([sides.low, sides.high], axis=1)[left != right]
    return edges


def _other_than(edges: Ints, others: Ints, n: int) -> Ints:
    """Return those of the edges that are none of others, whichever way round."""
    kept: Ints = edges[~np.isin(edges.min(axis=1) * n + edges.max(axis=1), others.min(axis=1) * n + others.max(axis=1))]
    return kept
