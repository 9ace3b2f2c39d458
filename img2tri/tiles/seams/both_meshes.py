"""A new mesh and finished pieces in the same numbers: what is near the border of the finished ones, and where who may take triangles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows
from img2tri.tiles.seams.piece_seams import Piece, Sides, seams_around

SAME = 1e-6  # px: vertices nearer to each other are one but for rounding


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

    def around(self, places: Points, reach: float) -> Territory:
        """Return the part of it that is near some places."""
        from scipy.spatial import cKDTree

        tree = cKDTree(as_rows(places))

        def outside(z: Points) -> Floats:
            distance: Floats = np.asarray(tree.query(as_rows(z.ravel()))[0])
            return np.asarray(np.maximum(self.outside(z), distance.reshape(z.shape) - reach))

        return Territory(outside, self.takes, self.margin)


@dataclass(frozen=True, eq=False)
class Both:
    """New mesh and finished pieces in the same numbers: vertices, triangles with codes of their regions, and the border of the old ones.

    `border` has the finished pieces on its left, `own` and `beyond` are the codes of the regions on both sides;
    `fresh` are those edges of it beyond which finished triangles were given up. `cut` are the edges towards the core of the new mesh.
    `moved` (n,) are the vertices of the new mesh that took the places of finished ones.
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
    moved: Bools

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


def _on_finished(mesh: Piece, finished: Points, alike: Floats) -> Points:
    """Return the vertices of a mesh, those that are nearly at the place of a finished one there.

    Windows make nearly the same vertices of the same outlines and lattice; what they differ in comes from their frames, far away.
    """
    from scipy.spatial import cKDTree

    z = mesh.vertices
    if not len(z) or not len(finished):
        return z
    shortest = np.full(len(z), np.inf)
    for a, b in (mesh.triangles[:, [k, (k + 1) % 3]].T for k in range(3)):
        length = np.abs(z[b] - z[a])
        np.minimum.at(shortest, a, length)
        np.minimum.at(shortest, b, length)
    reach = np.maximum(alike * np.where(np.isfinite(shortest), shortest, 0.0), SAME)
    query = cKDTree(as_rows(finished)).query(as_rows(z), distance_upper_bound=float(reach.max()))
    distance, nearest = np.asarray(query[0], np.float64), np.asarray(query[1], np.int64)
    close = np.flatnonzero(distance < reach)
    # Of several near one finished vertex the nearest has it.
    close = close[np.lexsort((distance[close], nearest[close]))]
    close = close[np.flatnonzero(np.diff(nearest[close], prepend=-1))]
    result = z.copy()
    result[close] = finished[nearest[close]]
    return result


def together(mesh: Piece, finished: Piece, lost: Bools, labels: Ints, territory: Territory, cut: Ints, alike: Floats) -> Both:
    """Bring both into the same numbers; only what is near counts, and of the finished triangles those not given up.

    `alike` (n,) is how near, in edges, vertices of the new mesh are to finished ones whose places they take.
    """
    own = _on_finished(mesh, finished.vertices, alike)
    z, number = np.unique(np.concatenate([own, finished.vertices]), return_inverse=True)
    n, margin = len(z), territory.margin
    new, old = number[mesh.triangles], number[finished.triangles + len(mesh.vertices)]
    seam, beyond_seam = number[finished.seam + len(mesh.vertices)], finished.beyond
    before = seam[:, 0] * n + seam[:, 1]
    if lost.any():
        seam, beyond_seam = seams_around(old, finished.regions, ~lost, seam, beyond_seam, n)
    outside = territory.outside(z)
    moved = np.zeros(n, bool)
    moved[number[np.flatnonzero(np.abs(own - mesh.vertices) > SAME)]] = True
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
    return Both(z, outside, new, codes, old, old_codes, border, old_codes[owner], beyond, fresh, number[cut], moved)
