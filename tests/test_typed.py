"""A user's type checker sees our types: the package says that it has some, and mypy finds them."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest
from children import PATIENCE

import img2tri

SCRIPT = """
from img2tri import Report, TriangleMesh, mesh_image

mesh: TriangleMesh = mesh_image("slice.png", edge_length=8, labels=[1, 4], names={1: "bone"})
report: Report = mesh.report
kept: bool = report.kept
report.kapt
mesh_image("slice.png", edge_lenth=8)
mesh_image("slice.png", recipe=7)
mesh_image("slice.png", min_angle="25")
"""
ERRORS = {7: "attr-defined", 8: "call-arg", 9: "arg-type", 10: "arg-type"}  # by line


def test_the_package_says_that_it_is_typed():
    assert files("img2tri").joinpath("py.typed").is_file()


def test_mypy_of_a_user_sees_our_types(tmp_path):
    """In an environment where only the checkout is installed, so that mypy has little to read, and without our settings."""
    mypy = shutil.which("mypy", path=f"{Path(sys.executable).parent}:{Path(sys.exec_prefix) / 'bin'}")
    if mypy is None:
        pytest.skip("mypy is not installed")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "env"], check=True, timeout=PATIENCE)
    python = tmp_path / "env" / "bin" / "python"
    ask = [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    site = subprocess.run(ask, capture_output=True, text=True, check=True, timeout=PATIENCE).stdout.strip()
    Path(site, "img2tri.pth").write_text(str(Path(img2tri.__file__).parents[1]), encoding="utf-8")
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    command = [mypy, "--strict", "--python-executable", str(python), "--config-file", "", "script.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=PATIENCE)
    told = re.findall(r"^script.py:(\d+): error: .*\[([a-z-]+)\]$", done.stdout, re.MULTILINE)
    assert {int(line): kind for line, kind in told} == ERRORS, done.stdout + done.stderr
