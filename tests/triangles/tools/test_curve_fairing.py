"""Free boundaries: pixel steps go, and form, frame, junctions, tolerance, areas and topology stay."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import angles, areas, check_valid

from img2tri.errors import MeshError, ParameterError
from img2tri.triangles.generate.constrained_delaunay import triangulate
from img2tri.triangles.tools.cotangent_smoothing import cotangent
from img2tri.triangles.tools.curve_fairing import _limits, fair_curves
from img2tri.triangles.tools.topology import boundary_edges, curve_vertices, interface_edges


def meshed(points, segments, left, right, spacing):
    """Triangles of a network of segments, with a lattice of vertices inside that keeps clear of it."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = np.meshgrid(np.arange(low[0], high[0], spacing), np.arange(low[1], high[1], spacing * 0.866))
    x[::2] += spacing / 2
    lattice = np.stack([x.ravel(), y.ravel()], axis=1)
    clear = shapely.distance(shapely.multilinestrings(points[segments]), shapely.points(lattice)) > 0.6 * spacing
    everything = np.concatenate([points, lattice[clear]])
    triangles, regions = triangulate(everything, segments, np.asarray(left), np.asarray(right))
    used, triangles = np.unique(triangles, return_inverse=True)
    return everything[used], triangles.reshape(-1, 3), regions


def ring(points):
    i = np.arange(len(points))
    return np.stack([i, np.roll(i, -1)], axis=1)


def rough_disc(radius=40.0, spacing=4.0, roughness=0.3, seed=0):
    """A disc around the origin, its boundary vertices off by up to `roughness`."""
    n = round(2 * np.pi * radius / spacing)
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = radius + np.random.default_rng(seed).uniform(-roughness, roughness, n)
    points = np.stack([r * np.cos(t), r * np.sin(t)], axis=1)
    return meshed(points, ring(points), np.ones(n, int), np.zeros(n, int), spacing)[:2]


def two_regions(seed=0, oblique=0.0, roughness=0.3):
    """The frame 40 x 30 with an interface from bottom to top, vertices unevenly spaced along it."""
    rng = np.random.default_rng(seed)
    s = np.r_[0, np.cumsum(rng.uniform(1.5, 3.5, 9))]
    s = s / s[-1]
    line = np.stack([20 + oblique * (s - 0.5) + rng.uniform(-roughness, roughness, 10), 30 * s], axis=1)
    corners = np.array([[0, 0], [40, 0], [40, 30], [0, 30.0]])
    points = np.concatenate([corners, line])
    segments = np.array([[0, 4], [4, 1], [1, 2], [2, 13], [13, 3], [3, 0]] + [[k, k + 1] for k in range(4, 13)])
    left = [1, 2, 2, 2, 1, 1] + [1] * 9
    right = [0] * 6 + [2] * 9
    frame = [np.linspace(points[a], points[b], 6)[1:-1] for a, b in segments[:6]]  # vertices along the frame
    cut, k = [], len(points)
    for i, (a, b) in enumerate(segments[:6]):
        chain = [a, *range(k, k + 4), b]
        cut += [(*pair, left[i]) for pair in pairwise(chain)]
        k += 4
    every = np.array([c[:2] for c in cut] + segments[6:].tolist())
    return meshed(np.concatenate([points, *frame]), every, [c[2] for c in cut] + left[6:], [0] * len(cut) + right[6:], 3.0)


FRAME = (0.0, 0.0, 40.0, 30.0)


def roughness(v, t):
    r = np.hypot(*v[curve_vertices(t, len(v))].T)
    return np.sqrt(((r - r.mean()) ** 2).mean())


def test_pixel_steps_are_rounded_off_within_the_tolerance():
    v, t = rough_disc()
    after = cotangent(v, t, boundary="free", tolerance=0.5)
    assert roughness(after, t) < 0.75 * roughness(v, t)
    on = curve_vertices(t, len(v))
    assert np.linalg.norm(after - v, axis=1)[on].max() <= 0.5 * (1 + 1e-12)
    assert areas(after, t).sum() == pytest.approx(areas(v, t).sum(), rel=1e-4)
    assert angles(after, t).min() >= angles(v, t).min() - 1e-9
    check_valid(after, t)


