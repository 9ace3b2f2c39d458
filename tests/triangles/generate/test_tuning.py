"""What the constants of this room are worth: worst angles, qualities, counts over many fillings, so that none is changed for the worse.

Outlines are given, so that nothing here depends on how they are made. Whoever makes something better may raise the values.
"""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from networks import NETWORKS, network, ring, wave

from img2tri.triangles.generate.filling import begin, fill, finish


def uneven(n, scale, seed):
    """A wavy outline with segments of uneven length."""
    points = wave(4 * n, scale, lobes=3 + seed, depth=0.25)
    kept = np.sort(np.random.default_rng(seed).choice(4 * n, n, replace=False))
    return points[kept]


def check(meshes, angle, quality, count):
    """Mean of the worst angles, of the mean qualities, and of the number of triangles are as good as they were, or better."""
    rows = []
    for vertices, triangles, _ in meshes:
        angles = oracles.angles(vertices, triangles)
        rows.append((angles.min(), 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean(), len(triangles)))
    found = np.mean(rows, axis=0)
    assert found[0] > angle - 1.0
    assert found[1] > quality - 0.0008
    assert found[2] == pytest.approx(count, rel=0.015)


def test_even_and_uneven_outlines():
    check(
        [
            fill(*network((uneven(90, 60, seed), 1, 0), (ring(20 + 3 * seed, 12, (5.0, 3.0 * seed)), 0, 1)), edge_length=5.0, seed=seed)
            for seed in range(6)
        ],
        38.1,
        0.9716,
        2180,
    )


def test_graded_lengths():
    def growing(places):
        return 0.8 + 0.25 * np.abs(places[:, 0] + 30)

    meshes = [fill(*network((wave(140, 60, lobes=3), 1, 0)), edge_length=9.0, size=growing, gradation=0.25, seed=seed) for seed in range(4)]
    check(meshes, 36.1, 0.9673, 3293)


def test_points_that_slide():
    meshes = []
    for seed in range(5):
        given = network((wave(75, 60, lobes=4), 1, 0), (ring(24, 20, (1.0 * seed, 0.5)), 0, 1))
        meshes.append(finish(begin(*given, edge_length=5.0, limits=np.full(len(given[0]), 0.6), seed=seed))[:3])
    check(meshes, 45.1, 0.9868, 885)


@pytest.mark.parametrize(("name", "reached"), [("grains", (41.0, 0.9738, 480)), ("speck", (39.8, 0.9842, 2208))])
def test_networks(name, reached):
    given, edge_length = NETWORKS[name]
    check([fill(*given, edge_length=edge_length, seed=seed) for seed in range(5)], *reached)
