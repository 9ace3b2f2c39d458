"""Pixels that are not there: no data of files, NaN and masked arrays are not meshed, and place no edge."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from img2tri import mesh_image
from img2tri.errors import ImageError
from img2tri.raster.metadata.nodata import equal_to
from img2tri.raster.reading import read

HALVES = np.zeros((60, 80), np.uint8)
HALVES[10:50, 10:40], HALVES[10:50, 40:70] = 1, 2


def test_nan_is_not_meshed():
    values = np.where(HALVES == 0, np.nan, HALVES).astype(np.float32)
    mesh = mesh_image(values, labels=True)
    assert {label: area["mesh"] for label, area in mesh.report.areas.items()} == pytest.approx({1: 1200, 2: 1200}, rel=1e-4)
    assert mesh.report.notes[0].startswith("2,400 pixels are not there (no data, NaN or masked)")
    assert mesh.report.removed["missing"] == 2400
    with pytest.raises(ImageError, match="expected pixels that are there"):
        mesh_image(np.full((5, 5), np.nan))


@pytest.mark.parametrize("background", [0, None, 7])
def test_masked_arrays(background):
    masked = np.ma.masked_array(np.where(HALVES == 0, 99, HALVES), HALVES == 0)
    mesh = mesh_image(masked, labels=True, background=background)
    assert set(mesh.regions) == {1, 2}
    same = mesh_image(HALVES, labels=True)
    assert (mesh.vertices == same.vertices).all()


def test_a_masked_array_of_colours():
    colours = np.ma.masked_array(np.stack([HALVES * 100] * 3, axis=2), False)
    colours[:, :40] = np.ma.masked
    mesh = mesh_image(colours, labels=True, background=None)
    assert set(mesh.regions) == {0, 200}
    assert mesh.vertices[:, 0].min() == pytest.approx(40, abs=0.2)


@pytest.mark.parametrize(
    ("dtype", "nodata", "found"),
    [(np.uint8, "2", 1200), (np.float32, "nan", 1200), (np.int16, "-32768", 1200), (np.float64, "-3.4e+38", 1200), (np.uint8, "-9999", 0),
     (np.uint8, "1.5", 0), (np.uint8, "none", 0), (np.float32, "-3.4028234663852886e+38", 1200)],
)  # fmt: skip
def test_the_tag_of_gdal(dtype, nodata, found, tmp_path):
    hole = {"nan": np.nan, "none": 2, "-9999": 2, "1.5": 2}.get(nodata) or float(nodata)
    values = np.where(HALVES == 2, hole, HALVES).astype(dtype)
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(42113, "s", 0, nodata, True)])
    picture = read(tmp_path / "a.tif")
    assert (0 if picture.missing is None else picture.missing.sum()) == found
    if found:
        assert (picture.missing == (HALVES == 2)).all()
        mesh = mesh_image(tmp_path / "a.tif")
        assert mesh.report.areas[1]["mesh"] == pytest.approx(1200, rel=1e-4)


def test_land_water_and_no_data():
    """1 is land, 0 water, 255 no data: land is meshed, and not what lies at the edge of the survey."""
    values = np.where(HALVES == 2, 255, HALVES)
    missing = equal_to(values, 255)
    mesh = mesh_image(np.ma.masked_array(values, missing))
    assert mesh.report.areas[1]["mesh"] == pytest.approx(1200, rel=1e-4)
    assert mesh_image(values, threshold="otsu").report.areas[1]["mesh"] == pytest.approx(1200, rel=1e-4)
    assert mesh_image(values, threshold="otsu").vertices[:, 0].min() == pytest.approx(40, abs=0.2)  # what was meshed before


@pytest.mark.parametrize("threshold", [None, 100, "otsu"])
def test_edges_beside_missing_pixels_are_not_placed_by_values(threshold):
    y, x = np.mgrid[:60, :80] + 0.5
    soft = np.clip(200 - 40 * (np.hypot(x - 40, y - 30) - 20), 0, 200)
    for hidden in (0.0, 1e6, -50.0):
        values = np.ma.masked_array(np.where(x > 40, hidden, soft), x > 40)
        mesh = mesh_image(values, threshold=threshold, edge_length=4)
        assert mesh.vertices[:, 0].max() == pytest.approx(40, abs=0.2)
        assert mesh.report.kept
        half = mesh_image(soft[:, :40], threshold=threshold, edge_length=4)
        assert mesh.report.areas[1]["mesh"] == pytest.approx(half.report.areas[1]["mesh"], rel=2e-3)


def test_missing_pixels_choose_no_level():
    y, x = np.mgrid[:60, :80]
    values = np.where(np.hypot(x - 20, y - 30) < 15, 120.0, 100.0) + np.random.default_rng(0).normal(0, 2, x.shape)
    values[:, 50:] = np.nan
    assert 105 < mesh_image(values).report.settings["threshold"] < 115
    assert mesh_image(np.nan_to_num(values)).report.settings["threshold"] < 100


def test_dicom_padding():
    pydicom = pytest.importorskip("pydicom")
    data = pydicom.Dataset()
    data.PixelPaddingValue = -2000
    from img2tri.raster.files.dicom import _padding

    stored = np.array([[-2000, -1000], [0, 5]], np.int16)
    assert (_padding(stored, data) == [[True, False], [False, False]]).all()
    data.PixelPaddingRangeLimit = -900
    assert (_padding(stored, data) == [[True, True], [False, False]]).all()
    assert _padding(stored, pydicom.Dataset()) is None


def test_a_part_keeps_what_is_missing_in_it():
    values = np.where(HALVES == 0, np.nan, HALVES)
    part = mesh_image(values, labels=True, crop=(5, 5, 45, 40))
    assert part.report.areas[1]["mesh"] == pytest.approx(30 * 30, rel=1e-3)
    assert part.report.removed["missing"] == np.isnan(values[20:55, 5:45]).sum()
