"""mesh_image: what it accepts, what each option changes, what it refuses and how it says so."""

from __future__ import annotations

import hashlib
import inspect
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import oracles
import pytest
import specimens
from PIL import Image
from scipy import ndimage
from scipy.spatial import KDTree

import img2tri
from img2tri import FileError, ImageError, Img2triError, ParameterError, mesh_image
from img2tri.options.mesh_options import RECIPES, SMOOTHINGS
from img2tri.paper.defaults import PAPER_THRESHOLD
from img2tri.paper.structured_unstructured import structured_mesh

DATA = Path(__file__).parents[1] / "data"
DISC = specimens.disc(40, 15).astype(bool)
GRAINS = specimens.polycrystal(48, 6)
Y, X = np.mgrid[:60, :80] + 0.5
RAMP = np.where(np.hypot(X - 40, Y - 30) < 26, 100 + X, 0).astype(np.uint8)  # a disc whose gray grows to the right
UNEVEN = (np.hypot(X - 30, Y - 25) < 20) & ~(np.hypot(X - 24, Y - 22) < 5)  # with a hole, and not its own mirror image
SHAPES = UNEVEN | (np.hypot(X - 65, Y - 20) < 7)  # and a smaller one beside it
COMB, SPIRAL = (specimens.MASKS[name].repeat(3, 0).repeat(3, 1) for name in ("comb", "spiral"))


def same(a, b):
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("vertices", "triangles", "regions"))


def area(mesh, region=None):
    triangles = mesh.triangles if region is None else mesh.triangles[mesh.regions == region]
    return oracles.areas(mesh.vertices, triangles).sum()


def centroid(mesh):
    a = oracles.areas(mesh.vertices, mesh.triangles)
    return a @ mesh.vertices[mesh.triangles].mean(axis=1) / a.sum()


def white_pixels(mesh, shape):
    """Which pixel centres lie within the outlines of a mesh whose pixels have size 1."""
    import shapely

    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    return np.any([shapely.contains_xy(polygon, x, shape[0] - y) for polygon in mesh.outlines().values()], axis=0)


def saved(values, path, **options):
    Image.fromarray(np.asarray(values)).save(path, **options)
    return path


# ---- what is accepted ----

MASK_AS = {
    "bool": DISC,
    "int64": DISC.astype(int),
    "uint8": DISC.astype(np.uint8) * 255,
    "uint16": DISC.astype(np.uint16) * 65535,
    "float32": DISC.astype(np.float32),
    "float64, negative": DISC * 3.5 - 1,
    "RGB": np.dstack([DISC.astype(np.uint8) * 255] * 3),
    "RGBA": np.dstack([DISC.astype(np.uint8) * 255] * 3 + [np.full(DISC.shape, 255, np.uint8)]),
    "black on transparent": np.dstack([np.zeros_like(DISC, np.uint8)] * 3 + [DISC.astype(np.uint8) * 255]),
    "in columns": np.asfortranarray(DISC),
    "every second": DISC.repeat(2, 0).repeat(2, 1)[::2, ::2],
    "big-endian": DISC.astype(">i4"),
    "nested lists": DISC.tolist(),
}


@pytest.mark.parametrize("name", MASK_AS)
def test_a_mask_is_the_same_in_any_type(name):
    assert same(mesh_image(MASK_AS[name], edge_length=5), mesh_image(DISC, edge_length=5))


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp"])
@pytest.mark.parametrize("kind", [str, Path])
def test_a_file_is_its_array(suffix, kind, tmp_path):
    path = saved(DISC.astype(np.uint8) * 255, tmp_path / f"disc{suffix}")
    mesh = mesh_image(kind(path), edge_length=5)
    assert same(mesh, mesh_image(DISC, edge_length=5))
    assert mesh.origin.settings["source"] == str(path)


def test_the_image_is_not_changed():
    image = RAMP.copy()
    mesh_image(image, edge_length=6)
    assert (image == RAMP).all()
    image.flags.writeable = False
    mesh_image(image, edge_length=6, invert=True)


def test_a_mesh_of_image_data_lies_on_the_object():
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.ImageData(dimensions=(81, 61, 1), spacing=(0.5, 0.5, 1), origin=(10, -20, 7))
    grid.cell_data["mask"] = UNEVEN.reshape(-1).astype(np.uint8)
    mesh = mesh_image(grid, edge_length="5px")
    # Cell (i, j) is [10 + i / 2, ...] x [-20 + j / 2, ...]: y grows with the row of the array.
    y, x = np.nonzero(UNEVEN)
    expected = np.array([10 + (x.mean() + 0.5) / 2, -20 + (y.mean() + 0.5) / 2])
    assert np.abs(centroid(mesh) - expected).max() < 0.05
    assert (oracles.areas(mesh.vertices, mesh.triangles) > 0).all()
    flat = mesh.to_pyvista()
    assert flat.bounds[4:] == (7, 7)
    # Every triangle lies on cells of the mask, but for those cut by the outline.
    found = grid.find_containing_cell(flat.cell_centers().points)
    assert (grid["mask"][found] == 1).mean() > 0.99


def test_image_data_on_points_reach_half_a_pixel_further():
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.ImageData(dimensions=(30, 20, 1), spacing=(2, 2, 1), origin=(1, 1, 0))
    grid.point_data["all"] = np.ones(600, np.uint8)
    mesh = mesh_image(grid)
    assert mesh.vertices.min(axis=0).tolist() == [0, 0]
    assert mesh.vertices.max(axis=0).tolist() == [60, 40]


# ---- what each option changes ----

