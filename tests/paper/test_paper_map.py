"""The maps of the paper, in its package and in the README, name functions that are there, in the order of the listing."""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest
from benchmarks import listing

import img2tri.paper

README = Path(__file__).parents[2] / "README.md"
PRINTED = [name for name, function in vars(listing).items() if inspect.isfunction(function) and function.__module__ == listing.__name__]


def in_the_readme():
    if not README.exists():
        pytest.skip("only where the sources are checked out")
    rows = re.findall(r"^\| .* \|$", README.read_text(encoding="utf-8").partition("## The paper")[2], re.MULTILINE)
    return "\n".join(rows)


@pytest.mark.parametrize("text", [lambda: img2tri.paper.__doc__, in_the_readme], ids=["package", "README"])
def test_all_functions_of_the_listing_are_named_and_lead_somewhere(text):
    names = re.findall(r"`([A-Za-z_.0-9]+)", text())
    assert sorted(set(PRINTED) - set(names)) == []
    places = [name for name in names if name.partition(".")[0] in ("raster", "triangles", "paper") and "." in name]
    assert len(places) >= len(PRINTED)
    for place in places:
        module, _, name = place.rpartition(".")
        if place != "paper.active_cells":
            assert callable(getattr(import_module(f"img2tri.{module}"), name)), place
