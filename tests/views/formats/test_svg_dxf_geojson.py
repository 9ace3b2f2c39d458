from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
import trimesh
from views.plates import ring, strip

from img2tri.errors import FileError, MeshError
from img2tri.views.formats.svg_dxf_geojson import DRAWING_FORMATS, save_outlines

SVG = "{http://www.w3.org/2000/svg}"
TEXTS = {"units": "mm", "img2tri": json.dumps({"recipe": "conforming", "source": "Ü --> <&>"})}


@pytest.fixture
def outlines():
    """A plate with a hole and an island in the hole, and a region beside it in two parts; at odd places."""
    box, third = shapely.box, 1 / 3
    plate = shapely.difference(box(1 + third, 2, 7 + third, 8), box(2 + third, 3, 5 + third, 6))
    island = box(3 + third, 4, 4 + third, 5)
    beside = [box(7 + third, 2, 9, 5), box(7 + third, 6, 9, 8)]
    return {3: shapely.multipolygons([plate, island]), 8: shapely.multipolygons(beside), 12: shapely.Point(20, 5).buffer(2)}


def same(found, expected, tolerance=0.0):
    return found.is_valid and shapely.symmetric_difference(found, expected).area <= tolerance


def path_rings(path):
    """Rings of an SVG path of M, L and Z."""
    for ring_text in re.findall(r"M([^MZ]*)Z?", path):
        yield np.array([[float(x) for x in pair.split()] for pair in ring_text.split("L")])


def filled(rings_):
    """What is inside by the even-odd rule."""
    area = shapely.Polygon()
    for corners in rings_:
        area = shapely.symmetric_difference(area, shapely.Polygon(corners))
    return area


def read_svg(path):
    root = ElementTree.parse(path).getroot()
    assert root.tag == SVG + "svg"
    shapes = {p.attrib["data-label"]: p for p in root.iterfind(f".//{SVG}g[@id='outlines']/{SVG}path")}
    return root, shapes


def test_svg_shows_every_region_the_right_way_up(tmp_path, outlines):
    save_outlines(tmp_path / "a.svg", outlines, names={3: 'bone "<A>"'}, bounds=(0, 0, 24, 10), field_data=TEXTS)
    root, shapes = read_svg(tmp_path / "a.svg")
    assert root.attrib["viewBox"] == "0 0 24 10"
    assert (root.attrib["width"], root.attrib["height"]) == ("24mm", "10mm")
    assert list(shapes) == ["3", "8", "12"]
    for label, shape in shapes.items():
        found = shapely.transform(filled(path_rings(shape.attrib["d"])), lambda p: p * [1, -1] + [0, 10])
        assert same(found, outlines[int(label)], 1e-6)
    assert shapes["3"].find(SVG + "title").text == 'bone "<A>"'
    assert shapes["8"].attrib["data-name"] == "region_8"
    assert len({shape.attrib["fill"] for shape in shapes.values()}) == 3
    assert json.loads(root.find(SVG + "metadata").text) == TEXTS
    assert root.find(f".//{SVG}path[@id='mesh']") is None


def test_svg_is_as_large_as_its_outlines_or_its_bounds(tmp_path, outlines):
    save_outlines(tmp_path / "a.svg", outlines)
    root, _ = read_svg(tmp_path / "a.svg")
    assert [float(x) for x in root.attrib["viewBox"].split()] == pytest.approx([0, 0, 22 - 4 / 3, 6])
    assert root.attrib["width"] == root.attrib["viewBox"].split()[2]  # no unit is known


def test_svg_of_an_image_with_y_down_is_not_turned_over(tmp_path, outlines):
    save_outlines(tmp_path / "a.svg", outlines, bounds=(0, 0, 24, 10), upward=False)
    _, shapes = read_svg(tmp_path / "a.svg")
    assert same(filled(path_rings(shapes["8"].attrib["d"])), outlines[8], 1e-6)


def test_svg_holds_the_edges_of_the_mesh_once(tmp_path, outlines):
    vertices, triangles = ring()
    save_outlines(tmp_path / "a.svg", outlines, mesh=(vertices, triangles), bounds=(0, 0, 24, 10))
    root, _ = read_svg(tmp_path / "a.svg")
    lines = list(path_rings(root.find(f".//{SVG}path[@id='mesh']").attrib["d"]))
    assert len({tuple(sorted(map(tuple, line.tolist()))) for line in lines}) == len(lines) == 48
    drawn = shapely.union_all([shapely.linestrings(line * [1, -1] + [0, 10]) for line in lines])
    edges = shapely.union_all(shapely.boundary(shapely.polygons(vertices[triangles])))
    assert drawn.equals(edges)


