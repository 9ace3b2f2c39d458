"""The options of meshing on the command line, made from their entries in `img2tri.options`."""

from __future__ import annotations

import re
from argparse import SUPPRESS, ArgumentParser, BooleanOptionalAction
from typing import Any

from img2tri.options.all_options import GROUPS
from img2tri.options.option import Option


def add_mesh_options(parser: ArgumentParser) -> None:
    """Add the options of mesh_image. Those not given are not in the namespace: defaults are left to mesh_image."""
    about = "take the options from a report, or JSON of them; those typed beside it win"
    parser.add_argument("--options", metavar="REPORT", help=about)
    for heading, entries in GROUPS.items():
        group = parser.add_argument_group(heading, argument_default=SUPPRESS)
        for name, (_, option) in entries.items():
            group.add_argument(flag_of(name, option), dest=name, help=_help(name, option), **_kind(option))


def flag_of(name: str, option: Option) -> str:
    """Return how an option is called on the command line."""
    return option.flag or "--" + name.replace("_", "-")


def _kind(option: Option) -> dict[str, Any]:
    if isinstance(option.default, bool):
        return {"action": BooleanOptionalAction if option.default else "store_true"}
    return {"type": option.typed, "metavar": option.sign} | ({"action": "append"} if option.flag else {})


def _help(name: str, option: Option) -> str:
    """Return the words of an option as they are read on the command line.

    Examples
    --------
    >>> _help("corners", Option("auto", '"auto": as far as `min_angle` allows.'))
    'auto: as far as --min-angle allows (default auto)'
    """
    words = option.words.split("\n\n")[0].removesuffix(".")
    default = f": {option.none}" if option.none else f" {flag_of(name, option) if option.default is True else option.default}"
    default = "" if option.default is False else f" (default{default})"
    text = (words + default).replace('"', "").replace("%", "%%")
    return re.sub(r"`(\w+)`", lambda match: "--" + match[1].replace("_", "-"), text)
