"""Constrained Delaunay triangulation, and the proof that its faces are the regions they should be.

In: points, segments that must appear as edges, and the regions on the left and right of each segment. Out: triangles, each with its
region. The triangulation itself is pythoncdt's, with exact predicates (L. P. Chew, Constrained Delaunay triangulations, Algorithmica 4,
1989, https://doi.org/10.1007/BF01553881). The regions are found by flood fill: triangles joined across edges that are no segments make
a face, and every segment casts two votes, one for the face on each of its sides. If all votes agree, each region lies on the side of its
outlines where it belongs, whatever was done to the outlines before; if not, two outlines have changed sides or crossed, and `PslgError`
says where.

Libraries offer to erase "outer triangles and holes" by counting how many outlines surround them. Votes are safer, as they check;
they serve any number of regions; and they are faster.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pythoncdt
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.triangles.connected_faces import connected_faces, spread

SUPER = 3  # corners of one triangle around everything, which pythoncdt puts before the vertices it was given


class PslgError(MeshError):
    """Points and segments are no planar straight-line graph, or the regions named by segments around one face differ.

    Attributes
    ----------
    segments
        The segments at fault, as far as they are known: those of the outvoted side of a face.
    """

    def __init__(self, message: str, segments: ArrayLike = ()) -> None:
        super().__init__(message)
        self.segments: Ints = np.asarray(segments, np.int64)


def triangulate(points: Floats, segments: Ints, left: Ints, right: Ints) -> tuple[Ints, Ints]:
    """Triangulate the regions between segments.

    Every point of a region other than 0 is a vertex, every segment an edge; apart from that the triangles are Delaunay.

    Parameters
    ----------
    points : (n, 2) float64
        All different.
    segments : (s, 2) int64
        Index pairs into `points`. Segments meet in their end points only, and no other point lies on them.
    left, right : (s,) int64
        Region on either side of each segment, seen from its first point to its second; 0 is not meshed.

    Returns
    -------
    triangles : (m, 3) int64
        Counter-clockwise; none in region 0.
    regions : (m,) int64
        The region of each triangle.

    Raises
    ------
    PslgError
        If segments cross, points coincide, or the regions contradict each other.

    Examples
    --------
    A square of region 7, its outline running counter-clockwise, with a point in the middle:

    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    >>> outline = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> triangles, regions = triangulate(square, outline, np.full(4, 7), np.zeros(4, int))
    >>> len(triangles), regions
    (4, array([7, 7, 7, 7]))
    """
    check_pslg(points, segments, left, right)
    triangulation = insert(points, segments)
    triangles, regions = _label(triangulation, len(points), segments, left, right)
    inside = regions.nonzero()[0]
    return triangles[inside], regions[inside]


@dataclass(frozen=True, eq=False)
class Refined:
    """A triangulation with points added.

    Attributes
    ----------
    vertices
        (v, 2) float64: the given points, then those added.
    triangles, regions
        As from `triangulate`.
    segments
        (p, 2) int64, segments and pieces of split segments, running the way of the segment.
    origin
        (p,) int64, the segment each is, or is a piece of.
    """

    vertices: Floats
    triangles: Ints
    regions: Ints
    segments: Ints
    origin: Ints


def ruppert(points: Floats, segments: Ints, left: Ints, right: Ints, min_angle: float, min_edge: float, most: int | None = None) -> Refined:
    """Triangulate as `triangulate` does, then add points until every angle is `min_angle` (Ruppert's refinement).

    Points are added at circumcentres, and in the middle of segments, which are thereby split. Where two segments meet in
    a sharper corner than about 60 degrees, or the shortest edges would become shorter than `min_edge`, angles may stay below.

    Parameters
    ----------
    points, segments, left, right
        As for `triangulate`.
    min_angle : float
        Degrees. Above 30 or so the refinement needs very many points or does not reach it.
    min_edge : float
        No edge shorter than this is split; smaller values reach the angle in more places, with more triangles.
    most : int, optional
        How many points it may add before it stops; None: as many as it is likely to need.

    Notes
    -----
    J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, J. Algorithms 18, 1995,
    https://doi.org/10.1006/jagm.1995.1021.
    """
    check_pslg(points, segments, left, right)
    triangulation = insert(points, segments)
    _, regions = _label(triangulation, len(points), segments, left, right)
    outside = set((regions == 0).nonzero()[0].tolist())
    budget = 20 * len(points) + 10_000 if most is None else most
    by_angle = pythoncdt.RefinementCriterion.SMALLEST_ANGLE
    triangulation.refine_triangles(budget, by_angle, math.radians(min_angle), outside, min_edge)
    corners = triangulation.vertices_array()[SUPER:]
    vertices = np.stack([corners["x"], corners["y"]], axis=1)
    pieces, whole = _pieces(triangulation, vertices, segments)
    triangles, regions = _label(triangulation, len(vertices), pieces, left[whole], right[whole])
    inside = regions.nonzero()[0]
    return Refined(vertices, triangles[inside], regions[inside], pieces, whole)


def check_pslg(points: Floats, segments: Ints, left: Ints, right: Ints) -> None:
    """Check what can be told without triangulating: shapes, finite coordinates, indices, segments of no length."""
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise PslgError(f"points: expected finite coordinates (n, 2), found shape {points.shape}, or NaN or infinity in them")
    if segments.ndim != 2 or segments.shape[1] != 2 or not (left.shape == right.shape == segments.shape[:1]):
        raise PslgError(f"segments, left, right: expected (s, 2), (s,), (s,), found {segments.shape}, {left.shape}, {right.shape}")
    if len(segments) and not (segments.min() >= 0 and segments.max() < len(points)):
        raise PslgError(f"segments: expected indices of {len(points)} points, found {segments.min()} to {segments.max()}")
    none = (points[segments[:, 0]] == points[segments[:, 1]]).all(axis=1)
    if none.any():
        raise PslgError("segments: expected two different points each", none.nonzero()[0])


def insert(points: Floats, segments: Ints) -> pythoncdt.Triangulation:
    """Triangulate; the outer triangles and holes are still there."""
    triangulation = pythoncdt.Triangulation(pythoncdt.VertexInsertionOrder.AUTO, pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0)
    try:
        # Arrays are buffers, though before Python 3.12 type checkers cannot know.
        triangulation.insert_vertices(np.ascontiguousarray(points, np.float64))  # type: ignore[call-overload, unused-ignore]
        triangulation.insert_edges(np.ascontiguousarray(segments, np.uint32))  # type: ignore[call-overload, unused-ignore]
    except RuntimeError as error:
        raise PslgError(f"points and segments: expected a planar straight-line graph, found: {error}") from error
    return triangulation


def _label(triangulation: pythoncdt.Triangulation, n: int, segments: Ints, left: Ints, right: Ints) -> tuple[Ints, Ints]:
    """All triangles, also those of region 0, and the regions that the segments vote for."""
    table = triangulation.triangles_array(copy=False)
    triangles, neighbours = table["vertices"].astype(np.int64) - SUPER, table["neighbors"].view(np.int32)
    a, b, c = triangles.T
    outer = ((a < 0) | (b < 0) | (c < 0)).nonzero()[0]
    edges, owners, votes = _votes(triangles, n, segments, left, right)
    # Triangles joined across edges that are no segments; -1 for the rest.
    joined = neighbours.copy()
    joined.ravel()[edges] = -1
    # Every face takes the label its voters name; the face around everything, 0.
    region, known = np.zeros(len(triangles), np.int64), np.zeros(len(triangles), bool)
    region[edges // 3], region[outer] = votes, 0
    known[edges // 3] = known[outer] = True
    spread(joined, region, known)
    if (region[edges // 3] != votes).any() or ((region[joined] != region[:, None]) & (joined >= 0)).any():
        at_fault = _outvoted(joined, outer, edges, owners, votes)
        raise PslgError(f"left and right: expected one region on each face, found {len(at_fault)} segments that disagree", at_fault)
    return triangles, region


def _outvoted(joined: NDArray[np.int32], outer: Ints, edges: Ints, owners: Ints, votes: Ints) -> Ints:
    """Return the segments that vote for another region than the face on that side of them has, which is that of one of its voters."""
    faces = connected_faces(joined)
    region = np.zeros(faces.max() + 1, np.int64)
    region[faces[edges // 3]] = votes
    region[faces[outer]] = 0
    return np.unique(owners[region[faces[edges // 3]] != votes])


def _votes(triangles: Ints, n: int, segments: Ints, left: Ints, right: Ints) -> tuple[Ints, Ints, Ints]:
    r"""Find the segments in the triangulation, as edges 3 t + k; return these, their segments, their votes for triangle t.

    Edge 3 t + k runs from corner k of triangle t to the next corner and has t on its left::

              2
             / \
            2   1       numbers inside: edges
           /  0  \
          0-------1     numbers outside: corners
    """
    on_segments = np.zeros(n + SUPER, bool)
    on_segments[segments] = True  # a corner of the outermost triangle has a negative index: one of the last, which stay False
    start = triangles.ravel()
    stop = triangles[:, [1, 2, 0]].ravel()
    edges = (on_segments[start] & on_segments[stop]).nonzero()[0]
    # One number per directed edge: those of the segments, and those of the segments turned round.
    known = np.concatenate([segments[:, 0] * n + segments[:, 1], segments[:, 1] * n + segments[:, 0]])
    order = np.argsort(known)
    known = known[order]
    wanted = start[edges] * n + stop[edges]
    found = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    hit = known[found] == wanted
    edges, found = edges[hit], order[found[hit]]
    if len(edges) != len(known):
        raise PslgError("segments: expected each once, and no point on them")
    return edges, found % len(segments), np.concatenate([left, right])[found]


def _pieces(triangulation: pythoncdt.Triangulation, vertices: Floats, segments: Ints) -> tuple[Ints, Ints]:
    """Segments and pieces of segments after refinement, and which segment each belongs to. Loops over split segments only."""
    index = {(lower, upper): i for i, (lower, upper) in enumerate(np.sort(segments, axis=1).tolist())}
    parent = {_ends(piece): _ends(of[0]) for piece, of in triangulation.piece_to_originals_iter()}
    edges = [_ends(edge) for edge in triangulation.fixed_edges_iter()]
    whole = np.zeros(len(edges), np.int64)
    for i, edge in enumerate(edges):
        while edge not in index:
            edge = parent[edge]
        whole[i] = index[edge]
    pieces = np.array(edges, np.int64).reshape(-1, 2)
    # pythoncdt orders the ends of an edge by number: turn the pieces to run along their segment.
    along = vertices[pieces[:, 1]] - vertices[pieces[:, 0]]
    direction = vertices[segments[whole, 1]] - vertices[segments[whole, 0]]
    turned = (along * direction).sum(axis=1) < 0
    pieces[turned] = pieces[turned, ::-1]
    return pieces, whole


def _ends(edge: pythoncdt.Edge) -> tuple[int, int]:
    return edge.v1 - SUPER, edge.v2 - SUPER
