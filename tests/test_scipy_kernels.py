"""Compiled kernels of SciPy, loaded apart from the packages around them."""

import subprocess
import sys

import numpy as np
import pytest
import scipy.linalg.lapack
import scipy.sparse

from img2tri import scipy_kernels

ALONE = """
import sys
from img2tri.scipy_kernels import banded_cholesky, csc_matvec
factor, add = banded_cholesky()[0], csc_matvec()
assert not {"scipy.linalg", "scipy.sparse", "numpy.f2py"} & set(sys.modules)
import numpy as np, scipy.linalg, scipy.sparse
band = np.array([[4.0, 5, 6], [1, 2, 0]], order="F")
assert np.array_equal(factor(band, lower=1)[0], scipy.linalg.cholesky_banded(band, lower=True))
assert scipy.linalg.lapack.dpbtrf is not factor and scipy.sparse._sparsetools.csc_matvec
"""


@pytest.fixture(params=["where it is", "moved", "gone", "in no file"])
def place(request, monkeypatch):
    """Where the extension modules are."""
    if request.param == "moved":
        monkeypatch.setattr(scipy_kernels, "_extension", lambda *_: object())
    elif request.param == "gone":
        monkeypatch.setattr(scipy_kernels, "_extension", lambda *name: scipy_kernels.import_module("scipy.gone"))
    elif request.param == "in no file":
        monkeypatch.setattr(scipy_kernels, "PathFinder", type("Nowhere", (), {"find_spec": lambda *_: None}))
        monkeypatch.delitem(sys.modules, "scipy.linalg._flapack")
        monkeypatch.delitem(sys.modules, "scipy.sparse._sparsetools")
    scipy_kernels.banded_cholesky.cache_clear()
    scipy_kernels.csc_matvec.cache_clear()
    scipy_kernels.sparse_sorts.cache_clear()
    yield
    scipy_kernels.banded_cholesky.cache_clear()
    scipy_kernels.csc_matvec.cache_clear()
    scipy_kernels.sparse_sorts.cache_clear()


@pytest.mark.usefixtures("place")
def test_banded_equations_are_solved():
    dense = np.diag([4.0, 5, 6, 7]) + np.diag([1.0, 2, 0.5], 1) + np.diag([1.0, 2, 0.5], -1)
    band = np.array([np.diag(dense), [*np.diag(dense, 1), 0]], order="F")
    factor, solve = scipy_kernels.banded_cholesky()
    found, failed = factor(band, lower=1)
    assert failed == 0
    assert np.allclose(solve(found, np.arange(4.0)[:, None], lower=1)[0][:, 0], np.linalg.solve(dense, np.arange(4.0)), rtol=1e-14)


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("kind", [float, complex])
def test_products_are_added(kind):
    matrix = scipy.sparse.csc_array(np.array([[1, 0, 2], [0, 3, 4]], kind) * (1 + 1j if kind is complex else 1))
    values, out = np.array([1, 10, 100], kind), np.array([7, 8], kind)
    scipy_kernels.csc_matvec()(2, 3, matrix.indptr, matrix.indices, matrix.data, values, out)
    assert np.array_equal(out, [7, 8] + matrix.toarray() @ values)


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize("kind", [np.int32, np.int64])
def test_matrices_are_stored_by_rows_and_by_columns(kind):
    by_rows, by_columns = scipy_kernels.sparse_sorts()
    rows, columns, data = np.array([2, 0, 2, 0], kind), np.array([0, 3, 0, 0], kind), np.array([7, 6, 8, 5], kind)
    out = np.empty(4, kind), np.empty(4, kind), np.empty(4, kind)
    by_rows(3, 4, 4, rows, columns, data, *out)
    assert [part.tolist() for part in out] == [[0, 2, 2, 4], [3, 0, 0, 0], [6, 5, 7, 8]]
    turned = np.empty(5, kind), np.empty(4, kind), np.empty(4, kind)
    by_columns(3, 4, *out, *turned)
    assert [part.tolist() for part in turned] == [[0, 3, 3, 3, 4], [0, 2, 2, 0], [5, 7, 8, 6]]


def test_kernels_come_without_their_packages_which_can_be_imported_after_them():
    subprocess.run([sys.executable, "-c", ALONE], check=True)


def test_kernels_imported_already_are_the_same():
    scipy_kernels.banded_cholesky.cache_clear()
    assert scipy_kernels.banded_cholesky()[0] is scipy.linalg.lapack.dpbtrf
