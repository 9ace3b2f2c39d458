from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from oracles import areas, edge_counts
from views.plates import STRIP_AREA, cells, is_closed, ring, strip, volume
from views.solver_meshes import elements

from img2tri.arrays import unique_edges
from img2tri.errors import MeshError, ParameterError
from img2tri.triangles.tools import topology
from img2tri.views.objects.extruded_wedges import quadratic, wedges
from img2tri.views.objects.region_borders import bordering

GAUSS = np.array([-1, 1]) / np.sqrt(3)
INSIDE = np.array([[1, 1], [4, 1], [1, 4]]) / 6  # of the triangle, exact for squares


def gradients(r, s, t, nodes):
    """d N / d (r, s, t), (nodes, 3), of the wedge with 6 or 15 nodes in the order of VTK; t from -1 at the base to 1 at the top.

    From the textbook's shape functions, by central differences, which are exact for polynomials of this degree up to rounding.
    """

    def shape(r, s, t):
        a, b, c = 1 - r - s, r, s
        if nodes == 6:
            return np.array([x * (1 + u * t) / 2 for u in (-1, 1) for x in (a, b, c)])
        corner = [x * ((2 * x - 1) * (1 + u * t) - (1 - t * t)) / 2 for u in (-1, 1) for x in (a, b, c)]
        flat = [2 * x * y * (1 + u * t) for u in (-1, 1) for x, y in ((a, b), (b, c), (c, a))]
        return np.array(corner + flat + [x * (1 - t * t) for x in (a, b, c)])

    assert shape(r, s, t).sum() == pytest.approx(1)
    h, x = 1e-4, np.array([r, s, t])
    return np.stack([(shape(*(x + h * e)) - shape(*(x - h * e))) / (2 * h) for e in np.eye(3)], axis=1)


def volumes(points, wedge):
    """Volume of each wedge by Gauss points, and the least Jacobian at any of them and at any corner."""
    p = points[wedge]
    at = [(r, s, t) for r, s in INSIDE for t in GAUSS]
    corners = [(r, s, t) for t in (-1, 1) for r, s in ((0, 0), (1, 0), (0, 1))]
    jacobian = np.array([np.linalg.det(np.einsum("knc,nd->kcd", p, gradients(*q, wedge.shape[1]))) for q in at + corners])
    return jacobian[: len(at)].sum(axis=0) / 6, jacobian.min()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("layers", [1, 3])
def test_wedges_fill_the_solid_with_positive_jacobians(order, layers):
    vertices, triangles = ring()
    points, wedge, regions = wedges(vertices, triangles, height=2.5, layers=layers, order=order, z=-1)
    assert wedge.shape == (24 * layers, {1: 6, 2: 15}[order])
    each, least = volumes(points, wedge)
    assert least > 0
    assert each == pytest.approx(np.tile(areas(vertices, triangles), layers) * 2.5 / layers, rel=1e-7)
    assert each.sum() == pytest.approx(12 * 2.5, rel=1e-7)
    assert np.array_equal(np.unique(wedge), np.arange(len(points)))
    assert len(np.unique(points.round(9), axis=0)) == len(points)
    assert (points[:, 2].min(), points[:, 2].max()) == (-1, 1.5)
    assert set(regions.tolist()) == {1}


def test_layers_are_conforming():
    """Each triangle between two layers and each wall between two wedges is one and the same face for both."""
    vertices, triangles = ring()
    points, wedge, _ = wedges(vertices, triangles, height=1, layers=3)
    flat = np.concatenate([wedge[:, [0, 1, 2]], wedge[:, [3, 4, 5]]])
    walls = np.concatenate([wedge[:, k] for k in ([0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5])])
    for faces, outside in ((flat, 2 * 24), (walls, 3 * 24)):
        _, count = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
        assert sorted(set(count.tolist())) == [1, 2]
        assert (count == 1).sum() == outside
    shell = pv.UnstructuredGrid({pv.CellType.WEDGE: wedge}, points).extract_surface(algorithm=None).triangulate()
    assert is_closed(shell.regular_faces)
    assert volume(np.asarray(shell.points), shell.regular_faces) == pytest.approx(12)


@pytest.mark.parametrize("order", [1, 2])
def test_vtk_agrees_on_order_and_volume(order):
    vertices, triangles, regions = strip()
    q = np.linspace(0.5, 1, len(triangles))
    made = elements(vertices, triangles, regions, height=2, layers=2, order=order, z=1, cell_data={"q": q}, field_data={"units": "mm"})
    assert set(made.celltypes.tolist()) == {{1: pv.CellType.WEDGE, 2: pv.CellType.QUADRATIC_WEDGE}[order]}
    assert made.volume == pytest.approx(2 * STRIP_AREA)
    assert np.all(made.compute_cell_sizes(length=False, area=False)["Volume"] > 0)
    if order == 1:
        assert np.all(made.cell_quality("scaled_jacobian")["scaled_jacobian"] > 0)
    assert made.points.dtype == np.float64
    assert made.bounds[4:] == (1, 3)
    assert made.active_scalars_name == "region"
    assert made.cell_data["region"].dtype == np.int32
    assert np.array_equal(made.cell_data["region"], np.tile(regions, 2))
    assert np.array_equal(made.cell_data["q"], np.tile(q, 2))
    assert made.field_data["units"][0] == "mm"
    assert made.threshold([7, 7], scalars="region").volume == pytest.approx(STRIP_AREA)


