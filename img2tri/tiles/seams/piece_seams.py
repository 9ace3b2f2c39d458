"""A piece of a mesh, and what its edges part.

A piece knows the triangles it owns, and of each of their edges whether the mesh ends there or another piece goes on: the *seam*. Places are
complex numbers in the plane of the whole image (see `img2tri.types.Frame.plane`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from img2tri.arrays import Bools, Ints, Points

POCKET = 8  # triangles left alone are taken along
EVENINGS = 4  # rounds of filling notches


class SeamError(Exception):
    """Two pieces could not be joined; the caller meshes both in one window instead.

    Attributes
    ----------
    at
        (k,) complex, where, as far as it is known.
    """

    def __init__(self, message: str, at: Points | None = None) -> None:
        super().__init__(message)
        self.at = np.zeros(0, np.complex128) if at is None else at


@dataclass(frozen=True, eq=False)
class Piece:
    """Triangles of one block of an image, readable alone.

    Attributes
    ----------
    vertices
        (n,) complex, the corners of these triangles, those on the seam included.
    triangles, regions
        (m, 3) int64, counter-clockwise; (m,) int64, the image's own labels.
    seam
        (k, 2) int64, the edges beyond which another piece has a triangle, with the piece on their left.
    beyond
        (k,) int64, the label beyond each of them.
    """

    vertices: Points
    triangles: Ints
    regions: Ints
    seam: Ints
    beyond: Ints

    @classmethod
    def empty(cls) -> Piece:
        """Return a piece without triangles."""
        none = np.zeros((0, 2), np.int64)
        return cls(np.zeros(0, np.complex128), np.zeros((0, 3), np.int64), none[:, 0], none, none[:, 0])


@dataclass(frozen=True, eq=False)
class Sides:
    """The edges of triangles, each once, and the triangles on both sides.

    Attributes
    ----------
    low, high
        (e,) int64, the ends of each edge, the lower number first.
    left, right
        (e,) int64, the triangle on its left and right as seen from `low` to `high`; -1 where there is none.
    """

    low: Ints
    high: Ints
    left: Ints
    right: Ints

    @classmethod
    def of(cls, triangles: Ints, n: int) -> Sides:
        """Find the edges of triangles (m, 3) of `n` vertices; more than one triangle on one side of an edge is refused."""
        start, stop = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
        owner = np.repeat(np.arange(len(triangles)), 3)
        keys, edge = np.unique(np.minimum(start, stop) * n + np.maximum(start, stop), return_inverse=True)
        upward = start < stop
        left, right = np.full(len(keys), -1), np.full(len(keys), -1)
        left[edge[upward]], right[edge[~upward]] = owner[upward], owner[~upward]
        if (left >= 0).sum() + (right >= 0).sum() != len(start):
            raise SeamError("two triangles on one side of an edge")
        return cls(*np.divmod(keys, max(n, 1)), left, right)

    def codes(self, codes: Ints) -> tuple[Ints, Ints]:
        """Codes of the regions on the left and right; 0 where there is no triangle. `codes` are those of the triangles."""
        known = np.append(codes, 0)
        return known[self.left], known[self.right]

    def bare(self) -> tuple[Ints, Ints]:
        """Return the edges (b, 2) with one triangle, which lies on their left, and that triangle (b,)."""
        a, b = self.left < 0, self.right < 0
        edges = [np.stack([self.low[b], self.high[b]], axis=1), np.stack([self.high[a], self.low[a]], axis=1)]
        return np.concatenate(edges), np.concatenate([self.left[b], self.right[a]])


def join_pieces(pieces: Sequence[Piece]) -> Piece:
    """Join pieces at their seams: vertices at the same place become one, edges that match are no seam any longer."""
    if not pieces:
        return Piece.empty()
    vertices, number = np.unique(np.concatenate([piece.vertices for piece in pieces]), return_inverse=True)
    first = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangles = np.concatenate([number[piece.triangles + k] for piece, k in zip(pieces, first, strict=False)])
    seam = np.concatenate([number[piece.seam + k] for piece, k in zip(pieces, first, strict=False)])
    open_ = ~matched(seam, len(vertices))
    regions, beyond = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("regions", "beyond"))
    return Piece(vertices, triangles, regions, seam[open_], beyond[open_])


def matched(seam: Ints, n: int) -> Bools:
    """Tell which seam edges (k, 2) meet one that runs the other way."""
    return np.asarray(np.isin(seam[:, 0] * n + seam[:, 1], seam[:, 1] * n + seam[:, 0]))


def taken(vertices: Points, triangles: Ints, regions: Ints, chosen: Bools, met: Ints, met_labels: Ints) -> Piece:
    """Take the chosen triangles of a mesh as a piece.

    Parameters
    ----------
    vertices, triangles, regions
        The mesh.
    chosen
        (m,) bool, which triangles.
    met, met_labels
        (k, 2) int64, edges along which the mesh meets other pieces, with the mesh on their left, and the labels beyond.
    """
    seam, beyond = seams_around(triangles, regions, chosen, met, met_labels, len(vertices))
    used, local = np.unique(triangles[chosen], return_inverse=True)
    return Piece(vertices[used], local.reshape(-1, 3), regions[chosen], np.searchsorted(used, seam), beyond)


def without(piece: Piece, gone: Bools) -> Piece:
    """Return a piece without some of its triangles (m,), which others have now."""
    n = len(piece.vertices)
    touched = np.zeros(n, bool)
    touched[piece.triangles[gone]] = True
    near = touched[piece.triangles].any(axis=1)
    none = np.zeros((0, 2), np.int64)
    seam, beyond = seams_around(piece.triangles[near], piece.regions[near], ~gone[near], none, none[:, 0], n)
    corners = piece.triangles[gone]
    stays = ~np.isin(piece.seam[:, 0] * n + piece.seam[:, 1], corners * n + corners[:, [1, 2, 0]])
    used = np.zeros(n, bool)
    used[piece.triangles[~gone]] = True
    local = np.cumsum(used) - 1
    seam, beyond = np.concatenate([piece.seam[stays], seam]), np.concatenate([piece.beyond[stays], beyond])
    return Piece(piece.vertices[used], local[piece.triangles[~gone]], piece.regions[~gone], local[seam], beyond)


def seams_around(triangles: Ints, regions: Ints, chosen: Bools, met: Ints, met_labels: Ints, n: int) -> tuple[Ints, Ints]:
    """Find the edges of chosen triangles beyond which there are others, and the labels there; arguments as for `taken`."""
    sides = Sides.of(triangles, n)
    mine = np.append(chosen, False)
    ahead = mine[sides.left] & ~mine[sides.right] & (sides.right >= 0)
    back = mine[sides.right] & ~mine[sides.left] & (sides.left >= 0)
    corners = triangles[chosen]
    owned = np.isin(met[:, 0] * n + met[:, 1], corners * n + corners[:, [1, 2, 0]])
    forwards, backwards = np.stack([sides.low, sides.high], axis=1), np.stack([sides.high, sides.low], axis=1)
    seam = np.concatenate([forwards[ahead], backwards[back], met[owned]])
    return seam, np.concatenate([regions[sides.right[ahead]], regions[sides.left[back]], met_labels[owned]])


def evened(triangles: Ints, codes: Ints, chosen: Bools, eligible: Bools, met: Ints, n: int) -> Bools:
    """Choose a few triangles more or less, so that the border of those chosen leaves room for good triangles beyond.

    Notches and small pockets are filled, strips of one row up to an outline are taken along, and triangles that stick out are left.

    Parameters
    ----------
    triangles, codes, chosen, eligible
        The mesh, codes of its regions, the first choice (m,), and what may be chosen (m,).
    met
        (k, 2) int64, edges along which the mesh meets other pieces.
    n
        Number of vertices.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    sides = Sides.of(triangles, n)
    left, right = sides.codes(codes)
    inner = (sides.left >= 0) & (sides.right >= 0)
    outline = np.zeros(n, bool)
    outline[sides.low[left != right]] = outline[sides.high[left != right]] = True
    one, other = sides.left[inner], sides.right[inner]
    closed = ~inner & np.isin(sides.low * n + sides.high, met.min(axis=1) * n + met.max(axis=1))
    others = np.bincount(np.maximum(sides.left, sides.right)[closed], minlength=len(triangles))
    ends = sides.low[inner] + sides.high[inner]
    chosen = chosen.copy()

    def neighbours() -> Ints:
        count = np.bincount(one, chosen[other], len(triangles)) + np.bincount(other, chosen[one], len(triangles))
        return np.asarray(count, np.int64) + others

    def filled() -> None:
        for _ in range(EVENINGS):
            more = ~chosen & eligible & (neighbours() >= 2)
            if not more.any():
                break
            chosen[more] = True

    filled()
    # Beyond an edge of the border: the vertex opposite, if it is on an outline.
    total = triangles.sum(axis=1)
    tip = np.zeros(len(triangles), bool)
    for a, b in ((one, other), (other, one)):
        beyond = chosen[a] & ~chosen[b]
        tip[b[beyond]] |= outline[(total[b] - ends)[beyond]]
    chosen |= tip & eligible
    filled()
    bordering = np.bincount(one, minlength=len(triangles)) + np.bincount(other, minlength=len(triangles)) + others
    chosen &= ~((neighbours() <= 1) & (bordering == 3))
    between = ~chosen[one] & ~chosen[other]
    graph = csr_array((np.ones(between.sum(), np.int8), (one[between], other[between])), shape=(len(triangles),) * 2)
    part = connected_components(graph, directed=False)[1]
    touching = np.zeros(part.max(initial=-1) + 1, bool)
    touching[part[(neighbours() > others) & ~chosen]] = True
    pocket = touching & (np.bincount(part) <= POCKET)
    pocket[part[~eligible]] = False
    return np.asarray(chosen | pocket[part])


