"""What is known of an option: one record for all who need it, and the checks that need no image.

A check takes the name and the value and returns the value as the stages take it, or raises a `ParameterError` that names it. What can
only be judged beside the image (whether it has such a label, whether a box lies in it) is for the stage that gets the option to say.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from img2tri.errors import ParameterError, choice, finite, flag, integer, shown
from img2tri.options import parsing as texts

Check = Callable[[str, Any], Any]

MOST_COLOURS = 256
MOST_LEVELS = 65535  # between the values of 16 bits


def unchecked(_name: str, value: Any) -> Any:
    """Leave it to the stage, which sees the image."""
    return value


@dataclass(frozen=True)
class Option:
    """An option of `mesh_image`. Its name and type are those of its entry; None is a value if the type says so.

    Attributes
    ----------
    default
        What is taken if it is left out.
    words
        What it is, with its unit, and what other values lead to. The first paragraph is also the help of the command line; other options
        are named in backticks there.
    none
        What None means, where it is the default.
    check
        From name and value to the value the stages get.
    typed
        From a text typed on the command line to the value. Flags have none.
    sign
        What stands for the value in the help of the command line.
    flag
        How it is called there; empty: ``--`` and its name. One that is not the name may be given several times, for pairs.
    kind
        The type in words, where that of the entry would be too long.
    recipes
        The recipes that have it; empty: all.
    """

    default: Any
    words: str
    none: str = ""
    check: Check = unchecked
    typed: Callable[[str], Any] = texts.as_typed
    sign: str = ""
    flag: str = ""
    kind: str = ""
    recipes: tuple[str, ...] = ()


def one_of(*values: str) -> Check:
    """Take one of these words."""
    return lambda name, value: choice(name, value, values)


def whole(least: int = 0, most: int | None = None) -> Check:
    """Take whole numbers within bounds."""
    return lambda name, value: integer(name, value, least=least, most=most)


def real(*, above: float | None = None, least: float | None = None, most: float | None = None) -> Check:
    """Take finite numbers within bounds."""
    return lambda name, value: finite(name, value, above=above, least=least, most=most)


def length(name: str, value: Any) -> Any:
    """Check lengths above 0: numbers, "8px" or "2%"; a text without a unit becomes a number."""
    from img2tri.types import Frame

    number = Frame((1, 1)).length(name, value)
    return number if _is_bare(value) else value


def length_or_zero(name: str, value: Any) -> Any:
    """Check lengths of at least 0."""
    from img2tri.types import Frame

    number = Frame((1, 1)).length(name, value, zero=True)
    return number if _is_bare(value) else value


def area(name: str, value: Any) -> Any:
    """Check areas of at least 0: numbers or "20px2"."""
    from img2tri.types import Frame

    number = Frame((1, 1)).area(name, value)
    return number if _is_bare(value) else value


def yes_or_area(name: str, value: Any) -> Any:
    """Check for True, False or an area."""
    return value if isinstance(value, bool) else area(name, value)


def _is_bare(value: Any) -> bool:
    return isinstance(value, str) and not value.strip().endswith(("px", "px2", "%"))


def yes_or_no(name: str, value: Any) -> bool:
    """Check for True or False; no words that count as true."""
    return flag(name, value)


def four_or_eight(name: str, value: Any) -> int:
    """Check for 4 or 8."""
    if isinstance(value, bool) or not isinstance(value, int) or value not in (4, 8):
        raise ParameterError(f"{name}: expected 4 or 8, found {shown(value)}")
    return value


def names_by_label(_name: str, value: Any) -> dict[int, str]:
    """Check names by label."""
    from img2tri.types import checked_names

    return checked_names(value)


def one_label(name: str, value: Any) -> int:
    """Check for a number that fits 64 bits."""
    from img2tri.raster.labels.rgb_to_labels import label

    return label(name, value)


def one_label_or_more(name: str, value: Any) -> list[int]:
    """Check for a label, or several."""
    from img2tri.raster.labels.rgb_to_labels import picked

    return picked(value, name) if isinstance(value, Iterable) else [one_label(name, value)]


def one_level_or_more(name: str, value: Any) -> Any:
    """Check for a number, a word, or rising numbers, of which a list is made."""
    if isinstance(value, (str, bytes, bytearray)) or not isinstance(value, Iterable) or getattr(value, "ndim", 1) == 0:
        if isinstance(value, str) and value not in ("otsu", "alpha"):
            raise ParameterError(f"{name}: expected a number, 'otsu', 'alpha' or None, found {value!r}")
        return value if isinstance(value, str) else finite(name, value)
    levels = [finite(name, level) for level in itertools.islice(value, MOST_LEVELS + 1)]
    if not 0 < len(levels) <= MOST_LEVELS or any(a >= b for a, b in itertools.pairwise(levels)):
        raise ParameterError(f"{name}: expected up to {MOST_LEVELS} rising numbers, like [110, 190], found {shown(value)}")
    return levels[0] if len(levels) == 1 else levels


def all_or_some(_name: str, value: Any) -> bool | list[int]:
    """Check for True or False, or labels, of which a list is made: an iterator can be read once."""
    from img2tri.raster.labels.rgb_to_labels import picked

    return value if isinstance(value, bool) else picked(value)


def count_or_colours(name: str, value: Any) -> int | list[float]:
    """Check for a count, or a list of colours, of which numbers are made."""
    if isinstance(value, int) and not isinstance(value, bool):
        return integer(name, value, least=1, most=MOST_COLOURS)
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable):
        raise ParameterError(f"{name}: expected how many colours, or a list like ['#dc2828', 0x28a0dc], found {shown(value)}")
    listed = [_colour(name, one) for one in itertools.islice(value, MOST_COLOURS + 1)]
    if not 0 < len(listed) <= MOST_COLOURS or len(set(listed)) < len(listed):
        raise ParameterError(f"{name}: expected 1 to {MOST_COLOURS} different colours, found {shown(value)}")
    return listed


def _colour(name: str, value: Any) -> float:
    if isinstance(value, str):
        if re.fullmatch(r"#[0-9a-fA-F]{6}", value.strip()):
            return int(value.strip()[1:], 16)
        raise ParameterError(f"{name}: expected colours like '#dc2828', found {shown(value)}")
    if hasattr(value, "__len__") and len(value) == 3:
        red, green, blue = (integer(name, channel, most=255) for channel in value)
        return red << 16 | green << 8 | blue
    number = finite(name, value)
    return int(number) if number.is_integer() else number


def edge_lengths(name: str, value: Any) -> Any:
    """Check one length, or what a field of lengths is made of; not the hash that a report keeps of a field."""
    if isinstance(value, (str, int, float)):
        return length(name, value)
    if isinstance(value, dict) and "sha256" in value:
        raise ParameterError(f"{name}: expected lengths, found the hash of a field, all a report keeps of one; give the field again")
    return value


def every(options: Iterable[str]) -> str:
    """List names in a sentence.

    Examples
    --------
    >>> every(["a", "b", "c"])
    'a, b or c'
    """
    *first, last = options
    return f"{', '.join(first)} or {last}" if first else last
