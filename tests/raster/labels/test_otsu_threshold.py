from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.otsu_threshold import Level, binarize

RNG = np.random.default_rng(4)
TYPES = [np.uint8, np.uint16, np.int8, np.int16, np.uint32, np.int64, np.float32, np.float64]


def between(values, mask):
    """The variance between two classes, from its definition."""
    low, high = values[~mask].astype(float), values[mask].astype(float)
    return low.size * high.size * (high.mean() - low.mean()) ** 2


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("threshold", [-1, 0, 3, 3.5, 50, 99, 1000, np.float64(3)])
def test_strictly_greater_is_foreground(dtype, threshold):
    values = RNG.integers(0, 100, (9, 9)).astype(dtype)
    mask, level = binarize(values, threshold=threshold)
    assert mask.dtype == bool
    assert (mask == (values.astype(float) > threshold)).all()
    assert level == Level(threshold, "given")


def test_the_threshold_of_the_paper_is_that_of_opencv():
    values = RNG.integers(0, 256, (99, 99), np.uint8)
    assert (binarize(values, threshold=240)[0] == (cv2.threshold(values, 240, 255, cv2.THRESH_BINARY)[1] > 0)).all()


def test_numbers_too_large_for_a_float_are_compared_exactly():
    values = np.array([[2**62, 2**62 + 1]])
    assert binarize(values, threshold=2**62)[0].tolist() == [[False, True]]
    assert binarize(values)[0].tolist() == [[False, True]]


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("pair", [(0, 1), (0, 100), (3, 4), (17, 90)])
def test_two_values_are_split_in_the_middle(dtype, pair):
    places = RNG.integers(0, 2, (9, 9))
    places[0, 0], places[0, 1] = 0, 1
    mask, level = binarize(np.asarray(pair)[places].astype(dtype))
    assert (mask == (places == 1)).all()
    assert level == Level(sum(pair) / 2, "middle")


def test_a_mask_is_kept():
    values = RNG.random((9, 9)) < 0.5
    for threshold in (None, "otsu", 240):
        mask, level = binarize(values, threshold=threshold)
        assert (mask == values).all()
        assert level == Level(0.5, "mask")


