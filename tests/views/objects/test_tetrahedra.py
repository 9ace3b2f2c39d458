"""Wedges cut into tetrahedra: neighbours agree, nothing is lost, the sets are the same surfaces."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv
from views.solver_meshes import HEIGHT, made, sizes

from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid


@pytest.mark.parametrize("kind", ["tetra", "tetra10"])
def test_they_fill_the_solid_and_every_inner_side_has_two(kind):
    mesh, wedges = made(kind), made("wedge")
    corners = mesh.points[mesh.cells[:, :4]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(sum(sizes(True)[0].values()), rel=1e-12)
    sides = np.sort(mesh.cells[:, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]].reshape(-1, 3), axis=1)
    _, counts = np.unique(sides, axis=0, return_counts=True)
    outside = sum(len(mesh.sides[name]) for name in mesh.wholes if "__" not in name)
    assert set(counts.tolist()) == {1, 2}
    assert (counts == 1).sum() == outside
    assert np.array_equal(mesh.regions, np.repeat(wedges.regions, 3))


@pytest.mark.parametrize("kind", ["tetra", "tetra10"])
def test_sets_have_their_sizes_and_look_outwards(kind):
    mesh = made(kind)
    for name, size in sizes(True)[1].items():
        p, q, r = (mesh.points[mesh.facets(name)[:, k]] for k in range(3))
        normal = np.cross(q - p, r - p)
        assert np.linalg.norm(normal, axis=1).sum() / 2 == pytest.approx(size, rel=1e-12), name
        inward = mesh.points[mesh.cells[mesh.sides[name][:, 0], :4]].mean(axis=1) - (p + q + r) / 3
        assert np.all((normal * inward).sum(axis=1) < 0)


def test_nodes_in_the_middle_lie_there_and_vtk_agrees():
    mesh = made("tetra10")
    p = mesh.points[mesh.cells]
    for node, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], start=4):
        assert p[:, node] == pytest.approx((p[:, a] + p[:, b]) / 2, abs=1e-12)
    grid = to_grid(mesh)
    assert set(grid.celltypes.tolist()) == {pv.CellType.QUADRATIC_TETRA}
    assert grid.volume == pytest.approx(sum(sizes(True)[0].values()))
    assert grid.bounds[4:] == pytest.approx((0.5, 0.5 + HEIGHT))
