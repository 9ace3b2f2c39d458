"""A symmetric image gets a mesh that is its own mirror image, with vertices exactly on the axis, and every promise kept."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens
from scipy.spatial import cKDTree

from img2tri import ImageError, ParameterError, mesh_image

NOISE = (np.random.default_rng(0).random((14, 15)) < 0.5).astype(int)
LABELS = np.random.default_rng(1).integers(0, 4, (12, 13))
GRAY = np.clip(255 * np.hypot(*np.mgrid[-9:31, -20:24] / 20.0) / 2, 0, 255).astype(np.uint8)
CASES = {
    "disc": (specimens.disc(50, 30, (48.2, 47.4)), {"edge_length": 5}),
    "disc cut by the axis": (specimens.disc(50, 15, (25.2, 46.1)), {"edge_length": 4}),
    "grains": (specimens.polycrystal(48, 14, 3), {"labels": True, "edge_length": 5}),
    "gray": (GRAY, {"threshold": 100, "edge_length": 4}),
    "noise": (NOISE, {}),
    "noise, 8": (NOISE, {"connectivity": 8}),
    "labels": (LABELS, {"labels": True, "background": None}),
    "sides of pixels": (NOISE, {"outline": "pixel"}),
    "round": (specimens.rectangle(40, (30, 20), 20), {"corners": "round"}),
    "poisson": (specimens.disc(40, 25, (40, 40)), {"interior": "poisson", "edge_length": 4}),
    "not square": (specimens.polycrystal(40, 9, 3), {"labels": True, "spacing": (0.5, 0.8), "origin": "upper", "edge_length": "6px"}),
}


def doubled(image, directions, odd):
    """An image with its mirror image beside it; odd: the last line belongs to both."""
    for direction in directions:
        axis = 1 if direction == "x" else 0
        other = np.flip(image, axis)
        image = np.concatenate([image, np.delete(other, 0, axis) if odd else other], axis=axis)
    return image


@pytest.mark.parametrize("odd", [False, True])
@pytest.mark.parametrize("symmetric", ["x", "y", "xy"])
@pytest.mark.parametrize("name", CASES)
def test_a_symmetric_image_gets_a_symmetric_mesh(name, symmetric, odd):
    image, options = CASES[name]
    mesh = mesh_image(doubled(image, symmetric, odd), symmetric=symmetric, **options)
    assert mesh.report.kept, mesh.report.warnings
    oracles.check_valid(mesh.vertices, mesh.triangles)
    left, bottom, right, top = mesh.frame.bounds
    for direction in symmetric:
        i, axis = (0, (left + right) / 2) if direction == "x" else (1, (bottom + top) / 2)
        other = mesh.vertices.copy()
        other[:, i] = 2 * axis - other[:, i]
        distance, twin = cKDTree(mesh.vertices).query(other)
        assert distance.max() < 1e-9
        assert (np.sort(twin) == np.arange(len(twin))).all()
        # The triangles, with their regions, are those of the mirror image.
        rows = (np.column_stack([np.sort(triangles, axis=1), mesh.regions]) for triangles in (mesh.triangles, twin[mesh.triangles]))
        found, expected = (np.unique(row, axis=0) for row in rows)
        assert np.array_equal(found, expected)
        near = np.abs(mesh.vertices[:, i] - axis) < 1e-6
        assert (mesh.vertices[near, i] == axis).all()


def test_a_curve_is_as_smooth_across_the_axis_as_elsewhere():
    radius, n = 40.3, 120
    mesh = mesh_image(specimens.disc(n, radius), symmetric="x", edge_length=6)
    points = mesh.vertices[np.unique(oracles.boundary(mesh.triangles))] - n / 2
    off = np.abs(np.hypot(*points.T) - radius)
    near = np.abs(points[:, 0]) < 12
    assert off[near].max() <= off[~near].max() + 0.05


def test_what_is_not_symmetric_is_refused():
    image = doubled(CASES["disc"][0], "x", odd=False)
    image[30, 70] = 1 - image[30, 70]
    message = "^symmetric: expected an image whose left and right are mirror images, found . and . in row 30, columns 29 and 70 "
    with pytest.raises(ImageError, match=message):
        mesh_image(image, symmetric="x")
    with pytest.raises(ImageError, match="top and bottom"):
        mesh_image(doubled(CASES["disc"][0], "x", odd=False), symmetric="xy")
    image = doubled(GRAY, "x", odd=True).copy()
    image[3, 5] += 1  # of the same label, but another gray
    with pytest.raises(ImageError, match="row 3, columns 5 and 81"):
        mesh_image(image, symmetric="x", threshold=100)


AGAINST = {"periodic": {"periodic": "x"}, "smoothing": {"smoothing": "uniform"}, "symmetric": {"recipe": "structured"}}


@pytest.mark.parametrize("named", AGAINST)
def test_options_that_stand_against_it(named):
    with pytest.raises(ParameterError, match=f"^{named}: "):
        mesh_image(np.full((60, 60), 250, np.uint8), symmetric="x", threshold=100, **AGAINST[named])


def test_lengths_that_differ_from_side_to_side_are_refused():
    image = doubled(CASES["disc"][0], "x", odd=False)
    with pytest.raises(ParameterError, match="^edge_length: expected lengths that are the same on both sides"):
        mesh_image(image, symmetric="x", edge_length=lambda places: 3 + places[:, 0] / 20)
    assert mesh_image(image, symmetric="x", edge_length=lambda places: 3 + abs(places[:, 0] - 50) / 20).report.kept


@pytest.mark.parametrize("symmetric", ["x", "y", "xy"])
@pytest.mark.parametrize("spacing", [(1.0, 20.0), (8.0, 1.0)])
def test_outlines_that_were_set_back_are_mirrored_too(spacing, symmetric):
    """So that the certificate compares with them, on both sides, where pixels are not square."""
    labels = np.random.default_rng(4).integers(0, 3, (4, 5))
    labels = np.hstack([labels, labels[:, ::-1]]) if "x" in symmetric else labels
    labels = np.vstack([labels, labels[-2::-1]]) if "y" in symmetric else labels
    mesh = mesh_image(labels, labels=True, spacing=spacing, symmetric=symmetric)
    assert mesh.report.kept, mesh.report.warnings
