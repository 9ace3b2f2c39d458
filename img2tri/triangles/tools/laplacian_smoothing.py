"""Laplacian smoothing with uniform weights, as in the paper (sections II-E and III-E): a mesh in, new vertices out.

Every vertex inside goes to the mean of its neighbours. That evens out all lengths: it helps a mesh that is meant to be even and was
scattered, and pulls a graded one about. With weights that keep a graded mesh as it is: `img2tri.triangles.tools.cotangent_smoothing`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Bools, Floats, Ints
from img2tri.errors import integer
from img2tri.triangles.tools.inversion_guard import put_back
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions, check_selection
from img2tri.triangles.tools.topology import adjacency, curve_vertices


def uniform(
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    iterations: int = 10,
    fixed: ArrayLike | None = None,
    regions: ArrayLike | None = None,
    guard: bool = False,
) -> Floats:
    """Draw every vertex inside to the mean of its neighbours, all at once, `iterations` times: Laplacian smoothing as in the paper.

    Without `guard` it may turn triangles over where the region is not convex. A vertex without triangles stays.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    iterations
        Number of passes (Jacobi); the paper's is 10. More evens out lengths further, also those that were meant to differ.
    fixed : (n,) bool or (k,) int, optional
        Exactly the vertices that stay, as a mask or as indices. None: those on the boundary and the interfaces.
    regions : (m,) int64, optional
        With them the vertices between different regions stay too. Of no effect with `fixed`.
    guard
        True: in each pass the vertices of triangles that were spoiled are put back (see `put_back`). False: exactly the paper's.

    Returns
    -------
    vertices : (n, 2) float64

    Raises
    ------
    MeshError
        The arrays are not a mesh.
    ParameterError
        `iterations` is not a whole number.

    Examples
    --------
    >>> vertices = [[0, 0], [2, 0], [2, 2], [0, 2], [0.5, 1.7]]
    >>> uniform(vertices, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])[4].tolist()
    [1.0, 1.0]
    """
    v, t = check_mesh(vertices, triangles)
    passes = integer("iterations", iterations)
    free = ~_fixed(t, len(v), fixed, regions)
    neighbours = adjacency(t, len(v))
    number = np.diff(neighbours.indptr)
    free &= number > 0
    rows, number = neighbours[free], number[free, None]
    for _ in range(passes):
        after = v.copy()
        after[free] = (rows @ v) / number
        v = put_back(v, after, t) if guard else after
    return v if passes else v.copy()


def _fixed(triangles: Ints, n: int, fixed: ArrayLike | None, regions: ArrayLike | None) -> Bools:
    """Return a mask of the vertices that stay: those named, or else those on the boundary and the interfaces."""
    r = None if regions is None else check_regions(regions, triangles)
    if fixed is None:
        return curve_vertices(triangles, n, r)
    mask = np.zeros(n, bool)
    mask[check_selection("fixed", fixed, n)] = True
    return mask
