from __future__ import annotations

import base64
import io
import json
import re
import zlib
from html.parser import HTMLParser

import numpy as np
import pytest
from oracles import angles
from PIL import Image
from views.plates import ring, strip

import img2tri
from img2tri.errors import MeshError, ParameterError
from img2tri.types import Frame
from img2tri.views.figures.image_png import png
from img2tri.views.figures.region_colours import palette
from img2tri.views.page import html_tables as tables
from img2tri.views.page.histogram_svg import chart
from img2tri.views.page.html_page import page

GOOD = {
    "recipe": "conforming",
    "settings": {"edge_length": 1.0, "tolerance": 0.5, "note": "</script><script>alert(1)</script> <b> & ü"},
    "counted": {"rounds": 1},
    "hausdorff": 0.25,
    "hausdorff_at": [1.5, 2.5],
    "tolerance": 0.5,
    "areas": {"1": {"mesh": 12.0, "image": 12.0, "error": -0.0001}},
    "topology": {"1": {"found": [1, 1], "expected": [1, 1]}},
    "neighbours_missing": [],
    "neighbours_extra": [],
    "unknown_labels": [],
    "wrong_pixels": 0,
    "wrong_pixels_at": [],
    **dict.fromkeys(tables._DEFECTS, 0),
    "smallest_angle": 45.0,
    "smallest_angle_at": [0.5, 0.5],
    "min_angle": 30.0,
    "narrow": 0,
    "narrow_at": [],
    "warnings": [],
}
WRONG = GOOD | {
    "hausdorff": 0.75,
    "topology": {"1": {"found": [1, 0], "expected": [1, 1]}},
    "wrong_pixels": 7,
    "wrong_pixels_at": [[3.0, 1.0], [3.0, 2.0]],
    "pinched_vertices": 2,
    "narrow": 2,
    "narrow_at": [[0.5, 0.5], [2.25, -1e-05]],
    "smallest_angle": 21.0,
    "warnings": [
        "pinched_vertices: 2",
        "label 1: 1 component with 0 holes, expected 1 with 1",
        "outline and mesh are 0.75 apart at (1.5, 2.5), tolerance 0.5",
        "7 pixel centres lie in a wrong region, the first at (3.0, 1.0)",
        "2 triangles below 30 degrees, the worst 21 at (0.5, 0.5)",
    ],
}
VOID = {"meta", "br", "hr", "img", "input", "link"}


