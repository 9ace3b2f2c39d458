r"""Solids for solvers: a plane mesh -> wedges, in layers, linear or quadratic; or the flat mesh with quadratic triangles.

Each triangle, drawn upwards, becomes one wedge per layer. All wedges of a layer have their corners in the same places above the
vertices of the mesh, so neighbours share whole sides, within a layer and from one to the next. Nodes are numbered as VTK, Abaqus (C3D6,
C3D15) and Gmsh agree on for corners; the nodes in the middle of edges in the order of VTK::

        5                     5
       /|\                  11|\10      the base 0 1 2 is counter-clockwise as seen from above, which makes
      / | \                 / 14\       the volume positive: for VTK as it computes, whatever its manual says
     3-----4               3--9--4
     |  2  |               |  2  |      6 7 8 between 0-1, 1-2, 2-0; 9 10 11 above them;
     | / \ |              12 8 \ 13     12 13 14 on the upright edges
     |/   \|               |/   7|
     0-----1               0--6--1
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints, unique_edges
from img2tri.errors import MeshError, ParameterError, finite, integer
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh


def wedges(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    height: float,
    layers: int = 1,
    order: int = 1,
    z: float = 0.0,
    middles: ArrayLike | None = None,
) -> tuple[Floats, Ints, Ints]:
    """Fill the solid above a plane mesh, from `z` to ``z + height``, with wedges.

    The wedges have together the area of the mesh times `height` as their volume, and each a positive Jacobian throughout if the triangles
    are counter-clockwise and the `middles` straight.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 in world units, and (m, 3) int64, counter-clockwise.
    regions
        (m,) int64. None is region 1 everywhere.
    height
        Thickness in world units, above 0.
    layers
        Wedges above each triangle, at least 1. More follow bending and what changes through the thickness more closely.
    order
        1: wedges of 6 nodes. 2: of 15, with one in the middle of each edge: many times as exact, at some four times the nodes.
    z
        Height of the bottom, in world units.
    middles
        (e, 2) float64, for order 2: where the node in the middle of each edge lies, edges as in `img2tri.arrays.unique_edges`.
        None puts them half-way, on straight edges.

    Returns
    -------
    points
        (p, 3) float64. First the nodes of each level from the bottom up: the vertices, then the middles of their edges (order 2); after
        these, for order 2, the nodes half-way up each layer.
    cells
        (layers m, 6 or 15) int64, in the order of VTK, layer by layer from the bottom up.
    regions
        (layers m,) int64, that of the triangle each wedge stands on.

    Raises
    ------
    MeshError
        If the arrays are not a mesh, or `middles` do not go with it.
    ParameterError
        If an option is not as above.

    Examples
    --------
    >>> points, cells, regions = wedges([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], [7], height=2, layers=2)
    >>> cells.tolist(), regions.tolist()
    ([[0, 1, 2, 3, 4, 5], [3, 4, 5, 6, 7, 8]], [7, 7])
    """
    v, t = plane_mesh(vertices, triangles)
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    height, z, layers = finite("height", height, above=0), finite("z", z), integer("layers", layers, least=1)
    nodes, flat = (v, t) if _checked_order(order, middles) == 1 else quadratic(v, t, middles=middles)
    n, levels = len(nodes), z + height * np.linspace(0, 1, layers + 1)
    points = _stacked(nodes, levels)
    # Layer k stands on level k: the same nodes, k n further on.
    bottom = (flat + n * np.arange(layers)[:, None, None]).reshape(-1, flat.shape[1])
    cells = np.concatenate([bottom[:, :3], bottom[:, :3] + n], axis=1)
    if order == 2:
        half_way = (t + len(points) + len(v) * np.arange(layers)[:, None, None]).reshape(-1, 3)
        points = np.concatenate([points, _stacked(v, (levels[1:] + levels[:-1]) / 2)])
        cells = np.concatenate([cells, bottom[:, 3:], bottom[:, 3:] + n, half_way], axis=1)
    return points, cells, np.tile(labels.astype(np.int64), layers)


def quadratic(vertices: Floats, triangles: Ints, *, middles: ArrayLike | None = None) -> tuple[Floats, Ints]:
    """Give each edge of a plane mesh a node in its middle.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64.
    middles
        (e, 2) float64, the nodes of the edges as `img2tri.arrays.unique_edges` orders them; None puts them half-way.

    Returns
    -------
    nodes
        (n + e, 2) float64: the vertices, then the middles.
    cells
        (m, 6) int64: the corners of each triangle, then the nodes between 0 and 1, 1 and 2, 2 and 0.

    Raises
    ------
    MeshError
        If there is not one finite place for each edge.

    Examples
    --------
    >>> nodes, cells = quadratic(np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]), np.array([[0, 1, 2]]))
    >>> nodes[cells[0, 3:]].tolist()
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    edges, sides = unique_edges(triangles)
    between = vertices[edges].mean(axis=1) if middles is None else np.asarray(middles, np.float64)
    if between.shape != (len(edges), 2) or not np.isfinite(between).all():
        raise MeshError(f"middles: expected one finite place (x, y) for each of {len(edges)} edges, found shape {between.shape}")
    return np.concatenate([vertices, between]), np.concatenate([triangles, sides + len(vertices)], axis=1)


def _checked_order(order: int, middles: ArrayLike | None) -> int:
    """Return `order` if it is 1 or 2, and 2 where there are middles."""
    if order not in (1, 2) or isinstance(order, bool):
        raise ParameterError(f"order: expected 1 or 2, found {order!r}")
    if order == 1 and middles is not None:
        raise ParameterError("middles: expected none for order 1, found some; give order=2 too")
    return order


def _stacked(nodes: Floats, levels: NDArray[Any]) -> Floats:
    """Return the nodes (k, 2) at each of the levels (l,), as (l k, 3), level by level."""
    return np.column_stack([np.tile(nodes, (len(levels), 1)), np.repeat(levels, len(nodes))])
