"""The paper's recipes as a whole, against the listing and for what they are known to get wrong."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
from benchmarks import listing
from benchmarks.shapes import blob
from scipy.spatial import cKDTree

from img2tri.errors import ImageError, ParameterError
from img2tri.paper.contours import contour_polygon, external_contours
from img2tri.paper.structured_unstructured import paper_mesh, structured_mesh, unstructured_mesh
from img2tri.triangles.tools.laplacian_smoothing import uniform
from img2tri.types import Frame

BLOB = blob(192, holes=0)
HOLES = blob(192)
TWO = np.concatenate([BLOB, blob(192, seed=1)], axis=1)


def as_places(points, triangles):
    return {tuple(sorted(map(tuple, corners))) for corners in np.round(points[triangles], 9).tolist()}


def edges_mean(points, triangles):
    edges, _ = oracles.edge_counts(triangles)
    return np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).mean()


def test_structured_points_and_area_are_those_of_the_listing():
    mesh = structured_mesh(BLOB)
    binary = BLOB * np.uint8(255)
    points = listing.adjust_mesh(listing.generate_mesh(binary.shape), binary)
    np.testing.assert_array_equal(mesh.points, points)
    theirs = listing.valid_triangles(listing.create_mesh(points), points, contour_polygon(external_contours(BLOB)[0]))
    # Squares of a grid may be halved along either diagonal; what is covered is the same but for the ends of diagonals at the outline.
    assert oracles.areas(mesh.points, mesh.triangles).min() > 0
    assert len(mesh.triangles) == pytest.approx(len(theirs), abs=4)


def test_structured_step():
    assert len(structured_mesh(BLOB, step=5).triangles) > 3.5 * len(structured_mesh(BLOB, step=10).triangles)


def test_unstructured_is_what_the_listing_makes_of_the_same_points(monkeypatch):
    """With our darts in the place of its own, `put_together` makes our mesh, smoothing included."""
    n_boundary, n_interior = 51, 150  # with 50 the listing loses a point to rounding
    counts = {"n_boundary_points": n_boundary, "n_interior_points": n_interior}
    ours = unstructured_mesh(BLOB, **counts, min_distance=6, min_distance_to_boundary=5, seed=3)
    assert ours.counted["interior_points"] == [n_interior]
    darts = ours.points[~ours.fixed]
    monkeypatch.setattr(listing, "poisson_disk_sampling", lambda *_: darts)
    [(theirs, triangles, boundary)] = listing.put_together(BLOB * np.uint8(255), n_boundary, n_interior, 6, 5, None)
    assert len(boundary) == n_boundary + 1
    np.testing.assert_array_equal(boundary[-1], boundary[0])
    smooth = uniform(ours.points, ours.triangles, iterations=10, fixed=ours.fixed)
    assert as_places(smooth, ours.triangles) == as_places(theirs, triangles)


def test_unstructured_keeps_its_distances():
    mesh = unstructured_mesh(TWO, edge_length=9, min_distance=6, min_distance_to_boundary=8)
    inside, on = mesh.points[~mesh.fixed], mesh.points[mesh.fixed]
    assert cKDTree(inside).query(inside, k=2)[0][:, 1].min() > 6
    assert cKDTree(on).query(inside)[0].min() > 8
    assert mesh.counted["contours"] == 2
    assert len(mesh.counted["interior_points"]) == 2
    assert oracles.mesh_topology(mesh.triangles)[0] == 2


@pytest.mark.parametrize("edge_length", [4, 8, 12])
def test_defaults_make_edges_of_the_length_asked_for(edge_length):
    mesh = unstructured_mesh(blob(512, holes=0), edge_length=edge_length)
    smooth = uniform(mesh.points, mesh.triangles, iterations=10, fixed=mesh.fixed)
    assert edges_mean(smooth, mesh.triangles) == pytest.approx(edge_length, rel=0.03)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("edge_length", 6),
        ("n_boundary_points", 20),
        ("n_interior_points", 30),
        ("min_distance", 12),
        ("min_distance_to_boundary", 20),
        ("seed", 1),
    ],
)
def test_each_option_changes_the_mesh(option, value):
    plain, other = unstructured_mesh(BLOB), unstructured_mesh(BLOB, **{option: value})
    assert not np.array_equal(plain.points, other.points)


def test_how_many_fitted_is_counted():
    mesh = unstructured_mesh(BLOB, n_interior_points=10**6)
    assert mesh.counted["interior_points_wanted"] == 10**6
    assert 0 < mesh.counted["interior_points"][0] < 1000
    assert (~mesh.fixed).sum() == mesh.counted["interior_points"][0]


@pytest.mark.parametrize("recipe", [structured_mesh, unstructured_mesh])
def test_holes_are_filled(recipe):
    mesh = recipe(HOLES)
    assert oracles.mesh_topology(mesh.triangles) == (1, 0)
    assert oracles.areas(*_parts(mesh)).sum() == pytest.approx(oracles.areas(*_parts(recipe(BLOB))).sum(), rel=1e-3)


def _parts(mesh):
    return mesh.points, mesh.triangles


def test_half_a_pixel_is_lost_all_around():
    square = np.pad(np.ones((101, 101), bool), 4)
    mesh = unstructured_mesh(square, n_boundary_points=40)
    assert oracles.areas(*_parts(mesh)).sum() == pytest.approx(100 * 100)


@pytest.mark.parametrize("name", specimens.MASKS)
@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_small_masks_make_a_mesh_or_a_clear_error(name, recipe):
    mask = np.kron(specimens.MASKS[name], np.ones((3, 3), int))
    try:
        made = paper_mesh(mask, Frame(mask.shape), recipe=recipe, edge_length=2.0)
    except ImageError as error:
        made, message = None, str(error)
    if made is None:
        assert message.startswith("mask: expected a white zone")
        return
    assert oracles.areas(made.vertices, made.triangles).min() >= 0
    assert len(np.unique(made.triangles)) == len(made.vertices)
    assert made.vertices.min() >= 0.5
    assert (made.vertices.max(axis=0) <= np.array(mask.shape)[::-1] - 0.5).all()


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_the_mesh_lies_where_the_image_does(recipe):
    frame = Frame(BLOB.shape, spacing=(0.5, 0.5), corner=(100, -20))
    made = paper_mesh(BLOB, frame, recipe=recipe, edge_length=8)
    rows, columns = np.nonzero(BLOB)
    world = frame.world(made.vertices)
    white = frame.xy(rows + 0.5, columns + 0.5)
    assert (oracles.areas(world, made.triangles) >= 0).all()
    close = 0.5 * (8 if recipe == "structured" else 2)
    np.testing.assert_allclose([world.min(axis=0), world.max(axis=0)], [white.min(axis=0), white.max(axis=0)], atol=close)
    assert set(made.regions.tolist()) == {1}


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_turning_the_image_upside_down_mirrors_the_mesh(recipe):
    up = paper_mesh(BLOB, Frame(BLOB.shape), recipe=recipe, edge_length=8)
    down = paper_mesh(BLOB, Frame(BLOB.shape, upward=False), recipe=recipe, edge_length=8)
    np.testing.assert_allclose(down.vertices, [0, BLOB.shape[0]] + up.vertices * [1, -1], atol=1e-9)
    assert (oracles.areas(down.vertices, down.triangles) >= 0).all()


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_pixels_that_are_not_square(recipe):
    """An image squeezed to half its width, with pixels twice as wide, makes triangles as even as before."""
    squeezed = blob(256, holes=0)[:, ::2]
    frame = Frame(squeezed.shape, spacing=(2.0, 1.0))
    made = paper_mesh(squeezed, frame, recipe=recipe, edge_length=8)
    angles = oracles.angles(made.vertices, made.triangles)
    assert np.median(angles.min(axis=1)) > (44 if recipe == "structured" else 45)
    assert np.ptp(made.vertices, axis=0) == pytest.approx([2 * np.ptp(np.nonzero(squeezed)[1]), np.ptp(np.nonzero(squeezed)[0])], abs=9)


def test_every_label_is_a_white_zone_of_its_own():
    labels = specimens.polycrystal(96, 6)
    made = paper_mesh(labels, Frame(labels.shape), recipe="unstructured", edge_length=5, background=3)
    assert sorted(set(made.regions.tolist())) == [1, 2, 3, 4, 5]
    area = np.bincount(made.regions, oracles.areas(made.vertices, made.triangles))[1:]
    pixels = [np.sum(labels == v) for v in (1, 2, 4, 5, 6)]
    assert (area < pixels).all()
    assert (area > 0.8 * np.array(pixels)).all()
    assert list(made.counted) == ["1", "2", "4", "5", "6"]


def test_smoothing_leaves_the_contour_in_place():
    plain, smooth = (paper_mesh(BLOB, Frame(BLOB.shape), recipe="unstructured", edge_length=8, iterations=k) for k in (0, 10))
    moved = (plain.vertices != smooth.vertices).any(axis=1)
    assert moved.sum() == smooth.counted["interior_points"][0]
    before, after = (oracles.angles(made.vertices, made.triangles).min(axis=1).mean() for made in (plain, smooth))
    assert after > before + 2


def test_lengths_with_units():
    frame = Frame(BLOB.shape, spacing=(0.5, 0.5))
    numbers = paper_mesh(BLOB, frame, recipe="unstructured", edge_length=8, min_distance=3, min_distance_to_boundary=4)
    strings = paper_mesh(BLOB, frame, recipe="unstructured", edge_length=8, min_distance="6px", min_distance_to_boundary="8px")
    np.testing.assert_array_equal(numbers.vertices, strings.vertices)
    assert len(paper_mesh(BLOB, frame, recipe="structured", edge_length=8, step="4px").triangles) > 1000


@pytest.mark.parametrize("recipe", [structured_mesh, unstructured_mesh])
def test_nothing_white(recipe):
    with pytest.raises(ImageError, match="mask: expected a white zone"):
        recipe(np.zeros((50, 50), bool))


def test_a_white_zone_smaller_than_the_step():
    with pytest.raises(ImageError, match="mask: expected a white zone"):
        structured_mesh(np.pad(np.ones((5, 5), bool), 20), step=12)


def test_nothing_but_background():
    with pytest.raises(ImageError, match="image: expected pixels to mesh, found only background"):
        paper_mesh(np.full((9, 9), 4), Frame((9, 9)), recipe="structured", edge_length=3, background=4)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"edge_length": 0}, "edge_length: expected a number above 0"),
        ({"n_boundary_points": 2}, "n_boundary_points: expected a whole number of at least 3"),
        ({"n_interior_points": -1}, "n_interior_points: expected a whole number"),
        ({"min_distance": -1}, "min_distance: expected a number of at least 0"),
        ({"min_distance_to_boundary": np.nan}, "min_distance_to_boundary: expected a number of at least 0"),
        ({"seed": 0.5}, "seed: expected a whole number"),
    ],
)
def test_wrong_options(option, message):
    with pytest.raises(ParameterError, match=message):
        unstructured_mesh(BLOB, **option)


def test_an_unknown_recipe():
    with pytest.raises(ParameterError, match="recipe: expected one of 'structured', 'unstructured', found 'round'"):
        paper_mesh(BLOB, Frame(BLOB.shape), recipe="round", edge_length=8)


def test_a_polygon_that_is_cut_by_the_frame():
    mesh = unstructured_mesh(np.ones((60, 80), bool), edge_length=5)
    assert shapely.box(0, 0, 79, 59).covers(shapely.multipoints(mesh.points))
    assert (oracles.areas(*_parts(mesh)).sum()) == pytest.approx(79 * 59, rel=0.01)


def test_a_contour_that_encloses_nothing_is_counted():
    mask = np.zeros((60, 60), bool)
    mask[5:30, 5:30] = True
    for k in range(9):
        mask[40 + k, 40 + k] = mask[40 + k, 56 - k] = True  # two diagonals, traced out and back
    assert contour_polygon(external_contours(mask)[0]).is_empty
    mesh = unstructured_mesh(mask, edge_length=5)
    assert (mesh.counted["contours"], mesh.counted["contours_without_triangles"]) == (2, 1)
    assert mesh.points.max() <= 30


def test_a_contour_whose_points_lie_on_one_line_is_counted():
    mask = np.zeros((60, 120), bool)
    mask[5:30, 5:30] = True
    mask[50, 10:110] = mask[51, 60] = True  # a line with a bump too small for a point
    mesh = unstructured_mesh(mask, n_boundary_points=3, n_interior_points=0)
    assert (mesh.counted["contours"], mesh.counted["contours_without_triangles"]) == (2, 1)
    assert mesh.points[:, 1].max() <= 30


def test_a_zone_narrower_than_the_grid_is_refused():
    mask = np.zeros((40, 40), bool)
    mask[0:2, 0:31] = mask[0:31, 0:2] = True  # an angle, with three points of the grid whose triangle lies beside it
    with pytest.raises(ImageError, match="mask: expected a white zone wider than step, found no triangle at step 30; make it smaller"):
        structured_mesh(mask, step=30)
    assert len(structured_mesh(mask, step=1).triangles) > 50
