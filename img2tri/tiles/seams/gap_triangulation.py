"""The gap between finished pieces and a new mesh: triangulated, smoothed, refined where it has to be.

Its rim stays as it is on both sides, so that no vertex can hang and no triangle overlap: constraints in a constrained Delaunay
triangulation. The regions of its faces are found from the rim and the outlines, which must agree.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows
from img2tri.tiles.seams.piece_seams import SeamError, Sides
from img2tri.triangles.generate.constrained_delaunay import SUPER, PslgError, insert
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.quality_smoothing import smooth, smooth_and_raise
from img2tri.triangles.generate.ruppert_refinement import refine_locally
from img2tri.triangles.generate.valence_repair import flip_valences, repair_valences
from img2tri.triangles.min_angle_tangents import narrower

REPAIRS = 2  # rounds of smoothing, valence repair and triangulation
PATCHES = (2, 4, 7, 11)  # rings of triangles around bad ones that are triangulated anew
RINGS = 4  # of triangles around the gap that are smoothed with it


@dataclass(frozen=True, eq=False)
class GapWalls:
    """Constraints of a gap.

    Attributes
    ----------
    segments
        (s, 2) int64.
    left, right
        (s,) int64, codes of the regions on their sides; 0 for what is not part of the gap.
    """

    segments: Ints
    left: Ints
    right: Ints

    @classmethod
    def together(cls, several: Sequence[GapWalls]) -> GapWalls:
        """Join several."""
        return cls(*(np.concatenate([getattr(one, name) for one in several]) for name in ("segments", "left", "right")))

    def chosen(self, which: Bools) -> GapWalls:
        """Return some of them."""
        return GapWalls(self.segments[which], self.left[which], self.right[which])


@dataclass(frozen=True, eq=False)
class Gap:
    """A gap to be filled.

    Attributes
    ----------
    z
        All vertices.
    walls
        Its constraints.
    loose
        (k,) int64, points in it that may move or go.
    inside
        Function of places that tells which count: the gap is open at its ends.
    met
        Function of places that tells which are so near that triangles between them may be taken.
    """

    z: Points
    walls: GapWalls
    loose: Ints
    inside: Callable[[Points], Bools]
    met: Callable[[Points], Bools]


def gap_filled(gap: Gap) -> tuple[Points, Ints, Ints]:
    """Fill a gap.

    Returns
    -------
    z, triangles, codes
        All vertices, with those added at the end; the triangles of the gap, and the codes of their regions.

    Raises
    ------
    SeamError
        If constraints cross or contradict each other.
    """
    z, loose = gap.z, gap.loose
    triangles, codes = _triangulated(z, loose, gap)
    for _ in range(REPAIRS):
        inside, local = np.unique(triangles, return_inverse=True)
        local, places = local.reshape(-1, 3), z[inside]
        free = np.isin(inside, loose)
        places = smooth(places, local, free)
        added, stays = repair_valences(places, local, free)
        z = z.copy()
        z[inside] = places
        loose = np.concatenate([inside[free & stays], len(z) + np.arange(len(added))])
        z = np.concatenate([z, added])
        triangles, codes = _triangulated(z, loose, gap)
    return z, triangles, codes


def _triangulated(z: Points, loose: Ints, gap: Gap) -> tuple[Ints, Ints]:
    """Triangles of the gap, and the codes of their regions."""
    used = np.unique(np.concatenate([loose, gap.walls.segments.ravel()]))
    segments = np.searchsorted(used, gap.walls.segments)
    places = z[used]
    try:
        table = insert(as_rows(places), segments).triangles_array(copy=False)
    except PslgError as error:
        named = [int(number) for number in re.findall(r"\d+", str(error).split("detected")[-1])[:4]]
        at = places[[number for number in named if number < len(places)]]
        raise SeamError("constraints cross", at) from error
    triangles = table["vertices"].astype(np.int64) - SUPER
    triangles = triangles[(triangles >= 0).all(axis=1)]
    triangles = triangles[gap.inside(places[triangles].mean(axis=1))]
    codes = _codes(places, triangles, segments, gap.walls, np.any(gap.met(places)[segments], axis=1))
    return used[triangles[codes > 0]], codes[codes > 0]


def _codes(places: Points, triangles: Ints, segments: Ints, walls: GapWalls, met: Bools) -> Ints:
    """Regions of triangles, flooded from the walls around them; from walls that are met (s,) alone, where there are some."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    if not len(triangles):
        return np.zeros(0, np.int64)
    n = len(places)
    sides = Sides.of(triangles, n)
    keys, wanted = sides.low * n + sides.high, segments.min(axis=1) * n + segments.max(axis=1)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    there = keys[at] == wanted  # others are outside of what counts
    is_wall = np.zeros(len(keys), bool)
    is_wall[at[there]] = True
    through = np.flatnonzero(~is_wall & (sides.left >= 0) & (sides.right >= 0))
    graph = csr_array((np.ones(len(through), np.int8), (sides.left[through], sides.right[through])), shape=(len(triangles),) * 2)
    face = connected_components(graph, directed=False)[1]
    upward = segments[:, 0] < segments[:, 1]
    left, right = np.where(upward, sides.left[at], sides.right[at]), np.where(upward, sides.right[at], sides.left[at])
    voters, votes = np.concatenate([left[there], right[there]]), np.concatenate([walls.left[there], walls.right[there]])
    near, inside = np.tile(met[there], 2), voters >= 0
    # Walls are missing at the open ends, where faces flow together: there, walls may contradict those that are met.
    told = np.isin(face[voters], face[voters[near & inside]])
    votes, voters = votes[inside & (near | ~told)], voters[inside & (near | ~told)]
    size = int(votes.max(initial=0)) + 1
    ballots, count = np.unique(face[voters] * size + votes, return_counts=True)
    order = np.argsort(count, kind="stable")
    code = np.zeros(face.max() + 1, np.int64)
    code[ballots[order] // size] = ballots[order] % size  # the most votes are written last
    wrong = code[face[voters]] != votes
    if wrong.any():
        raise SeamError("regions around the gap contradict each other", places[triangles[voters[wrong], 0]])
    return np.asarray(code[face])


def improved(
    z: Points, triangles: Ints, codes: Ints, is_gap: Bools, fixed: Bools, closed: Ints, min_angle: float
) -> tuple[Points, Ints, Ints]:
    """Flip edges in a gap and what is around it, smooth it, and refine where angles stay too small.

    Parameters
    ----------
    z, triangles, codes, is_gap
        The mesh of the gap and of what is beside it, and which of its triangles (m,) are the gap's.
    fixed
        (n,) bool, vertices of finished pieces.
    closed
        (k, 2) int64, edges of finished pieces.
    min_angle
        Degrees.

    Raises
    ------
    SeamError
        If an angle stays too small.
    """
    n = len(z)
    zone = _rings_around(triangles, n, is_gap, RINGS)
    inside, local = np.unique(triangles[zone], return_inverse=True)
    local, places, code = local.reshape(-1, 3), z[inside], codes[zone]
    sides = Sides.of(local, len(inside))
    left, right = sides.codes(code)
    still = left != right  # outlines, the border of the zone and of the mesh
    free = ~np.append(fixed, np.zeros(n - len(fixed), bool))[inside]
    free[sides.low[still]] = free[sides.high[still]] = False
    local, _ = flip_valences(places, local, free)
    places = smooth_and_raise(places, local, free)
    z, triangles = z.copy(), triangles.copy()
    z[inside], triangles[zone] = places, inside[local]
    return refined(z, triangles, codes, zone, closed, min_angle)


def refined(z: Points, triangles: Ints, codes: Ints, zone: Bools, closed: Ints, min_angle: float) -> tuple[Points, Ints, Ints]:
    """Refine around the narrow triangles of a zone, place by place, each in as small a patch as does; its rim is not split.

    Raises
    ------
    SeamError
        If an angle stays too small.
    """
    for rings in PATCHES:
        bad = zone & narrower(z, triangles, min_angle)
        if not bad.any():
            return z, triangles, codes
        network = _network(z, triangles, codes, closed)
        for patch in _patches(triangles, len(z), bad, rings):
            made = _remade(z, triangles[patch], codes[patch], network, min_angle)
            if made is not None:
                z, more, more_codes = made
                triangles = np.concatenate([triangles, more])  # those done go when all patches are
                codes, zone = np.concatenate([codes, more_codes]), np.append(zone, np.ones(len(more), bool))
                triangles[patch] = -1
        left = triangles[:, 0] >= 0
        triangles, codes, zone = triangles[left], codes[left], zone[left]
    bad = zone & narrower(z, triangles, min_angle)
    if bad.any():
        raise SeamError(f"angles below {min_angle:g} degrees are left", z[triangles[bad]].mean(axis=1))
    return z, triangles, codes


def _network(z: Points, triangles: Ints, codes: Ints, closed: Ints) -> Pslg:
    """Return the outlines of a mesh; not those that are edges of finished pieces, which nothing may split."""
    n = len(z)
    sides = Sides.of(triangles, n)
    left, right = sides.codes(codes)
    free = (left != right) & ~np.isin(sides.low * n + sides.high, closed.min(axis=1) * n + closed.max(axis=1))
    segments = np.stack([sides.low, sides.high], axis=1)[free]
    return Pslg(z, segments, left[free], right[free], np.arange(len(segments)))


def _patches(triangles: Ints, n: int, bad: Bools, rings: int) -> list[Ints]:
    """Triangles within so many rings of bad ones, as separate patches."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    near = np.flatnonzero(_rings_around(triangles, n, bad, rings))
    inside, local = np.unique(triangles[near], return_inverse=True)
    local = local.reshape(-1, 3)
    pairs = np.concatenate([local[:, :2], local[:, 1:]])
    graph = csr_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(inside),) * 2)
    part = connected_components(graph, directed=False)[1][local[:, 0]]
    order = np.argsort(part, kind="stable")
    return np.split(near[order], np.flatnonzero(np.diff(part[order])) + 1)


def _remade(z: Points, triangles: Ints, codes: Ints, network: Pslg, min_angle: float) -> tuple[Points, Ints, Ints] | None:
    """Triangulate a patch anew; None if that does not give good triangles, or splits an edge that others have too."""
    border, _ = Sides.of(triangles, len(z)).bare()
    try:
        made = refine_locally(z, triangles, codes, network, len(network.segments), min_angle)
    except PslgError:
        return None
    if made is None or narrower(made[0], made[1], min_angle).any():
        return None
    # What is split of the border has to be an outline with nothing beyond.
    n = len(made[0])
    split = ~np.isin(border[:, 0] * n + border[:, 1], made[1] * n + made[1][:, [1, 2, 0]])
    free = (network.left == 0) | (network.right == 0)
    known = np.sort(network.segments[free], axis=1)
    if not np.isin(border[split].min(axis=1) * n + border[split].max(axis=1), known[:, 0] * n + known[:, 1]).all():
        return None
    return made


def _rings_around(triangles: Ints, n: int, chosen: Bools, rings: int) -> Bools:
    """Add the triangles that share a vertex with those chosen, and so on."""
    for _ in range(rings):
        near = np.zeros(n, bool)
        near[triangles[chosen]] = True
        chosen = np.asarray(near[triangles].any(axis=1))
    return chosen


def longest_sides(z: Points, triangles: Ints) -> Floats:
    """Return the longest edge of a mesh at each of its vertices; 0 elsewhere."""
    result = np.zeros(len(z))
    for k in range(3):
        a, b = triangles[:, k], triangles[:, (k + 1) % 3]
        length = np.abs(z[b] - z[a])
        np.maximum.at(result, a, length)
        np.maximum.at(result, b, length)
    return result
