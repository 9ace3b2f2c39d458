"""The strip between the outlines and the core of the lattice: its points, its triangles, and the mesh that both make together.

The core is a hole to the strip: the edges of its rim are constraints with region 0 on the core's side. So the work follows the length of
the outlines, not the area, and a large mesh costs a fraction of the time that its triangulation would take.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, as_rows
from img2tri.triangles.generate.constrained_delaunay import triangulate
from img2tri.triangles.generate.first_layer import apexes, uncrowded
from img2tri.triangles.generate.graded_lattice import finer, reaches
from img2tri.triangles.generate.hexagonal_lattice import Codes, Core, Lattice
from img2tri.triangles.generate.interior_sizes import SizeFunction, nearest_of
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.quality_smoothing import SAFE, raise_sliding, smooth, smooth_and_raise
from img2tri.triangles.generate.valence_repair import flip_valences, repair_valences
from img2tri.triangles.min_angle_tangents import min_angle_tangents

CLEAR = 0.66  # lattice nodes nearer to an outline or apex than this times the wanted length are dropped
WITHIN = 0.3  # of the shorter part beside it: how far a point slides in which a segment was divided
NUDGE = 1e-7  # of the length wanted there: how far free points are put off
BY_CHANCE = 7.13  # turns: their directions are as good as by chance from one to the next


Settle = Callable[[Floats], Floats]
"""From where points (n, 2) of outlines are wanted to where they may be, near where they are."""


@dataclass(frozen=True, eq=False)
class Strip:
    """Everything that has to be triangulated, and what has not.

    Attributes
    ----------
    constraints
        The outlines, then the edges of the core's rim: what stays where it is.
    n_outline
        How many of these segments are outlines.
    free
        (k,) complex, the points between, which may move.
    core
        The triangles of the core of the lattice.
    rim
        Its nodes on the rim: the last points of the constraints.
    """

    constraints: Pslg
    n_outline: int
    free: Points
    core: Core
    rim: Ints


@dataclass(frozen=True, eq=False)
class RegionMesh:
    """Triangles of one region each: the points of the constraints, then other vertices.

    Attributes
    ----------
    vertices, triangles, codes
        (v,) complex, (m, 3) int64 and (m,) int64, the region of each triangle.
    """

    vertices: Points
    triangles: Ints
    codes: Ints


def lay_strip(pslg: Pslg, at_points: Floats, at_middles: Floats, sizes: SizeFunction, lattice: Lattice, rings: int) -> Strip:
    """Place the points of the strip: apexes, nodes of the lattice, finer nodes. The core begins `rings` nodes further in.

    `at_points` and `at_middles` are the lengths wanted at the points of the outlines and the middles of their segments.
    """
    tips, tip_lengths = apexes(pslg, at_middles)
    near, wanted = np.concatenate([pslg.points, tips]), np.concatenate([at_points, tip_lengths])
    stays = uncrowded(near, wanted, len(pslg.points))
    near, wanted = near[stays], wanted[stays]
    codes = lattice.codes(pslg.points, pslg.segments, pslg.left, pslg.right)
    busy, fine, fine_lengths = _fine(pslg, sizes, lattice, codes)
    if len(fine):
        stays = _clear(near, fine, fine_lengths)
        stays[stays] = _inside(pslg, fine[stays])
        fine, fine_lengths = fine[stays], fine_lengths[stays]
    codes[lattice.near(near, CLEAR * wanted)[0]] = 0
    # The core keeps clear of finer nodes too.
    deep = codes.copy()
    deep[busy] = 0
    for _ in range(rings):
        if not deep.any():
            break
        deep = lattice.eroded(deep)
    core = lattice.core(deep)
    between = ((codes != 0) & ~core.nodes()).nonzero()[0]
    edges = core.rim()
    on_rim = np.zeros(len(codes), bool)
    on_rim[edges] = True
    rim, number = on_rim.nonzero()[0], np.cumsum(on_rim, dtype=np.int64) - 1
    constraints = pslg.joined(lattice.positions(rim), number[edges], right=codes[edges[:, 0]].astype(np.int64))
    free = np.concatenate([near[len(pslg.points) :], lattice.positions(between), fine])
    # Nodes of a lattice lie on common circles, over which exact predicates take long: a nudge, and they do not. Its direction follows
    # from where a point lies, so that windows of one image, which have other points far away, triangulate it alike.
    lengths = np.concatenate([wanted[len(pslg.points) :], np.full(len(between), lattice.pitch), fine_lengths])
    way = (free - lattice.node) / lattice.pitch
    free += NUDGE * lengths * np.exp(2j * np.pi * BY_CHANCE * np.sin(3 * way.real + 5 * way.imag))
    return Strip(constraints, len(pslg.segments), free, core, rim)


def _fine(pslg: Pslg, sizes: SizeFunction, lattice: Lattice, codes: Codes) -> tuple[Ints, Points, Floats]:
    """Find finer nodes where the wanted length is below the pitch: around its sources, or anywhere if it is a field."""
    if sizes.uniform:
        return np.zeros(0, np.int64), np.zeros(0, np.complex128), np.zeros(0)
    # Nodes inside of the outlines or beside them: no others have descendants inside.
    asked = codes != 0
    asked[lattice.near(pslg.points, np.full(len(pslg.points), lattice.pitch))[0]] = True
    asked = lattice.dilated(asked, 2)
    if sizes.field is None:
        nodes, of = lattice.near(sizes.sources, np.full(len(sizes.sources), lattice.pitch))
        rings = (1 + reaches(sizes) / lattice.height).astype(np.int64)[of]
        around = np.zeros(len(codes), bool)
        for ring in range(int(rings.max(initial=0)), 0, -1):
            around[nodes[rings == ring]] = True
            around = lattice.dilated(around, 1)
        asked &= around
    return finer(lattice, asked.nonzero()[0], sizes)


def _inside(pslg: Pslg, points: Points) -> Bools:
    """Whether points lie in a region: on the right side of the nearest segment. A point misjudged is dropped with its triangles."""
    _, nearest = nearest_of(pslg.middles, points)
    start, stop = pslg.ends
    on_left = ((points - start[nearest]) / (stop - start)[nearest]).imag > 0
    inside: Bools = np.where(on_left, pslg.left[nearest], pslg.right[nearest]) != 0
    return inside


def _clear(near: Points, points: Points, wanted: Floats) -> Bools:
    """Whether points keep clear of others."""
    clear: Bools = nearest_of(near, points, CLEAR * wanted.max())[0] > CLEAR * wanted
    return clear


def relax_strip(strip: Strip, limits: Floats | None = None) -> RegionMesh:
    """Triangulate the strip and smooth it; the first points slide along their outlines, within limits, to where triangles want them."""
    mesh = _triangulated(strip, strip.constraints.points, strip.free)
    lines = None if limits is None else strip.constraints.slide_lines(limits)
    return RegionMesh(smooth(mesh.vertices, mesh.triangles, _free(strip, mesh), lines=lines), mesh.triangles, mesh.codes)


def finish_strip(strip: Strip, relaxed: RegionMesh, first: Points) -> RegionMesh:
    """Repair the valences of a smoothed strip, and smooth it until its worst angles are good, with the first points put to these places."""
    vertices, triangles, codes = relaxed.vertices.copy(), relaxed.triangles, relaxed.codes
    fixed = len(strip.constraints.points)
    free = _free(strip, relaxed)
    added, stays = repair_valences(vertices, triangles, free)
    vertices[: len(first)] = first
    # With nothing to repair the triangles may stay, unless the first points spoilt them.
    tangents = min_angle_tangents(vertices, triangles) if stays.all() else None
    if tangents is None or (tangents < np.tan(np.radians(SAFE))).any():
        mesh = _triangulated(strip, vertices[:fixed], np.concatenate([vertices[fixed:][stays[fixed:]], added]))
        vertices, triangles, codes, free, tangents = mesh.vertices, mesh.triangles, mesh.codes, _free(strip, mesh), None
    triangles, flipped = flip_valences(vertices, triangles, free)
    return RegionMesh(smooth_and_raise(vertices, triangles, free, None if flipped else tangents), triangles, codes)


def slide_again(strip: Strip, mesh: RegionMesh, limits: Floats, settle: Settle) -> RegionMesh:
    """Raise the worst angles of a finished strip by letting the first points slide once more, within limits (n,), as the caller settles it.

    Points in which segments were divided slide along these.
    """
    fixed = len(strip.constraints.points)
    placed = replace(strip.constraints, points=mesh.vertices[:fixed])

    def settled(vertices: Points) -> Points:
        places = as_complex(settle(as_rows(vertices[: len(limits)])))
        return np.concatenate([placed.on_segments(len(limits), np.concatenate([places, vertices[len(limits) : fixed]])), vertices[fixed:]])

    lines = placed.slide_lines(limits, within=WITHIN)
    return replace(mesh, vertices=raise_sliding(mesh.vertices, mesh.triangles, _free(strip, mesh), lines, settled))


def _triangulated(strip: Strip, fixed: Points, free: Points) -> RegionMesh:
    """Triangulate the constraints, their points put to these places, and free points."""
    vertices, c = np.concatenate([fixed, free]), strip.constraints
    return RegionMesh(vertices, *triangulate(as_rows(vertices), c.segments, c.left, c.right))


def _free(strip: Strip, mesh: RegionMesh) -> Bools:
    return np.arange(len(mesh.vertices)) >= len(strip.constraints.points)


def with_core(strip: Strip, mesh: RegionMesh) -> RegionMesh:
    """Join the finished strip and the core in one mesh: points of the constraints, other vertices of the strip, the core.

    Every array is written once, as it may be large.
    """
    fixed, m = len(strip.constraints.points), len(mesh.triangles)
    used = np.arange(len(mesh.vertices)) < fixed
    used[mesh.triangles] = True
    inner = strip.core.nodes()  # not yet numbered
    inner[strip.rim] = False
    given = int(np.count_nonzero(used))
    numbers: Ints = np.cumsum(inner, dtype=np.int64)
    numbers += given - 1
    numbers[strip.rim] = np.arange(fixed - len(strip.rim), fixed)
    vertices = np.zeros(given + int(np.count_nonzero(inner)), np.complex128)
    vertices[:given] = mesh.vertices[used]
    strip.core.lattice.positions(inner.nonzero()[0], out=vertices[given:])
    triangles = np.zeros((m + len(strip.core), 3), np.int64)
    codes = np.zeros(len(triangles), np.int64)
    triangles[:m], codes[:m] = (np.cumsum(used) - 1)[mesh.triangles], mesh.codes
    strip.core.write(numbers, triangles[m:], codes[m:])
    return RegionMesh(vertices, triangles, codes)
