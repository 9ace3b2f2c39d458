"""The app in a browser: every flow, by the keyboard too. Run with  pytest -m tools."""

from __future__ import annotations

import io
import json
import re
import time
import urllib.parse

import numpy as np
import pytest
from app.test_server import served
from browser import browser
from PIL import Image

import img2tri
from img2tri.options.all_options import load_options

pytest.importorskip("uvicorn")
pytestmark = pytest.mark.tools

GRAY = np.clip(250 - 3.5 * np.hypot(*np.mgrid[-80:80, -100:100] + 0.5), 0, 255).astype(np.uint8)
GRAINS = np.kron(np.arange(6, dtype=np.uint8).reshape(2, 3), np.ones((40, 40), np.uint8))
CANVAS = "document.getElementById('canvas').dataset"
TEXT = "document.getElementById('{}').textContent"


@pytest.fixture(scope="module")
def tab():
    with browser(1500, 1200) as opened:
        yield opened


@pytest.fixture
def app(tab, tmp_path):
    """Open the app with an image; afterwards the console has to be empty, and nobody but the app was asked."""
    Image.fromarray(GRAY).save(tmp_path / "gray.png")
    Image.fromarray(GRAINS).save(tmp_path / "grains.png")
    stack, addresses = [], []

    def start(*arguments, fragment=""):
        running = served(*arguments, folder=tmp_path)
        address, token = running.__enter__()
        stack.append(running)
        addresses.append(address)
        tab.go("about:blank")
        tab.size(1500, 1200)
        tab.go(f"{address}/?token={token}{fragment}")
        if arguments:
            settled(tab)
        return tab

    yield start
    asked = tab.run("return performance.getEntriesByType('resource').map(entry => entry.name)")
    assert all(name.startswith((addresses[-1], "blob:", "data:")) for name in asked), asked
    problems = tab.problems
    tab.go("about:blank")
    for running in stack:
        running.__exit__(None, None, None)
    assert problems == []


def settled(tab):
    """Wait until the last wish is shown and certified."""
    certified = f"{CANVAS}.certified && {CANVAS}.certified === {CANVAS}.shown"
    tab.until(f"{certified} && !{TEXT.format('verdict')}.includes('checking')")


def turned(tab, css, value):
    """Turn a knob as a hand does, and wait for its mesh."""
    before = tab.run(f"return {CANVAS}.shown")
    tab.run(
        "const e = document.querySelector(arguments[0]); e.value = arguments[1];"
        "for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind, { bubbles: true }))", css, value
    )  # fmt: skip
    tab.until(f"{CANVAS}.shown !== '{before}'")
    settled(tab)


def mesh_said(tab):
    """The mesh that the Python on the page makes."""
    said = {}
    exec(tab.run(f"return {TEXT.format('python')}"), {"img2tri": img2tri}, said)
    return said["mesh"]


