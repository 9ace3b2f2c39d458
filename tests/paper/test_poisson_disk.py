"""Poisson-disk points: both distances kept, the region full, always an end."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from benchmarks import listing
from benchmarks.shapes import blob
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Voronoi, cKDTree
from scipy.spatial.distance import cdist, pdist
from scipy.stats import kstest

from img2tri.errors import ParameterError
from img2tri.paper import poisson_disk as poisson
from img2tri.paper.boundary_points import arc_length_samples
from img2tri.paper.contours import contour_polygon, external_contours
from img2tri.paper.poisson_disk import poisson_disk

SQUARE = shapely.box(0, 0, 40, 40)
CONTOUR = external_contours(blob(256, holes=0))[0]
REGIONS = {
    "square": SQUARE,
    "far away": shapely.box(1e6, -1e6, 1e6 + 30, -1e6 + 50),
    "blob": contour_polygon(CONTOUR),
    "ring": shapely.Point(20, 20).buffer(20).difference(shapely.Point(20, 20).buffer(8)),
    "two parts": shapely.union(SQUARE, shapely.box(60, 10, 62, 70)),
    "needle": shapely.Polygon([(0, 0), (100, 1), (0, 2)]),
    "speck": shapely.box(0, 0, 0.01, 0.01),
}


def coasts(region, spacing):
    """Points along all rings of a region."""
    rings = [ring for part in shapely.get_parts(region) for ring in (part.exterior, *part.interiors)]
    return np.concatenate([arc_length_samples(shapely.get_coordinates(ring), max(3, round(ring.length / spacing))) for ring in rings])


def check_distances(points, region, boundary, distance, to_boundary):
    assert shapely.contains_xy(region, points[:, 0], points[:, 1]).all()
    # The listing's own terms: np.min(cdist(...)) > min_dist.
    if len(points) > 1:
        assert (pdist(points).min() if len(points) < 3000 else cKDTree(points).query(points, k=2)[0][:, 1].min()) > distance
    if len(points) and len(boundary):
        assert cdist(points, boundary).min() > to_boundary


def room_left(points, region, distance):
    """Places inside whose distance to the nearest point is largest, and more: whatever of them is further than `distance`."""
    corners = shapely.get_coordinates(region)
    tried = np.random.default_rng(0).uniform(*np.reshape(region.bounds, (2, 2)), (20_000, 2))
    places = [corners, tried] + ([Voronoi(points).vertices] if len(points) > 3 else [])
    places = np.concatenate(places)
    places = places[shapely.intersects_xy(region, places[:, 0], places[:, 1])]
    return places[cKDTree(points).query(places)[0] > distance * (1 + 1e-5)]


@pytest.mark.parametrize("to_boundary", [0, 0.4, 1.0, 3.7])
@pytest.mark.parametrize("name", REGIONS)
def test_both_distances_are_kept(name, to_boundary):
    region, distance = REGIONS[name], 1.3
    boundary = coasts(region, 1.1)
    points = poisson_disk(region, boundary, min_distance=distance, min_distance_to_boundary=to_boundary)
    check_distances(points, region, boundary, distance, to_boundary)


@pytest.mark.parametrize("distance", [0.7, 2.0, 9.0])
@pytest.mark.parametrize("name", ["square", "blob", "ring", "two parts"])
def test_the_region_is_full(name, distance):
    region = REGIONS[name]
    boundary = coasts(region, distance)
    points = poisson_disk(region, boundary, min_distance=distance, min_distance_to_boundary=distance)
    # With both distances alike, room is wherever all points, of either kind, are further than that: Voronoi corners are the worst places.
    assert len(room_left(np.concatenate([points, boundary]), region, distance)) == 0
    alone = poisson_disk(region, [], min_distance=distance, min_distance_to_boundary=distance)
    assert len(room_left(alone, region, distance)) == 0
    check_distances(alone, region, [], distance, 0)


def test_a_full_region_has_the_number_of_points_that_random_packing_has():
    points = poisson_disk(shapely.box(0, 0, 300, 300), [], min_distance=1, min_distance_to_boundary=0)
    # Discs of diameter 1 dropped one after another cover 0.547 of the plane when no more fit; those at the border stick out.
    assert len(points) * np.pi / 4 / 301**2 == pytest.approx(0.547, abs=0.003)


@given(
    st.lists(st.tuples(st.integers(-20, 20), st.integers(-20, 20)), min_size=3, max_size=7, unique=True),
    st.floats(0.5, 30),
    st.floats(0, 10),
    st.integers(0, 2**32),
)
@settings(deadline=None, max_examples=60)
def test_any_region_is_filled(corners, distance, to_boundary, seed):
    region = shapely.convex_hull(shapely.multipoints(np.array(corners, float)))
    if region.area == 0:
        return
    boundary = coasts(region, 3)
    points = poisson_disk(region, boundary, min_distance=distance, min_distance_to_boundary=to_boundary, seed=seed)
    check_distances(points, region, boundary, distance, to_boundary)
    x = np.random.default_rng(seed).uniform(*np.reshape(region.bounds, (2, 2)), (3000, 2))
    x = x[shapely.contains_xy(region, x[:, 0], x[:, 1])]
    room = cdist(x, boundary).min(axis=1) > to_boundary + 1e-4
    room &= cdist(x, points).min(axis=1) > distance + 1e-4 if len(points) else True
    assert not room.any()


def test_as_many_as_wanted():
    kept = poisson_disk(SQUARE, [], min_distance=1, min_distance_to_boundary=0, n_points=123)
    assert kept.shape == (123, 2)
    check_distances(kept, SQUARE, [], 1, 0)
    assert poisson_disk(SQUARE, [], min_distance=1, min_distance_to_boundary=0, n_points=0).shape == (0, 2)


def test_it_ends_where_the_listing_would_not():
    boundary = coasts(SQUARE, 2)
    full = poisson_disk(SQUARE, boundary, min_distance=2, min_distance_to_boundary=2)
    more = poisson_disk(SQUARE, boundary, min_distance=2, min_distance_to_boundary=2, n_points=10**6)
    assert len(more) == pytest.approx(len(full), rel=0.05)
    assert len(poisson_disk(SQUARE, boundary, min_distance=100, min_distance_to_boundary=0, n_points=50)) == 1
    assert len(poisson_disk(SQUARE, boundary, min_distance=1, min_distance_to_boundary=100, n_points=50)) == 0


def test_a_full_region_holds_more_than_the_listing_finds():
    boundary = coasts(SQUARE, 4)
    full = poisson_disk(SQUARE, boundary, min_distance=3, min_distance_to_boundary=3)
    ring = shapely.get_coordinates(SQUARE)
    theirs = listing.poisson_disk_sampling(ring, boundary, 3, round(0.85 * len(full)), 3, np.random.default_rng(0))
    check_distances(theirs, SQUARE, boundary, 3, 3)
    ours = poisson_disk(ring[:-1], boundary, min_distance=3, min_distance_to_boundary=3, n_points=len(theirs))
    assert len(ours) == len(theirs)
    check_distances(ours, SQUARE, boundary, 3, 3)


def test_the_first_darts_fall_evenly():
    first = np.concatenate([poisson_disk(SQUARE, [], min_distance=3, min_distance_to_boundary=0, n_points=3, seed=s) for s in range(300)])
    assert kstest(first[:, 0] / 40, "uniform").pvalue > 0.01
    assert kstest(first[:, 1] / 40, "uniform").pvalue > 0.01


def test_the_seed_decides():
    options = {"min_distance": 2, "min_distance_to_boundary": 1}
    one, same, other = (poisson_disk(REGIONS["ring"], [], seed=s, **options) for s in (5, 5, 6))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one[:10], other[:10])


def test_a_ring_of_corners_is_a_region():
    corners = shapely.get_coordinates(SQUARE)[:-1]
    options = {"min_distance": 2, "min_distance_to_boundary": 1}
    np.testing.assert_array_equal(poisson_disk(corners, corners, **options), poisson_disk(shapely.Polygon(corners), corners, **options))


def test_each_distance_matters():
    boundary = coasts(SQUARE, 1)
    base = poisson_disk(SQUARE, boundary, min_distance=2, min_distance_to_boundary=1)
    assert len(poisson_disk(SQUARE, boundary, min_distance=4, min_distance_to_boundary=1)) < len(base) / 2
    further = poisson_disk(SQUARE, boundary, min_distance=2, min_distance_to_boundary=8)
    assert SQUARE.buffer(-7.9).covers(shapely.multipoints(further))


def test_no_distance_at_all():
    points = poisson_disk(SQUARE, SQUARE.exterior.coords, min_distance=0, min_distance_to_boundary=0, n_points=5000)
    assert len(np.unique(points, axis=0)) == 5000


def test_a_region_without_area_holds_nothing():
    flat = [[0, 0], [1, 1], [2, 2]]
    with pytest.raises(ParameterError, match="region: expected a valid polygon"):
        poisson_disk(flat, [], min_distance=1, min_distance_to_boundary=0)
    assert poisson_disk(shapely.Polygon(), [], min_distance=1, min_distance_to_boundary=0).shape == (0, 2)


def test_too_small_a_distance_to_fit_in_memory():
    with pytest.raises(ParameterError, match=r"min_distance: expected at least .* for a region 40 x 40, found 1e-06"):
        poisson_disk(SQUARE, [], min_distance=1e-6, min_distance_to_boundary=0)
    with pytest.raises(ParameterError, match="min_distance: expected at least"):
        poisson_disk(SQUARE, [], min_distance=0, min_distance_to_boundary=0)


@pytest.mark.parametrize("wrong", [-1, np.nan, np.inf, "far", None])
@pytest.mark.parametrize("name", ["min_distance", "min_distance_to_boundary"])
def test_a_wrong_distance(name, wrong):
    with pytest.raises(ParameterError, match=f"{name}: expected a number of at least 0"):
        poisson_disk(SQUARE, [], **{"min_distance": 1, "min_distance_to_boundary": 1, name: wrong})


@pytest.mark.parametrize(("name", "wrong"), [("n_points", -1), ("n_points", 1.5), ("seed", -1), ("seed", None)])
def test_a_wrong_number(name, wrong):
    with pytest.raises(ParameterError, match=f"{name}: expected a whole number"):
        poisson_disk(SQUARE, [], min_distance=1, min_distance_to_boundary=1, **{name: wrong})


def test_wrong_points():
    with pytest.raises(ParameterError, match="boundary_points: expected at least 0 finite points"):
        poisson_disk(SQUARE, [[0, np.nan]], min_distance=1, min_distance_to_boundary=1)
    with pytest.raises(ParameterError, match="region: expected at least 3 finite points"):
        poisson_disk([[0, 0], [1, 1]], [], min_distance=1, min_distance_to_boundary=1)


def test_a_region_that_crosses_itself():
    with pytest.raises(ParameterError, match=r"region: expected a valid polygon, found .*Self-intersection"):
        poisson_disk([[0, 0], [4, 4], [4, 0], [0, 4]], [], min_distance=1, min_distance_to_boundary=1)


def test_it_ends_where_there_is_room_in_cells_split_as_often_as_they_are(monkeypatch):
    full = poisson_disk(SQUARE, coasts(SQUARE, 1.0), min_distance=1.0, min_distance_to_boundary=0.5)
    monkeypatch.setattr(poisson, "DEPTH", 0)
    some = poisson_disk(SQUARE, coasts(SQUARE, 1.0), min_distance=1.0, min_distance_to_boundary=0.5)
    check_distances(some, SQUARE, coasts(SQUARE, 1.0), 1.0, 0.5)
    assert 0.3 * len(full) < len(some) < 0.9 * len(full)
