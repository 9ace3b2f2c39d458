"""Random images and options: every promise holds, by the oracles and by the report."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens
import strategies
from hypothesis import assume, given
from hypothesis import strategies as st
from strategies import FEW, QUICK, THOROUGH

from img2tri import mesh_image

SURE = 0.5  # px: a tolerance that can always be kept
OPTIONS = st.fixed_dictionaries(
    {
        "edge_length": strategies.edge_lengths(),
        "tolerance": strategies.tolerances(),
        "min_angle": strategies.min_angles(),
        "connectivity": st.sampled_from([4, 8]),
    }
)


def check_promises(mesh, labels, *, background, tolerance, min_angle, connectivity, **_):
    """All oracles, and the report of the same mind."""
    v, t, r = mesh.vertices, mesh.triangles, mesh.regions
    oracles.check_valid(v, t)
    assert oracles.angles(v, t).min() >= min_angle - 1e-6
    meshed = [label for label in np.unique(labels).tolist() if label != background]
    if len(meshed) == 1 and connectivity == 8:
        assert oracles.mesh_topology(t) == oracles.pixel_topology(labels == meshed[0], 8)
        assert set(r.tolist()) == set(meshed)
    else:
        oracles.check_faithful(v, t, r, labels, background=background, tolerance=max(tolerance, SURE))
    report = mesh.report
    # Below half a pixel a narrow place may need more than the tolerance; then the report says so.
    too_far = [line for line in report.warnings if tolerance < SURE and "apart at" in line]
    assert report.warnings == too_far
    assert report.hausdorff <= (SURE if too_far else tolerance) * (1 + 1e-9)
    assert report.smallest_angle == pytest.approx(oracles.angles(v, t).min(), abs=1e-6)
    for label in meshed:
        mine = t[r == label]
        assert report.topology[label]["found"] == oracles.mesh_topology(mine)
        assert report.areas[label]["mesh"] == pytest.approx(oracles.areas(v, mine).sum(), rel=1e-9)
        assert report.areas[label]["image"] == pytest.approx((labels == label).sum())
    if background is None:
        assert oracles.areas(v, t).sum() == pytest.approx(labels.size, rel=1e-9)


def all_promises(case, options):
    labels, background = case
    mesh = mesh_image(labels, labels=True, background=background, **options)
    check_promises(mesh, labels, background=background, **options)


@QUICK
@given(strategies.maps_and_backgrounds(), OPTIONS)
def test_any_label_map(case, options):
    all_promises(case, options)


@pytest.mark.slow
@THOROUGH
@given(strategies.maps_and_backgrounds(24), OPTIONS)
def test_many_label_maps(case, options):
    all_promises(case, options)


def default_promises(case, outline, corners):
    labels, background = case
    mesh = mesh_image(labels, labels=True, background=background, outline=outline, corners=corners)
    check_promises(mesh, labels, background=background, tolerance=0.5, min_angle=30, connectivity=4)


@QUICK
@given(strategies.maps_and_backgrounds(), st.sampled_from(["smooth", "pixel"]), st.sampled_from(["auto", "round"]))
def test_any_label_map_with_the_defaults(case, outline, corners):
    default_promises(case, outline, corners)


@pytest.mark.slow
@THOROUGH
@given(strategies.maps_and_backgrounds(24), st.sampled_from(["smooth", "pixel"]), st.sampled_from(["auto", "round"]))
def test_many_label_maps_with_the_defaults(case, outline, corners):
    default_promises(case, outline, corners)


def mask_promises(mask, invert, options):
    white = (mask == 1) != invert
    assume(white.any())
    mesh = mesh_image(mask == 1, invert=invert, **options)
    assert set(mesh.regions.tolist()) == {1}
    check_promises(mesh, white.astype(int), background=0, **options)


@QUICK
@given(st.one_of(strategies.noise(), strategies.masks()), st.booleans(), OPTIONS)
def test_any_mask(mask, invert, options):
    mask_promises(mask, invert, options)


@pytest.mark.slow
@THOROUGH
@given(st.one_of(strategies.noise(30), strategies.masks(20)), st.booleans(), OPTIONS)
def test_many_masks(mask, invert, options):
    mask_promises(mask, invert, options)


def gray_promises(case, options):
    import shapely

    image, threshold = case
    assume((image > threshold).any())
    mesh = mesh_image(image, threshold=threshold, **options)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= options["min_angle"] - 1e-6
    assert oracles.mesh_topology(mesh.triangles) == oracles.pixel_topology(image > threshold, options["connectivity"])
    excused = [line for line in mesh.report.warnings if ": area " in line or (options["tolerance"] < SURE and "apart at" in line)]
    assert mesh.report.warnings == excused
    h, w = image.shape
    y, x = np.mgrid[:h, :w] + 0.5
    assert (shapely.contains_xy(mesh.outlines()[1], x, h - y) == (image > threshold)).all()


@QUICK
@given(strategies.gray_images(), OPTIONS)
def test_any_gray_image(case, options):
    gray_promises(case, options)


@pytest.mark.slow
@THOROUGH
@given(strategies.gray_images(30), OPTIONS)
def test_many_gray_images(case, options):
    gray_promises(case, options)


@FEW
@given(strategies.maps_and_backgrounds(10), st.sampled_from([0.5, 4.0, 0.7, 1e-4, 3e5]), strategies.edge_lengths())
def test_spacing_scales_any_mesh_exactly(case, spacing, edge_length):
    labels, background = case
    options = {"labels": True, "background": background, "edge_length": f"{edge_length}px"}
    one, scaled = mesh_image(labels, **options), mesh_image(labels, spacing=spacing, **options)
    assert np.array_equal(scaled.vertices, spacing * one.vertices)
    assert np.array_equal(scaled.triangles, one.triangles)
    assert np.array_equal(scaled.regions, one.regions)


@FEW
@given(strategies.maps_and_backgrounds(10), st.floats(0.2, 5), st.sampled_from(["lower", "upper"]))
def test_pixels_of_any_shape(case, ratio, origin):
    labels, background = case
    mesh = mesh_image(labels, labels=True, background=background, spacing=(1, ratio), origin=origin)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    upward = mesh.vertices * [1, 1 / ratio] if origin == "lower" else [0, labels.shape[0]] + mesh.vertices * [1, -1 / ratio]
    assert upward.min() >= -1e-9
    assert (upward.max(axis=0) <= np.array(labels.shape[::-1]) + 1e-9).all()
    assert oracles.mesh_neighbours(mesh.triangles, mesh.regions) == oracles.pixel_neighbours(labels, background)


@FEW
@given(strategies.maps_and_backgrounds(10), st.sampled_from(["uniform", "fixed", "free"]), st.integers(0, 20))
def test_smoothing_never_spoils(case, how, iterations):
    labels, background = case
    plain = mesh_image(labels, labels=True, background=background, edge_length=2)
    options = {"method": "uniform"} if how == "uniform" else {"method": "cotangent", "boundary": how}
    mesh = plain.smoothed(iterations=iterations, **options)
    assert np.array_equal(mesh.triangles, plain.triangles)
    assert (oracles.areas(mesh.vertices, mesh.triangles) > 0).all()
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= oracles.angles(plain.vertices, plain.triangles).min() - 1e-6
    moved = np.linalg.norm(mesh.vertices - plain.vertices, axis=1)[np.unique(oracles.boundary(plain.triangles))]
    assert moved.max() <= (0.5 + 1e-9 if how == "free" else 0)


@FEW
@given(strategies.maps_and_backgrounds(10), st.sampled_from(["uniform", "cotangent"]), st.integers(0, 20))
def test_smoothing_in_one_call_keeps_the_angles(case, smoothing, iterations):
    labels, background = case
    mesh = mesh_image(labels, labels=True, background=background, smoothing=smoothing, iterations=iterations)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6
    assert oracles.mesh_neighbours(mesh.triangles, mesh.regions) == oracles.pixel_neighbours(labels, background)


@FEW
@given(strategies.maps_and_backgrounds(8))
def test_the_same_mesh_again(case):
    labels, background = case
    one, other = (mesh_image(labels.copy(), labels=True, background=background) for _ in range(2))
    assert one.vertices.tobytes() == other.vertices.tobytes()
    assert one.triangles.tobytes() == other.triangles.tobytes()


NOISE = specimens.drawn(
    "...111.1.111",
    "......1..1.1",
    "..........11",
    "...........1",
    "........1.11",
    ".11.....1111",
    ".111.1111...",
    "..1111.....1",
    "...11111....",
)
GRAY = np.array([[1, -25, 38, 55, 70], [19, 67, -8, -21, 16], [-18, 18, 49, -23, -26], [22, 44, 39, -24, 49], [-14, 43, 52, 56, 63]]) / 10


@pytest.mark.parametrize(
    ("image", "options"),
    [
        (NOISE, {"labels": True, "background": None}),
        (GRAY, {"threshold": -1.944, "edge_length": 1, "tolerance": 0.25, "min_angle": 0}),
    ],
    ids=["labels", "gray"],
)
def test_areas_are_not_kept_at_the_expense_of_the_tolerance(image, options):
    assert mesh_image(image, **options, keep_area=False).report.kept
    # The area yields, and the certificate says so; all else is kept.
    assert all(": area " in line for line in mesh_image(image, **options).report.warnings)


def test_flat_pixels_have_the_angles_of_others():
    labels = specimens.drawn(".11", "1..", "...")
    assert mesh_image(labels, labels=True, background=None, spacing=(1, 0.25)).report.kept
