"""Smoothing along the arc: straight lines come out straight, nothing leaves its range, chains know nothing of each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
import specimens

from img2tri.arrays import ChainIndex
from img2tri.shapes.place import constrained_smoothing
from img2tri.shapes.place.constrained_smoothing import BoundedChains, restore_swept_areas, swept_areas, widest_fitting_spline
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import BOUND, lay_out
from img2tri.types import Frame

ELLIPSE = specimens.ellipse(70, (28.3, 17.1), 25, (34.6, 35.2))
SHAPES = {
    "ellipse": ELLIPSE,
    "disc": specimens.disc(40, 15.0, (20.2, 19.7)),
    "rectangle": np.pad(np.ones((20, 31), int), 3),
    "polycrystal": specimens.polycrystal(),
    "noise": np.random.default_rng(0).integers(0, 3, (24, 25)),
    "spiral": specimens.spiral(),
    "one pixel": specimens.MASKS["one pixel"],
}


def sliding(labels, reach=BOUND):
    dual_edges = lay_out(find_crack_edges(labels), Frame(labels.shape))
    low = np.where(dual_edges.slides, -reach, 0.0)
    return BoundedChains(dual_edges.middle, dual_edges.vector, low, -low, np.full(len(low), BOUND), dual_edges.chains)


def fitted_to(s):
    """The shifts of points onto the splines."""
    return widest_fitting_spline(s)[0]


def moved(s, shift):
    return s.points + shift * s.axis


def some_chains(s, chosen):
    """The same points, only these chains."""
    parts = [s.chains.indices[s.chains.starts[i] : s.chains.starts[i + 1]] for i in chosen]
    return replace(s, chains=ChainIndex(np.concatenate(parts), np.cumsum([0, *map(len, parts)]), s.chains.rings[chosen]))


def begun_elsewhere(s, at):
    """The same ring, begun at another of its points."""
    ring = np.roll(s.chains.indices[:-1], -at)
    return replace(s, chains=replace(s.chains, indices=np.append(ring, ring[0])))


@pytest.mark.parametrize("reach", [0.0, 0.1, BOUND])
@pytest.mark.parametrize("name", SHAPES)
def test_no_point_leaves_its_range(name, reach):
    s = sliding(SHAPES[name], reach)
    kept = s.points.copy()
    fitted = fitted_to(s)
    wanted = swept_areas(s.points, s) + np.linspace(-30, 30, len(s.chains.rings))
    for shift in (fitted, restore_swept_areas(s, fitted, wanted)):
        assert (s.low <= shift).all()
        assert (shift <= s.high).all()
        assert (shift[s.axis == 0] == 0).all()
    assert np.array_equal(s.points, kept)


def test_a_range_of_one_point_only_is_respected():
    s = sliding(ELLIPSE)
    known = np.arange(len(s.points)) % 3 == 0
    at = np.where(known, 0.2, 0)
    narrow = replace(s, points=s.points + at * s.axis, low=np.where(known, 0, s.low - at), high=np.where(known, 0, s.high - at))
    assert (fitted_to(narrow)[known] == 0).all()
    assert (restore_swept_areas(narrow, fitted_to(narrow), swept_areas(s.points, s) + 20)[known] == 0).all()


@pytest.mark.parametrize("angle", [4.5, 8, 11.3, 14, 17, 20, 23, 29, 33, 37, 41, 51, 55.5, 59, 68, 73, 77.7, 81, 86])
def test_the_steps_of_a_straight_edge_are_gone(angle):
    """A half plane whose steps are not too long to be seen through: away from its ends the outline is a straight line."""
    n, turn = 160, np.exp(1j * np.radians(angle))
    y, x = np.mgrid[:n, :n] + 0.5
    s = sliding((((x - 80.2) + 1j * (80.1 - y)) / turn).real < 0)
    z = moved(s, fitted_to(s))
    inner = (s.axis != 0) & (np.minimum.reduce([z.real, z.imag, n - z.real, n - z.imag]) > 12)
    off = ((z - (80.2 + 1j * (n - 80.1))) / turn).real[inner]
    rough = ((s.points - (80.2 + 1j * (n - 80.1))) / turn).real[inner]
    assert np.sqrt((off**2).mean()) < min(0.12, 0.5 * np.sqrt((rough**2).mean()))
    assert np.abs(off).max() < 0.3


def test_corners_are_spared_and_sides_stay_straight():
    s = sliding(np.pad(np.ones((40, 60), int), 5))
    z = moved(s, fitted_to(s))
    off = np.minimum.reduce([abs(z.real - 5), abs(z.real - 65), abs(z.imag - 5), abs(z.imag - 45)])
    from_corner = np.min([abs(z - corner) for corner in (5 + 5j, 65 + 5j, 5 + 45j, 65 + 45j)], axis=0)
    assert off[from_corner > 1].max() < 0.1
    assert off[from_corner > 8].max() < 0.03


def test_a_wide_curve_is_found_far_better_than_its_steps():
    for radius, most in ((20, 0.05), (40, 0.05), (80, 0.05), (150, 0.055)):
        n = 2 * radius + 20
        s = sliding(specimens.disc(n, radius, (n / 2 + 0.3, n / 2 - 0.2)))
        off = np.abs(moved(s, fitted_to(s)) - (n / 2 - 0.2 + 1j * (n / 2 - 0.3))) - radius
        assert np.sqrt((off**2).mean()) < most


# ---- chains are on their own ----


@pytest.mark.parametrize("name", ["ellipse", "disc"])
def test_where_a_ring_begins_does_not_matter(name):
    s = sliding(SHAPES[name])
    expected = fitted_to(s)
    for at in (1, 7, len(s.chains.indices) // 2):
        np.testing.assert_allclose(fitted_to(begun_elsewhere(s, at)), expected, atol=1e-9)


def test_a_ring_knows_nothing_of_another_one():
    discs = np.concatenate([SHAPES["disc"], np.zeros((40, 200), int), SHAPES["disc"], np.zeros((40, 4), int)], axis=1)
    s = sliding(discs)
    assert s.chains.rings.tolist() == [True, True]
    together = fitted_to(s)
    for ring in (0, 1):
        own = s.chains.indices[s.chains.starts[ring] : s.chains.starts[ring + 1]]
        np.testing.assert_allclose(fitted_to(some_chains(s, [ring]))[own], together[own], atol=1e-9)


def test_an_open_chain_knows_nothing_of_another_one():
    s = sliding(SHAPES["polycrystal"])
    together = fitted_to(s)
    for chain in range(len(s.chains.rings)):
        # Chains that meet in a node share the scale that fits there: it is felt four points away.
        own = s.chains.indices[s.chains.starts[chain] + 5 : s.chains.starts[chain + 1] - 5]
        alone = fitted_to(some_chains(s, [chain]))
        np.testing.assert_allclose(alone[own], together[own], atol=1e-9)


@pytest.mark.parametrize("name", ["ellipse", "disc", "polycrystal"])
def test_the_direction_of_chains_does_not_matter(name):
    s = sliding(SHAPES[name])
    c = s.chains
    turned = replace(s, chains=ChainIndex(c.indices[::-1], len(c.indices) - c.starts[::-1], c.rings[::-1]))
    fitted = fitted_to(s)
    np.testing.assert_allclose(fitted_to(turned), fitted, atol=1e-9)
    wanted = swept_areas(s.points, s)
    np.testing.assert_allclose(swept_areas(s.points, turned)[::-1], -wanted, atol=1e-9)
    np.testing.assert_allclose(restore_swept_areas(turned, fitted, -wanted[::-1]), restore_swept_areas(s, fitted, wanted), atol=1e-9)


# ---- areas ----


def test_swept_area_of_rings_is_that_of_their_polygons():
    for name in ("ellipse", "disc", "one pixel"):
        s = sliding(SHAPES[name])
        z = moved(s, fitted_to(s))[s.chains.indices]
        expected = shapely.Polygon(np.stack([z.real, z.imag], axis=1)).area
        assert abs(swept_areas(moved(s, fitted_to(s)), s)[0]) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("change", [-20.0, -1.0, 0.0, 3.0, 20.0])
@pytest.mark.parametrize("name", ["ellipse", "disc"])
def test_the_wanted_area_is_met(name, change):
    s = sliding(SHAPES[name])
    wanted = swept_areas(s.points, s) + change
    shift = restore_swept_areas(s, fitted_to(s), wanted)
    assert swept_areas(moved(s, shift), s) == pytest.approx(wanted, abs=1e-9)


def test_each_chain_meets_its_own_area():
    s = sliding(SHAPES["polycrystal"])
    fitted = fitted_to(s)
    wanted = swept_areas(moved(s, fitted), s)
    changed = wanted + np.where(np.arange(len(wanted)) % 2, 0.5, -0.5)
    shift = restore_swept_areas(s, fitted, changed)
    inside = np.bincount(s.chains.chain, s.slides[s.chains.indices]) > 8
    assert inside.sum() > 10
    assert swept_areas(moved(s, shift), s)[inside] == pytest.approx(changed[inside], abs=1e-9)
    # Chains that enclose what they should stay where they are.
    assert restore_swept_areas(s, fitted, wanted) == pytest.approx(fitted, abs=1e-9)


def test_an_area_that_cannot_be_had_is_met_as_far_as_it_can(monkeypatch):
    monkeypatch.setattr(constrained_smoothing, "AREA_ROUNDS", 20)
    s = sliding(SHAPES["disc"])
    for change, end in ((1000, s.low), (-1000, s.high)):
        # The disc is on the right of its outline: outwards is towards the left, where its outline sweeps less.
        shift = restore_swept_areas(s, np.zeros(len(s.points)), swept_areas(s.points, s) + change)
        assert np.array_equal(shift, end)


@pytest.mark.parametrize("rounds", [0, 1])
def test_rounds_of_keeping_areas(rounds, monkeypatch):
    monkeypatch.setattr(constrained_smoothing, "AREA_ROUNDS", rounds)
    s = sliding(SHAPES["ellipse"])
    fitted = fitted_to(s)
    wanted = swept_areas(s.points, s) + 20
    missing = abs(swept_areas(moved(s, restore_swept_areas(s, fitted, wanted)), s) - wanted)
    assert (missing > 1e-9).all()
    assert (missing < abs(swept_areas(moved(s, fitted), s) - wanted)).all() == (rounds > 0)
