r"""Half-edges and their twins: triangles -> for each side of a triangle the same edge as the other triangle has it.

Side 3 t + k is side k of triangle t, from corner k to the next. Sorted by their ends, sides of one edge follow each other::

        c
       /|\
      / | \       side b -> c of the triangle on the left and side c -> b of the one on the right are twins
     /  |  \
    a   |   d
     \  |  /
      \ | /
       \|/
        b
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Ints, sorted_sides
from img2tri.errors import MeshError


def half_edge_twins(triangles: Ints) -> Ints:
    """Return for each side (3 m,) the one that runs the other way, or -1 where the mesh ends.

    Parameters
    ----------
    triangles
        (m, 3) int64, wound alike.

    Raises
    ------
    MeshError
        If two triangles run along a side in the same direction, so that no inside can be told from an outside.

    Examples
    --------
    >>> half_edge_twins(np.array([[0, 1, 2], [0, 2, 3]])).tolist()
    [-1, -1, 3, 2, -1, -1]
    """
    order, lower, higher = sorted_sides(triangles)
    alike = (lower[1:] == lower[:-1]) & (higher[1:] == higher[:-1])
    at, start = np.flatnonzero(alike), triangles.ravel()
    one, other = order[at], order[at + 1]
    twice = int(np.count_nonzero(start[one] == start[other]))
    if twice or np.any(alike[1:] & alike[:-1]):
        raise MeshError(
            "triangles: expected each side in at most two triangles, wound alike; "
            f"found {max(twice, 1)} that run along a side in the same direction as another"
        )
    twins = np.full(len(order), -1)
    twins[one], twins[other] = other, one
    return twins


def next_side(sides: Ints) -> Ints:
    """Return the next side of the same triangle: it begins where `sides` end."""
    return sides - sides % 3 + (sides + 1) % 3


def previous_side(sides: Ints) -> Ints:
    """Return the side of the same triangle that ends where `sides` begin."""
    return sides - sides % 3 + (sides + 2) % 3