def test_the_inside_follows():
    v, t = rough_disc()
    inside = ~curve_vertices(t, len(v))
    moved = np.linalg.norm(cotangent(v, t, boundary="free", tolerance=0.5) - v, axis=1)
    near = inside & (np.hypot(*v.T) > 30)
    far = inside & (np.hypot(*v.T) < 10)
    assert 0.02 < moved[near].max() < 0.5
    assert moved[far].max() < 0.01
    np.testing.assert_array_equal(fair_curves(v, t, tolerance=0.5)[inside], v[inside])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.floats(0, 3), st.floats(0.5, 100), st.integers(0, 4))
def test_no_vertex_of_a_curve_leaves_its_tolerance(seed, tolerance, width, iterations):
    v, t, regions = two_regions(seed)
    after = fair_curves(v, t, tolerance=tolerance, width=width, iterations=iterations, regions=regions, bounds=FRAME)
    assert np.linalg.norm(after - v, axis=1).max() <= tolerance + 1e-12
    assert np.isfinite(after).all()


@pytest.mark.parametrize(
    ("option", "less", "more"),
    [("tolerance", 0.05, 0.5), ("width", 4.0, 40.0), ("iterations", 1, 10)],
)
def test_more_is_smoother(option, less, more):
    v, t = rough_disc(roughness=0.25)
    given_ = {"tolerance": 0.5, "width": 16.0, "iterations": 3}
    one, other = (roughness(fair_curves(v, t, **given_ | {option: value}), t) for value in (less, more))
    assert other < 0.9 * one < roughness(v, t)


def test_no_tolerance_no_motion():
    v, t = rough_disc()
    np.testing.assert_array_equal(cotangent(v, t, boundary="free", tolerance=0), v)
    np.testing.assert_array_equal(cotangent(v, t, boundary="free", tolerance=0.5, iterations=0), v)


def test_width_as_documented():
    """One pass takes (1 + (w / width)^4)^-2 of a wave of length w, here on a long straight line with fine vertices."""
    x = np.linspace(0, 96, 385)
    line = np.stack([x, 0.05 * np.sin(2 * np.pi * x / 12)], axis=1)
    points = np.concatenate([line, [[96, 20], [0, 20]]])
    v, t, _ = meshed(points, ring(points), np.ones(len(points), int), np.zeros(len(points), int), 4.0)
    bottom = (v[:, 1] < 1) & (v[:, 0] > 36) & (v[:, 0] < 60)
    for width, taken in ((12.0, 1 / 4), (6.0, 1 / 17**2), (24.0, (16 / 17) ** 2)):
        after = fair_curves(v, t, tolerance=1.0, width=width, iterations=1)
        assert 1 - np.ptp(after[bottom, 1]) / np.ptp(v[bottom, 1]) == pytest.approx(taken, abs=0.02)


@pytest.mark.parametrize("radius", [3, 6, 12, 40])
def test_discs_stay_round_and_keep_their_area(radius):
    v, t = rough_disc(radius, 1.0, 0.2)
    after = fair_curves(v, t, tolerance=0.5)
    assert roughness(after, t) < 0.65 * roughness(v, t)
    assert areas(after, t).sum() == pytest.approx(areas(v, t).sum(), rel=3e-3)


@pytest.mark.parametrize("seed", range(5))
def test_the_frame_stays_flat_and_the_interface_slides_along_it(seed):
    v, t, regions = two_regions(seed)
    after = cotangent(v, t, boundary="free", tolerance=0.5, regions=regions, bounds=FRAME, guard=False)
    for side, value in ((0, 0), (0, 40), (1, 0), (1, 30)):
        on = v[:, side] == value
        assert (after[on, side] == value).all()
    moved = (after != v).any(axis=1) & curve_vertices(t, len(v), regions)
    interface = np.zeros(len(v), bool)
    interface[interface_edges(t, regions)] = True
    assert (moved == interface).all()
    ends = interface & ((v[:, 1] == 0) | (v[:, 1] == 30))
    assert (after[ends, 0] != v[ends, 0]).all()
    x = after[interface][np.argsort(after[interface, 1]), 0]
    assert np.abs(np.diff(x, 2)).max() < 0.5 * np.abs(np.diff(v[interface][np.argsort(v[interface, 1]), 0], 2)).max()
    before_area, after_area = (np.bincount(regions, areas(p, t)) for p in (v, after))
    np.testing.assert_allclose(after_area[1:], before_area[1:], rtol=1e-3)


