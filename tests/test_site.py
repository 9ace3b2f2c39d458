"""The pages of the site: their Python runs as it stands, and they are all to be reached. Built by  pytest -m slow tests/test_site.py."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGES = sorted(path for path in (ROOT / ".docs").rglob("*.rst") if "made" not in path.parts)

pytestmark = pytest.mark.skipif(not PAGES, reason="only where the sources are checked out")


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_the_python_of_a_page_runs(path, tmp_path, monkeypatch):
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    found = re.findall(r"\.\. code-block:: python\n\n((?:   .*\n|\n)+)", path.read_text(encoding="utf-8") + "\n")
    names = {}
    for block in found:
        exec(compile(textwrap.dedent(block), str(path), "exec"), names)


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path):
    if importlib.util.find_spec("sphinx_gallery") is None:
        pytest.skip("sphinx is not installed; pip install 'img2tri[docs]'")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", str(ROOT / ".docs"), str(tmp_path / "site")]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1800)
    assert run.returncode == 0, run.stderr[-4000:]
    for example in (ROOT / "examples").glob("[0-9]*.py"):
        page = (tmp_path / "site" / "made" / "gallery" / f"{example.stem}.html").read_text(encoding="utf-8")
        assert "sphx_glr" in page
    assert not re.findall(r'(?:src|href)="https?://(?!www\.sphinx|pydata|sphinx-gallery)[^"]*\.(?:js|css)', page)
