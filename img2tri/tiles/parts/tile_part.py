"""The blocks of a tile -> a part of the mesh, readable alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Floats, Ints, as_rows
from img2tri.tiles.block_plan import Cell, Plan
from img2tri.tiles.parts.vertex_numbers import Numbering, global_numbers
from img2tri.tiles.piece_files import PieceStore, load_piece
from img2tri.tiles.seams.piece_seams import join_pieces


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a mesh, readable alone.

    Attributes
    ----------
    name
        Of the part: rows and columns of its tile.
    vertices, triangles, regions
        As of a mesh, in world units.
    numbers
        (n,) int64, the numbers of its vertices in the whole mesh.
    blocks
        (b, 2) int64, for each block of the part the number of its first triangle in the whole mesh, and how many follow.
    """

    name: str
    vertices: Floats
    triangles: Ints
    regions: Ints
    numbers: Ints
    blocks: Ints


@dataclass(frozen=True, eq=False)
class PartPlan:
    """What one part is made of, and where it lies among the others.

    Attributes
    ----------
    name
        Rows and columns of its tile.
    cells, numbering, blocks
        Its blocks, the numbers of the vertices of each, and the number of its first triangle with how many follow.
    n_vertices, n_triangles
        Of the part.
    place
        How many parts with triangles, vertices and triangles of such parts come before.
    """

    name: str
    cells: list[Cell]
    numbering: list[Numbering]
    blocks: list[tuple[int, int]]
    n_vertices: int
    n_triangles: int
    place: tuple[int, int, int]


def planned_parts(plan: Plan, tile: int, numbering: dict[Cell, Numbering]) -> list[PartPlan]:
    """Return the parts of a mesh, one for each tile of about so many px, whole blocks."""
    side = max(1, round(tile / plan.block))
    rows, columns = plan.grid
    tiles = [(i, j) for i in range(0, rows, side) for j in range(0, columns, side)]
    firsts, triangles = {}, 0
    for cell in plan.cells():
        firsts[cell] = triangles
        triangles += numbering[cell].triangles
    parts, before = [], (0, 0, 0)
    for i, j in tiles:
        cells = [(a, b) for a in range(i, min(rows, i + side)) for b in range(j, min(columns, j + side))]
        its = [numbering[cell] for cell in cells]
        # Vertices on seams between its own blocks are one.
        shared = np.unique(np.concatenate([one.numbers for one in its]))
        n = len(shared) + sum(one.count - len(one.numbers) for one in its)
        m = sum(one.triangles for one in its)
        blocks = [(firsts[cell], numbering[cell].triangles) for cell in cells]
        parts.append(PartPlan(f"{i // side}-{j // side}", cells, its, blocks, n, m, before))
        before = (before[0] + 1, before[1] + n, before[2] + m) if m else before
    return parts


def tile_part(plan: Plan, store: PieceStore, wanted: PartPlan) -> Part:
    """Join the blocks of a tile."""
    pieces = [load_piece(store, plan, cell)[0] for cell in wanted.cells]
    numbers = [global_numbers(one) for one in wanted.numbering]
    piece, number = pieces[0], numbers[0]
    if len(pieces) > 1:
        piece = join_pieces(pieces)
        number = np.zeros(len(piece.vertices), np.int64)
        for one, its in zip(pieces, numbers, strict=True):
            number[np.searchsorted(piece.vertices, one.vertices)] = its
    world = plan.frame.world(as_rows(piece.vertices))
    return Part(wanted.name, world, piece.triangles, piece.regions, number, np.array(wanted.blocks))