def test_without_bounds_the_frame_is_a_boundary_like_any():
    v, t, regions = two_regions()
    corner = (v == 0).all(axis=1)
    with_bounds, without = (fair_curves(v, t, tolerance=0.5, regions=regions, bounds=b) for b in (FRAME, None))
    assert (with_bounds[corner] == 0).all()
    assert (without[corner] > 0.05).all()


def test_nothing_but_frame_stays_as_it_is():
    v, t, _ = two_regions()
    np.testing.assert_array_equal(cotangent(v, t, boundary="free", tolerance=0.5, bounds=FRAME), v)


@pytest.mark.parametrize("oblique", [0.0, 12.0])
def test_a_straight_interface_stays_however_its_vertices_are_spaced(oblique):
    v, t, regions = two_regions(1, oblique, roughness=0.0)
    after = fair_curves(v, t, tolerance=0.5, regions=regions, bounds=FRAME)
    np.testing.assert_allclose(after, v, atol=1e-9)


def test_vertices_that_coincide_do_no_harm():
    v, t = rough_disc(10)
    i, j = boundary_edges(t)[0]
    v[i] = v[j]
    after = cotangent(v, t, boundary="free", tolerance=0.5)
    assert np.isfinite(after).all()
    assert np.linalg.norm(after - v, axis=1).max() <= 0.5 + 1e-12


