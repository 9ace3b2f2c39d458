"""How meshes are saved, as typed on the command line: for each option of `TriangleMesh.save` the formats that take it."""

from __future__ import annotations

from argparse import Namespace, _ArgumentGroup
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from img2tri.errors import ParameterError, finite, integer
from img2tri.options.option import every
from img2tri.options.parsing import height_by_label, name_and_file, number, whole_number

SURFACES = (".stl", ".ply", ".obj", ".off", ".3mf", ".glb", ".vtp", ".vtu")
WITH_ARRAYS = (".ply", ".vtp", ".msh", ".xdmf", ".vtu", ".vtkhdf")
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
        "world units: write the closed solid from z = 0 to H, for printing; for solvers wedges; else flat; H is one for all, or, for "
        "printing, of each region, as in 1=2,2=5",
        typed={"type": height_by_label, "metavar": "H"},
    ),
    "base": SaveOption(
        "--base",
        "world units, for printing, with --height: a plate below that joins loose parts; the solid stands on it",
        SURFACES,
        {"type": number, "metavar": "T"},
    ),
    "layers": SaveOption("--layers", "for solvers: layers of wedges, with --height", SOLVERS, {"type": whole_number, "metavar": "N"}),
    "order": SaveOption(
        "--order",
        "for solvers: 2 for quadratic elements (default 1)",
        SOLVERS,
        {"type": whole_number, "metavar": "1|2"},
    ),
    "cells": SaveOption("--cells", "for solvers: wedges or tetrahedra, with --height (default wedges)", SOLVERS, {"metavar": "C"}),
    "data": SaveOption(
        "--data",
        "another image on the same grid, whose mean over each triangle is written as an array of that name; {stem} as in names of files; "
        "may be given several times",
        WITH_ARRAYS,
        {"type": name_and_file, "metavar": "NAME=IMAGE", "action": "append"},
    ),
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
    heights = given.get("height", {})
    for label, value in heights.items() if isinstance(heights, dict) else [(None, heights)]:
        finite("height" if label is None else f"height of {label}", value, above=0)
    if heights and isinstance(heights, dict) and set(suffixes) & set(SOLVERS) - set(SURFACES):
        raise ParameterError("height: expected one for solvers, found one for each region, which makes closed surfaces for printing")
    if "data" in given:
        given["data"] = dict(given["data"])
    if "base" in given:
        finite("base", given["base"], above=0)
    for name in ("layers", "order"):
        if name in given:
            integer(name, given[name], least=1)
    for name in ("layers", "cells", "base"):
        if name in given and "height" not in given:
            raise ParameterError(f"{name}: expected with --height, which makes a solid, found none")
    for name in given:
        homes = SAVE_OPTIONS[name].suffixes
        if homes and not set(homes) & set(suffixes):
            raise ParameterError(f"{SAVE_OPTIONS[name].flag}: expected with a mesh that ends in {every(homes)}, found none")
    return {suffix: {n: v for n, v in given.items() if suffix in (SAVE_OPTIONS[n].suffixes or (suffix,))} for suffix in suffixes}


def of_image(given: dict[str, Any], stem: str) -> dict[str, Any]:
    """Return the options of saving for an image, with its stem in place of ``{stem}``."""
    if "data" not in given:
        return given
    return {**given, "data": {name: path.replace("{stem}", stem) for name, path in given["data"].items()}}
