"""What the cotangent Laplacian is good for in the plane: carrying the inside along when the boundary moves, and smoothing fields.

In: a mesh with displacements or values at vertices. Out: all vertices, or the values smoothed. The matrix is libigl's `cotmatrix`, the
stiffness matrix of linear finite elements: solving with it gives the discrete harmonic function, and stepping with it the flow of heat.
Both systems are symmetric and positive and are solved directly, by libigl's sparse Cholesky factors: exact to rounding, so that
integrals and linear functions are kept, and three times as fast as SciPy's LU on meshes of up to some 100,000 vertices.
"""

from __future__ import annotations

import igl
import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, csc_matrix, diags_array

from img2tri.arrays import Floats, Ints, as_complex
from img2tri.errors import MeshError, finite
from img2tri.triangles.min_angle_tangents import min_angle_tangents
from img2tri.triangles.tools.inversion_guard import put_back
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions, check_selection, check_values
from img2tri.triangles.tools.topology import curve_vertices


def carry(
    vertices: ArrayLike,
    triangles: ArrayLike,
    moved: ArrayLike,
    positions: ArrayLike,
    *,
    regions: ArrayLike | None = None,
    guard: bool = True,
) -> Floats:
    """Move some vertices, as a rule of the boundary, and let the inside follow harmonically.

    The displacement inside is the harmonic function (cotangent weights) with the given values at the moved vertices and 0 at all others of
    boundary and interfaces. So a shift, a turn or a stretch of the whole boundary is passed on to the inside exactly, and the
    short waves of pixel steps fade within a few triangles.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    moved : (n,) bool or (k,) int
        The vertices to move, as a mask or as indices.
    positions : (k, 2) float
        Where they go, in the order of the indices (of the mask).
    regions : (m,) int64, optional
        With them, vertices of interfaces that are not moved stay.
    guard
        True: vertices of triangles that would be spoiled are put back, moved ones too. False: all moved ones end at `positions`.

    Returns
    -------
    vertices : (n, 2) float64

    Raises
    ------
    MeshError
        The arrays are not a mesh, or `moved` and `positions` do not fit each other.

    Notes
    -----
    Solved directly (libigl's ``min_quad_with_fixed``, sparse Cholesky): 100,000 vertices take 0.3 s, five times as many
    twenty times as long.

    Examples
    --------
    The right side is pulled out by 1; the vertex in the middle goes half of the way:

    >>> vertices = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]
    >>> carry(vertices, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], [1, 2], [[3, 0], [3, 2]], guard=False)[4].tolist()
    [1.5, 1.0]
    """
    v, t = check_mesh(vertices, triangles)
    which = check_selection("moved", moved, len(v))
    goal = check_values("positions", positions, len(which))
    if goal.shape[1:] != (2,):
        raise MeshError(f"positions: expected shape ({len(which)}, 2), found {goal.shape}")
    L = laplacian(v, t)
    r = None if regions is None else check_regions(regions, t)
    known = curve_vertices(t, len(v), r) | (L.diagonal() <= 0)
    known[which] = True
    shift = np.zeros_like(v)
    shift[which] = goal - v[which]
    if shift.any() and not known.all():
        shift = _solve(L, np.zeros_like(v), np.flatnonzero(known), shift[known])
    after = v + shift
    after[which] = goal
    return put_back(v, after, t) if guard else after


def smooth_field(vertices: ArrayLike, triangles: ArrayLike, values: ArrayLike, *, time: float) -> Floats:
    """Smooth values given at the vertices, a field or a relief: one implicit step of heat flow, (M + t L) u = M u0.

    Keeps the integral of the field over the mesh, and constants. On a Delaunay mesh no new extremes appear.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    values : (n,) or (n, k) float
        One or more fields.
    time
        World units squared: details smaller than its square root fade. 0 changes nothing.

    Returns
    -------
    values : as given, float64

    Raises
    ------
    MeshError
        The arrays are not a mesh with values.
    ParameterError
        `time` is negative or not finite.

    Examples
    --------
    >>> smooth_field([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], [0, 0, 3, 0], time=1.0).round(3).tolist()
    [0.675, 0.9, 1.425, 0.9]
    """
    v, t = check_mesh(vertices, triangles)
    u = check_values("values", values, len(v))
    time = finite("time", time, least=0)
    mass = np.bincount(t.ravel(), np.repeat(np.abs(igl.doublearea(v, t)) / 6, 3), minlength=len(v))
    mass[mass == 0] = 1.0  # a vertex without triangles keeps its value
    L = laplacian(v, t)
    columns = u.reshape(len(v), -1)
    change = _solve((diags_array(mass) + time * L).tocsc(), -time * (L @ columns), np.zeros(0, np.int64), np.zeros((0, columns.shape[1])))
    return u + change.reshape(u.shape)


def laplacian(vertices: Floats, triangles: Ints) -> csc_array:
    """Return libigl's cotangent matrix (n, n), with the sign that makes it positive semidefinite; triangles without area add nothing.

    Examples
    --------
    >>> laplacian(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]])).toarray().tolist()
    [[1.0, -0.5, -0.5], [-0.5, 0.5, 0.0], [-0.5, 0.0, 0.5]]
    """
    sound = np.abs(min_angle_tangents(as_complex(vertices), triangles)) > 1e-6
    if not sound.any():
        return csc_array((len(vertices), len(vertices)))
    return csc_array(-igl.cotmatrix(vertices, triangles[sound]))


def _solve(matrix: csc_array, right: Floats, known: Ints, values: Floats) -> Floats:
    """Solve matrix x = right for all vertices but the known ones, which have their values; the matrix is symmetric and positive."""
    n = matrix.shape[0]
    nothing = csc_matrix((0, n))
    return igl.min_quad_with_fixed(csc_matrix(matrix), -right, known, values, nothing, np.zeros((0, right.shape[1])), True)  # type: ignore[no-any-return]
