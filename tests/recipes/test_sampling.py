"""Images carried to meshes: sums over the mesh are sums over the pixels, a plane is met exactly, labels stay labels."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
import specimens
from PIL import Image

import img2tri
from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError

FULL = np.ones((23, 31), bool)
DISC = specimens.disc(40, 15).astype(bool)
NOISE = np.random.default_rng(3).normal(100, 20, DISC.shape)


def areas(mesh):
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def clipped_means(mesh, values):
    """The same by cutting every triangle with every pixel."""
    f = mesh.frame
    rows, columns = np.indices(values.shape)
    lower, upper = f.xy(rows + 1, columns), f.xy(rows, columns + 1)
    low, high = np.minimum(lower, upper).reshape(-1, 2), np.maximum(lower, upper).reshape(-1, 2)
    pixels, tree_values = shapely.box(*low.T, *high.T), values.ravel()
    triangles = shapely.polygons(mesh.vertices[mesh.triangles])
    one, other = shapely.STRtree(pixels).query(triangles)
    share = shapely.area(shapely.intersection(triangles[one], pixels[other]))
    return np.bincount(one, share * tree_values[other], len(triangles)) / np.bincount(one, share, len(triangles))


@pytest.mark.parametrize(
    "options", [{}, {"origin": "upper", "spacing": (0.5, 0.7)}, {"spacing": (2, 1), "origin": (1e3, -50)}, {"edge_length": 1}]
)
def test_the_mean_over_a_triangle_is_that_of_the_pixels_in_it(options):
    mesh = mesh_image(DISC, **options)
    assert mesh.sample(NOISE) == pytest.approx(clipped_means(mesh, NOISE), rel=1e-9)


def test_sums_over_the_mesh_are_sums_over_the_pixels():
    values = np.random.default_rng(1).normal(size=FULL.shape)
    mesh = mesh_image(FULL, spacing=(0.5, 0.8), edge_length=2)
    assert (mesh.sample(values) * areas(mesh)).sum() == pytest.approx(values.sum() * 0.4, rel=1e-10)
    assert (mesh.sample(values + 1e9) - 1e9) == pytest.approx(mesh.sample(values), abs=1e-5)


def test_a_plane_is_met_exactly():
    rows, columns = np.indices(FULL.shape) + 0.5
    mesh = mesh_image(FULL, edge_length=4)
    x, y = mesh.frame.xy(rows, columns).transpose(2, 0, 1)
    inside = ((mesh.vertices > 0.5) & (mesh.vertices < np.array(FULL.shape[::-1]) - 0.5)).all(axis=1)
    at = mesh.sample(2 * x - 3 * y + 1, on="vertices")
    assert at[inside] == pytest.approx((mesh.vertices @ [2, -3] + 1)[inside], abs=1e-9)


def test_constants_and_channels():
    mesh = mesh_image(DISC)
    assert mesh.sample(np.full(DISC.shape, 7, np.uint8)) == pytest.approx(7)
    both = mesh.sample(np.stack([NOISE, -NOISE], axis=2))
    assert both.shape == (len(mesh.triangles), 2)
    assert both[:, 0] == pytest.approx(mesh.sample(NOISE))
    assert mesh.sample(np.stack([NOISE] * 3, axis=2), on="vertices").shape == (len(mesh.vertices), 3)


def test_labels_stay_labels():
    labels = specimens.polycrystal(40, 3)
    mesh = mesh_image(labels, labels=True, background=None, edge_length=3)
    found = mesh.sample(labels, method="nearest")
    assert found.dtype == labels.dtype
    assert (found == mesh.regions).mean() > 0.97
    assert mesh.sample(labels > 2).dtype == bool
    assert set(mesh.sample(labels, on="vertices", method="nearest").tolist()) <= set(np.unique(labels).tolist())


def test_pixels_without_a_value_are_left_out():
    mesh = mesh_image(DISC, edge_length=3)
    holes = NOISE.copy()
    holes[:20] = np.nan
    found, masked = mesh.sample(holes), mesh.sample(np.ma.masked_invalid(holes))
    assert np.array_equal(found, masked, equal_nan=True)
    assert np.isnan(found).any()
    whole = mesh.vertices[mesh.triangles][..., 1].max(axis=1) < 19.9
    assert found[whole] == pytest.approx(mesh.sample(NOISE)[whole])
    known = found[~np.isnan(found)]
    assert known.min() >= np.nanmin(holes) - 1e-9
    assert known.max() <= np.nanmax(holes) + 1e-9
    at = mesh.sample(holes, on="vertices")
    assert np.isnan(at).any()
    assert np.isfinite(at).any()


def test_of_a_part_the_part_or_the_whole(tmp_path):
    part = mesh_image(DISC, crop=(4, 6, 30, 32))
    assert np.array_equal(part.sample(NOISE), part.sample(NOISE[8:34, 4:30]))
    Image.fromarray(NOISE.astype(np.uint8)).save(tmp_path / "gray.png")
    assert np.array_equal(part.sample(tmp_path / "gray.png"), part.sample(NOISE.astype(np.uint8)))


def test_what_cannot_be_sampled():
    mesh = mesh_image(DISC)
    with pytest.raises(ImageError, match=r"image: expected numbers on the grid of the mesh, \(40, 40\), found float64 of shape \(3, 3\)"):
        mesh.sample(np.zeros((3, 3)))
    with pytest.raises(ParameterError, match="on: expected one of 'triangles', 'vertices', found 'faces'"):
        mesh.sample(NOISE, on="faces")
    with pytest.raises(ParameterError, match="method: expected one of 'mean', 'nearest', found 'median'"):
        mesh.sample(NOISE, method="median")
    assert img2tri.TriangleMesh.sample.__doc__