WRAPPED = np.pad(GRAINS, ((0, 1), (0, 1)), mode="wrap")
WAVES = np.abs(np.arange(-20, 20)[:, None] + 6 * np.sin(np.arange(2300) / 15)) < 12
CHANGES = {
    "recipe": (UNEVEN * 255, {"recipe": "conforming"}, {"recipe": "structured"}, {"recipe": "unstructured"}),
    "threshold": (RAMP, {"threshold": 100}, {"threshold": 140}, {"threshold": "otsu"}),
    "labels": (GRAINS, {"labels": True}, {"labels": [1, 2]}, {"labels": [3]}),
    "background": (GRAINS, {"labels": True}, {"labels": True, "background": 3}),
    "invert": (UNEVEN, {}, {"invert": True}),
    "connectivity": (specimens.MASKS["touching corners inside"], {}, {"connectivity": 8}),
    "edge_length": (UNEVEN, {"edge_length": 4}, {"edge_length": 8}, {"edge_length": "2%"}),
    "outline": (UNEVEN, {}, {"outline": "pixel"}),
    "corners": (COMB, {}, {"corners": "round"}),
    "keep_area": (UNEVEN, {"edge_length": 8}, {"edge_length": 8, "keep_area": False}),
    "symmetric": (np.pad(np.ones((9, 12), bool), 3), {}, {"symmetric": "x"}, {"symmetric": "y"}),
    "periodic": (WRAPPED, {"labels": True}, {"labels": True, "periodic": "x"}, {"labels": True, "periodic": "y"}),
    "interior": (UNEVEN, {}, {"interior": "poisson"}),
    "blocks": (WAVES, {}, {"blocks": True}),
    "gradation": (SHAPES, {"boundary_edge_length": 2, "edge_length": 12}, {"boundary_edge_length": 2, "edge_length": 12, "gradation": 1}),
    "boundary_edge_length": (UNEVEN, {"edge_length": 8}, {"edge_length": 8, "boundary_edge_length": 3}),
    "min_edge_length": (UNEVEN, {"segments_per_turn": 60}, {"segments_per_turn": 60, "min_edge_length": 3}),
    "elements_across": (COMB, {}, {"elements_across": 3}),
    "segments_per_turn": (UNEVEN, {}, {"segments_per_turn": 60}),
    "min_angle": (SPIRAL, {"min_angle": 0, "edge_length": 9}, {"min_angle": 32, "edge_length": 9}),
    "tolerance": (UNEVEN, {"tolerance": "0.1px", "edge_length": 12}, {"tolerance": "1px", "edge_length": 12}),
    "smoothing": (UNEVEN, {"smoothing": "none"}, {"smoothing": "uniform"}, {"smoothing": "cotangent"}),
    "iterations": (UNEVEN, {"smoothing": "uniform", "iterations": 1}, {"smoothing": "uniform", "iterations": 5}),
    "spacing": (UNEVEN, {"edge_length": "6px"}, {"edge_length": "6px", "spacing": 2}, {"edge_length": "6px", "spacing": (1, 2)}),
    "width": (UNEVEN, {"edge_length": "6px"}, {"edge_length": "6px", "width": 100}, {"edge_length": "6px", "width": 40}),
    "origin": (UNEVEN, {}, {"origin": "upper"}, {"origin": (5, -3)}),
    "crop": (UNEVEN, {}, {"crop": (0, 0, 40, 60)}, {"crop": (20, 30, 50, 60)}),
    "min_area": (UNEVEN, {}, {"min_area": 100}),
    "colors": (40 * GRAINS, {"labels": True}, {"colors": 2}, {"colors": 3}, {"colors": [80, 160]}),
    "absorb": (GRAINS, {"labels": True}, {"labels": True, "absorb": 1}, {"absorb": [1, 2]}),
    "fill_holes": (SHAPES, {}, {"fill_holes": True}),
    "largest": (SHAPES, {}, {"largest": True}),
    "seed": (UNEVEN * 255, {"recipe": "unstructured"}, {"recipe": "unstructured", "seed": 1}),
    "step": (UNEVEN * 255, {"recipe": "structured"}, {"recipe": "structured", "step": 7}),
    "n_boundary_points": (UNEVEN * 255, {"recipe": "unstructured"}, {"recipe": "unstructured", "n_boundary_points": 20}),
    "n_interior_points": (UNEVEN * 255, {"recipe": "unstructured"}, {"recipe": "unstructured", "n_interior_points": 5}),
    "min_distance": (UNEVEN * 255, {"recipe": "unstructured"}, {"recipe": "unstructured", "min_distance": 8}),
    "min_distance_to_boundary": (UNEVEN * 255, {"recipe": "unstructured"}, {"recipe": "unstructured", "min_distance_to_boundary": 8}),
}


def test_every_option_is_shown_to_change_something():
    elsewhere = {"page", "max_pixels", "names", "progress", "units"}
    signature = inspect.signature(mesh_image).parameters
    assert set(CHANGES) | elsewhere == set(signature) - {"image"}


@pytest.mark.parametrize("name", CHANGES)
def test_an_option_changes_the_mesh(name):
    image, *options = CHANGES[name]
    meshes = [mesh_image(image, **o) for o in options]
    assert not any(same(a, b) for i, a in enumerate(meshes) for b in meshes[:i])


@pytest.mark.parametrize("threshold", [99, 120, 140.5])
def test_threshold_strictly_greater_is_white(threshold):
    mesh = mesh_image(RAMP, threshold=threshold, edge_length=4)
    assert (white_pixels(mesh, RAMP.shape) == (RAMP > threshold)).all()
    assert mesh.report.kept
    assert mesh.origin.settings["threshold"] == threshold
    assert mesh.origin.settings["threshold_from"] == "given"