def test_svg_numbers_are_short_and_exact_enough_at_any_scale(tmp_path, outlines):
    for scale in (1e-6, 1.0, 1e6):
        scaled = {label: shapely.transform(shape, lambda p, s=scale: p * s) for label, shape in outlines.items()}
        save_outlines(tmp_path / "a.svg", scaled)
        root, shapes = read_svg(tmp_path / "a.svg")
        width = float(root.attrib["viewBox"].split()[2])
        assert width == pytest.approx((22 - 4 / 3) * scale, rel=1e-8)
        area = sum(filled(path_rings(shape.attrib["d"])).area for shape in shapes.values())
        assert area == pytest.approx(sum(shape.area for shape in scaled.values()), rel=1e-6)
        assert max(map(len, re.findall(r"[-\d.e]+", shapes["12"].attrib["d"]))) <= 15
        assert "-0 " not in shapes["3"].attrib["d"]


def dxf_entities(text):
    """Closed polylines by layer, lines by layer, and the layers there are, read pair by pair."""
    rows = text.splitlines()
    pairs = [(int(code), value) for code, value in zip(rows[::2], rows[1::2], strict=True)]
    assert pairs[-1] == (0, "EOF")
    items = []
    for code, value in pairs:
        if code == 0:
            items.append({0: value})
        elif items:
            items[-1].setdefault(code, value)
    rings_, lines, layers = {}, {}, []
    for item in items:
        if item[0] == "LAYER":
            layers.append(item[2])
        elif item[0] == "POLYLINE":
            assert item[70] == "1"
            rings_.setdefault(item[8], []).append([])
        elif item[0] == "VERTEX":
            rings_[item[8]][-1].append((float(item[10]), float(item[20])))
        elif item[0] == "LINE":
            lines.setdefault(item[8], []).append([[float(item[10]), float(item[20])], [float(item[11]), float(item[21])]])
    return rings_, lines, layers


def test_dxf_holds_every_region_on_its_layer(tmp_path, outlines):
    vertices, triangles = ring()
    save_outlines(tmp_path / "a.dxf", outlines, names={3: "bone"}, mesh=(vertices, triangles), field_data=TEXTS)
    text = (tmp_path / "a.dxf").read_text("ascii")
    rings_, lines, layers = dxf_entities(text)
    assert layers == ["bone", "region_8", "region_12", "mesh"]
    assert all(same(filled(rings_[layer]), outlines[label]) for layer, label in (("bone", 3), ("region_8", 8), ("region_12", 12)))
    assert len(rings_["bone"]) == 3
    drawn = shapely.union_all(shapely.linestrings(np.array(lines["mesh"])))
    assert drawn.equals(shapely.union_all(shapely.boundary(shapely.polygons(vertices[triangles]))))
    assert max(map(len, text.splitlines())) <= 256
    assert text.startswith("999\nunits: mm\n999\nimg2tri: {")


def test_dxf_read_by_trimesh(tmp_path, outlines):
    save_outlines(tmp_path / "a.dxf", outlines, names={3: "bone"})
    read = trimesh.load_path(io.StringIO((tmp_path / "a.dxf").read_text()), file_type="dxf")
    assert len(read.entities) == 3 + 2 + 1
    assert all(entity.closed for entity in read.entities)
    assert read.bounds.ravel().tolist() == pytest.approx([4 / 3, 2, 22, 8])
    whole = filled(entity.discrete(read.vertices) for entity in read.entities)
    assert same(whole, shapely.union_all(list(outlines.values())), 1e-6)


def test_layers_keep_to_what_release_12_allows(tmp_path):
    square = shapely.box(0, 0, 1, 1)
    names = {1: "Os à moelle / x", 2: "os_á_moelle___x", 3: "mesh", 4: "0", 5: "n" * 60, 6: "n" * 61, -7: "plain"}
    save_outlines(tmp_path / "a.dxf", dict.fromkeys(names, square), names=names)
    rings_, _, layers = dxf_entities((tmp_path / "a.dxf").read_text("ascii"))
    assert set(rings_) == set(layers) - {"mesh"}
    assert len({layer.lower() for layer in layers}) == len(layers) == len(names) + 1
    assert all(re.fullmatch(r"[A-Za-z0-9_-]{1,31}", layer) for layer in layers)
    assert "plain" in layers


