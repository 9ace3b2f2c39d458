from __future__ import annotations

import base64
import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from oracles import angles
from PIL import Image
from views.plates import cells, ring, strip

from img2tri.errors import MeshError
from img2tri.views.figures.notebook import LARGEST, html, svg
from img2tri.views.figures.region_colours import palette

SVG = "{http://www.w3.org/2000/svg}"


def drawn(text):
    """Size of the drawing, the filled triangles with their colours, and the lines."""
    root = ElementTree.fromstring(text)
    *filled, lines = root.iterfind(f"{SVG}path")
    triangles = [(path.attrib["fill"], corners) for path in filled for corners in _parts(path.attrib["d"])]
    return [float(x) for x in root.attrib["viewBox"].split()], triangles, _parts(lines.attrib["d"])


def _parts(path):
    return [np.array([[float(x) for x in place.split()] for place in part.rstrip("Z").split("L")]) for part in path.split("M")[1:]]


def test_a_small_mesh_is_drawn_triangle_by_triangle():
    vertices, triangles, regions = strip()
    box, shown, lines = drawn(svg(vertices, triangles, regions))
    assert box[:2] == [-2, -2]
    assert max(box[2:]) == 404
    assert box[3] == pytest.approx(4 + 400 * np.ptp(vertices[:, 1]) / np.ptp(vertices[:, 0]), abs=1)
    blue, rose = (f"#{r:02x}{g:02x}{b:02x}" for r, g, b in palette(2).tolist())
    assert [colour for colour, _ in shown] == [blue] * 6 + [rose] * 6
    # Left and right as in the mesh, y turned over.
    assert max(corners[:, 0].max() for colour, corners in shown if colour == blue) == 200
    scale = 400 / np.ptp(vertices[:, 0])
    expected = (vertices[triangles] - vertices.min(axis=0)) * scale
    expected[..., 1] = np.ptp(vertices[:, 1]) * scale - expected[..., 1]
    order = np.argsort(regions, kind="stable")
    assert np.array([corners for _, corners in shown]) == pytest.approx(expected[order], abs=0.26)
    assert len(lines) == 2 * 6 + 2 + 1  # around it and between the regions


def test_y_down_is_drawn_down():
    vertices, triangles = [[0, 0], [2, 0], [0, 1]], [[0, 1, 2]]
    up, down = (drawn(svg(vertices, triangles, upward=upward))[1][0][1].tolist() for upward in (True, False))
    assert up == [[0, 200], [400, 200], [0, 0]]
    assert down == [[0, 0], [400, 0], [0, 200]]


def picture(text):
    """The dots of a drawing, (h, w, 4)."""
    with Image.open(io.BytesIO(base64.b64decode(re.search(r"data:image/png;base64,([^\"]+)", text)[1]))) as read:
        return np.asarray(read.convert("RGBA")).astype(int)


@pytest.mark.parametrize("upward", [True, False])
def test_a_large_mesh_is_drawn_by_its_regions(upward):
    vertices, triangles = cells(np.pad(np.zeros((2, 2), bool), 40, constant_values=True))
    assert len(triangles) > LARGEST
    regions = np.where(vertices[triangles].mean(axis=1)[:, 0] < 10, 1, 2)
    regions[vertices[triangles].mean(axis=1)[:, 1] > 60] = 7
    text = svg(vertices, triangles, regions, upward=upward)
    dots = picture(text)
    assert dots.shape == (800, 800, 4)
    x, y = np.meshgrid(np.arange(800) + 0.5, np.arange(800) + 0.5) * np.array(82 / 800)
    y = 82 - y if upward else y
    wanted = np.where(y > 60, 3, np.where(x < 10, 1, 2))
    hole = (np.abs(x - 41) < 1) & (np.abs(y - 41) < 1)
    near = (np.abs(x - 10) < 0.2) | (np.abs(y - 60) < 0.2) | (np.abs(np.maximum(np.abs(x - 41), np.abs(y - 41)) - 1) < 0.2)  # lines
    colours = np.array([[0, 0, 0], *palette(3)])
    assert np.array_equal(dots[~near][:, 3] > 0, ~hole[~near])
    shown = ~near & ~hole
    assert np.array_equal(dots[shown][:, :3], colours[wanted[shown]])
    assert len(text) < 20_000


def test_many_regions_stay_small():
    vertices, triangles = cells(np.ones((50, 50), bool))
    rng = np.random.default_rng(0)
    assert len(svg(vertices, triangles, rng.integers(1, 500, len(triangles)))) < 120_000


def test_however_fine_a_mesh_is_its_drawing_stays_small():
    vertices, triangles = cells(np.ones((400, 400), bool))
    assert len(triangles) == 320_000
    assert len(svg(vertices, triangles)) < 120_000
    # What is smaller than half a pixel is gone.
    cluster = np.concatenate([vertices / 1000, [[400, 0], [400, 400], [0, 400]]])
    assert len(svg(cluster, np.concatenate([triangles, len(vertices) + np.array([[0, 1, 2]])]))) < 20_000


def test_html_says_what_there_is():
    vertices, triangles, regions = strip()
    text = html(vertices, triangles, regions)
    root = ElementTree.fromstring(text)
    drawing, line = root
    assert drawing.tag == SVG + "svg"
    assert line.text == f"12 triangles · 14 vertices · 2 regions · smallest angle {angles(vertices, triangles).min():.1f}°"
    assert ElementTree.tostring(drawing) == ElementTree.tostring(ElementTree.fromstring(svg(vertices, triangles, regions)))
    assert drawing.attrib["aria-label"] == line.text


def test_nothing_is_fetched():
    assert re.findall(r"https?://[^\"]*", html(*ring())) == ["http://www.w3.org/2000/svg"]  # a name, not an address


def test_the_same_mesh_gives_the_same_text():
    assert html(*strip()) == html(*strip())


def test_arrays_that_are_no_mesh_are_refused():
    with pytest.raises(MeshError, match="triangles: expected indices"):
        html([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]])
    with pytest.raises(MeshError, match="regions: expected one number"):
        svg(*ring(), [1])
