"""The smallest angle of a triangle, its tangent, and comparing by it."""

from __future__ import annotations

import numpy as np
import oracles
from scipy.spatial import Delaunay

from img2tri.arrays import as_complex
from img2tri.triangles.min_angle_tangents import min_angle_tangents, narrower, smallest_angles


def random_mesh(seed):
    """Counter-clockwise triangles of random points."""
    points = np.random.default_rng(seed).random((300, 2))
    triangles = Delaunay(points).simplices.astype(np.int64)
    clockwise = oracles.areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return points, triangles


def test_the_smallest_angle_is_that_of_the_definition():
    points, triangles = random_mesh(1)
    z = as_complex(points)
    assert np.allclose(smallest_angles(z, triangles), oracles.angles(points, triangles).min(axis=1), atol=1e-6)
    assert (smallest_angles(z, triangles[:, ::-1]) == -smallest_angles(z, triangles)).all()


def test_triangles_are_told_by_the_angle_given():
    points, triangles = random_mesh(2)
    z = as_complex(points)
    for degrees in (0, 12.3, 45):
        assert (narrower(z, triangles, degrees) == (smallest_angles(z, triangles) < degrees)).all()
        assert narrower(z, triangles[:, ::-1], degrees).all()


def test_triangles_without_area_have_none():
    z = np.array([0, 1, 2, 0, 0], complex)
    assert min_angle_tangents(z, np.array([[0, 1, 2], [0, 3, 4]])).tolist() == [0, 0]
    assert min_angle_tangents(z, np.zeros((0, 3), np.int64)).shape == (0,)
