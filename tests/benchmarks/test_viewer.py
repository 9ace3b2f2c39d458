"""How quickly the viewer follows a hand, in headless Chromium without a graphics card.

    pytest -m benchmark -s tests/benchmarks/test_viewer.py

Prints milliseconds, medians; what they should be stands beside them. Nothing here fails for being slow: the machine may be busy.
"""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from app.test_app_in_browser import CANVAS
from app.test_server import served
from benchmarks.shapes import blob
from browser import browser
from PIL import Image
from scipy.ndimage import gaussian_filter

import img2tri

pytest.importorskip("uvicorn")
pytestmark = pytest.mark.benchmark

TURN = """
const knob = document.querySelector(arguments[0]), before = document.getElementById('canvas').dataset.shown;
knob.value = arguments[1];
for (const kind of ['input', 'change']) knob.dispatchEvent(new Event(kind, { bubbles: true }));
return before
"""
TINT = """
const e = document.getElementById('levels');
e.value = arguments[0];
e.dispatchEvent(new Event('input', { bubbles: true }));
"""
PAN = """
const viewer = document.getElementById('canvas'), box = viewer.getBoundingClientRect(), frames = [];
const at = (type, i) => viewer.dispatchEvent(new PointerEvent(type, { pointerId: 1, bubbles: true, isPrimary: true,
  clientX: box.left + box.width / 2 + 60 * Math.sin(i / 6), clientY: box.top + box.height / 2 + 40 * Math.sin(i / 4) }));
viewer.setPointerCapture = () => {};
return new Promise(done => {
  at('pointerdown', 0);
  let i = 0, last = performance.now();
  const step = now => {
    frames.push(now - last); last = now;
    at('pointermove', ++i);
    if (i < 60) requestAnimationFrame(step); else { at('pointerup', i); done(frames.slice(2).sort((a, b) => a - b)); }
  };
  requestAnimationFrame(step);
});
"""


def row(what, value, wanted):
    print(f"{what:<52}{value:>9.1f}{wanted:>9}", flush=True)


@pytest.fixture(scope="module")
def tab():
    with browser(1400, 1000) as opened:
        print(f"\n{'':<52}{'ms':>9}{'at most':>9}")
        yield opened


@pytest.mark.parametrize(("size", "knob", "mask", "certificate"), [(512, 100, 20, 300), (2048, 300, 20, 1000)])
def test_from_knob_to_picture(tab, tmp_path, size, knob, mask, certificate):
    image = gaussian_filter(255.0 * blob(size), 2).astype(np.uint8)
    Image.fromarray(image).save(tmp_path / "a.png")
    start = time.monotonic()
    with served("a.png", folder=tmp_path) as (address, token):
        tab.go(f"{address}/?token={token}")
        tab.until(f"{CANVAS}.shown")
        row(f"{size} x {size}: from the command to the first mesh", 1000 * (time.monotonic() - start), 1500)
        tab.until(f"{CANVAS}.certified === {CANVAS}.shown")
        times, certified = [], []
        for length in (8, 9, 10, 11, 12):
            before = tab.run(TURN, "[data-knob=edge_length]", str(length))
            tab.until(f"{CANVAS}.shown !== '{before}'")
            shown = time.monotonic()
            times.append(float(tab.run(f"return {CANVAS}.took")))
            tab.until(f"{CANVAS}.certified === {CANVAS}.shown")
            certified.append(1000 * (time.monotonic() - shown))
        row(f"{size} x {size}: knob to picture", float(np.median(times)), knob)
        row(f"{size} x {size}: certificate, after the rest of 250", float(np.median(certified)), certificate + 250)
        tinted = []
        for level in range(90, 130, 5):
            tab.run(TINT, level)
            tinted.append(float(tab.run(f"return {CANVAS}.mask")))
        row(f"{size} x {size}: mask", float(np.median(tinted)), mask)
        tab.until(f"{CANVAS}.certified === {CANVAS}.shown")
        tab.go("about:blank")


@pytest.mark.parametrize(("size", "length"), [(512, 8), (2048, 8), (4096, 6)])
def test_a_frame_of_panning(tab, tmp_path, size, length):
    mask = blob(size)
    mesh = img2tri.mesh_image(mask, edge_length=length)
    mesh.save(tmp_path / "a.html", image=mask)
    tab.go((tmp_path / "a.html").as_uri())
    tab.until(f"{CANVAS}.drawn")
    time.sleep(1)
    frames = tab.run(PAN)
    size_of_page = (tmp_path / "a.html").stat().st_size
    row(f"{len(mesh.triangles):,} triangles, {size_of_page / 1e6:.2f} MB: a frame of panning", frames[len(frames) // 2], 20)
    assert json.dumps(frames)
