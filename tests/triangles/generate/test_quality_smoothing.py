"""Quality-weighted smoothing: shapes of triangles as complex numbers, moves that only help, and repairs."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from scipy.spatial import Delaunay

from img2tri.arrays import as_rows
from img2tri.triangles.generate.quality_smoothing import (
    DEFECT,
    SMOOTH,
    WORST_FIRST,
    SlideLines,
    defects_and_qualities,
    raise_sliding,
    raise_worst_angles,
    smooth,
)
from img2tri.triangles.generate.valence_repair import excess, repair_valences
from img2tri.triangles.min_angle_tangents import smallest_angles

TURN = np.exp(1j * np.pi / 3)
FEW = ((1, 1.0, 3),)
ANNEAL = ((1, 1.0, 2), (1, 0.8, 3), (2, 0.6, 3), (3, 0.5, 4), (4, 0.3, 6))


def rough(seed, n=300):
    """A Delaunay mesh of random points in a square, and which of its vertices are inside."""
    rng = np.random.default_rng(seed)
    side = np.linspace(0, 1, 18)[:-1]
    frame = np.concatenate([side, 1 + 1j * side, 1 - side + 1j, 1j * (1 - side)])
    z = np.concatenate([frame, rng.uniform(0.02, 0.98, n) + 1j * rng.uniform(0.02, 0.98, n)])
    triangles = Delaunay(as_rows(z)).simplices.astype(np.int64)
    a = oracles.areas(as_rows(z), triangles)
    triangles[a < 0] = triangles[a < 0][:, ::-1]
    return z, triangles[np.abs(a) > 1e-12], np.arange(len(z)) >= len(frame)


def with_lines(seed, limit):
    """A fair mesh of a square whose points lie by chance: vertices on its sides may slide along these, but for the corners."""
    rng = np.random.default_rng(seed)
    n = 12
    side = np.arange(n) / n + np.where(np.arange(n) > 0, rng.uniform(-0.3, 0.3, n) / n, 0)
    frame = np.concatenate([1j**k * (side - 0.5 - 0.5j) for k in range(4)])
    x, y = np.mgrid[1:n, 1:n] / n
    inside = (x + 1j * y).ravel() - 0.5 - 0.5j + (rng.uniform(-0.2, 0.2, (n - 1) ** 2) + 1j * rng.uniform(-0.2, 0.2, (n - 1) ** 2)) / n
    z = np.concatenate([frame, inside])
    triangles = Delaunay(as_rows(z)).simplices.astype(np.int64)
    a = oracles.areas(as_rows(z), triangles)
    triangles[a < 0] = triangles[a < 0][:, ::-1]
    sides = np.flatnonzero(np.arange(4 * n) % n)
    lines = SlideLines(sides, 1j ** (sides // n), z[sides], np.full(len(sides), limit))
    return z, triangles[np.abs(a) > 1e-12], np.arange(len(z)) >= len(frame), lines


def test_an_equilateral_triangle_has_no_defect():
    defect, quality = defects_and_qualities(np.array([2j, 2j + 3, 2j + 3 * TURN]), np.array([[0, 1, 2]]))
    assert abs(defect[0]) < 1e-12
    assert quality[0] == pytest.approx(1)


def test_quality_is_area_over_squares_of_edges():
    z, triangles, _ = rough(0)
    p = as_rows(z)[triangles]
    squares = sum(((p[:, k] - p[:, k - 1]) ** 2).sum(axis=1) for k in range(3))
    assert defects_and_qualities(z, triangles)[1] == pytest.approx(4 * 3**0.5 * oracles.areas(as_rows(z), triangles) / squares)
    assert defects_and_qualities(z, triangles[:, ::-1])[1] == pytest.approx(-defects_and_qualities(z, triangles)[1])


@pytest.mark.parametrize("corner", [0, 1, 2])
def test_moving_one_corner_by_its_defect_makes_the_triangle_equilateral(corner):
    z = np.array([0, 4 + 1j, 1 + 2j])
    defect, _ = defects_and_qualities(z, np.array([[0, 1, 2]]))
    z[corner] -= defect[0] * DEFECT.conj()[corner]
    assert oracles.angles(as_rows(z), np.array([[0, 1, 2]])) == pytest.approx(60)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("schedule", [SMOOTH, WORST_FIRST, FEW, ANNEAL, ((7, 1.0, 5),), ((1, 1.9, 20),)])
def test_smoothing_never_lowers_the_worst_angle(seed, schedule):
    z, triangles, free = rough(seed)
    before = z.copy()
    moved = smooth(z, triangles, free, schedule)
    assert (z == before).all(), "the argument was changed"
    assert (moved[~free] == z[~free]).all()
    assert oracles.angles(as_rows(moved), triangles).min() >= oracles.angles(as_rows(z), triangles).min() - 1e-6
    assert (oracles.areas(as_rows(moved), triangles) > 0).all()


@pytest.mark.parametrize("seed", range(4))
def test_smoothing_makes_triangles_better(seed):
    for z, triangles, free, *_ in (rough(seed), with_lines(seed, 0)):
        before, after = (defects_and_qualities(vertices, triangles)[1].mean() for vertices in (z, smooth(z, triangles, free, SMOOTH)))
        assert 1 - after < 0.96 * (1 - before)


@pytest.mark.parametrize("seed", range(4))
def test_rough_meshes_get_better_in_few_steps_and_their_worst_angles_by_growing_powers(seed):
    z, triangles, free = rough(seed)
    even = smooth(z, triangles, free, FEW)
    assert defects_and_qualities(even, triangles)[1].mean() > defects_and_qualities(z, triangles)[1].mean() + 0.02
    annealed = smooth(even, triangles, free, ANNEAL)
    assert np.percentile(smallest_angles(annealed, triangles), 5) > np.percentile(smallest_angles(even, triangles), 5)


def test_the_worst_angles_of_a_rough_mesh_rise():
    z, triangles, free = rough(5)
    z = smooth(smooth(z, triangles, free, FEW), triangles, free, ANNEAL)
    lifted = raise_worst_angles(z, triangles, free)
    assert smallest_angles(lifted, triangles).min() > smallest_angles(z, triangles).min()
    assert (lifted == z).sum() > len(z) / 3
    assert (raise_worst_angles(z, triangles, free, target=0.0) == z).all()


@pytest.mark.parametrize("seed", range(4))
def test_large_powers_weigh_the_worst_triangles(seed):
    z, triangles, free, _ = with_lines(seed, 0)
    plain, high = (smooth(z, triangles, free, ((doublings, 0.3, 40),)) for doublings in (1, 4))
    worst = [np.percentile(smallest_angles(moved, triangles), 2) for moved in (plain, high)]
    mean = [defects_and_qualities(moved, triangles)[1].mean() for moved in (plain, high)]
    assert worst[1] > worst[0]
    assert mean[1] < mean[0]


@pytest.mark.parametrize("seed", range(4))
def test_the_worst_angle_rises_and_moves_nothing_far_away(seed):
    z, triangles, free, _ = with_lines(seed, 0)
    z = smooth(z, triangles, free, SMOOTH)
    lifted = raise_worst_angles(z, triangles, free)
    assert smallest_angles(lifted, triangles).min() > smallest_angles(z, triangles).min()
    assert (lifted == z).sum() > len(z) / 3
    assert (raise_worst_angles(z, triangles, free, target=0.0) == z).all()


@pytest.mark.parametrize("seed", range(4))
def test_poor_angles_become_fewer_where_vertices_slide_and_all_stay_where_they_would_not(seed):
    z, triangles, free, lines = with_lines(seed, 0.03)
    z = smooth(z, triangles, free, SMOOTH)
    before = smallest_angles(z, triangles)
    target = np.percentile(before, 5)
    slid = raise_sliding(z, triangles, free, lines, lambda wanted: wanted, target)
    after = smallest_angles(slid, triangles)
    assert after.min() >= before.min() - 1e-9
    assert (after < target).sum() < (before < target).sum()
    assert np.abs(slid[lines.at] - z[lines.at]).max() <= 0.03 + 1e-12
    assert (slid == z).sum() > len(z) / 4
    # What is settled may be worse than what was wanted: then nothing moves.
    assert np.array_equal(raise_sliding(z, triangles, free, lines, lambda wanted: np.where(free, wanted, 0.7 * z), target), z)
    assert np.array_equal(raise_sliding(z, triangles, free, lines, lambda wanted: wanted, before.min() - 1), z)


@pytest.mark.parametrize("seed", range(4))
def test_where_a_slide_spoils_triangles_only_what_hangs_together_with_them_goes_back(seed):
    meshes = [with_lines(seed, 0.03), with_lines(seed, 0.03)]
    n, apart = len(meshes[0][0]), 100
    z = np.concatenate([smooth(m[0], m[1], m[2], SMOOTH) + k * apart for k, m in enumerate(meshes)])
    triangles, free = np.concatenate([meshes[0][1], meshes[1][1] + n]), np.concatenate([m[2] for m in meshes])
    one, other = meshes[0][3], meshes[1][3]
    joined = [(one.at, other.at + n), (one.along, other.along), (one.start, other.start + apart), (one.limits, other.limits)]
    lines = SlideLines(*(np.concatenate(part) for part in joined))
    target = np.percentile(smallest_angles(z, triangles), 5)
    spoilt = ~free & (np.arange(2 * n) >= n)
    slid = raise_sliding(z, triangles, free, lines, lambda wanted: np.where(spoilt, 0.7 * (z - apart) + apart, wanted), target)
    assert np.array_equal(slid[n:], z[n:])
    before, after = (smallest_angles(vertices, triangles)[: len(meshes[0][1])] for vertices in (z, slid))
    assert (after < target).sum() < (before < target).sum()
    assert after.min() >= before.min() - 1e-9


def wheel(spokes):
    turn = np.exp(2j * np.pi * np.arange(spokes) / spokes)
    i = np.arange(spokes)
    triangles = np.stack([np.full(spokes, spokes), i, (i + 1) % spokes], axis=1)
    return np.concatenate([turn, [0]]), triangles, i.size == np.arange(spokes + 1)


@pytest.mark.parametrize("spokes", [3, 4, 5, 6, 7, 8, 9, 12])
def test_the_hub_of_a_wheel(spokes):
    z, triangles, free = wheel(spokes)
    assert excess(z, triangles)[-1] == pytest.approx(spokes - 6)
    added, stays = repair_valences(z, triangles, free)
    assert stays[:-1].all()
    assert stays[-1] == (5 <= spokes <= 7)
    assert len(added) == (2 if spokes >= 8 else 0)
    if len(added):
        assert added.sum() == pytest.approx(0, abs=0.3)
        assert (np.abs(added) < 0.7).all()


def test_an_inner_vertex_in_no_triangle_goes_and_fixed_ones_stay():
    z, triangles, free = wheel(4)
    assert repair_valences(z, triangles, np.zeros(5, bool))[1].all()
    lonely = np.concatenate([z, [3]])
    assert not repair_valences(lonely, triangles, np.append(free, True))[1][-1]
    assert repair_valences(lonely, triangles, np.append(free, False))[1][-1]


@pytest.mark.parametrize("seed", range(5))
def test_repairing_and_triangulating_anew_leaves_fewer_bad_vertices(seed):
    z, triangles, free = rough(seed)
    z = smooth(z, triangles, free, SMOOTH)
    added, stays = repair_valences(z, triangles, free)
    points = np.concatenate([z[stays], added])
    anew = Delaunay(as_rows(points)).simplices
    a = oracles.areas(as_rows(points), anew)
    anew = anew[np.abs(a) > 1e-12]
    bad = np.abs(excess(z, triangles)[free]) > 1.5
    turned = oracles.areas(as_rows(points), anew)[:, None] < 0
    left = np.abs(excess(points, np.where(turned, anew[:, ::-1], anew))[68:]) > 1.5
    assert left.sum() < bad.sum()


@pytest.mark.parametrize("seed", range(4))
def test_vertices_on_lines_keep_to_their_lines_and_help(seed):
    z, triangles, free, lines = with_lines(seed, 0.02)
    moved, without = (smooth(z, triangles, free, ((1, 1.0, 12),), some) for some in (lines, None))
    way = (moved[lines.at] - z[lines.at]) / lines.along
    assert np.abs(way.imag).max() < 1e-12
    assert 0.01 < np.abs(way.real).max() <= 0.02 + 1e-12
    stays = ~free
    stays[lines.at] = False
    assert (moved[stays] == z[stays]).all()
    assert defects_and_qualities(moved, triangles)[1].mean() > defects_and_qualities(without, triangles)[1].mean() + 0.005
    assert smallest_angles(moved, triangles).min() >= smallest_angles(z, triangles).min() - 1e-9


def test_limits_are_measured_from_the_start_of_a_line_however_often_one_slides():
    z, triangles, free, lines = with_lines(1, 0.01)
    moved = z
    for _ in range(5):
        moved = smooth(moved, triangles, free, SMOOTH, lines)
    assert np.abs(moved[lines.at] - z[lines.at]).max() == pytest.approx(0.01)
