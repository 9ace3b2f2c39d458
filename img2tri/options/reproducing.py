"""Options -> the command line and the Python that make the same mesh, with only what differs from the defaults.

Options that are no plain data, lengths as an array or a function, can be written in neither; they are named instead.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

from img2tri.options.all_options import OPTIONS


def different(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that differ from their defaults.

    Examples
    --------
    >>> different({"min_angle": 30.0, "seed": 3})
    {'seed': 3}
    """
    return {name: value for name, value in options.items() if is_field(value) or value != OPTIONS[name].default}


def python(image: str, options: Mapping[str, Any], *, literal: bool = True) -> str:
    """Write the call of Python, `image` being a path, or with ``literal=False`` the name of a variable.

    Examples
    --------
    >>> python("a.png", {"edge_length": 8.0, "labels": [1, 2], "invert": False})
    "mesh = img2tri.mesh_image('a.png', edge_length=8, labels=[1, 2])"
    """
    given = [repr(image) if literal else image] + [f"{name}={_python(value)}" for name, value in different(options).items()]
    return f"mesh = img2tri.mesh_image({', '.join(given)})"


def command(image: str, options: Mapping[str, Any], output: str = "mesh.vtu") -> str:
    """Write the command line, quoted where a shell needs it.

    Examples
    --------
    >>> command("my bone.png", {"edge_length": {1: 4.0, 2: "8px"}, "names": {1: "bone"}, "keep_area": False, "background": None})
    "img2tri mesh 'my bone.png' -o mesh.vtu --edge-length 1=4,2=8px --name 1=bone --no-keep-area --background none"
    """
    words = ["img2tri", "mesh", image, "-o", output]
    for name, value in different(options).items():
        words += _words(name, value)
    return shlex.join(words)


def _words(name: str, value: Any) -> list[str]:
    flag = OPTIONS[name].flag or "--" + name.replace("_", "-")
    if isinstance(value, bool):
        return [flag] if value else ["--no-" + flag[2:]]
    if name == "names":
        return [word for label, entry in value.items() for word in (flag, f"{label}={entry}")]
    text = "none" if value is None else _typed(value)
    return [f"{flag}={text}"] if text.startswith("-") else [flag, text]


def _typed(value: Any) -> str:
    if isinstance(value, Mapping) and not is_field(value):
        return ",".join(f"{label}={_typed(entry)}" for label, entry in value.items())
    if isinstance(value, (list, tuple, range, set)):
        return ",".join(map(_typed, value))
    return _number(value) if isinstance(value, float) else "(a field of lengths)" if is_field(value) else str(value)


def _python(value: Any) -> str:
    if isinstance(value, Mapping) and not is_field(value):
        return "{" + ", ".join(f"{label}: {_python(entry)}" for label, entry in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_python, value)) + "]"
    return _number(value) if isinstance(value, float) else "..." if is_field(value) else repr(value)


def _number(value: float) -> str:
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def is_field(value: Any) -> bool:
    """Tell whether a value is no plain data: an array or a function, or what a report keeps of one."""
    return callable(value) or getattr(value, "ndim", 0) > 0 or (isinstance(value, Mapping) and "sha256" in value)
