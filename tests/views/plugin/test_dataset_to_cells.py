"""Objects of pyvista as cells: what they know is kept, what they do not know is found."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista as pv
from views.solver_meshes import KINDS, made, plate

from img2tri import MeshError
from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid
from img2tri.views.plugin.dataset_to_cells import from_dataset, image_frame, written_about

ABOUT = {"names": {"4": "bone"}, "frame": {"shape": [5, 6], "spacing": [0.3, 0.3], "corner": [-0.7, 0.1], "upward": True}}


def poly(about=None):
    vertices, triangles, regions = plate()
    mesh = pv.PolyData.from_regular_faces(np.column_stack([vertices, np.full(len(vertices), 0.5)]), triangles)
    mesh.cell_data["region"] = regions.astype(np.int32)
    if about is not None:
        mesh.field_data["img2tri"] = [json.dumps(about)]
    return mesh


def same(one, other):
    assert one.kind == other.kind
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.cells, other.cells)
    assert np.array_equal(one.regions, other.regions)
    assert one.names == other.names
    assert {name: np.unique(one.facets(name)).tolist() for name in one.sides} == {
        name: np.unique(other.facets(name)).tolist() for name in other.sides
    }
    assert one.tags == other.tags


@pytest.mark.parametrize("kind", KINDS)
def test_a_grid_with_named_parts_gives_the_cells_it_was_made_of(kind):
    mesh = made(kind)
    same(from_dataset(to_grid(mesh)), mesh)
    assert from_dataset(to_grid(mesh)).texts == mesh.texts


def test_names_and_frame_are_taken_from_what_img2tri_wrote():
    same(from_dataset(poly(ABOUT)), made("triangle"))


def test_what_is_not_known_is_found():
    mesh = from_dataset(poly())
    assert mesh.names == {-1: "region_-1", 4: "region_4"}
    assert set(mesh.wholes) == {"outer", "hole_1", "hole_2", "region_-1__region_4"}
    bare = poly()
    del bare.cell_data["region"]
    assert from_dataset(bare).names == {1: "region_1"}


@pytest.mark.parametrize("kind", ["wedge", "wedge15"])
def test_wedges_in_layers_are_recognised_without_named_parts(kind):
    grid = to_grid(made(kind))
    grid.clear_field_data()
    mesh = from_dataset(grid)
    assert set(mesh.wholes) == {"outer", "hole_1", "hole_2", "region_-1__region_4", "z_min", "z_max"}
    assert len(mesh.sides["hole_1"]) == 2 * 6


def test_wedges_in_no_order_have_the_sets_they_bring():
    grid = to_grid(made("wedge"))
    mixed = grid.extract_cells(np.random.default_rng(0).permutation(grid.n_cells))
    mixed = pv.UnstructuredGrid({13: mixed.cells_dict[13][::-1]}, mixed.points)
    assert from_dataset(mixed).sides == {}
    mixed.field_data["left"] = mixed.cells_dict[13][:3, [0, 1, 4, 3]]
    assert list(from_dataset(mixed).sides) == ["left"]


def test_sets_that_no_longer_fit_are_found_anew():
    grid = to_grid(made("triangle"))
    grid.field_data["mine"] = np.array([[0, 1]])
    assert from_dataset(grid).tags["mine"] > 5
    grid.field_data["mine"] = np.array([[0, 20]])
    assert "mine" not in from_dataset(grid).sides
    assert "hole_1" in from_dataset(grid).sides


def test_arrays_of_another_width_are_no_sets():
    grid = to_grid(made("triangle"))
    grid.field_data["table"] = np.arange(12).reshape(3, 4)
    same(from_dataset(grid), made("triangle"))


def test_triangles_seen_from_below_are_turned():
    mesh = poly(ABOUT).flip_faces()
    found = from_dataset(mesh)
    assert set(found.sides) == set(made("triangle").sides)
    corners = found.points[found.cells]
    assert np.all(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0)
    curved = to_grid(made("triangle6"))
    turned = pv.UnstructuredGrid({22: curved.cells_dict[22][:, [0, 2, 1, 5, 4, 3]]}, curved.points)
    assert sorted(map(tuple, from_dataset(turned).cells.tolist())) == sorted(map(tuple, curved.cells_dict[22].tolist()))


@pytest.mark.parametrize(
    ("dataset", "words"),
    [
        (pv.PolyData(), "expected a PolyData of triangles, found no face"),
        (pv.Plane(), r"found other faces; use \.triangulate\(\)"),
        (pv.Sphere(), "expected triangles in a plane of constant z, found z from -0.5 to 0.5"),
        (pv.ImageData(dimensions=(3, 3, 1)), "expected a PolyData of triangles, or an UnstructuredGrid .* found ImageData"),
        (pv.UnstructuredGrid({9: np.array([[0, 1, 2, 3]])}, np.eye(4)[:, :3]), "found UnstructuredGrid with cells of the types 9"),
    ],
)
def test_other_objects_are_refused(dataset, words):
    with pytest.raises(MeshError, match=words):
        from_dataset(dataset)


def test_regions_have_to_be_whole_numbers():
    mesh = poly()
    mesh.cell_data["region"] = np.linspace(0, 1, mesh.n_cells)
    with pytest.raises(MeshError, match="region: expected whole numbers"):
        from_dataset(mesh)
    mesh.cell_data["region"] = np.full(mesh.n_cells, 2.0)
    assert from_dataset(mesh).names == {2: "region_2"}


@pytest.mark.parametrize("text", ["", "[1]", "{", '{"frame": {"shape": [1]}}', '{"frame": 3}'])
def test_damaged_notes_are_no_trouble(text):
    mesh = poly()
    mesh.field_data["img2tri"] = [text]
    assert image_frame(written_about(mesh)) is None
    assert "left" not in from_dataset(mesh).sides


def test_the_object_is_not_changed():
    mesh = poly(ABOUT)
    before = mesh.copy()
    from_dataset(mesh)
    assert mesh == before
