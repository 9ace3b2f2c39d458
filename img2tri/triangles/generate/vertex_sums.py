"""Sums over the corners of triangles, vertex by vertex: a sparse matrix with a row for each vertex and a column for each triangle.

SciPy looks at a matrix and a vector for longer than it takes to multiply those of a small mesh, so what `csc_array @ vector` does in the
end is called here at once, on arrays that are known to be right.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, Points
from img2tri.scipy_kernels import csc_matvec


class VertexSums:
    """Sums over the corners that meet at each vertex, of the values of their triangles times factors.

    Examples
    --------
    >>> VertexSums(np.array([[0, 1, 2], [0, 2, 3]]), 4, np.array([1.0, 2.0, 3.0])).of(np.array([1.0, 10.0])).tolist()
    [11.0, 2.0, 23.0, 30.0]
    """

    def __init__(self, triangles: Ints, n: int, factors: Floats | Points) -> None:
        """Take triangles (m, 3) of n vertices, and a factor for the first, second and third corner of each."""
        m = len(triangles)
        self._shape, self._factors = (n, m), np.tile(factors, m)
        self._entries, self._ends = triangles.ravel().astype(np.int32), np.arange(0, 3 * m + 1, 3, dtype=np.int32)

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the sums (n,) of values (m,), which are of the kind of the factors."""
        sums = np.zeros(self._shape[0], self._factors.dtype)
        csc_matvec()(*self._shape, self._ends, self._entries, self._factors, values, sums)
        return sums
