"""What a piece and finished ones must not be where they meet: doubled in a vertex, or a region that touches itself in one."""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Ints, as_rows
from img2tri.tiles.seams.both_meshes import SAME, Both
from img2tri.tiles.seams.piece_seams import Piece, SeamError, Sides


def check_joint(piece: Piece, both: Both, labels: Ints, within: float) -> None:
    """Refuse a piece that is not as it must be where it meets finished ones.

    Parameters
    ----------
    piece, both
        The piece, and what it was made of.
    labels
        Of the codes of regions, from 1 on.
    within
        How far outside of its block is looked.

    Raises
    ------
    SeamError
        If two vertices are one but for rounding, or triangles of a region around a vertex are more than one fan.
    """
    from scipy.spatial import cKDTree

    if not len(piece.triangles):
        return
    used = np.unique(both.old)
    z, number = np.unique(np.concatenate([piece.vertices, both.z[used]]), return_inverse=True)
    every = np.concatenate([number[piece.triangles], number[len(piece.vertices) + np.searchsorted(used, both.old)]])
    codes = np.concatenate([np.searchsorted(labels, piece.regions) + 1, both.old_codes])
    doubled = cKDTree(as_rows(z)).query_pairs(SAME, output_type="ndarray") if len(used) else np.zeros((0, 2), np.int64)
    if len(doubled):
        raise SeamError("two vertices are one but for rounding", z[doubled[:, 0]])
    size = len(labels) + 1
    corners, fans = np.unique(every * size + codes[:, None], return_counts=True)
    sides = Sides.of(every, len(z))
    left, right = sides.codes(codes)
    inner = (left == right) & (sides.left >= 0) & (sides.right >= 0)
    shared, count = np.unique(np.concatenate([sides.low[inner], sides.high[inner]]) * size + np.tile(left[inner], 2), return_counts=True)
    fans[np.searchsorted(corners, shared)] -= count
    # On seams that are still open, where the core was set aside, and far outside there are no whole fans.
    open_ = np.zeros(len(z), bool)
    edge = np.concatenate([number[piece.seam], np.searchsorted(z, both.z[both.border[both.beyond > 0]])])
    met = np.isin(edge[:, 0] * len(z) + edge[:, 1], edge[:, 1] * len(z) + edge[:, 0])
    open_[edge[~met]] = True
    for places in (both.z[both.cut.ravel()], both.z[both.outside > within]):
        at = np.minimum(np.searchsorted(z, places), len(z) - 1)
        open_[at[z[at] == places]] = True
    pinched = np.unique(corners[fans > 1] // size)
    pinched = pinched[~open_[pinched]]
    if len(pinched):
        raise SeamError("a region touches itself in a vertex", z[pinched])
