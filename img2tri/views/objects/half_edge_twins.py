r"""Half-edges and their twins: triangles -> for each side of a triangle the same edge as the other triangle has it.

Side 3 t + k is side k of triangle t, from corner k to the next. A directed side is one integer, so its twin is the integer of the
opposite side; all are found by one sort::

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

from img2tri.arrays import Ints
from img2tri.errors import MeshError


def half_edge_twins(triangles: Ints, n: int) -> Ints:
    """Return for each side (3 m,) the one that runs the other way, or -1 where the mesh ends.

    Parameters
    ----------
    triangles
        (m, 3) int64, wound alike.
    n
        Number of vertices.

    Raises
    ------
    MeshError
        If two triangles run along a side in the same direction, so that no inside can be told from an outside.

    Examples
    --------
    >>> half_edge_twins(np.array([[0, 1, 2], [0, 2, 3]]), 4).tolist()
    [-1, -1, 3, 2, -1, -1]
    """
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    # Both sides of an edge have the same key, so they follow each other.
    key = np.minimum(start, end) * n + np.maximum(start, end)
    order, ordered = _sorted(key, n * n)
    alike = ordered[1:] == ordered[:-1]
    one, other = order[:-1][alike], order[1:][alike]
    twice = int(np.count_nonzero(start[one] == start[other]))
    if twice or np.any(alike[1:] & alike[:-1]):
        raise MeshError(
            "triangles: expected each side in at most two triangles, wound alike; "
            f"found {max(twice, 1)} that run along a side in the same direction as another"
        )
    twins = np.full(len(key), -1)
    twins[one], twins[other] = other, one
    return twins


def _sorted(keys: Ints, beyond: int) -> tuple[Ints, Ints]:
    """Return the order of keys below `beyond`, and the keys in this order: sorted with their places behind them, which is much faster."""
    bits = len(keys).bit_length()
    if beyond.bit_length() + bits > 63:
        order = np.argsort(keys)
        return order, keys[order]
    both = np.sort(keys << bits | np.arange(len(keys)))
    return both & ((1 << bits) - 1), both >> bits


def next_side(sides: Ints) -> Ints:
    """Return the next side of the same triangle: it begins where `sides` end."""
    return sides - sides % 3 + (sides + 1) % 3


def previous_side(sides: Ints) -> Ints:
    """Return the side of the same triangle that ends where `sides` begin."""
    return sides - sides % 3 + (sides + 2) % 3
