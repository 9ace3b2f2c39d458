"""The accessors on objects of pyvista: the same as the public functions, on the object in hand."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista as pv
import specimens

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
    assert image.img2tri.mesh(edge_length=4, labels=True).n_cells < image.img2tri.mesh(edge_length=1, labels=True).n_cells


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