def test_a_threshold_is_tinted_at_once_and_meshed_when_it_rests(app, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tab = app("gray.png")
    tab.run("const e = document.getElementById('levels'); e.value = 150; e.dispatchEvent(new Event('input', { bubbles: true }))")
    assert float(tab.run(f"return {CANVAS}.mask")) < 100
    picture = tab.shot()
    assert (np.abs(picture - (0.31 * 200 + 0.69 * np.array([64, 160, 224]))).max(axis=2) < 60).sum() > 3000  # tinted blue
    settled(tab)
    tab.until("document.getElementById('python').textContent.includes('threshold=150')")
    settled(tab)
    assert f"{len(mesh_said(tab).triangles):,}" in tab.run(f"return {TEXT.format('tiles')}")
    tab.click("#otsu")
    tab.until("!document.getElementById('python').textContent.includes('threshold')")


def test_edge_length_by_slider_by_number_and_by_count(app):
    tab = app("gray.png")
    turned(tab, "#length", "0.3")
    length = float(re.search(r"--edge-length ([\d.]+)", tab.run(f"return {TEXT.format('command')}"))[1])
    turned(tab, "[data-knob=edge_length]", "12")
    coarse = int(tab.run(f"return {TEXT.format('tiles')}").split("triangle")[0].replace(",", ""))
    assert length < 12
    turned(tab, "#count", "3 000")
    fine = int(tab.run(f"return {TEXT.format('tiles')}").split("triangle")[0].replace(",", ""))
    assert coarse < 1500 < fine == pytest.approx(3000, rel=0.15)
    turned(tab, "[data-knob=tolerance]", "1px")
    assert "--tolerance 1px" in tab.run(f"return {TEXT.format('command')}")


def test_regions_have_names_lengths_and_are_found_in_the_picture(app, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tab = app("grains.png")
    assert tab.run("return document.querySelectorAll('#part-list [data-on]:checked').length") == 5  # 0 is the background
    x, y = tab.run(
        "const b = document.getElementById('canvas').getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]"
    )
    tab.drag([(x, y + 60)])
    assert tab.run("return document.querySelector('#part-list [aria-selected=true]').dataset.label") == "4"
    turned(tab, "[data-name='4']", "bone")
    turned(tab, "[data-length='4']", "3")
    tab.run("document.querySelector(\"[data-on='0']\").click()")
    tab.until("document.getElementById('python').textContent.includes('background=None')")
    settled(tab)
    mesh = mesh_said(tab)
    assert mesh.names == {4: "bone"}
    assert set(mesh.regions) == set(range(6))
    sizes = np.bincount(mesh.regions)
    assert sizes[4] > 1.5 * sizes[1]
    assert "bone" in tab.run(f"return {TEXT.format('regions')}")


def test_two_settings_are_compared(app):
    tab = app("gray.png")
    tab.run("document.getElementById('compare').open = true")
    tab.click("#pin")
    turned(tab, "[data-knob=edge_length]", "10")
    rows = tab.run("return [...document.querySelectorAll('#both tr')].map(row => [...row.cells].map(cell => cell.textContent))")
    assert rows[0] == ["", "pinned", "now"]
    assert int(rows[1][1].replace(",", "")) > int(rows[1][2].replace(",", ""))
    tab.run("document.getElementById('canvas').focus()")
    before = tab.shot()
    tab.keys("]", "]", "]", "]")
    time.sleep(0.3)
    assert not np.array_equal(before, tab.shot())
    tab.click("#back")
    tab.until("!document.getElementById('python').textContent.includes('edge_length')")
    settled(tab)


def test_errors_of_the_library_appear_as_they_are(app):
    tab = app("gray.png")
    tab.run("document.getElementById('more').open = true")
    tab.run(
        "const e = document.querySelector('[data-knob=min_angle]'); e.value = '45'; e.dispatchEvent(new Event('change', { bubbles: true }))"
    )
    said = tab.until("!document.getElementById('complaint').hidden && document.getElementById('complaint').textContent")
    with pytest.raises(img2tri.ParameterError) as problem:
        img2tri.mesh_image(GRAY, min_angle=45.0)
    assert said == str(problem.value)
    turned(tab, "[data-knob=min_angle]", "25")
    assert tab.run("return document.getElementById('complaint').hidden")
    assert [line for line in tab.problems if "422" not in line] == []


def test_the_state_is_in_the_address(app):
    options = {"threshold": "120", "edge_length": "14"}
    tab = app("gray.png", fragment="#" + urllib.parse.urlencode({"options": json.dumps(options), "fill": "quality"}))
    assert tab.run(f"return {TEXT.format('command')}").endswith("--threshold 120 --edge-length 14")
    assert tab.run("return document.querySelector('[name=fill]:checked').value") == "quality"
    turned(tab, "[data-knob=edge_length]", "20")
    state = urllib.parse.parse_qs(tab.run("return location.hash.slice(1)"))
    assert json.loads(state["options"][0]) == {"threshold": "120", "edge_length": "20"}


def test_an_image_is_chosen_and_dropped(app, tmp_path):
    tab = app()
    assert "Drop an image" in tab.run(f"return {TEXT.format('drop')}")
    tab.type("#file", str(tmp_path / "grains.png"))
    settled(tab)
    assert tab.run(f"return {TEXT.format('title')}") == "grains.png"
    file = io.BytesIO()
    Image.fromarray(GRAY).save(file, "PNG")
    tab.run(
        "const t = new DataTransfer(); t.items.add(new File([new Uint8Array(arguments[0])], 'dropped.png'));"
        "document.getElementById('viewer').dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: t }))",
        list(file.getvalue()),
    )  # fmt: skip
    tab.until("document.getElementById('title').textContent === 'dropped.png'")
    settled(tab)
    assert not tab.run("return document.getElementById('level').hidden")


def test_files_are_saved_by_the_browser(app, tmp_path):
    tab = app("gray.png")
    (tmp_path / "saved").mkdir()
    tab.ask(
        "/chromium/send_command",
        {"cmd": "Browser.setDownloadBehavior", "params": {"behavior": "allow", "downloadPath": str(tmp_path / "saved")}},
    )
    tab.run("document.getElementById('saving').open = true")
    for kind in (".off", ".json", ".html"):
        tab.run("document.getElementById('format').value = arguments[0]", kind)
        tab.click("#save")
        end = time.monotonic() + 20
        while not (tmp_path / "saved" / f"gray{kind}").exists() and time.monotonic() < end:
            time.sleep(0.05)
    assert (tmp_path / "saved" / "gray.off").read_bytes()[:3] == b"OFF"
    assert "edge_length" in load_options(tmp_path / "saved" / "gray.json")
    for path in (tmp_path / "saved").iterdir():
        path.unlink()


def test_the_keyboard_reaches_and_turns_everything(app):
    tab = app("gray.png")
    tab.run(
        "document.querySelectorAll('#knobs details').forEach(d => { d.open = true }); document.body.tabIndex = -1; document.body.focus()"
    )
    reached = set()
    for _ in range(140):
        tab.keys("Tab")
        reached.add(
            tab.run("const e = document.activeElement; return e.id || e.dataset.knob || e.dataset.zoom || e.value || e.textContent")
        )
    wanted = {
        "file",
        "levels",
        "threshold",
        "otsu",
        "invert",
        "length",
        "edge_length",
        "count",
        "gradation",
        "pin",
        "format",
        "save",
        "canvas",
        "theme",
        "tolerance",
        "corners",
    }
    assert wanted <= reached, wanted - reached
    tab.run("document.getElementById('levels').focus()")
    tab.keys(*["Right"] * 12)
    tab.until("document.getElementById('python').textContent.includes('threshold=')")
    settled(tab)
