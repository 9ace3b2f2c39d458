"""Compiled kernels of SciPy, loaded apart from the packages around them."""

import subprocess
import sys

import numpy as np
import pytest

from img2tri.scipy_kernels import scipy_kernel

ALONE = """
import sys
from img2tri.scipy_kernels import scipy_kernel
lapack, sums = scipy_kernel("linalg", "_flapack"), scipy_kernel("sparse", "_sparsetools")
assert not {"scipy.linalg", "scipy.sparse", "numpy.f2py"} & set(sys.modules)
import numpy as np, scipy.linalg, scipy.sparse
band = np.array([[4.0, 5, 6], [1, 2, 0]], order="F")
assert np.array_equal(lapack.dpbtrf(band, lower=1)[0], scipy.linalg.cholesky_banded(band, lower=True))
assert scipy.linalg.lapack.dpbtrf is not lapack.dpbtrf and scipy.sparse._sparsetools.csc_matvec
"""


def test_a_kernel_comes_without_its_package_which_can_be_imported_after_it():
    subprocess.run([sys.executable, "-c", ALONE], check=True)


def test_a_kernel_imported_already_is_the_same():
    import scipy.linalg.lapack

    scipy_kernel.cache_clear()
    assert scipy_kernel("linalg", "_flapack").dpbtrs is scipy.linalg.lapack.dpbtrs


def test_there_must_be_such_a_kernel():
    with pytest.raises(ImportError):
        scipy_kernel("linalg", "_nothing")


def test_where_there_is_no_file_the_package_is_imported(monkeypatch):
    monkeypatch.setattr("img2tri.scipy_kernels.PathFinder.find_spec", lambda *_: None)
    scipy_kernel.cache_clear()
    assert np.allclose(scipy_kernel("linalg", "_flapack").dpotrf(np.eye(2))[0], np.eye(2))
