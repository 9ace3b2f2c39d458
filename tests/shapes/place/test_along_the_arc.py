"""What spreads along the arc: against sums over all places."""

from __future__ import annotations

import numpy as np
import pytest
from shapes.place.test_smoothing_splines import circle, laid

from img2tri.arrays import ChainIndex
from img2tri.shapes.place.along_the_arc import ArcLengths, fade_out
from img2tri.shapes.place.padded_chains import PaddedChains, gaussian
from img2tri.shapes.place.smoothing_splines import PADDING, SmoothingSpline


@pytest.mark.parametrize("ring", [True, False])
def test_distances_of_marks_are_those_along_the_chain(ring):
    rng = np.random.default_rng(2)
    line, points = laid(circle(8.0, 50, seed=3) if ring else np.cumsum(rng.uniform(0.7, 1.3, 50)), ring=ring)
    steps = SmoothingSpline(line, points).steps
    own = np.flatnonzero(line.own)
    x, length = np.cumsum(steps[own]) - steps[own], steps[own].sum()
    for chosen in ([], [0], [49], [3, 20], [25]):
        marks = np.zeros(len(points), bool)
        marks[own[chosen]] = True
        away = np.abs(x[:, None] - x[chosen])
        if ring:
            away = np.minimum(away, length - away)
        for distance in (0.5, 6.0):
            expected = away.min(axis=1, initial=np.inf) > distance
            assert np.array_equal(ArcLengths(line, steps).farther_than(marks, distance)[own], expected)


def test_marks_say_nothing_of_other_chains():
    z = np.concatenate([circle(6.0, 40), circle(9.0, 60) + 100, np.arange(30.0) + 50j])
    indices = np.concatenate([np.arange(40), [0], np.arange(40, 100), [40], np.arange(100, 130)])
    line = PaddedChains(ChainIndex(indices, np.array([0, 41, 102, 132]), np.array([True, True, False])), np.ones(3, bool), PADDING)
    steps = SmoothingSpline(line, line.points(z)).steps
    for chain in range(3):
        far = ArcLengths(line, steps).farther_than(line.chain == chain, 1000.0)
        assert np.array_equal(far, line.chain != chain)


def test_values_fade_and_do_not_add_up():
    line, _ = laid(np.arange(60.0), ring=False)
    values = np.zeros(len(line.own))
    own = np.flatnonzero(line.own)
    values[own[[10, 40, 41]]] = 1, -2, -2
    fading = fade_out(line, values, 3.0)[own]
    assert fading[[10, 40, 41]] == pytest.approx([1, -2, -2], abs=0.05)
    assert fading[13] == pytest.approx(np.exp(-0.5), abs=0.01)
    assert np.abs(fading[[0, 25, 59]]).max() < 0.02
    assert not fade_out(line, np.zeros(len(values)), 3.0).any()


@pytest.mark.parametrize("share", [0.0, 0.005, 0.05, 0.5])
@pytest.mark.parametrize("count", [12, 400])
def test_values_fade_as_if_all_places_were_looked_at(count, share):
    """Bit for bit: those without a value within reach add nothing."""
    rng = np.random.default_rng(count)
    line, _ = laid(circle(count / 6, count), ring=True, reach=40)
    values = (rng.normal(size=count) * (rng.random(count) < share))[line.source]
    kernel = gaussian(4.0)
    kernel /= kernel.max()
    crowd = np.convolve((values != 0).astype(float), kernel, "same")[line.original]
    expected = np.convolve(values / np.maximum(crowd, 1), kernel, "same")[line.original]
    assert np.array_equal(fade_out(line, values, 4.0), expected)
