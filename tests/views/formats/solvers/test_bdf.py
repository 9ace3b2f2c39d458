"""BDF read back: by meshio, by pyNastran with the names, by Gmsh, and by our own reader."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from views.solver_meshes import KINDS, TAGS, TEXTS, gmsh, made, sizes

from img2tri import MeshError
from img2tri.views.formats.readers.read_msh_bdf import parse_bdf
from img2tri.views.formats.solvers.bdf import bdf

IDS = {"region_-1": 5, "bone": 4}
tools = pytest.mark.tools


def test_lines_are_short_and_fields_in_their_columns():
    for kind in KINDS:
        lines = bdf(made(kind))[""].decode("ascii").splitlines()
        assert max(map(len, lines)) <= 80
        for line in lines:
            if line[:1] not in "$C" and line[:5] not in ("BEGIN", "ENDDA"):
                width = 16 if line[:8].rstrip().endswith("*") else 8
                fields = [line[i : i + width] for i in range(8, len(line), width)]
                assert all(" " not in field.strip() for field in fields)


@pytest.mark.parametrize("kind", KINDS)
def test_meshio_finds_cells_and_properties(tmp_path, monkeypatch, kind):
    # It reads wedges of 15 nodes, but has forgotten to enter them in one of its tables.
    monkeypatch.setitem(meshio._mesh.topological_dimension, "wedge15", 3)
    mesh = made(kind)
    (tmp_path / "a.bdf").write_bytes(bdf(mesh)[""])
    read = meshio.read(tmp_path / "a.bdf")
    assert read.points == pytest.approx(mesh.points, rel=1e-9)
    ((block,), (properties,)) = read.cells, read.cell_data["nastran:ref"]
    assert block.type == kind
    order = np.argsort(mesh.regions != -1, kind="stable")  # by properties in the file
    assert np.array_equal(block.data, mesh.cells[order])
    assert np.array_equal(properties, np.where(mesh.regions == -1, 5, 4)[order])


@tools
@pytest.mark.parametrize("kind", KINDS)
def test_pynastran_finds_elements_sets_and_names(tmp_path, monkeypatch, kind):
    monkeypatch.setattr(np, "in1d", np.isin, raising=False)  # which numpy has given up, and pyNastran not
    reader = pytest.importorskip("pyNastran.bdf.bdf", reason="pyNastran is not installed")
    mesh = made(kind)
    (tmp_path / "a.bdf").write_bytes(bdf(mesh)[""])
    model = reader.read_bdf(str(tmp_path / "a.bdf"), xref=False, validate=False, debug=None)
    assert len(model.nodes) == len(mesh.points)
    places = np.array([model.nodes[i + 1].xyz for i in range(len(mesh.points))])
    assert places == pytest.approx(mesh.points, rel=1e-9)
    assert np.array_equal([model.elements[i + 1].pid for i in range(len(mesh.cells))], np.where(mesh.regions == -1, 5, 4))
    named = {}
    for number, card in model.sets.items():
        named[card.comment.split('"')[1]] = number
        assert sorted(card.ids) == (np.unique(mesh.facets(card.comment.split('"')[1])) + 1).tolist()
    assert named == {name: TAGS[name] for name in mesh.sides}
    comments = [element.comment for element in model.elements.values() if element.comment]
    assert [(int(text.split('"')[0].split()[-1]), text.split('"')[1]) for text in comments] == [(5, "region_-1"), (4, "bone")]


@tools
@pytest.mark.parametrize("kind", ["triangle", "wedge"])
def test_gmsh_finds_regions_of_their_sizes(tmp_path, kind):
    program, mesh = gmsh(), made(kind)
    (tmp_path / "a.bdf").write_bytes(bdf(mesh)[""])
    program.initialize(interruptible=False)
    try:
        program.option.setNumber("General.Terminal", 0)
        program.open(str(tmp_path / "a.bdf"))
        inside = 3 if mesh.solid else 2
        for name, size in sizes(mesh.solid)[0].items():
            _, elements, _ = program.model.mesh.getElements(inside, IDS[name])
            assert program.model.mesh.getElementQualities(np.concatenate(elements), "volume").sum() == pytest.approx(size, rel=1e-9)
    finally:
        program.finalize()


@pytest.mark.parametrize("kind", KINDS)
def test_our_own_reader_finds_everything_in_its_order(kind):
    mesh = made(kind)
    found = parse_bdf(bdf(mesh)[""])
    assert found.points == pytest.approx(mesh.points, rel=1e-9)
    assert np.array_equal(found.cells, mesh.cells)
    assert (found.kind, found.names) == (kind, mesh.names)
    assert np.array_equal(found.regions, mesh.regions)
    assert {name: rows.ravel().tolist() for name, rows in found.facets.items()} == {
        name: np.unique(mesh.facets(name)).tolist() for name in mesh.sides
    }


def test_texts_are_comments():
    lines = bdf(made("triangle"))[""].decode().splitlines()
    assert lines[:2] == ["$ written by img2tri", "$ units: mm"]
    comments = [line[2:] for line in lines[2 : lines.index("CEND")]]
    assert "".join(line.removeprefix("   ") for line in comments) == f"img2tri: {TEXTS['img2tri']}" + 'labels: {"region_-1": -1}'


FOREIGN = """$ by hand
SOL 101
CEND
BEGIN BULK
grid,7,,0.,0.,0.
GRID     9              1.5+0   -2.5-1  0.
GRID*                 12                           1.5D0             1.0
*                    0.0
CTRIA3   3       1       7       9      12
PSHELL   1       1      .5
ENDDATA
"""


def test_files_of_others_are_read_free_small_and_large():
    found = parse_bdf(FOREIGN.encode())
    assert found.points.tolist() == [[0, 0, 0], [1.5, -0.25, 0], [1.5, 1, 0]]
    assert found.cells.tolist() == [[0, 1, 2]]
    assert (found.regions.tolist(), found.names, found.facets) == ([1], {}, {})


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", MeshError),
        (FOREIGN.replace("CTRIA3", "CQUAD4"), MeshError),
        (FOREIGN.replace("9      12", "9       8"), ValueError),
        (FOREIGN.replace("9      12", "9      13"), IndexError),
        (FOREIGN.replace("1.5D0", "one"), ValueError),
        (FOREIGN.replace("7       9      12", "7       9"), KeyError),
    ],
)
def test_what_is_no_bdf_of_triangles_or_wedges_is_refused(text, kind):
    with pytest.raises(kind):
        parse_bdf(text.encode())
