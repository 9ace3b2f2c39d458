from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.rgb_to_labels import distinct, label_map

RNG = np.random.default_rng(5)
INTEGERS = [np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.uint64, np.int64]


@pytest.mark.parametrize("dtype", INTEGERS)
@pytest.mark.parametrize("background", [0, 3, None, -7, 1000])
def test_integers_are_their_own_labels(dtype, background):
    values = RNG.integers(0, 6, (9, 9)).astype(dtype)
    for labels in (True, None, range(6) if background is None else [v for v in range(6) if v != background]):
        found = label_map(values, labels=labels, background=background)
        assert np.shares_memory(found.values, values) or background == 3 or (background == 0 and labels not in (True, None))
        assert (found.values == values).all()
        assert found.background == background


def test_a_mask_is_0_and_1():
    values = RNG.random((9, 9)) < 0.5
    found = label_map(values)
    assert found.values.dtype == np.uint8
    assert (found.values == values).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_whole_floats_are_labels(dtype):
    values = RNG.integers(-9, 9, (9, 9)).astype(dtype)
    found = label_map(values).values
    assert np.issubdtype(found.dtype, np.integer)
    assert (found == values).all()
    assert label_map(np.array([[2.0**40, -(2.0**40)]])).values.tolist() == [[2**40, -(2**40)]]


def test_the_dtype_of_labels_fits_int64():
    assert label_map(np.array([[0, 2**63 - 1]], np.uint64)).values.max() == 2**63 - 1
    with pytest.raises(ImageError, match="labels: expected numbers of at most 63 bits, found 9223372036854775808"):
        label_map(np.array([[0, 2**63]], np.uint64))


@pytest.mark.parametrize(
    ("values", "message"),
    [([[0, 0.5]], "expected whole numbers, found 0.5; give a threshold"), ([[0, 1e300]], "at most 53 bits, found floats from 0 to 1e")],
)
def test_other_floats_are_refused(values, message):
    with pytest.raises(ImageError, match=message):
        label_map(values)


def test_colours_are_written_as_in_web_pages():
    values = np.array([[[255, 0, 0], [0x12, 0x34, 0x56], [0, 0, 0]]], np.uint8)
    assert label_map(values).values.tolist() == [[0xFF0000, 0x123456, 0]]
    assert label_map(values, labels=[0xFF0000]).values.tolist() == [[0xFF0000, 0, 0]]
    assert label_map(values.astype(np.int64)).values.tolist() == [[0xFF0000, 0x123456, 0]]
    wide = np.array([[[0xABCD, 0x1234, 1], [0, 0, 0]]], np.uint16)
    assert label_map(wide).values.tolist() == [[0xABCD12340001, 0]]


@settings(max_examples=60, deadline=None)
@given(arrays.arrays(np.uint8, (3, 4, 3), elements=st.integers(0, 255)))
def test_different_colours_have_different_labels(values):
    labels = label_map(values).values
    equal_colours = (values[:, :, None, None] == values).all(axis=-1)
    assert (equal_colours == (labels[:, :, None, None] == labels)).all()


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint16, np.int64, np.float32])
def test_a_segmentation_saved_as_colours_keeps_its_numbers(dtype):
    values = RNG.integers(0, 2, (9, 9)).astype(dtype)
    assert (label_map(np.dstack([values] * 3)).values == values).all()


@pytest.mark.parametrize("values", [np.array([[[0, 0.5, 1]]]), np.array([[[0, 1, 256]]]), np.array([[[0, 1, -1]]])])
def test_other_colours_are_refused(values):
    with pytest.raises(ImageError, match=r"labels: expected colours of uint8 or uint16, found .*; scale them to 0..255"):
        label_map(values)


def test_missing_pixels_are_background():
    values = RNG.integers(1, 256, (9, 9, 3), np.uint8)
    missing = np.zeros((9, 9), bool)
    missing[2:5] = True
    found = label_map(values, missing=missing)
    assert (found.values[2:5] == 0).all()
    assert (found.values[5:] == label_map(values[5:]).values).all()
    assert found.background == 0


