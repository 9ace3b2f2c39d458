"""What the README says, holds: its Python runs, its test command is the one CI calls, its files exist."""

from __future__ import annotations

import re
import shlex
import textwrap
from pathlib import Path

import pytest

from img2tri.cli.program import main

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"

pytestmark = pytest.mark.skipif(not README.exists(), reason="only where the sources are checked out")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


def test_python_blocks_run(tmp_path, monkeypatch, capsys):
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    for block in blocks("python"):
        exec(compile(textwrap.dedent(block), "README.md", "exec"), {})
    assert "min_angle" in capsys.readouterr().out


def test_the_test_command_is_what_ci_calls():
    command = next(block.strip() for block in blocks("sh") if "pytest" in block)
    assert command in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_the_main_command_makes_its_files(tmp_path, monkeypatch, capsys):
    command = next(block.strip() for block in blocks("sh") if "img2tri mesh data" in block)
    words = shlex.split(command.split("&& .venv/bin/img2tri ")[1])
    (tmp_path / "out").mkdir()
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    assert main(words) == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"femur.stl", "femur.ply", "femur.vtu", "femur.png"}
    assert "min_angle" in capsys.readouterr().out


def test_links_lead_somewhere():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", README.read_text(encoding="utf-8")):
        assert (ROOT / target).exists(), target


def test_each_program_with_a_star_has_a_test():
    table = README.read_text(encoding="utf-8").partition("Which program takes what")[2].partition("## ")[0]
    starred = re.findall(r"(\w[\w-]*)(?: \*|\s*\*)", " ".join(line.split("|")[1] for line in table.splitlines() if line.startswith("| ")))
    assert len(starred) >= 18
    tests = " ".join(re.findall(r"def (test_\w+)", "".join(path.read_text() for path in (ROOT / "tests" / "views").rglob("test_*.py"))))
    assert [name for name in starred if name.lower().replace("-", "_") not in tests] == []
