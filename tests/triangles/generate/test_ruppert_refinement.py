"""The safety net: what must stay whole stays whole, or it says that it cannot help."""

from __future__ import annotations

import numpy as np
import oracles
import pytest

from img2tri.arrays import as_complex, as_rows
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.ruppert_refinement import RESERVE, refine_locally, refine_with_reserve

FLAT = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 1.0]])  # a rectangle of two triangles with angles of 6 degrees
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
ELSEWHERE = np.array([[20.0, 0.0], [22.0, 0.0], [21.0, 1.7]])


def mesh(apart):
    """The flat rectangle, and with `apart` a triangle that hangs together with nothing."""
    points, triangles = FLAT, TRIANGLES
    segments = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    if apart:
        points, triangles = np.concatenate([points, ELSEWHERE]), np.concatenate([triangles, [[4, 5, 6]]])
        segments = np.concatenate([segments, [[4, 5], [5, 6], [6, 4]]])
    z, n = as_complex(points), len(segments)
    constraints = Pslg(z, segments, np.ones(n, np.int64), np.zeros(n, np.int64), np.full(n, -1))
    return z, triangles, np.ones(len(triangles), np.int64), constraints


@pytest.mark.parametrize("apart", [False, True])
def test_segments_that_must_stay_whole_are_never_split_in_silence(apart):
    assert refine_locally(*mesh(apart), n_outline=0, min_angle=20.0) is None


@pytest.mark.parametrize("apart", [False, True])
def test_where_segments_may_be_split_angles_become_large_enough(apart):
    vertices, triangles, codes, constraints = mesh(apart)
    found = refine_locally(vertices, triangles, codes, constraints, n_outline=len(constraints.segments), min_angle=20.0)
    assert found is not None
    places, refined, regions = found
    assert np.array_equal(places[: len(vertices)], vertices)
    assert len(regions) == len(refined) > len(triangles)
    oracles.check_valid(as_rows(places), refined)
    assert np.bincount(refined.ravel(), minlength=len(places)).all()


@pytest.mark.parametrize("min_angle", [20.0, 30.0])
def test_a_few_points_more_give_better_angles_than_wanted(min_angle):
    vertices, triangles, codes, constraints = mesh(apart=True)
    places, refined, _ = refine_with_reserve(vertices, triangles, codes, constraints, len(constraints.segments), min_angle)
    oracles.check_valid(as_rows(places), refined)
    assert oracles.angles(as_rows(places), refined).min() >= min_angle + RESERVE - 1e-9


def test_where_that_would_take_many_points_the_angle_wanted_is_enough():
    given = mesh(apart=False)
    segments = len(given[3].segments)
    assert oracles.angles(*map(np.asarray, (as_rows((made := refine_with_reserve(*given, segments, 37.0))[0]), made[1]))).min() < 39
    usual = refine_locally(*given, segments, 37.0)
    assert np.array_equal(made[1], usual[1])
