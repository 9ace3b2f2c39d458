"""Every example runs, quietly correct: a number of each is asserted."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


def run(name, out):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.main(out)


def test_one_call(tmp_path):
    found = run("01_one_call", tmp_path)
    assert found["min_angle"] >= 30
    assert found["q_mean"] > 0.95
    assert found["hausdorff"] <= 0.25  # half of a pixel of 0.5
    assert (tmp_path / "femur.png").stat().st_size > 10_000


def test_extrude_to_stl(tmp_path):
    found = run("03_extrude_to_stl", tmp_path)
    assert found["watertight"]
    assert found["width"] == pytest.approx(40, abs=0.1)
    assert found["height"] == pytest.approx(6)
    assert found["volume_over_area"] == pytest.approx(6)
