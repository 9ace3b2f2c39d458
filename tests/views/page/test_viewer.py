"""The page in a browser: what is drawn, moved, clicked and typed. Run with  pytest -m tools."""

from __future__ import annotations

import json
import re
import time
from importlib.resources import files

import numpy as np
import pytest
from browser import browser
from views.page.test_html_page import GOOD, WRONG, made
from views.plates import cells, ring

import img2tri
from img2tri.triangles.tools.quality_summary import measure
from img2tri.types import Frame
from img2tri.views.figures.region_colours import palette
from img2tri.views.page.html_page import page

pytestmark = pytest.mark.tools
DRAWN = "document.getElementById('canvas').dataset.drawn"
TEXT = "document.getElementById('{}').textContent"


@pytest.fixture(scope="module")
def tab():
    with browser() as opened:
        yield opened


@pytest.fixture
def opened(tab, tmp_path):
    """Open a page by its text; afterwards the console has to be empty."""

    def show(text, fragment="", width=1400, height=1300):
        (tmp_path / "a.html").write_text(text, encoding="utf-8")
        tab.go("about:blank")
        tab.size(width, height)
        tab.go((tmp_path / "a.html").as_uri() + fragment)
        tab.until(DRAWN)
        return tab

    yield show
    assert tab.problems == []


def near(picture, colour, tolerance=12):
    return np.abs(picture - np.asarray(colour, int)).max(axis=2) <= tolerance


def viewer(tab):
    """What is seen of the viewer."""
    box = tab.run(
        "const b = document.getElementById('viewer').getBoundingClientRect(); return [b.top, b.bottom, b.left, b.right].map(Math.round)"
    )
    top, bottom, left, right = box
    return tab.shot()[max(top, 0) : bottom, left:right]


def real(image, **options):
    mesh = img2tri.mesh_image(image, **options)
    measured = measure(mesh.vertices, mesh.triangles, ["q", "min_angle"])
    return mesh, page(
        mesh.vertices, mesh.triangles, **measured, frame=mesh.frame, report=mesh.report.to_json(), regions=mesh.regions, image=image
    )


def test_the_mesh_is_where_it_should_be(opened):
    tab = opened(made(*ring(), report=WRONG, image=np.zeros((4, 4))), "#fill=region&image=0&edges=0")
    assert tab.run(f"return {DRAWN}") == "24"
    filled = near(viewer(tab), palette(1)[0])
    r, c = np.nonzero(filled)
    inside = filled[r.min() : r.max() + 1, c.min() : c.max() + 1]
    assert inside.shape[0] == pytest.approx(inside.shape[1], abs=6)
    assert inside.shape[0] > 300
    assert inside.mean() == pytest.approx(12 / 16, abs=0.05)  # a little is covered by the rings at places
    middle = slice(round(inside.shape[0] * 0.3), round(inside.shape[0] * 0.7))
    assert inside[middle, middle].mean() == 0
    # Places of warnings are marked in red, and one of them can be zoomed to.
    before = viewer(tab)
    assert near(before, (182, 50, 31)).sum() > 100
    tab.click("ol.warnings [data-place]")
    tab.until("!!window.performance && " + TEXT.format("readout") + ".includes('triangle')")
    time.sleep(0.3)
    assert not np.array_equal(viewer(tab), before)


def test_a_viewer_that_was_hidden_shows_the_mesh_again(opened):
    tab = opened(made(*ring(), image=np.zeros((4, 4))), "#edges=0")
    before = near(viewer(tab), 0.72 * palette(1)[0], 3).sum()
    assert before > 10_000
    for hide, show in (("display = 'none'", "display = ''"), ("width = 0", "width = ''")):
        tab.run(f"document.getElementById('viewer').style.{hide}")
        time.sleep(0.3)
        tab.run(f"document.getElementById('viewer').style.{show}")
        time.sleep(0.5)
        assert near(viewer(tab), 0.72 * palette(1)[0], 3).sum() == pytest.approx(before, rel=0.01)
        tab.run("document.getElementById('canvas').focus()")
        tab.keys("+")
        time.sleep(0.4)
        assert near(viewer(tab), 0.72 * palette(1)[0], 3).sum() > before
        tab.keys("0")
        time.sleep(0.4)


