"""A plane mesh with a thickness: triangles -> the closed surface of the solid between two heights, or of one with a height of each region.

The bottom is the mesh turned over, the top is the mesh, and every side of a triangle that has no neighbour becomes a wall of two
triangles. This needs no outline: holes come out as through-holes because their sides have no neighbour either, and interfaces between
regions of one height make no wall. The cost is that of sorting the sides.

Where triangles have different heights, the solid is built in storeys: between two heights that follow each other stand the triangles that
are at least as high, and the walls of a storey are those of their mesh. So a wall has a vertex wherever another one, or a roof, ends on its
upright edges, and the surface is closed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats, Ints
from img2tri.errors import ParameterError, finite
from img2tri.views.objects.half_edge_twins import half_edge_twins, previous_side


@dataclass(frozen=True, eq=False)
class Extrusion:
    """The closed surface of a solid on a plane mesh.

    Attributes
    ----------
    points
        (p, 3) float64, level by level from the bottom: all vertices at the bottom, then those of the first roof, and so on. A vertex in
        which parts of the mesh touch without sharing a side is there once for each part, so that the solid stays closed there.
    faces
        (k, 3) int64: bottom, top, then two for each wall, storey by storey; wound outwards.
    sources
        (k,) int64, the triangle each face comes from.
    origins
        (p,) int64, the vertex each point lies above.
    """

    points: Floats
    faces: Ints
    sources: Ints
    origins: Ints


def extrude(vertices: Floats, triangles: Ints, height: ArrayLike, *, z: float = 0.0) -> Extrusion:
    """Give a plane mesh a thickness: the surface of the solid from `z` to ``z + height``.

    The surface is closed and wound outwards wherever the mesh is wound counter-clockwise: each of its sides belongs to two triangles,
    in opposite directions. Its volume is the area of the mesh times `height`.

    Parameters
    ----------
    vertices
        (n, 2) float64, world units.
    triangles
        (m, 3) int64, counter-clockwise.
    height
        Thickness in world units, above 0; or that of each triangle, (m,).
    z
        Height of the bottom, in world units.

    Raises
    ------
    ParameterError
        If a height is not above 0, or `z` not finite.
    MeshError
        If two triangles run along a side in the same direction, so that no inside can be told from an outside.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> solid = extrude(square, np.array([[0, 1, 2], [0, 2, 3]]), 5)
    >>> solid.points.shape, solid.faces.shape, solid.sources.tolist()
    ((8, 3), (12, 3), [0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1])
    >>> steps = extrude(square, np.array([[0, 1, 2], [0, 2, 3]]), [5, 2])
    >>> steps.points.shape, steps.faces.shape
    ((11, 3), (18, 3))
    """
    z = finite("z", z)
    heights = (
        np.broadcast_to(np.asarray(height, np.float64), len(triangles))
        if np.ndim(height)
        else np.full(1, finite("height", height, above=0))
    )
    if not (np.isfinite(heights).all() and (heights > 0).all()):
        raise ParameterError("height: expected numbers above 0, found others")
    levels, roof = np.unique(heights, return_inverse=True)
    roof = np.broadcast_to(roof, len(triangles))
    n = len(vertices)

    below, origin = np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    points, origins, walls, sources, count = [], [], [], [], 0
    top = np.empty_like(triangles)
    for storey, level in enumerate(levels.tolist()):
        mine = np.flatnonzero(roof >= storey)
        standing = triangles[mine]
        twins = half_edge_twins(standing)
        corners, origin = _unpinched(standing, n, twins)
        if len(levels) > 1:
            used, inverse = np.unique(corners, return_inverse=True)
            corners, origin = inverse.reshape(-1, 3), origin[used]
        if storey == 0:
            points.append(np.column_stack([vertices[origin], np.full(len(origin), z)]))
            origins.append(origin)
            bottom, floor, count = corners, corners, len(origin)
        else:
            floor = below[mine]
        above = corners + count
        points.append(np.column_stack([vertices[origin], np.full(len(origin), z + level)]))
        origins.append(origin)
        count += len(origin)
        top[mine] = above
        # Each side that has no neighbour in this storey becomes a wall, seen here from outside, where a -> b has the mesh behind it:
        #
        #     A ---- B
        #     |    / |
        #     |  /   |
        #     a ---- b
        #
        free = np.flatnonzero(twins < 0)
        a, b = floor.ravel()[free], floor[:, [1, 2, 0]].ravel()[free]
        upper_a, upper_b = above.ravel()[free], above[:, [1, 2, 0]].ravel()[free]
        walls.append(np.stack([a, b, upper_b, a, upper_b, upper_a], axis=1).reshape(-1, 3))
        sources.append(np.repeat(mine[free // 3], 2))
        below = np.zeros_like(triangles)
        below[mine] = above

    every = np.arange(len(triangles))
    whole = np.concatenate(points), np.concatenate([bottom[:, ::-1], top, *walls]), np.concatenate(origins)
    if len(levels) > 1:
        # Inside a storey nothing ends where the next one stands.
        used, inverse = np.unique(whole[1], return_inverse=True)
        whole = whole[0][used], inverse.reshape(-1, 3), whole[2][used]
    return Extrusion(whole[0], whole[1], np.concatenate([every, every, *sources]), whole[2])


def _unpinched(triangles: Ints, n: int, twins: Ints) -> tuple[Ints, Ints]:
    r"""Split the vertices in which parts of the mesh touch without sharing a side; return the corners and whence each vertex came.

    Around such a vertex v the triangles form several fans. One free side of each fan leaves v. From there the fan is walked triangle by
    triangle, all fans at once, until there is no next one::

        c ------ b
          \    /           side v -> b of triangle (v, b, c) begins in its corner v;
           \  /            the next triangle of the fan has the side v -> c
            v
           /  \
          /    \           another fan: it gets a vertex of its own
        . ------ .
    """
    start, free = triangles.ravel(), np.flatnonzero(twins < 0)
    leaving = free[np.argsort(start[free], kind="stable")]
    again = np.flatnonzero(np.diff(start[leaving]) == 0) + 1  # all but the first fan of a vertex, which keeps it
    corner, new = leaving[again], n + np.arange(len(again))
    origin = np.concatenate([np.arange(n), start[corner]])
    corners = start.copy()
    while len(corner):
        corners[corner] = new
        following = twins[previous_side(corner)]
        corner, new = following[following >= 0], new[following >= 0]
    return corners.reshape(-1, 3), origin
