"""The options of `mesh_image` as knobs: names, words and defaults for the page; texts typed into them, and JSON -> values.

All comes from the entries of `img2tri.options`; here is only which of them have a knob of their own, and what the values of a choice are.
"""

from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Mapping
from typing import Any

from img2tri.errors import ParameterError, shown
from img2tri.options.all_options import GROUPS, OPTIONS, TYPES, nearest

_OWN = {"threshold", "labels", "background", "invert", "names", "edge_length", "gradation", "boundary_edge_length", "min_area", "largest"}
CHOICES: dict[str, tuple[str, ...]] = {
    "recipe": ("conforming", "structured", "unstructured"),
    "outline": ("smooth", "pixel"),
    "corners": ("auto", "keep", "round"),
    "interior": ("lattice", "poisson"),
    "smoothing": ("none", "uniform", "cotangent"),
    "periodic": ("x", "y", "xy"),
    "symmetric": ("x", "y", "xy"),
    "connectivity": ("4", "8"),
    "units": ("um", "mm", "cm", "m", "in", "ft"),
}
_FIXED = {"max_pixels"}  # a limit for who starts the app, not for who turns knobs


def knobs() -> list[dict[str, Any]]:
    """List the options that have no knob of their own, for the page: name, heading, words, default, and the values of a choice."""
    return [
        {
            "name": name,
            "heading": heading,
            "words": option.words.partition("\n\n")[0].replace("`", ""),
            "default": option.default if isinstance(option.default, bool) else said(option.default),
            "none": option.none,
            "choices": CHOICES.get(name, ()),
            "flag": TYPES[name] is bool,
        }
        for heading, group in GROUPS.items()
        for name, (_, option) in group.items()
        if name not in _OWN | _FIXED
    ]


def said(value: Any) -> str:
    """Write a value as it is typed into a knob; None is nothing."""
    if value is None:
        return ""
    return ",".join(map(said, value)) if isinstance(value, (list, tuple)) else f"{value:g}" if isinstance(value, float) else str(value)


def values(given: Mapping[str, Any]) -> dict[str, Any]:
    """Turn what the page sends, texts and JSON, into options of `mesh_image`; what is left empty is left out.

    Raises
    ------
    ParameterError
        If there is no such option, or a text is not what it stands for.

    Examples
    --------
    >>> values({"edge_length": {"1": "8px"}, "threshold": "90", "labels": None, "tolerance": ""})
    {'edge_length': {1: '8px'}, 'threshold': 90.0, 'labels': None}
    """
    return {name: _value(name, value) for name, value in given.items() if value != ""}


def _value(name: str, value: Any) -> Any:
    if name not in OPTIONS or name in _FIXED:
        raise ParameterError(f"{name}: expected an option of mesh_image, found none{nearest(name, OPTIONS)}")
    if isinstance(value, str):
        try:
            return _checked(name, OPTIONS[name].typed(value))
        except ArgumentTypeError as problem:
            raise ParameterError(f"{name}: {problem}") from None
    if isinstance(value, dict):
        return {_label(name, label): _checked(name, entry) if name == "edge_length" else entry for label, entry in value.items()}
    return value


def _checked(name: str, value: Any) -> Any:
    """Check a value as `mesh_image` will: a text without a unit becomes a number."""
    return value if value is None else OPTIONS[name].check(name, value)


def _label(name: str, label: str) -> int:
    try:
        return int(label)
    except ValueError:
        raise ParameterError(f"{name}: expected whole numbers with values, found {shown(label)}") from None
