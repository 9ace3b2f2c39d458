"""A part of a picture lies where it lay in the whole."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from img2tri.errors import ParameterError
from img2tri.raster.labels.cropping import crop
from img2tri.raster.reading import read
from img2tri.types import Frame, Picture

ROWS = np.arange(20 * 30).reshape(20, 30)
FRAMES = [
    Frame((20, 30)),
    Frame((20, 30), upward=False),
    Frame((20, 30), (0.1, 0.3), (-7.3, 100.1)),
    Frame((20, 30), (0.7, 0.2), (5, -3), upward=False, z=4.5),
]
SIDES = st.tuples(st.floats(0, 1), st.floats(0, 1)).map(sorted).filter(lambda pair: pair[1] - pair[0] > 1e-3)


def sheet(frame):
    return Picture(ROWS, frame, "a file", {"format": "PNG"})


def values_at(picture, points):
    row, column = picture.frame.row_column(np.asarray(points, float))
    return picture.values[np.floor(row).astype(int), np.floor(column).astype(int)]


@pytest.mark.parametrize("frame", FRAMES)
@given(across=SIDES, up=SIDES)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_each_place_keeps_its_pixel_and_none_is_lost(frame, across, up):
    corner, size = np.array(frame.bounds[:2]), np.array(frame.spacing)
    low, high = (corner + np.array(ends) * size * [30, 20] for ends in zip(across, up, strict=True))
    part = crop(sheet(frame), (*low, *high))
    assert part.values.shape == part.frame.shape
    assert (part.frame.spacing, part.frame.upward, part.frame.z) == (frame.spacing, frame.upward, frame.z)
    # The part covers the box, and less than a pixel more on each side.
    for more in (low - part.frame.bounds[:2], part.frame.bounds[2:] - high):
        assert (-2e-6 * size <= more).all()
        assert (more < (1 + 1e-9) * size).all()
    # Centres of pixels have the values they had.
    h, w = part.frame.shape
    r, c = np.mgrid[:h, :w] + 0.5
    centres = part.frame.xy(r, c)
    assert (values_at(sheet(frame), centres) == part.values).all()


@pytest.mark.parametrize("frame", FRAMES)
def test_sides_of_pixels_are_met_whatever_the_rounding(frame):
    for first, end in ((0, 30), (3, 7), (29, 30), (1, 29)):
        for low, high in ((0, 20), (6, 9), (19, 20)):
            x, y = frame.corner
            dx, dy = frame.spacing
            part = crop(sheet(frame), (x + first * dx, y + low * dy, x + end * dx, y + high * dy))
            assert part.frame.shape == (high - low, end - first)
            rows = slice(20 - high, 20 - low) if frame.upward else slice(low, high)
            assert (part.values == ROWS[rows, first:end]).all()
            assert part.notes["crop"] == {"rows": (rows.start, rows.stop), "columns": (first, end), "of": (20, 30)}


def test_a_box_within_one_pixel_gives_that_pixel():
    assert crop(sheet(FRAMES[0]), (3.2, 4.1, 3.3, 4.9)).values.tolist() == [[ROWS[15, 3]]]
    assert crop(sheet(FRAMES[1]), (3.2, 4.1, 3.3, 4.9)).values.tolist() == [[ROWS[4, 3]]]


def test_the_whole_and_none():
    picture = sheet(FRAMES[2])
    assert crop(picture, None) is picture
    whole = crop(picture, picture.frame.bounds)
    assert whole.frame == picture.frame
    assert (whole.values == ROWS).all()


def test_parts_of_parts_are_parts():
    picture = sheet(FRAMES[3])
    first = crop(picture, (6, -2, 20, 0))
    assert crop(first, (8, -1, 10, -0.5)).frame.bounds == pytest.approx(crop(picture, (8, -1, 10, -0.5)).frame.bounds)


def test_colours_and_notes_come_along_and_the_picture_is_not_changed():
    picture = read(np.zeros((5, 6, 4), np.uint8))
    picture = dataclasses.replace(picture, source="a file", notes={"palette": 1})
    part = crop(picture, (1, 1, 3, 3))
    assert part.values.shape == (2, 2, 4)
    assert (part.source, part.notes["palette"]) == ("a file", 1)
    assert picture.notes == {"palette": 1}
    assert not np.shares_memory(part.values, picture.values)
    assert part.values.flags.c_contiguous


@pytest.mark.parametrize("box", [(1, 2, 3), (1, 2, 3, 4, 5), "1234", 7, {}, [[1, 2, 3, 4]]])
def test_a_box_is_four_numbers(box):
    with pytest.raises(ParameterError, match=r"^crop: expected four numbers \(left, bottom, right, top\), found"):
        crop(sheet(FRAMES[0]), box)


@pytest.mark.parametrize("box", [(1, 2, 3, np.nan), (1, 2, np.inf, 3), (1, 2, "3", None), (1, 2, 3, True)])
def test_numbers_of_a_box_are_finite(box):
    with pytest.raises(ParameterError, match="^crop: expected a number, found"):
        crop(sheet(FRAMES[0]), box)


@pytest.mark.parametrize("box", [(3, 2, 3, 4), (4, 2, 3, 4), (1, 4, 3, 4), (1, 5, 3, 4)])
def test_a_box_is_not_empty(box):
    with pytest.raises(ParameterError, match="^crop: expected left < right and bottom < top, found"):
        crop(sheet(FRAMES[0]), box)


@pytest.mark.parametrize("upward", [True, False])
@pytest.mark.parametrize("box", [(-1, 2, 3, 4), (1, -0.1, 3, 4), (1, 2, 30.5, 4), (1, 2, 3, 21), (40, 40, 50, 50)])
def test_a_box_lies_within_the_image(box, upward):
    with pytest.raises(ParameterError, match=r"^crop: expected a box within the image, \(0.0, 0.0, 30.0, 20.0\), found"):
        crop(sheet(dataclasses.replace(FRAMES[0], upward=upward)), box)