def test_nodes_between_lie_between():
    vertices, triangles, _ = strip()
    points, wedge, _ = wedges(vertices, triangles, height=1, layers=2, order=2)
    p = points[wedge]
    for node, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)], start=6):
        assert p[:, node] == pytest.approx((p[:, a] + p[:, b]) / 2, abs=1e-14)


def test_flat_quadratic_triangles():
    vertices, triangles, regions = strip()
    made = elements(vertices, triangles, regions, order=2, z=4)
    assert set(made.celltypes.tolist()) == {pv.CellType.QUADRATIC_TRIANGLE}
    cell = made.cells_dict[pv.CellType.QUADRATIC_TRIANGLE]
    assert np.array_equal(cell[:, :3], triangles)
    p = made.points[cell]
    assert p[:, 3:] == pytest.approx((p[:, [0, 1, 2]] + p[:, [1, 2, 0]]) / 2, abs=1e-14)
    assert len(made.points) == len(vertices) + len(edge_counts(triangles)[0])
    assert np.all(made.points[:, 2] == 4)
    assert made.area == pytest.approx(STRIP_AREA)
    linear = elements(vertices, triangles, regions)
    assert linear.celltypes.tolist() == [pv.CellType.TRIANGLE] * len(triangles)
    assert np.array_equal(linear.cell_data["region"], regions)


def test_curved_middles_are_kept_and_count():
    """A hexagon whose outer edges bulge: each adds the area of a parabola, two thirds of chord times height."""
    turn = np.arange(6) * np.pi / 3
    vertices = np.concatenate([[[0, 0]], np.stack([np.cos(turn), np.sin(turn)], axis=1)])
    triangles = np.stack([np.zeros(6, int), np.arange(1, 7), np.arange(6) % 6 + 2], axis=1)
    triangles[-1, 2] = 1
    edges, sides = unique_edges(triangles)
    middles = vertices[edges].mean(axis=1)
    outer = bordering(sides, np.ones(6))
    middles[outer] /= np.linalg.norm(middles[outer], axis=1, keepdims=True)
    area = 6 * np.sqrt(3) / 4 + 6 * 2 / 3 * (1 - np.sqrt(3) / 2)
    points, wedge, _ = wedges(vertices, triangles, height=0.5, layers=2, order=2, middles=middles)
    each, least = volumes(points, wedge)
    assert least > 0
    assert each.sum() == pytest.approx(0.5 * area, rel=1e-7)
    nodes, cell = quadratic(vertices, triangles, middles=middles)
    assert np.array_equal(nodes[7:], middles)
    assert np.linalg.norm(nodes[cell[:, 4]], axis=1) == pytest.approx(1)
    assert np.array_equal(points[: len(nodes), :2], nodes)


def test_edges_that_border_are_those_of_the_boundary_and_the_interfaces():
    for triangles in (ring()[1], strip()[1]):
        edges, sides = unique_edges(triangles)
        assert np.array_equal(bordering(sides, np.ones(len(triangles))), np.bincount(sides.ravel()) == 1)
    regions = strip()[2]
    assert np.array_equal(edges[bordering(sides, regions)], topology.curve_edges(triangles, regions))


@given(nps.arrays(bool, st.tuples(st.integers(1, 5), st.integers(1, 5))).filter(np.any), st.floats(0.01, 100), st.integers(1, 4))
def test_any_set_of_cells_is_filled(mask, height, layers):
    vertices, triangles = cells(mask)
    points, wedge, _ = wedges(vertices, triangles, height=height, layers=layers)
    each, least = volumes(points, wedge)
    assert least > 0
    assert each.sum() == pytest.approx(mask.sum() * height, rel=1e-6)


def test_the_arguments_are_left_as_they_are():
    vertices, triangles, regions = strip()
    before = vertices.copy(), triangles.copy(), regions.copy()
    wedges(vertices, triangles, regions, height=1, layers=2, order=2)
    assert all(np.array_equal(a, b) for a, b in zip(before, (vertices, triangles, regions), strict=True))


@pytest.mark.parametrize(
    ("error", "options", "words"),
    [
        (ParameterError, {"height": 0}, "height: expected a number above 0, found 0"),
        (ParameterError, {"height": 1, "layers": 0}, "layers: expected a whole number of at least 1, found 0"),
        (ParameterError, {"height": 1, "layers": 1.5}, "layers: expected a whole number of at least 1, found 1.5"),
        (ParameterError, {"height": 1, "order": 3}, "order: expected 1 or 2, found 3"),
        (ParameterError, {"height": 1, "z": np.nan}, "z: expected a number"),
        (ParameterError, {"height": 1, "middles": [[0, 0]]}, "middles: expected none for order 1"),
        (MeshError, {"height": 1, "order": 2, "middles": [[0, 0]]}, r"expected one finite place .* of 25 edges, found shape \(1, 2\)"),
        (MeshError, {"height": 1, "order": 2, "middles": np.full((25, 2), np.nan)}, "middles: expected one finite place"),
    ],
)
def test_options_that_cannot_be_are_refused(error, options, words):
    vertices, triangles, regions = strip()
    with pytest.raises(error, match=words):
        wedges(vertices, triangles, regions, **options)


def test_arrays_that_are_no_mesh_are_refused():
    with pytest.raises(MeshError, match="triangles: expected indices from 0 to 2"):
        wedges([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]], height=1)
    with pytest.raises(MeshError, match="regions: expected one number for each of 1 triangles"):
        wedges([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], [1, 2], height=1)