@dataclass(frozen=True, eq=False)
class Stubs:
    """Ends of outlines on the border of finished pieces.

    Attributes
    ----------
    at
        (k,) int64, the vertices.
    low, high
        (k,) int64, the codes of the regions the outline parts.
    away
        (k,) bool, with the lower region on its left the outline runs away from the finished pieces; else towards them.
    heading
        (k,) complex, into the middle of the sector that is not yet meshed.
    """

    at: Ints
    low: Ints
    high: Ints
    away: Bools
    heading: Points

    def chosen(self, which: Bools) -> Stubs:
        """Return some of them."""
        return Stubs(*(getattr(self, field.name)[which] for field in fields(self)))


def find_stubs(z: Points, border: Ints, beyond: Ints) -> Stubs:
    """Find where the region beyond the border of finished pieces changes.

    Parameters
    ----------
    z
        All vertices.
    border
        (b, 2) int64, its edges, the finished pieces on their left.
    beyond
        (b,) int64, the code of the region on the other side, 0 where nothing is meshed.
    """
    # At a vertex the sector that is not meshed lies clockwise of an edge that leaves it, up to an edge that arrives.
    at = np.concatenate([border[:, 0], border[:, 1]])
    other = np.concatenate([border[:, 1], border[:, 0]])
    leaves = np.repeat([True, False], len(border))
    edge = np.tile(np.arange(len(border)), 2)
    angle = np.angle(z[other] - z[at])
    order = np.lexsort((-angle, at))
    at, leaves, edge, angle = at[order], leaves[order], edge[order], angle[order]
    first = np.flatnonzero(np.diff(at, prepend=-1))
    last = np.append(first[1:], len(at)) - 1
    following = np.arange(len(at)) + 1
    following[last] = first
    i = np.flatnonzero(leaves)
    j = following[i]
    # A border cut off where it is far away has vertices with one edge only.
    whole = ~leaves[j]
    i, j = i[whole], j[whole]
    one, two = beyond[edge[i]], beyond[edge[j]]
    changes = one != two
    i, j, one, two = i[changes], j[changes], one[changes], two[changes]
    turn = (angle[i] - angle[j]) % (2 * np.pi)
    heading = np.exp(1j * (angle[i] - np.where(turn == 0, 2 * np.pi, turn) / 2))
    # Looking out, the first region is on the left.
    return Stubs(at[i], np.minimum(one, two), np.maximum(one, two), one < two, heading)
