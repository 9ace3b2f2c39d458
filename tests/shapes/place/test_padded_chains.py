"""Chains padded and laid out on a line against the rules they are continued by, and the kernels that run along them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import QUICK

from img2tri.arrays import ChainIndex
from img2tri.shapes.place.padded_chains import PaddedChains, convolve


def continued(z, place, ring):
    """Point `place` of a chain z[0], ..., z[n] that goes on beyond its ends; a ring's last point is its first again."""
    n = len(z) - 1
    if ring:
        return z[place % n]
    if place < 0:
        return 2 * z[0] - continued(z, -place, ring)
    if place > n:
        return 2 * z[n] - continued(z, 2 * n - place, ring)
    return z[place]


@st.composite
def chain_sets(draw):
    """Points, chains through them (rings of two steps and more), which are rings, which are chosen, and how far to go on."""
    points, indices, starts, rings = [], [], [0], []
    for _ in range(draw(st.integers(1, 4))):
        ring, steps = draw(st.booleans()), draw(st.integers(2, 9))
        own = range(len(points), len(points) + steps + (not ring))
        points += draw(st.lists(st.complex_numbers(max_magnitude=99), min_size=len(own), max_size=len(own)))
        indices += [*own, *own[: int(ring)]]
        starts.append(len(indices))
        rings.append(ring)
    chosen = draw(st.lists(st.booleans(), min_size=len(rings), max_size=len(rings)))
    return np.array(points), np.array(indices), np.array(starts), np.array(rings), np.array(chosen, bool), draw(st.integers(0, 30))


@QUICK
@given(chain_sets())
def test_chains_go_on_as_they_should(case):
    z, indices, starts, rings, chosen, reach = case
    line = PaddedChains(ChainIndex(indices, starts, rings), chosen, reach)
    points, at = line.points(z), 0
    for chain in np.flatnonzero(chosen):
        mine = indices[starts[chain] : starts[chain + 1]]
        last = len(mine) - 1 - int(rings[chain])
        places = range(-reach, last + reach + 1)
        part = slice(at, at + len(places))
        np.testing.assert_allclose(points[part], [continued(z[mine], p, rings[chain]) for p in places], atol=1e-9 * (1 + reach))
        assert line.own[part].tolist() == [0 <= p <= last for p in places]
        assert np.array_equal(line.source[part][line.own[part]], mine[: last + 1])
        assert (line.ring[part] == rings[chain]).all()
        at = part.stop
    assert at == len(points) == len(line.source) == len(line.own)


def test_a_straight_line_goes_on_straight_and_a_regular_ring_round():
    straight = PaddedChains(ChainIndex(np.arange(5), np.array([0, 5]), np.array([False])), np.array([True]), 13).points(
        np.arange(5) * (2 + 1j)
    )
    np.testing.assert_allclose(np.diff(straight), 2 + 1j, atol=1e-12)
    circle = np.exp(2j * np.pi * np.arange(7) / 7)
    ring = PaddedChains(ChainIndex(np.append(np.arange(7), 0), np.array([0, 8]), np.array([True])), np.array([True]), 20).points(circle)
    np.testing.assert_allclose(ring[1:] / ring[:-1], circle[1], atol=1e-12)


def test_smoothing_leaves_the_ends_of_open_chains_where_they_are():
    z = np.random.default_rng(0).random(20) + 1j * np.random.default_rng(1).random(20)
    kernel = np.hanning(13)[1:-1] / np.hanning(13).sum()
    line = PaddedChains(ChainIndex(np.arange(20), np.array([0, 20]), np.array([False])), np.array([True]), len(kernel) // 2)
    smooth = convolve(line.points(z), kernel)[line.own]
    assert smooth[[0, -1]] == pytest.approx(z[[0, -1]], abs=1e-12)
    assert np.abs(smooth - z).max() > 0.1


@pytest.mark.parametrize("length", [1, 3, 7])
def test_convolution_is_the_sum_it_stands_for(length):
    rng = np.random.default_rng(length)
    line, kernel = rng.random(30) + 1j * rng.random(30), rng.random(length)
    half = length // 2
    padded = np.pad(line, half)
    expected = [(padded[i : i + length] * kernel[::-1]).sum() for i in range(30)]
    np.testing.assert_allclose(convolve(line, kernel), expected, atol=1e-12)