def test_threshold_left_out_is_chosen_and_told():
    assert mesh_image(DISC).origin.settings["threshold_from"] == "mask"
    two = mesh_image(DISC * 100.0 + 50).report.settings
    assert (two["threshold"], two["threshold_from"]) == (100, "middle")
    many = mesh_image(RAMP)
    assert many.report.settings["threshold_from"] == "otsu"
    assert same(many, mesh_image(RAMP, threshold="otsu"))
    assert (white_pixels(many, RAMP.shape) == (RAMP > many.report.settings["threshold"])).all()


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_threshold_of_the_paper_is_240(recipe):
    image = np.where(DISC, 241, np.where(specimens.disc(40, 18), 240, 0)).astype(np.uint8)
    mesh = mesh_image(image, recipe=recipe, edge_length=4)
    assert PAPER_THRESHOLD == 240
    assert mesh.report.settings["threshold"] == 240
    assert np.array_equal(white_pixels(mesh, DISC.shape), DISC)
    assert same(mesh, mesh_image(image, recipe=recipe, edge_length=4, threshold=240))


@pytest.mark.parametrize("background", [None, 0, 3])
def test_labels_make_a_conforming_mesh_of_all_regions(background):
    grains = np.where(GRAINS == 5, 0, GRAINS) * 10
    mesh = mesh_image(grains, labels=True, background=background and background * 10, edge_length=5)
    back = background and background * 10
    assert set(mesh.regions.tolist()) == set(np.unique(grains).tolist()) - {back}
    oracles.check_valid(mesh.vertices, mesh.triangles)
    oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, grains, background=back)
    assert mesh.report.kept


def test_a_list_of_labels_leaves_the_others_out():
    mesh = mesh_image(GRAINS, labels=[2, 4], edge_length=4)
    kept = np.where(np.isin(GRAINS, [2, 4]), GRAINS, 0)
    oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, kept)
    assert same(mesh, mesh_image(GRAINS, labels=(4, 2, 4), edge_length=4))
    assert mesh.report.settings["labels"] == [2, 4]


def test_one_white_zone_is_region_1():
    assert set(mesh_image(DISC * 200.0).regions.tolist()) == {1}


def test_invert_meshes_the_rest():
    white, dark = mesh_image(UNEVEN, edge_length=4), mesh_image(UNEVEN, edge_length=4, invert=True)
    assert white.report.areas[1]["image"] + dark.report.areas[1]["image"] == UNEVEN.size
    assert abs(area(white) + area(dark) - UNEVEN.size) < 0.01 * UNEVEN.size
    oracles.check_faithful(dark.vertices, dark.triangles, dark.regions, (~UNEVEN).astype(int))


def test_connectivity_joins_pixels_at_their_corners():
    corners = specimens.MASKS["touching corners inside"]
    for connectivity in (4, 8):
        mesh = mesh_image(corners, connectivity=connectivity)
        assert oracles.mesh_topology(mesh.triangles) == oracles.pixel_topology(corners == 1, connectivity)
        assert mesh.report.kept


def test_edge_length_is_the_length_of_edges():
    for wanted in (3.0, 6.0):
        mesh = mesh_image(np.ones((60, 80)), edge_length=wanted)
        edges = mesh.vertices[oracles.edge_counts(mesh.triangles)[0]]
        assert np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).mean() == pytest.approx(wanted, rel=0.15)


def test_edge_length_in_pixels_in_percent_and_in_world_units():
    image = np.zeros((30, 40), bool)
    image[5:25, 5:35] = True
    wanted = mesh_image(image, spacing=0.5, edge_length=2)
    assert same(wanted, mesh_image(image, spacing=0.5, edge_length="4px"))
    assert same(wanted, mesh_image(image, spacing=0.5, edge_length="8%"))
    assert wanted.report.settings["edge_length"] == 2


def test_edge_length_may_differ_from_region_to_region():
    halves = np.repeat([[1, 2]], 40, axis=0).repeat(40, axis=1)
    mesh = mesh_image(halves, labels=True, edge_length={1: 2, 2: "8px"})
    q = mesh.quality().arrays["longest_edge"]
    fine, coarse = (q[mesh.regions == region].mean() for region in (1, 2))
    assert 2 * fine < coarse
    assert mesh.report.kept


def test_edge_length_left_out_follows_the_area_and_is_told():
    small, large = mesh_image(DISC), mesh_image(DISC.repeat(8, 0).repeat(8, 1))
    assert small.report.settings["edge_length"] == 4
    assert large.report.settings["edge_length"] > 4
    assert 1000 < len(large.triangles) < 4000


@pytest.mark.parametrize("min_angle", [0, 20, 30, 32])
def test_min_angle_is_kept(min_angle):
    mesh = mesh_image(COMB, min_angle=min_angle, edge_length=9)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= min_angle - 1e-6
    assert mesh.report.min_angle == min_angle
    assert mesh.report.kept


@pytest.mark.parametrize("tolerance", ["0.1px", "0.5px", 2])
def test_tolerance_is_kept(tolerance):
    mesh = mesh_image(UNEVEN, tolerance=tolerance, edge_length=15)
    limit = mesh.frame.length("tolerance", tolerance)
    assert mesh.report.tolerance == limit
    assert mesh.report.hausdorff <= limit
    assert mesh.report.kept


def test_outlines_can_run_along_the_sides_of_pixels():
    mesh = mesh_image(UNEVEN, outline="pixel", tolerance="0.5px", edge_length=6)
    assert mesh.outlines()[1].area == UNEVEN.sum()
    corners = np.concatenate([np.asarray(ring.coords) for ring in (mesh.outlines()[1].exterior, *mesh.outlines()[1].interiors)])
    assert np.array_equal(2 * corners, np.round(2 * corners))
    assert mesh.report.kept


