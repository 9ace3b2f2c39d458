"""Carrying and field smoothing against libigl's `harmonic`, dense algebra and what must be kept."""

from __future__ import annotations

from itertools import pairwise

import igl
import numpy as np
import pytest
from oracles import angles, areas
from scipy.spatial import Delaunay

from img2tri.errors import MeshError, ParameterError
from img2tri.triangles.tools.cotangent_laplacian import carry, laplacian, smooth_field
from img2tri.triangles.tools.topology import curve_vertices


def square(seed=0, n=150):
    """A square of side 1 with even boundary and random vertices inside, Delaunay."""
    rng = np.random.default_rng(seed)
    s = np.arange(0, 1, 0.1)
    o, e = np.zeros_like(s), np.ones_like(s)
    sides = [np.stack(p, axis=1) for p in ((s, o), (e, s), (1 - s, e), (o, 1 - s))]
    points = np.concatenate([*sides, rng.uniform(0.04, 0.96, (n, 2))])
    triangles = Delaunay(points).simplices.astype(np.int64)
    clockwise = areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return points, triangles[np.abs(areas(points, triangles)) > 1e-12]


def stiffness(v, t):
    """The stiffness matrix of linear elements, from gradients, dense."""
    K = np.zeros((len(v), len(v)))
    for tri in t:
        edges = v[tri[[2, 0, 1]]] - v[tri[[1, 2, 0]]]
        area = np.linalg.det(np.c_[v[tri], np.ones(3)]) / 2
        K[np.ix_(tri, tri)] += edges @ edges.T / (4 * area)
    return K


def test_laplacian_is_the_stiffness_matrix():
    v, t = square()
    np.testing.assert_allclose(laplacian(v, t).toarray(), stiffness(v, t), atol=1e-9)


def test_laplacian_without_sound_triangles_is_zero():
    v = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    assert laplacian(v, np.array([[0, 1, 2]])).count_nonzero() == 0


def test_carried_displacement_is_harmonic():
    v, t = square(1)
    rows = np.flatnonzero(curve_vertices(t, len(v)))
    rng = np.random.default_rng(0)
    goal = rng.normal(size=(len(rows), 2)) * 1e-5
    after = carry(v, t, rows, goal, guard=False)
    np.testing.assert_array_equal(after[rows], goal)
    np.testing.assert_allclose(after - v, igl.harmonic(v, t, rows, goal - v[rows], 1), atol=1e-12)
    inside = np.setdiff1d(np.arange(len(v)), rows)
    np.testing.assert_allclose((stiffness(v, t) @ (after - v))[inside], 0, atol=1e-10)


def test_linear_motions_of_the_boundary_are_passed_on_exactly():
    v, t = square(2)
    on = curve_vertices(t, len(v))
    motion = np.array([[1.2, 0.3], [-0.1, 0.9]])
    np.testing.assert_allclose(carry(v, t, on, (v @ motion + 5)[on], guard=False), v @ motion + 5, atol=1e-12)


def test_mask_and_indices_in_any_order_say_the_same():
    v, t = square(3)
    on = curve_vertices(t, len(v))
    goal = v * 1.1
    order = np.random.default_rng(0).permutation(np.flatnonzero(on))
    np.testing.assert_array_equal(carry(v, t, on, goal[on]), carry(v, t, order, goal[order]))


def test_the_rest_of_the_boundary_stays():
    v, t = square(4)
    on = np.flatnonzero(curve_vertices(t, len(v)))
    after = carry(v, t, on[:3], v[on[:3]] + 0.01, guard=False)
    np.testing.assert_array_equal(after[on[3:]], v[on[3:]])
    assert (after != v).any(axis=1).sum() > 50


def test_regions_hold_their_interface():
    v, t = square(5)
    regions = (v[t].mean(axis=1)[:, 0] > 0.5).astype(int)
    interface = curve_vertices(t, len(v), regions) & ~curve_vertices(t, len(v))
    side = np.flatnonzero(v[:, 0] == 0)
    free, held = (carry(v, t, side, v[side] - [0.05, 0], regions=r, guard=False) for r in (None, regions))
    np.testing.assert_array_equal(held[interface], v[interface])
    assert (free[interface] != v[interface]).any()