def test_geojson_gives_back_the_very_polygons(tmp_path, outlines):
    save_outlines(tmp_path / "a.geojson", outlines, names={3: "Knochen ß"}, field_data=TEXTS)
    read = json.loads((tmp_path / "a.geojson").read_text())
    assert read["type"] == "FeatureCollection"
    assert read["metadata"] == TEXTS
    assert [f["properties"] for f in read["features"]] == [
        {"label": 3, "name": "Knochen ß"},
        {"label": 8, "name": "region_8"},
        {"label": 12, "name": "region_12"},
    ]
    assert [f["geometry"]["type"] for f in read["features"]] == ["MultiPolygon", "MultiPolygon", "Polygon"]
    whole = shapely.from_geojson((tmp_path / "a.geojson").read_text())
    for shape, label in zip(whole.geoms, outlines, strict=True):
        assert shape.normalize().equals_exact(outlines[label].normalize(), 0)
        for part in shapely.get_parts(shape):
            assert part.exterior.is_ccw
            assert not any(hole.is_ccw for hole in part.interiors)


def test_geojson_holds_the_edges_of_the_mesh(tmp_path, outlines):
    vertices, triangles, _ = strip()
    save_outlines(tmp_path / "a.geojson", outlines, mesh=(vertices, triangles))
    *_, last = json.loads((tmp_path / "a.geojson").read_text())["features"]
    assert last["properties"] == {"name": "mesh"}
    assert len(last["geometry"]["coordinates"]) == 25
    assert {tuple(p) for line in last["geometry"]["coordinates"] for p in line} == {tuple(p) for p in vertices.tolist()}


@pytest.mark.parametrize("suffix", sorted(DRAWING_FORMATS))
def test_the_same_drawing_gives_the_same_bytes(tmp_path, outlines, suffix):
    files = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for file in files:
        save_outlines(file, outlines, mesh=ring(), field_data=TEXTS)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert not list(tmp_path.glob(".*"))
    before = files[0].read_bytes()
    with pytest.raises(MeshError):
        save_outlines(files[0], {1: shapely.Point(0, 0)})
    assert files[0].read_bytes() == before


def test_drawings_need_no_heavy_library(tmp_path):
    code = """
import sys
from img2tri.views.formats.svg_dxf_geojson import save_outlines
class Shape: __geo_interface__ = {"type": "Polygon", "coordinates": [[(0, 0), (1, 0), (0, 1), (0, 0)]]}
for suffix in ("svg", "dxf", "geojson"): save_outlines(sys.argv[1] + "/a." + suffix, {1: Shape()})
print(sorted({"trimesh", "shapely", "pyvista", "matplotlib", "scipy"} & set(sys.modules)))
"""
    run = subprocess.run([sys.executable, "-c", code, tmp_path], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
    assert len(list(tmp_path.iterdir())) == 3


def test_what_cannot_be_drawn_is_refused(tmp_path, outlines):
    with pytest.raises(FileError, match=r"a.ai: expected a name that ends in .dxf, .geojson or .svg, found '.ai'"):
        save_outlines(tmp_path / "a.ai", outlines)
    with pytest.raises(FileError, match="expected an existing folder"):
        save_outlines(tmp_path / "no" / "a.svg", outlines)
    with pytest.raises(MeshError, match="outlines: expected a polygon or multi-polygon for region 1, found Point"):
        save_outlines(tmp_path / "a.svg", {1: shapely.Point(0, 0)})
    with pytest.raises(MeshError, match="outlines: expected a polygon or multi-polygon for region 1, found list"):
        save_outlines(tmp_path / "a.svg", {1: [[0, 0], [1, 0], [0, 1]]})
    with pytest.raises(MeshError, match="outlines: expected at least one, found none"):
        save_outlines(tmp_path / "a.svg", {})
    with pytest.raises(MeshError, match="triangles: expected indices"):
        save_outlines(tmp_path / "a.svg", outlines, mesh=([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]]))
    assert not list(tmp_path.iterdir())
