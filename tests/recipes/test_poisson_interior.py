"""Scattered points inside: all promises hold with them too, and lengths are those wanted."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens

from img2tri import mesh_image
from img2tri.arrays import ChainIndex
from img2tri.recipes.poisson_interior import scattered
from img2tri.triangles.generate.constrained_delaunay import PslgError
from img2tri.types import Outlines


@pytest.mark.parametrize("name", ["disc", "ring", "spiral", "comb", "polycrystal", "island in island"])
def test_all_promises_hold(name):
    labels = specimens.ALL[name]
    mesh = mesh_image(labels, labels=True, edge_length=4, interior="poisson")
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6
    oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, labels)


def test_another_seed_scatters_other_points_and_leaves_the_outlines():
    one, other = (mesh_image(specimens.disc(60, 25), edge_length=4, interior="poisson", seed=seed) for seed in (0, 1))
    assert len(one.vertices) != len(other.vertices) or not np.array_equal(one.vertices, other.vertices)
    assert one.report.areas[1]["mesh"] == pytest.approx(other.report.areas[1]["mesh"])


def test_lengths_follow_the_field():
    mesh = mesh_image(np.ones((120, 120), bool), edge_length=lambda p: 2 + 0.08 * p[:, 0], interior="poisson")
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    size = np.sqrt(oracles.areas(mesh.vertices, mesh.triangles) * 4 / 3**0.5)
    wanted = 2 + 0.08 * middle[:, 0]
    assert 0.7 < np.median(size / wanted) < 1.2
    assert np.median(size[middle[:, 0] > 90]) > 2 * np.median(size[middle[:, 0] < 30])


def test_an_outline_that_meets_itself_is_told_as_any_mesh_tells_it():
    """So that the recipe mends the outlines, and tries again."""
    points = np.array([[0.0, 0], [6, 0], [6, 4], [2, -1]])
    ring = ChainIndex(np.array([0, 1, 2, 3, 0]), np.array([0, 5]), np.array([True]))
    with pytest.raises(PslgError, match="Self-intersection"):
        scattered(Outlines(points, ring, np.array([1]), np.array([0]), np.array([0, 1])), 1.0, None, min_angle=30.0, seed=0)
