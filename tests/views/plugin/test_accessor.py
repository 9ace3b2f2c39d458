"""The accessors on objects of pyvista: the same as the public functions, on the object in hand."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista as pv
import specimens
from PIL import Image

import img2tri
import img2tri.views.plugin.accessor  # what the entry point does when .img2tri is asked for
from img2tri import ImageError, MeshError, ParameterError

DISC = specimens.disc(40, 15.0)


def image_of(values, spacing=(0.25, 0.5), origin=(3, -2, 1.5), where="points"):
    """An ImageData whose first row of values is the lowest."""
    h, w = np.array(values.shape) + (where == "cells")
    image = pv.ImageData(dimensions=(w, h, 1), spacing=(*spacing, 1), origin=origin)
    (image.point_data if where == "points" else image.cell_data)["values"] = values.ravel()
    return image


@pytest.mark.parametrize("where", ["points", "cells"])
def test_the_mesh_lies_on_the_image(where):
    values = np.ones((20, 30), np.uint8)
    image = image_of(values, where=where)
    mesh = image.img2tri.mesh(edge_length="5px", threshold=0.5)
    assert type(mesh) is pv.PolyData
    half = np.array([0.25, 0.25, 0.5, 0.5, 0, 0]) / 2 * [-1, 1, -1, 1, 0, 0] if where == "points" else 0
    assert mesh.bounds == pytest.approx(np.array(image.bounds) + half)


def test_every_centre_of_a_pixel_is_in_the_region_of_its_label():
    labels = specimens.polycrystal(40, 5)
    image = image_of(labels, spacing=(0.5, 0.5))
    mesh = image.img2tri.mesh(edge_length=2, labels=True)
    points = pv.PolyData(np.array(image.points) + (1e-6, 2e-6, 0))
    found = mesh.find_containing_cell(points.points)
    assert (found >= 0).all()
    assert np.mean(mesh.cell_data["region"][found] == labels.ravel()) > 0.98  # the rest lie on an edge, within the tolerance


def test_it_is_what_mesh_image_makes():
    image = image_of(DISC)
    mine, other = image.img2tri.mesh(edge_length=2, labels=True), img2tri.mesh_image(image, edge_length=2, labels=True)
    assert np.array_equal(mine.points[:, :2], other.vertices)
    assert np.array_equal(mine.regular_faces, other.triangles)
    assert np.array_equal(mine.cell_data["region"], other.regions)
    assert image.img2tri.mesh(edge_length=4, labels=True).n_cells < mine.n_cells


def test_with_a_height_it_is_a_closed_solid_upon_the_image():
    solid = image_of(DISC).img2tri.mesh(edge_length=2, height=0.7)
    assert solid.n_open_edges == 0
    assert solid.bounds[4:] == pytest.approx((1.5, 2.2))


def test_errors_are_those_of_mesh_image():
    with pytest.raises(ImageError, match="planar"):
        pv.ImageData(dimensions=(3, 3, 3)).img2tri.mesh()
    with pytest.raises(ParameterError, match="edge_length"):
        image_of(DISC).img2tri.mesh(edge_length=-1)


@pytest.fixture(scope="module")
def disc():
    return img2tri.mesh_image(DISC, edge_length=5, outline="pixel", spacing=0.1)


def test_quality_is_that_of_the_mesh(disc):
    mine, other = disc.to_pyvista().img2tri.quality().summary(), disc.quality().summary()
    assert mine == other


@pytest.mark.parametrize("options", [{}, {"method": "uniform"}, {"method": "uniform", "iterations": 2, "guard": False}])
def test_smooth_moves_as_smoothed_does(disc, options):
    mesh = disc.to_pyvista()
    mesh.cell_data["mine"] = np.arange(mesh.n_cells)
    mesh.point_data["also"] = np.arange(mesh.n_points)
    before = mesh.copy()
    smooth = mesh.img2tri.smooth(**options)
    assert np.array_equal(smooth.points[:, :2], disc.smoothed(**{"method": "cotangent", **options}).vertices)
    assert np.array_equal(smooth.points[:, 2], mesh.points[:, 2])
    assert mesh == before
    assert np.array_equal(smooth.cell_data["mine"], mesh.cell_data["mine"])
    assert np.array_equal(smooth.point_data["also"], mesh.point_data["also"])
    moved = img2tri.TriangleMesh(smooth.points[:, :2], disc.triangles, disc.regions)
    assert smooth.cell_data["q"] == pytest.approx(moved.quality().arrays["q"])


def test_a_free_boundary_moves_within_the_tolerance(disc):
    mesh = disc.to_pyvista()
    moved = [np.abs(mesh.img2tri.smooth(boundary="free", tolerance=far).points - mesh.points).max() for far in (0.01, 0.05)]
    assert 0 < moved[0] <= 0.01 * 1.5
    assert moved[0] < moved[1] <= 0.05 * 1.5


def test_pixels_are_only_known_to_a_mesh_that_knows_its_image(disc):
    mesh = disc.to_pyvista()
    mesh.field_data["img2tri"] = ["{}"]
    for tolerance in (None, "0.5px"):
        with pytest.raises(ParameterError, match="tolerance: expected a number for a mesh that knows no image"):
            mesh.img2tri.smooth(boundary="free", tolerance=tolerance)
    frame = {"shape": [40, 40], "spacing": [0.1, 0.1], "corner": [0, 0], "upward": True}
    mesh.field_data["img2tri"] = [json.dumps({"frame": frame})]
    usual = mesh.img2tri.smooth(boundary="free").points
    assert np.array_equal(usual, mesh.img2tri.smooth(boundary="free", tolerance=0.05).points)
    assert np.array_equal(usual, mesh.img2tri.smooth(boundary="free", tolerance="0.5px").points)
    assert not np.array_equal(usual, mesh.img2tri.smooth(boundary="free", tolerance="0.1px").points)


def test_regions_keep_their_interfaces():
    mesh = img2tri.mesh_image(specimens.polycrystal(40, 5), labels=True, edge_length=5)
    smooth = mesh.to_pyvista().img2tri.smooth("uniform")
    assert np.array_equal(smooth.points[:, :2], mesh.smoothed("uniform").vertices)


@pytest.mark.parametrize("mesh", [pv.Sphere(), pv.Plane(), pv.PolyData()])
def test_what_is_no_plane_mesh_of_triangles_is_refused(mesh):
    for method in ("quality", "smooth"):
        with pytest.raises(MeshError, match="expected"):
            getattr(mesh.img2tri, method)()


# ---- what a mesh knows of its image ----


def solid_of(mesh):
    return mesh.to_pyvista(0.7, solid=True, layers=2)


@pytest.mark.parametrize(
    "made",
    [
        lambda mesh: mesh.to_pyvista(),
        lambda mesh: mesh.to_pyvista(0.7),
        lambda mesh: mesh.to_pyvista({1: 0.5}, base=0.2),
        lambda mesh: mesh.to_pyvista(order=2),
        solid_of,
        lambda mesh: mesh.to_pyvista(0.7, solid=True, cells="tetrahedra"),
    ],
)
def test_every_object_made_here_has_the_report_of_its_mesh_and_its_regions(disc, made):
    dataset = made(disc)
    assert dataset.img2tri.report is disc.report
    sets = dataset.img2tri.sets()
    assert sets.labels["region_1"] == 1
    assert np.array_equal(sets.regions["region_1"], np.flatnonzero(dataset.cell_data["region"] == 1))
    assert dataset.img2tri.plot(pv.Plotter(off_screen=True)).actors


def test_a_flat_mesh_that_was_changed_is_judged_as_it_is(disc):
    mesh = disc.to_pyvista()
    smooth = mesh.img2tri.smooth("uniform")
    assert smooth.img2tri.report.to_dict() == disc.smoothed("uniform").report.to_dict()
    mesh.points[0] += (0, 3, 0)
    assert not mesh.img2tri.report.kept
    relabelled = disc.to_pyvista()
    relabelled.cell_data["region"] = np.where(np.arange(relabelled.n_cells) == 0, 7, 1)
    assert relabelled.img2tri.report.unknown_labels == [7]


def test_a_solid_that_was_changed_has_no_report(disc):
    solid = solid_of(disc)
    solid.points[0] += (0, 3, 0)
    with pytest.raises(MeshError, match="report: expected a solid as it was made, found it changed"):
        _ = solid.img2tri.report


def test_a_copy_and_a_file_are_known_by_the_file_of_their_image(tmp_path, disc):
    Image.fromarray(DISC.astype(np.uint8) * 255).save(tmp_path / "disc.png")
    mesh = img2tri.mesh_image(tmp_path / "disc.png", edge_length=5)
    mesh.save(tmp_path / "disc.vtp")
    for dataset in (mesh.to_pyvista().copy(), pv.read(tmp_path / "disc.vtp"), solid_of(mesh).copy()):
        assert dataset.img2tri.report.to_dict() == mesh.report.to_dict()
    moved = solid_of(mesh).copy()
    moved.points[:, :2] *= 1.1
    with pytest.raises(MeshError, match="found it changed"):
        _ = moved.img2tri.report
    Image.fromarray(DISC.astype(np.uint8) * 255).transpose(Image.Transpose.ROTATE_90).crop((0, 0, 39, 40)).save(tmp_path / "disc.png")
    with pytest.raises(MeshError, match="expected the image this mesh was made from, found another"):
        _ = pv.read(tmp_path / "disc.vtp").img2tri.report
    for other in (disc.to_pyvista().copy(), pv.Plane().triangulate()):
        with pytest.raises(MeshError, match="report: expected a mesh whose image is known, found a copy"):
            _ = other.img2tri.report


def test_sets_are_those_of_the_mesh(disc):
    mine, other = disc.to_pyvista().img2tri.sets(), disc.sets()
    assert mine.tags == other.tags
    assert all(np.array_equal(mine.edges[name], other.edges[name]) for name in other.edges)
    solid = solid_of(disc)
    sets = solid.img2tri.sets()
    assert len(sets.edges["z_min"]) == len(disc.triangles)
    assert len(sets.edges["outer"]) == 2 * len(other.edges["outer"])
    assert sets.edges["outer"].shape[1] == 4


# ---- which array, which plane ----


def test_scalars_picks_the_array():
    image = image_of(DISC)
    image.point_data["other"] = 1 - DISC.ravel()
    image.set_active_scalars("values")
    one, two = (image.img2tri.mesh(edge_length=2, labels=[1], scalars=name) for name in (None, "other"))
    assert one.area + two.area == pytest.approx(40 * 40 * 0.125, rel=1e-4)  # two outlines of one edge
    assert image.active_scalars_name == "values"
    with pytest.raises(ImageError, match="scalars: expected one of 'values', 'other', found 'none'"):
        image.img2tri.mesh(scalars="none")


@pytest.mark.parametrize("where", ["points", "cells"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_slice_is_meshed_in_its_plane(axis, where):
    """Whatever its normal: the mesh lies on the pixels it was made of, faces along the normal, and a solid rises along it."""
    values = specimens.disc(24, 7.0)[:20]
    values[3:9, 12:17] = 1  # no symmetry
    u, v = [a for a in range(3) if a != axis]
    counts = np.ones(3, int)
    counts[[u, v]] = np.array(values.shape[::-1]) + (where == "cells")
    image = pv.ImageData(dimensions=counts, spacing=(0.5, 0.25, 0.75), origin=(3, -2, 1.5))
    (image.point_data if where == "points" else image.cell_data)["values"] = values.ravel()
    mesh = image.img2tri.mesh(edge_length=2, labels=True)
    centres = (np.asarray(image.points) if where == "points" else np.asarray(image.cell_centers().points))[values.ravel() > 0]
    assert np.ptp(np.asarray(mesh.points)[:, axis]) == 0
    assert mesh.find_closest_cell(centres, return_closest_point=True)[1] == pytest.approx(centres, abs=0.1)
    assert mesh.area == pytest.approx(len(centres) * np.prod(np.array(image.spacing)[[u, v]]), rel=0.02)
    normals = mesh.compute_normals(auto_orient_normals=False, consistent_normals=False).cell_data["Normals"]
    assert normals == pytest.approx(np.tile(np.eye(3)[axis], (mesh.n_cells, 1)))
    solid = image.img2tri.mesh(edge_length=2, labels=True, height=0.5)
    assert solid.n_open_edges == 0
    assert solid.volume == pytest.approx(0.5 * mesh.area)
    assert solid.bounds[2 * axis : 2 * axis + 2] == pytest.approx(np.array(image.origin)[axis] + (0, 0.5))
    assert mesh.img2tri.report.kept
    smooth = mesh.img2tri.smooth("uniform")
    assert smooth.area == pytest.approx(mesh.area)
    assert np.abs(smooth.points - mesh.points).max() > 0
    assert mesh.img2tri.quality().arrays["q"] == pytest.approx(mesh.cell_data["q"])
    assert list(mesh.img2tri.sets().edges)[:1] == ["outer"]


def test_it_is_registered_once_on_images_and_surfaces():
    found = [(entry.name, entry.target) for entry in pv.registered_accessors() if entry.name == "img2tri"]
    kinds = (pv.ImageData, pv.PolyData, pv.UnstructuredGrid)
    assert sorted(found, key=str) == sorted([("img2tri", kind) for kind in kinds], key=str)


def test_quality_is_measured_anew_only_where_it_was_before():
    mesh = pv.Plane(i_resolution=4, j_resolution=4).triangulate()
    mesh.clear_data()
    mesh.points[12] += (0.1, 0.05, 0)
    assert "q" not in mesh.img2tri.smooth("uniform").cell_data
    mesh.cell_data["q"] = np.zeros(mesh.n_cells)
    smooth = mesh.img2tri.smooth("uniform")
    assert smooth.cell_data["q"] == pytest.approx(smooth.img2tri.quality().arrays["q"])
    assert not mesh.cell_data["q"].any()
