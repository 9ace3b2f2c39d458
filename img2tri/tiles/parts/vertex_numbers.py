"""The proof that all pieces fit, edge by edge, and the numbers of vertices in the whole mesh.

In: the seams of all pieces. Every edge of a seam has to be that of exactly one other piece, run through the other way, between vertices of
the same bits; if one is not, there is no mesh but an error. Out: for each piece which of its vertices are its own, and the numbers of those
it shares. Only seams are held, nothing that grows with the area of the image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Ints, Points
from img2tri.errors import MeshError
from img2tri.tiles.block_plan import Cell, Plan
from img2tri.tiles.seams.piece_seams import Piece, Sides

NEAR = 4  # margins: how far within a block those of others may reach


@dataclass(frozen=True, eq=False)
class Seam:
    """What of a piece others share.

    Attributes
    ----------
    count, triangles
        How many vertices and triangles the piece has.
    numbers
        (k,) int64, its vertices on seams, and those that others may have though no edge is shared.
    places
        (k,) complex, where they are.
    edges
        (e, 2) int64, its seam edges, as places in `numbers`.
    """

    count: int
    triangles: int
    numbers: Ints
    places: Points
    edges: Ints


def seam_of(piece: Piece, plan: Plan, cell: Cell) -> Seam:
    """Return what of the piece of a block others share: its seam, and corners of outlines near its border, which may be all they have."""
    near = np.flatnonzero(plan.territory(cell, NEAR).outside(piece.vertices) > -NEAR * plan.margin)
    beside = np.zeros(len(piece.vertices), bool)
    beside[near] = True
    bare, _ = Sides.of(piece.triangles[beside[piece.triangles].any(axis=1)], len(piece.vertices)).bare()
    numbers = np.unique(np.concatenate([piece.seam.ravel(), bare[beside[bare]]]))
    return Seam(len(piece.vertices), len(piece.triangles), numbers, piece.vertices[numbers], np.searchsorted(numbers, piece.seam))


@dataclass(frozen=True, eq=False)
class Numbering:
    """The numbers of the vertices of a piece in the whole mesh.

    Attributes
    ----------
    count, triangles
        How many vertices and triangles the piece has.
    local, numbers
        (k,) int64, its vertices that others share or may share, and their numbers in the whole mesh.
    first
        The number of the first of its own vertices, which follow each other; what is less belongs to others.
    """

    count: int
    triangles: int
    local: Ints
    numbers: Ints
    first: int


def numbered_vertices(seams: Sequence[Seam]) -> tuple[list[Numbering], int]:
    """Give the vertices of all pieces numbers, each one.

    Parameters
    ----------
    seams
        Of all pieces, in their order. A vertex on a seam belongs to the first piece that has it.

    Returns
    -------
    numbering : list of Numbering
        Of each piece.
    total : int

    Raises
    ------
    MeshError
        If an edge of a seam has no partner, or two.
    """
    places, vertex = np.unique(np.concatenate([seam.places for seam in seams]), return_inverse=True)
    piece = np.repeat(np.arange(len(seams)), [len(seam.numbers) for seam in seams])
    first = np.cumsum([0, *(len(seam.numbers) for seam in seams)])
    edges = np.concatenate([vertex[seam.edges + k] for seam, k in zip(seams, first, strict=False)])
    _check(places, edges)
    owner = np.full(len(places), len(seams))
    np.minimum.at(owner, vertex, piece)
    own = owner[vertex] == piece
    result, total, known = [], 0, np.full(len(places), -1)
    for k, seam in enumerate(seams):
        mine, at = own[first[k] : first[k + 1]], vertex[first[k] : first[k + 1]]
        # Its own vertices are numbered in their order, those of others left out.
        before = np.zeros(seam.count + 1, np.int64)
        before[seam.numbers[~mine] + 1] = 1
        rank = seam.numbers - np.cumsum(before)[seam.numbers]
        known[at[mine]] = total + rank[mine]
        result.append(Numbering(seam.count, seam.triangles, seam.numbers, known[at], total))
        total += seam.count - int((~mine).sum())
    return result, total


def _check(places: Points, edges: Ints) -> None:
    n = len(places)
    keys, there, count = np.unique(edges[:, 0] * n + edges[:, 1], return_index=True, return_counts=True)
    back = np.isin(edges[there, 1] * n + edges[there, 0], keys)
    wrong = ~back | (count > 1)
    if wrong.any():
        at = places[edges[there][wrong]].mean(axis=1)[0]
        raise MeshError(
            f"seams: {int(wrong.sum())} edges do not fit, the first at ({at.real:.2f}, {at.imag:.2f}) px; please report this image"
        )


def global_numbers(one: Numbering) -> Ints:
    """Return the number in the whole mesh of each vertex (count,) of a piece."""
    shared = one.numbers < one.first
    own = np.ones(one.count, bool)
    own[one.local[shared]] = False
    result = np.cumsum(own) - 1 + one.first
    result[one.local[shared]] = one.numbers[shared]
    return result
