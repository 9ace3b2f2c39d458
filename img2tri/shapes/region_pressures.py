"""Regions that lack area -> by how much to shift the boundaries between them: the least shifts by which all get what they lack.

Each region has a pressure, what is not meshed has none, and a boundary moves by the difference of the pressures on its two sides: what one
region lacks it gets from whatever boundary of it can move, and its neighbours from theirs. That are the shifts with the least weighted
sum of squares (Lagrange multipliers; the equations are those of currents in a network, Kirchhoff 1847), one linear equation a region.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints

FEW_REGIONS = 100  # regions, whose equations are solved as a full matrix
SOLVABLE = 1e-6  # px: so that there is one solution where nothing is free to move


def region_pressures(left: Ints, right: Ints, width: Floats, lacking: Floats) -> Floats:
    """Return the pressure (r,) of each region, by its number; that of 0, nothing, is 0.

    Parameters
    ----------
    left, right
        (k,) int64, the region numbers beside pieces of boundaries.
    width
        (k,) float64, the area that left regions gain where such a piece is shifted by 1 to the right.
    lacking
        (r,) float64, the area that each region is to gain.

    Examples
    --------
    Region 1 lacks an area of 3; towards region 2 its boundary is 4 px long, towards nothing 2. Region 2 has one more boundary.

    >>> region_pressures(np.array([1, 0, 2]), np.array([2, 1, 0]), np.array([4.0, 2, 8]), np.array([0.0, 3, 0])).round(3).tolist()
    [0.0, 0.643, 0.214]
    """
    n = len(lacking)
    rows, columns = np.concatenate([left, right, left, right]), np.concatenate([left, right, right, left])
    values = np.concatenate([width, width, -width, -width])
    if n <= FEW_REGIONS:
        full = np.bincount(rows * n + columns, values, n * n).reshape(n, n)[1:, 1:]
        return np.concatenate([[0.0], np.linalg.solve(full + SOLVABLE * np.eye(n - 1), lacking[1:])])
    from scipy.sparse import coo_array, eye_array
    from scipy.sparse.linalg import spsolve

    equations = coo_array((values, (rows, columns)), shape=(n, n)).tocsr()[1:, 1:] + SOLVABLE * eye_array(n - 1)
    return np.concatenate([[0.0], np.atleast_1d(spsolve(equations.tocsc(), lacking[1:]))])
