"""The option `periodic` checked, and the chains along opposite sides of an image cut at the same places.

Copies of the image are set side by side: the cell is as wide as the image, and beside its last column lies its first. Their labels may
differ. Then chains along one side end where none does along the other, and are cut there too, so that they can be divided alike::

    left side   1 1 1 1 2 2 2          cut here, as the right side changes      1 1 1|1|2 2 2
    right side  1 1 1 2 2 2 2                                                   1 1 1|2|2 2 2

Between such places the border of two regions runs along the side itself. Where only one side is meshed, what lies there has no partner.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Ints
from img2tri.errors import ParameterError, shown
from img2tri.shapes.trace.crack_edges import NODE, CrackEdges

DIRECTIONS = {None: (), "x": (0,), "y": (1,), "xy": (0, 1)}  # which coordinate tells a side from the one opposite to it


def check_periodic(periodic: str | None, *, recipe: str = "conforming", smoothing: str | None = None) -> None:
    """Check that nothing stands against the option.

    Raises
    ------
    ParameterError
        If `periodic` is none of None, "x", "y", "xy"; if the recipe is one of the paper's, or smoothing moves the boundary.
    """
    if not (periodic is None or isinstance(periodic, str)) or periodic not in DIRECTIONS:
        raise ParameterError(f"periodic: expected 'x', 'y', 'xy' or None, found {shown(periodic)}")
    if periodic and (recipe != "conforming" or smoothing == "cotangent"):
        found = f"recipe {recipe!r}" if recipe != "conforming" else f"smoothing {smoothing!r}"
        raise ParameterError(f"periodic: expected None with {found}, which does not keep opposite sides alike, found {periodic!r}")


def cut_alike(crack_edges: CrackEdges, periodic: str | None) -> CrackEdges:
    """Cut the chains along opposite sides wherever one of the two ends.

    Examples
    --------
    >>> from img2tri.shapes.trace.crack_edges import find_crack_edges
    >>> edges = find_crack_edges(np.array([[1, 2, 1], [1, 2, 2]]))
    >>> [int((e.successor == NODE).sum()) for e in (edges, cut_alike(edges, "x"))]
    [10, 11]
    """
    successor = crack_edges.successor.copy()
    for axis in DIRECTIONS[periodic]:
        walls = [_along_wall(crack_edges, axis, last=last) for last in (False, True)]
        follows = np.zeros(len(successor), bool)
        follows[successor[successor != NODE]] = True
        ends = [np.concatenate([head[on & (successor == NODE)], tail[on & ~follows]]) for on, tail, head in walls]
        for on, _, head in walls:
            successor[on & np.isin(head, np.concatenate(ends))] = NODE
    return replace(crack_edges, successor=successor)


def _along_wall(crack_edges: CrackEdges, axis: int, *, last: bool) -> tuple[Bools, Ints, Ints]:
    """Tell which crack edges lie on a side of the image, and where along it all begin and end."""
    h, w = crack_edges.shape
    ends = [np.divmod(corners, w + 1) for corners in (crack_edges.tail, crack_edges.head)]
    (tail_across, tail), (head_across, head) = ((c, r) if axis == 0 else (r, c) for r, c in ends)
    wall = (w if axis == 0 else h) if last else 0
    return crack_edges.on_frame & (tail_across == wall) & (head_across == wall), tail, head
