"""The hexagonal lattice: regions of nodes, neighbours, and the triangles written directly, against slow and simple counterparts."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely

from img2tri.arrays import as_rows
from img2tri.triangles.generate.hexagonal_lattice import Lattice


def star(n=40, scale=10.0):
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return scale * (1 + 0.3 * np.cos(5 * turn)) * np.exp(1j * turn)


def labelled(pitch=0.7, inside=3):
    points = star()
    lattice = Lattice.over(points, pitch)
    segments = np.stack([np.arange(40), (np.arange(40) + 1) % 40], axis=1)
    codes = lattice.codes(points, segments, np.full(40, inside), np.zeros(40, np.int64))
    return lattice, codes, shapely.Polygon(as_rows(points))


def everywhere(lattice):
    return lattice.positions(np.arange(lattice.count))


def test_neighbours_lie_one_pitch_away():
    lattice = Lattice.over(star(), 0.7)
    z = everywhere(lattice)
    w = lattice.width
    inner = np.flatnonzero(shapely.contains_xy(shapely.box(-12, -12, 12, 12), as_rows(z)))
    for step in (-w, 1 - w, -1, 1, w - 1, w):
        assert np.abs(z[inner + step] - z[inner]) == pytest.approx(0.7)
    assert len(np.unique(np.round(z, 6))) == lattice.count


def test_regions_of_nodes_are_those_of_the_polygon():
    lattice, codes, polygon = labelled()
    inside = shapely.contains_xy(polygon, as_rows(everywhere(lattice)))
    assert (codes == 3 * inside).all()


def test_regions_beside_each_other_and_turned_segments():
    square = np.array([0, 2, 2 + 1j, 1j, 1, 1 + 1j]) * 10 - 0.123j
    segments = np.array([[0, 4], [1, 4], [1, 2], [2, 5], [5, 3], [3, 0], [4, 5]])
    left, right = np.array([1, 0, 2, 2, 1, 1, 1]), np.array([0, 2, 0, 0, 0, 0, 2])
    lattice = Lattice.over(square, 0.31)
    z = everywhere(lattice)
    codes = lattice.codes(square, segments, left, right)
    inside = (z.real > 0) & (z.real < 20) & (z.imag > -0.123) & (z.imag < 10 - 0.123)
    clear = np.abs(z.real - 10) > 1e-6
    assert (codes == np.where(inside, np.where(z.real < 10, 1, 2), 0))[clear].all()


@pytest.mark.parametrize("radius", [0.2, 0.5, 0.75, 0.99])
def test_nodes_around_points(radius):
    lattice = Lattice.over(star(), 0.7)
    centres = star(17, 8.0)
    near = lattice.near(centres, radius * 0.7 * np.linspace(0.5, 1, 17))
    expected = np.nonzero(np.abs(everywhere(lattice)[:, None] - centres) < radius * 0.7 * np.linspace(0.5, 1, 17))
    assert set(zip(*(part.tolist() for part in near), strict=True)) == set(zip(*(part.tolist() for part in expected), strict=True))


def test_erosion_and_dilation_go_to_the_six_neighbours():
    lattice, codes, _ = labelled()
    w = lattice.width
    ring = np.array([-w, 1 - w, -1, 1, w - 1, w])
    inner = np.arange(w, lattice.count - w)
    kept = inner[(codes[inner[:, None] + ring] == codes[inner, None]).all(axis=1)]
    expected = np.zeros_like(codes)
    expected[kept] = codes[kept]
    assert (lattice.eroded(codes) == expected).all()
    marked = np.zeros(lattice.count, bool)
    centre = int(np.abs(everywhere(lattice)).argmin())
    marked[centre] = True
    assert set(np.flatnonzero(lattice.dilated(marked, 1))) == {centre, *(centre + ring)}
    assert np.count_nonzero(lattice.dilated(marked, 2)) == 19


def core_mesh():
    lattice, codes, polygon = labelled()
    core = lattice.core(lattice.eroded(codes))
    nodes = core.nodes()
    triangles, regions = np.zeros((len(core), 3), np.int64), np.zeros(len(core), np.int64)
    core.write(np.cumsum(nodes) - 1, triangles, regions)
    return core, nodes, as_rows(lattice.positions(np.flatnonzero(nodes))), triangles, regions, polygon


def test_the_triangles_of_the_core_are_equilateral_and_all_there():
    core, _, vertices, triangles, regions, polygon = core_mesh()
    assert oracles.angles(vertices, triangles) == pytest.approx(60)
    assert oracles.areas(vertices, triangles) == pytest.approx(0.7**2 * 3**0.5 / 4)
    assert (regions == 3).all()
    assert len(np.unique(np.sort(triangles, axis=1), axis=0)) == len(triangles)
    # Every triple of neighbouring kept nodes is a triangle: as many as found by brute force.
    codes = core.codes
    z = core.lattice.positions(np.flatnonzero(codes))
    near = np.abs(z[:, None] - z) < 0.71
    np.fill_diagonal(near, False)
    assert np.trace(np.linalg.matrix_power(near.astype(float), 3)) / 6 == len(triangles)
    assert shapely.contains_xy(polygon, vertices).all()


def test_the_rim_is_the_boundary_with_the_triangles_on_its_left():
    core, nodes, vertices, triangles, _, _ = core_mesh()
    rim = (np.cumsum(nodes) - 1)[core.rim()]
    assert {tuple(sorted(e)) for e in rim.tolist()} == set(map(tuple, oracles.boundary(triangles).tolist()))
    directed = {(t[k], t[(k + 1) % 3]) for t in triangles.tolist() for k in range(3)}
    assert all(tuple(e) in directed for e in rim.tolist())
    assert len(np.unique(triangles)) == len(vertices)


def test_an_empty_lattice_has_no_core():
    lattice, codes, _ = labelled()
    core = lattice.core(np.zeros_like(codes))
    assert len(core) == 0
    assert len(core.rim()) == 0
    assert not core.nodes().any()


def test_a_large_core_is_written_block_by_block():
    lattice, codes, _ = labelled(0.1)
    assert lattice.count > 2 * 2**15
    core = lattice.core(lattice.eroded(codes))
    numbers = np.arange(lattice.count)
    triangles, regions = np.zeros((len(core), 3), np.int64), np.zeros(len(core), np.int64)
    core.write(numbers, triangles, regions)
    z = everywhere(lattice)[triangles]
    assert abs(z - np.roll(z, 1, axis=1)) == pytest.approx(0.1)
    assert ((z[:, 1] - z[:, 0]).conj() * (z[:, 2] - z[:, 0])).imag.min() > 0
    assert len(np.unique(np.sort(triangles, axis=1), axis=0)) == len(triangles)
    assert (regions == 3).all()
    assert set(np.unique(triangles)) == set(np.flatnonzero(core.nodes()))
