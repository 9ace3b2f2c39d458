"""Wedges cut into tetrahedra, for solvers that know no wedges: cells of wedges -> cells of tetrahedra, with the same named parts.

Each wedge becomes three tetrahedra. Each of its walls is cut along the diagonal from the corner of the lowest number, so neighbours agree
(Dompierre, Labbe, Vallet and Camarero 1999, "How to subdivide pyramids, prisms and hexahedra into tetrahedra"). Quadratic tetrahedra keep
the nodes of the wedges, and get one more in the middle of each wall, which lies on the curved wall where the wedge has one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.views.objects.solver_cells import CELL_SIDES, Cells

# How to turn a wedge so that each of its corners comes first.
_TURNED = np.array([[0, 1, 2, 3, 4, 5], [1, 2, 0, 4, 5, 3], [2, 0, 1, 5, 3, 4], [3, 5, 4, 0, 2, 1], [4, 3, 5, 1, 0, 2], [5, 4, 3, 2, 1, 0]])
# The wall opposite to the first corner is cut from 1 to 5, or from 2 to 4.
_CUT = np.array([[[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]], [[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]]])
_EDGES = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])  # of a tetrahedron, in the order of their middles
# The edges of a wedge with the node in the middle of each, then the diagonals of its walls with the two nodes half-way between which
# theirs is.
_MIDDLES = [(0, 1, 6), (1, 2, 7), (2, 0, 8), (3, 4, 9), (4, 5, 10), (5, 3, 11), (0, 3, 12), (1, 4, 13), (2, 5, 14)]
_DIAGONALS = [(0, 4, 6, 9), (1, 3, 6, 9), (1, 5, 7, 10), (2, 4, 7, 10), (2, 3, 8, 11), (0, 5, 8, 11)]


def tetrahedra(made: Cells) -> Cells:
    """Cut wedges into tetrahedra.

    Parameters
    ----------
    made
        Wedges, of 6 or 15 nodes.

    Returns
    -------
    Cells
        Of "tetra" or "tetra10": three tetrahedra for each wedge, one after the other, with its region and values; the sets hold the same
        surfaces.

    Examples
    --------
    >>> from img2tri.views.objects.solver_cells import flat_cells, solid_cells
    >>> from img2tri.views.objects.extruded_wedges import wedges
    >>> triangle = [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]
    >>> cut = tetrahedra(solid_cells(flat_cells(*triangle), *wedges(*triangle, height=1)[:2]))
    >>> cut.kind, cut.cells.tolist(), len(cut.sides["outer"])
    ('tetra', [[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]], 6)
    """
    wedge = made.cells[:, :6]
    turned = np.take_along_axis(wedge, _TURNED[np.argmin(wedge, axis=1)], axis=1)
    other = np.minimum(turned[:, 1], turned[:, 5]) > np.minimum(turned[:, 2], turned[:, 4])
    corners = turned[np.arange(len(turned))[:, None, None], _CUT[other.astype(int)]].reshape(-1, 4)
    points, cells, point_data = made.points, corners, made.point_data
    if made.kind == "wedge15":
        middles, points, point_data = _middles(made, corners)
        cells = np.concatenate([corners, middles], axis=1)
    return replace(
        made, points=points, cells=cells, kind="tetra10" if made.kind == "wedge15" else "tetra", regions=np.repeat(made.regions, 3),
        sides={name: _sides(rows, made, corners) for name, rows in made.sides.items()},
        cell_data={name: np.repeat(values, 3, axis=0) for name, values in made.cell_data.items()}, point_data=point_data,
    )  # fmt: skip


def _sides(rows: Ints, made: Cells, corners: Ints) -> Ints:
    """Return the sides of tetrahedra that make up sides of wedges: those whose corners are all among the corners of the side."""
    wedge, side = rows.T
    local = np.array([[*nodes[: 4 if i < 3 else 3], nodes[0]][:4] for i, nodes in enumerate(CELL_SIDES["wedge"])])[side]
    wall = made.cells[wedge[:, None], local]
    inside = corners.reshape(-1, 12)[wedge]  # the corners of the three tetrahedra of each wedge
    among = (inside[:, :, None] == wall[:, None, :]).any(axis=2).reshape(-1, 3, 4)
    on = among[:, :, np.array(CELL_SIDES["tetra"])].all(axis=3)
    row, third, number = np.nonzero(on)
    return np.stack([3 * wedge[row] + third, number], axis=1)


def _middles(made: Cells, corners: Ints) -> tuple[Ints, Floats, dict[str, NDArray[Any]]]:
    """Return the nodes in the middle of the edges of tetrahedra, all points, and the values of these."""
    c, n = made.cells, len(made.points)

    def key(a: Ints, b: Ints) -> Ints:
        return np.asarray(np.minimum(a, b) * n + np.maximum(a, b))

    known = np.concatenate([key(c[:, a], c[:, b]) for a, b, _ in _MIDDLES])
    nodes = np.concatenate([c[:, middle] for *_, middle in _MIDDLES])
    walls = np.concatenate([key(c[:, a], c[:, b]) for a, b, *_ in _DIAGONALS])
    between = np.concatenate([c[:, [low, high]] for *_, low, high in _DIAGONALS])
    wanted, which = np.unique(key(corners[:, _EDGES[:, 0]], corners[:, _EDGES[:, 1]]), return_inverse=True)
    order = np.argsort(known)
    place = np.searchsorted(known, wanted, sorter=order).clip(max=len(known) - 1)
    found = known[order[place]] == wanted
    number = np.where(found, nodes[order[place]], 0)
    number[~found] = n + np.arange(np.count_nonzero(~found))
    order = np.argsort(walls)
    pairs = between[order[np.searchsorted(walls, wanted[~found], sorter=order)]]
    points = np.concatenate([made.points, made.points[pairs].mean(axis=1)])
    data = {name: np.concatenate([values, values[pairs].mean(axis=1)]) for name, values in made.point_data.items()}
    return number[which].reshape(-1, 6), points, data
