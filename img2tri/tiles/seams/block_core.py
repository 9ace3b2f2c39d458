"""The core of a new mesh, which no other piece is near to, set aside while what is around it is fitted, and put back.

So merging costs what the borders of blocks do, not their areas; of the core not a bit changes.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Ints
from img2tri.tiles.seams.piece_seams import Piece, Sides


def core_put_back(mesh: Piece, core: Bools, piece: Piece) -> Piece:
    """Join the core of a new mesh and what became of the rest; vertices of the new mesh stay in their order, others follow."""
    n = len(mesh.vertices)
    rim = np.unique(mesh.triangles[~core])
    places, number = np.unique(np.concatenate([mesh.vertices[rim], piece.vertices]), return_inverse=True)
    known = np.full(len(places), -1)
    known[number[: len(rim)]] = rim
    own = known[number[len(rim) :]]
    own[own < 0] = n + np.arange((own < 0).sum())
    vertices = np.concatenate([mesh.vertices, piece.vertices[own >= n]])
    triangles = np.concatenate([mesh.triangles[core], own[piece.triangles]])
    used = np.zeros(len(vertices), bool)
    used[triangles] = True
    local = np.cumsum(used) - 1
    regions = np.concatenate([mesh.regions[core], piece.regions])
    return Piece(vertices[used], local[triangles], regions, local[own[piece.seam]], piece.beyond)


def core_set_aside(mesh: Piece, core: Bools) -> tuple[Piece, Ints]:
    """Return a mesh without its core, which no other piece is near to, and the edges (k, 2) between both, the rest on their left."""
    used, local = np.unique(mesh.triangles[~core], return_inverse=True)
    inner = np.isin(used, mesh.triangles[core])
    local = local.reshape(-1, 3)
    edges, _ = Sides.of(local, len(used)).bare()
    return Piece(mesh.vertices[used], local, mesh.regions[~core], mesh.seam, mesh.beyond), edges[inner[edges].all(axis=1)]
