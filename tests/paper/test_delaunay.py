"""The paper's triangles, against scipy and the listing."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
from benchmarks import listing
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, Delaunay

from img2tri.errors import MeshError
from img2tri.paper.delaunay import centroid_filter, delaunay, without_unused


def scattered(n, seed=0):
    return np.random.default_rng(seed).random((n, 2)) * 100


def as_set(triangles):
    return set(map(tuple, np.sort(triangles, axis=1).tolist()))


@pytest.mark.parametrize("n", [3, 4, 10, 100, 3000])
def test_the_triangles_are_those_of_scipy(n):
    points = scattered(n)
    triangles = delaunay(points)
    assert triangles.dtype == np.int64
    assert as_set(triangles) == as_set(Delaunay(points).simplices)
    assert (oracles.areas(points, triangles) > 0).all()


@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=3, max_size=40, unique=True))
def test_points_of_a_grid(corners):
    points = np.array(corners, float)
    try:
        triangles = delaunay(points)
    except MeshError:
        assert np.linalg.matrix_rank(points - points[0]) < 2
        return
    area = oracles.areas(points, triangles)
    assert (area > 0).all()
    assert area.sum() == pytest.approx(ConvexHull(points).volume)
    assert len(np.unique(triangles)) == len(points)
    # No point lies inside a circumcircle; those of a grid often lie on it.
    a, b, c = points[triangles].transpose(1, 0, 2)
    for p in points:
        u, v, w = a - p, b - p, c - p
        columns = [np.concatenate([d, (d**2).sum(axis=1)[:, None]], axis=1) for d in (u, v, w)]
        assert np.linalg.det(np.stack(columns, axis=1)).max() < 1e-6


def test_a_grid_of_the_paper():
    x, y = np.meshgrid(np.arange(0, 500, 10), np.arange(0, 300, 10))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    triangles = delaunay(points)
    assert len(triangles) == 2 * 49 * 29
    assert (oracles.areas(points, triangles) == 50).all()


@pytest.mark.parametrize("points", [[[0, 0], [1, 1]], [], [[0, 0, 0]] * 3, [0, 1, 2]])
def test_too_few_points(points):
    with pytest.raises(MeshError, match="points: expected at least three"):
        delaunay(points)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_points_that_are_nowhere(bad):
    with pytest.raises(MeshError, match="points: expected finite coordinates"):
        delaunay([[0, 0], [1, 0], [0, bad]])


def test_repeated_points():
    with pytest.raises(MeshError, match=r"points: expected each once, found 2 repeated, the first at \[0.0, 0.0\]; keep one of each"):
        delaunay([[5, 5], [0, 0], [1, 0], [0, 1], [0, 0], [5, 5]])


@pytest.mark.parametrize("points", [[[0, 0], [1, 1], [5, 5]], [[2, 7], [2, 8], [2, 10], [2, -3]]])
def test_points_on_one_line(points):
    with pytest.raises(MeshError, match="on one line"):
        delaunay(points)


@pytest.mark.parametrize("seed", range(3))
def test_the_filter_is_that_of_the_listing(seed):
    points = scattered(200, seed)
    polygon = shapely.Point(50, 50).buffer(40).difference(shapely.box(40, 40, 70, 55))
    tri = Delaunay(points)
    kept = centroid_filter(points, tri.simplices, polygon)
    np.testing.assert_array_equal(kept, listing.valid_triangles(tri, points, polygon))
    assert 0 < len(kept) < len(tri.simplices)


def test_the_filter_looks_at_the_centroid_only():
    points = [[0, 0], [9, 0], [0, 9]]
    assert len(centroid_filter(points, [[0, 1, 2]], shapely.box(2.9, 2.9, 3.1, 3.1))) == 1
    assert len(centroid_filter(points, [[0, 1, 2]], shapely.box(3.1, 3.1, 9, 9))) == 0
    assert len(centroid_filter(points, [[0, 1, 2]], shapely.Polygon())) == 0


def test_no_triangles_to_filter():
    assert centroid_filter([[0, 0]], [], shapely.box(0, 0, 1, 1)).shape == (0, 3)


def test_triangles_of_other_points():
    with pytest.raises(MeshError, match="triangles: expected indices from 0 to 2"):
        centroid_filter([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]], shapely.box(0, 0, 1, 1))


def test_points_that_are_no_corners_are_left_out():
    points = scattered(50)
    triangles = delaunay(points)[::7]
    used, renumbered = without_unused(points, triangles)
    np.testing.assert_array_equal(points[used][renumbered], points[triangles])
    assert np.array_equal(np.unique(renumbered), np.arange(len(used)))
