"""Cells of each kind and the facets of their sets, by geometry."""

from __future__ import annotations

import numpy as np
import pytest
from views.solver_meshes import BOUNDS, HEIGHT, KINDS, LAYERS, NAMES, SIZE, TAGS, TEXTS, made, plate, sizes

from img2tri import MeshError
from img2tri.views.objects.extruded_wedges import quadratic, wedges
from img2tri.views.objects.solver_cells import CELL_SIDES, flat_cells, solid_cells

SOLIDS = KINDS[2:4]


def corners_of(mesh, name):
    nodes = mesh.facets(name)
    linear = mesh.kind in ("triangle", "wedge", "tetra")
    return mesh.points[nodes if linear else nodes[:, : (nodes.shape[1] + 1) // 2]]


def size_of(mesh, name):
    """Length of edges, area of flat facets."""
    corners = corners_of(mesh, name)
    if corners.shape[1] == 2:
        return np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).sum()
    across = sum(np.cross(corners[:, i] - corners[:, 0], corners[:, i + 1] - corners[:, 0]) for i in range(1, corners.shape[1] - 1))
    return np.linalg.norm(across, axis=1).sum() / 2


@pytest.mark.parametrize("kind", KINDS)
def test_sets_have_their_sizes_and_tags(kind):
    mesh = made(kind)
    expected = sizes(mesh.solid)[1]
    assert {name: size_of(mesh, name) for name in mesh.sides} == pytest.approx(expected, rel=1e-12)
    assert mesh.tags == {name: TAGS[name] for name in expected}


@pytest.mark.parametrize("kind", KINDS)
def test_sets_lie_where_their_names_say(kind):
    mesh = made(kind)
    for name, axis, value in (("left", 0, BOUNDS[0]), ("bottom", 1, BOUNDS[1])):
        assert mesh.points[mesh.facets(name)][..., axis] == pytest.approx(value, abs=1e-12)
    if mesh.solid:
        assert np.all(mesh.points[mesh.facets("z_min")][..., 2] == 0.5)
        assert mesh.points[mesh.facets("z_max")][..., 2] == pytest.approx(0.5 + HEIGHT)


@pytest.mark.parametrize("kind", ["triangle6", "wedge15"])
def test_nodes_behind_the_corners_are_in_the_middle_of_edges(kind):
    mesh = made(kind)
    for name in mesh.sides:
        nodes, corners = mesh.points[mesh.facets(name)], corners_of(mesh, name)
        n = corners.shape[1]
        middles = (corners + np.roll(corners, -1, axis=1)) / 2
        assert nodes[:, n:] == pytest.approx(middles[:, : nodes.shape[1] - n], abs=1e-12)


@pytest.mark.parametrize("kind", SOLIDS)
def test_facets_of_solids_are_seen_from_outside(kind):
    mesh = made(kind)
    for name, sides in mesh.sides.items():
        c = corners_of(mesh, name)
        normal = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
        inward = mesh.points[mesh.cells[sides[:, 0], :6]].mean(axis=1) - c.mean(axis=1)
        assert np.all((normal * inward).sum(axis=1) < 0)


@pytest.mark.parametrize("kind", SOLIDS)
def test_layers_have_the_regions_values_and_names_of_the_triangles(kind):
    mesh = made(kind, cell_data={"q": np.arange(34)})
    regions = plate()[2]
    assert np.array_equal(mesh.regions, np.tile(regions, LAYERS))
    assert np.array_equal(mesh.cell_data["q"], np.tile(np.arange(34), LAYERS))
    assert mesh.names == {-1: "region_-1", 4: "bone"}
    assert mesh.texts == TEXTS


@pytest.mark.parametrize("kind", KINDS)
def test_sides_know_all_nodes_of_a_cell(kind):
    assert set().union(*CELL_SIDES[kind]) == set(range(made(kind).cells.shape[1]))


def test_numbers_begin_with_one_and_labels_above_keep_theirs():
    vertices, triangles, _ = plate()
    labels = np.arange(len(triangles)) % 4 - 1
    assert flat_cells(vertices, triangles, labels).ids == {-1: 3, 0: 4, 1: 1, 2: 2}
    assert flat_cells(vertices, triangles, labels * 0 - 5).ids == {-5: 1}


def test_options_reach_the_cells():
    plain = flat_cells(*plate())
    assert plain.names == {-1: "region_-1", 4: "region_4"}
    assert np.all(plain.points[:, 2] == 0)
    assert "left" not in plain.sides
    full = flat_cells(*plate(), z=2, names=NAMES, bounds=BOUNDS, cell_data={"a": np.ones(34)}, field_data={"b": "c"})
    assert (full.names[4], full.points[0, 2], "left" in full.sides) == ("bone", 2, True)
    assert (list(full.cell_data), full.texts) == (["a"], {"b": "c"})


@pytest.mark.parametrize(
    ("elements", "words"),
    [
        (np.zeros((3, 4), int), r"elements: expected rows of 3 or 6 nodes, found shape \(3, 4\)"),
        (np.array([[0, 1, 6, 2, 3, 99]]), r"elements: expected indices from 0 to \d+, found 0 to 99"),
        (np.array([[0, 1, 6, 2, 3, -1]]), r"elements: expected indices from 0 to \d+, found -1 to 6"),
        (np.array([[0, 1, 99]]), "triangles: expected indices"),
    ],
)
def test_elements_that_are_none_are_refused(elements, words):
    with pytest.raises(MeshError, match=words):
        flat_cells(plate()[0], elements)


def test_wedges_that_do_not_go_with_the_mesh_are_refused():
    vertices, triangles, regions = plate()
    points, cells, _ = wedges(vertices, triangles, height=SIZE, layers=2)
    with pytest.raises(MeshError, match=r"cells: expected wedges of 6 or 15 nodes, 34 in each layer, found shape \(67, 6\)"):
        solid_cells(flat_cells(vertices, triangles, regions), points, cells[:-1])
    with pytest.raises(MeshError, match=r"found shape \(34, 3\)"):
        solid_cells(flat_cells(vertices, triangles, regions), points, triangles)


def test_quadratic_and_linear_cells_have_the_same_sets():
    for flat, curved in (("triangle", "triangle6"), ("wedge", "wedge15")):
        one, other = made(flat), made(curved)
        assert list(one.sides) == list(other.sides)
        assert all(np.array_equal(one.sides[name], other.sides[name]) for name in one.sides)


def test_middles_need_not_be_half_way():
    vertices, triangles, regions = plate()
    nodes, elements = quadratic(vertices, triangles)
    nodes[len(vertices) :] += 0.01
    mesh = flat_cells(nodes, elements, regions, bounds=BOUNDS)
    assert np.array_equal(mesh.points[:, :2], nodes)
    assert set(mesh.sides) >= {"left", "bottom"}  # what lies on the frame is for the corners to say
