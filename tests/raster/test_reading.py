"""Where an image lies, and what is refused at the door. Files are read in test_decoding.py."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image

from img2tri.errors import ImageError, ParameterError
from img2tri.raster.reading import read

ROWS = np.arange(6).reshape(2, 3)


def test_an_array_is_kept_as_it_is():
    for dtype in (bool, np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.uint64, np.int64, np.float32, np.float64):
        image = ROWS.astype(dtype)
        picture = read(image)
        assert picture.values is image
        assert (picture.source, picture.notes) == ("array", {})
    colours = np.zeros((4, 5, 4), np.uint8)
    assert read(colours).values is colours
    assert read(colours).frame.shape == (4, 5)


def test_foreign_byte_order_and_odd_floats_are_made_plain():
    assert read(ROWS.astype(">u2")).values.dtype == np.dtype("=u2")
    assert (read(ROWS.astype(">u2")).values == ROWS).all()
    assert read(ROWS.astype(np.float16)).values.dtype == np.float32
    assert read(ROWS.astype(np.longdouble)).values.dtype == np.float64
    assert (read(ROWS.tolist()).values == ROWS).all()


@pytest.mark.parametrize(
    ("origin", "bounds", "first"),
    [
        ("lower", (0, 0, 1.5, 0.5), (0.25, 0.375)),
        ("upper", (0, 0, 1.5, 0.5), (0.25, 0.125)),
        ((10, -2), (10, -2, 11.5, -1.5), (10.25, -1.625)),
        (np.array([10.0, -2.0]), (10, -2, 11.5, -1.5), (10.25, -1.625)),
    ],
)
def test_origin_and_spacing(origin, bounds, first):
    frame = read(ROWS, origin=origin, spacing=(0.5, 0.25)).frame
    assert frame.bounds == bounds
    assert frame.xy(0.5, 0.5).tolist() == list(first)  # the centre of the first pixel
    assert frame.z == 0


def test_spacing_may_be_one_number():
    assert read(ROWS).frame.spacing == (1, 1)
    assert read(ROWS, spacing=3).frame.spacing == (3, 3)
    assert read(ROWS, spacing=np.float32(0.5)).frame.spacing == (0.5, 0.5)


def test_a_path_may_be_a_string_or_a_path(tmp_path):
    Image.fromarray(ROWS.astype(np.uint8)).save(tmp_path / "a.png")
    for path in (tmp_path / "a.png", str(tmp_path / "a.png")):
        picture = read(path)
        assert (picture.values == ROWS).all()
        assert picture.source == str(path)
        assert picture.notes == {"format": "PNG"}


@pytest.mark.parametrize("suffix", ["png", "jpg", "bmp", "tif"])
def test_spacing_of_a_file_is_used_only_when_asked_for(suffix, tmp_path):
    path = tmp_path / f"a.{suffix}"
    Image.fromarray(np.zeros((8, 8), np.uint8)).save(path, dpi=(254, 127))
    assert read(path).frame.spacing == (1, 1)
    if suffix == "bmp":
        with pytest.raises(ParameterError, match="spacing: 'file' expected a resolution with a unit"):
            read(path, spacing="file")
    else:
        picture = read(path, spacing="file")
        assert picture.frame.spacing == pytest.approx((0.1, 0.2), rel=1e-4)
        assert picture.notes["spacing"] == "file"


@pytest.mark.parametrize(("unit", "size"), [("INCH", (0.254, 0.127)), ("CENTIMETER", (0.1, 0.05)), ("NONE", None), (None, None)])
@pytest.mark.parametrize("dtype", [np.uint8, np.float64])
def test_spacing_of_a_tiff(dtype, unit, size, tmp_path):
    resolution = {} if unit is None else {"resolution": (100, 200), "resolutionunit": unit}
    tifffile.imwrite(tmp_path / "a.tif", ROWS.astype(dtype), **resolution)
    if size is None:
        with pytest.raises(ParameterError, match=r"spacing: 'file' expected a resolution with a unit in '.*a.tif', found none"):
            # Without a unit tifffile notes one dot per inch or none at all; neither is a size.
            read(tmp_path / "a.tif", spacing="file")
    else:
        assert read(tmp_path / "a.tif", spacing="file").frame.spacing == pytest.approx(size)


def test_spacing_of_a_jpeg_from_its_exif(tmp_path):
    exif = Image.Exif()
    exif[282], exif[283], exif[296] = 10.0, 20.0, 3
    Image.fromarray(np.zeros((8, 8), np.uint8)).save(tmp_path / "a.jpg", exif=exif)
    assert read(tmp_path / "a.jpg", spacing="file").frame.spacing == pytest.approx((1, 0.5))


def test_spacing_invented_by_pillow_is_not_used(tmp_path):
    exif = Image.Exif()
    exif[271] = "a camera that notes no resolution"
    Image.fromarray(np.zeros((8, 8), np.uint8)).save(tmp_path / "a.jpg", exif=exif)
    with Image.open(tmp_path / "a.jpg") as img:
        assert img.info.get("dpi", (72, 72)) == (72, 72)
    with pytest.raises(ParameterError, match="found none"):
        read(tmp_path / "a.jpg", spacing="file")


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros(5), r"expected shape \(h, w\), or \(h, w, 3 or 4\) with colours, found \(5,\)$"),
        (np.zeros((4, 5, 6, 3)), r"found \(4, 5, 6, 3\); pick one image of a stack"),
        (np.zeros((4, 5, 2)), r"found \(4, 5, 2\)"),
        (np.zeros((0, 5)), r"expected at least one pixel, found shape \(0, 5\)"),
        (np.zeros((5, 0, 3), np.uint8), r"expected at least one pixel, found shape \(5, 0, 3\)"),
        (np.array([[0, np.inf], [-np.inf, 1]], np.float32), "found 2 NaN or infinite"),
        (np.array([[None, 1]]), "found an array of type object"),
        (np.zeros((2, 2), complex), "found an array of type complex128"),
        (np.array([["a", "b"]]), "found an array of type <U1"),
        (np.zeros((2, 2), "M8[s]"), "found an array of type datetime64"),
        ([[1, 2], [3]], "found rows of unequal length"),
        (None, "found NoneType"),
        (b"bytes", "found bytes"),
        (7, r"expected shape \(h, w\), or \(h, w, 3 or 4\) with colours, found \(\)"),
    ],
)
def test_what_is_not_an_image(image, message):
    with pytest.raises(ImageError, match=f"^image: .*{message}"):
        read(image)


@pytest.mark.parametrize("spacing", [0, -1, np.nan, np.inf, "0.5", "pixels", (1, 0), (1,), (1, 2, 3), (1, None), True, [[1, 2]], {}])
def test_bad_spacing(spacing):
    with pytest.raises(ParameterError, match=r"^spacing: expected"):
        read(ROWS, spacing=spacing)


@pytest.mark.parametrize("spacing", [1e-101, 1e101, (1, 1e-200), (1e200, 1)])
def test_spacing_whose_squares_are_no_numbers(spacing):
    with pytest.raises(ParameterError, match=r"^spacing: expected numbers from 1e-100 to 1e100, found .*; choose another unit"):
        read(ROWS, spacing=spacing)
    for size in (1e-100, 1e100):
        assert read(ROWS, spacing=size).frame.spacing == (size, size)


def test_an_array_has_no_spacing_of_a_file():
    with pytest.raises(ParameterError, match="spacing: 'file' expected a resolution with a unit in 'array', found none; give the size"):
        read(ROWS, spacing="file")


@pytest.mark.parametrize("origin", ["left", None, 0, (1,), (1, 2, 3), (0, np.nan), ("a", "b"), "uu"])
def test_bad_origin(origin):
    with pytest.raises(ParameterError, match=r"^origin: expected"):
        read(ROWS, origin=origin)


def test_bad_page():
    for page in (-1, 0.5, "first"):
        with pytest.raises(ParameterError, match=r"^page: expected a whole number of at least 0"):
            read(ROWS, page=page)
    with pytest.raises(ParameterError, match=r"^page: expected 0 for an array"):
        read(ROWS, page=1)


def test_arrays_need_no_heavy_library():
    code = (
        "import sys, numpy as np; from img2tri.raster.reading import read; from img2tri.raster.labels.otsu_threshold import binarize;"
        "binarize(read(np.eye(3)).values); heavy = {'PIL', 'cv2', 'pyvista', 'tifffile'} & set(sys.modules); assert not heavy, heavy"
    )
    root = Path(sys.modules["img2tri"].__path__[0]).parent
    subprocess.run([sys.executable, "-c", code], check=True, cwd=root)
