"""The nodes of a periodic mesh that are the same place: cells -> pairs of nodes on opposite sides of the frame.

Left and right, or bottom and top, have the same pieces in the same order, and each piece the same nodes in the same order of places.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Ints
from img2tri.errors import MeshError
from img2tri.views.objects.solver_cells import Cells

_SIDES = {"x": ("left", "right"), "y": ("bottom", "top")}
_ALIKE = 1e-6  # how far two nodes of a pair may be apart along their sides, relative to the length of these


@dataclass(frozen=True, eq=False)
class NodePairs:
    """The nodes of a piece of one side, and those they repeat.

    Attributes
    ----------
    axis
        "x": right repeats left, "y": top repeats bottom.
    tag, master
        The tags of the two sets.
    nodes
        (k, 2) int64, the node and the one it repeats.
    """

    axis: str
    tag: int
    master: int
    nodes: Ints


def node_pairs(made: Cells) -> list[NodePairs]:
    """Return the pairs of nodes of a periodic mesh, piece by piece; none if it is not.

    Raises
    ------
    MeshError
        If nodes have no partner, as of a mesh that was changed.
    """
    found = []
    for axis in made.periodic:
        low, high = _SIDES[axis]
        if low not in made.sides and high not in made.sides:
            continue
        pieces = [[name for name, whole in made.part_of.items() if whole == side] or [side] for side in (low, high)]
        if low not in made.sides or high not in made.sides or len(pieces[0]) != len(pieces[1]):
            raise MeshError(f"periodic: expected {low} and {high} to have the same pieces, found others")
        for master, slave in zip(*pieces, strict=True):
            nodes = [_in_order(made, name, axis) for name in (slave, master)]
            if len(nodes[0]) != len(nodes[1]) or not _alike(made, nodes, axis):
                raise MeshError(f"periodic: expected the same places on {master} and {slave}, found others")
            found.append(NodePairs(axis, made.tags[slave], made.tags[master], np.stack(nodes, axis=1)))
    return found


def _in_order(made: Cells, name: str, axis: str) -> Ints:
    """Return the nodes of a set by their places along the side, then by height."""
    nodes = np.unique(made.facets(name))
    x, y, z = made.points[nodes].T
    return np.asarray(nodes[np.lexsort((z, y if axis == "x" else x))])


def _alike(made: Cells, nodes: list[Ints], axis: str) -> bool:
    along = made.points[:, [1, 2] if axis == "x" else [0, 2]]
    return bool(np.all(np.abs(along[nodes[0]] - along[nodes[1]]) <= _ALIKE * np.ptp(along)))
