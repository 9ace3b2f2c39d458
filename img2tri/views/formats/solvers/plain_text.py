"""What the formats in plain text have in common: numbers in columns, numbers in rows, comments, names.

Numbers are written with the fewest digits that give the same float64 again, unless a format has no room for them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from img2tri.views.formats.stl_ply_obj_off import rows

MARK = "written by img2tri"
_PIECE = 70  # characters of a note in a line; some programs read 80 in all


def numbered(template: str, array: NDArray[Any], numbers: NDArray[Any] | list[str], *others: object) -> list[str]:
    """Fill `template` with a number, then the other values, which are the same for all, then a row of `array`.

    Examples
    --------
    >>> import numpy as np
    >>> numbered("{} 2 {} {} {}", np.array([[1, 2], [3, 4]]), np.array([7, 8]), 5)
    ['7 2 5 1 2', '8 2 5 3 4']
    """
    first, _, rest = template.partition("{}")
    for other in others:
        rest = rest.replace("{}", str(other), 1)
    return [f"{first}{number}{row}" for number, row in zip(list(numbers), rows(rest, array), strict=True)]


def in_lines(words: Sequence[object], each: int, between: str = ", ") -> list[str]:
    """Write numbers, or words, at most `each` in a line.

    Examples
    --------
    >>> in_lines([1, 2, 3], 2)
    ['1, 2', '3']
    """
    texts = list(map(str, words))
    return [between.join(texts[i : i + each]) for i in range(0, len(words), each)]


def fitted_number(number: float, width: int) -> str:
    """Write a number with a decimal point in at most `width` characters: all its digits, or as many as there is room for.

    Examples
    --------
    >>> fitted_number(0.1, 16), fitted_number(-1 / 3, 16), fitted_number(1e-7, 16), fitted_number(-1.23456789012345e-100, 16)
    ('0.1', '-0.3333333333333', '1.E-07', '-1.23456789E-100')
    """
    text, digits = repr(number), 17
    while len(text) + ("." not in text) > width:
        digits -= 1
        text = f"{number:.{digits}g}"
    if "." not in text:
        mantissa, mark, exponent = text.partition("e")
        text = f"{mantissa}.{mark}{exponent}"
    return text.upper()


def comment_lines(texts: Mapping[str, str], mark: str) -> list[str]:
    """Write texts as comments: `mark`, name and text; long ones go on in further lines, behind three spaces.

    Examples
    --------
    >>> comment_lines({"units": "mm"}, "** ")
    ['** units: mm']
    """
    lines = []
    for name, text in texts.items():
        whole = f"{name}: {text}".replace("\n", "\\n")
        pieces = [whole[i : i + _PIECE] for i in range(0, len(whole), _PIECE)]
        lines += [mark + ("   " if i else "") + piece for i, piece in enumerate(pieces)]
    return lines


def identifiers(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Return for each name what Abaqus and CalculiX take as one: letters, digits and underscores, a letter first, at most 80.

    Case is kept, but as these programs do not tell cases apart, names that differ by it only, or are in `taken`, get a number.

    Examples
    --------
    >>> identifiers(["left", "Left", "femur, head", "region_-1", "3rd"])
    {'left': 'left', 'Left': 'Left_2', 'femur, head': 'femur_head', 'region_-1': 'region_minus1', '3rd': 'set_3rd'}
    """
    used, found = {name.upper() for name in taken}, {}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]+", "_", re.sub(r"-(?=\d)", "minus", name)).strip("_")
        plain = (plain if re.match("[A-Za-z]", plain) else f"set_{plain}")[:76]
        free = next(word for word in (plain, *(f"{plain}_{i}" for i in range(2, 1000))) if word.upper() not in used)
        used.add(free.upper())
        found[name] = free
    return found
