"""Fill a network of outlines with triangles: the inside of the mesh.

In: points, segments, the regions on both sides of each segment, the wanted edge length. Out: a triangle mesh that has the segments as
its edges. The way:

    sizes     how long edges should be at each place                                       grading.py
    divide    segments too long for that                                                   network.py
    front     an apex over either side of each segment                                     front.py
    lattice   hexagonal inside; its depth becomes triangles at once                        lattice.py
    finer     nodes of nested lattices, where shorter edges are wanted                     grading.py
    band      constrained Delaunay triangulation of what lies between                      band.py, delaunay.py
    relax     move vertices, repair their number of triangles, move again;                 relaxing.py, repairing.py
              those on outlines may slide along these
    mend      where an angle is still too small: Ruppert's refinement, in a patch          mending.py
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from img2tri.errors import ParameterError, finite, integer
from img2tri.triangles.generate.constrained_delaunay import NetworkError, check_network
from img2tri.triangles.generate.graded_lattice import Sizes, pairs
from img2tri.triangles.generate.hexagonal_lattice import Lattice
from img2tri.triangles.generate.local_refinement import mended
from img2tri.triangles.generate.pslg import Network
from img2tri.triangles.generate.strip import Slide, band, completed, settled
from img2tri.types import Floats, Ints


def fill(
    points: Floats,
    segments: Ints,
    left: Ints,
    right: Ints,
    *,
    edge_length: float,
    min_angle: float = 30.0,
    gradation: float = 0.17,
    size: Floats | Callable[[Floats], Floats] | None = None,
    slide: Slide | None = None,
    seed: int = 0,
) -> tuple[Floats, Ints, Ints]:
    """Fill the regions of a network of segments with triangles.

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
        Degrees. Where the mesh misses it, points are added. It is reached unless segments meet in sharp corners.
    gradation : float
        By how much the wanted length grows per unit of distance from short segments. Smaller values give better
        triangles, and more.
    size : (n,) float64 or callable, optional
        Edge length wanted at each point; or a function of places (k, 2) that returns lengths (k,), which should itself grow by no more
        than `gradation`. Only what is below `edge_length` counts.
    slide : Slide, optional
        How points may slide along their outlines; None: they stay.
    seed : int
        0 centres the lattice on the network; another number shifts it by chance, for another mesh as good.

    Returns
    -------
    vertices : (v, 2) float64
        The points, in their order, slid or not; then all others.
    triangles : (m, 3) int64
        Counter-clockwise. Every segment is an edge, or a chain of edges where it was long for the length wanted there.
    regions : (m,) int64
        The region of each triangle.

    Raises
    ------
    NetworkError
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
    edge_length = finite("edge_length", edge_length, above=0)
    min_angle = finite("min_angle", min_angle, least=0, most=40)
    gradation = finite("gradation", gradation, above=0)
    seed = integer("seed", seed)
    check_network(points, segments, left, right)
    if not (np.any(left) or np.any(right)):
        return points.copy(), np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    given, names = _network(points, segments, left, right)
    sizes = _sizes(given, edge_length, gradation, size)
    network, at_points, at_middles = given.divided(sizes)
    lattice = Lattice.over(network.points, edge_length, _shift(seed))
    try:
        # To mend the mesh may take splitting an edge of the depth, which cannot be: then again with less depth, or none.
        for rings in (2, 8, lattice.rows):
            laid = band(network, at_points, at_middles, sizes, lattice, rings)
            mesh = mended(*settled(laid, slide), laid.fence, laid.own, min_angle)
            if mesh is not None:
                break
    except NetworkError as error:
        own = error.segments[error.segments < len(network.segments)]
        raise NetworkError(str(error), np.unique(network.origin[own])) from error
    assert mesh is not None, "without depth every edge may be split"
    vertices, triangles, codes = completed(laid, *mesh)
    return pairs(vertices), triangles, names[codes]


def _network(points: Floats, segments: Ints, left: Ints, right: Ints) -> tuple[Network, Ints]:
    """Give the regions codes near 0, and 0 for region 0; return their names by code, those of negative codes counted from the end."""
    names, codes = np.unique(np.concatenate([[0], left, right]), return_inverse=True)
    zero = int(codes[0])
    left, right = np.split(codes[1:] - zero, 2)
    network = Network(points[:, 0] + 1j * points[:, 1], segments, left, right, np.arange(len(segments)))
    return network, np.roll(names, -zero).astype(np.int64)


def _sizes(network: Network, largest: float, gradation: float, size: Floats | Callable[[Floats], Floats] | None) -> Sizes:
    """Shorter edges are wanted near short segments, and where `size` says so."""
    if size is None or callable(size):
        return Sizes.near(network.middles, network.lengths, largest, gradation, size)
    wanted = np.asarray(size, np.float64)
    if wanted.shape != network.points.shape or not (wanted > 0).all():
        raise ParameterError(f"size: expected a positive length for each of {len(network.points)} points, found shape {wanted.shape}")
    sources, lengths = np.concatenate([network.middles, network.points]), np.concatenate([network.lengths, wanted])
    return Sizes.near(sources, lengths, largest, gradation)


def _shift(seed: int) -> complex:
    return complex(*np.random.default_rng(seed).uniform(-0.5, 0.5, 2)) if seed else 0j