def test_corners_are_kept_or_rounded():
    square = np.zeros((30, 30), bool)
    square[5:25, 5:25] = True
    places = np.array([[5, 5], [25, 5], [25, 25], [5, 25.0]])

    def off(**options):
        vertices = mesh_image(square, edge_length=4, **options).vertices
        return np.linalg.norm(vertices[:, None] - places, axis=2).min(axis=0)

    assert off().max() < 1e-9
    assert off(corners="keep").max() < 1e-9
    assert off(corners="round").min() > 0.1


def test_areas_are_kept_by_moving_vertices_out():
    for keep_area in (True, False):
        mesh = mesh_image(specimens.disc(60, 25), edge_length=9, tolerance=2, keep_area=keep_area)
        error = area(mesh) / specimens.disc(60, 25).sum() - 1
        assert (abs(error) < 0.002) == keep_area


def test_smoothing_left_out_is_what_the_recipe_does():
    white = UNEVEN * 255
    assert same(mesh_image(white), mesh_image(white, smoothing="none"))
    structured = {"recipe": "structured", "edge_length": 6}
    assert same(mesh_image(white, **structured), mesh_image(white, **structured, smoothing="none"))
    paper = {"recipe": "unstructured", "edge_length": 6}
    assert same(mesh_image(white, **paper), mesh_image(white, **paper, smoothing="uniform", iterations=10))
    assert not same(mesh_image(white, **paper), mesh_image(white, **paper, smoothing="none"))


@pytest.mark.parametrize("smoothing", ["uniform", "cotangent"])
def test_smoothing_keeps_the_promises_of_the_default_recipe(smoothing):
    mesh = mesh_image(UNEVEN, smoothing=smoothing, edge_length=5)
    assert (oracles.areas(mesh.vertices, mesh.triangles) > 0).all()
    assert mesh.report.topology[1]["found"] == mesh.report.topology[1]["expected"]
    assert mesh.report.narrow == 0


@pytest.mark.parametrize("spacing", [0.25, 2.0, 0.7, 1e-3, 1234.5])
@pytest.mark.parametrize("image", [UNEVEN, GRAINS], ids=["mask", "labels"])
def test_a_mesh_scales_exactly_with_spacing(image, spacing):
    options = {"labels": True if image is GRAINS else None, "edge_length": "5px"}
    one, scaled = mesh_image(image, **options), mesh_image(image, spacing=spacing, **options)
    assert np.array_equal(scaled.vertices, spacing * one.vertices)
    assert np.array_equal(scaled.triangles, one.triangles)
    assert scaled.report.hausdorff == pytest.approx(spacing * one.report.hausdorff)
    assert scaled.report.areas[1]["image"] == pytest.approx(spacing**2 * one.report.areas[1]["image"])


def test_pixels_need_not_be_square():
    mesh = mesh_image(np.ones((20, 30), bool), spacing=(0.5, 0.7), edge_length=1)
    assert mesh.vertices.min(axis=0).tolist() == [0, 0]
    assert mesh.vertices.max(axis=0) == pytest.approx([15, 14], rel=1e-15)
    assert mesh.report.kept
    assert area(mesh) == pytest.approx(15 * 14, rel=1e-12)


def test_origin_is_the_place_of_the_corner():
    lower = mesh_image(UNEVEN, edge_length=5)
    moved = mesh_image(UNEVEN, edge_length=5, origin=(100, -7.5))
    assert np.array_equal(moved.vertices, lower.vertices + np.array([100, -7.5]))
    y, x = np.nonzero(UNEVEN)
    assert np.abs(centroid(lower) - [x.mean() + 0.5, 60 - y.mean() - 0.5]).max() < 0.05


def test_origin_upper_gives_image_coordinates():
    upper = mesh_image(UNEVEN, edge_length=5, origin="upper", spacing=0.5)
    y, x = np.nonzero(UNEVEN)
    assert np.abs(centroid(upper) - [(x.mean() + 0.5) / 2, (y.mean() + 0.5) / 2]).max() < 0.05
    assert (oracles.areas(upper.vertices, upper.triangles) > 0).all()
    assert upper.report.kept


@pytest.mark.parametrize("spacing", [1, 0.5])
def test_a_crop_lies_where_it_was(spacing):
    left, bottom, right, top = 12 * spacing, 20 * spacing, 44 * spacing, 50 * spacing
    mesh = mesh_image(UNEVEN, crop=(left, bottom, right, top), spacing=spacing, edge_length="5px")
    part = UNEVEN[10:40, 12:44]
    assert mesh.report.areas[1]["image"] == pytest.approx(part.sum() * spacing**2)
    assert mesh.frame.bounds == (left, bottom, right, top)
    y, x = np.nonzero(part)
    assert np.abs(centroid(mesh) / spacing - [x.mean() + 12.5, 60 - y.mean() - 10.5]).max() < 0.1
    assert mesh.report.kept


def test_specks_and_holes_are_removed_and_listed():
    mesh = mesh_image(SHAPES, min_area="200px2", edge_length=5)
    assert mesh.report.topology[1]["found"] == (1, 0)
    removed = mesh.report.counted["removed"]
    assert (removed["specks"], removed["holes"]) == (1, 1)
    assert same(mesh, mesh_image(SHAPES, min_area=200, edge_length=5))
    half = mesh_image(SHAPES, min_area=50, edge_length=2.5, spacing=0.5)
    assert np.array_equal(half.vertices, mesh.vertices / 2)


