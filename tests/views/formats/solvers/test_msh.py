"""MSH read back: by Gmsh itself, by meshio, and by our own reader."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from views.plates import cells
from views.solver_meshes import KINDS, PIECES, TAGS, TEXTS, gmsh, made, plate, sizes

from img2tri import MeshError, ParameterError
from img2tri.views.formats.readers.read_msh_bdf import parse_msh
from img2tri.views.formats.solvers.msh import msh
from img2tri.views.objects.extruded_wedges import wedges
from img2tri.views.objects.solver_cells import flat_cells, solid_cells

VERSIONS = ("4.1", "2.2")
IDS = {"region_-1": 5, "bone": 4}
tools = pytest.mark.tools


@pytest.fixture
def opened(tmp_path):
    """Open bytes in Gmsh, silently; what it warns of is an error."""
    program = gmsh()

    def open_(data):
        (tmp_path / "a.msh").write_bytes(data)
        program.initialize(interruptible=False)
        program.option.setNumber("General.Terminal", 0)
        program.logger.start()
        program.open(str(tmp_path / "a.msh"))
        assert not [line for line in program.logger.get() if line.startswith(("Warning", "Error"))]
        return program

    yield open_
    if program.isInitialized():
        program.logger.stop()
        program.finalize()


@tools
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_gmsh_finds_every_group_with_its_name_and_size(opened, kind, version):
    mesh = made(kind)
    program = opened(msh(mesh, version=version)[""])
    inside = 3 if mesh.solid else 2
    regions, sets = sizes(mesh.solid)
    found = {program.model.getPhysicalName(*group): group for group in program.model.getPhysicalGroups()}
    sets = {name: size for name, size in sets.items() if version == "4.1" or name not in PIECES}
    assert found == {name: (inside, IDS[name]) for name in regions} | {name: (inside - 1, TAGS[name]) for name in sets}
    for name, size in {**regions, **sets}.items():
        total = 0.0
        for entity in program.model.getEntitiesForPhysicalGroup(*found[name]):
            _, elements, _ = program.model.mesh.getElements(found[name][0], entity)
            total += program.model.mesh.getElementQualities(np.concatenate(elements), "volume").sum()
        assert abs(total) == pytest.approx(size, rel=1e-9), name


@tools
@pytest.mark.parametrize("kind", KINDS)
def test_gmsh_finds_every_element_upright(opened, kind):
    """A node in a wrong place of a quadratic element would make its Jacobian vary."""
    mesh = made(kind)
    program = opened(msh(mesh)[""])
    _, elements, _ = program.model.mesh.getElements(3 if mesh.solid else 2)
    measure = program.model.mesh.getElementQualities
    assert sum(map(len, elements)) == len(mesh.cells)
    assert measure(np.concatenate(elements), "minSICN").min() > 0.3
    low, high = (measure(np.concatenate(elements), name) for name in ("minDetJac", "maxDetJac"))
    assert low == pytest.approx(high, rel=1e-6)


@tools
def test_gmsh_finds_the_nodes_of_each_group(opened):
    program = opened(msh(made("triangle"))[""])
    mesh = made("triangle")
    nodes = {name: program.model.mesh.getNodesForPhysicalGroup(1, TAGS[name])[0] for name in mesh.sides}
    for name, tags in nodes.items():
        assert sorted(tags.tolist()) == (np.unique(mesh.facets(name)) + 1).tolist()


@tools
@pytest.mark.parametrize("solid", [False, True])
def test_gmsh_finds_the_nodes_that_repeat_others(opened, tmp_path, solid):
    vertices, triangles = cells(np.ones((4, 5), bool))
    mesh = flat_cells(vertices, triangles, bounds=(0, 0, 5, 4), periodic="xy")
    mesh = solid_cells(mesh, *wedges(vertices, triangles, height=1, layers=1)[:2]) if solid else mesh
    program = opened(msh(mesh)[""])
    for name, master, axis, length in (("right", "left", 0, 5), ("top", "bottom", 1, 4)):
        tag, nodes, others, _ = program.model.mesh.getPeriodicNodes(2 if solid else 1, mesh.tags[name])
        assert tag == mesh.tags[master]
        assert sorted(nodes.tolist()) == (np.unique(mesh.facets(name)) + 1).tolist()
        apart = mesh.points[nodes.astype(int) - 1] - mesh.points[others.astype(int) - 1]
        assert np.array_equal(apart, np.tile(np.eye(3)[axis] * length, (len(nodes), 1)))
    # In version 2.2 Gmsh writes what it does not read again.
    program.option.setNumber("Mesh.MshFileVersion", 2.2)
    program.write(str(tmp_path / "b.msh"))
    texts = (tmp_path / "b.msh").read_text(), msh(mesh, version="2.2")[""].decode()
    one, other = (text.partition("$Periodic\n")[2].partition("$EndPeriodic")[0].split() for text in texts)
    assert sorted(other) == sorted(one)
    assert other[:4] == one[:4]


@tools
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("labels", [(2**31 - 1, 5), (-5, 2), (-(2**31), 2**31), (2**63 - 1, 3), (0, 1), (2_000_000_000, 1_999_999_999)])
def test_gmsh_finds_labels_of_any_size_by_their_names(opened, labels, version):
    square = np.array([[0, 0], [2, 0], [2, 1], [0, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    program = opened(msh(flat_cells(*square, labels, bounds=(0, 0, 2, 1)), version=version)[""])
    found = {program.model.getPhysicalName(*group): group for group in program.model.getPhysicalGroups(2)}
    assert set(found) == {f"region_{label}" for label in labels}
    for row, label in enumerate(labels):
        number = found[f"region_{label}"][1]
        assert number == label or not 1 <= label <= 2_000_000_000
        nodes = program.model.mesh.getNodesForPhysicalGroup(2, number)[0]
        assert sorted(nodes.tolist()) == (np.sort(square[1][row]) + 1).tolist()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "wedge15"])  # which meshio does not know
def test_meshio_finds_cells_groups_and_names(tmp_path, kind, version):
    mesh = made(kind)
    (tmp_path / "a.msh").write_bytes(msh(mesh, version=version)[""])
    read = meshio.read(tmp_path / "a.msh")
    inside = 3 if mesh.solid else 2
    expected = {name: [number, inside] for name, number in IDS.items()} | {
        name: [TAGS[name], inside - 1] for name in mesh.sides if version == "4.1" or name not in PIECES
    }
    assert {name: list(values) for name, values in read.field_data.items()} == expected
    groups = np.concatenate(read.cell_data["gmsh:physical"])
    dimensions = np.concatenate([np.full(len(block.data), block.dim) for block in read.cells])
    for name, (number, dimension) in expected.items():
        if name in PIECES:
            continue  # meshio knows one group of an element
        count = len(mesh.sides[name]) if name in mesh.sides else (mesh.regions == (-1 if name == "region_-1" else 4)).sum()
        assert np.count_nonzero((groups == number) & (dimensions == dimension)) == count
    order = np.lexsort(read.points.T)
    assert np.array_equal(read.points[order], mesh.points[np.lexsort(mesh.points.T)])


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_our_own_reader_finds_everything_by_region(kind, version):
    mesh = made(kind)
    found = parse_msh(msh(mesh, version=version)[""])
    order = np.argsort(mesh.regions, kind="stable")
    assert np.array_equal(found.points, mesh.points)
    assert np.array_equal(found.cells, mesh.cells[order])
    assert (found.kind, found.names) == (kind, mesh.names)
    assert np.array_equal(found.regions, mesh.regions[order])
    sets = {name: np.sort(mesh.facets(name), axis=0) for name in mesh.sides}
    assert {name: np.sort(rows, axis=0).tolist() for name, rows in found.facets.items()} == {n: rows.tolist() for n, rows in sets.items()}


def test_texts_are_comments_in_short_lines():
    lines = msh(made("triangle"))[""].decode().splitlines()
    at = lines.index("$Comments")
    comments = lines[at + 1 : lines.index("$EndComments")]
    assert comments[:2] == ["written by img2tri", "units: mm"]
    assert "".join(line.removeprefix("   ") for line in comments[2:]) == f"img2tri: {TEXTS['img2tri']}" + 'labels: {"region_-1": -1}'
    assert max(map(len, comments)) <= 80


def test_the_version_changes_the_file_and_another_is_refused():
    one, other = (msh(made("triangle"), version=version)[""] for version in VERSIONS)
    assert one.startswith(b"$MeshFormat\n4.1 0 8\n")
    assert other.startswith(b"$MeshFormat\n2.2 0 8\n")
    with pytest.raises(ParameterError, match=r"version: expected '4.1' or '2.2', found '3'"):
        msh(made("triangle"), version="3")


def test_quotes_in_names_do_not_end_them():
    vertices, triangles, regions = plate()
    data = msh(flat_cells(vertices, triangles, regions, names={4: 'the "hard"\nbone é'}))[""]
    assert parse_msh(data).names[4] == "the 'hard' bone é"


def test_a_name_that_holds_a_label_is_read_as_that_label():
    vertices, triangles, regions = plate()
    found = parse_msh(msh(flat_cells(vertices, triangles, np.where(regions == 4, 0, -7)))[""])
    assert sorted(set(found.regions.tolist())) == [-7, 0]


FOREIGN = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
1 1 1 0
9 0 0 0 0
3 0 0 0 1 0 0 1 7 2 9 -9
5 0 0 0 1 1 0 0 1 3
$EndEntities
$Nodes
2 4 10 40
1 3 1 2
10
20
0 0 0 0.0
1 0 0 1.0
2 5 0 2
40
30
1 1 0
0 1 0
$EndNodes
$Elements
3 4 1 4
0 9 15 1
1 10
1 3 1 1
2 10 20
2 5 2 2
3 10 20 40
4 10 40 30
$EndElements
"""


def test_files_of_others_are_read_with_gaps_in_the_numbers_parameters_and_no_groups():
    found = parse_msh(FOREIGN.encode())
    assert found.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    assert found.cells.tolist() == [[0, 1, 3], [0, 3, 2]]
    assert (found.regions.tolist(), found.names, found.facets) == ([0, 0], {}, {})


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"", KeyError),
        (b"$MeshFormat\n4.1 1 8\n$EndMeshFormat\n", ValueError),
        (b"$MeshFormat\n1 0 8\n$EndMeshFormat\n", ValueError),
        (FOREIGN.replace("3 10 20 40", "3 10 20 41").encode(), IndexError),
        (FOREIGN.replace("2 5 2 2\n3 10 20 40\n4 10 40 30", "2 5 3 1\n3 10 20 40 30").encode(), MeshError),
        (FOREIGN.replace("3 10 20 40", "3 10 20 25").encode(), ValueError),
        (FOREIGN.partition("$Elements")[0].encode(), KeyError),
        (FOREIGN.replace("4 10 40 30\n", "").encode(), ValueError),
    ],
)
def test_what_is_no_msh_of_triangles_or_wedges_is_refused(data, kind):
    with pytest.raises(kind):
        parse_msh(data)
