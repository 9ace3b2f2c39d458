"""The constants of the rooms that make meshes: found in their source, and changed while a test runs."""

from __future__ import annotations

import ast
import importlib
import pkgutil
from functools import cache
from pathlib import Path
from types import FunctionType

import numpy as np

ROOMS = ("shapes", "triangles", "recipes", "certificate", "tiles")


@cache
def modules():
    rooms = [importlib.import_module(f"img2tri.{room}") for room in ROOMS]
    return [importlib.import_module(found.name) for room in rooms for found in pkgutil.walk_packages(room.__path__, f"{room.__name__}.")]


def is_number(value):
    """Tell a number, or several of them; switches are none."""
    if isinstance(value, tuple):
        return len(value) > 0 and all(map(is_number, value))
    return isinstance(value, int | float | complex | np.number | np.ndarray) and not isinstance(value, bool)


@cache
def constants():
    """The numbers with names in capitals at the top of modules: name -> module."""
    found = {}
    for module in modules():
        for statement in ast.parse(Path(module.__file__).read_text(encoding="utf-8")).body:
            targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
            names = [node.id for target in targets if target for node in ast.walk(target) if isinstance(node, ast.Name)]
            found |= {name: module.__name__ for name in names if name.isupper() and is_number(vars(module)[name])}
    return found


def changed(value, factor):
    return tuple(changed(one, factor) for one in value) if isinstance(value, tuple) else type(value)(value * factor)


def change(monkeypatch, name, factor):
    """Multiply a constant in all modules that have it, also where a function has it, no whole number, as a default."""
    old = getattr(importlib.import_module(constants()[name]), name)
    new = changed(old, factor)
    for module in modules():
        if name in vars(module):
            monkeypatch.setattr(module, name, new)
        for function in functions(module):
            defaults = function.__defaults__ or ()
            if not isinstance(old, int) and any(default is old for default in defaults):
                monkeypatch.setattr(function, "__defaults__", tuple(new if default is old else default for default in defaults))


def functions(module):
    """Those of a module and of its classes."""
    for owner in (module, *(thing for thing in vars(module).values() if isinstance(thing, type))):
        if owner is module or owner.__module__ == module.__name__:
            yield from (thing for thing in vars(owner).values() if isinstance(thing, FunctionType) and thing.__module__ == module.__name__)
