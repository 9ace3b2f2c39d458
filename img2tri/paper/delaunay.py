"""The paper's triangles: points in, the Delaunay triangles whose centroid is inside the shape out.

Sections II-D, II-E, III-D and III-E of the paper, `create_mesh` and `valid_triangles` of its listing. No outline takes part: Delaunay
triangulates the convex hull of all points, and the centroid decides what belongs to the shape. That is right only where the
outline happens to be made of edges of the triangulation. Elsewhere a triangle sticks out of the shape, or a piece is missing, and nothing
says so. `img2tri.triangles.generate.constrained_delaunay.triangulate`, which keeps the segments of the outline, has neither fault.

(Section II-D states the circumcircle condition without its inequality: no point lies *inside* the circumcircle of a triangle.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pythoncdt
from numpy.typing import ArrayLike
from shapely import MultiPolygon, Polygon, contains_xy

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.triangles.tools.mesh_checks import check_mesh


def delaunay(points: ArrayLike) -> Ints:
    """Triangulate the convex hull of points: no point lies inside the circumcircle of a triangle.

    Parameters
    ----------
    points : (n, 2) float
        At least three, all different, not all on one line.

    Returns
    -------
    (m, 3) int64
        Indices into `points`, counter-clockwise where x points right and y up. Where four points or more lie on one empty circle,
        as in a square grid, any of the possible diagonals may come.

    Raises
    ------
    MeshError
        When there are fewer than three points, two are the same, or all lie on one line.

    Notes
    -----
    The listing uses scipy's Qhull, which leaves out repeated points without a word. pythoncdt is ten times as fast, and exact.

    Examples
    --------
    >>> sorted(map(sorted, delaunay([[0, 0], [2, 0], [0, 2], [3, 3]]).tolist()))
    [[0, 1, 2], [1, 2, 3]]
    """
    p = np.ascontiguousarray(points, np.float64)
    if p.ndim != 2 or p.shape[1] != 2 or len(p) < 3:
        raise MeshError(f"points: expected at least three, shape (n, 2), found shape {p.shape}")
    if not np.isfinite(p).all():
        raise MeshError("points: expected finite coordinates, found NaN or infinity")
    triangulation: Any = pythoncdt.Triangulation(
        pythoncdt.VertexInsertionOrder.AUTO, pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
    )
    try:
        triangulation.insert_vertices(p)
    except RuntimeError as error:
        places, copies = np.unique(p, axis=0, return_counts=True)
        again, n = places[copies > 1], len(p) - len(places)
        raise MeshError(f"points: expected each once, found {n} repeated, the first at {again[0].tolist()}; keep one of each") from error
    triangulation.erase_super_triangle()
    triangles: Ints = triangulation.triangles_array()["vertices"].astype(np.int64)
    if len(triangles) == 0:
        raise MeshError(f"points: expected three that are not on one line, found {len(p)} on one line")
    return triangles


def centroid_filter(points: ArrayLike, triangles: ArrayLike, polygon: Polygon | MultiPolygon) -> Ints:
    """Keep the triangles whose centroid is inside a polygon.

    A triangle is kept or dropped as a whole, however much of it is on the other side of the outline.

    Parameters
    ----------
    points : (n, 2) float
    triangles : (m, 3) int
    polygon
        Holes, where it has any, are outside. A centroid on the outline itself is outside too.

    Returns
    -------
    (k, 3) int64
        In their old order.

    Raises
    ------
    MeshError
        When `points` and `triangles` are not a mesh.

    Notes
    -----
    The paper's section II-E: accepted if (p_1 + p_2 + p_3) / 3 is in Polygon(B).

    Examples
    --------
    >>> from shapely import box
    >>> points = [[0, 0], [3, 0], [0, 3], [9, 9]]
    >>> centroid_filter(points, [[0, 1, 2], [1, 3, 2]], box(0, 0, 2, 2))
    array([[0, 1, 2]])
    """
    if np.size(triangles) == 0:
        return np.zeros((0, 3), np.int64)
    p, t = check_mesh(points, triangles)
    x, y = p[t].mean(axis=1).T
    kept: Ints = t[contains_xy(polygon, x, y)]
    return kept


def without_unused(points: Floats, triangles: Ints) -> tuple[Ints, Ints]:
    """Leave out the points that are no corners, and number the others anew.

    Returns
    -------
    used : (k,) int64
        Which points are corners of triangles, ascending: the new number of point ``used[i]`` is i.
    triangles : (m, 3) int64
        With the new numbers.

    Examples
    --------
    >>> used, triangles = without_unused(np.zeros((5, 2)), np.array([[0, 2, 4]]))
    >>> used.tolist(), triangles.tolist()
    ([0, 2, 4], [[0, 1, 2]])
    """
    used = np.zeros(len(points), np.bool_)
    used[triangles] = True
    number = np.cumsum(used) - 1
    return np.flatnonzero(used), number[triangles]
