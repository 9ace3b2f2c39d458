from __future__ import annotations

import cv2
import numpy as np
import pytest
from PIL import Image

from img2tri.errors import ImageError
from img2tri.raster.labels.colours_to_gray import alpha_is_the_picture, to_gray

RNG = np.random.default_rng(3)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint16, np.int16, np.int64, np.float32, np.float64])
def test_one_value_per_pixel_is_kept(dtype):
    values = (RNG.random((5, 6)) * 100).astype(dtype)
    assert to_gray(values) is values


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_colours_become_gray_as_in_the_paper(dtype):
    values = RNG.integers(0, np.iinfo(dtype).max, (200, 200, 3), dtype, endpoint=True)
    gray = to_gray(values)
    assert gray.dtype == dtype
    assert (gray == cv2.cvtColor(np.ascontiguousarray(values[..., ::-1]), cv2.COLOR_BGR2GRAY)).all()


@pytest.mark.parametrize("dtype", [np.int16, np.int64, np.uint32, np.float32, np.float64])
def test_other_types_have_the_same_weights(dtype):
    values = RNG.integers(0, 256, (200, 200, 3), np.uint8)
    gray = to_gray(values.astype(dtype))
    assert gray.dtype == dtype
    assert abs(gray - to_gray(values).astype(float)).max() <= (0.51 if np.issubdtype(dtype, np.floating) else 1)
    assert (gray == np.rint(gray)).all() == np.issubdtype(dtype, np.integer)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint16, np.int32, np.float64])
def test_gray_colours_keep_their_value(dtype):
    values = (RNG.random((20, 20)) * 255).astype(dtype)
    assert np.allclose(to_gray(np.dstack([values] * 3)), values, rtol=1e-12)


def test_colours_are_red_green_blue():
    bright = np.eye(3, dtype=np.uint8)[None] * 255
    assert to_gray(bright).tolist() == [[76, 150, 29]]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int64, np.float64])
def test_transparent_is_background(dtype):
    full = 1 if dtype is np.float64 else np.iinfo(np.uint16 if dtype is np.uint16 else np.uint8).max
    values = (RNG.random((30, 30, 4)) * full).astype(dtype)
    values[..., 3] = full
    opaque = to_gray(values)
    assert (opaque == to_gray(values[..., :3])).all()
    values[:5, :, 3], values[5:10, :, 3] = 0, full // 2 if dtype is not np.float64 else 0.5
    gray = to_gray(values)
    assert gray.dtype == dtype
    assert (gray[:5] == 0).all()
    assert np.allclose(gray[5:10], opaque[5:10] * (values[5:10, :, 3] / full), atol=0 if dtype is np.float64 else 0.51)
    assert (gray[10:] == opaque[10:]).all()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("colour", [0, 1, (0.2, 0.9, 0.4)])
def test_a_logo_of_one_colour_is_its_alpha(colour, dtype):
    full = 1 if dtype is np.float32 else np.iinfo(dtype).max
    values = np.zeros((40, 40, 4), dtype)
    values[..., 3] = (RNG.random((40, 40)) * full).astype(dtype)
    values[20:, :, 3], values[0, 0, 3] = 0, full
    values[..., :3] = (np.asarray(colour) * full).astype(dtype)
    values[20:, :, :3] = (RNG.random((20, 40, 3)) * full).astype(dtype)  # whatever is behind full transparency does not count
    assert alpha_is_the_picture(values)
    assert (to_gray(values) == values[..., 3]).all()


def test_a_logo_saved_with_colours_multiplied_by_alpha_is_its_alpha():
    alpha = RNG.integers(0, 256, (40, 40))
    alpha[0, 0] = 255
    multiplied = np.rint(np.array([200, 30, 90]) * alpha[..., None] / 255)
    back = np.rint(multiplied * 255 / np.maximum(alpha, 1)[..., None]).clip(0, 255)
    values = np.dstack([back, alpha]).astype(np.uint8)
    assert len(np.unique(values[alpha > 0][:, :3], axis=0)) > 20  # the colours seem to differ
    assert (to_gray(values) == alpha).all()


def test_two_colours_are_content():
    values = np.zeros((4, 4, 4), np.uint8)
    values[1:3, 1:3, 3] = 255
    values[1, 1, :3] = 255
    assert not alpha_is_the_picture(values)
    assert to_gray(values).tolist() == [[0] * 4, [0, 255, 0, 0], [0] * 4, [0] * 4]


def test_an_alpha_that_does_not_vary_is_not_content():
    values = np.zeros((4, 4, 4), np.uint8)
    for alpha in (0, 100, 255):
        values[..., 3] = alpha
        assert not alpha_is_the_picture(values)
        assert not to_gray(values).any()


@pytest.mark.parametrize("channels", [3, 4])
def test_palette(channels):
    indices = RNG.integers(0, 7, (9, 9), np.uint8)
    palette = RNG.integers(0, 256, (256, channels), np.uint8)
    assert (to_gray(indices, palette=palette) == to_gray(palette[indices])).all()
    assert not (to_gray(indices, palette=palette) == to_gray(indices)).all()


def test_agrees_with_pillow():
    values = RNG.integers(0, 256, (50, 50, 3), np.uint8)
    assert abs(to_gray(values).astype(int) - np.asarray(Image.fromarray(values).convert("L"))).max() <= 1


def test_what_is_not_an_image_is_refused():
    with pytest.raises(ImageError, match="expected shape"):
        to_gray(np.zeros((2, 2, 5)))


def test_the_argument_is_not_changed():
    values = RNG.integers(0, 256, (9, 9, 4), np.uint8)
    before = values.copy()
    to_gray(values)
    assert (values == before).all()
