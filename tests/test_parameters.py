"""Every option of `mesh_image` over values it was never meant to have: an error that names it, or a mesh."""

from __future__ import annotations

import inspect
import math
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import specimens

from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError
from img2tri.pipeline import PaperOptions

pytest.importorskip("resource")
import children

IMAGE = specimens.disc(16, 6.0)
OPTIONS = [p for p in inspect.signature(mesh_image).parameters if p not in ("image", "paper", "progress")] + list(PaperOptions.__annotations__)

ODD = {
    "0": 0, "-1": -1, "1": 1, "0.0": 0.0, "-0.5": -0.5, "nan": math.nan, "inf": math.inf, "-inf": -math.inf, "1e-300": 1e-300,
    "5e-324": 5e-324, "1e300": 1e300, "2**31": 2**31, "2**63": 2**63, "-2**63": -(2**63), "2**64": 2**64, "10**400": 10**400,
    "10**5000": 10**5000,
    "''": "", "' '": " ", "'8 px'": "8 px", "' 8px'": " 8px", "'px'": "px", "'%'": "%", "'0px'": "0px", "'-1px'": "-1px",
    "'nanpx'": "nanpx", "'1e999px'": "1e999px", "'1e-999%'": "1e-999%", "'e'": "e", "'--1'": "--1", "'8px2'": "8px2", "'٣px'": "٣px",
    "'auto'": "auto", "'None'": "None", "'nul'": "nul\0", "b'8'": b"8", "bytearray": bytearray(b"8"), "None": None, "[]": [], "()": (),
    "{}": {}, "set()": set(), "[1]": [1], "[1, 2]": [1, 2], "[1, 'a']": [1, "a"], "[nan]*2": [math.nan, math.nan], "[[1, 2]]": [[1, 2]],
    "(0, 0)": (0, 0), "(1, -1)": (1, -1), "(2, 2, 10, 10)": (2, 2, 10, 10), "(10, 10, 2, 2)": (10, 10, 2, 2),
    "(nan,)*4": (math.nan,) * 4, "(-inf, 0, inf, 9)": (-math.inf, 0, math.inf, 9), "(1e300,)*4": (1e300,) * 4,
    "[None]": [None], "[True]": [True], "True": True, "False": False, "np.True_": np.True_, "np.False_": np.False_,
    "np.int8": np.int8(3), "np.uint64": np.uint64(2**64 - 1), "np.float32": np.float32(2.5), "np.float16 inf": np.float16(np.inf),
    "np.longdouble": np.longdouble(2), "np.array(3)": np.array(3), "np.array([])": np.array([]), "np.array([1])": np.array([1]),
    "np.array([1, 2])": np.array([1, 2]), "np.array(['a', 'b'])": np.array(["a", "b"]), "np.array of the image": np.full((16, 16), 3.0),
    "np.array of the image, nan": np.full((16, 16), math.nan), "np.array of the image, 0": np.zeros((16, 16)),
    "np.array of the image, 1e-300": np.full((16, 16), 1e-300),
    "np.array of the image, words": np.full((16, 16), "a"), "np.str_": np.str_("8px"),
    "complex": 1 + 2j, "Decimal": Decimal("2.5"), "Decimal nan": Decimal("nan"), "Decimal snan": Decimal("snan"), "Fraction": Fraction(5, 2),
    "Path": Path("x"), "object": object(), "type": int, "{1: 3}": {1: 3}, "{1: '3px'}": {1: "3px"}, "{1: nan}": {1: math.nan},
    "{7: 3}": {7: 3}, "{'a': 3}": {"a": 3}, "{1: None}": {1: None}, "{1: 'bone'}": {1: "bone"}, "{1: ''}": {1: ""},
    "datetime64": np.datetime64("2020-01-01"), "range(2)": range(2), "range(10**12)": range(10**12),
}  # fmt: skip
RECIPE = {name: "unstructured" for name in PaperOptions.__annotations__} | {"step": "structured"}


def mesh_with(case):
    """Mesh a small disc with one option, told by the names of both."""
    import warnings

    option, odd = case
    warnings.simplefilter("error")
    options = {"recipe": RECIPE[option]} if option in RECIPE else {}
    image = IMAGE.astype(bool)
    if option in RECIPE:
        image = np.where(IMAGE, 255, 0).astype(np.uint8)
    mesh = mesh_image(image, **{option: ODD[odd]}, **options)
    mesh.report.to_json()
    return f"{len(mesh.triangles)} triangles, kept {mesh.report.kept}"


CASES = [(option, odd) for option in OPTIONS for odd in ODD]
