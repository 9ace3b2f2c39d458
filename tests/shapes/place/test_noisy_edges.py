"""Hard edges with noise are what their mask is; edges drawn by area or by distance are exact."""

from __future__ import annotations

import numpy as np
import pytest
import specimens
from shapes.test_tuning import traced

from img2tri.shapes.place import iso_crossings

N, RADIUS, CENTRE = 100, 36.3, (50.3, 49.8)
MASK = specimens.disc(N, RADIUS, CENTRE)


def off(gray, level):
    """Distances of the outline from the circle."""
    points = traced((gray > (120 if level is None else level)).astype(int), gray=gray, level=level)[0].points
    away = np.hypot(points[:, 0] - CENTRE[1], N - points[:, 1] - CENTRE[0]) - RADIUS
    return away[np.abs(away) < 2]


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("deviation", [1, 2, 4, 8])
@pytest.mark.parametrize("level", [None, 120.0])
def test_hard_edges_with_noise_say_what_their_mask_says(deviation, level):
    noise = np.random.default_rng(deviation).normal(0, deviation, MASK.shape)
    alone = traced(MASK.astype(int))[0].points
    away = rms(np.hypot(alone[:, 0] - CENTRE[1], N - alone[:, 1] - CENTRE[0]) - RADIUS)
    assert rms(off(np.round(30 + 180 * MASK + noise), level)) < 1.1 * away


@pytest.mark.parametrize("contrast", [40, 180, -180])
def test_edges_drawn_by_area_are_exact_whatever_the_contrast(contrast):
    share = specimens.gray_disc(N, RADIUS, CENTRE).astype(float) / 255
    points = traced((share > 0.5).astype(int), gray=128 + contrast * (share - 0.5))[0].points
    assert rms(np.hypot(points[:, 0] - CENTRE[1], N - points[:, 1] - CENTRE[0]) - RADIUS) < 0.003


def test_so_are_edges_drawn_by_distance():
    y, x = np.mgrid[:N, :N] + 0.5
    gray = 255 * np.clip(RADIUS - np.hypot(x - CENTRE[1], y - CENTRE[0]) + 0.5, 0, 1)
    assert rms(off(gray, None)) < 0.0075


@pytest.mark.parametrize("width", [1.0, 1.5, 2.0])
def test_the_sides_of_slow_ramps_are_found_where_they_end(width):
    from scipy.ndimage import gaussian_filter

    soft = gaussian_filter(np.pad(np.full((60, 30), 200.0), ((0, 0), (30, 0))), width)
    outlines, dual_edges = traced((soft > 100).astype(int), gray=soft)
    assert np.abs(outlines.points[dual_edges.vector != 0][:, 0] - 30).max() < 0.01


def noisy():
    noise = np.random.default_rng(4).normal(0, 4, MASK.shape)
    return rms(off(np.round(30 + 180 * MASK + noise), None))


def drawn_by_area():
    gray = specimens.gray_disc(N, RADIUS, CENTRE).astype(float)
    points = traced((gray > 127.5).astype(int), gray=gray)[0].points
    return rms(np.hypot(points[:, 0] - CENTRE[1], N - points[:, 1] - CENTRE[0]) - RADIUS)


CHANGES = [("NOISE", 0.3, noisy), ("NORMAL", 0.3, noisy), ("SAMPLE", 10**6, noisy), ("PURE", 1.06, drawn_by_area)]


@pytest.mark.parametrize(("name", "factor", "measure"), CHANGES, ids=[name for name, *_ in CHANGES])
def test_the_numbers_matter(name, factor, measure, monkeypatch):
    before = measure()
    value = getattr(iso_crossings, name)
    monkeypatch.setattr(iso_crossings, name, type(value)(value * factor))
    assert measure() > 1.1 * before
