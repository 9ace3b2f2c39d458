"""A new mesh and finished pieces in the same numbers: what is near the border of the finished ones, and where who may take triangles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows
from img2tri.tiles.seams.piece_seams import Piece, Sides, seams_around

SAME = 1e-6  # px: vertices nearer to each other are one; windows differ by 1e-10


@dataclass(frozen=True)
class Territory:
    """Where a piece may take triangles.

    Attributes
    ----------
    outside
        Function of places (k,) that returns how far they lie outside of the piece's own block; within, less than 0: how far from where
        it meets others, minus infinity if it meets none.
    takes
        Function of places (k,): whether a triangle whose middle lies there is the piece's, if no finished piece covers it.
    margin
        How far outside the new mesh is looked at.
    """

    outside: Callable[[Points], Floats]
    takes: Callable[[Points], Bools]
    margin: float


@dataclass(frozen=True, eq=False)
class Both:
    """New mesh and finished pieces in the same numbers: vertices, triangles with codes of their regions, and the border of the old ones.

    `border` has the finished pieces on its left, `own` and `beyond` are the codes of the regions on both sides;
    `fresh` are those edges of it beyond which finished triangles were given up. `cut` are the edges towards the core of the new mesh.
    """

    z: Points
    outside: Floats
    new: Ints
    new_codes: Ints
    old: Ints
    old_codes: Ints
    border: Ints
    own: Ints
    beyond: Ints
    fresh: Bools
    cut: Ints

    def covered(self, places: Points) -> Bools:
        """Tell which places lie in finished pieces, or on their border."""
        result = np.zeros(len(places), bool)
        if self.tree is not None:
            result[np.unique(self.tree.query(shapely.points(places.real, places.imag), predicate="intersects")[0])] = True
        return result

    @cached_property
    def tree(self) -> shapely.STRtree | None:
        """The finished triangles by place."""
        return shapely.STRtree(shapely.polygons(as_rows(self.z[self.old.ravel()]).reshape(-1, 3, 2))) if len(self.old) else None


def _on_finished(new: Points, finished: Points) -> Points:
    """Put vertices that are a finished one but for rounding, as windows add in another order, where that is."""
    from scipy.spatial import cKDTree

    if not len(new) or not len(finished):
        return new
    distance, nearest = cKDTree(as_rows(finished)).query(as_rows(new), distance_upper_bound=SAME)
    return np.where(distance < SAME, finished[np.minimum(nearest, len(finished) - 1)], new)


def together(mesh: Piece, finished: Piece, lost: Bools, labels: Ints, territory: Territory, cut: Ints) -> Both:
    """Bring both into the same numbers; only what is near counts, and of the finished triangles those not given up."""
    z, number = np.unique(np.concatenate([_on_finished(mesh.vertices, finished.vertices), finished.vertices]), return_inverse=True)
    n, margin = len(z), territory.margin
    new, old = number[mesh.triangles], number[finished.triangles + len(mesh.vertices)]
    seam, beyond_seam = number[finished.seam + len(mesh.vertices)], finished.beyond
    before = seam[:, 0] * n + seam[:, 1]
    if lost.any():
        seam, beyond_seam = seams_around(old, finished.regions, ~lost, seam, beyond_seam, n)
    outside = territory.outside(z)
    near = territory.outside(np.asarray(z[new].mean(axis=1), np.complex128)) < margin
    new, codes = new[near], np.searchsorted(labels, mesh.regions[near]) + 1
    near = (territory.outside(np.asarray(z[old].mean(axis=1), np.complex128)) < 2 * margin) & ~lost
    old, old_codes = old[near], np.searchsorted(labels, finished.regions[near]) + 1
    border, owner = Sides.of(old, n).bare()
    true = (outside[border] < margin).all(axis=1)
    border, owner = border[true], owner[true]
    beyond = np.zeros(len(border), np.int64)
    keys, wanted = seam[:, 0] * n + seam[:, 1], border[:, 0] * n + border[:, 1]
    if len(keys):
        order = np.argsort(keys)
        at = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
        goes_on = keys[at] == wanted
        beyond[goes_on] = np.searchsorted(labels, beyond_seam[at[goes_on]]) + 1
    fresh = (beyond > 0) & ~np.isin(wanted, before)
    return Both(z, outside, new, codes, old, old_codes, border, old_codes[owner], beyond, fresh, number[cut])
