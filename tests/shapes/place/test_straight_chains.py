"""Open chains that may be straight lines are."""

from __future__ import annotations

import numpy as np
import pytest
from shapes.place.test_constrained_smoothing import sliding

from img2tri.shapes.place import straight_chains
from img2tri.shapes.place.constrained_smoothing import widest_fitting_spline
from img2tri.shapes.place.straight_chains import straightened

N = 90


def halves(angle, centre=(44.7, 45.2)):
    """Two regions on both sides of a line, that ends in a third one and at the frame."""
    y, x = np.mgrid[:N, :N] + 0.5
    across = (x - centre[0]) * np.sin(angle) - (N - y - centre[1]) * np.cos(angle)
    along = (x - centre[0]) * np.cos(angle) + (N - y - centre[1]) * np.sin(angle)
    labels = 1 + (across > 0).astype(int)
    labels[along > 15] = 3
    return labels


def inner_chains(s):
    """The open chains whose crossings slide."""
    return [s.chains.indices[a + 1 : b - 1] for a, b, r in zip(s.chains.starts, s.chains.starts[1:], s.chains.rings, strict=False) if not r]


def bent(z):
    """How far points are from the line through the first and the last of them, at most."""
    along = z[-1] - z[0]
    return np.abs(((z - z[0]) * along.conj()).imag / abs(along)).max()


def both(labels):
    """Chains, and their points on splines and straightened."""
    s = sliding(labels)
    shift, ends = widest_fitting_spline(s)
    again, ends_again = straightened(s, shift, ends)
    return s, shift, again, ends, ends_again


def test_straight_sides_are_straight_lines_and_nearer_to_the_true_ones():
    off, straight = [], 0
    for angle in np.linspace(0.03, 3.1, 24):
        s, shift, again, _, ends = both(halves(angle))
        assert (again >= s.low).all()
        assert (again <= s.high).all()
        for chain, at in enumerate(inner_chains(s)):
            changed = at[again[at] != shift[at]]
            within = changed[(again[changed] > s.low[changed]) & (again[changed] < s.high[changed])]
            if len(within) > 20:
                straight += 1
                z = s.points[within] + again[within] * s.axis[within]
                assert bent(z) < 1e-9
                assert np.abs((ends.direction[chain] * (z[-1] - z[0]).conj()).imag).max() < 1e-9
        true = (s.points - (44.7 + 45.2j)) * np.exp(-1j * angle)
        near = (np.abs(true.imag) < 1.5) & (true.real < 5) & (s.axis != 0)
        off += [[((true + one * s.axis * np.exp(-1j * angle)).imag[near] ** 2).mean() for one in (shift, again)]]
    spline, line = np.sqrt(np.mean(off, axis=0))
    assert straight > 12
    assert line < 0.045
    assert line < 0.95 * spline


def test_what_is_curved_stays_as_it_was():
    y, x = np.mgrid[:N, :N] + 0.5
    labels = 1 + (np.hypot(x - 45.2, N - y - 44.6) < 30).astype(int)
    labels[:, 50:] += 2
    s, shift, again, ends, ends_again = both(labels)
    z = s.points + again * s.axis
    round_ones = [at for at in inner_chains(s) if len(at) > 40 and bent(z[at]) > 5]
    assert len(round_ones) == 2
    for at in round_ones:
        np.testing.assert_array_equal(again[at], shift[at])
    assert (ends_again.scale >= ends.scale).all()


def test_rings_and_short_chains_are_left_alone():
    for labels in (np.pad(np.ones((20, 30), int), 4), np.indices((6, 6)).sum(0) % 2, np.zeros((5, 5), int)):
        _, shift, again, ends, ends_again = both(labels)
        np.testing.assert_array_equal(again, shift)
        np.testing.assert_array_equal(ends_again.scale, ends.scale)


@pytest.mark.parametrize("slope", [0.0, 0.03, 0.31, 0.618, 0.93])
def test_the_line_is_the_mean_of_all_that_part_the_same_pixels(slope):
    """Against lines tried at random, told by their heights at both ends."""
    x, rng = np.arange(24.0), np.random.default_rng(1)
    z = x + 1j * np.round(slope * x + 0.2)
    count, turn = len(z), np.exp(0.4j)
    middle, line = straight_chains._least_squares(z, np.zeros(count, int), 1)
    ends = line[0] * np.array([-1, 1]) * (np.abs(((z - middle) / line).real).max() + 1) + middle
    heights = ends.imag[:, None] + rng.uniform(-0.8, 0.8, (2, 200_000))
    share = ((x - ends[0].real) / (ends[1] - ends[0]).real)[:, None]
    parts = (np.abs((1 - share) * heights[0] + share * heights[1] - z.imag[:, None]) < 0.5).all(axis=0)
    assert parts.sum() > 300
    true = ends.real + 1j * heights[:, parts].mean(axis=1)
    # Turned, beside a group that is not chosen.
    turned = np.concatenate([z * turn, z]), np.concatenate([np.full(count, 1j) * turn, np.full(count, 1j)])
    which, lines = np.arange(2).repeat(count), np.array([line[0] * turn, line[0]])
    middles = np.array([middle[0] * turn, middle[0]])
    found, along = straight_chains._mean_of_possible(*turned, which, middles, lines, np.array([True, False]))
    off = ((true * turn - found[0]) * along[0].conj()).imag
    assert np.abs(off).max() < 0.03
    assert (found[1], along[1]) == (middles[1], lines[1])


def test_it_is_nearer_to_the_true_line_than_that_of_least_squares(monkeypatch):
    def off():
        found = []
        for angle in np.linspace(0.05, 3.0, 40):
            s, _, again, _, _ = both(halves(angle))
            true = (s.points + again * s.axis - (44.7 + 45.2j)) * np.exp(-1j * angle)
            found.append(true.imag[(np.abs(true.imag) < 1.5) & (true.real < 5) & (s.axis != 0)])
        return np.sqrt(np.mean(np.concatenate(found) ** 2))

    mean = off()
    monkeypatch.setattr(straight_chains, "_mean_of_possible", lambda z, axis, which, middle, line, chosen: (middle, line))
    assert mean < 0.037
    assert mean < 0.9 * off()
