"""The error tree, and the checks made at the door.

Everything a user can cause is an ``Img2triError``; each child is also the built-in error Python users expect::

    Img2triError
    ├── ParameterError (ValueError)   an option has a value it cannot have
    ├── ImageError     (ValueError)   the image cannot be meshed as it is
    ├── FileError      (OSError)      a file cannot be read or written
    └── MeshError      (ValueError)   arrays given as a mesh are not one

A message names the parameter, what was expected, what was found, and, where it is not obvious, what to do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T", bound=str)


class Img2triError(Exception):
    """Base of every error a user of img2tri can cause."""


class ParameterError(Img2triError, ValueError):
    """An option has a value it cannot have."""


class ImageError(Img2triError, ValueError):
    """The image cannot be meshed as it is."""


class FileError(Img2triError, OSError):
    """A file cannot be read or written."""


class MeshError(Img2triError, ValueError):
    """Arrays given as a mesh are not one."""


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
        number = float(value) if not isinstance(value, (bool, str, bytes)) else math.nan  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    within = (above is None or number > above) and (least is None or number >= least) and (most is None or number <= most)
    if not (math.isfinite(number) and within):
        raise ParameterError(f"{name}: expected {expected}, found {value!r}")
    return number


def integer(name: str, value: object, *, least: int = 0) -> int:
    """Return `value` as an int, or say that it is not a whole number of at least `least`.

    Examples
    --------
    >>> integer("iterations", 10)
    10
    """
    whole = hasattr(value, "__index__") and not isinstance(value, bool)
    if not whole or int(value) < least:  # type: ignore[call-overload]
        raise ParameterError(f"{name}: expected a whole number of at least {least}, found {value!r}")
    return int(value)  # type: ignore[call-overload, no-any-return]


def choice(name: str, value: T, options: Sequence[str]) -> T:
    """Return `value` if it is one of `options`, or list them.

    Examples
    --------
    >>> choice("recipe", "conforming", ["conforming", "structured"])
    'conforming'
    """
    if value not in options:
        raise ParameterError(f"{name}: expected one of {', '.join(map(repr, options))}, found {value!r}")
    return value