@pytest.mark.parametrize(("value", "foreground"), [(0, False), (1, True), (255, True), (-3, False)])
def test_one_value(value, foreground):
    mask, level = binarize(np.full((3, 4), value, np.int16))
    assert (mask == foreground).all()
    assert level == Level(0.0, "uniform")


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_otsu_agrees_with_opencv(dtype):
    for seed in range(8):
        rng = np.random.default_rng(seed)
        values = cv2.GaussianBlur(rng.random((120, 90)), (0, 0), 1 + seed)
        values = (values - values.min()) / (values.max() - values.min())
        values = (np.where(rng.random(values.shape) < 0.3, values**3, values) * np.iinfo(dtype).max).astype(dtype)
        mask, level = binarize(values)
        expected, _ = cv2.threshold(values, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
        assert level.how == "otsu"
        # Where no pixel has a value between two levels they are the same level.
        assert (mask == (values > expected)).all()
        assert level.value in values


@settings(max_examples=100, deadline=None)
@given(arrays.arrays(np.uint8, (4, 5), elements=st.integers(0, 255)))
def test_otsu_is_the_greatest_variance_between_classes(values):
    if values.min() == values.max():
        return
    mask, level = binarize(values, threshold="otsu")
    assert (mask == (values > level.value)).all()
    best = max(between(values, values > t) for t in np.unique(values)[:-1])
    assert between(values, mask) >= best * (1 - 1e-9)


@settings(max_examples=100, deadline=None)
@given(arrays.arrays(np.float64, (4, 5), elements=st.floats(-1e308, 1e308)))
def test_otsu_of_any_floats_parts_them(values):
    if values.min() == values.max():
        return
    mask, level = binarize(values, threshold="otsu")
    assert (mask == (values > level.value)).all()
    assert mask.any()
    assert not mask.all()


@pytest.mark.parametrize("dtype", [np.int8, np.int16, np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64])
def test_otsu_does_not_depend_on_type_and_offset(dtype):
    values = RNG.integers(0, 100, (40, 40)).astype(np.uint8) // RNG.integers(1, 9, (40, 40)).astype(np.uint8)
    expected, level = binarize(values, threshold="otsu")
    offset = {np.int8: -90, np.int16: -3000, np.uint64: 2**64 - 200, np.int64: -(2**63)}.get(dtype, 5)
    shifted = (values.astype(object) + offset).astype(dtype)
    mask, shifted_level = binarize(shifted, threshold="otsu")
    assert (mask == expected).all()
    assert shifted_level.value == float(level.value + offset)


@pytest.mark.parametrize("scale", [1e-300, 1e-3, 1e3, 1e300])
def test_otsu_of_floats_scales(scale):
    values = RNG.normal(size=(50, 50)) + 6 * (RNG.random((50, 50)) < 0.4)
    mask, level = binarize(values)
    scaled, scaled_level = binarize(values * scale)
    assert (mask == scaled).all()
    assert scaled_level.value == pytest.approx(level.value * scale, rel=1e-12)
    assert between(values, mask) >= 0.9999 * max(between(values, values > t) for t in np.linspace(-2, 8, 500))


def test_otsu_of_whole_numbers_far_apart():
    values = RNG.choice([0, 10**9, 7 * 10**9], (20, 20))
    mask, level = binarize(values, threshold="otsu")
    assert level.value == 10**9
    assert (mask == (values > 10**9)).all()


def test_otsu_counts_large_images_in_blocks():
    values = np.tile(np.arange(256, dtype=np.uint8), (5000, 1))
    assert values.size > 1 << 20
    assert binarize(values)[1] == binarize(values[:1])[1]


@pytest.mark.parametrize("threshold", [None, "otsu", 40])
def test_invert(threshold):
    values = RNG.integers(0, 100, (9, 9), np.uint8)
    mask, level = binarize(values, threshold=threshold)
    inverted, same = binarize(values, threshold=threshold, invert=True)
    assert (inverted == ~mask).all()
    assert level == same


def test_transposed_views_are_read_alike():
    values = RNG.integers(0, 100, (9, 14), np.uint8)
    assert (binarize(values.T)[0] == binarize(values)[0].T).all()


@pytest.mark.parametrize("dtype", [np.int8, np.int16, np.int32, np.int64, np.uint32, np.uint64])
def test_label_numbers_are_not_split_unasked(dtype):
    with pytest.raises(ImageError, match=rf"found {np.dtype(dtype)} with more than two values; labels=True makes each value a region"):
        binarize(np.arange(6).reshape(2, 3).astype(dtype))


@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.float64])
def test_otsu_of_one_value_is_refused(dtype):
    with pytest.raises(ImageError, match="threshold: 'otsu' expected at least two values in the image, found only 7"):
        binarize(np.full((3, 3), 7, dtype), threshold="otsu")


@pytest.mark.parametrize("threshold", [np.nan, np.inf, -np.inf, True, [1], (1, 2)])
def test_bad_numbers(threshold):
    with pytest.raises(ParameterError, match="threshold: expected a number, found"):
        binarize(np.eye(3), threshold=threshold)


def test_unknown_word():
    with pytest.raises(ParameterError, match="threshold: expected a number, 'otsu' or None, found 'li'"):
        binarize(np.eye(3), threshold="li")


def test_colours_are_refused():
    with pytest.raises(ImageError, match=r"expected shape \(h, w\), found"):
        binarize(np.zeros((3, 3, 3)))


def test_the_argument_is_not_changed():
    values = RNG.random((9, 9))
    before = values.copy()
    binarize(values)
    assert (values == before).all()
