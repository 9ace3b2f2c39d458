"""Coarse outlines -> triangles, with points inside scattered by chance: the paper's interior between conforming outlines.

Poisson-disk points (`img2tri.paper.poisson_disk`) fill each component until no more fit. Where shorter edges are wanted in some places,
they are thrown at the least distance, and thinned to the distance wanted where they lie. A constrained Delaunay triangulation keeps the
outlines, and Ruppert's refinement adds points where an angle is too small. Scattered points have no direction, which a lattice has;
their triangles are worse: mean q 0.94 against 0.98 and more.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, independent
from img2tri.errors import ParameterError
from img2tri.paper.poisson_disk import DISTANCE_PER_EDGE, poisson_disk
from img2tri.shapes.polygons import component_polygons
from img2tri.triangles.generate.constrained_delaunay import PslgError, ruppert
from img2tri.types import Outlines

SHORTEST_SPLIT = 0.03  # px: no shorter edge is split for the sake of angles


def scattered(
    chains: Outlines, longest: float, field: Callable[[Floats], Floats] | None, *, min_angle: float, seed: int
) -> tuple[Floats, Ints, Ints, int]:
    """Fill the regions within coarse outlines with Poisson-disk points, and triangulate them.

    Parameters
    ----------
    chains
        Coarse outlines, in px.
    longest, field
        Greatest edge length wanted, and the lengths over the image, or None where it is the greatest everywhere.
    min_angle
        Degrees.
    seed
        Of the points.

    Returns
    -------
    vertices, triangles, regions, irregular
        As from `img2tri.triangles.generate.filling.finish`; no triangle is regular.
    """
    from scipy.spatial import cKDTree

    segments, left, right = chains.segments
    least = longest if field is None else float(min(longest, field(chains.points).min(), _sampled(field, chains.points).min()))
    near = DISTANCE_PER_EDGE * least
    try:
        inside = [
            poisson_disk(part, chains.points, min_distance=near, min_distance_to_boundary=near, seed=seed + i)
            for i, part in enumerate(component_polygons(chains)[1])
        ]
    except ParameterError as error:  # an outline that meets itself
        raise PslgError(str(error)) from error
    points = np.concatenate(inside)
    if field is not None and len(points):
        distance = DISTANCE_PER_EDGE * np.minimum(field(points), longest)
        clear = cKDTree(chains.points).query(points)[0] > distance
        points, distance = points[clear], distance[clear]
        points = points[_thinned(points, distance)]
    found = ruppert(np.concatenate([chains.points, points]), segments, left, right, min_angle, SHORTEST_SPLIT)
    return found.vertices, found.triangles, found.regions, len(found.triangles)


def _sampled(field: Callable[[Floats], Floats], points: Floats) -> Floats:
    """Lengths on a coarse grid over the points, so that a fine spot inside is not missed."""
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    x, y = np.meshgrid(np.linspace(x0, x1, 200), np.linspace(y0, y1, 200))
    return field(np.stack([x.ravel(), y.ravel()], axis=1))


def _thinned(points: Floats, distance: Floats) -> Bools:
    """Keep points that are each as far from all others kept as both ask for on average, the first ones first."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(float(distance.max()), output_type="ndarray")
    lower, higher = pairs.min(axis=1), pairs.max(axis=1)
    apart = np.hypot(*(points[lower] - points[higher]).T)
    close = apart < (distance[lower] + distance[higher]) / 2
    return independent(lower[close], higher[close], len(points))
