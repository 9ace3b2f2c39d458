"""Constrained Delaunay triangulation: every face is the region its segments say, or the network is refused."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from networks import area_of_ring, network, ring
from scipy.spatial import Delaunay

from img2tri.triangles.generate.constrained_delaunay import PslgError, ruppert, triangulate

NESTED = network((ring(40, 10), 5, 0), (ring(30, 7), 0, 5), (ring(20, 4), -3, 0), (ring(12, 2), 9, -3))


def region_areas(vertices, triangles, regions):
    a = oracles.areas(vertices, triangles)
    assert (a > 0).all()
    return {int(r): a[regions == r].sum() for r in np.unique(regions)}


def expected_areas():
    a = [area_of_ring(n, r) for n, r in ((40, 10), (30, 7), (20, 4), (12, 2))]
    return {5: a[0] - a[1], -3: a[2] - a[3], 9: a[3]}


def test_rings_within_rings_are_regions_holes_and_islands():
    found = region_areas(NESTED[0], *triangulate(*NESTED))
    assert found == pytest.approx(expected_areas(), rel=1e-12)


def test_every_segment_is_an_edge():
    triangles, _ = triangulate(*NESTED)
    edges = set(map(tuple, oracles.edge_counts(triangles)[0].tolist()))
    assert all(tuple(sorted(s)) in edges for s in NESTED[1].tolist())


def test_without_segments_inside_the_triangles_are_those_of_delaunay():
    rng = np.random.default_rng(3)
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    points = np.concatenate([square, rng.uniform(0.05, 0.95, (300, 2))])
    outline = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    triangles, _ = triangulate(points, outline, np.ones(4, int), np.zeros(4, int))
    expected = Delaunay(points).simplices
    assert set(map(tuple, np.sort(triangles, axis=1).tolist())) == set(map(tuple, np.sort(expected, axis=1).tolist()))


@pytest.mark.parametrize("turned", [False, True])
def test_a_segment_may_run_either_way(turned):
    points, segments, left, right = NESTED
    if turned:
        segments, left, right = segments[:, ::-1], right, left
    assert region_areas(points, *triangulate(points, segments, left, right)) == pytest.approx(expected_areas(), rel=1e-12)


def test_a_segment_on_the_wrong_side_is_found():
    points, segments, left, right = NESTED
    left = left.copy()
    left[45] = 6
    with pytest.raises(PslgError, match="one region on each face") as caught:
        triangulate(points, segments, left, right)
    assert set(caught.value.segments) & set(range(40, 70))


def test_an_outline_outside_of_its_region_is_found():
    points, segments, left, right = network((ring(20, 5), 1, 0), (ring(8, 1, (9, 0)), 0, 1))
    with pytest.raises(PslgError, match="disagree"):
        triangulate(points, segments, left, right)


def test_crossing_segments():
    with pytest.raises(PslgError, match="planar"):
        triangulate(*network((ring(20, 5), 1, 0), (ring(20, 5, (3, 0)), 1, 0)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p, s: (np.concatenate([p, p[:1]]), s), "planar"),
        (lambda p, s: (np.where(np.arange(len(p))[:, None] == 2, np.nan, p), s), "finite"),
        (lambda p, s: (p, np.where(s == 3, 1000, s)), "indices of 102 points"),
        (lambda p, s: (p, np.where(s == 3, -1, s)), "indices of 102 points"),
        (lambda p, s: (p, np.where(s == 3, 2, s)), "two different points"),
        (lambda p, s: (p[:, :1], s), "shape"),
        (lambda p, s: (p, s[:-1]), "segments, left, right"),
    ],
)
def test_what_is_no_network_is_refused(change, message):
    points, segments = change(*NESTED[:2])
    with pytest.raises(PslgError, match=message):
        triangulate(points, segments, *NESTED[2:])


def test_a_point_on_a_segment():
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0]])
    outline = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    with pytest.raises(PslgError, match="no point on them"):
        triangulate(points, outline, np.ones(4, int), np.zeros(4, int))


def test_refined_triangles_have_the_angle_and_the_regions():
    net = ruppert(*NESTED, 30.0, 1e-3)
    assert oracles.angles(net.vertices, net.triangles).min() >= 30 - 1e-9
    assert region_areas(net.vertices, net.triangles, net.regions) == pytest.approx(expected_areas(), rel=1e-9)
    assert (net.vertices[: len(NESTED[0])] == NESTED[0]).all()


def test_the_least_angle_asked_for_changes_the_triangles():
    assert len(ruppert(*NESTED, 30.0, 1e-3).triangles) > len(ruppert(*NESTED, 20.0, 1e-3).triangles)


def test_the_least_edge_stops_refinement():
    thin = network((np.array([[0.0, 0], [10, 0], [10, 0.1], [0, 1.0]]), 1, 0))
    assert len(ruppert(*thin, 30.0, 1e-3).triangles) > len(ruppert(*thin, 30.0, 2.0).triangles)


def test_pieces_of_split_segments_make_up_the_segment():
    points, segments, left, right = network((ring(60, 10), 1, 0), (ring(60, 8.8, (1, 0)), 0, 1))
    net = ruppert(points, segments, left, right, 30.0, 1e-3)
    assert len(net.segments) > len(segments)
    along = net.vertices[net.segments[:, 1]] - net.vertices[net.segments[:, 0]]
    whole = points[segments[:, 1]] - points[segments[:, 0]]
    sums = np.stack([np.bincount(net.origin, along[:, k], minlength=len(segments)) for k in range(2)], axis=1)
    assert sums == pytest.approx(whole, abs=1e-12)
    lengths = np.bincount(net.origin, np.linalg.norm(along, axis=1))
    assert lengths == pytest.approx(np.linalg.norm(whole, axis=1), abs=1e-12)
