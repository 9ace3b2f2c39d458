"""A pyvista.ImageData is read so that the picture lies on the object."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista as pv

from img2tri.errors import ImageError, ParameterError
from img2tri.raster.reading import read

RNG = np.random.default_rng(2)


def grid(**options):
    return pv.ImageData(**({"dimensions": (5, 4, 1), "spacing": (0.5, 0.25, 3), "origin": (10, -2, 7)} | options))


def pixel_centres(picture):
    rows, columns = np.indices(picture.values.shape[:2]) + 0.5
    return picture.frame.xy(rows, columns).reshape(-1, 2)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int16, np.int64, np.float32])
def test_points_are_the_centres_of_pixels(dtype):
    image = grid()
    image.point_data["v"] = (RNG.random(20) * 90).astype(dtype)
    picture = read(image)
    assert picture.values.shape == (4, 5)
    assert picture.values.dtype == dtype
    assert (picture.values.reshape(-1) == image.point_data["v"]).all()
    assert np.allclose(pixel_centres(picture), image.points[:, :2])
    assert picture.frame.z == 7
    assert picture.source == "ImageData 'v'"


def test_cells_are_pixels():
    image = grid()
    image.cell_data["v"] = RNG.integers(0, 9, 12)
    picture = read(image)
    assert (picture.values.reshape(-1) == image.cell_data["v"]).all()
    assert np.allclose(pixel_centres(picture), image.cell_centers().points[:, :2])
    assert np.allclose(picture.frame.bounds, [image.bounds[i] for i in (0, 2, 1, 3)])


@pytest.mark.parametrize("channels", [3, 4])
def test_colours(channels):
    image = grid()
    image.point_data["v"] = RNG.integers(0, 256, (20, channels)).astype(np.uint8)
    assert (read(image).values.reshape(20, channels) == image.point_data["v"]).all()


def test_the_active_scalars_are_taken():
    image = grid()
    image.point_data["first"], image.point_data["second"], image.cell_data["cells"] = np.arange(20), np.arange(20) * 2, np.arange(12)
    for name, kind, size in (("second", "point", 20), ("cells", "cell", 12), ("first", "point", 20)):
        image.set_active_scalars(name, preference=kind)
        picture = read(image)
        assert picture.source == f"ImageData {name!r}"
        assert picture.values.size == size


@pytest.mark.parametrize("kind", ["point_data", "cell_data"])
def test_the_first_scalars_are_taken_if_none_are_active(kind):
    image = grid()
    size = 20 if kind == "point_data" else 12
    getattr(image, kind)["a"], getattr(image, kind)["b"] = np.arange(size), np.zeros(size)
    image.set_active_scalars(None)
    assert (read(image).values.reshape(-1) == np.arange(size)).all()


def test_an_extent_need_not_begin_at_0():
    image = grid(dimensions=(9, 9, 1))
    image.point_data["v"] = np.arange(81)
    image.extent = (2, 5, 3, 8, 0, 0)
    image.point_data.clear()
    image.point_data["v"] = np.arange(24)
    assert np.allclose(pixel_centres(read(image)), image.points[:, :2])


def test_what_pyvista_reads_lies_where_it_lies_in_pyvista(tmp_path):
    image = grid()
    image.point_data["v"] = RNG.integers(0, 256, 20).astype(np.uint8)
    image.save(tmp_path / "image.vti")
    again = read(pv.read(tmp_path / "image.vti"))
    assert (again.values == read(image).values).all()
    assert again.frame == read(image).frame


def test_errors():
    with pytest.raises(ImageError, match="expected an ImageData with point or cell data, found none"):
        read(grid())
    volume = grid(dimensions=(4, 4, 4))
    volume.point_data["v"] = np.arange(64)
    with pytest.raises(ImageError, match=r"planar ImageData, of dimensions \(nx, ny, 1\), found \(4, 4, 4\); take a slice"):
        read(volume)
    turned = grid(direction_matrix=[(0, 1, 0), (-1, 0, 0), (0, 0, 1)])
    turned.point_data["v"] = np.arange(20)
    with pytest.raises(ImageError, match="direction_matrix"):
        read(turned)
    flat = grid(spacing=(0, 1, 1))
    flat.point_data["v"] = np.arange(20)
    with pytest.raises(ImageError, match="spacing above 0"):
        read(flat)
    vectors = grid()
    vectors.point_data["v"] = np.zeros((20, 2))
    with pytest.raises(ImageError, match=r"found \(4, 5, 2\)"):
        read(vectors)
    hollow = grid()
    hollow.point_data["v"] = np.full(20, np.nan)
    with pytest.raises(ImageError, match="expected finite values"):
        read(hollow)


@pytest.mark.parametrize("option", [{"spacing": 1}, {"spacing": "file"}, {"origin": "upper"}, {"origin": (0, 0)}, {"page": 1}])
def test_its_place_cannot_be_overridden(option):
    image = grid()
    image.point_data["v"] = np.arange(20)
    with pytest.raises(ParameterError, match=r"spacing, origin, page: a pyvista\.ImageData has its own place"):
        read(image, **option)