def test_largest_keeps_one_component():
    mesh = mesh_image(SHAPES, largest=True, edge_length=5)
    assert oracles.mesh_topology(mesh.triangles) == (1, 1)
    assert mesh.vertices[:, 0].max() < 52
    assert mesh.report.kept


def test_page_is_the_image_of_a_file(tmp_path):
    first, second = (Image.fromarray(specimens.disc(40, r).astype(np.uint8) * 255) for r in (8, 15))
    path = tmp_path / "pages.tif"
    first.save(path, save_all=True, append_images=[second])
    assert mesh_image(path).report.areas[1]["image"] == specimens.disc(40, 8).sum()
    assert mesh_image(path, page=1).report.areas[1]["image"] == specimens.disc(40, 15).sum()


def test_spacing_from_the_file(tmp_path):
    path = saved(DISC.astype(np.uint8) * 255, tmp_path / "disc.png", dpi=(254, 254))
    assert mesh_image(path).frame.spacing == (1, 1)
    assert mesh_image(path, spacing="file").frame.spacing == pytest.approx((0.1, 0.1), rel=1e-3)


def test_names_are_kept_with_the_mesh():
    names = {1: "bone", 2: "marrow"}
    mesh = mesh_image(GRAINS, labels=[1, 2], names=names)
    assert mesh.names == names
    assert mesh.smoothed().names == names
    assert mesh_image(DISC).names == {}


def test_a_name_of_no_region_is_refused():
    with pytest.raises(ParameterError, match=r"^names: expected labels of the image, found 2; it has \[1\]"):
        mesh_image(DISC, names={1: "bone", 2: "marrow"})
    with pytest.raises(ParameterError, match="^names: expected labels of the image, found 0; it has "):
        mesh_image(GRAINS, labels=True, names={0: "outside"})


def test_names_are_those_of_the_moment_and_in_the_report():
    names = {1: "bone"}
    mesh = mesh_image(DISC, names=names)
    names[1] = "stone"
    assert mesh.names == {1: "bone"}
    assert "bone" in mesh.report.to_json()


@pytest.mark.parametrize("options", [{"names": ["bone"]}, {"names": {"a": "bone"}}, {"edge_length": {7: 3}}, {"background": "white"}])
def test_what_means_nothing_is_refused(options):
    with pytest.raises(ParameterError):
        mesh_image(DISC, **options)


def test_labels_from_an_iterator_are_in_the_report():
    assert mesh_image(GRAINS, labels=iter([2, 1])).report.settings["labels"] == [1, 2]


@pytest.mark.parametrize("recipe", RECIPES)
def test_progress_tells_the_stages_in_order(recipe):
    told = []
    mesh_image(UNEVEN * 255, recipe=recipe, progress=lambda stage, fraction: told.append((stage, fraction)))
    stages, fractions = zip(*told, strict=True)
    assert told[0] == ("reading", 0)
    assert told[-1] == ("done", 1)
    assert list(fractions) == sorted(fractions)
    assert {"reading", "labels", "outlines", "smoothing", "done"} <= set(stages)


@pytest.mark.parametrize("stage", ["reading", "labels", "outlines", "triangles", "smoothing"])
def test_raising_in_progress_cancels(stage):
    class Cancelled(Exception):
        pass

    told = []

    def progress(now, _):
        told.append(now)
        if now == stage:
            raise Cancelled

    with pytest.raises(Cancelled):
        mesh_image(UNEVEN, progress=progress)
    assert told[-1] == stage


# ---- the paper's recipes ----


def test_structured_is_the_stage_of_that_name():
    white = UNEVEN.astype(np.uint8) * 255
    mesh, alone = mesh_image(white, recipe="structured", step=7), structured_mesh(UNEVEN, step=7)
    column, row = alone.points.T
    assert np.array_equal(mesh.vertices, np.stack([column + 0.5, 60 - row - 0.5], axis=1))
    assert len(mesh.triangles) == len(alone.triangles)
    assert mesh.report.counted["grid_points"] == alone.counted["grid_points"]
    assert set(np.round((mesh.vertices - mesh.vertices.min(axis=0)) % 7, 9).ravel().tolist()) == {0}


def test_the_paper_fills_holes_and_the_report_says_so():
    for recipe in ("structured", "unstructured"):
        mesh = mesh_image(UNEVEN * 255, recipe=recipe, edge_length=4)
        assert mesh.report.recipe == recipe
        assert mesh.report.topology[1] == {"found": (1, 0), "expected": (1, 1)}
        assert any("expected 1 with 1" in line for line in mesh.report.warnings)
        assert mesh.report.wrong_pixels > 0
        assert mesh.report.tolerance is None
        assert mesh.report.min_angle is None
        assert (oracles.areas(mesh.vertices, mesh.triangles) > 0).all()


def test_unstructured_has_the_points_that_are_wanted():
    options = {"recipe": "unstructured", "n_boundary_points": 30, "n_interior_points": 12, "min_distance": 3, "min_distance_to_boundary": 2}
    mesh = mesh_image(DISC * 255, **options)
    assert mesh.report.counted["boundary_points"] == [30]
    assert mesh.report.counted["interior_points"] == [12]
    assert len(oracles.boundary(mesh.triangles)) == 30
    assert len(mesh.vertices) == 42
    assert {name: mesh.report.settings[name] for name in options if name != "recipe"} == {k: v for k, v in options.items() if k != "recipe"}


