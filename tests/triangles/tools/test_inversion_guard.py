"""The guard: what it promises of every move, and that it does not put back more than it must."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import angles, areas
from scipy.spatial import Delaunay

from img2tri.triangles.tools.inversion_guard import put_back


def mesh(seed, n=80):
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    triangles = Delaunay(points).simplices.astype(np.int64)
    clockwise = areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return points, triangles[np.abs(areas(points, triangles)) > 1e-6], rng


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.001, 1.0))
def test_nothing_turns_over_and_the_worst_angle_does_not_fall(seed, size):
    v, t, rng = mesh(seed)
    after = v + rng.normal(size=v.shape) * size
    kept = put_back(v, after, t)
    assert (areas(kept, t) > 0).all()
    assert angles(kept, t).min() >= angles(v, t).min() - 1e-9
    assert ((kept == v) | (kept == after)).all()


def test_a_sound_move_is_left_alone():
    v, t, _ = mesh(1)
    after = v @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + 3
    assert (put_back(v, after, t) == after).all()


def test_only_what_is_near_the_damage_is_put_back():
    v, t, _ = mesh(2, 400)
    grown = v * 1.0001
    grown[7] += 0.5
    back = (put_back(v, grown, t) == v).all(axis=1)
    assert back[7]
    assert 0 < back.sum() < 0.1 * len(v)


def test_triangles_turned_over_before_do_not_stop_the_rest():
    v, t, _ = mesh(4)
    t[0] = t[0, ::-1]
    after = v + np.array([1.0, 2.0])
    np.testing.assert_array_equal(put_back(v, after, t), after)


@pytest.mark.parametrize("size", [0.0, 1e3])
def test_it_ends_at_both_extremes(size):
    v, t, rng = mesh(5)
    after = v + rng.normal(size=v.shape) * size
    np.testing.assert_array_equal(put_back(v, after, t), v)