def test_the_page_has_a_dark_side_and_is_printed_light(opened):
    tab = opened(made(*ring(), image=np.zeros((4, 4))), "#theme=dark")
    picture = tab.shot()
    assert picture[:20, :20].mean() < 40
    assert near(picture, (228, 230, 233)).sum() > 100  # words are light
    tab.ask("/chromium/send_command", {"cmd": "Emulation.setEmulatedMedia", "params": {"media": "print"}})
    printed = tab.shot()
    tab.ask("/chromium/send_command", {"cmd": "Emulation.setEmulatedMedia", "params": {"media": ""}})
    assert printed[:20, :20].mean() == 255
    assert near(printed, (35, 40, 46)).sum() > 100  # words are dark


def test_on_a_phone_nothing_covers_anything_and_a_thumb_can_scroll(opened):
    tab = opened(made(*ring(), image=np.zeros((4, 4))), "#fill=angle", 390, 844)
    boxes = tab.run(
        "return ['tools', 'zoom', 'scale', 'readout', 'bar'].map(id => { const b = document.getElementById(id).getBoundingClientRect();"
        "return [b.left, b.top, b.right, b.bottom] })"
    )
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1], (a, b)
    assert tab.run("return document.documentElement.scrollWidth") <= 390
    assert tab.run("return getComputedStyle(document.getElementById('canvas')).touchAction") == "pan-y"
    assert tab.run("return document.getElementById('viewer').offsetHeight") <= 0.65 * 844
    small = tab.run(
        "return [...document.querySelectorAll('button, #fill label')]"
        ".filter(e => e.offsetParent && e.getBoundingClientRect().height < 24).length"
    )
    assert small == 0


def test_the_keyboard_alone_does_everything(opened):
    mesh, text = real(np.kron(np.eye(2, dtype=np.uint8), np.ones((40, 40), np.uint8)), edge_length=6, labels=True, background=None)
    tab = opened(text)
    tab.run("document.querySelector('[value=region]').focus()")
    tab.keys("Right")
    assert tab.run("return document.activeElement.value") == "quality"
    assert not tab.run("return document.getElementById('scale').hidden")
    tab.run("document.getElementById('canvas').focus()")
    worst = np.argsort(measure(mesh.vertices, mesh.triangles, ["min_angle"])["min_angle"], kind="stable")
    tab.keys("n")
    assert f"1 of the {min(200, len(worst))} worst" in tab.until(TEXT.format("readout"))
    assert f"triangle {worst[0]} " in tab.run(f"return {TEXT.format('readout')}")
    tab.keys("n", "p", "p")
    assert f"triangle {worst[min(199, len(worst) - 1)]} " in tab.run(f"return {TEXT.format('readout')}")
    # From bar to bar of a histogram; Enter chooses its triangles.
    tab.run("document.querySelector('#charts .hit').focus()")
    tab.keys("Right", "Enter")
    said = tab.run("return document.activeElement.querySelector('title').textContent")
    assert tab.run(f"return {TEXT.format('readout')}").split()[0] == re.search(r": ([\d,]+) tri", said)[1]
    tab.keys("Enter")
    assert tab.run("return document.querySelectorAll('.hit[aria-pressed]').length") == 0
    tab.run("document.querySelector('#regions button[data-region=\"1\"]').focus()")
    tab.keys("Enter")
    assert tab.run("return document.querySelector('tr[aria-selected=true]').dataset.region") == "1"


def test_every_bar_chooses_what_it_counts(opened):
    _, text = real(np.pad(np.ones((60, 90), np.uint8), 9), edge_length=5)
    tab = opened(text)
    counts = tab.run(
        "return [...document.querySelectorAll('.hit')].map(bar => { bar.dispatchEvent(new MouseEvent('click', { bubbles: true }));"
        "return [bar.querySelector('title').textContent, document.getElementById('readout').textContent] })"
    )
    assert len(counts) > 10
    assert all(re.search(r": ([\d,]+) tri", said)[1] == found.split()[0] for said, found in counts)


