"""Sets of edges that are known, as from a file: vertices at the ends of edges -> sides of triangles, beside the sets that are found.

An edge is in one set only, but for the pieces of sets: edges of known sets leave those that are found, and of two known sets the one within
the other is a piece of it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from img2tri.arrays import Ints
from img2tri.errors import MeshError


def with_known_edges(
    triangles: Ints, twins: Ints, regions: Ints, given: Mapping[str, Ints], found: Mapping[str, Ints], part_of: Mapping[str, str]
) -> tuple[dict[str, Ints], dict[str, str]]:
    """Put known sets beside those that were found.

    Parameters
    ----------
    triangles, twins, regions
        (m, 3) int64; (3 m,) the same side as the neighbour has it, or -1; (m,) labels.
    given
        Name -> (k, 2) vertices.
    found, part_of
        Name -> sides, side 3 t + k being side k of triangle t; name of a piece -> that of the whole.

    Returns
    -------
    sides, part_of
        Of all sets, known ones first.

    Raises
    ------
    MeshError
        If an edge is no side of a triangle.

    Examples
    --------
    >>> triangles, twins = np.array([[0, 1, 2], [0, 2, 3]]), np.array([-1, -1, 3, 2, -1, -1])
    >>> sets = with_known_edges(triangles, twins, np.array([1, 1]), {"inlet": np.array([[1, 0]])}, {"outer": np.array([0, 1, 4, 5])}, {})
    >>> {name: sides.tolist() for name, sides in sets[0].items()}
    {'inlet': [0], 'outer': [1, 4, 5]}
    """
    sides = {name: sides_of(triangles, twins, regions, edges, name) for name, edges in given.items()}
    pieces = {name: whole for name in sides if (whole := _whole(name, sides)) is not None}
    taken = np.zeros(triangles.size, bool)
    for name in [name for name in sides if name not in pieces]:
        sides[name] = sides[name][~taken[sides[name]]]
        taken[sides[name]] = True
    lost = np.flatnonzero(taken)
    taken[twins[lost][twins[lost] >= 0]] = True
    others = {name: rows[~taken[rows]] for name, rows in found.items() if name not in sides}
    wholes = {name: whole for name, whole in part_of.items() if name in others and len(others.get(whole, ()))}
    # A piece whose whole is gone, or has no other piece left, says nothing more than the whole.
    left = [whole for name, whole in wholes.items() if len(others[name])]
    others = {name: rows for name, rows in others.items() if name not in part_of or left.count(wholes.get(name, "")) > 1}
    return sides | others, pieces | {name: whole for name, whole in wholes.items() if name in others}


def sides_of(triangles: Ints, twins: Ints, regions: Ints, edges: Ints, name: str = "edges") -> Ints:
    """Return the side of a triangle that each edge is, once each; between two regions, that of the lower label."""
    n = int(max(triangles.max(), edges.max(initial=0))) + 1
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    keys = np.minimum(start, end) * n + np.maximum(start, end)
    order = np.argsort(keys, kind="stable")
    wanted = np.unique(edges.min(axis=1, initial=n) * n + edges.max(axis=1, initial=0)) if len(edges) else np.zeros(0, np.int64)
    at = order[np.searchsorted(keys, wanted, sorter=order).clip(max=len(keys) - 1)]
    if (keys[at] != wanted).any():
        raise MeshError(f"{name}: expected edges of triangles, found {int((keys[at] != wanted).sum())} others")
    other = twins[at]
    swapped = (other >= 0) & (regions[other // 3] < regions[at // 3])
    return np.asarray(np.where(swapped, other, at))


def _whole(name: str, sides: Mapping[str, Ints]) -> str | None:
    """Return the known set that has all edges of another, and more, or comes before one that is the same."""
    mine, order = sides[name], list(sides)
    before = order[: order.index(name)]
    larger = (
        other
        for other, rows in sides.items()
        if (len(rows) > len(mine) or other in before) and len(rows) >= len(mine) and np.isin(mine, rows).all()
    )
    return next(larger, None)