def test_junctions_stay():
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    rim = 20 * np.stack([np.cos(t), np.sin(t)], axis=1)
    rng = np.random.default_rng(0)
    spokes = [np.linspace(rim[20 * k], [0, 0], 9)[1:-1] + rng.uniform(-0.3, 0.3, (7, 2)) for k in range(3)]
    points = np.concatenate([rim, [[0, 0]], *spokes])
    segments, left, right = ring(rim).tolist(), [1 + i // 20 for i in range(60)], [0] * 60
    for k in range(3):
        chain = [20 * k, *range(61 + 7 * k, 68 + 7 * k), 60]
        segments += [[a, b] for a, b in pairwise(chain)]
        left += [1 + (k + 2) % 3] * 8
        right += [1 + k] * 8
    v, tri, regions = meshed(points, np.array(segments), left, right, 3.0)
    after = fair_curves(v, tri, tolerance=0.5, regions=regions)
    junctions = (v == 0).all(axis=1) | np.isin(v, rim[::20]).all(axis=1)
    assert junctions.sum() == 4
    np.testing.assert_array_equal(after[junctions], v[junctions])
    others = curve_vertices(tri, len(v), regions) & ~junctions
    assert (after[others] != v[others]).any(axis=1).all()
    np.testing.assert_allclose(np.bincount(regions, areas(after, tri)), np.bincount(regions, areas(v, tri)), rtol=1e-3)


@pytest.mark.parametrize("gap", [0.02, 0.4, 1.0])
@pytest.mark.parametrize("seed", range(4))
def test_curves_close_to_each_other_never_touch(seed, gap):
    """Two rough bars with a narrow gap of background between them, which no triangle guards, and a tolerance far wider."""
    rng = np.random.default_rng(seed)
    x = np.arange(0, 41.0)
    edge = rng.uniform(-1, 1, 41)
    low = np.concatenate([np.stack([x, edge], 1), [[40, -8], [0, -8]]])
    high = np.concatenate([np.stack([x, edge + gap], 1), [[40, 9], [0, 9]]])
    points = np.concatenate([low, high])
    segments = np.concatenate([ring(low)[:, ::-1], ring(high) + 43])
    v, t, _ = meshed(points, segments, np.ones(86, int), np.zeros(86, int), 2.0)
    after = fair_curves(v, t, tolerance=5.0, width=60.0)
    lines = shapely.polygonize(shapely.linestrings(after[boundary_edges(t)]).tolist())
    assert len(lines.geoms) == 2
    for part in lines.geoms:
        assert part.is_valid
    assert shapely.distance(*lines.geoms) > 0
    assert np.abs(after - v).max() > 0.005


def test_limits_hold_for_a_vertex_beside_a_long_edge_and_for_its_ends():
    points = np.array([[0, 0], [10, 0], [5, 0.1], [5, 9], [4, 9], [0, -9]])
    limits = _limits(points, np.array([[0, 1], [2, 3], [3, 4], [4, 2], [1, 5], [5, 0]]), 0.5)
    np.testing.assert_allclose(limits, [0.045, 0.045, 0.045, 0.45, 0.45, 0.5], atol=0.01)


def test_a_curve_beside_the_frame_does_not_reach_it():
    """The sides of a square, whose corners are rounded off, bulge so that the area is kept."""
    s = np.arange(20.0)
    o, e = np.zeros(20), np.full(20, 20.0)
    points = np.concatenate([np.stack(p, axis=1) for p in ((s, o), (e, s), (20 - s, e), (o, 20 - s))])
    v, t, _ = meshed(points, ring(points), np.ones(80, int), np.zeros(80, int), 2.0)
    near, far = (fair_curves(v, t, tolerance=2.0, width=40.0, bounds=(-w, -w, 20 + w, 20 + w)) for w in (0.01, 5.0))
    assert far.min() < -0.01
    assert near.min() > -0.01
    assert near.max() < 20.01


def test_guard_keeps_the_worst_angle():
    spoiled = 0
    for seed in range(5):
        v, t, regions = two_regions(seed, roughness=0.8)
        wild, kept = (cotangent(v, t, boundary="free", tolerance=2.0, regions=regions, bounds=FRAME, guard=g) for g in (False, True))
        spoiled += angles(wild, t).min() < angles(v, t).min() - 1e-6
        assert angles(kept, t).min() >= angles(v, t).min() - 1e-9
        assert (areas(kept, t) > 0).all()
    assert spoiled


def test_same_input_same_result():
    v, t, regions = two_regions()
    once, again = (cotangent(v, t, boundary="free", tolerance=0.5, regions=regions, bounds=FRAME) for _ in range(2))
    np.testing.assert_array_equal(once, again)


@settings(max_examples=10, deadline=None)
@given(st.floats(1e-3, 1e3), st.floats(-1e3, 1e3), st.integers(0, 3))
def test_scale_shift_and_turns_are_passed_through(scale, shift, quarter):
    v, t = rough_disc(20)
    turn = np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), quarter)
    moved = fair_curves(v @ turn * scale + shift, t, tolerance=0.5 * scale)
    np.testing.assert_allclose(moved, fair_curves(v, t, tolerance=0.5) @ turn * scale + shift, atol=1e-8 * (scale + abs(shift)))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tolerance": -1}, "tolerance: expected a number of at least 0, found -1"),
        ({"tolerance": 1, "width": 0}, "width: expected a number above 0, found 0"),
        ({"tolerance": 1, "bounds": (0, 0, 0, 1)}, r"bounds: expected \(left, bottom, right, top\) with left < right"),
        ({"tolerance": 1, "bounds": (0, 0, np.nan, 1)}, "bounds: expected a number, found nan"),
        ({"tolerance": 1, "iterations": 1.5}, "iterations: expected a whole number"),
    ],
)
def test_options_that_cannot_be(options, message):
    v, t = rough_disc(10)
    with pytest.raises(ParameterError, match=message):
        cotangent(v, t, boundary="free", **options)


@pytest.mark.parametrize("scale", [1e-200, 1e150])
def test_lengths_whose_squares_are_no_numbers(scale):
    v, t = rough_disc(20)
    with pytest.raises(MeshError, match="vertices: expected edges of a length between 1e-100 and 1e100 on the boundary, found "):
        fair_curves(v * scale, t, tolerance=0.5 * scale)
