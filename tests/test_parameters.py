"""Every option of `mesh_image` over values it was never meant to have: an error that names it, or a mesh."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import specimens

from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError
from img2tri.options import OPTIONS
from img2tri.options.paper_options import PaperOptions

pytest.importorskip("resource")
import children

IMAGE = specimens.disc(16, 6.0)

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
    "complex": 1 + 2j, "Decimal": Decimal("2.5"), "Decimal nan": Decimal("nan"), "Decimal snan": Decimal("snan"),
    "Fraction": Fraction(5, 2),
    "Path": Path("x"), "object": object(), "type": int, "{1: 3}": {1: 3}, "{1: '3px'}": {1: "3px"}, "{1: nan}": {1: math.nan},
    "{7: 3}": {7: 3}, "{'a': 3}": {"a": 3}, "{1: None}": {1: None}, "{1: 'bone'}": {1: "bone"}, "{1: ''}": {1: ""},
    "datetime64": np.datetime64("2020-01-01"), "range(2)": range(2), "range(10**12)": range(10**12),
}  # fmt: skip
RECIPE = dict.fromkeys(PaperOptions.__annotations__, "unstructured") | {"step": "structured"}


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

# One that none of the options can be; all others are tried by  pytest -m slow.
QUICK = ("0", "-1", "nan", "inf", "1e-300", "1e300", "2**64", "10**5000", "''", "'8 px'", "b'8'", "[]", "True", "object")
QUICK += ("np.array([1, 2])", "np.array(3)", "range(10**12)")


def sweep(cases):
    outcomes = children.run("test_parameters:mesh_with", cases, memory=3 * children.GIGABYTE)
    wrong = {}
    for (option, odd), outcome in zip(cases, outcomes, strict=True):
        # What is refused names the option first.
        named = outcome.kind == "done" or (outcome.kind == "refused" and option in outcome.text)
        if not named:
            wrong[option, odd] = outcome
    assert not wrong, f"{len(wrong)}: {dict(list(wrong.items())[:5])}"
    return dict(zip(cases, outcomes, strict=True))


def test_no_value_of_an_option_is_met_with_anything_but_its_name_or_a_mesh():
    outcomes = sweep([case for case in CASES if case[1] in QUICK])
    for option in OPTIONS:
        assert outcomes[option, "object"].kind == "refused", option
        assert outcomes[option, "b'8'"].kind == "refused", option
        assert outcomes[option, "np.array([1, 2])"].kind == "refused" or option in ("spacing", "origin", "threshold", "colors", "absorb"), (
            option
        )


@pytest.mark.slow
def test_no_value_of_an_option_is_met_with_anything_but_its_name_or_a_mesh_of_all():
    sweep(CASES)


@pytest.mark.parametrize("option", ["invert", "keep_area", "largest"])
@pytest.mark.parametrize("odd", ["no", 0, None, np.array([True])])
def test_words_and_numbers_are_no_flags(option, odd):
    with pytest.raises(ParameterError, match=rf"^{option}: expected True or False, found"):
        mesh_image(IMAGE, **{option: odd})


@pytest.mark.parametrize("edge_length", [1e-4, "0.001px", 1e-300, np.full((16, 16), 1e-4), {1: 1e-4}, lambda p: np.full(len(p), 1e-4)])
@pytest.mark.parametrize("recipe", ["conforming", "unstructured"])
def test_lengths_that_would_fill_the_memory_are_refused_at_once(edge_length, recipe):
    with pytest.raises(ParameterError, match=r"edge_length: expected at most [\d,]+ triangles"):
        mesh_image(IMAGE * 255, threshold=100, edge_length=edge_length, recipe=recipe)


@pytest.mark.parametrize("min_area", [1e300, 1000])
def test_all_removed_as_too_small(min_area):
    with pytest.raises(ImageError, match="min_area="):
        mesh_image(IMAGE.astype(bool), min_area=min_area)


@pytest.mark.parametrize("origin", [(1e17, 0), (0, -1e300)])
def test_places_beyond_the_numbers_are_refused(origin):
    with pytest.raises(ParameterError, match=r"^origin: "):
        mesh_image(IMAGE.astype(bool), origin=origin)


@pytest.mark.parametrize("options", [
    {"gradation": 0.001}, {"gradation": 10}, {"min_angle": 32}, {"spacing": 1e-12}, {"spacing": 1e12}, {"spacing": 1e-90},
    {"spacing": 1e90}, {"tolerance": 1e6}, {"edge_length": 1e6}, {"edge_length": 0.3}, {"origin": (1e9, -1e9)},
    {"elements_across": 50}, {"segments_per_turn": 1e4}, {"boundary_edge_length": 1e-200},
])  # fmt: skip
def test_extremes_keep_every_promise(options):
    assert mesh_image(specimens.disc(30, 11.0).astype(bool), **options).report.kept


@pytest.mark.parametrize("spacing", [(1, 10), (10, 1), (1, 100), (100, 1)])
def test_flat_pixels_end_and_stay_valid(spacing):
    import oracles

    mesh = mesh_image(specimens.disc(24, 9.0).astype(bool), spacing=spacing)
    oracles.check_valid(mesh.vertices / spacing, mesh.triangles)
    assert mesh.report.topology[1]["found"] == (1, 0)


def test_a_tolerance_that_cannot_be_kept_is_in_the_report():
    report = mesh_image(specimens.disc(30, 11.0).astype(bool), tolerance=1e-6).report
    assert report.kept or all("apart at" in line for line in report.warnings)
