"""Fill the regions between outlines with triangles: the inside of the mesh, in two halves.

In: points, segments, the regions on both sides of each segment, the wanted edge length. Out: a triangle mesh that has the segments as
its edges. The way:

    begin     sizes     how long edges should be at each place                                    interior_sizes.py
              divide    segments too long for that                                                pslg.py
              apexes    a first layer of points in front of the segments                          first_layer.py
              lattice   hexagonal inside; its core becomes triangles at once                      hexagonal_lattice.py
              finer     nodes of nested lattices, where shorter edges are wanted                  graded_lattice.py
              strip     constrained Delaunay triangulation of what lies between                   strip.py, constrained_delaunay.py
              smooth    move vertices; those on outlines may slide along these                    quality_smoothing.py
    finish    repair    too many or too few triangles at a vertex; smooth again                   valence_repair.py
              slide     once more, where angles are poor                                          quality_smoothing.py
              refine    where an angle is still too small: Ruppert's refinement, in a patch       ruppert_refinement.py

Between the halves the caller, who knows the outlines, says where their points may be; `fill` does both and lets them stay.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex, as_rows
from img2tri.errors import ParameterError, finite, integer
from img2tri.triangles.generate.constrained_delaunay import PslgError, check_pslg
from img2tri.triangles.generate.graded_lattice import lengths_near
from img2tri.triangles.generate.hexagonal_lattice import Lattice
from img2tri.triangles.generate.interior_sizes import SizeFunction
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.ruppert_refinement import refine_with_reserve
from img2tri.triangles.generate.strip import RegionMesh, Settle, Strip, finish_strip, lay_strip, relax_strip, slide_again, with_core

LengthField = Callable[[Floats], Floats]
MARGINS = (2, 8)  # rings of nodes between the strip's other points and the core, tried in turn; then there is no core


@dataclass(frozen=True, eq=False)
class Filling:
    """A mesh half-way: smoothed once, with a core that has no triangles yet.

    Attributes
    ----------
    pslg, sizes, at_points, at_middles
        The outlines, divided; the size function, and the lengths wanted at their points and the middles of their segments.
    lattice, strip, mesh
        The lattice; the strip with a core as large as may be, and its mesh.
    names
        The regions by their codes, those of negative codes counted from the end.
    n_given
        How many points the caller gave.
    """

    pslg: Pslg
    sizes: SizeFunction
    at_points: Floats
    at_middles: Floats
    lattice: Lattice
    strip: Strip
    mesh: RegionMesh
    names: Ints
    n_given: int

    @property
    def wanted(self) -> Floats:
        """(n, 2) where the triangles would like the points given by the caller to be, in their order."""
        return as_rows(self.mesh.vertices[: self.n_given])


def fill(
    points: Floats,
    segments: Ints,
    left: Ints,
    right: Ints,
    *,
    edge_length: float,
    min_angle: float = 30.0,
    gradation: float = 0.17,
    size: Floats | LengthField | None = None,
    seed: int = 0,
) -> tuple[Floats, Ints, Ints]:
    """Fill the regions between segments with triangles; the points stay where they are.

    Edges are about `edge_length` long, and shorter near shorter segments. Far from outlines triangles are equilateral; near them their
    worst angle is 40 degrees and more where segments are of even length.

    Parameters
    ----------
    points : (n, 2) float64
        All different.
    segments : (s, 2) int64
        Index pairs into `points`; segments meet in their end points only.
    left, right : (s,) int64
        The region on either side of each segment, seen from its first point to its second; 0 is not meshed.
    edge_length : float
        Wanted length of edges. Segments should be about as long, or shorter in thin places.
    min_angle : float
        Degrees, see `finish`.
    gradation, size, seed
        See `begin`.

    Returns
    -------
    vertices, triangles, regions
        As from `finish`.

    Raises
    ------
    PslgError
        If segments cross or touch, or their regions contradict each other; its `segments` names them as far as they are known.
    ParameterError
        If an option has a value it cannot have.

    Examples
    --------
    >>> turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    >>> circle = 10 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    >>> segments = np.stack([np.arange(60), (np.arange(60) + 1) % 60], axis=1)
    >>> vertices, triangles, regions = fill(circle, segments, np.full(60, 1), np.full(60, 0), edge_length=1.0)
    >>> bool((vertices[:60] == circle).all()), np.unique(regions)
    (True, array([1]))
    """
    check_pslg(points, segments, left, right)
    if not (np.any(left) or np.any(right)):
        return points.copy(), np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    begun = begin(points, segments, left, right, edge_length=edge_length, gradation=gradation, size=size, seed=seed)
    return finish(begun, min_angle=min_angle)[:3]


def begin(
    points: Floats,
    segments: Ints,
    left: Ints,
    right: Ints,
    *,
    edge_length: float,
    gradation: float = 0.17,
    size: Floats | LengthField | None = None,
    limits: Floats | None = None,
    seed: int = 0,
    node: complex | None = None,
) -> Filling:
    """Make a first mesh, and let the points slide to where its triangles want them.

    Parameters
    ----------
    points, segments, left, right, edge_length
        As for `fill`.
    gradation : float
        By how much the wanted length grows per unit of distance from short segments. Smaller values give better
        triangles, and more.
    size : (n,) float64 or callable, optional
        Edge length wanted at each point; or a function of places (k, 2) that returns lengths (k,), which should itself grow by no more
        than `gradation`. Only what is below `edge_length` counts.
    limits : (n,) float64, optional
        How far each point may slide, parallel to the line between its neighbours; 0 for those that stay. None: all stay.
    seed : int
        0 centres the lattice on the points; another number shifts it by chance, for another mesh as good.
    node : complex, optional
        A place that is a node of the lattice, rather than its being centred.

    Returns
    -------
    Filling
        Its `wanted` are the places that the points slid to.

    Raises
    ------
    PslgError, ParameterError
        As from `fill`.
    """
    edge_length, gradation = finite("edge_length", edge_length, above=0), finite("gradation", gradation, above=0)
    seed = integer("seed", seed)
    check_pslg(points, segments, left, right)
    given, names = _coded(points, segments, left, right)
    sizes = _sizes(given, edge_length, gradation, size)
    pslg, at_points, at_middles = given.divided(sizes)
    lattice = Lattice.over(pslg.points, edge_length, _shift(seed), node)
    strip = lay_strip(pslg, at_points, at_middles, sizes, lattice, MARGINS[0])
    try:
        mesh = relax_strip(strip, limits)
    except PslgError as error:
        raise _named(error, pslg) from error
    return Filling(pslg, sizes, at_points, at_middles, lattice, strip, mesh, names, len(points))


def finish(
    begun: Filling, points: Floats | None = None, *, min_angle: float = 30.0, limits: Floats | None = None, settle: Settle | None = None
) -> tuple[Floats, Ints, Ints, int]:
    """Finish a mesh, with the points given for it put to some places (n, 2) near where it wants them; None: exactly there.

    Parameters
    ----------
    begun
        From `begin`.
    points
        At places that differ little from those of before; the segments between them must not cross.
    min_angle : float
        Degrees. Where the mesh misses it, points are added. It is reached unless segments meet in sharp corners.
    limits, settle : optional
        How far each point (n,) may slide from there for the sake of the worst angles, and what tells where points wanted at places (n, 2)
        may be; None: they stay there.

    Returns
    -------
    vertices : (v, 2) float64
        The points, in their order; then all others.
    triangles : (m, 3) int64
        Counter-clockwise. Every segment is an edge, or a chain of edges where it was long for the length wanted there.
    regions : (m,) int64
        The region of each triangle.
    irregular : int
        How many triangles, the first ones, may have other angles than 60 degrees.

    Raises
    ------
    PslgError, ParameterError
        As from `fill`.
    """
    min_angle = finite("min_angle", min_angle, least=0, most=40)
    first = begun.mesh.vertices[: begun.n_given] if points is None else as_complex(points)
    strip, relaxed = begun.strip, begun.mesh
    try:
        # Refinement may have to split an edge of the core, which cannot be: then again with less of a core, or none.
        for margin in (*MARGINS[1:], begun.lattice.rows, None):
            mesh = finish_strip(strip, relaxed, first)
            if limits is not None and settle is not None:
                mesh = slide_again(strip, mesh, limits, settle)
            refined = refine_with_reserve(mesh.vertices, mesh.triangles, mesh.codes, strip.constraints, strip.n_outline, min_angle)
            if refined is not None or margin is None:
                break
            outlines = replace(begun.pslg, points=np.concatenate([first, begun.pslg.points[len(first) :]]))
            strip = lay_strip(outlines, begun.at_points, begun.at_middles, begun.sizes, begun.lattice, margin)
            relaxed = relax_strip(strip)
    except PslgError as error:
        raise _named(error, begun.pslg) from error
    assert refined is not None, "without a core every edge may be split"
    mesh = with_core(strip, RegionMesh(*refined))
    return as_rows(mesh.vertices), mesh.triangles, begun.names[mesh.codes], len(refined[1])


def _named(error: PslgError, pslg: Pslg) -> PslgError:
    """Name the caller's segments in an error about those of a strip."""
    own = error.segments[error.segments < len(pslg.segments)]
    return PslgError(str(error), np.unique(pslg.origin[own]))


