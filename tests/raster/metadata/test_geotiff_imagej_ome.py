"""How large pixels are and where they lie, in the dialects of TIFF."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from img2tri import mesh_image
from img2tri.errors import ParameterError
from img2tri.raster.metadata.geotiff_imagej_ome import place_of_tiff
from img2tri.raster.reading import read

GRAY = np.zeros((60, 80), np.uint8)
GRAY[10:50, 10:40] = 255
SCALE, TIE, KEYS = (33550, "d", 3, (30.0, 20.0, 0.0), True), (33922, "d", 6, (0.0, 0.0, 0.0, 500000.0, 4649776.0, 0.0), True), 34735


def geo(path, *, keys=(1, 1, 0, 1, 1024, 0, 1, 1), scale=SCALE, tie=TIE, values=GRAY):
    tags = [tag for tag in (scale, tie) if tag] + [(KEYS, "H", len(keys), keys, True)]
    tifffile.imwrite(path, values, extratags=tags)
    return path


@pytest.mark.parametrize("dtype", [np.uint8, np.int64])  # read by Pillow, and by tifffile
@pytest.mark.parametrize("unit", ["um", "micron", "µm", "\\u00B5m", "mm", "nm"])
def test_imagej(dtype, unit, tmp_path):
    path = tmp_path / "a.tif"
    description = f"ImageJ=1.54f\nunit={unit}\n".encode()
    tifffile.imwrite(path, GRAY.astype(dtype), description=description, resolution=(1 / 0.103, 1 / 0.2), metadata=None)
    picture = read(path, spacing="file")
    scale, name = {"mm": (1, "mm"), "nm": (1e-3, "um")}.get(unit, (1, "um"))
    assert picture.frame.spacing == pytest.approx((0.103 * scale, 0.2 * scale), rel=1e-6)
    assert picture.notes["units"] == name
    assert read(path).frame.spacing == (1, 1)


@pytest.mark.parametrize("dtype", [np.uint8, np.float64])
@pytest.mark.parametrize(
    ("unit", "expected"), [("µm", (0.103, "um")), ("mm", (0.103, "mm")), ("nm", (0.103e-3, "um")), (None, (0.103, "um"))]
)
def test_ome(dtype, unit, expected, tmp_path):
    path = tmp_path / "a.ome.tif"
    size = {"PhysicalSizeX": 0.103, "PhysicalSizeY": 0.103} | ({"PhysicalSizeXUnit": unit, "PhysicalSizeYUnit": unit} if unit else {})
    tifffile.imwrite(path, GRAY.astype(dtype), metadata={"axes": "YX", **size})
    picture = read(path, spacing="file")
    assert picture.frame.spacing == pytest.approx((expected[0], expected[0]))
    assert mesh_image(path, spacing="file").report.settings["units"] == expected[1]
    assert "pixels are" in mesh_image(path, spacing="file").report.notes[-1]


def test_geotiff_lies_at_its_place(tmp_path):
    path = geo(tmp_path / "a.tif")
    mesh = mesh_image(path, spacing="file")
    assert mesh.frame.spacing == (30, 20)
    assert mesh.frame.bounds == (500000.0, 4649776.0 - 60 * 20, 500000.0 + 80 * 30, 4649776.0)
    assert mesh.report.settings["units"] == "m"
    left, bottom = mesh.vertices.min(axis=0)
    assert (left, bottom) == pytest.approx((500000 + 10 * 30, 4649776 - 50 * 20))
    assert mesh_image(path, spacing="file", origin=(0, 0)).frame.corner == (0, 0)
    assert mesh_image(path, spacing="file", origin="upper").frame.corner == (0, 0)
    assert mesh_image(path).frame.bounds == (0, 0, 80, 60)


def test_geotiff_in_degrees_has_no_unit_of_length(tmp_path):
    path = geo(tmp_path / "a.tif", keys=(1, 1, 0, 1, 1024, 0, 1, 2))
    mesh = mesh_image(path, spacing="file")
    assert mesh.report.settings["units"] is None
    assert "in a unit it does not name" in mesh.report.notes[-1]


def test_geotiff_by_the_centre_of_its_first_pixel(tmp_path):
    path = geo(tmp_path / "a.tif", keys=(1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 2))
    assert read(path, spacing="file").frame.corner == (500000 - 15, 4649776 - 60 * 20 + 10)


def test_geotiff_by_a_matrix():
    matrix = (30.0, 0.0, 0.0, 5.0, 0.0, -30.0, 0.0, 900.0, 0, 0, 0, 0, 0, 0, 0, 1)
    assert place_of_tiff({34264: matrix}, 10).corner == (5, 600)
    turned = (21.0, 21.0, 0.0, 5.0, 21.0, -21.0, 0.0, 900.0, 0, 0, 0, 0, 0, 0, 0, 1)
    assert place_of_tiff({34264: turned}, 10).size is None


def test_a_turned_geotiff_is_refused_with_its_spacing(tmp_path):
    matrix = (34264, "d", 16, (21.0, 21.0, 0.0, 5.0, 21.0, -21.0, 0.0, 900.0, *[0.0] * 7, 1.0), True)
    path = geo(tmp_path / "a.tif", scale=None, tie=matrix)
    with pytest.raises(ParameterError, match="found none"):
        read(path, spacing="file")
    assert read(path).frame.spacing == (1, 1)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint16, np.int32])
def test_white_as_the_least_value(dtype, tmp_path):
    """Labels are as stored at every depth, gray values turned round."""
    values = np.zeros((60, 80), dtype)
    values[10:50, 10:40], values[10:50, 40:70] = (1, 0) if dtype is bool else (3, 7)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, values, photometric="miniswhite", metadata=None)
    picture = read(path)
    assert (picture.values == values).all()
    assert picture.notes["min_is_white"]
    mesh = mesh_image(path, labels=True)
    assert set(mesh.regions) == set(np.unique(values)) - {0}
    assert "MinIsWhite" in mesh.report.notes[0]
    if dtype != np.int32:
        white = mesh_image(path, threshold="otsu").report.areas[1]["mesh"]
        assert white == pytest.approx((values == values.min()).sum(), rel=0.01) or dtype is not bool
