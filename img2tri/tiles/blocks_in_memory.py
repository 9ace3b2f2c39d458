"""An image in memory meshed by the same blocks as one by tiles: the same bits as `mesh_tiles` gives.

Each block depends on its own window and on its neighbours' borders alone, so that a change of the image changes the mesh in its block and
those around only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from img2tri.arrays import Ints, Points, as_rows
from img2tri.options.all_options import MeshOptions
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.tiles.block_plan import Plan, planned, refuse_by_blocks
from img2tri.tiles.mesh_block import mesh_block
from img2tri.tiles.parts.vertex_numbers import Seam, global_numbers, numbered_vertices, seam_of
from img2tri.tiles.piece_files import PiecesInMemory, load_piece
from img2tri.tiles.window_regions import cut_out
from img2tri.types import Frame, RecipeMesh


def conform_blocks(
    zones: Segmentation,
    frame: Frame,
    options: MeshOptions,
    labels: Sequence[int] | Ints,
    progress: Callable[[str, float], object] | None = None,
) -> RecipeMesh:
    """Mesh all regions of an image block by block, in the plane.

    Parameters
    ----------
    zones, frame
        The regions of the whole image, and where it lies.
    options
        All options of `mesh_image`.
    labels
        (r,) the label of each region number, that of number 0 not being used.
    progress
        What is called with the name of a stage and the fraction done.
    """
    refuse_by_blocks(dict(options))
    tell = progress or (lambda *_: None)
    meshed = zones.labels.size if zones.background is None else int(np.count_nonzero(zones.labels != zones.background))
    plan, store = planned(frame, dict(options), meshed), PiecesInMemory()
    cells = list(plan.in_order())
    for k, cell in enumerate(cells):
        tell("triangles", 0.3 + 0.6 * k / len(cells))
        mesh_block(plan, partial(cut_out, zones), store, cell)
    vertices, triangles, regions, seams = _joined(plan, store)
    order = np.argsort(labels[1:], kind="stable")
    number = order[np.searchsorted(np.asarray(labels)[1:][order], regions)] + 1
    return RecipeMesh(as_rows(vertices), triangles, number, {"blocks": len(cells), "seam_edges": seams})


def _joined(plan: Plan, store: PiecesInMemory) -> tuple[Points, Ints, Ints, int]:
    """Return the vertices (complex), triangles and labels of all pieces, each vertex once, and the number of edges on seams."""
    pieces = [load_piece(store, plan, cell)[0] for cell in plan.cells()]
    seams: list[Seam] = [seam_of(piece, plan, cell) for piece, cell in zip(pieces, plan.cells(), strict=True)]
    numbering, total = numbered_vertices(seams)
    vertices = np.zeros(total, np.complex128)
    triangles = []
    for piece, its in zip(pieces, numbering, strict=True):
        number = global_numbers(its)
        vertices[number] = piece.vertices
        triangles.append(number[piece.triangles])
    regions = np.concatenate([piece.regions for piece in pieces])
    return vertices, np.concatenate(triangles), regions, sum(len(seam.edges) for seam in seams) // 2