def _coded(points: Floats, segments: Ints, left: Ints, right: Ints) -> tuple[Pslg, Ints]:
    """Give the regions codes near 0, and 0 for region 0; return their names by code, those of negative codes counted from the end."""
    names, codes = np.unique(np.concatenate([[0], left, right]), return_inverse=True)
    zero = int(codes[0])
    left, right = np.split(codes[1:] - zero, 2)
    return Pslg(as_complex(points), segments, left, right, np.arange(len(segments))), np.roll(names, -zero).astype(np.int64)


def _sizes(pslg: Pslg, largest: float, gradation: float, size: Floats | LengthField | None) -> SizeFunction:
    """Shorter edges are wanted near short segments, and where `size` says so."""
    if size is None or callable(size):
        return lengths_near(pslg.middles, pslg.lengths, largest, gradation, size)
    wanted = np.asarray(size, np.float64)
    if wanted.shape != pslg.points.shape or not (wanted > 0).all():
        raise ParameterError(f"size: expected a positive length for each of {len(pslg.points)} points, found shape {wanted.shape}")
    sources, lengths = np.concatenate([pslg.middles, pslg.points]), np.concatenate([pslg.lengths, wanted])
    return lengths_near(sources, lengths, largest, gradation)


def _shift(seed: int) -> complex:
    return complex(*np.random.default_rng(seed).uniform(-0.5, 0.5, 2)) if seed else 0j
