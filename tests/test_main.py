"""``python -m img2tri`` is the command line."""

from __future__ import annotations

import runpy
import sys

import pytest

import img2tri


@pytest.mark.parametrize(("arguments", "status"), [(["--version"], 0), (["mesh"], 2)])
def test_the_module_runs_the_command_line(arguments, status, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["img2tri", *arguments])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("img2tri", run_name="__main__")
    assert ended.value.code == status
    told = capsys.readouterr()
    assert (img2tri.__version__ in told.out) if status == 0 else ("img2tri mesh" in told.err)


def test_it_can_be_imported_without_running():
    assert callable(runpy.run_module("img2tri.__main__", run_name="img2tri.__main__")["main"])
