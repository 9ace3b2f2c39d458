"""The hexagonal lattice: regions of nodes, neighbours, and the triangles written directly, against slow and simple counterparts."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely

from img2tri.triangles.generate.graded_lattice import pairs
from img2tri.triangles.generate.hexagonal_lattice import Lattice


def star(n=40, scale=10.0):
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return scale * (1 + 0.3 * np.cos(5 * turn)) * np.exp(1j * turn)


def labelled(pitch=0.7, inside=3):
    points = star()
    lattice = Lattice.over(points, pitch)
    segments = np.stack([np.arange(40), (np.arange(40) + 1) % 40], axis=1)
    labels = lattice.labels(points, segments, np.full(40, inside), np.zeros(40, np.int64))
    return lattice, labels, shapely.Polygon(pairs(points))


def everywhere(lattice):
    return lattice.positions(np.arange(lattice.count))


def test_neighbours_lie_one_pitch_away():
    lattice = Lattice.over(star(), 0.7)
    z = everywhere(lattice)
    w = lattice.width
    inner = np.flatnonzero(shapely.contains_xy(shapely.box(-12, -12, 12, 12), pairs(z)))
    for step in (-w, 1 - w, -1, 1, w - 1, w):
        assert np.abs(z[inner + step] - z[inner]) == pytest.approx(0.7)
    assert len(np.unique(np.round(z, 6))) == lattice.count


def test_regions_of_nodes_are_those_of_the_polygon():
    lattice, labels, polygon = labelled()
    inside = shapely.contains_xy(polygon, pairs(everywhere(lattice)))
    assert (labels == 3 * inside).all()


def test_regions_beside_each_other_and_turned_segments():
    square = np.array([0, 2, 2 + 1j, 1j, 1, 1 + 1j]) * 10 - 0.123j
    segments = np.array([[0, 4], [1, 4], [1, 2], [2, 5], [5, 3], [3, 0], [4, 5]])
    left, right = np.array([1, 0, 2, 2, 1, 1, 1]), np.array([0, 2, 0, 0, 0, 0, 2])
    lattice = Lattice.over(square, 0.31)
    z = everywhere(lattice)
    labels = lattice.labels(square, segments, left, right)
    inside = (z.real > 0) & (z.real < 20) & (z.imag > -0.123) & (z.imag < 10 - 0.123)
    clear = np.abs(z.real - 10) > 1e-6
    assert (labels == np.where(inside, np.where(z.real < 10, 1, 2), 0))[clear].all()


@pytest.mark.parametrize("radius", [0.2, 0.5, 0.75, 0.99])
def test_nodes_around_points(radius):
    lattice = Lattice.over(star(), 0.7)
    centres = star(17, 8.0)
    found = np.unique(lattice.around(centres, np.full(17, radius * 0.7)))
    distance = np.abs(everywhere(lattice)[:, None] - centres).min(axis=1)
    assert (found == np.flatnonzero(distance < radius * 0.7)).all()


def test_erosion_and_growth_go_to_the_six_neighbours():
    lattice, labels, _ = labelled()
    w = lattice.width
    ring = np.array([-w, 1 - w, -1, 1, w - 1, w])
    inner = np.arange(w, lattice.count - w)
    kept = inner[(labels[inner[:, None] + ring] == labels[inner, None]).all(axis=1)]
    expected = np.zeros_like(labels)
    expected[kept] = labels[kept]
    assert (lattice.eroded(labels) == expected).all()
    marked = np.zeros(lattice.count, bool)
    centre = int(np.abs(everywhere(lattice)).argmin())
    marked[centre] = True
    assert set(np.flatnonzero(lattice.grown(marked, 1))) == {centre, *(centre + ring)}
    assert np.count_nonzero(lattice.grown(marked, 2)) == 19


def depth_mesh():
    lattice, labels, polygon = labelled()
    depth = lattice.depth(lattice.eroded(labels))
    nodes = depth.nodes()
    triangles, regions = np.zeros((len(depth), 3), np.int64), np.zeros(len(depth), np.int64)
    depth.write(np.cumsum(nodes) - 1, triangles, regions)
    return depth, nodes, pairs(lattice.positions(np.flatnonzero(nodes))), triangles, regions, polygon


def test_the_triangles_of_the_depth_are_equilateral_and_all_there():
    depth, _, vertices, triangles, regions, polygon = depth_mesh()
    assert oracles.angles(vertices, triangles) == pytest.approx(60)
    assert oracles.areas(vertices, triangles) == pytest.approx(0.7**2 * 3**0.5 / 4)
    assert (regions == 3).all()
    assert len(np.unique(np.sort(triangles, axis=1), axis=0)) == len(triangles)
    # Every triple of neighbouring kept nodes is a triangle: as many as found by brute force.
    labels = depth.labels
    z = depth.lattice.positions(np.flatnonzero(labels))
    near = np.abs(z[:, None] - z) < 0.71
    np.fill_diagonal(near, False)
    assert np.trace(np.linalg.matrix_power(near.astype(float), 3)) / 6 == len(triangles)
    assert shapely.contains_xy(polygon, vertices).all()


def test_the_front_is_the_boundary_with_the_triangles_on_its_left():
    depth, nodes, vertices, triangles, _, _ = depth_mesh()
    front = (np.cumsum(nodes) - 1)[depth.front()]
    assert {tuple(sorted(e)) for e in front.tolist()} == set(map(tuple, oracles.boundary(triangles).tolist()))
    directed = {(t[k], t[(k + 1) % 3]) for t in triangles.tolist() for k in range(3)}
    assert all(tuple(e) in directed for e in front.tolist())
    assert len(np.unique(triangles)) == len(vertices)


def test_an_empty_lattice_has_no_depth():
    lattice, labels, _ = labelled()
    depth = lattice.depth(np.zeros_like(labels))
    assert len(depth) == 0
    assert len(depth.front()) == 0
    assert not depth.nodes().any()


def test_a_large_depth_is_written_block_by_block():
    lattice, labels, _ = labelled(0.1)
    assert lattice.count > 2 * 2**15
    depth = lattice.depth(lattice.eroded(labels))
    numbers = np.arange(lattice.count)
    triangles, regions = np.zeros((len(depth), 3), np.int64), np.zeros(len(depth), np.int64)
    depth.write(numbers, triangles, regions)
    z = everywhere(lattice)[triangles]
    assert abs(z - np.roll(z, 1, axis=1)) == pytest.approx(0.1)
    assert ((z[:, 1] - z[:, 0]).conj() * (z[:, 2] - z[:, 0])).imag.min() > 0
    assert len(np.unique(np.sort(triangles, axis=1), axis=0)) == len(triangles)
    assert (regions == 3).all()
    assert set(np.unique(triangles)) == set(np.flatnonzero(depth.nodes()))
