"""Uniform smoothing against the paper's own loop; cotangent smoothing, a fixed point; what each does to a graded mesh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import angles, areas
from scipy.linalg import eigh
from scipy.spatial import Delaunay

from img2tri.arrays import unique_edges
from img2tri.errors import MeshError, ParameterError
from img2tri.triangles.tools.cotangent_laplacian import laplacian
from img2tri.triangles.tools.cotangent_smoothing import DAMPING, cotangent
from img2tri.triangles.tools.laplacian_smoothing import uniform
from img2tri.triangles.tools.topology import curve_vertices


def counter_clockwise(points, triangles):
    triangles = triangles.astype(np.int64)
    clockwise = areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return triangles[areas(points, triangles) > 1e-9]


def scattered(seed=0, n=120):
    """Random points of the unit square, Delaunay."""
    points = np.random.default_rng(seed).random((n, 2))
    return points, counter_clockwise(points, Delaunay(points).simplices)


def ell():
    """An L, its six corners around one vertex inside; their mean lies outside."""
    points = np.array([[0, 0], [4, 0], [4, -1], [-1, -1], [-1, 4], [0, 4], [-0.4, -0.3]])
    i = np.arange(6)
    return points, np.stack([np.roll(i, -1), i, np.full(6, 6)], axis=1)


def graded(n=17):
    """A square grid whose cells grow from 0.015 to 0.5, in triangles."""
    s = np.linspace(0, 2, n) ** 2
    x, y = np.meshgrid(s, s)
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = i[:-1, :-1].ravel(), i[:-1, 1:].ravel(), i[1:, 1:].ravel(), i[1:, :-1].ravel()
    return np.stack([x.ravel(), y.ravel()], axis=1), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def papers_loop(points, triangles, fixed, iterations):
    """The listing: `find_neighbors` and `laplacian_smoothing`, the boundary points being those in `fixed`."""

    def find_neighbors(point_index):
        neighbors = set()
        for tri in triangles:
            if point_index in tri:
                neighbors.update(tri)
        if point_index in neighbors:
            neighbors.remove(point_index)
        return sorted(neighbors)

    for _ in range(iterations):
        new_points = np.copy(points)
        for i in range(len(points)):
            if i in fixed:
                continue
            neighbors = find_neighbors(i)
            if neighbors:
                new_points[i] = np.mean(points[neighbors], axis=0)
        points = new_points
    return points


@pytest.mark.parametrize("iterations", [0, 1, 3])
@pytest.mark.parametrize("make", [scattered, ell])
def test_uniform_is_the_papers_loop_bit_for_bit(make, iterations):
    v, t = make()
    v = np.r_[v, [[0.5, 0.5]]]  # a vertex that no triangle has
    held = set(np.flatnonzero(curve_vertices(t, len(v))).tolist())
    np.testing.assert_array_equal(uniform(v, t, iterations=iterations), papers_loop(v, t.tolist(), held, iterations))


@pytest.mark.parametrize("as_mask", [False, True])
def test_fixed_are_exactly_those_named(as_mask):
    v, t = scattered(1, 60)
    fixed = np.arange(0, len(v), 3)
    given = np.isin(np.arange(len(v)), fixed) if as_mask else fixed
    np.testing.assert_array_equal(uniform(v, t, iterations=2, fixed=given), papers_loop(v, t.tolist(), set(fixed.tolist()), 2))


@pytest.mark.parametrize("smooth", [uniform, lambda v, t, **o: cotangent(v, t, boundary="free", tolerance=0.1, guard=False, **o)])
def test_regions_make_a_difference(smooth):
    v, t = scattered(4)
    regions = (v[t].mean(axis=1)[:, 0] > 0.5).astype(int)
    assert (smooth(v, t) != smooth(v, t, regions=regions)).any()


def test_uniform_leaves_interfaces_where_they_are():
    v, t = scattered(4)
    regions = (v[t].mean(axis=1)[:, 0] > 0.5).astype(int)
    on = curve_vertices(t, len(v), regions)
    after = uniform(v, t, regions=regions)
    np.testing.assert_array_equal(after[on], v[on])
    assert (after[~on] != v[~on]).any(axis=1).all()


def test_uniform_in_the_papers_manner_turns_triangles_over_and_the_guard_does_not():
    v, t = ell()
    assert (areas(v, t) > 0).all()
    assert (areas(uniform(v, t), t) < 0).any()
    np.testing.assert_array_equal(uniform(v, t, guard=True), v)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 12))
def test_guarded_passes_never_lower_the_worst_angle(seed, iterations):
    v, t = scattered(seed, 60)
    after = uniform(v, t, iterations=iterations, guard=True)
    assert (areas(after, t) > 0).all()
    assert angles(after, t).min() >= angles(v, t).min() - 1e-9


def test_uniform_evens_out_a_scattered_mesh():
    v, t = scattered(5, 400)
    mean = [angles(uniform(v, t, iterations=k), t).min(axis=1).mean() for k in (0, 1, 10)]
    assert mean[0] + 3 < mean[1] < mean[2]


@pytest.mark.parametrize("guard", [False, True])
@pytest.mark.parametrize("iterations", [1, 10, 300])
@pytest.mark.parametrize(("stretch", "shift"), [(1, 0.0), (30, 0.0), (1, 1e6)])
def test_a_planar_mesh_is_a_fixed_point_of_cotangent_weights(stretch, shift, iterations, guard):
    """Stretched thirty times, most triangles are obtuse and many weights negative; far from the origin sums would cancel."""
    v, t = scattered(6)
    v = v * [stretch, 1] + shift
    after = cotangent(v, t, iterations=iterations, guard=guard)
    assert np.abs(after - v).max() <= 1e-12 * np.ptp(v)


def test_negative_weights_are_there_and_the_step_is_short_enough_for_them():
    """No eigenvalue of D^-1 L is above 3, so 1 - DAMPING * eigenvalue stays within -1 and 1, however obtuse the triangles."""
    largest = []
    for stretch in (1, 30):
        v, t = scattered(7)
        v = v * [stretch, 1]
        inside = np.flatnonzero(~curve_vertices(t, len(v)))
        L = laplacian(v, t).toarray()[np.ix_(inside, inside)]
        largest.append(eigh(L, np.diag(np.diag(L)), eigvals_only=True).max())
    assert np.triu(L, 1).max() > 1
    assert 2 < max(largest) <= 3
    assert DAMPING * 3 < 2


def test_cotangent_leaves_turned_over_and_flat_triangles_alone():
    v, t = ell()
    spoiled = uniform(v, t)
    assert (areas(spoiled, t) < 0).any()
    assert np.abs(cotangent(spoiled, t) - spoiled).max() < 1e-12
    v, t = scattered(8)
    edges, sides = unique_edges(t)
    edge = edges[np.flatnonzero(np.bincount(sides.ravel()) == 2)[0]]
    third = next(i for i in t[np.isin(t, edge).sum(axis=1) == 2][0] if i not in edge)
    v[third] = v[edge].mean(axis=0)
    assert np.abs(cotangent(v, t) - v).max() < 1e-12


def test_cotangent_keeps_the_grading_and_uniform_pulls_it_about():
    v, t = graded()
    edges = unique_edges(t)[0]

    def change(after):
        """Greatest factor between the lengths of an edge after and before."""
        length = [np.linalg.norm(np.diff(x[edges], axis=1)[:, 0], axis=1) for x in (v, after)]
        return np.exp(np.abs(np.log(length[1] / length[0])).max())

    assert change(cotangent(v, t, iterations=10)) < 1 + 1e-12
    assert change(uniform(v, t, iterations=10)) > 1.5
    assert change(uniform(v, t, iterations=100)) > change(uniform(v, t, iterations=10))


@pytest.mark.parametrize("smooth", [uniform, cotangent])
def test_arguments_stay_and_results_are_new(smooth):
    v, t = scattered(9)
    before = v.copy(), t.copy()
    for iterations in (0, 2):
        assert not np.shares_memory(smooth(v, t, iterations=iterations), v)
    np.testing.assert_array_equal(v, before[0])
    np.testing.assert_array_equal(t, before[1])
    np.testing.assert_array_equal(smooth(v, t, iterations=0), v)


@pytest.mark.parametrize("smooth", [uniform, cotangent])
def test_errors_at_the_door(smooth):
    v, t = scattered(10)
    with pytest.raises(ParameterError, match="iterations: expected a whole number of at least 0, found -1"):
        smooth(v, t, iterations=-1)
    with pytest.raises(MeshError, match="triangles: expected indices"):
        smooth(v, t + 1)
    with pytest.raises(MeshError, match="regions: expected one for each triangle"):
        smooth(v, t, regions=[1])


def test_errors_of_one_only():
    v, t = scattered(10)
    with pytest.raises(MeshError, match="fixed: expected indices from 0 to 119"):
        uniform(v, t, fixed=[120])
    with pytest.raises(ParameterError, match="boundary: expected one of 'fixed', 'free', found 'loose'"):
        cotangent(v, t, boundary="loose")
    with pytest.raises(ParameterError, match="tolerance: expected a length with boundary='free', found None"):
        cotangent(v, t, boundary="free")
