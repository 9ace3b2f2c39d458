"""Smoothing splines along chains: against a dense solution of the same problem, and what they must leave alone."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.arrays import ChainIndex
from img2tri.shapes.place.padded_chains import PaddedChains
from img2tri.shapes.place.smoothing_splines import NODE_WEIGHT, PADDING, WIDTH, CurvatureSpline, SmoothingSpline


def laid(z, *, ring, reach=PADDING):
    """One chain on a line: a ring ends with its first point."""
    indices = np.append(np.arange(len(z)), 0) if ring else np.arange(len(z))
    line = PaddedChains(ChainIndex(indices, np.array([0, len(indices)]), np.array([ring])), np.array([True]), reach)
    return line, line.points(z)


def smoothed(line, points, scale):
    curves = SmoothingSpline(line, points)
    return *curves.smoothed(scale), curves.steps


def arc(radius, degrees, seed=0):
    """Points spread unevenly, and a little roughly, on an arc; its ends far off it, as nodes may be."""
    rng = np.random.default_rng(seed)
    angle = np.cumsum(rng.uniform(0.7, 1.3, round(radius * np.radians(degrees)))) / radius
    z = (radius + rng.uniform(-0.2, 0.2, len(angle))) * np.exp(1j * angle)
    z[[0, -1]] *= 1 + 0.5 / radius, 1 - 0.5 / radius
    return z


def circle(radius, count, seed=0):
    """Points spread unevenly on a circle."""
    angle = np.cumsum(np.random.default_rng(seed).uniform(0.7, 1.3, count))
    return radius * np.exp(2j * np.pi * angle / angle[-1])


def by_hand(x, z, weight, stiffness, *, ring, period=0.0):
    """The same curve by a dense matrix with one row for each third derivative."""
    n = len(z)
    rows, near = [], n if ring else n - 3
    for k in range(near):
        at = np.arange(k, k + 4)
        places = x[at % n] + period * (at // n)
        rows.append(np.zeros(n))
        for j in range(4):
            others = np.delete(places, j)
            rows[-1][at[j] % n] += 6 / np.prod(places[j] - others) * np.sqrt((places[3] - places[0]) / 3)
    D = np.array(rows)
    return np.linalg.solve(np.diag(weight) + stiffness * D.T @ D, weight * z)


@pytest.mark.parametrize("scale", [1.5, 5.0])
@pytest.mark.parametrize("count", [40, 41])
def test_rings_are_those_of_a_dense_matrix(scale, count):
    rng = np.random.default_rng(count)
    z = circle(count / 6.3, count) + rng.normal(0, 0.2, count) + 1j * rng.normal(0, 0.2, count)
    line, points = laid(z, ring=True)
    off, _, steps = smoothed(line, points, scale)
    own = np.flatnonzero(line.own)
    ahead, behind = steps[own], steps[own - 1]
    expected = by_hand(np.cumsum(ahead) - ahead, z, (ahead + behind) / 2, (WIDTH * scale) ** 6, ring=True, period=ahead.sum())
    np.testing.assert_allclose((points + off)[own], expected, atol=1e-8)


@pytest.mark.parametrize("scale", [1.5, 4.0])
def test_open_chains_are_those_of_a_dense_matrix(scale):
    """Their nodes hardly count, and nothing counts beyond them."""
    rng = np.random.default_rng(0)
    z = np.arange(50) * (0.8 + 0.3j) + rng.normal(0, 0.2, 50) + 1j * rng.normal(0, 0.2, 50)
    line, points = laid(z, ring=False)
    off, _, steps = smoothed(line, points, scale)
    own = np.flatnonzero(line.own)
    weight = (steps[own - 1] + steps[own]) / 2
    weight[[0, -1]] *= NODE_WEIGHT
    expected = by_hand(np.concatenate([[0], np.cumsum(steps[own[:-1]])]), z, weight, (WIDTH * scale) ** 6, ring=False)
    np.testing.assert_allclose((points + off)[own], expected, atol=1e-6)


@pytest.mark.parametrize("scale", [9.0, 20.0, 48.0])
@pytest.mark.parametrize("radius", [12.0, 30.0, 200.0])
def test_arcs_stay_arcs_up_to_their_ends_however_wide_the_spline(radius, scale):
    """A spline smooth in x and y would open them by up to a pixel."""
    z = arc(radius, 120)
    line, points = laid(z, ring=False)
    off, direction = CurvatureSpline(SmoothingSpline(line, points), 4.0).smoothed(scale)
    curve = (points + off)[line.own]
    assert np.abs(np.abs(curve) - radius).max() < 0.2
    assert np.abs((direction[line.own] * curve.conj()).real / np.abs(curve))[1:-1].max() < 0.05
    rough = np.sqrt(np.mean((np.abs(z[1:-1]) - radius) ** 2))
    assert np.sqrt(np.mean((np.abs(curve) - radius) ** 2)) < 0.7 * rough


@pytest.mark.parametrize("scale", [9.0, 48.0])
def test_rings_do_not_shrink_however_wide_the_spline(scale):
    z = circle(14.0, 88) * (1 + np.random.default_rng(1).uniform(-0.2, 0.2, 88) / 14)
    line, points = laid(z, ring=True)
    off, _ = CurvatureSpline(SmoothingSpline(line, points), 4.0).smoothed(scale)
    radius = np.abs((points + off)[line.own])
    assert radius.mean() == pytest.approx(14, abs=0.05)
    assert np.ptp(radius) < 0.25
    if scale > 20:
        shrunk = np.abs((points + SmoothingSpline(line, points).smoothed(scale)[0])[line.own])
        assert shrunk.mean() < 10


@pytest.mark.parametrize("scale", [9.0, 20.0, 48.0])
def test_splines_smooth_in_curvature_take_away_what_narrow_waves_there_are(scale):
    x = np.arange(800)
    for waves, least, most in ((0.5, 0, 0.05), (6, 0.9, 1.02)):
        z = x + 0.05j * np.sin(2 * np.pi * x / (waves * scale))
        line, points = laid(z, ring=False)
        off, _ = CurvatureSpline(SmoothingSpline(line, points), 1.0).smoothed(scale)
        left = np.abs((points + off)[line.own].imag[200:-200]).max()
        assert least <= left / 0.05 <= most, waves


def test_what_rounding_leaves_is_taken_away():
    """Turned by a quarter, a chain has the same spline to some 1e-9 px, though the equations of wide ones are badly conditioned."""
    z = arc(150.0, 100)
    found = []
    for turn in (1, 1j):
        line, points = laid(z * turn, ring=False)
        found.append(CurvatureSpline(SmoothingSpline(line, points), 4.0).smoothed(48.0)[0][line.own] / turn)
    np.testing.assert_allclose(found[0], found[1], atol=1e-8)


@pytest.mark.parametrize("scale", [1.0, 4.0, 16.0])
def test_circles_stay_whose_points_lie_unevenly(scale):
    z = circle(60.0, 377)
    line, points = laid(z, ring=True)
    off, direction, steps = smoothed(line, points, scale)
    curve = (points + off)[line.own]
    assert np.abs(np.abs(curve) - 60).max() < 0.02
    assert np.abs((direction[line.own] * curve.conj()).real / 60).max() < 0.02
    assert steps[np.flatnonzero(line.own)].sum() == pytest.approx(2 * np.pi * 60, rel=0.01)


@pytest.mark.parametrize("scale", [1.0, 5.0, 16.0])
def test_straight_lines_stay(scale):
    line, points = laid((2 - 1j) * np.arange(40), ring=False)
    assert np.abs(smoothed(line, points, scale)[0]).max() < 1e-7
    off, _ = CurvatureSpline(SmoothingSpline(line, points), 4.0).smoothed(scale)
    assert np.abs(off).max() < 1e-7


def test_nodes_follow_the_rest_of_their_chain():
    z = (2 - 1j) * np.arange(40) + 3
    moved = z.copy()
    moved[[0, -1]] += 0.4j, -0.3j
    line, points = laid(moved, ring=False)
    off, direction, _ = smoothed(line, points, 4.0)
    # On the line again, though not evenly along it.
    curve = (points + off)[line.own]
    np.testing.assert_allclose(((curve - 3) / (2 - 1j)).imag, 0, atol=0.02)
    np.testing.assert_allclose(direction[line.own] * abs(2 - 1j) / (2 - 1j), 1, atol=0.02)


def test_waves_are_taken_away_by_their_length():
    scale, x = 4.0, np.arange(600)
    for waves, least, most in ((0.5, 0, 0.01), (3, 0.45, 0.55), (6, 0.97, 1.0)):
        z = x + 0.05j * np.sin(2 * np.pi * x / (waves * scale))
        line, points = laid(z, ring=False)
        left = np.abs((points + smoothed(line, points, scale)[0])[line.own].imag[100:-100]).max()
        assert least <= left / 0.05 <= most, waves
