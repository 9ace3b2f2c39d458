"""A plate under a plane mesh, to join loose parts when they are printed: the mesh -> the triangles between it and the rim of the plate.

The plate is a rectangle that reaches beyond the image, or the mesh, by a margin, so that it surrounds all parts. What the mesh leaves free
of it is cut into triangles between the vertices there are and the four corners (GEOS's constrained Delaunay triangulation, which adds no
point), so the mesh and these triangles together are one mesh, and the solid made of it is one closed body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.views.objects.half_edge_twins import half_edge_twins

PLATE = "base"  # the name of its region
GRAY = (150, 150, 150)


@dataclass(frozen=True)
class Base:
    """A plate under a mesh.

    Attributes
    ----------
    thickness
        World units.
    bounds
        (left, bottom, right, top) of the image, or the mesh; the plate reaches beyond it by its thickness.
    """

    thickness: float
    bounds: tuple[float, float, float, float]

    def under(self, vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
        """Return the vertices of mesh and plate, and the triangles beside the mesh, see `around`."""
        left, bottom, right, top = self.bounds
        t = self.thickness
        return around(vertices, triangles, (left - t, bottom - t, right + t, top + t))


def plate_label(labels: Ints) -> int:
    """Return the label of the plate: 0, or the next one below all others.

    Examples
    --------
    >>> plate_label(np.array([1, 2])), plate_label(np.array([0, 3]))
    (0, -1)
    """
    return 0 if labels.min() > 0 else int(labels.min()) - 1


def around(vertices: Floats, triangles: Ints, rectangle: tuple[float, float, float, float]) -> tuple[Floats, Ints]:
    """Fill a rectangle around a mesh with triangles.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64, counter-clockwise.
    rectangle
        (left, bottom, right, top), beyond all vertices.

    Returns
    -------
    vertices
        (n + 4, 2) float64: those of the mesh, and the corners.
    triangles
        (k, 3) int64, those beside the mesh, counter-clockwise.

    Examples
    --------
    >>> places, beside = around(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]]), (-1, -1, 2, 2))
    >>> len(places), len(beside)
    (7, 7)
    """
    import shapely

    left, bottom, right, top = rectangle
    n = len(vertices)
    points = np.concatenate([vertices, [[left, bottom], [right, bottom], [right, top], [left, top]]])
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    sides = np.flatnonzero(half_edge_twins(triangles) < 0)
    rim = np.stack([np.arange(n, n + 4), n + (np.arange(4) + 1) % 4], axis=1)
    edges = np.concatenate([np.stack([start[sides], end[sides]], axis=1), rim])
    faces: Any = shapely.get_parts(shapely.polygonize(shapely.linestrings(points[edges])))
    order = np.argsort(points[:, 0] + 1j * points[:, 1])
    places = (points[:, 0] + 1j * points[:, 1])[order]
    # A face lies on the left of its first edge; the mesh lies on the left of its own.
    inward = set(map(tuple, edges[: len(sides)].tolist()))
    beside = []
    for face in faces.tolist():
        ring = shapely.get_coordinates(shapely.get_exterior_ring(shapely.orient_polygons(face)))[:2]
        if tuple(order[np.searchsorted(places, ring[:, 0] + 1j * ring[:, 1])].tolist()) not in inward:
            beside.append(face)
    parts: Any = shapely.get_parts(shapely.constrained_delaunay_triangles(np.array(beside)))
    corners = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]
    found = order[np.searchsorted(places, corners[..., 0] + 1j * corners[..., 1])]
    (ux, uy), (vx, vy) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return points, np.where((ux * vy - uy * vx > 0)[:, None], found, found[:, ::-1])
