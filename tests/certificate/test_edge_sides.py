"""Edges and what lies on their sides, against loops; whether few angles are measured and the right ones."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from scipy.spatial import Delaunay

from img2tri.certificate.edge_sides import EdgeSides
from img2tri.certificate.min_angle_check import angles_below
from img2tri.certificate.outline_distance import SegmentSet


def random_mesh(seed, n=200):
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    triangles = Delaunay(points).simplices.astype(np.int64)
    clockwise = oracles.areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return points, triangles, rng.integers(0, 3, len(triangles))


@pytest.mark.parametrize("seed", range(3))
def test_the_sides_of_each_edge(seed):
    _, triangles, number = random_mesh(seed)
    triangles = np.concatenate([triangles, [[0, 1, 2], [1, 0, 3], [0, 1, 4]]])  # edges of many triangles, too
    number = np.append(number, [5, 7, 6])
    sides = EdgeSides.of(triangles)
    found = {}
    for i, t in enumerate(triangles.tolist()):
        for k in range(3):
            found.setdefault(tuple(sorted((t[k], t[(k + 1) % 3]))), []).append(3 * i + k)
    chosen = np.arange(len(found)) % 3 != 1
    for some, which in ((sides, np.ones_like(chosen)), (sides.among(chosen), chosen)):
        assert [edge for edge, there in zip(sorted(found), which, strict=True) if there] == list(map(tuple, some.edges.tolist()))
        ends = some.at_both_ends()
        for i, edge in enumerate(map(tuple, some.edges.tolist())):
            at = found[edge]
            assert some.sides[some.starts[i] : some.starts[i + 1]].tolist() == at
            assert (some.counts[i], ends[0][i], ends[1][i]) == (len(at), at[0], at[-1])
            assert (some.edge[some.starts[i] : some.starts[i + 1]] == i).all()
    parting = [len(at) != 2 or number[at[0] // 3] != number[at[1] // 3] for _, at in sorted(found.items())]
    assert sides.curves(number).tolist() == parting
    assert sides.curves(np.zeros_like(number)).tolist() == [len(at) != 2 for _, at in sorted(found.items())]


@pytest.mark.parametrize("below", [0.0, 5.0, 30.0])
def test_no_small_angle_is_missed(below):
    points, triangles, _ = random_mesh(4)
    all_angles = oracles.angles(points, triangles).min(axis=1)
    which, angles = angles_below(points, triangles, below)
    assert angles == pytest.approx(all_angles[which])
    assert angles.min() == pytest.approx(all_angles.min())
    assert set(np.flatnonzero(all_angles < below)) <= set(which.tolist())
    assert len(which) <= max(1, (all_angles < below + 1e-3).sum())


@pytest.mark.parametrize("seed", range(4))
def test_distances_are_those_to_the_nearest_of_all_segments(seed):
    rng = np.random.default_rng(seed)
    points = rng.random((30, 2)) * 40
    segments = rng.integers(0, 30, (25, 2))
    segments = segments[segments[:, 0] != segments[:, 1]]
    places = rng.random((400, 2)) * 60 - 10
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    share = np.clip(((places[:, None] - a) * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1), 0, 1)
    slow = np.linalg.norm(places[:, None] - a - share[..., None] * (b - a), axis=2).min(axis=1)
    found = SegmentSet(points, segments)
    assert found.distance(places) == pytest.approx(slow, abs=1e-12)
    assert found.distance(found.places) == pytest.approx(0, abs=1e-12)
    assert SegmentSet(points, segments[:1]).distance(a[:1]) == 0