def test_guard_puts_back_what_would_turn_over():
    v, t = square(6)
    corner = np.flatnonzero((v == 0).all(axis=1))
    wild = carry(v, t, corner, [[0.5, 0.5]], guard=False)
    kept = carry(v, t, corner, [[0.5, 0.5]])
    assert (areas(wild, t) < 0).any()
    assert (areas(kept, t) > 0).all()
    assert angles(kept, t).min() >= angles(v, t).min() - 1e-9
    np.testing.assert_array_equal(wild[corner], [[0.5, 0.5]])


def test_a_vertex_without_triangles_or_in_flat_ones_only_stays():
    v, t = square(7)
    v = np.r_[v, [[9.0, 9.0], [0.5, -1.0]]]
    t = np.r_[t, [[0, 1, len(v) - 1]]]
    v[-1] = (v[0] + v[1]) / 2  # a flat triangle on the bottom
    on = np.flatnonzero(curve_vertices(t, len(v)))
    after = carry(v, t, on, v[on] + 1.0, guard=False)
    np.testing.assert_array_equal(after[-2], v[-2])
    assert np.isfinite(after).all()


def test_nothing_moved_and_nothing_inside():
    v, t = square(8)
    np.testing.assert_array_equal(carry(v, t, [], np.zeros((0, 2))), v)
    triangle = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_array_equal(carry(triangle, [[0, 1, 2]], [0, 1, 2], triangle * 2), triangle * 2)


@pytest.mark.parametrize(
    ("moved", "positions", "message"),
    [
        ([0, 1], [[0, 0]], r"positions: expected shape \(2,\) or \(2, k\)"),
        ([0], [0.0], r"positions: expected shape \(1, 2\), found \(1,\)"),
        ([0], [[0, 0, 0]], r"positions: expected shape \(1, 2\), found \(1, 3\)"),
        ([999], [[0, 0]], "moved: expected indices from 0 to 189"),
        ([0], [[0, np.nan]], "positions: expected finite numbers"),
    ],
)
def test_what_cannot_be_carried(moved, positions, message):
    v, t = square(9)
    with pytest.raises(MeshError, match=message):
        carry(v, t, moved, positions)


def integral(v, t, u):
    return (areas(v, t) * u[t].mean(axis=1)).sum()


def test_field_smoothing_is_one_implicit_step():
    v, t = square(10)
    u = np.random.default_rng(0).normal(size=len(v))
    mass = np.diag(np.bincount(t.ravel(), np.repeat(areas(v, t) / 3, 3)))
    expected = np.linalg.solve(mass + 0.01 * stiffness(v, t), mass @ u)
    np.testing.assert_allclose(smooth_field(v, t, u, time=0.01), expected, atol=1e-10)


@pytest.mark.parametrize("time", [0, 1e-4, 1e-2, 1])
def test_field_smoothing_keeps_the_integral_and_adds_no_extremes(time):
    v, t = square(11)
    u = np.random.default_rng(1).normal(size=len(v))
    after = smooth_field(v, t, u, time=time)
    assert integral(v, t, after) == pytest.approx(integral(v, t, u), abs=1e-12)
    assert after.max() <= u.max() + 1e-12
    assert after.min() >= u.min() - 1e-12


def test_longer_time_smooths_more_down_to_the_mean():
    v, t = square(12)
    u = np.random.default_rng(2).normal(size=len(v))
    spread = [np.ptp(smooth_field(v, t, u, time=time)) for time in (0, 1e-4, 1e-2, 1, 1e3)]
    assert all(a > b for a, b in pairwise(spread))
    np.testing.assert_allclose(smooth_field(v, t, u, time=1e3), integral(v, t, u), atol=1e-3)


def test_several_fields_at_once():
    v, t = square(13)
    u = np.random.default_rng(3).normal(size=(len(v), 3))
    after = smooth_field(v, t, u, time=0.01)
    assert after.shape == u.shape
    for k in range(3):
        np.testing.assert_allclose(after[:, k], smooth_field(v, t, u[:, k], time=0.01), atol=1e-13)


def test_a_vertex_without_triangles_keeps_its_value():
    v, t = square(14)
    u = np.r_[np.random.default_rng(4).normal(size=len(v)), 7.0]
    assert smooth_field(np.r_[v, [[5.0, 5.0]]], t, u, time=1.0)[-1] == 7.0


def test_field_errors():
    v, t = square(15)
    with pytest.raises(ParameterError, match="time: expected a number of at least 0, found -1"):
        smooth_field(v, t, v[:, 0], time=-1)
    with pytest.raises(MeshError, match="values: expected shape"):
        smooth_field(v, t, [1.0], time=1)
