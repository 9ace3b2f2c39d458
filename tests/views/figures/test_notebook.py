from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from oracles import angles
from views.plates import cells, ring, strip

from img2tri.errors import MeshError
from img2tri.views.figures.colours import palette
from img2tri.views.figures.notebook import LARGEST, html, svg

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


def test_a_large_mesh_is_drawn_by_its_regions():
    vertices, triangles = cells(np.pad(np.zeros((2, 2), bool), 40, constant_values=True))
    assert len(triangles) > LARGEST
    regions = np.where(vertices[triangles].mean(axis=1)[:, 0] < 10, 1, 2)
    text = svg(vertices, triangles, regions)
    _, shown, lines = drawn(text)
    assert len(lines) == 4 * 82 + 8 + 82
    # A place is filled where it lies in an odd number of the triangles.
    x, y = np.mgrid[1:400:4, 1:400:4] + np.array([0.5, 0.71])[:, None, None]
    for colour, inside in zip(dict.fromkeys(colour for colour, _ in shown), (x < 10 / 82 * 400, x > 10 / 82 * 400), strict=True):
        found = np.sum([_within(corners, x, y) for c, corners in shown if c == colour], axis=0) % 2
        hole = (np.abs(x - 200) < 400 / 82) & (np.abs(y - 200) < 400 / 82)
        assert np.array_equal(found == 1, inside & ~hole)
    assert len(text) < 40_000


def _within(corners, x, y):
    turn = [(b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    return np.all(np.array(turn) > 0, axis=0) | np.all(np.array(turn) < 0, axis=0)


def test_however_fine_a_mesh_is_its_drawing_stays_small():
    vertices, triangles = cells(np.ones((400, 400), bool))
    assert len(triangles) == 320_000
    assert len(svg(vertices, triangles)) < 120_000
    # What is smaller than half a pixel is gone.
    cluster = np.concatenate([vertices / 1000, [[400, 0], [400, 400], [0, 400]]])
    assert len(svg(cluster, np.concatenate([triangles, len(vertices) + np.array([[0, 1, 2]])]))) < 1000


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
