"""Dividing the segments of outlines: parts as long as wanted, growing evenly; what is known of them goes along."""

from __future__ import annotations

import math

import numpy as np
import pytest

from img2tri.triangles.generate.graded_lattice import lengths_near
from img2tri.triangles.generate.pslg import Pslg, _geometric, _log_mean


@pytest.mark.parametrize("ratio", [1e-6, 0.1, 0.5, 0.99, 1 - 1e-4, 1 + 1e-4, 1.3, 2.5, 1e6])
def test_the_logarithmic_mean(ratio):
    found = _log_mean(np.array([3.0]), np.array([3.0 * ratio]))[0]
    assert found == pytest.approx(3 * (ratio - 1) / math.log(ratio), rel=1e-11)


@pytest.mark.parametrize("near", [0.0, 1e-12, 9e-6, 1.1e-5, -1e-12, -9e-6, -1.1e-5])
def test_the_logarithmic_mean_of_equals(near):
    a, b = 3.0, 3.0 * (1 + near)
    # The series: (a + b) / 2 - (b - a)^2 / 12 a, beyond which there are terms of the third order.
    assert _log_mean(np.array([a]), np.array([b]))[0] == pytest.approx((a + b) / 2 - (b - a) ** 2 / (12 * a), rel=1e-10)


@pytest.mark.parametrize("ratio", [0.01, 0.7, 1.0, 1 + 1e-9, 1.2, 40.0])
def test_steps_of_even_share_grow_in_geometric_progression(ratio):
    ends = _geometric(np.linspace(0, 1, 9), np.full(9, ratio))
    steps = np.diff(ends)
    assert (ends[0], ends[-1]) == (0, pytest.approx(1))
    assert steps[1:] / steps[:-1] == pytest.approx(ratio ** (1 / 8))


def line(length):
    return Pslg(np.array([0, length], complex), np.array([[0, 1]]), np.array([4]), np.array([7]), np.array([11]))


def sizes(wanted):
    """Lengths as a function of x alone."""
    return lengths_near(np.zeros(1, complex), np.array([1e9]), 1e9, 0.5, lambda points: wanted(points[:, 0]))


@pytest.mark.parametrize("growth", [0.0, 0.02, 0.1])
def test_parts_have_the_length_wanted_where_they_are(growth):
    def wanted(x):
        return 1 + growth * np.minimum(x, 100 - x)

    parts, at_points, at_middles = line(100.0).divided(sizes(wanted))
    places = parts.points[parts.segments]
    assert places[0, 0] == 0
    assert places[-1, 1] == 100
    assert (places[1:, 0] == places[:-1, 1]).all()
    np.testing.assert_allclose(parts.lengths / wanted(parts.middles.real), 1, atol=0.08)
    np.testing.assert_allclose(at_points, wanted(parts.points.real))
    np.testing.assert_allclose(at_middles, wanted(parts.middles.real))
    assert set(parts.left) | set(parts.right) | set(parts.origin) == {4, 7, 11}
    assert parts.lengths[::-1] == pytest.approx(parts.lengths)


def test_what_is_short_enough_stays():
    given = line(1.2)
    parts, at_points, at_middles = given.divided(sizes(lambda x: np.full(len(x), 1.0)))
    assert parts is given
    assert (at_points.tolist(), at_middles.tolist()) == ([1, 1], [1])


def test_only_the_long_ones_are_divided():
    segments, left = np.array([[0, 1], [1, 2], [2, 0]]), np.array([1, 2, 3])
    given = Pslg(np.array([0, 1, 8 + 1j]), segments, left, np.zeros(3, int), np.array([5, 6, 7]))
    parts, _, at_middles = given.divided(sizes(lambda x: np.full(len(x), 1.0)))
    count = np.bincount(parts.origin)[5:]
    assert count.tolist() == [1, len(parts.left[parts.left == 2]), len(parts.left[parts.left == 3])]
    assert (count[1:] >= 7).all()
    assert len(at_middles) == count.sum()
    assert (parts.points[:3] == given.points).all()
    assert parts.segments[0].tolist() == [0, 1]
    assert np.array_equal(parts.segments[1:, 0], parts.segments[:-1, 1])


def test_slide_lines_are_parallel_to_the_line_between_neighbours():
    z = np.array([0, 2, 3 + 1j, 3 + 4j, 1j * 3])
    ring = np.stack([np.arange(5), (np.arange(5) + 1) % 5], axis=1)
    square = Pslg(z, ring, np.ones(5, int), np.zeros(5, int), np.arange(5))
    lines = square.slide_lines(np.array([0, 0.1, 0.2, 0.0, 0.3]))
    assert lines.at.tolist() == [1, 2, 4]
    assert lines.limits.tolist() == [0.1, 0.2, 0.3]
    assert (lines.start == z[[1, 2, 4]]).all()
    line = np.array([z[2] - z[0], z[3] - z[1], z[0] - z[3]])
    assert lines.along == pytest.approx(line / np.abs(line))


def test_what_ends_a_divided_segment_has_no_line():
    """The parts of a segment lie on one line, which would get a kink."""
    z = np.array([0, 8, 8 + 1j, 8 + 2j, 4 + 2j, 2j])
    ring = np.stack([np.arange(6), (np.arange(6) + 1) % 6], axis=1)
    outlines = Pslg(z, ring, np.ones(6, int), np.zeros(6, int), np.arange(6))
    divided, _, _ = outlines.divided(sizes(lambda x: np.full(len(x), 4.0)))
    assert len(divided.segments) == 7
    assert divided.slide_lines(np.full(6, 0.1)).at.tolist() == [2, 3, 4, 5]


def test_points_in_divided_segments_slide_and_stay_on_them():
    z = np.array([0, 8, 8 + 1j, 8 + 2j, 4 + 2j, 2j])
    ring = np.stack([np.arange(6), (np.arange(6) + 1) % 6], axis=1)
    divided, _, _ = Pslg(z, ring, np.ones(6, int), np.zeros(6, int), np.arange(6)).divided(sizes(lambda x: np.full(len(x), 2.5)))
    added = np.arange(6, len(divided.points))
    lines = divided.slide_lines(np.full(6, 0.1), within=0.3)
    assert lines.at.tolist() == [*range(6), *added]
    assert lines.limits[:6] == pytest.approx(0.1)
    assert (lines.limits[6:] > 0.3).all()
    # Wherever the ends go, the points between lie on the line between them, one after the other.
    rng = np.random.default_rng(0)
    moved = divided.points + 0.2 * np.exp(2j * np.pi * rng.random(len(divided.points)))
    found = divided.on_segments(6, moved)
    assert np.array_equal(found[:6], moved[:6])
    for segment in range(6):
        chain = divided.segments[divided.origin == segment]
        a, b = found[segment], found[(segment + 1) % 6]
        way = (found[np.append(chain[:, 0], chain[-1, 1])] - a) / (b - a)
        assert way.imag == pytest.approx(0, abs=1e-12)
        assert (np.diff(way.real) > 0).all()
    assert divided.on_segments(6, divided.points) == pytest.approx(divided.points)
