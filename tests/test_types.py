"""Where the image lies in the world: ways there and back, and lengths and areas with their units."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.errors import ParameterError
from img2tri.types import Frame

FRAMES = [
    Frame((30, 40)),
    Frame((30, 40), (0.5, 0.25), (7, -3)),
    Frame((30, 40), (0.5, 2.0), (-1, 2), upward=False),
]


@pytest.mark.parametrize("frame", FRAMES)
def test_there_and_back(frame):
    rows, columns = np.random.default_rng(0).uniform(0, 30, (2, 50))
    places = frame.xy(rows, columns)
    assert frame.world(frame.plane(rows, columns)) == pytest.approx(places)
    for found, given in zip(frame.row_column(places), (rows, columns), strict=True):
        assert found == pytest.approx(given)


@pytest.mark.parametrize("frame", FRAMES)
def test_the_corners_of_the_image_are_its_bounds(frame):
    left, bottom, right, top = frame.bounds
    assert (right - left, top - bottom) == (40 * frame.spacing[0], 30 * frame.spacing[1])
    first = (left, top) if frame.upward else (left, bottom)
    assert tuple(frame.xy(0, 0)) == first
    assert set(map(tuple, frame.xy([0, 0, 30, 30], [0, 40, 0, 40]).tolist())) == {(x, y) for x in (left, right) for y in (bottom, top)}
    assert frame.diagonal == pytest.approx(np.hypot(right - left, top - bottom))


@pytest.mark.parametrize(
    ("text", "length"), [("8", 8), (" 8 px ", 2), ("8px", 2), ("1e1px", 2.5), ("+.5px", 0.125), ("2%", 0.02 * np.hypot(20, 7.5)), (8, 8)]
)
def test_lengths_have_units(text, length):
    assert FRAMES[1].length("a", text) == pytest.approx(length)


@pytest.mark.parametrize(("text", "area"), [("8", 8), ("8px2", 1), (" 8 px2 ", 1), (8, 8), (0, 0)])
def test_areas_have_units(text, area):
    assert FRAMES[1].area("a", text) == pytest.approx(area)


@pytest.mark.parametrize("text", ["", "px", "8 m", "8px2", "8 8px", "nanpx", "infpx", "8p x"])
def test_what_is_no_length_with_a_unit_is_refused(text):
    with pytest.raises(ParameterError) as refused:
        FRAMES[0].length("a", text)
    assert str(refused.value) == f"a: expected a number with a unit, like 8, '8px' or '2%', found {text!r}"


@pytest.mark.parametrize("text", ["8e", "1.2.3px", "--8px", "8-8", ".px", "E%"])
def test_what_looks_like_a_number_and_is_none_is_refused(text):
    with pytest.raises(ParameterError, match="^a: expected a number above 0, found "):
        FRAMES[0].length("a", text)


@pytest.mark.parametrize("text", ["8px", "8%"])
def test_an_area_has_units_of_its_own(text):
    with pytest.raises(ParameterError, match="expected a number with a unit, like 4 or '4px2'"):
        FRAMES[0].area("a", text)


@pytest.mark.parametrize("value", [0, "0px", -1, "-1px", "0%"])
def test_a_length_is_above_0_unless_0_is_allowed(value):
    with pytest.raises(ParameterError, match="^a: expected a number above 0, found "):
        FRAMES[0].length("a", value)
    if "-" not in str(value):
        assert FRAMES[0].length("a", value, zero=True) == 0
