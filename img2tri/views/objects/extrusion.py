"""A plane mesh with a thickness: triangles -> the closed surface of the solid between two heights.

The bottom is the mesh turned over, the top is the mesh, and every side of a triangle that has no neighbour becomes a wall of two
triangles. This needs no outline: holes come out as through-holes because their sides have no neighbour either, and interfaces between
regions make no wall. The cost is that of sorting the sides.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.errors import finite
from img2tri.views.objects.side_twins import previous_side, side_twins


def extrude(vertices: Floats, triangles: Ints, height: float, *, z: float = 0.0) -> tuple[Floats, Ints, Ints]:
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
        Thickness in world units, above 0.
    z
        Height of the bottom, in world units.

    Returns
    -------
    points
        (2 n, 3) float64: all vertices at the bottom, then all at the top. A vertex in which parts of the mesh touch without sharing a
        side is given once for each part, so that the solid stays closed there; n is then larger by these.
    faces
        (2 m + 2 b, 3) int64: bottom, top, then two for each of the b sides without a neighbour.
    sources
        (2 m + 2 b,) int64, the triangle each face comes from.

    Raises
    ------
    ParameterError
        If `height` is not above 0, or `z` not finite.
    MeshError
        If two triangles run along a side in the same direction, so that no inside can be told from an outside.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> points, faces, sources = extrude(square, np.array([[0, 1, 2], [0, 2, 3]]), 5)
    >>> points.shape, faces.shape, sources.tolist()
    ((8, 3), (12, 3), [0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1])
    """
    height, z = finite("height", height, above=0), finite("z", z)
    twins = side_twins(triangles, len(vertices))
    free = np.flatnonzero(twins < 0)
    corners, origin = _unpinched(triangles, len(vertices), twins)
    n = len(origin)

    # Each side that has no neighbour becomes a wall, seen here from outside, where a -> b has the mesh behind it:
    #
    #     a + n ---- b + n
    #       |      /   |
    #       |   /      |
    #       a -------- b
    #
    a, b = corners.ravel()[free], np.roll(corners, -1, axis=1).ravel()[free]
    walls = np.stack([a, b, b + n, a, b + n, a + n], axis=1).reshape(-1, 3)

    points = np.concatenate([np.column_stack([vertices[origin], np.full(n, level)]) for level in (z, z + height)])
    faces = np.concatenate([corners[:, ::-1], corners + n, walls])
    every = np.arange(len(triangles))
    return points, faces, np.concatenate([every, every, np.repeat(free // 3, 2)])


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
