"""The net under the mesh: where an angle is too small, the triangles around it are refined by Ruppert's method.

In: a mesh and the network it was made of. Out: the mesh with its bad places replaced. Only a *patch*, some rings of triangles around
the bad ones, is triangulated anew, with its rim and the segments in it as constraints. Refinement may split a segment that has
nothing but the patch on its sides. If it splits another edge of the rim, the neighbours outside do not fit: then the patch is made
larger there.
"""

from __future__ import annotations

import numpy as np

from img2tri.triangles.generate.constrained_delaunay import refine
from img2tri.triangles.generate.graded_lattice import pairs
from img2tri.triangles.generate.hexagonal_lattice import Complex
from img2tri.triangles.generate.pslg import Network
from img2tri.triangles.generate.quality_smoothing import SMOOTH, narrow, relaxed, touched
from img2tri.types import Bools, Ints

RINGS = (3, 3, 6, 12, 24, 1_000_000)  # how far patches reach around bad triangles, then around edges of the rim that were split
SHORTEST = 0.05  # no edge becomes shorter than about this times the shortest segment in the patch


def mended(
    vertices: Complex, triangles: Ints, codes: Ints, network: Network, own: int, min_angle: float
) -> tuple[Complex, Ints, Ints] | None:
    """Refine the mesh of a network where angles are smaller than `min_angle`; its vertices stay, others are added after them.

    Only the first `own` segments of the network may be split. None if that is not enough.
    """
    bad = narrow(vertices, triangles, min_angle)
    if not bad.any():
        return vertices, triangles, codes
    patch, cause = np.zeros(len(triangles), bool), bad
    for rings in RINGS:
        patch = patch | _grown(cause, triangles, rings)
        inside, local = np.unique(triangles[patch], return_inverse=True)
        walls, splittable = _walls(vertices[inside], inside, local.reshape(-1, 3), codes[patch], network, own)
        net = refine(pairs(walls.points), walls.segments, walls.left, walls.right, min_angle, SHORTEST * walls.lengths.min())
        torn = (np.bincount(net.origin) > 1) & ~splittable
        if not torn.any():
            break
        if patch.all():
            return None
        ends = np.zeros(len(vertices), bool)
        ends[inside[walls.segments[torn]]] = True
        cause = touched(triangles, ends)
    places = net.vertices[:, 0] + 1j * net.vertices[:, 1]
    free = np.ones(len(places), bool)
    free[net.segments] = False
    places = relaxed(places, net.triangles, free, SMOOTH)
    numbers = np.concatenate([inside, len(vertices) + np.arange(len(places) - len(inside))])
    all_places = np.concatenate([vertices, places[len(inside) :]])
    all_places[inside] = places[: len(inside)]
    return (
        all_places,
        np.concatenate([triangles[~patch], numbers[net.triangles]]),
        np.concatenate([codes[~patch], net.regions]),
    )


def _grown(chosen: Bools, triangles: Ints, rings: int) -> Bools:
    """Add the triangles that share a vertex with those chosen, and so on."""
    for _ in range(rings):
        zone = np.zeros(triangles.max() + 1, bool)
        zone[triangles[chosen]] = True
        grown = touched(triangles, zone)
        if np.array_equal(grown, chosen):
            break
        chosen = grown
    return chosen


def _walls(points: Complex, inside: Ints, triangles: Ints, codes: Ints, network: Network, own: int) -> tuple[Network, Bools]:
    """Find the rim of a patch and the segments in it, in numbers of the patch, and whether each may be split."""
    n = len(inside)
    start, stop = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    # An edge is known by its ends, lower first. The triangle that has it in this direction lies on its left.
    keys, edge = np.unique(np.minimum(start, stop) * n + np.maximum(start, stop), return_inverse=True)
    upward, code = start < stop, np.repeat(codes, 3)
    left, right = np.zeros(len(keys), np.int64), np.zeros(len(keys), np.int64)
    left[edge[upward]], right[edge[~upward]] = code[upward], code[~upward]
    found = np.bincount(edge)
    # Segments of the network with both ends in the patch, and the edges they are.
    place = np.full(len(network.points), -1)
    known = np.flatnonzero(inside < len(network.points))
    place[inside[known]] = known
    ends = np.sort(place[network.segments], axis=1)
    wanted = ends[:, 0] * n + ends[:, 1]
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    segment = np.flatnonzero((ends[:, 0] >= 0) & (keys[at] == wanted))
    at = at[segment]
    # A segment may be split if all its triangles are in the patch.
    sides = (network.left[segment] != 0).astype(np.int64) + (network.right[segment] != 0)
    wall: Bools = found == 1
    splittable = np.zeros(len(keys), bool)
    wall[at] = True
    splittable[at] = (found[at] == sides) & (segment < own)
    lower, upper = np.divmod(keys[wall], n)
    origin = np.full(len(lower), -1)
    return Network(points, np.stack([lower, upper], axis=1), left[wall], right[wall], origin), splittable[wall]
