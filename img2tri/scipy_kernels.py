"""SciPy's compiled kernels, without the packages around them: to import `scipy.linalg` or `scipy.sparse` takes longer than a small mesh.

Out: functions. These packages import a good part of NumPy and of each other, 0.3 s in all, for the sake of what is not used here; the
extension modules in them need none of it. Where they are not where they were, what is public in SciPy or NumPy is taken instead.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any

MOVED = (ImportError, AttributeError)  # extension modules are SciPy's own, and may move


@cache
def banded_cholesky() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return LAPACK's ``dpbtrf``, which factors a symmetric banded matrix, and ``dpbtrs``, which solves equations by the factor."""
    try:
        lapack = _extension("linalg", "_flapack")
        return lapack.dpbtrf, lapack.dpbtrs
    except MOVED:
        from scipy.linalg.lapack import dpbtrf, dpbtrs

        return dpbtrf, dpbtrs


@cache
def csc_matvec() -> Callable[..., None]:
    """Return the function that adds to a vector the product of a sparse matrix, stored by columns, with another vector.

    Its arguments are both sizes of the matrix, where its columns end, the rows and values of its entries, and both vectors; they are not
    looked at, which takes longer than the product of a small matrix.
    """
    try:
        return _extension("sparse", "_sparsetools").csc_matvec  # type: ignore[no-any-return]
    except MOVED:
        from scipy.sparse import csc_array

        def add_product(n: int, m: int, ends: Any, rows: Any, data: Any, values: Any, out: Any) -> None:
            out += csc_array((data, rows, ends), shape=(n, m)) @ values

        return add_product


@cache
def sparse_sorts() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return ``coo_tocsr`` and ``csr_tocsc``, which store a sparse matrix by rows, and one stored by rows by columns.

    They keep the order of entries of one row, or one column. Arguments are both sizes; the matrix, the first time the number of entries
    and their rows, columns and values, the second time where rows end, columns and values; and what is written: where rows end, or
    columns, then columns, or rows, and values.
    """
    try:
        kernels = _extension("sparse", "_sparsetools")
        return kernels.coo_tocsr, kernels.csr_tocsc
    except MOVED:
        import numpy as np

        def sort(keys: Any, size: int, others: Any, data: Any, out_ends: Any, out_others: Any, out_data: Any) -> None:
            order = np.argsort(keys, kind="stable")
            out_ends[:] = np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=size))])
            out_others[:], out_data[:] = others[order], data[order]

        def by_rows(n: int, _m: int, _count: int, rows: Any, columns: Any, data: Any, *out: Any) -> None:
            sort(rows, n, columns, data, *out)

        def by_columns(n: int, m: int, ends: Any, columns: Any, data: Any, *out: Any) -> None:
            sort(columns, m, np.arange(n).repeat(np.diff(ends)), data, *out)

        return by_rows, by_columns


def _extension(package: str, name: str) -> Any:
    """Return an extension module of SciPy: the one that is imported already, or else one loaded from its file, apart from its package."""
    known = sys.modules.get(f"scipy.{package}.{name}")
    if known is not None:
        return known
    if sys.platform == "win32":
        import scipy  # noqa: F401 - its start makes shared libraries known
    whole = find_spec("scipy")
    folders = [f"{folder}/{package}" for folder in (whole and whole.submodule_search_locations) or ()]
    spec = PathFinder.find_spec(f"{__name__}.{name}", folders)
    if spec is None or spec.loader is None:  # as in programs packed into one file
        return import_module(f"scipy.{package}.{name}")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
