"""Whatever is handed over as a mesh is turned into safe arrays or refused by name."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.errors import MeshError
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions, check_selection, check_values

V = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
T = np.array([[0, 1, 2], [0, 2, 3]])


def test_sound_arrays_come_back_as_they_are():
    v, t = check_mesh(V, T)
    assert np.shares_memory(v, V)
    assert np.shares_memory(t, T)


@pytest.mark.parametrize("dtype", [np.int8, np.int32, np.uint32, np.uint64, ">i4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_any_whole_and_real_dtype_becomes_contiguous(dtype, order):
    v, t = check_mesh(np.array(V, np.float32, order=order), np.array(T, dtype, order=order))
    assert v.dtype == np.float64
    assert t.dtype == np.int64
    assert v.flags.c_contiguous
    assert t.flags.c_contiguous
    assert (v == V).all()
    assert (t == T).all()


def test_lists_and_read_only_arrays_will_do():
    v = V.copy()
    v.flags.writeable = False
    assert (check_mesh(v, T.tolist())[1] == T).all()


NAN = V.copy()
NAN[2, 1] = np.nan


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (V[:, :1], T, r"vertices: expected shape \(n, 2\), found \(4, 1\)"),
        (np.c_[V, V[:, :1]], T, r"vertices: .* \(4, 3\); leave out the third column"),
        (V.ravel(), T, r"vertices: expected shape \(n, 2\), found \(8,\)"),
        ([[0, 0], [1]], T, "vertices: .*rows of different lengths"),
        (V.astype(complex), T, "vertices: expected real numbers, found dtype complex128"),
        (V.astype(str), T, "vertices: expected real numbers"),
        (NAN, T, r"vertices: expected finite numbers, found \[1.0, nan\] in row 2 \(1 such"),
        (V + np.inf, T, "vertices: expected finite numbers"),
        (V, T[:0], r"triangles: expected shape \(m, 3\) with m of at least 1, found \(0, 3\)$"),
        (V, [[0, 1]], r"triangles: expected shape \(m, 3\) with m of at least 1, found \(1, 2\)$"),
        (V, [0, 1, 2, 3], r"triangles: expected shape \(m, 3\) with m of at least 1, found \(4,\)$"),
        (V, [[0, 1, 2, 3]], "triangles: .*quadrilaterals have to be split"),
        (V, T.astype(float), r"triangles: expected whole numbers, found dtype float64; convert .* astype\(int\)"),
        (V, T > 0, "triangles: expected whole numbers, found dtype bool"),
        (V, [[0, 1, 2], [0, 2, 4]], r"triangles: expected indices from 0 to 3 .* found 4 in triangle 1"),
        (V, [[0, 1, -1]], r"triangles: expected indices from 0 to 3 .* found -1 in triangle 0"),
        (V, np.array([[0, 1, 2**64 - 1]], np.uint64), "triangles: expected numbers that fit 64 bits with a sign"),
        (V, [[0, 1, 2], [0, 2, 2]], r"triangles: expected three different vertices each, found \[0, 2, 2\] in triangle 1 \(1 such\)"),
        (V[:0], T, "triangles: expected indices from 0 to -1"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, triangles, message):
    with pytest.raises(MeshError, match=message):
        check_mesh(vertices, triangles)


def test_regions():
    assert check_regions(np.array([3, -1], np.int16), T).dtype == np.int64
    with pytest.raises(MeshError, match=r"regions: expected one for each triangle, shape \(2,\), found shape \(3,\)"):
        check_regions([1, 2, 3], T)
    with pytest.raises(MeshError, match="regions: expected whole numbers"):
        check_regions([1.0, 2.0], T)


def test_selection_by_mask_or_by_indices():
    assert check_selection("fixed", [3, 1], 4).tolist() == [3, 1]
    assert check_selection("fixed", [False, True, False, True], 4).tolist() == [1, 3]
    assert check_selection("fixed", [], 4).tolist() == []


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ([True, False], r"fixed: expected a mask of shape \(4,\)"),
        ([0, 4], "fixed: expected indices from 0 to 3 .* found 4 in place 1"),
        ([[0, 1]], "fixed: .* in one dimension"),
        ([0.5], "fixed: expected whole numbers"),
    ],
)
def test_selections_that_are_none(chosen, message):
    with pytest.raises(MeshError, match=message):
        check_selection("fixed", chosen, 4)


def test_values():
    assert check_values("values", np.arange(8).reshape(4, 2), 4).dtype == np.float64
    with pytest.raises(MeshError, match=r"values: expected shape \(4,\) or \(4, k\), one row for each vertex, found \(3,\)"):
        check_values("values", [1, 2, 3], 4)
    with pytest.raises(MeshError, match=r"values: expected finite numbers, found nan in row 1"):
        check_values("values", [1, np.nan, 3, 4], 4)
