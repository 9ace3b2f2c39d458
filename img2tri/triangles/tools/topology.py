"""How the triangles of a mesh hang together: its boundary, its interfaces, who is whose neighbour.

In: triangles (m, 3) int64. Out: index arrays and a sparse matrix, made from the edges of `img2tri.arrays.unique_edges`: the cost is
that of sorting three numbers per triangle; the triangles are never searched for a vertex. Sides are numbered as there, side k from
corner k to the next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Bools, Ints, unique_edges

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def directed_edges(triangles: Ints) -> Ints:
    """Return all sides (3 m, 2) int64 in the direction of their triangles: row ``3 i + k`` is side k of triangle i.

    With counter-clockwise triangles each has its triangle on its left.

    Examples
    --------
    >>> directed_edges(np.array([[4, 5, 6]])).tolist()
    [[4, 5], [5, 6], [6, 4]]
    """
    return np.ascontiguousarray(triangles[:, [0, 1, 1, 2, 2, 0]]).reshape(-1, 2)


def boundary_edges(triangles: Ints) -> Ints:
    """Return the edges (b, 2) int64 that belong to one triangle only, directed with the mesh on their left.

    Examples
    --------
    >>> boundary_edges(np.array([[0, 1, 2], [0, 2, 3]])).tolist()
    [[0, 1], [1, 2], [2, 3], [3, 0]]
    """
    _, sides = unique_edges(triangles)
    side = sides.ravel()
    edges: Ints = directed_edges(triangles)[np.bincount(side)[side] == 1]
    return edges


def interface_edges(triangles: Ints, regions: Ints) -> Ints:
    """Return the edges (k, 2) int64, lower vertex first, between triangles of different regions.

    Parameters
    ----------
    triangles : (m, 3) int64
    regions : (m,) int64

    Examples
    --------
    >>> interface_edges(np.array([[0, 1, 2], [0, 2, 3]]), np.array([1, 2])).tolist()
    [[0, 2]]
    """
    edges, sides = unique_edges(triangles)
    low, high = _span(sides, len(edges), regions)
    interface: Ints = edges[low < high]
    return interface


def curve_edges(triangles: Ints, regions: Ints | None = None) -> Ints:
    """Return the edges (k, 2) int64, lower vertex first, that give the mesh its form: its boundary and its interfaces.

    Edges with three triangles or more count as such too. Without `regions` there are no interfaces.

    Examples
    --------
    >>> curve_edges(np.array([[0, 1, 2], [0, 2, 3]]), np.array([1, 2])).tolist()
    [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    """
    edges, sides = unique_edges(triangles)
    parts = np.bincount(sides.ravel(), minlength=len(edges)) != 2
    if regions is not None:
        low, high = _span(sides, len(edges), regions)
        parts |= low < high
    curve: Ints = edges[parts]
    return curve


def directed_curves(triangles: Ints, regions: Ints | None = None) -> Ints:
    """Return the edges of `curve_edges`, each directed: boundary with the mesh on the left, interfaces with the lower region there.

    So all edges of one curve, between two junctions, run the same way.

    Examples
    --------
    >>> directed_curves(np.array([[0, 1, 2], [0, 2, 3]]), np.array([2, 1])).tolist()
    [[0, 1], [1, 2], [0, 2], [2, 3], [3, 0]]
    """
    edges, sides = unique_edges(triangles)
    side = sides.ravel()
    chosen = np.bincount(side)[side] != 2
    if regions is not None:
        low, high = _span(sides, len(edges), regions)
        chosen |= (low < high)[side] & (np.repeat(regions, 3) == low[side])
    curves: Ints = directed_edges(triangles)[chosen]
    return curves


def curve_vertices(triangles: Ints, n: int, regions: Ints | None = None) -> Bools:
    """Return a mask (n,) bool of the vertices on the boundary and on the interfaces.

    Examples
    --------
    >>> curve_vertices(np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]), 5)
    array([ True,  True,  True,  True, False])
    """
    mask = np.zeros(n, bool)
    mask[curve_edges(triangles, regions)] = True
    return mask


def adjacency(triangles: Ints, n: int) -> csr_array:
    """Return who is whose neighbour as a sparse matrix (n, n) of float64 ones, row i holding the neighbours of vertex i.

    Two vertices are neighbours where a triangle has both (paper, section II-E). Each neighbour counts once, however many
    triangles the two share; a vertex is not its own neighbour; the columns in each row are sorted. The neighbours of vertex i
    are ``matrix.indices[matrix.indptr[i]:matrix.indptr[i + 1]]``.

    Examples
    --------
    >>> matrix = adjacency(np.array([[0, 1, 2], [0, 2, 3]]), 4)
    >>> matrix.indices[matrix.indptr[1]:matrix.indptr[2]].tolist()
    [0, 2]
    """
    from scipy.sparse import coo_array

    a, b = directed_edges(triangles).T
    matrix = coo_array((np.ones(2 * len(a)), (np.concatenate([a, b]), np.concatenate([b, a]))), shape=(n, n)).tocsr()
    matrix.data[:] = 1.0
    return matrix


def _span(sides: Ints, number: int, regions: Ints) -> tuple[Ints, Ints]:
    """Return the lowest and the highest region at each of `number` edges."""
    limits = np.iinfo(np.int64)
    low, high = np.full(number, limits.max), np.full(number, limits.min)
    of_side = np.repeat(regions, 3)
    np.minimum.at(low, sides.ravel(), of_side)
    np.maximum.at(high, sides.ravel(), of_side)
    return low, high
