r"""The edges of a triangle mesh: triangles -> each edge once, which edges each triangle has, and which of them can be seen from afar.

Each edge is packed into one integer and sorted. The sides of a triangle are numbered by the corner they begin in, as in VTK::

              2
             / \             side 0 runs from corner 0 to corner 1
      side 2/   \side 1      side 1 runs from corner 1 to corner 2
           /     \           side 2 runs from corner 2 to corner 0
          0-------1
            side 0
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.types import Bools, Ints


def unique_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return each edge once, and the edges of each triangle.

    Parameters
    ----------
    triangles
        (m, 3) int64.

    Returns
    -------
    edges
        (e, 2) int64, lower vertex first, sorted: the order in which values per edge are expected everywhere in img2tri.
    sides
        (m, 3) int64, the row in `edges` of each side of each triangle.

    Examples
    --------
    >>> edges, sides = unique_edges(np.array([[0, 1, 2], [0, 2, 3]]))
    >>> edges.tolist(), sides.tolist()
    ([[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]], [[0, 3, 1], [1, 4, 2]])
    """
    start, end = triangles, np.roll(triangles, -1, axis=1)
    n = int(triangles.max(initial=0)) + 1
    keys, sides = np.unique(np.minimum(start, end) * n + np.maximum(start, end), return_inverse=True)
    return np.stack(np.divmod(keys, n), axis=1), sides.reshape(triangles.shape)


def bordering(sides: Ints, labels: NDArray[Any]) -> Bools:
    """Return a mask (e,) of the edges that bound the mesh or part two regions.

    Parameters
    ----------
    sides
        (m, 3) int64 from `unique_edges`.
    labels
        (m,), the region of each triangle.

    Examples
    --------
    >>> bordering(unique_edges(np.array([[0, 1, 2], [0, 2, 3]]))[1], np.array([7, 7])).tolist()
    [True, False, True, True, True]
    """
    order = np.argsort(sides, axis=None, kind="stable")
    edge, label = sides.ravel()[order], np.repeat(labels, 3)[order]
    # The two sides of an inner edge follow each other.
    alike = (edge[1:] == edge[:-1]) & (label[1:] == label[:-1])
    border = np.ones(int(sides.max(initial=-1)) + 1, bool)
    border[edge[1:][alike]] = False
    return border
