"""The error tree, and the checks made at the door.

Everything a user can cause is an ``Img2triError``; each child is also the built-in error Python users expect::

    Img2triError
    ├── ParameterError (ValueError)   an option has a value it cannot have
    │   └── UnknownOptionError (TypeError)   there is no option of that name
    ├── ImageError     (ValueError)   the image cannot be meshed as it is
    ├── FileError      (OSError)      a file cannot be read or written
    └── MeshError      (ValueError)   arrays given as a mesh are not one

What is told before the work, because it is hardly meant, is an ``Img2triWarning``::

    Img2triWarning (UserWarning)
    ├── SizeWarning           far more triangles are to be expected than were asked for
    ├── ConnectivityWarning   a region is in pieces that touch at corners of pixels only
    └── ConfettiWarning       most labels are no more than the edges between others

A message names the parameter, what was expected, what was found, and, where it is not obvious, what to do.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Sequence
from typing import SupportsFloat, SupportsIndex, TypeVar

T = TypeVar("T", bound=str)

SHOWN = 100  # letters of a value in a message


class Img2triError(Exception):
    """Base of every error a user of img2tri can cause."""


class ParameterError(Img2triError, ValueError):
    """An option has a value it cannot have."""


class UnknownOptionError(ParameterError, TypeError):
    """There is no option of that name; Python's own error for it is a TypeError."""


class ImageError(Img2triError, ValueError):
    """The image cannot be meshed as it is."""


class FileError(Img2triError, OSError):
    """A file cannot be read or written."""


class MeshError(Img2triError, ValueError):
    """Arrays given as a mesh are not one."""


class Img2triWarning(UserWarning):
    """Base of all that is told before the work, because it is hardly meant."""


class SizeWarning(Img2triWarning):
    """Far more triangles are to be expected than were asked for."""


class ConnectivityWarning(Img2triWarning):
    """A region is in pieces that touch at corners of pixels only."""


class ConfettiWarning(Img2triWarning):
    """Most labels are no more than the edges between others."""


def finite(name: str, value: object, *, above: float | None = None, least: float | None = None, most: float | None = None) -> float:
    """Return `value` as a float, or say why it is not a finite number within its bounds.

    Examples
    --------
    >>> finite("edge_length", 8, above=0)
    8.0
    >>> finite("edge_length", -1, above=0)
    Traceback (most recent call last):
    ...
    img2tri.errors.ParameterError: edge_length: expected a number above 0, found -1
    """
    bounds = [f"above {above:g}"] if above is not None else []
    bounds += [f"of at least {least:g}"] if least is not None else []
    bounds += [f"of at most {most:g}"] if most is not None else []
    expected = " ".join(["a number", " and ".join(bounds)]).strip()
    try:
        # All that Python counts among numbers, numpy's and Decimal too; no bool, no text, which float() would take.
        plain = getattr(value, "ndim", 0) == 0 and getattr(getattr(value, "dtype", None), "kind", "f") in "iuf"
        known = plain and isinstance(value, (int, float, SupportsFloat, SupportsIndex)) and not _is_bool(value)
        number = float(value) if known else math.nan  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    within = (above is None or number > above) and (least is None or number >= least) and (most is None or number <= most)
    if not (math.isfinite(number) and within):
        raise ParameterError(f"{name}: expected {expected}, found {shown(value)}")
    return number


def integer(name: str, value: object, *, least: int = 0, most: int | None = None) -> int:
    """Return `value` as an int, or say that it is not a whole number from `least` to `most`.

    Examples
    --------
    >>> integer("iterations", 10)
    10
    """
    try:
        number = None if _is_bool(value) else operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        number = None
    if number is None or number < least:
        raise ParameterError(f"{name}: expected a whole number of at least {least}, found {shown(value)}")
    if most is not None and number > most:
        raise ParameterError(f"{name}: expected a whole number of at most {most}, found {shown(value)}")
    return number


def choice(name: str, value: T, options: Sequence[str]) -> T:
    """Return `value` if it is one of `options`, or list them.

    Examples
    --------
    >>> choice("recipe", "conforming", ["conforming", "structured"])
    'conforming'
    """
    if not isinstance(value, str) or value not in options:
        raise ParameterError(f"{name}: expected one of {', '.join(map(repr, options))}, found {shown(value)}")
    return value


def flag(name: str, value: object) -> bool:
    """Return `value` if it is True or False, or say that it is neither: the words "no" and "False" would count as true.

    Examples
    --------
    >>> flag("invert", "no")
    Traceback (most recent call last):
    ...
    img2tri.errors.ParameterError: invert: expected True or False, found 'no'
    """
    if not _is_bool(value):
        raise ParameterError(f"{name}: expected True or False, found {shown(value)}")
    return bool(value)


def shown(value: object) -> str:
    """Return what a message says of a value: its repr, in one line of bearable length.

    Examples
    --------
    >>> shown("8 px"), shown(10**5000), len(shown("x" * 1000))
    ("'8 px'", 'int', 100)
    """
    try:
        text = " ".join(repr(value).split())
    except Exception:
        # Integers of more than 4300 digits have none, nor have objects of all kinds.
        return type(value).__name__
    return text if len(text) <= SHOWN else text[: SHOWN - 4] + " ..."


def _is_bool(value: object) -> bool:
    # numpy's own, without the need to load numpy here.
    return isinstance(value, bool) or type(value).__name__ in ("bool_", "bool")


def bounded(what: str, rounds: int) -> Iterator[int]:
    """Count the rounds of a loop that is known to end, and end it with an error where it does not: a loop never runs for ever.

    Parameters
    ----------
    what
        Which loop, for the message.
    rounds
        More than it can take.

    Examples
    --------
    >>> for _ in bounded("halving", 3):
    ...     pass
    Traceback (most recent call last):
    ...
    img2tri.errors.Img2triError: halving: expected to be done within 3 rounds, found no end; this is a fault of img2tri, please report it
    """
    yield from range(rounds)
    raise Img2triError(f"{what}: expected to be done within {rounds} rounds, found no end; this is a fault of img2tri, please report it")