def test_many_regions_can_be_searched_and_ordered(opened):
    vertices, triangles = cells(np.ones((3, 10), bool))
    tab = opened(made(vertices, triangles, np.arange(60) // 2, names={7: "cortex"}, report={}))
    tab.type("#find", "cort")
    rows = "[...document.querySelectorAll('#regions tbody tr')]"
    assert tab.run(f"return {rows}.filter(row => !row.hidden).map(row => row.cells[0].textContent)") == ["cortex"]
    tab.run("const find = document.getElementById('find'); find.value = ''; find.dispatchEvent(new Event('input'))")
    names = tab.run(f"document.querySelector('[data-sort=\"0\"]').click(); return {rows}.map(row => row.cells[0].textContent)")
    assert names[0] == "cortex"
    assert names[1:] == [f"region_{i}" for i in range(30) if i != 7]


def test_a_place_is_seen_at_the_size_of_its_triangle(opened):
    # A sliver of a hundredth of the median edge: it fills a fifth of the view.
    vertices, triangles = cells(np.ones((20, 20), bool))
    sliver = np.array([[10.4, 20.6], [10.41, 20.6], [10.405, 20.6001]])
    vertices, triangles = np.concatenate([vertices, sliver]), np.concatenate([triangles, [len(vertices) + np.arange(3)]])
    report = GOOD | {"smallest_angle_at": sliver.mean(axis=0).tolist(), "hausdorff_at": None}
    tab = opened(made(vertices, triangles, report=report, frame=Frame((20, 20))))
    tab.click("#certificate [data-place]")
    assert f"triangle {len(triangles) - 1} " in tab.until(TEXT.format("readout"))
    assert len(tab.run(f"return {TEXT.format('readout')}")) > 20


def test_a_large_mesh_is_drawn_and_stored_in_a_third_of_its_size(opened):
    mesh, text = real(np.ones((600, 600), bool), edge_length=2.0)
    assert len(mesh.triangles) > 200_000
    assert len(text) < 0.4 * 4 / 3 * (16 * len(mesh.vertices) / 2 + 18 * len(mesh.triangles))  # base64 of float32, uint32, and two bytes
    tab = opened(text, "#fill=region&edges=0&image=0")
    tab.until(f"{DRAWN} === '{len(mesh.triangles)}'")
    time.sleep(0.5)
    filled = near(viewer(tab), palette(1)[0])
    r, c = np.nonzero(filled)
    assert filled[r.min() : r.max() + 1, c.min() : c.max() + 1].mean() > 0.97


@pytest.mark.parametrize("dark", [False, True])
def test_words_stand_out_from_what_is_behind_them(dark):
    style = files("img2tri.views.page").joinpath("page.css").read_text(encoding="utf-8")
    colours = {name: pair[dark] for name, *pair in re.findall(r"--([\w-]+): light-dark\((#\w+), (#\w+)\)", style)}

    def lightness(name):
        digits = colours[name].lstrip("#")[:6]
        digits = "".join(2 * digit for digit in digits) if len(digits) == 3 else digits
        values = np.array([int(digits[i : i + 2], 16) for i in (0, 2, 4)]) / 255
        return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]  # WCAG 2.2

    pairs = [(word, ground) for word in ("ink", "quiet", "accent", "good", "bad") for ground in ("paper", "card", "well")]
    pairs += [("good", "good-back"), ("bad", "bad-back"), ("on-accent", "accent")]
    for word, ground in pairs:
        dim, bright = sorted([lightness(word), lightness(ground)])
        if (word, ground) not in {("good", "well"), ("bad", "well")}:  # never beside each other
            assert (bright + 0.05) / (dim + 0.05) >= 4.5, (word, ground)


def test_the_report_is_plain_json_for_other_programs(opened):
    tab = opened(made(*ring(), report=GOOD))
    assert json.loads(tab.run(f"return {TEXT.format('report')}")) == GOOD
