"""Smoothing by cotangent weights: a mesh in, new vertices out; the triangles stay as they are.

Cotangent weights reproduce linear functions, so in the plane every vertex inside already is the weighted mean of its neighbours: *a
flat mesh with fixed boundary is a fixed point* of cotangent smoothing, whatever its grading, and nothing moves but rounding errors.
That is its meaning, and its use lies elsewhere: with a free boundary it rounds off the pixel steps of boundary and interfaces, within a
tolerance, and the inside follows harmonically. What else the matrix of these weights is good for: `cotangent_laplacian`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import diags_array

from img2tri.arrays import Floats, Ints, as_complex
from img2tri.errors import ParameterError, choice, integer
from img2tri.triangles.min_angle_tangents import min_angle_tangents
from img2tri.triangles.tools.cotangent_laplacian import carry, laplacian
from img2tri.triangles.tools.curve_fairing import Bounds, fair_curves
from img2tri.triangles.tools.inversion_guard import put_back
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions
from img2tri.triangles.tools.topology import curve_vertices

DAMPING = 0.5
"""Part of the way to the weighted mean that one pass of cotangent smoothing goes. With obtuse angles some weights are negative and
whole steps can swing up; steps of up to 2/3 cannot on any mesh, no eigenvalue of D^-1 L being above 3, the number of corners."""


def cotangent(
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    iterations: int = 10,
    boundary: str = "fixed",
    tolerance: float | None = None,
    width: float | None = None,
    bounds: Bounds | None = None,
    regions: ArrayLike | None = None,
    guard: bool = True,
) -> Floats:
    """Smooth by cotangent weights; with a free boundary, round off the pixel steps of boundary and interfaces.

    ``boundary="fixed"``: every vertex inside goes half of the way to its weighted mean, where it is already. The mesh stays as it is, to
    about 1e-15 of its size for sound triangles and 1e-12 for needles. Vertices of triangles that are turned over, or have an angle
    below 0.006 degrees, have no such mean and are left alone.

    ``boundary="free"``: the curves are smoothed by `fair_curves` and the inside follows by `carry`. No vertex of a curve ends further than
    `tolerance` from where it was; junctions stay, and with `bounds` the frame of the image stays flat and its corners exact.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    iterations
        Number of passes. With a free boundary, more smooth over a longer stretch of the curves.
    boundary
        "fixed" or "free".
    tolerance
        World units; needed with a free boundary, and of no effect else. Larger rounds off more, corners too.
    width
        World units, for a free boundary: longer waves along the curves stay, shorter ones go. None: 24 times the tolerance, or four
        edges of the curves if that is more.
    bounds
        (left, bottom, right, top) of the image, for a free boundary: vertices on this frame only slide along it.
    regions : (m,) int64, optional
        With them the interfaces between regions are treated as the boundary is.
    guard
        True: the vertices of triangles that were spoiled are put back (see `put_back`). False: all stay where they were moved.

    Returns
    -------
    vertices : (n, 2) float64

    Raises
    ------
    MeshError
        The arrays are not a mesh.
    ParameterError
        An option has a value it cannot have, or `tolerance` is missing.

    Examples
    --------
    >>> vertices = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.5, 1.7]])
    >>> after = cotangent(vertices, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> bool(np.abs(after - vertices).max() < 1e-12)
    True
    """
    v, t = check_mesh(vertices, triangles)
    passes = integer("iterations", iterations)
    r = None if regions is None else check_regions(regions, t)
    if choice("boundary", boundary, ("fixed", "free")) == "fixed":
        return _relaxed(v, t, passes, r, guard)
    if tolerance is None:
        raise ParameterError("tolerance: expected a length with boundary='free', found None; say how far the boundary may move")
    faired = fair_curves(v, t, tolerance=tolerance, width=width, iterations=passes, regions=r, bounds=bounds)
    curve = np.flatnonzero(curve_vertices(t, len(v), r))
    return carry(v, t, curve, faired[curve], guard=guard)


def _relaxed(vertices: Floats, triangles: Ints, passes: int, regions: Ints | None, guard: bool) -> Floats:
    """Go half of the way to the weighted means, `passes` times, boundary and interfaces fixed."""
    L = laplacian(vertices, triangles)
    diagonal = L.diagonal()
    free = ~curve_vertices(triangles, len(vertices), regions) & (diagonal > 0)
    free[triangles[min_angle_tangents(as_complex(vertices), triangles) < 1e-4]] = False
    rows = diags_array(DAMPING / diagonal[free]) @ L.tocsr()[free]
    # Differences from the middle: far from the origin L x would be a small difference of large numbers.
    middle = vertices.mean(axis=0)
    x = vertices.copy()
    for _ in range(passes):
        after = x.copy()
        after[free] -= rows @ (x - middle)
        x = put_back(x, after, triangles) if guard else after
    return x
