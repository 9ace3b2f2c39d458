"""Objects of other libraries, arrays with axes of one: taken for what they are."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError
from img2tri.raster.in_memory.array_checks import pixels
from img2tri.raster.in_memory.simpleitk_image import from_simpleitk, is_simpleitk
from img2tri.raster.reading import read

VALUES = np.zeros((20, 30), np.uint8)
VALUES[3:10, 4:20] = 255


@pytest.mark.parametrize("shape", [(20, 30, 1), (1, 20, 30), (1, 20, 30, 1), (1, 1, 20, 30), (20, 30, 1, 1)])
def test_axes_of_one_are_dropped(shape):
    assert (pixels(VALUES.reshape(shape)) == VALUES).all()
    assert (mesh_image(VALUES.reshape(shape)).vertices == mesh_image(VALUES).vertices).all()


def test_colours_in_a_batch_of_one():
    colours = np.stack([VALUES] * 3, axis=2)
    assert pixels(colours[None]).shape == (20, 30, 3)
    assert pixels(colours[..., None]).shape == (20, 30, 3)


def test_advice_names_the_axis_that_is_meant():
    for shape, advice in (((20, 30, 2), r"image\[\.\.\., 0\]"), ((5, 20, 30), r"image\[0\]"), ((3, 20, 30), "moveaxis")):
        with pytest.raises(ImageError, match=advice):
            read(np.zeros(shape))


def test_pillow_images():
    assert (read(Image.fromarray(VALUES)).values == VALUES).all()
    palette = Image.fromarray(VALUES // 255).convert("P")
    assert read(palette).notes["palette"].shape == (256, 3)
    assert (read(Image.fromarray(VALUES > 0)).values == (VALUES > 0)).all()


def test_arrays_of_other_libraries():
    array = pytest.importorskip("dask.array")
    assert (read(array.from_array(VALUES)).values == VALUES).all()

    class Tensor:
        def __array__(self, dtype=None, copy=None):
            return VALUES

    assert (read(Tensor()).values == VALUES).all()


def data_array(x, y, dims=("y", "x"), values=VALUES, **attrs):
    xarray = pytest.importorskip("xarray")
    coords = {"y": y, "x": x}
    return xarray.DataArray(values if dims == ("y", "x") else values.T, coords=coords, dims=dims, attrs=attrs)


FALLING, RISING, X = np.arange(20)[::-1] * 2.0 + 101, np.arange(20) * 2.0 + 101, np.arange(30) * 0.5 + 7.25


def test_a_data_array_lies_where_its_coordinates_say():
    """White pixels are in rows 3 to 9: high up where y falls, low where it rises. Nothing is upside down."""
    for y, low, high in ((FALLING, 120, 134), (RISING, 106, 120)):
        mesh = mesh_image(data_array(X, y))
        assert mesh.vertices.min(axis=0) == pytest.approx((9, low))
        assert mesh.vertices.max(axis=0) == pytest.approx((17, high))
        assert mesh.frame.bounds == (7, 100, 22, 140)


def test_a_data_array_with_x_first_or_falling():
    for image in (data_array(X, RISING, ("x", "y")), data_array(X[::-1], RISING, values=VALUES[:, ::-1])):
        mesh = mesh_image(image)
        assert mesh.vertices.min(axis=0) == pytest.approx((9, 106))
        assert mesh.vertices.max(axis=0) == pytest.approx((17, 120))


def test_a_data_array_keeps_its_no_data_and_units():
    image = data_array(X, RISING, _FillValue=255)
    image.coords["x"].attrs["units"] = "m"
    picture = read(image)
    assert (picture.missing == (VALUES == 255)).all()
    assert picture.notes["units"] == "m"


def test_a_data_array_that_is_not_understood_is_refused():
    with pytest.raises(ImageError, match="evenly spaced"):
        read(data_array(X**2, RISING))
    with pytest.raises(ParameterError, match="has its own place"):
        read(data_array(X, RISING), spacing=2)
    xarray = pytest.importorskip("xarray")
    with pytest.raises(ImageError, match="with isel"):
        read(xarray.DataArray(np.zeros((4, 20, 30)), dims=("time", "y", "x")))
    plain = read(xarray.DataArray(VALUES, dims=("y", "x")), spacing=0.5)
    assert plain.frame.spacing == (0.5, 0.5)
    assert plain.frame.upward
    bands = xarray.DataArray(np.stack([VALUES] * 3), dims=("band", "y", "x"))
    assert read(bands).values.shape == (20, 30, 3)


class FakeItk:
    """What SimpleITK's image has, where that is not installed."""

    def __init__(self, values, spacing, origin, direction):
        self.values, self.spacing, self.origin, self.direction = values, spacing, origin, direction

    GetSize = lambda self: self.values.shape[::-1]  # noqa: E731
    GetSpacing = lambda self: self.spacing  # noqa: E731
    GetOrigin = lambda self: self.origin  # noqa: E731
    GetDirection = lambda self: self.direction  # noqa: E731


FakeItk.__module__ = "SimpleITK.SimpleITK"


@pytest.fixture
def itk(monkeypatch):
    import sys
    import types

    library = types.ModuleType("SimpleITK")
    library.GetArrayViewFromImage = lambda image: image.values
    monkeypatch.setitem(sys.modules, "SimpleITK", library)


@pytest.mark.usefixtures("itk")
def test_simpleitk():
    image = FakeItk(VALUES, (0.5, 2.0), (10.0, 100.0), (1, 0, 0, 1))
    assert is_simpleitk(image)
    mesh = mesh_image(image)
    assert mesh.frame.bounds == (9.75, 99.0, 24.75, 139.0)
    assert mesh.vertices.min(axis=0) == pytest.approx((9.75 + 2, 99 + 6))  # row 3 is the third from the bottom: y rises with the row
    volume = FakeItk(np.stack([VALUES * 0, VALUES]), (0.5, 2.0, 3.0), (10.0, 100.0, 7.0), np.eye(3).ravel())
    picture = read(volume, page=1)
    assert (picture.values == VALUES).all()
    assert picture.frame.z == 10
    with pytest.raises(ParameterError, match="page: expected 0 to 1"):
        read(volume, page=2)
    with pytest.raises(ImageError, match="direction turns it"):
        from_simpleitk(FakeItk(VALUES, (1, 1), (0, 0), (0, 1, 1, 0)))
    with pytest.raises(ParameterError, match="has its own place"):
        read(image, spacing=1)