def test_lengths_of_the_paper_have_units_too():
    white = UNEVEN * 255
    one = mesh_image(white, recipe="structured", step=5)
    assert same(one, mesh_image(white, recipe="structured", step="5px"))
    assert same(one, mesh_image(white, recipe="structured", step="5%"))  # the diagonal is 100
    half = mesh_image(white, recipe="structured", step="5px", spacing=0.5)
    assert np.array_equal(half.vertices, one.vertices / 2)


def test_edge_length_is_the_step_of_the_paper_if_there_is_none():
    white = UNEVEN * 255
    assert same(mesh_image(white, recipe="structured", edge_length=6), mesh_image(white, recipe="structured", step=6))


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_the_paper_on_labels(recipe):
    mesh = mesh_image(GRAINS, recipe=recipe, labels=True, edge_length=3)
    assert set(mesh.regions.tolist()) <= set(range(1, 7))
    assert len(set(mesh.regions.tolist())) > 4


# ---- the images of the project ----


@pytest.mark.skipif(not DATA.is_dir(), reason="the images are in the checkout only")
@pytest.mark.parametrize("name", sorted(p.name for p in DATA.glob("*.png")) if DATA.is_dir() else [])
def test_the_images_of_the_project_keep_every_promise(name):
    labels = np.asarray(Image.open(DATA / name))
    mesh = mesh_image(DATA / name, labels=True if name == "polycrystal.png" else None)
    assert mesh.report.kept, mesh.report.warnings
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert all(abs(row["error"]) < 0.01 for row in mesh.report.areas.values())
    if name == "polycrystal.png":
        oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, labels.astype(int), background=0)


# ---- same input, same mesh ----


def digest(mesh):
    return hashlib.sha256(b"".join(a.tobytes() for a in (mesh.vertices, mesh.triangles, mesh.regions))).hexdigest()


@pytest.mark.parametrize("recipe", RECIPES)
def test_same_input_same_mesh(recipe):
    options = {"recipe": recipe, "edge_length": 4, "smoothing": "uniform"}
    here = digest(mesh_image(UNEVEN * 255, **options))
    assert digest(mesh_image(UNEVEN * 255, **options)) == here
    code = f"import test_pipeline as t; print(t.digest(t.mesh_image(t.UNEVEN * 255, **{options!r})))"
    path = os.pathsep.join([str(Path(__file__).parent), str(Path(img2tri.__file__).parents[1])])
    env = os.environ | {"PYTHONPATH": path, "PYTHONHASHSEED": "7"}
    there = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env).stdout.strip()
    assert there == here


def test_labels_too():
    assert digest(mesh_image(GRAINS, labels=True)) == digest(mesh_image(GRAINS.copy(), labels=True))


# ---- bad input ----

