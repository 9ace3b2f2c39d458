"""The entries of all options by name -> values checked, values for a stage, values as plain data.

In: what a user gave. Out: every option with its value. A report keeps them as plain data, from which the same mesh can be made again.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import numbers
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar, cast, get_args, get_type_hints

from img2tri.errors import FileError, ParameterError, UnknownOptionError
from img2tri.options.image_options import NameOptions, PartOptions, ReadOptions, SegmentOptions, SpeckOptions, WidthOptions
from img2tri.options.mesh_options import (
    BlockOptions,
    FillOptions,
    OutlineOptions,
    RecipeOptions,
    SizeOptions,
    SmoothOptions,
    SymmetryOptions,
    ToleranceOptions,
)
from img2tri.options.option import Option, every
from img2tri.options.paper_options import PaperOptions

if TYPE_CHECKING:
    from numpy.typing import NDArray

G = TypeVar("G")


class MeshOptions(
    RecipeOptions, ReadOptions, WidthOptions, PartOptions, SegmentOptions, SpeckOptions, NameOptions, OutlineOptions, SymmetryOptions,
    SizeOptions, BlockOptions,
    ToleranceOptions, FillOptions, SmoothOptions, PaperOptions, total=False,
):  # fmt: skip
    """Every option of `mesh_image`, for functions that hand them on: ``**options: Unpack[MeshOptions]``."""


# In the order of the documentation: groups under the headings of the command line.
HEADINGS: dict[str, tuple[Any, ...]] = {
    "what is meshed": (SegmentOptions, SpeckOptions, PartOptions),
    "where it lies": (ReadOptions, WidthOptions, NameOptions),
    "how it is meshed": (
        RecipeOptions,
        OutlineOptions,
        SymmetryOptions,
        SizeOptions,
        BlockOptions,
        ToleranceOptions,
        FillOptions,
        SmoothOptions,
    ),
    "the paper's recipes only": (PaperOptions,),
}


def _entries(group: Any) -> dict[str, tuple[Any, Option]]:
    """Return type and option of each entry of a group."""
    hints = get_type_hints(group, localns={"EdgeLength": Any}, include_extras=True)
    return {name: (get_args(hint)[0], next(entry for entry in get_args(hint) if isinstance(entry, Option))) for name, hint in hints.items()}


GROUPS: dict[str, dict[str, tuple[Any, Option]]] = {
    heading: {name: entry for group in groups for name, entry in _entries(group).items()} for heading, groups in HEADINGS.items()
}
TYPES: dict[str, Any] = {name: kind for group in GROUPS.values() for name, (kind, _) in group.items()}
OPTIONS: dict[str, Option] = {name: option for group in GROUPS.values() for name, (_, option) in group.items()}


MAY_BE_NONE = {name for name, option in OPTIONS.items() if type(None) in get_args(TYPES[name]) or option.kind.endswith("None")}


def takes_none(name: str) -> bool:
    """Whether None is a value of an option."""
    return name in MAY_BE_NONE


def checked(given: Mapping[str, Any], *, function: str = "mesh_image") -> MeshOptions:
    """Return every option, as given or by default, checked as far as it can be without the image.

    Raises
    ------
    ParameterError
        If a value cannot be that of its option, an option is of another recipe, or there is none of the name.

    Examples
    --------
    >>> checked({"min_angle": 25})["min_angle"], checked({})["tolerance"]
    (25.0, '0.5px')
    """
    for name in given:
        if name not in OPTIONS:
            raise UnknownOptionError(f"{function}() got an unexpected keyword argument {name!r}{nearest(name, [*OPTIONS, 'progress'])}")
    values: dict[str, Any] = {}
    for name, option in OPTIONS.items():
        value = _alone(given.get(name, option.default))
        values[name] = value if value is None and takes_none(name) else option.check(name, value)
    for name, option in OPTIONS.items():
        if option.recipes and values["recipe"] not in option.recipes and values[name] is not None:
            raise ParameterError(f"{name}: not an option of recipe {values['recipe']!r}; leave it out, or choose {every(option.recipes)}")
    return cast(MeshOptions, values)


def _alone(value: Any) -> Any:
    """Return a value that is an array without dimensions as what is in it; by its name, since options are known without NumPy."""
    return value.item() if type(value).__name__ == "ndarray" and value.ndim == 0 else value


def of(group: type[G], options: MeshOptions) -> G:
    """Return the options of a group, which are those of a stage.

    Examples
    --------
    >>> from img2tri.options.mesh_options import SmoothOptions
    >>> of(SmoothOptions, checked({}))
    {'smoothing': None, 'iterations': 10}
    """
    return group(**{name: options[name] for name in group.__annotations__})  # type: ignore[literal-required]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the end of a message that names what may have been meant.

    Examples
    --------
    >>> nearest("edge_lenght", OPTIONS)
    "; did you mean 'edge_length'?"
    """
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.7)
    return f"; did you mean {close[0]!r}?" if close else ""


def plain(options: Mapping[str, Any], *, field: NDArray[Any] | None = None) -> dict[str, Any]:
    """Return options as plain data, numbers, words, lists and dictionaries, from which the same mesh can be made again.

    Of lengths given as an array or a function there is only the hash of the grid `field` that was made of them.
    """
    result = {name: _plain(value) for name, value in options.items()}
    if isinstance(result["edge_length"], _Field):
        grid = b"" if field is None else field.tobytes()
        result["edge_length"] = {"field": result["edge_length"].kind, "sha256": hashlib.sha256(grid).hexdigest()}
    return result


@dataclass(frozen=True)
class _Field:
    """Lengths that are no plain data."""

    kind: str


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, Mapping):
        return {_plain(label): _plain(entry) for label, entry in value.items()}
    if callable(value):
        return _Field("function")
    if getattr(value, "ndim", 0) == 2:
        return _Field(f"array {' x '.join(map(str, value.shape))}")
    if isinstance(value, Iterable):
        return [_plain(entry) for entry in value]
    return float(value)


def load_options(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the options of a report, or of a file with nothing but options, both JSON.

    Raises
    ------
    FileError
        If there is no such file, or it holds no options.
    """
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except (OSError, ValueError) as problem:
        raise FileError(f"{os.fspath(path)!r}: expected a report or options as JSON, found {problem}") from problem
    options = data.get("options", data) if isinstance(data, dict) else None
    if not isinstance(options, dict) or not options or not set(options) <= set(OPTIONS):
        raise FileError(f"{os.fspath(path)!r}: expected a report or options as JSON, found no options of meshing")
    return {name: _with_labels(value) for name, value in options.items()}


def _with_labels(value: Any) -> Any:
    """Turn the keys of a dictionary by label, which are texts in JSON, back into labels."""
    if isinstance(value, dict):
        return {int(key) if key.lstrip("-").isdigit() else key: entry for key, entry in value.items()}
    return value
