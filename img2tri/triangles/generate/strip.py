"""The band between the outlines and the depth of the lattice: its points, its triangles, and the mesh that both make together.

To the band the depth is one more hole: the edges between both are segments with region 0 on the side of the depth. So the work
follows the length of the outlines, not the area, and a large mesh costs a fraction of the time that its triangulation would take.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from img2tri.triangles.generate.constrained_delaunay import triangulate
from img2tri.triangles.generate.first_layer import apexes, keepers, spread
from img2tri.triangles.generate.graded_lattice import Sizes, finer, nearest_of, pairs
from img2tri.triangles.generate.hexagonal_lattice import Complex, Depth, Labels, Lattice
from img2tri.triangles.generate.pslg import Network
from img2tri.triangles.generate.quality_smoothing import SAFE, SMOOTH, climbed, narrow, relaxed
from img2tri.triangles.generate.valence_repair import repaired
from img2tri.types import Bools, Floats, Ints

CLEAR = 0.66  # lattice nodes nearer to an outline or apex than this times the wanted length are dropped
NUDGE, GOLDEN = 1e-7, 0.618  # of the shortest segment: how far loose points are put off, each the other way than the one before


@dataclass(frozen=True, eq=False)
class Slide:
    """How points of a network may slide along its outlines.

    Attributes
    ----------
    room
        (n,) float64, how far each may, parallel to the line between its neighbours; 0 for those that stay.
    settled
        Function of the places (n, 2) they slid to, that returns those (n, 2) where they may stay.
    """

    room: Floats
    settled: Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Band:
    """Everything that has to be triangulated, and what has not.

    Attributes
    ----------
    fence
        The network of outlines, then the edges of the depth: what stays where it is.
    own
        How many of its segments are outlines.
    loose
        The points between, which may move.
    depth
        The triangles of the depth of the lattice.
    front
        Its nodes on the fence: the last points of the fence.
    """

    fence: Network
    own: int
    loose: Complex
    depth: Depth
    front: Ints


def band(network: Network, at_points: Floats, at_middles: Floats, sizes: Sizes, lattice: Lattice, rings: int) -> Band:
    """Place the points of a network: apexes, nodes of the lattice, finer nodes. The depth begins `rings` nodes further in.

    `at_points` and `at_middles` are the lengths wanted at the points of the network and the middles of its segments.
    """
    walls, walls_wanted = keepers(network, at_points, at_middles)
    tips, tips_wanted = apexes(network, at_middles)
    near, wanted = np.concatenate([walls, tips]), np.concatenate([walls_wanted, tips_wanted])
    stays = spread(near, wanted, len(walls))
    near, wanted = near[stays], wanted[stays]
    labels = lattice.labels(network.points, network.segments, network.left, network.right)
    busy, fine, fine_wanted = _fine(network, sizes, lattice, labels)
    if len(fine):
        fine = fine[_clear(near, fine, fine_wanted)]
        fine = fine[_inside(network, fine)]
    labels[lattice.around(near, CLEAR * wanted)] = 0
    # The depth keeps clear of finer nodes too.
    core = labels.copy()
    core[busy] = 0
    for _ in range(rings):
        if not core.any():
            break
        core = lattice.eroded(core)
    depth = lattice.depth(core)
    between = np.flatnonzero((labels != 0) & ~depth.nodes())
    edges = depth.front()
    front, ends = np.unique(edges, return_inverse=True)
    fence = network.joined(lattice.positions(front), ends.reshape(-1, 2), right=labels[edges[:, 0]].astype(np.int64))
    loose = np.concatenate([near[len(walls) :], lattice.positions(between), fine])
    # Nodes of a lattice lie on common circles, over which exact predicates take long: a nudge, and they do not.
    loose += NUDGE * network.lengths.min() * np.exp(2j * np.pi * GOLDEN * np.arange(len(loose)))
    return Band(fence, len(network.segments), loose, depth, front)


def _fine(network: Network, sizes: Sizes, lattice: Lattice, labels: Labels) -> tuple[Ints, Complex, Floats]:
    """Find finer nodes where the wanted length is below the pitch: around its sources, or anywhere if it is a field."""
    if sizes.uniform:
        return np.zeros(0, np.int64), np.zeros(0, np.complex128), np.zeros(0)
    # Nodes inside of the outlines or beside them: no others have descendants inside.
    asked = labels != 0
    asked[lattice.around(network.points, np.full(len(network.points), lattice.pitch))] = True
    asked = lattice.grown(asked, 2)
    if sizes.field is None:
        near = np.zeros(len(labels), bool)
        near[lattice.around(sizes.sources, np.full(len(sizes.sources), lattice.pitch))] = True
        asked &= lattice.grown(near, 1 + int(sizes.reach / lattice.height))
    return finer(lattice, np.flatnonzero(asked), sizes)


def _inside(network: Network, points: Complex) -> Bools:
    """Whether points lie in a region: on the right side of the nearest segment. A point misjudged is dropped with its triangles."""
    _, nearest = nearest_of(network.middles, points)
    start, stop = network.ends
    on_left = ((points - start[nearest]) / (stop - start)[nearest]).imag > 0
    inside: Bools = np.where(on_left, network.left[nearest], network.right[nearest]) != 0
    return inside


def _clear(near: Complex, points: Complex, wanted: Floats) -> Bools:
    """Whether points keep clear of others."""
    clear: Bools = nearest_of(near, points, CLEAR * wanted.max())[0] > CLEAR * wanted
    return clear


def settled(band: Band, slide: Slide | None = None) -> tuple[Complex, Ints, Ints]:
    """Triangulate the band and move its loose points until triangles are good; return vertices, triangles, regions."""
    fence, size = band.fence, len(band.fence.points)
    vertices, free, triangles, codes = _joined(fence, fence.points, band.loose)
    vertices = relaxed(vertices, triangles, free, SMOOTH, None if slide is None else fence.rails(slide.room))
    added, stays = repaired(vertices, triangles, free)
    if slide is not None:
        places = slide.settled(pairs(vertices[: len(slide.room)]))
        vertices[: len(places)] = places[:, 0] + 1j * places[:, 1]
    # With nothing to repair the triangles may stay, unless settling spoilt them.
    if not stays.all() or narrow(vertices, triangles, SAFE).any():
        loose = np.concatenate([vertices[size:][stays[size:]], added])
        vertices, free, triangles, codes = _joined(fence, vertices[:size], loose)
    # Only the worst angle is worth a climb: what else it spoils is smoothed once more, and that angle stays.
    vertices = climbed(relaxed(vertices, triangles, free, SMOOTH), triangles, free)
    return relaxed(vertices, triangles, free, SMOOTH), triangles, codes


def _joined(fence: Network, walls: Complex, loose: Complex) -> tuple[Complex, Bools, Ints, Ints]:
    """Triangulate points on a fence, and loose ones; return all points, which are free, triangles, regions."""
    vertices = np.concatenate([walls, loose])
    triangles, codes = triangulate(pairs(vertices), fence.segments, fence.left, fence.right)
    return vertices, np.arange(len(vertices)) >= len(walls), triangles, codes


def completed(band: Band, vertices: Complex, triangles: Ints, codes: Ints) -> tuple[Complex, Ints, Ints]:
    """Join the finished band and the depth in one mesh: fence, loose vertices, depth. Every array is written once, as it may be large."""
    fixed, m = len(band.fence.points), len(triangles)
    used = np.arange(len(vertices)) < fixed
    used[triangles] = True
    inner = band.depth.nodes()  # not yet numbered
    inner[band.front] = False
    numbers: Ints = np.cumsum(inner, dtype=np.int64)
    numbers += int(np.count_nonzero(used)) - 1
    numbers[band.front] = np.arange(fixed - len(band.front), fixed)
    given = int(np.count_nonzero(used))
    all_vertices = np.zeros(given + int(np.count_nonzero(inner)), np.complex128)
    all_vertices[:given] = vertices[used]
    band.depth.lattice.positions(np.flatnonzero(inner), out=all_vertices[given:])
    all_triangles = np.zeros((m + len(band.depth), 3), np.int64)
    all_codes = np.zeros(len(all_triangles), np.int64)
    all_triangles[:m], all_codes[:m] = (np.cumsum(used) - 1)[triangles], codes
    band.depth.write(numbers, all_triangles[m:], all_codes[m:])
    return all_vertices, all_triangles, all_codes
