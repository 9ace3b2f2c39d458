"""The options -> the signature, and the numpydoc section of the parameters, of a function that has all of them."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

from img2tri.options.all_options import OPTIONS, TYPES

F = TypeVar("F", bound=Callable[..., Any])

DOC_WIDTH = 120
PLACE = r"\{options\}"


def with_options(function: F) -> F:
    """Give a function with ``**options: Unpack[MeshOptions]`` its signature, and the words in place of ``{options}`` in its docstring.

    Type checkers and editors read the entries; this is for `help`, notebooks and the documentation.
    """
    own = inspect.signature(function)
    first, last = (
        [p for p in own.parameters.values() if p.kind is kind]
        for kind in (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    )
    entries = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=option.default, annotation=option.kind or TYPES[name])
        for name, option in OPTIONS.items()
    ]
    function.__signature__ = own.replace(parameters=[*first, *entries, *last])  # type: ignore[attr-defined]
    if function.__doc__ is not None:  # as under python -OO; from Python 3.13 on docstrings are not indented
        words = parameters_section()
        function.__doc__ = re.sub(rf"^( *){PLACE}$", lambda found: textwrap.indent(words, found[1], bool), function.__doc__, flags=re.M)
    return function


def parameters_section() -> str:
    """Describe each option: its type, its default, and what they mean."""
    return "\n".join(_described(name) for name in OPTIONS)


def _described(name: str) -> str:
    option = OPTIONS[name]
    words = option.words + (f" None: {option.none}." if option.none else "")
    lines = [textwrap.fill(paragraph, DOC_WIDTH, initial_indent=" " * 4, subsequent_indent=" " * 4) for paragraph in words.split("\n\n")]
    return f"{name} : {option.kind or words_of(TYPES[name])}, default {option.default!r}\n" + "\n\n".join(lines)


def words_of(kind: Any) -> str:
    """Say what a type is.

    Examples
    --------
    >>> words_of(float | str | None)
    'float | str | None'
    >>> from collections.abc import Sequence
    >>> words_of(int | Sequence[int | str] | None)
    'int | Sequence[int | str] | None'
    """
    if get_origin(kind) in (Union, UnionType):
        return " | ".join(map(words_of, get_args(kind)))
    if kind is NoneType:
        return "None"
    return kind.__name__ if type(kind) is type else re.sub(r"\b\w+\.", "", str(kind))