def test_transparent_is_never_equal_to_a_colour():
    values = np.repeat(np.arange(6), 6).reshape(6, 6)
    missing = values == 3
    for background, transparent, marker in ((0, True, 3), (None, False, 3), (0, False, 0), (4, True, 4)):
        found = label_map(values, missing=missing, background=background, transparent=transparent)
        assert found.background == marker
        assert (found.values == np.where(missing, marker, values)).all()
    assert label_map(values, labels=[0, 5], missing=missing, transparent=True).background == 1
    with pytest.raises(ImageError, match="found 3, which is not one"):
        label_map(values, labels=[3], missing=missing)


@pytest.mark.parametrize("dtype", INTEGERS)
def test_labels_not_picked_become_background(dtype):
    values = RNG.integers(0, 9, (20, 20)).astype(dtype)
    before = values.copy()
    for background in (0, 7, 100):
        found = label_map(values, labels=[2, 5], background=background)
        assert (found.values == np.where((values == 2) | (values == 5), values, background)).all()
        assert found.background == background
    assert (values == before).all()


@pytest.mark.parametrize("background", [-1, 300, 2**40])
def test_a_background_beyond_the_type_widens_it(background):
    values = RNG.integers(0, 9, (20, 20), np.uint8)
    found = label_map(values, labels=[2, 5], background=background)
    assert set(np.unique(found.values).tolist()) == {background, 2, 5}


@pytest.mark.parametrize(("labels", "marker"), [([1, 2], 0), ([0, 2], 1), ([0, 1, 2], 3), ([5, 0], 1)])
def test_without_background_what_is_left_out_gets_an_unused_value(labels, marker):
    values = RNG.integers(0, 9, (20, 20), np.uint8)
    found = label_map(values, labels=labels, background=None)
    assert found.background == marker
    chosen = np.isin(values, labels)
    assert (found.values[chosen] == values[chosen]).all()
    assert (found.values[~chosen] == marker).all()


def test_without_background_and_all_picked_nothing_is_left_out():
    values = RNG.integers(0, 3, (20, 20), np.uint8)
    found = label_map(values, labels=[0, 1, 2], background=None)
    assert found.values is values
    assert found.background is None


def test_every_value_of_a_type_may_be_picked():
    values = np.arange(256, dtype=np.uint8).reshape(16, 16)
    found = label_map(values, labels=range(255), background=None)
    assert found.background == 255
    assert label_map(values, labels=range(256), background=None).values is values


def test_labels_may_be_any_sequence_of_integers():
    values = RNG.integers(0, 9, (20, 20))
    for labels in ([3, 1, 3], (1, 3), {1, 3}, np.array([1, 3]), np.array([1, 3], np.uint8), range(1, 4, 2), iter([3, 1])):
        assert set(np.unique(label_map(values, labels=labels).values).tolist()) == {0, 1, 3}


def test_a_label_that_does_not_occur():
    with pytest.raises(ImageError, match=r"labels: expected values of the image, found 9, which is not one; there are 0, 1, 4$"):
        label_map(np.array([[0, 1, 4]]), labels=[1, 9])
    with pytest.raises(ImageError, match=r"there are 0, 1, .*, 19 and 80 more$"):
        label_map(np.arange(100).reshape(10, 10), labels=[-1])
    with pytest.raises(ImageError, match="found 1000, which is not one"):
        label_map(np.zeros((2, 2), np.uint8), labels=[1000])


@pytest.mark.parametrize("labels", [[], False, 3, "all", [1.5], [True], ["1"], [None]])
def test_bad_labels(labels):
    with pytest.raises(ParameterError, match="labels: expected True or a list of integers, found"):
        label_map(np.eye(3, dtype=int), labels=labels)


def test_a_label_that_is_the_background():
    with pytest.raises(ParameterError, match="labels: expected values other than the background, found 0; give background=None"):
        label_map(np.eye(3, dtype=int), labels=[0, 1])


@pytest.mark.parametrize("background", [0.5, "black", True, [0]])
def test_bad_background(background):
    with pytest.raises(ParameterError, match="background: expected an integer or None, found"):
        label_map(np.eye(3, dtype=int), background=background)


@settings(max_examples=100, deadline=None)
@given(arrays.arrays(np.int16, st.tuples(st.integers(1, 6), st.integers(1, 6)), elements=st.integers(-3, 3)))
def test_distinct(values):
    assert (distinct(values) == np.unique(values)).all()
    assert (distinct(values.T) == np.unique(values)).all()
