"""Sums over corners, against the sparse matrix they are a product of."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_array

from img2tri.triangles.generate.vertex_sums import VertexSums


@pytest.mark.parametrize("m", [0, 1, 500])
@pytest.mark.parametrize("kind", [np.float64, np.complex128])
def test_they_are_products_with_a_sparse_matrix_bit_for_bit(m, kind):
    rng = np.random.default_rng(m)
    triangles, n = rng.integers(0, 80, (m, 3)), 80
    factors, values = (
        (rng.normal(size=k) + 1j * rng.normal(size=k)).astype(kind) if kind is np.complex128 else rng.normal(size=k) for k in (3, m)
    )
    matrix = csc_array((np.tile(factors, m), triangles.ravel(), np.arange(0, 3 * m + 1, 3)), shape=(n, m))
    assert np.array_equal(VertexSums(triangles, n, factors).of(values), matrix @ values)
