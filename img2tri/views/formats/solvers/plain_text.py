"""What the formats in plain text have in common: numbers in columns, numbers in rows, comments, names.

Numbers are written with the fewest digits that give the same float64 again, unless a format has no room for them.
"""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.views.formats.number_rows import rows
from img2tri.views.objects.solver_cells import Cells

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


def fitted_numbers(column: NDArray[Any], width: int) -> list[str]:
    """Write each number as `fitted_number` does; most fit as Python writes them.

    Examples
    --------
    >>> import numpy as np
    >>> fitted_numbers(np.array([0.1, -1 / 3]), 16)
    ['0.1', '-0.3333333333333']
    """
    if len(column) and np.all(column == column[0]) and not np.signbit(column).any():
        return [fitted_number(float(column[0]), width)] * len(column)
    texts = list(map(repr, column.tolist()))
    size = np.abs(column)
    lengths = np.fromiter(map(len, texts), np.int64, len(texts))
    odd = ((size < 1e-4) & (size > 0)) | (size >= 1e16) | (lengths > width)  # Python's own has an exponent, or is too long
    plain = odd & (size >= 1e-4) & (size < 1e9)
    for i in np.flatnonzero(odd & ~plain).tolist():
        texts[i] = fitted_number(float(column[i]), width)
    # Those without an exponent have as many decimals as there is room for, zeros at the end left out.
    before = np.searchsorted(10.0 ** np.arange(1, 10), size, side="right") + 1 + np.signbit(column)
    for taken in np.unique(before[plain]).tolist():
        mine = np.flatnonzero(plain & (before == taken))
        template = f"%.{width - 1 - taken}f"
        for i, x in zip(mine.tolist(), column[mine].tolist(), strict=True):
            texts[i] = (template % x).rstrip("0")
    return texts


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


def distinct_names(names: Iterable[str], fit: Callable[[str], str]) -> dict[str, str]:
    """Return for each name what a format can hold of it, no two alike.

    Examples
    --------
    >>> distinct_names(["a b", "a  b", "c"], lambda name: " ".join(name.split()))
    {'a b': 'a b', 'a  b': 'a b_2', 'c': 'c'}
    """
    found: dict[str, str] = {}
    names = list(names)
    taken = {name for name in names if fit(name) == name}
    for name in names:
        plain = fit(name)
        if plain != name:
            plain = next(word for word in chain([plain], (f"{plain}_{i}" for i in count(2))) if word not in taken)
        taken.add(plain)
        found[name] = plain
    return found


def unquoted(name: str) -> str:
    """Return a name in one line, as it can stand in double quotes."""
    return " ".join(name.replace('"', "'").split())


def label_table(made: Cells, called: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return a note of the labels of regions that have another number in files, by their names; nothing if there are none.

    Names that read as the number of another region are there too; `called` are the names in the file, where these differ.

    Examples
    --------
    >>> from img2tri.views.objects.solver_cells import flat_cells
    >>> label_table(flat_cells([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], [-7]))
    {'labels': '{"region_-7": -7}'}
    """
    own = {label: (called or {}).get(name, name) for label, name in made.names.items()}
    odd = {label for label, name in own.items() if re.fullmatch(r"region_-?\d+", name) and name != f"region_{label}"}
    others = {own[label]: label for label, number in made.ids.items() if label != number or label in odd}
    return {"labels": json.dumps(others)} if others else {}


def ascii_letters(text: str) -> str:
    """Write a text in letters and digits of ASCII, underscores and hyphens, so that different texts are likely to stay different.

    Accents are dropped; other letters become their number in Unicode.

    Examples
    --------
    >>> ascii_letters("Müller's Knochen"), ascii_letters("骨")
    ('Muller_s_Knochen', 'u9aa8')
    """
    plain = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    letters = "".join(c if c.isascii() or not c.isalnum() else f"_u{ord(c):04x}_" for c in plain)
    return re.sub(r"[^A-Za-z0-9-]+", "_", letters).strip("_")


def set_identifiers(made: Cells, taken: Iterable[str] = ()) -> dict[str, str]:
    """Return for each name of a region or set what Abaqus and CalculiX take as one, no two alike.

    Names of interfaces are composed of those of their regions, names of pieces of those of their sets.

    Examples
    --------
    >>> from img2tri.views.objects.solver_cells import flat_cells
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]
    >>> list(set_identifiers(flat_cells(*square, [1, 2], names={1: "bone marrow", 2: "骨"})).values())
    ['bone_marrow', 'u9aa8', 'outer', 'bone_marrow__u9aa8', 'outer_1', 'outer_2', 'outer_3', 'outer_4']
    """
    fixed = [name for name in made.sides if name not in made.between and name not in made.part_of]
    own = identifiers(made.names.values(), taken=(*taken, *made.sides))
    own |= identifiers(fixed, taken=(*taken, *own.values()))
    own |= {name: "__".join(own[made.names[label]] for label in labels) for name, labels in made.between.items()}
    return own | {name: own[whole] + name.removeprefix(whole) for name, whole in made.part_of.items()}


def identifiers(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Return for each name what Abaqus and CalculiX take as one: letters, digits and single underscores, a letter first.

    At most 40 characters, so that two make the name of an interface, of 80. Case is kept, but as these programs do not tell cases apart,
    names that differ by it only, or are in `taken`, get a number.

    Examples
    --------
    >>> identifiers(["left", "Left", "femur, head", "region_-1", "3rd"])
    {'left': 'left', 'Left': 'Left_2', 'femur, head': 'femur_head', 'region_-1': 'region_minus1', '3rd': 'set_3rd'}
    """
    used, found = {name.upper() for name in taken}, {}
    for name in names:
        plain = ascii_letters(re.sub(r"-(?=\d)", "minus", name)).replace("-", "_")
        plain = re.sub("_+", "_", plain if re.match("[A-Za-z]", plain) else f"set_{plain}")[:36].strip("_")
        free = next(word for word in chain([plain], (f"{plain}_{i}" for i in count(2))) if word.upper() not in used)
        used.add(free.upper())
        found[name] = free
    return found
