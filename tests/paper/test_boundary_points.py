"""Points spread along a ring, against the listing where the listing is right."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from benchmarks import listing
from benchmarks.shapes import blob
from hypothesis import given
from hypothesis import strategies as st

from img2tri.errors import ParameterError
from img2tri.paper.boundary_points import arc_length_samples
from img2tri.paper.contours import external_contours

STAR = np.array([[0.0, 0], [10, 2], [20, 0], [12, 9], [15, 20], [8, 12], [-3, 14], [2, 7]])
CONTOUR = external_contours(blob(128, holes=0))[0]


@pytest.mark.parametrize("boundary", [STAR, CONTOUR], ids=["star", "contour"])
@pytest.mark.parametrize("n", [1, 2, 3, 7, 20, 100, 333])
def test_the_points_are_those_of_the_listing(boundary, n):
    ours, theirs = arc_length_samples(boundary, n), listing.distribute_boundary_points(boundary, n)
    assert len(ours) == n
    # The listing loses its last point to rounding in every other case, and repeats the first.
    lost = n - len(theirs[:n]) + int(len(theirs) == n and n > 1 and np.array_equal(theirs[-1], theirs[0]))
    assert lost in (0, 1)
    np.testing.assert_allclose(ours[: n - lost], theirs[: n - lost], atol=1e-9)
    if n > 2:
        np.testing.assert_array_equal(theirs[-1], theirs[0])
        assert not np.array_equal(ours[-1], ours[0])


@given(st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=2, max_size=12), st.integers(1, 60))
def test_steps_along_the_ring_are_equal(corners, n):
    ring = np.array(corners, float)
    if (ring == ring[0]).all():
        return
    points = arc_length_samples(ring, n)
    assert points.shape == (n, 2)
    np.testing.assert_allclose(points[-1], ring[0], atol=1e-9)
    line = shapely.LinearRing(np.concatenate([ring, ring[:1]])) if len(ring) > 2 else shapely.LineString(ring[[0, 1, 0]])
    assert shapely.distance(line, shapely.points(points)).max() < 1e-9
    # By the definition: walk the ring, as finely as the corners and the points.
    arcs = np.arange(1, n + 1) * (line.length / n)
    expected = shapely.get_coordinates(shapely.line_interpolate_point(line, arcs))
    np.testing.assert_allclose(points, expected, atol=1e-8)


def test_a_closed_ring_is_the_same_ring():
    np.testing.assert_allclose(arc_length_samples(np.concatenate([STAR, STAR[:1]]), 17), arc_length_samples(STAR, 17), atol=1e-12)


def test_repeated_corners_make_no_difference():
    np.testing.assert_allclose(arc_length_samples(np.repeat(STAR, 3, axis=0), 17), arc_length_samples(STAR, 17), atol=1e-12)


def test_the_argument_is_left_as_it_is():
    ring = STAR.copy()
    arc_length_samples(ring, 9)
    np.testing.assert_array_equal(ring, STAR)


@pytest.mark.parametrize("n", [0, -1, 2.5, None])
def test_a_wrong_number(n):
    with pytest.raises(ParameterError, match="n_points: expected a whole number of at least 1"):
        arc_length_samples(STAR, n)


@pytest.mark.parametrize("boundary", [[], [[0, 0]], [[0, 0, 0], [1, 1, 1]], [[0, 0], [np.inf, 1]]])
def test_a_wrong_boundary(boundary):
    with pytest.raises(ParameterError, match="boundary: expected at least two finite points"):
        arc_length_samples(boundary, 5)


def test_a_boundary_without_length():
    with pytest.raises(ParameterError, match="boundary: expected a ring with a length"):
        arc_length_samples([[1, 1], [1, 1], [1, 1]], 5)
