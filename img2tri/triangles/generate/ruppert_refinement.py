"""Local Ruppert refinement, the safety net: where an angle is still too small, the triangles around it are refined.

In: a mesh and the constraints it was made of. Out: the mesh with its bad places replaced. Only a *patch*, some rings of triangles around
the bad ones, is triangulated anew, with its rim and the segments in it as constraints. Refinement may split a segment that has
nothing but the patch on its sides. If it splits another edge of the rim, the neighbours outside do not fit: then the patch is made
larger there.
"""

from __future__ import annotations

import math

import numpy as np

from img2tri.arrays import Bools, Ints, Points, as_complex, as_rows, unique_edges
from img2tri.triangles.generate.constrained_delaunay import ruppert
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.quality_smoothing import patch_around, smooth, touching
from img2tri.triangles.min_angle_tangents import min_angle_tangents, narrower

# How far patches reach around bad triangles, then around split edges of the rim; None: to the end.
PATCH_RINGS = (3, 3, 6, 6, 6, 12, 12, 24, 24, None)
RESERVE = 2.0  # degrees over the least angle, which refinement reaches nearly always where it is asked of few triangles
FEW, SOME_POINTS, POINTS_EACH = 24, 100, 12  # so many of them at most; and the points that may be added for all, and for each
SHORTEST_EDGE = 0.05  # of the shortest segment in the patch: no edge becomes shorter. A stop only: sharp corners would be refined for ever


def refine_with_reserve(
    vertices: Points, triangles: Ints, codes: Ints, constraints: Pslg, n_outline: int, min_angle: float
) -> tuple[Points, Ints, Ints] | None:
    """Refine a mesh as `refine_locally` does, to angles larger than `min_angle` by `RESERVE`, or half of it, if few points do that.

    A degree or two more may take very many points, or may not be reached with any number. So it is tried with a few for each triangle
    that lacks it.
    """
    tangents = min_angle_tangents(vertices, triangles)
    for wanted in (min_angle + RESERVE, min_angle + RESERVE / 2):
        lacking = int(np.count_nonzero(tangents < math.tan(math.radians(wanted))))
        if not lacking:
            return vertices, triangles, codes
        if lacking <= FEW:
            better = refine_locally(vertices, triangles, codes, constraints, n_outline, wanted, SOME_POINTS + POINTS_EACH * lacking)
            if better is not None and not narrower(better[0], better[1], wanted - 1e-9).any():
                return better
    return refine_locally(vertices, triangles, codes, constraints, n_outline, min_angle)


def refine_locally(
    vertices: Points, triangles: Ints, codes: Ints, constraints: Pslg, n_outline: int, min_angle: float, most: int | None = None
) -> tuple[Points, Ints, Ints] | None:
    """Refine a mesh where angles are smaller than `min_angle`; its vertices stay, others, `most` of them, are added after them.

    Only the first `n_outline` segments of the constraints may be split. None if that is not enough.
    """
    bad = narrower(vertices, triangles, min_angle)
    if not bad.any():
        return vertices, triangles, codes
    patch, cause = np.zeros(len(triangles), bool), bad
    for rings in PATCH_RINGS:
        grown = patch | (_component(cause, triangles) if rings is None else patch_around(cause, triangles, len(vertices), rings)[0])
        if np.array_equal(grown, patch):
            return None
        patch = grown
        inside, local = np.unique(triangles[patch], return_inverse=True)
        rim, may_split = _patch_constraints(vertices[inside], inside, local.reshape(-1, 3), codes[patch], constraints, n_outline)
        made = ruppert(as_rows(rim.points), rim.segments, rim.left, rim.right, min_angle, SHORTEST_EDGE * rim.lengths.min(), most)
        split = (np.bincount(made.origin) > 1) & ~may_split
        if not split.any():
            break
        ends = np.zeros(len(vertices), bool)
        ends[inside[rim.segments[split]]] = True
        cause = touching(triangles, ends)
    else:
        return None  # the patch is all that hangs together with it, and still a segment was split that must stay whole
    places = as_complex(made.vertices)
    free = np.ones(len(places), bool)
    free[made.segments] = False
    places = smooth(places, made.triangles, free)
    numbers = np.concatenate([inside, len(vertices) + np.arange(len(places) - len(inside))])
    all_places = np.concatenate([vertices, places[len(inside) :]])
    all_places[inside] = places[: len(inside)]
    return (
        all_places,
        np.concatenate([triangles[~patch], numbers[made.triangles]]),
        np.concatenate([codes[~patch], made.regions]),
    )


def _component(chosen: Bools, triangles: Ints) -> Bools:
    """Add to some triangles (m,) all that hang together with them through vertices."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    m, size = len(triangles), len(triangles) + int(triangles.max()) + 1
    # Triangles and vertices are the nodes of a graph, with a link from each triangle to each of its corners.
    ends = np.minimum(np.arange(size + 1), m) * 3
    graph = csr_array((np.ones(3 * m, np.int8), triangles.ravel() + m, ends), shape=(size, size))
    number = connected_components(graph, directed=False)[1][:m]
    hit = np.zeros(size, bool)
    hit[number[chosen]] = True
    return np.asarray(hit[number])


def _patch_constraints(points: Points, inside: Ints, triangles: Ints, codes: Ints, constraints: Pslg, n_outline: int) -> tuple[Pslg, Bools]:
    """Find the rim of a patch and the segments in it, in numbers of the patch, and whether each may be split."""
    n = len(inside)
    edges, sides = unique_edges(triangles)
    edge, code = sides.ravel(), np.repeat(codes, 3)
    # The triangle that has an edge in its direction, from the lower to the higher number, lies on its left.
    upward = (triangles < np.roll(triangles, -1, axis=1)).ravel()
    left, right = np.zeros(len(edges), np.int64), np.zeros(len(edges), np.int64)
    left[edge[upward]], right[edge[~upward]] = code[upward], code[~upward]
    found = np.bincount(edge)
    # Segments with both ends in the patch, and the edges they are.
    place = np.full(len(constraints.points), -1)
    known = (inside < len(constraints.points)).nonzero()[0]
    place[inside[known]] = known
    ends = np.sort(place[constraints.segments], axis=1)
    keys, wanted = edges @ (n, 1), ends @ (n, 1)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    segment = ((ends[:, 0] >= 0) & (keys[at] == wanted)).nonzero()[0]
    at = at[segment]
    # A segment may be split if all its triangles are in the patch.
    meshed = (constraints.left[segment] != 0).astype(np.int64) + (constraints.right[segment] != 0)
    kept: Bools = found == 1
    may_split = np.zeros(len(keys), bool)
    kept[at] = True
    may_split[at] = (found[at] == meshed) & (segment < n_outline)
    return Pslg(points, edges[kept], left[kept], right[kept], np.full(int(kept.sum()), -1)), may_split[kept]