class Elements(HTMLParser):
    """Elements, their attributes and texts; complains where one is not closed in order."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.all = [], []
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        assert len(dict(attrs)) == len(attrs), f"an attribute twice in {tag}"
        self.all.append((tag, dict(attrs), []))
        if tag not in VOID:
            self.open.append((tag, self.all[-1]))

    def handle_startendtag(self, tag, attrs):
        self.all.append((tag, dict(attrs), []))

    def handle_endtag(self, tag):
        assert self.open, f"{tag} was not open"
        assert self.open[-1][0] == tag, f"{tag} closed, {self.open[-1][0]} open"
        self.open.pop()

    def handle_data(self, data):
        for _, element in self.open:
            element[2].append(data)

    def find(self, tag, **attributes):
        return [(attrs, "".join(texts)) for name, attrs, texts in self.all if name == tag and attributes.items() <= attrs.items()]

    def by_id(self, name):
        (found,) = ((attrs, "".join(texts)) for _, attrs, texts in self.all if attrs.get("id") == name)
        return found


def made(vertices, triangles, regions=None, report=GOOD, **options):
    worst = angles(vertices, triangles)
    q = 8 * np.sin(np.radians(worst) / 2).prod(axis=1)
    options = {"frame": Frame((4, 4)), "report": json.dumps(report), **options}
    return page(vertices, triangles, q=q, min_angle=worst.min(axis=1), regions=regions, **options)


def unpacked(elements):
    """The head of the mesh in a page, and its arrays."""
    data = zlib.decompress(base64.b64decode(elements.by_id("mesh")[1]))
    size = int.from_bytes(data[:4], "little")
    head, at, arrays = json.loads(data[4 : 4 + size]), -(-(4 + size) // 8) * 8, {}
    for name, kind, length in head["arrays"]:
        arrays[name] = np.frombuffer(data, "<" + kind, length, at)
        at += -(-arrays[name].nbytes // 8) * 8
    assert at == len(data)
    return head["view"], arrays


def test_the_page_is_well_formed_and_fetches_nothing():
    text = made(*ring(), image=np.eye(4), report=WRONG, title="a <b> & c.png", command="img2tri view-report 'a <b> & c.png'")
    elements = Elements(text)
    assert re.findall(r"https?:", text) == []
    assert not [attrs for _, attrs, _ in elements.all if {"src", "href", "srcset", "action"} & attrs.keys()]
    assert not re.findall(r"@import|url\(|import\(|fetch\(|XMLHttpRequest|WebSocket", text)
    ((policy, _),) = [found for found in elements.find("meta") if found[0].get("http-equiv") == "Content-Security-Policy"]
    assert policy["content"].startswith("default-src 'none'; img-src data: blob:;")
    ids = [attrs["id"] for _, attrs, _ in elements.all if "id" in attrs]
    assert len(ids) == len(set(ids))
    assert not re.findall(r"@\w+@", text)
    assert elements.find("h1")[0][1] == "a <b> & c.png"
    assert elements.by_id("command")[1] == "img2tri view-report 'a <b> & c.png'"
    # Everything the script asks for is there.
    assert set(re.findall(r'\$\("(\w+)"\)', elements.find("script")[-1][1])) - {"picture"} <= set(ids)


def test_the_certificate_is_in_the_page_word_for_word():
    elements = Elements(made(*ring(), report=GOOD))
    attrs, text = elements.by_id("report")
    assert attrs["type"] == "application/json"
    assert json.loads(text) == GOOD
    assert "alert(1)" not in "".join(script for found, script in elements.find("script") if "type" not in found)
    assert "</script>" not in text


def test_the_arrays_are_the_mesh():
    vertices, triangles, regions = strip()
    frame = Frame((3, 5), spacing=(0.5, 1.0), corner=(-1.0, 0.25))
    elements = Elements(made(vertices, triangles, regions, frame=frame, image=np.zeros((3, 5)), names={7: "bone"}, unit="mm"))
    rows, columns = frame.row_column(vertices)
    view, found = unpacked(elements)
    xy = found["vertices"].reshape(-1, 2)
    assert xy == pytest.approx(np.stack([columns, rows * 2], axis=1), abs=1e-6)  # one unit is the smaller side of a pixel
    assert np.array_equal(found["triangles"].reshape(-1, 3), triangles)
    assert np.array_equal(np.array([3, 7])[found["regions"]], regions)
    assert len(found["borders"]) == 2 * (14 + 1)
    angle = angles(vertices, triangles).min(axis=1)
    assert np.all(np.abs(found["angle"] + 0.5 - angle / 60 * 50) <= 0.5 + 1e-9)  # the bar it is counted in
    assert len(found["quality"]) == len(triangles)
    assert {array.dtype.itemsize for name, array in found.items() if name != "vertices"} == {1}
    assert np.all(np.diff(angle[view["worst"]]) >= 0)
    assert sorted(view["worst"]) == list(range(len(triangles)))
    assert view["size"] == [5, 6]
    assert (view["corner"], view["pixel"], view["upward"], view["unit"]) == ([-1.0, 0.25], 0.5, True, "mm")
    assert [(region["label"], region["name"]) for region in view["regions"]] == [(3, "region_3"), (7, "bone")]
    assert view["regions"][0]["colour"] == "#{:02x}{:02x}{:02x}".format(*palette(2)[0])
    assert view["box"] == pytest.approx([*xy.min(axis=0), *xy.max(axis=0)])


def test_the_image_is_in_the_page_or_not():
    gray = np.arange(12).reshape(3, 4)
    elements = Elements(made(*ring(), image=gray))
    with Image.open(io.BytesIO(base64.b64decode(elements.by_id("picture")[1]))) as read:
        assert np.array_equal(np.asarray(read), np.round(gray / 11 * 255).astype(np.uint8))
    assert "picture" not in {attrs.get("id") for _, attrs, _ in Elements(made(*ring())).all}
    large = Elements(made(*ring(), image=np.zeros((9000, 2))))
    with Image.open(io.BytesIO(base64.b64decode(large.by_id("picture")[1]))) as read:
        assert read.size == (1, 3000)  # thinned out alike in both directions


@pytest.mark.parametrize(
    "image",
    [
        np.array([[True, False]]),
        np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8),
        np.random.default_rng(0).integers(0, 256, (5, 7, 4), np.uint8),
        np.random.default_rng(0).integers(0, 65536, (5, 7, 3), np.uint16),
        np.random.default_rng(0).random((5, 7, 3)),
        np.array([[np.nan, 0.0, 2.0]]),
        np.full((2, 2), 7),
    ],
)
def test_a_png_is_read_by_pillow(image):
    with Image.open(io.BytesIO(png(image))) as read:
        read.load()
        found = np.asarray(read)
    scale = {"u1": 1, "u2": 255 / 65535}.get(image.dtype.str[1:], 255)
    if image.ndim == 3:
        assert found == pytest.approx(image * scale, abs=0.51)
    else:
        finite = np.nan_to_num(image.astype(float))
        assert found == pytest.approx(255 * (finite - finite.min()) / (np.ptp(finite) or 1), abs=0.51)


def rows(text):
    """Rows of the certificate: words -> found, promised, mark, place."""
    elements = Elements(text)
    found = {}
    start = text.index("<table>", text.index("<h2>Certificate</h2>"))
    for row in re.findall(r"<tr>(.*?)</tr>", text[start : text.index("</table>", start)]):
        cells = re.findall(r"<td[^>]*>(.*?)</td>", row)
        place = re.search(r'data-place="(\d+)"', row)
        kind = re.search(r'class="mark (\w+)"', row)[1]
        found[cells[0]] = (re.sub("<.*?>", "", cells[1]), cells[2], kind, int(place[1]) if place else None)
    assert elements
    return found


def test_a_kept_promise_has_a_green_mark():
    text = made(*ring(), report=GOOD)
    found = rows(text)
    assert len(found) == 3 + 3 + 6 + 2
    assert {mark for *_, mark, _ in found.values()} == {"good"}
    assert found["Outlines and mesh apart"][:2] == ("0.25", "≤ 0.5")
    assert found["Smallest angle"][:2] == ("45.00°", "≥ 30°")
    assert found["Areas off at most"][:2] == ("0.010 %", "≤ 1 %")
    assert "every promise kept" in text
    assert "<h2>Warnings</h2>" not in text


def test_a_broken_promise_has_a_red_mark_and_its_place():
    text = made(*ring(), report=WRONG)
    found, (view, _) = rows(text), unpacked(Elements(text))
    bad = {words for words, (*_, mark, _) in found.items() if mark == "bad"}
    assert bad == {
        "Outlines and mesh apart", "Pixel centres on a wrong side", "Components and holes", "Pinched vertices", "Smallest angle",
        "Triangles below 30°",
    }  # fmt: skip
    places = view["places"]
    assert [(p["x"], p["y"]) for p in places] == [(1.5, 1.5), (3, 3), (0.5, 3.5), (3, 2), (2.25, 4.00001)]  # y down
    assert [(p["number"], p["first"]) for p in places] == [(3, True), (4, True), (5, True), (4, False), (5, False)]
    for words, place in (("Outlines and mesh apart", 0), ("Pixel centres on a wrong side", 1), ("Smallest angle", 2)):
        assert found[words][3] == place
    assert "5 warnings" in text
    listed = re.search(r'<ol class="warnings">(.*?)</ol>', text)[1]
    assert re.findall(r'data-place="(\d+)"', listed) == ["0", "1", "2"]
    assert [line for line in WRONG["warnings"] if tables.text(line) not in listed] == []


def test_without_promises_there_are_no_marks_for_them():
    found = rows(made(*ring(), report=GOOD | {"tolerance": None, "min_angle": None, "recipe": "structured"}))
    assert found["Outlines and mesh apart"][1:3] == ("", "none")
    assert found["Smallest angle"][1:3] == ("", "none")
    assert found["Areas off at most"][1:3] == ("", "none")
    assert "Triangles below 30°" not in found


def test_without_a_certificate_nothing_is_said_about_promises():
    text = made(*ring(), report={})
    assert "There is no image to judge this mesh by." in text
    assert 'class="chip' not in text
    assert "24</b><span>triangles" in text


def test_a_wanted_edge_length_may_be_words():
    text = made(*ring(), report=GOOD | {"settings": {"edge_length": "1=4, 2=<8px>"}})
    assert "<b>1=4, 2=&lt;8px&gt;</b><span>wanted edge length" in text


def test_places_are_found_in_the_warnings_of_a_real_certificate():
    mesh = img2tri.mesh_image(np.pad(np.ones((20, 30), bool), 3), edge_length=3, spacing=0.5)
    inner = int(np.argmin(np.abs(mesh.vertices - mesh.vertices.mean(axis=0)).sum(axis=1)))
    moved = mesh.vertices.copy()
    moved[[inner, 0]] += [[1.2, 0.3], [1.8, 1.5]]
    report = json.loads(img2tri.TriangleMesh(moved, mesh.triangles, mesh.regions, mesh.frame, {}, mesh.origin).report.to_json())
    found = tables.places(report)
    assert {place.source for place in found} >= {"warning", "narrow_at", "wrong_pixels_at"}
    assert all(place.number for place in found)
    assert all(report["warnings"][place.number - 1] for place in found)
    where = {place.at for place in found}
    assert where >= {tuple(at) for name in ("narrow_at", "wrong_pixels_at") for at in report[name]}
    assert tuple(report["smallest_angle_at"]) in where
    narrow = next(i for i, line in enumerate(report["warnings"], 1) if "degrees" in line)
    assert {place.number for place in found if place.source == "narrow_at"} == {narrow}


def test_charts_count_every_triangle_once():
    rng = np.random.default_rng(1)
    for values, most, unit in ((rng.random(5000), 1.0, ""), (rng.random(777) * 60, 60.0, "°"), (np.full(3, 60.0), 60.0, "°")):
        text = chart("quality", "Quality", "words", values, most, unit)
        bars = re.findall(r"<title>([\d.e-]+)\D? to ([\d.e-]+)\D?: ([\d,]+) triangles</title>", text)
        assert sum(int(count.replace(",", "")) for *_, count in bars) == len(values)
        for low, high, count in bars:
            inside = (values >= float(low) - 1e-9) & ((values < float(high) - 1e-9) | (values == most) & (float(high) == most))
            assert int(count.replace(",", "")) == pytest.approx(inside.sum(), abs=1)
        assert f"mean {values.mean():.3f}" in text or f"mean {values.mean():.1f}{unit}" in text


def test_regions_are_listed_with_names_and_errors():
    vertices, triangles, regions = strip()
    report = GOOD | {
        "areas": {"3": {"mesh": 0.4, "error": 0.0}, "7": {"mesh": 123456.0, "error": 0.0123}},
        "topology": {"3": {"found": [1, 0], "expected": [1, 0]}, "7": {"found": [2, 0], "expected": [1, 0]}},
    }
    text = made(vertices, triangles, regions, report=report, names={3: "<bone>"})
    table = text[text.index("<h2>Regions</h2>") :]
    lines = re.findall(r"<tr[^>]*>(.*?)</tr>", table[: table.index("</table>")])
    found = [[re.sub("<.*?>", "", cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", line)] for line in lines]
    assert found[1:] == [["&lt;bone&gt;", "6", "0.4", "0 %", "1 / 0"], ["region_7", "6", "123,456", "+1.230 %", "2 / 0"]]


def test_the_same_mesh_gives_the_same_page():
    assert made(*ring(), image=np.eye(4)) == made(*ring(), image=np.eye(4))


def test_what_is_no_mesh_or_no_certificate_is_refused():
    vertices, triangles = ring()
    with pytest.raises(MeshError, match="report: expected JSON, found 'no'"):
        page(vertices, triangles, q=np.ones(24), min_angle=np.ones(24), frame=Frame((4, 4)), report="no")
    with pytest.raises(MeshError, match="report: expected an object of JSON, found list"):
        page(vertices, triangles, q=np.ones(24), min_angle=np.ones(24), frame=Frame((4, 4)), report="[1]")
    with pytest.raises(MeshError, match="q: expected one number for each of 24 triangles"):
        page(vertices, triangles, q=[1], min_angle=np.ones(24), frame=Frame((4, 4)), report="{}")
    with pytest.raises(MeshError, match="regions: expected one number"):
        made(vertices, triangles, [1])
    with pytest.raises(MeshError, match="triangles: expected indices"):
        page(vertices, triangles + 99, q=np.ones(24), min_angle=np.ones(24), frame=Frame((4, 4)), report="{}")
    with pytest.raises(ParameterError, match=r"image: expected shape \(h, w\), \(h, w, 3\) or \(h, w, 4\), found \(3,\)"):
        made(vertices, triangles, image=[1, 2, 3])