MANY = np.arange(12).reshape(3, 4)
REFUSED = {
    "zero rows": (np.zeros((0, 5)), {}, ImageError, "image: expected at least one pixel, found shape (0, 5)"),
    "one dimension": (np.ones(5), {}, ImageError, "image: expected shape (h, w), or (h, w, 3 or 4) with colours, found (5,)"),
    "a stack": (np.ones((5, 6, 7)), {}, ImageError, "found (5, 6, 7); pick one image of a stack"),
    "two channels": (np.ones((5, 6, 2)), {}, ImageError, "found (5, 6, 2)"),
    "text": (np.array([["a"]]), {}, ImageError, "image: expected an array of bool, integer or floating point values"),
    "complex": (np.ones((3, 3), complex), {}, ImageError, "found an array of type complex128"),
    "nothing": (None, {}, ImageError, "image: expected an array"),
    "NaN": (np.full((3, 3), np.nan), {}, ImageError, "image: expected pixels that are there, found only transparent ones, NaN"),
    "infinite": (np.array([[1, np.inf]]), {}, ImageError, "image: expected finite values, found 1 NaN or infinite"),
    "black": (np.zeros((9, 9), bool), {}, ImageError, "image: expected pixels to mesh, found none"),
    "black, gray": (np.zeros((9, 9), np.uint8), {}, ImageError, "image: expected pixels to mesh, found none above the threshold 0"),
    "all background": (np.full((9, 9), 3), {"labels": True, "background": 3}, ImageError, "image: expected pixels to mesh, found none"),
    "white, inverted": (np.ones((9, 9), bool), {"invert": True}, ImageError, "image: expected pixels to mesh, found none"),
    "too dark": (DISC * 200, {"threshold": 240}, ImageError, "above the threshold 240 (given); try another threshold=, or invert=True"),
    "too dark for the paper": (DISC * 200, {"recipe": "structured"}, ImageError, "none above the threshold 240"),
    "one value": (np.ones((9, 9), np.uint8), {"threshold": "otsu"}, ImageError, "threshold: 'otsu' expected at least two values"),
    "labels not said": (MANY, {}, ImageError, "labels=True makes each value a region of its own"),
    "labels not whole": (np.array([[0.5, 1]]), {"labels": True}, ImageError, "labels: expected whole numbers, found 0.5"),
    "label not there": (MANY, {"labels": [1, 99]}, ImageError, "labels: expected values of the image, found 99"),
    "no labels": (MANY, {"labels": []}, ParameterError, "labels: expected True or a list of integers, found []"),
    "one label": (MANY, {"labels": 3}, ParameterError, "labels: expected True or a list of integers, found 3"),
    "background in labels": (MANY, {"labels": [0, 1]}, ParameterError, "give background=None to mesh it too"),
    "threshold with labels": (MANY, {"labels": True, "threshold": 3}, ParameterError, "threshold: expected to be left out"),
    "invert with labels": (MANY, {"labels": True, "invert": True}, ParameterError, "invert: expected to be left out"),
    "background": (MANY, {"labels": True, "background": 0.5}, ParameterError, "background: expected an integer or None, found 0.5"),
    "recipe": (DISC, {"recipe": "magic"}, ParameterError, "expected one of 'conforming', 'structured', 'unstructured', found 'magic'"),
    "threshold": (DISC * 1.0, {"threshold": "high"}, ParameterError, "threshold: expected a number, 'otsu', 'alpha' or None, found 'high'"),
    "threshold NaN": (DISC * 1.0, {"threshold": np.nan}, ParameterError, "threshold: expected a number, found nan"),
    "connectivity": (DISC, {"connectivity": 6}, ParameterError, "connectivity: expected 4 or 8, found 6"),
    "outline": (DISC, {"outline": "soft"}, ParameterError, "outline: expected one of 'smooth', 'pixel', found 'soft'"),
    "corners": (DISC, {"corners": "soft"}, ParameterError, "corners: expected one of 'auto', 'keep', 'round', found 'soft'"),
    "smoothing": (DISC, {"smoothing": "soft"}, ParameterError, "smoothing: expected one of 'none', 'uniform', 'cotangent', found 'soft'"),
    "iterations": (DISC, {"iterations": 1.5}, ParameterError, "iterations: expected a whole number of at least 0, found 1.5"),
    "seed": (DISC, {"seed": -1}, ParameterError, "seed: expected a whole number of at least 0, found -1"),
    "page": (DISC, {"page": 1}, ParameterError, "page: expected 0 for an array"),
    "max_pixels": (DISC, {"max_pixels": 0}, ParameterError, "max_pixels: expected a whole number of at least 1, found 0"),
    "min_angle below": (DISC, {"min_angle": -1}, ParameterError, "min_angle: expected a number of at least 0 and of at most 32, found -1"),
    "min_angle above": (DISC, {"min_angle": 40}, ParameterError, "min_angle: expected a number of at least 0 and of at most 32, found 40"),
    "tolerance": (DISC, {"tolerance": 0}, ParameterError, "tolerance: expected a number above 0, found 0"),
    "tolerance unit": (DISC, {"tolerance": "1mm"}, ParameterError, "tolerance: expected a number with a unit, like 8, '8px'"),
    "crop": (DISC, {"crop": (1, 2, 3)}, ParameterError, "crop: expected"),
    "crop outside": (DISC, {"crop": (100, 100, 120, 120)}, Img2triError, "crop"),
    "min_area": (DISC, {"min_area": -1}, ParameterError, "min_area: expected a number of at least 0, found -1"),
    "min_area unit": (DISC, {"min_area": "4px"}, ParameterError, "min_area: expected a number with a unit, like 4 or '4px2', found '4px'"),
    "nothing large enough": (DISC, {"min_area": 2000}, ImageError, "found none"),
    "spacing pair": (DISC, {"spacing": (1, 2, 3)}, ParameterError, "spacing: expected a pair of numbers, found 3"),
    "spacing word": (DISC, {"spacing": "mm"}, ParameterError, "spacing: expected a number, a pair (dx, dy), 'file' or None, found 'mm'"),
    "spacing of an array": (DISC, {"spacing": "file"}, ParameterError, "spacing: 'file' expected a resolution"),
    "origin": (DISC, {"origin": "middle"}, ParameterError, "origin: expected 'lower', 'upper' or a pair (x, y), found 'middle'"),
    "origin NaN": (DISC, {"origin": (0, np.nan)}, ParameterError, "origin: expected a number, found nan"),
    "step": (DISC * 255, {"recipe": "structured", "step": 0}, ParameterError, "step: expected a number above 0, found 0"),
    "step too large": (DISC * 255, {"recipe": "structured", "step": 100}, ImageError, "step 100"),
    "n_boundary_points": (
        DISC * 255,
        {"recipe": "unstructured", "n_boundary_points": 2},
        ParameterError,
        "n_boundary_points: expected a whole number of at least 3, found 2",
    ),
    "n_interior_points": (
        DISC * 255,
        {"recipe": "unstructured", "n_interior_points": -1},
        ParameterError,
        "n_interior_points: expected a whole number of at least 0, found -1",
    ),
    "min_distance": (
        DISC * 255,
        {"recipe": "unstructured", "min_distance": -1},
        ParameterError,
        "min_distance: expected a number of at least 0, found -1",
    ),
    "min_distance_to_boundary": (
        DISC * 255,
        {"recipe": "unstructured", "min_distance_to_boundary": np.nan},
        ParameterError,
        "min_distance_to_boundary: expected a number of at least 0, found nan",
    ),
    "option of another recipe": (DISC, {"step": 5}, ParameterError, "step"),
    "option unknown": (DISC, {"edge_lenght": 5}, TypeError, "edge_lenght"),
    **{
        f"{name} {value}": (DISC, {name: value}, ParameterError, f"{name}: expected a number above 0, found {value}")
        for name in ("edge_length", "spacing", "tolerance")
        for value in (-8, 0, 0.0, np.nan, np.inf)
    },
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_with_its_own_words(case):
    image, options, error, words = REFUSED[case]
    with pytest.raises(error) as refused:
        mesh_image(image, **options)
    assert words in str(refused.value)
    if error is not TypeError:
        assert isinstance(refused.value, Img2triError)
        assert isinstance(refused.value, OSError if error is FileError else ValueError)


def files(folder):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64), np.uint8)
    for suffix in (".png", ".jpg", ".tif"):
        data = saved(noise, folder / f"whole{suffix}").read_bytes()
        (folder / f"cut{suffix}").write_bytes(data[: len(data) // 2])
    (folder / "text.png").write_text("not an image")
    (folder / "empty.png").write_bytes(b"")
    (folder / "folder.png").mkdir()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("none.png", "there is no file"),
        ("folder.png", "found the folder"),
        ("text.png", "is not an image in a known format"),
        ("empty.png", "is empty"),
        ("cut.png", "is damaged or truncated"),
        ("cut.jpg", "is damaged or truncated"),
        ("cut.tif", "is damaged or truncated"),
    ],
)
def test_a_bad_file_is_refused_by_name(name, words, tmp_path):
    files(tmp_path)
    with pytest.raises(FileError) as refused:
        mesh_image(tmp_path / name)
    assert isinstance(refused.value, OSError)
    assert words in str(refused.value)
    assert name in str(refused.value)


