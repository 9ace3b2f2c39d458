"""Checks made on arrays that are said to be a mesh, before any of them reaches libigl.

In: what a caller gave. Out: contiguous float64 and int64 arrays that are safe to index with, or a ``MeshError``. libigl checks
no bounds: one wrong index ends the whole process, so every function that calls it comes through here first. All checks are
whole-array operations; for a million triangles they take a few hundredths of a second.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError


def check_mesh(vertices: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Ints]:
    """Return `vertices` and `triangles` ready for libigl, or say what is wrong with them.

    Arrays that already are contiguous float64 and int64 come back as they are, not copied. The orientation and the area of the
    triangles are not looked at: a mesh may be spoiled and still be measured.

    Parameters
    ----------
    vertices : (n, 2) float
        Coordinates, all finite.
    triangles : (m, 3) int
        Indices of three different vertices each, m at least 1.

    Returns
    -------
    vertices : (n, 2) float64
    triangles : (m, 3) int64

    Raises
    ------
    MeshError
        Wrong shape or dtype, a coordinate that is not finite, an index out of bounds, a triangle that repeats a vertex.

    Examples
    --------
    >>> check_mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]])
    Traceback (most recent call last):
    ...
    img2tri.errors.MeshError: triangles: expected indices from 0 to 2 (there are 3 vertices), found 3 in triangle 0; ...
    """
    v = _array("vertices", vertices, "(n, 2) numbers")
    if v.ndim != 2 or v.shape[1] != 2:
        hint = "; leave out the third column, a mesh of an image is flat" if v.ndim == 2 and v.shape[1] == 3 else ""
        raise MeshError(f"vertices: expected shape (n, 2), found {v.shape}{hint}")
    v = _floats("vertices", v)
    t = _array("triangles", triangles, "(m, 3) whole numbers")
    if t.ndim != 2 or t.shape[1] != 3 or len(t) == 0:
        hint = "; quadrilaterals have to be split" if t.ndim == 2 and t.shape[1] == 4 else ""
        raise MeshError(f"triangles: expected shape (m, 3) with m of at least 1, found {t.shape}{hint}")
    t = _indices("triangles", t, len(v))
    repeated = (t[:, 0] == t[:, 1]) | (t[:, 1] == t[:, 2]) | (t[:, 2] == t[:, 0])
    if repeated.any():
        i = int(np.argmax(repeated))
        raise MeshError(
            f"triangles: expected three different vertices each, found {t[i].tolist()} in triangle {i} "
            f"({int(repeated.sum())} such); remove these triangles"
        )
    return v, t


def check_regions(regions: ArrayLike, triangles: Ints) -> Ints:
    """Return `regions` as (m,) int64, one for each triangle, or raise ``MeshError``.

    Examples
    --------
    >>> check_regions([1, 2], np.array([[0, 1, 2], [0, 2, 3]]))
    array([1, 2])
    """
    r = _array("regions", regions, "(m,) whole numbers")
    if r.shape != (len(triangles),):
        raise MeshError(f"regions: expected one for each triangle, shape ({len(triangles)},), found shape {r.shape}")
    return _whole("regions", r)


def check_selection(name: str, chosen: ArrayLike, n: int) -> Ints:
    """Return a choice of vertices as indices, given as such in any order or as a mask (n,) bool, or raise ``MeshError``.

    Examples
    --------
    >>> check_selection("fixed", [True, False, True, False], 4)
    array([0, 2])
    """
    c = _array(name, chosen, "a mask or indices of vertices")
    if c.dtype == np.bool_:
        if c.shape != (n,):
            raise MeshError(f"{name}: expected a mask of shape ({n},), one for each vertex, found shape {c.shape}")
        return np.flatnonzero(c)
    if c.ndim != 1:
        raise MeshError(f"{name}: expected a mask or indices in one dimension, found shape {c.shape}")
    return _indices(name, c, n)


def check_values(name: str, values: ArrayLike, n: int) -> Floats:
    """Return values at vertices, (n,) or (n, k), as contiguous finite float64, or raise ``MeshError``.

    Examples
    --------
    >>> check_values("values", [1, 2, 3], 3)
    array([1., 2., 3.])
    """
    x = _array(name, values, "numbers")
    if x.ndim not in (1, 2) or len(x) != n:
        raise MeshError(f"{name}: expected shape ({n},) or ({n}, k), one row for each vertex, found {x.shape}")
    return _floats(name, x)


def _array(name: str, value: ArrayLike, expected: str) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except ValueError as error:
        raise MeshError(f"{name}: expected {expected}, found rows of different lengths") from error


def _floats(name: str, x: NDArray[Any]) -> Floats:
    if x.dtype.kind not in "biuf":
        raise MeshError(f"{name}: expected real numbers, found dtype {x.dtype}")
    x = np.ascontiguousarray(x, np.float64)
    bad = ~np.isfinite(x)
    if bad.any():
        row = int(np.argwhere(bad)[0, 0])
        raise MeshError(f"{name}: expected finite numbers, found {x[row].tolist()} in row {row} ({int(bad.sum())} such numbers)")
    return x


def _whole(name: str, x: NDArray[Any]) -> Ints:
    if x.size == 0:
        return np.zeros(x.shape, np.int64)
    if x.dtype.kind not in "iu":
        raise MeshError(f"{name}: expected whole numbers, found dtype {x.dtype}; convert them with astype(int) if that is what they are")
    if x.dtype == np.uint64 and x.max() > np.uint64(np.iinfo(np.int64).max):
        raise MeshError(f"{name}: expected numbers that fit 64 bits with a sign, found {x.max()}")
    return np.ascontiguousarray(x, np.int64)


def _indices(name: str, x: NDArray[Any], n: int) -> Ints:
    x = _whole(name, x)
    if x.size and (x.min() < 0 or x.max() >= n):
        row = int(np.argwhere((x < 0) | (x >= n))[0, 0])
        found = int(next(i for i in np.ravel(x[row]) if not 0 <= i < n))
        place = f"triangle {row}" if x.ndim == 2 else f"place {row}"
        raise MeshError(
            f"{name}: expected indices from 0 to {n - 1} (there are {n} vertices), found {found} in {place}; "
            "indices count from 0, and every one needs its vertex"
        )
    return x
