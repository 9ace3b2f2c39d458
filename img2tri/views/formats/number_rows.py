"""Arrays of numbers as text, one row in a line, for the formats that are text: as fast as Python and numpy go.

Whole numbers are taken apart four digits at a time by numpy, so their cost is that of a few passes over their bytes. Other numbers are
written by Python, with the fewest digits that give the same float64 again; one template for thousands of rows makes the calls few.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ParameterError

EXACT = 2**53  # up to here a float64 holds all whole numbers
_ROWS = 4096  # filled into one template at once
SHARE_OF_TEXTS = 0.3  # of numbers: so few different ones are written once each
_DIGITS = 4  # taken at once from a table of all groups of so many


def exact_doubles(name: str, values: NDArray[Any]) -> NDArray[np.float64]:
    """Return values as float64, or say that whole numbers among them would lose digits.

    Examples
    --------
    >>> exact_doubles("ids", np.array([2**53 + 1]))
    Traceback (most recent call last):
    ...
    img2tri.errors.ParameterError: ids: expected whole numbers up to 2^53, which is all a double holds, found 9007199254740993
    """
    if values.dtype.kind in "iu" and values.size:
        largest = max(int(values.max()), -int(values.min()))
        if largest > EXACT:
            raise ParameterError(f"{name}: expected whole numbers up to 2^53, which is all a double holds, found {largest}")
    return values.astype(np.float64)


def whole_rows(array: NDArray[np.integer[Any]], between: str = " ", *, before: str = "", after: str = "") -> str:
    r"""Write whole numbers of at least 0, a row (k, c) in a line.

    Parameters
    ----------
    between
        What stands between the numbers.
    before, after
        What each line begins and ends with.

    Examples
    --------
    >>> whole_rows(np.array([[1, 20345], [300, 4]]), before="f "), whole_rows(np.array([[7]]), ",", after=", S1")
    ('f 1 20345\nf 300 4\n', '7, S1\n')
    """
    if not array.size:
        return ""
    largest = int(array.max())
    if array.min() < 0 or largest >= 2**32:
        return "".join(f"{before}{between.join(map(str, row))}{after}\n" for row in array.tolist())
    width = len(str(largest))
    groups = -(-width // _DIGITS)
    head, tail = before.encode(), after.encode() + b"\n"
    k, columns = array.shape
    comma = between.encode()
    size = groups * _DIGITS + len(comma)
    line = np.zeros((k, len(head) + columns * size - len(comma) + len(tail)), np.uint8)
    shown = np.ones(line.shape, bool)
    line[:, : len(head)], line[:, line.shape[1] - len(tail) :] = list(head), list(tail)
    for column in range(columns):
        rest, at = array[:, column].astype(np.uint32), len(head) + column * size
        digits = np.empty((k, groups), np.uint32)
        for group in range(groups - 1, -1, -1):
            upper = rest // np.uint32(10**_DIGITS)
            digits[:, group] = _table()[rest - upper * np.uint32(10**_DIGITS)]
            rest = upper
        line[:, at : at + groups * _DIGITS] = digits.view(np.uint8)
        # Zeros in front are not shown.
        for power in range(groups * _DIGITS - 1):
            shown[:, at + power] = array[:, column] >= 10 ** (groups * _DIGITS - 1 - power)
        if column < columns - 1:
            line[:, at + groups * _DIGITS : at + size] = list(comma)
    return line[shown].tobytes().decode()


def real_rows(array: NDArray[np.floating[Any]], between: str = " ", *, before: str = "", after: str = "") -> str:
    r"""Write float64 numbers with all their digits, a row (k, c) in a line; options as of `whole_rows`.

    Examples
    --------
    >>> real_rows(np.array([[0.1, 1 / 3], [2, -0.0]]))
    '0.1 0.3333333333333333\n2.0 -0.0\n'
    """
    fixed = [repr(float(values[0])) if len(values) and _constant(values) else "" for values in array.T]
    free = [i for i, word in enumerate(fixed) if not word]
    values, place = _repeated(array[:, free].ravel())
    template = before.replace("%", "%%") + between.join(word or place for word in fixed) + after.replace("%", "%%") + "\n"
    if not free:
        return template * len(array)
    each, parts = _ROWS * len(free), []
    large = template * _ROWS
    for i in range(0, len(values), each):
        some = values[i : i + each]
        parts.append((large if len(some) == each else template * (len(some) // len(free))) % tuple(some))
    return "".join(parts)


def _repeated(values: NDArray[np.floating[Any]]) -> tuple[list[Any], str]:
    """Return numbers and the place for one in a template; or their texts and the place for these, where they repeat so that it is faster.

    As most coordinates do on a lattice. Numbers are told apart by their bits: -0.0 is not 0.0.
    """
    bits = np.ascontiguousarray(values, np.float64).view(np.int64)
    known = np.unique(bits)
    if len(known) > SHARE_OF_TEXTS * len(bits):
        return values.tolist(), "%r"
    texts = np.array([*map(repr, known.view(np.float64).tolist()), None], object)[:-1]
    return texts[np.searchsorted(known, bits)].tolist(), "%s"


def rows(template: str, array: NDArray[Any]) -> list[str]:
    """Fill `template` with each row of `array`; ``{!r}`` writes the fewest digits that give the same float64 again.

    Examples
    --------
    >>> rows("v {!r} {!r}", np.array([[0.1, 1 / 3]]))
    ['v 0.1 0.3333333333333333']
    """
    return list(map(template.format, *array.T.tolist()))


def _constant(values: NDArray[Any]) -> bool:
    return bool(np.all(values == values[0]) and np.all(np.signbit(values) == np.signbit(values[0])))


@cache
def _table() -> NDArray[np.uint32]:
    """Return for each number below 10,000 its four digits, as the bytes of one uint32."""
    number = np.arange(10**_DIGITS)[:, None] // 10 ** np.arange(_DIGITS - 1, -1, -1) % 10
    return np.ascontiguousarray((number + ord("0")).astype(np.uint8)).view(np.uint32).ravel()
