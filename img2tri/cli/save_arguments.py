"""How meshes are saved, as typed on the command line: for each option of `TriangleMesh.save` the formats that take it."""

from __future__ import annotations

from argparse import Namespace, _ArgumentGroup
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from img2tri.errors import ParameterError, finite, integer
from img2tri.options.option import every
from img2tri.options.parsing import number, whole_number

SOLVERS = (".msh", ".inp", ".bdf", ".xdmf", ".mesh", ".vtu", ".vtkhdf")


@dataclass(frozen=True)
class SaveOption:
    """An option of saving: how it is typed, and the suffixes that take it; none: all."""

    flag: str
    help: str
    suffixes: tuple[str, ...] = ()
    typed: dict[str, Any] = field(default_factory=dict)


SAVE_OPTIONS = {
    "height": SaveOption(
        "--height",
        "world units: write the closed solid from z = 0 to H, for printing; for solvers wedges; else flat",
        typed={"type": number, "metavar": "H"},
    ),
    "layers": SaveOption("--layers", "for solvers: layers of wedges, with --height", SOLVERS, {"type": whole_number, "metavar": "N"}),
    "order": SaveOption(
        "--order",
        "for solvers: 2 for quadratic elements (default 1)",
        SOLVERS,
        {"type": whole_number, "metavar": "1|2"},
    ),
    "cells": SaveOption("--cells", "for solvers: wedges or tetrahedra, with --height (default wedges)", SOLVERS, {"metavar": "C"}),
    "deck": SaveOption("--deck", "write an analysis that runs (.inp)", (".inp",), {"action": "store_true", "default": None}),
    "plane": SaveOption("--plane", "stress or strain (.inp; default stress)", (".inp",), {"metavar": "P"}),
    "version": SaveOption("--msh-version", "4.1 or 2.2 (.msh; default 4.1)", (".msh",), {"metavar": "V"}),
}


def add_save_options(group: _ArgumentGroup) -> None:
    """Add the options of saving."""
    for name, option in SAVE_OPTIONS.items():
        group.add_argument(option.flag, dest=name, help=option.help, **option.typed)


def save_options(arguments: Namespace, suffixes: Collection[str]) -> dict[str, dict[str, Any]]:
    """Return for each suffix the options its files are saved with.

    Raises
    ------
    ParameterError
        If an option cannot have its value, or none of the files takes it.
    """
    given = {name: value for name in SAVE_OPTIONS if (value := getattr(arguments, name)) is not None}
    if "height" in given:
        finite("height", given["height"], above=0)
    for name in ("layers", "order"):
        if name in given:
            integer(name, given[name], least=1)
    for name in ("layers", "cells"):
        if name in given and "height" not in given:
            raise ParameterError(f"{name}: expected with --height, which makes a solid, found none")
    for name in given:
        homes = SAVE_OPTIONS[name].suffixes
        if homes and not set(homes) & set(suffixes):
            raise ParameterError(f"{SAVE_OPTIONS[name].flag}: expected with a mesh that ends in {every(homes)}, found none")
    return {suffix: {n: v for n, v in given.items() if suffix in (SAVE_OPTIONS[n].suffixes or (suffix,))} for suffix in suffixes}
