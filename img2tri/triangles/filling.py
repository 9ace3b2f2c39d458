"""Fill a network of outlines with triangles: the inside of the mesh.

In: points, segments, the regions on both sides of each segment, the wanted edge length. Out: a triangle mesh that has the segments as edges. The steps:

    sizes     how long edges should be at each place                                    grading.py
    front     one apex over each side of each segment                                   front.py
    lattice   hexagonal inside; its depth becomes triangles at once                     lattice.py
    finer     nodes of nested lattices, where shorter edges are wanted                  grading.py
    band      constrained Delaunay triangulation of what lies between                   delaunay.py
    relax     move vertices; repair their number of triangles; move again               relaxing.py, repairing.py
    net       where an angle is still too small: Ruppert's refinement                   delaunay.py

To the band, the depth of the lattice is one more hole. So the work follows the length of the outlines, not the area, and a large mesh costs a fraction of
the time that its triangulation would take.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from img2tri.records import Floats, Ints
from img2tri.triangles.delaunay import refine, triangulate
from img2tri.triangles.front import apexes, keepers, spread
from img2tri.triangles.grading import FINER, LONGEST, Sizes, finer, pairs
from img2tri.triangles.lattice import ROW, Complex, Depth, Labels, Lattice
from img2tri.triangles.network import Network
from img2tri.triangles.relaxing import AGAIN, ANNEAL, SMOOTH, climbed, relaxed, smallest_angles
from img2tri.triangles.repairing import repaired

CLEAR = 0.75  # lattice nodes nearer than this times the wanted length to an outline or apex are dropped
REPAIRS = 2
AFTER_NET = (*SMOOTH, *ANNEAL)
SHORTEST = 0.05  # the net makes no edge shorter than this times the shortest segment


def fill(
    points: Floats,
    segments: Ints,
    left: Ints,
    right: Ints,
    *,
    edge_length: float,
    min_angle: float = 30.0,
    gradation: float = 0.3,
    size: Floats | Callable[[Floats], Floats] | None = None,
    seed: int = 0,
) -> tuple[Floats, Ints, Ints]:
    """Fill the regions of a network of segments with triangles."""
    network, names = _network(points, segments, left, right)
    sizes = _sizes(network, edge_length, gradation, size)
    if not sizes.uniform:
        network = network.divided(sizes)
    lattice = Lattice.over(network.points, edge_length, _shift(seed))
    # The net may have to split an edge of the depth, which is not its to split: then once more with less depth, or none.
    for rings in (2, 8, lattice.rows):
        band = _band(network, sizes, lattice, rings)
        mesh = _net(band, *_settled(band), min_angle)
        if mesh is not None:
            break
    vertices, triangles, codes = _joined(band, *mesh)
    return pairs(vertices), triangles, names[codes]


@dataclass(frozen=True)
class Band:
    """The network of outlines and of the front of the depth; points that are not on it; the depth and the place of its front in the points."""

    network: Network
    given: Network
    loose: Complex
    depth: Depth
    front: Ints


def _network(points, segments, left, right):
    names, codes = np.unique(np.concatenate([[0], left, right]), return_inverse=True)
    codes = codes - codes[0]
    left, right = np.split(codes[1:].astype(np.int32), 2)
    return Network(points[:, 0] + 1j * points[:, 1], segments, left, right), np.roll(names, codes.min())


def _sizes(network: Network, edge_length: float, gradation: float, size) -> Sizes:
    """Short segments are where shorter edges are wanted, and points with a size of their own."""
    sources, lengths = network.middles, network.lengths
    field = None
    if callable(size):
        field = size
    elif size is not None:
        sources, lengths = np.concatenate([sources, network.points]), np.concatenate([lengths, size])
    short = lengths < edge_length * LONGEST / FINER
    return Sizes(edge_length, gradation, sources[short], lengths[short], field)


def _shift(seed: int) -> complex:
    return complex(*np.random.default_rng(seed).uniform(-0.5, 0.5, 2)) if seed else 0j


def _band(network: Network, sizes: Sizes, lattice: Lattice, rings: int) -> Band:
    z = network.points
    tips, tips_wanted = apexes(network, sizes)
    walls, walls_wanted = keepers(network, sizes)
    near, wanted = np.concatenate([walls, tips]), np.concatenate([walls_wanted, tips_wanted])
    stays = spread(near, wanted, len(walls))
    near, wanted = near[stays], wanted[stays]
    labels = lattice.labels(z, network.segments, network.left, network.right)
    busy, fine = _fine(network, sizes, lattice, labels, near)
    labels[lattice.around(near, CLEAR * wanted)] = 0
    core = labels.copy()
    core[busy] = 0
    for _ in range(rings):
        core = lattice.eroded(core)
    depth = lattice.depth(core)
    nodes = np.flatnonzero((labels != 0) & ~depth.nodes)
    front, ends = np.unique(depth.front, return_inverse=True)
    ends = ends.reshape(-1, 2) + len(z)
    fence = Network(
        points=np.concatenate([z, lattice.positions(front)]),
        segments=np.concatenate([network.segments, ends]),
        left=np.concatenate([network.left, np.zeros(len(ends), np.int32)]),
        right=np.concatenate([network.right, labels[front][ends[:, 0] - len(z)]]),
    )
    return Band(
        network=fence,
        given=network,
        loose=np.concatenate([near[len(walls) :], lattice.positions(nodes), fine]),
        depth=depth,
        front=front,
    )


def _fine(network: Network, sizes: Sizes, lattice: Lattice, labels: Labels, near: Complex) -> tuple[Ints, Complex]:
    if sizes.uniform:
        return np.zeros(0, np.int64), np.zeros(0, np.complex128)
    marked = np.zeros(len(labels), bool)
    marked[lattice.around(sizes.sources, np.full(len(sizes.sources), lattice.pitch))] = True
    reach = ((LONGEST + sizes.gradation) / FINER * lattice.pitch - sizes.lengths.min(initial=np.inf)) / sizes.gradation
    marked = lattice.grown(marked, 1 + int(max(0, reach) / (ROW * lattice.pitch)))
    if sizes.field is not None:
        marked |= lattice.grown(labels != 0, 1)
    busy, fine, wanted = finer(lattice, np.flatnonzero(marked), sizes)
    if not len(fine):
        return busy, fine
    distance, _ = cKDTree(pairs(near)).query(pairs(fine))
    start, stop = network.ends
    _, nearest = cKDTree(pairs(network.middles)).query(pairs(fine))
    on_left = ((fine - start[nearest]) / (stop - start)[nearest]).imag > 0
    inside = np.where(on_left, network.left[nearest], network.right[nearest]) != 0
    return busy, fine[inside & (distance > CLEAR * wanted)]


def _settled(band: Band) -> tuple[Complex, Ints, Ints]:
    loose, fixed = band.loose, len(band.network.points)
    schedule = SMOOTH
    for last in [False] * REPAIRS + [True]:
        vertices = np.concatenate([band.network.points, loose])
        free = np.arange(len(vertices)) >= fixed
        triangles, codes = triangulate(pairs(vertices), band.network.segments, band.network.left, band.network.right)
        vertices = relaxed(vertices, triangles, free, schedule)
        if last:
            break
        added, stays = repaired(vertices, triangles, free)
        if stays.all():
            break
        loose = np.concatenate([vertices[fixed:][stays[fixed:]], added])
        schedule = AGAIN
    vertices = relaxed(vertices, triangles, free, ANNEAL)
    return climbed(vertices, triangles, free), triangles, codes


def _net(band: Band, vertices: Complex, triangles: Ints, codes: Ints, min_angle: float) -> tuple[Complex, Ints, Ints] | None:
    if smallest_angles(vertices, triangles).min(initial=60) >= min_angle:
        return vertices, triangles, codes
    network = band.network
    shortest = SHORTEST * network.lengths.min()
    net = refine(pairs(vertices), network.segments, network.left, network.right, min_angle, shortest)
    if np.bincount(net.origin)[len(band.given.segments) :].max(initial=0) > 1:
        return None
    vertices = net.vertices[:, 0] + 1j * net.vertices[:, 1]
    free = np.ones(len(vertices), bool)
    free[net.segments] = free[: len(network.points)] = False
    vertices = relaxed(vertices, net.triangles, free, AFTER_NET)
    return vertices, net.triangles, net.regions


def _joined(band: Band, vertices: Complex, triangles: Ints, codes: Ints) -> tuple[Complex, Ints, Ints]:
    given = len(band.network.points) - len(band.front)
    used = np.zeros(len(vertices), bool)
    used[triangles] = True
    used[: len(band.network.points)] = True
    m = len(triangles)
    all_triangles = np.zeros((m + len(band.depth), 3), np.int64)
    all_codes = np.zeros(len(all_triangles), np.int64)
    all_triangles[:m], all_codes[:m] = (np.cumsum(used) - 1)[triangles], codes
    inner = band.depth.nodes
    inner[band.front] = False
    inner = np.flatnonzero(inner)
    numbers = np.zeros(band.depth.lattice.count, np.int64)
    numbers[band.front] = np.arange(given, len(band.network.points))
    numbers[inner] = np.arange(len(inner)) + np.count_nonzero(used)
    band.depth.write(numbers, all_triangles[m:], all_codes[m:])
    return np.concatenate([vertices[used], band.depth.lattice.positions(inner)]), all_triangles, all_codes
