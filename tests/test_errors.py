"""Numbers, whole numbers, choices and flags at the door: what is taken, what is refused, and what the error says."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from img2tri.errors import FileError, ImageError, Img2triError, MeshError, ParameterError, choice, finite, flag, integer, shown


@pytest.mark.parametrize("value", [8, 8.0, np.float32(8), np.int16(8), np.array(8.0), Decimal(8), Fraction(8)])
def test_every_kind_of_number_is_taken(value):
    number = finite("a", value)
    assert (type(number), number) == (float, 8.0)


@pytest.mark.parametrize(
    "value",
    [math.nan, math.inf, -math.inf, "8", b"8", None, True, np.True_, np.array([8.0]), np.array(True), 8j, Decimal("sNaN"), 10**400, [8]],
)
def test_what_is_no_finite_number_is_refused(value):
    with pytest.raises(ParameterError, match="^a: expected a number, found "):
        finite("a", value)


@pytest.mark.parametrize(
    ("bounds", "inside", "outside", "words"),
    [
        ({"above": 0}, [5e-324, 1e308], [0, -1], "a number above 0"),
        ({"least": 0}, [0, 1e308], [-5e-324], "a number of at least 0"),
        ({"most": 40}, [40, -1e308], [40.000001], "a number of at most 40"),
        ({"least": 1, "most": 2}, [1, 2], [0.99, 2.01], "a number of at least 1 and of at most 2"),
        ({"above": 1, "most": 2}, [1.01, 2], [1, 2.01], "a number above 1 and of at most 2"),
    ],
)
def test_bounds_are_kept_and_told(bounds, inside, outside, words):
    assert [finite("a", value, **bounds) for value in inside] == inside
    for value in outside:
        with pytest.raises(ParameterError) as refused:
            finite("a", value, **bounds)
        assert str(refused.value) == f"a: expected {words}, found {value}"


@pytest.mark.parametrize("value", [8, np.uint8(8), np.array(8)])
def test_every_kind_of_whole_number_is_taken(value):
    number = integer("a", value, least=8, most=8)
    assert (type(number), number) == (int, 8)


@pytest.mark.parametrize(
    ("value", "bounds", "words"),
    [
        (8.0, {}, "a whole number of at least 0"),
        ("8", {}, "a whole number of at least 0"),
        (True, {}, "a whole number of at least 0"),
        (-1, {}, "a whole number of at least 0"),
        (7, {"least": 8}, "a whole number of at least 8"),
        (9, {"most": 8}, "a whole number of at most 8"),
    ],
)
def test_what_is_no_whole_number_within_its_bounds_is_refused(value, bounds, words):
    with pytest.raises(ParameterError) as refused:
        integer("a", value, **bounds)
    assert str(refused.value) == f"a: expected {words}, found {value!r}"


@pytest.mark.parametrize("value", ["c", "A", "", None, 1, ["a"]])
def test_a_choice_lists_what_there_is(value):
    assert choice("a", "b", ["a", "b"]) == "b"
    with pytest.raises(ParameterError) as refused:
        choice("a", value, ["a", "b"])
    assert str(refused.value) == f"a: expected one of 'a', 'b', found {value!r}"


def test_a_flag_is_true_or_false():
    assert [flag("a", value) for value in (True, False, np.True_, np.False_)] == [True, False, True, False]
    for value in (0, 1, "no", None, [], np.array([True])):
        with pytest.raises(ParameterError, match="^a: expected True or False, found "):
            flag("a", value)


def test_any_value_can_be_shown_in_one_short_line():
    class Mute:
        def __repr__(self):
            raise RuntimeError

    assert shown(Mute()) == "Mute"
    assert shown(np.eye(2)) == "array([[1., 0.], [0., 1.]])"
    assert shown("x" * 97) == repr("x" * 97)
    assert shown("x" * 200) == "'" + "x" * 95 + " ..."
    assert len(shown("x" * 200)) == 100


def test_errors_are_of_the_kinds_python_has():
    assert all(issubclass(error, Img2triError) for error in (ParameterError, ImageError, FileError, MeshError))
    assert all(issubclass(error, ValueError) for error in (ParameterError, ImageError, MeshError))
    assert issubclass(FileError, OSError)