def test_a_file_of_too_many_pixels_is_refused(tmp_path):
    path = saved(DISC.astype(np.uint8) * 255, tmp_path / "disc.png")
    mesh_image(path, max_pixels=1600)
    with pytest.raises(ImageError, match="at most max_pixels=1599 pixels, found 40 x 40"):
        mesh_image(path, max_pixels=1599)


def test_every_error_is_one_sentence_of_its_own():
    assert len({words for *_, words in REFUSED.values()}) > 40
    assert issubclass(FileError, OSError)
    assert issubclass(ParameterError, ValueError)
    assert set(SMOOTHINGS) == {"none", "uniform", "cotangent"}


@pytest.mark.parametrize(
    ("units", "word", "svg"), [("mm", "millimeter", "mm"), ("um", "micron", ""), ("in", "inch", "in"), (None, "millimeter", "")]
)
def test_units_reach_objects_and_files(tmp_path, units, word, svg):
    mesh = mesh_image(specimens.disc(30, 10), edge_length=5, units=units)
    assert mesh.to_trimesh(height=2).units == units
    texts = mesh.to_pyvista().field_data
    assert (texts["units"][0] if units else "units" in texts) == (units or False)
    mesh.save(tmp_path / "disc.3mf", height=2)
    mesh.save(tmp_path / "disc.svg")
    with zipfile.ZipFile(tmp_path / "disc.3mf") as package:
        assert f'unit="{word}"' in package.read("3D/3dmodel.model").decode()
    assert f'width="30{svg}"' in (tmp_path / "disc.svg").read_text()


def test_files_that_know_their_pixels_are_in_millimetres(tmp_path):
    path = tmp_path / "slice.tif"
    Image.fromarray(specimens.disc(30, 10).astype(np.uint8) * 255).save(path, resolution=10, resolution_unit=3)  # pixels per cm
    assert mesh_image(path, edge_length="5px", spacing="file").origin.settings["units"] == "mm"
    assert mesh_image(path, edge_length="5px").origin.settings["units"] is None
    assert mesh_image(path, edge_length="5px", spacing="file", units="cm").origin.settings["units"] == "cm"


def test_units_that_are_none():
    with pytest.raises(ParameterError, match="units: expected one of 'um', 'mm', 'cm', 'm', 'in', 'ft', found 'furlong'"):
        mesh_image(specimens.disc(30, 10), units="furlong")


# ---- as wide as wanted ----


def test_an_image_as_wide_as_wanted():
    wide = mesh_image(UNEVEN, width=80, edge_length=4)
    pixel = 80 / UNEVEN.shape[1]
    assert same(wide, mesh_image(UNEVEN, spacing=pixel, edge_length=4))
    assert wide.frame.bounds == pytest.approx((0, 0, 80, pixel * UNEVEN.shape[0]))
    assert wide.report.settings["spacing"] == (pixel, pixel)
    assert same(mesh_image(UNEVEN, **wide.report.options), wide)
    part = mesh_image(UNEVEN, width=80, crop=(0, 0, 40, 40), edge_length=4)
    assert part.frame.pixel == pytest.approx(pixel)
    with pytest.raises(ParameterError, match="width: expected to be left out with the size of a pixel"):
        mesh_image(UNEVEN, width=80, spacing=2)
    with pytest.raises(ParameterError, match="width: expected a number above 0, found -1"):
        mesh_image(UNEVEN, width=-1)
    with pytest.raises(ParameterError, match="width: expected pixels that numbers of 64 bits can part"):
        mesh_image(UNEVEN, width=1e-9, origin=(1e6, 0))


def test_pixels_keep_the_shape_a_file_knows(tmp_path):
    path = tmp_path / "flat.png"
    Image.fromarray(UNEVEN.astype(bool)).save(path, dpi=(254, 127))
    mesh = mesh_image(path, width=50, spacing="file")
    dx, dy = mesh.frame.spacing
    assert dx == pytest.approx(50 / UNEVEN.shape[1])
    assert dy / dx == pytest.approx(2, rel=1e-3)
    assert mesh.report.settings["units"] is None


@pytest.mark.parametrize("labels", [False, True])
def test_an_edit_of_a_corner_changes_triangles_near_it_only(labels):
    image = ndimage.gaussian_filter(np.random.default_rng(0).standard_normal((400, 400)), 6)
    image = np.digitize(image, [-0.02, 0.02]) if labels else image > 0
    edited = image.copy()
    edited[20:30, 20:30] = image[200, 200] ^ 1
    middles = []
    for one in (image, edited):
        mesh = mesh_image(one, edge_length=4.0, **({"labels": True} if labels else {}))
        middle = mesh.vertices[mesh.triangles].mean(axis=1)
        middles.append(middle[np.hypot(middle[:, 0] - 25, middle[:, 1] - 375) > 48 * 4.0])
    distance = KDTree(middles[1]).query(middles[0])[0]
    assert len(distance) > 3000
    assert (distance < 0.4).mean() > 0.99  # .8 where points are put off, and valences repaired, in the order of numbers
