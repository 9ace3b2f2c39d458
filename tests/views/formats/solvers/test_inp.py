"""INP read back: by meshio, and by CalculiX, which computes with it."""

from __future__ import annotations

import re
import subprocess

import meshio
import numpy as np
import pytest
from children import PATIENCE
from views.plates import cells
from views.solver_meshes import BOUNDS, HEIGHT, KINDS, TEXTS, made, plate, program, sizes

from img2tri import MeshError, ParameterError
from img2tri.views.formats.readers.read_inp import parse_inp
from img2tri.views.formats.solvers.inp import inp
from img2tri.views.objects.solver_cells import flat_cells

tools = pytest.mark.tools
ELEMENTS = {"triangle": "CPS3", "triangle6": "CPS6", "wedge": "C3D6", "wedge15": "C3D15", "tetra": "C3D4", "tetra10": "C3D10"}
PLAIN = {"region_-1": "region_minus1", "region_-1__bone": "region_minus1__bone"}


def cards(data):
    """Keyword line -> lines of data, read line by line."""
    found, key = {}, None
    for line in data.decode("ascii").splitlines():
        if line.startswith("*") and not line.startswith("**"):
            key = line
            assert key not in found
            found[key] = []
        elif not line.startswith("**"):
            found[key].append(line.split(", "))
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_lines_keep_to_the_limits_of_abaqus(kind):
    for deck in (False, True)[: 2 - kind.startswith("tetra")]:
        for line in inp(made(kind), deck=deck)[""].decode("ascii").splitlines():
            assert len(line) <= 256
            if not line.startswith("*"):
                items = line.split(",")
                assert len(items) <= 16
                assert max(len(item.strip()) for item in items) <= 20


@pytest.mark.parametrize("kind", KINDS)
def test_the_mesh_alone_has_nodes_elements_sets_and_surfaces_and_nothing_else(kind):
    mesh = made(kind)
    found = cards(inp(mesh)[""])
    names = [PLAIN.get(name, name) for name in mesh.sides]
    elements = {f"*ELEMENT, TYPE={ELEMENTS[kind]}, ELSET={name}": label for name, label in (("region_minus1", -1), ("bone", 4))}
    assert set(found) == {"*NODE", *elements, *(f"*NSET, NSET={n}" for n in names), *(f"*SURFACE, NAME={n}, TYPE=ELEMENT" for n in names)}
    assert np.array([[float(x) for x in row[1:]] for row in found["*NODE"]]) == pytest.approx(
        mesh.points if mesh.solid else mesh.points * (1, 1, 0), rel=1e-12, abs=0
    )
    for key, label in elements.items():
        rows = np.array(found[key], int)
        assert np.array_equal(rows[:, 0] - 1, np.flatnonzero(mesh.regions == label))
        assert np.array_equal(rows[:, 1:] - 1, mesh.cells[mesh.regions == label])
    for name in mesh.sides:
        members = [int(word) for row in found[f"*NSET, NSET={PLAIN.get(name, name)}"] for word in row]
        assert members == (np.unique(mesh.facets(name)) + 1).tolist()


@pytest.mark.parametrize("kind", ["triangle", "wedge", "wedge15", "tetra", "tetra10"])  # meshio does not know CPS6
def test_meshio_finds_cells_and_names(tmp_path, monkeypatch, kind):
    monkeypatch.setitem(meshio._mesh.topological_dimension, "wedge15", 3)
    mesh = made(kind)
    (tmp_path / "a.inp").write_bytes(inp(mesh)[""])
    read = meshio.read(tmp_path / "a.inp")
    assert read.points[:, :2] == pytest.approx(mesh.points[:, :2], rel=1e-12)
    assert {block.type for block in read.cells} == {kind}
    order = np.argsort(mesh.regions != -1, kind="stable")
    assert np.array_equal(np.concatenate([block.data for block in read.cells]), mesh.cells[order])
    assert {name: [len(part) for part in parts] for name, parts in read.cell_sets.items()} == {
        "region_minus1": [(mesh.regions == -1).sum(), 0], "bone": [0, (mesh.regions == 4).sum()],
    }  # fmt: skip
    assert {name: np.sort(rows).tolist() for name, rows in read.point_sets.items()} == {
        PLAIN.get(name, name): np.unique(mesh.facets(name)).tolist() for name in mesh.sides
    }


def run(folder, text):
    """The reactions (x, y, z) that CalculiX prints last."""
    ccx = program("ccx")
    (folder / "job.inp").write_bytes(text)
    done = subprocess.run([ccx, "job"], cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout
    assert "ERROR" not in done.stdout, done.stdout
    assert "WARNING" not in done.stdout, done.stdout
    totals = re.findall(r"total force.*\n\n\s*(\S+)\s+(\S+)\s+(\S+)", (folder / "job.dat").read_text())
    return np.array(totals[-1], float)


@tools
@pytest.mark.parametrize("kind", KINDS)
def test_calculix_finds_every_surface_where_it_is_and_every_set_of_nodes(tmp_path, kind):
    """Pressure on a surface is held by a set of nodes, which it must not touch: reaction = pressure x area x normal."""
    mesh = made(kind)
    (tmp_path / "mesh.inp").write_bytes(inp(mesh)[""])
    thickness = "" if mesh.solid else "1.\n"
    sections = "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=steel\n{thickness}" for name in ("region_minus1", "bone"))
    regions, sets = sizes(mesh.solid)
    expected = {
        "left": ("hole_1", [-sets["left"], 0, 0]),
        "outer": ("hole_1", [4 / 9 * sets["outer"], 5 / 9 * sets["outer"], 0]),  # right and top
        "bottom": ("hole_1", [0, -sets["bottom"], 0]),
        "hole_1": ("bottom", [0, 0, 0]),
        "region_-1__bone": ("hole_1", [sets["region_-1__bone"], 0, 0]),  # seen from region -1, on its right
    }
    if mesh.solid:
        expected["z_max"] = ("z_min", [0, 0, sum(regions.values()) / HEIGHT])
    for name, (held, force) in expected.items():
        text = (
            "*INCLUDE, INPUT=mesh.inp\n*MATERIAL, NAME=steel\n*ELASTIC\n1e5, 0.3\n" + sections + "*STEP\n*STATIC\n"
            f"*BOUNDARY\n{held}, 1, {3 if mesh.solid else 2}\n*DSLOAD\n{PLAIN.get(name, name)}, P, 7.\n"
            f"*NODE PRINT, NSET={held}, TOTALS=ONLY\nRF\n*END STEP\n"
        )
        assert run(tmp_path, text.encode()) == pytest.approx(7 * np.array(force), abs=1e-4), name


def stretched(vertices, triangles, plane, held, drawn, up):
    """Force needed to move some vertices up by `up`, others being held: linear triangles, modulus 1000, Poisson's ratio 0.3."""
    e, nu = (1000, 0.3) if plane == "stress" else (1000 / (1 - 0.3**2), 0.3 / (1 - 0.3))
    law = e / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    stiffness = np.zeros((2 * len(vertices),) * 2)
    for t in triangles:
        (x, y), area = vertices[t].T, 0
        b, c = np.roll(y, -1) - np.roll(y, 1), np.roll(x, 1) - np.roll(x, -1)
        area = (x * b).sum() / 2
        strain = np.zeros((3, 6))
        strain[0, ::2], strain[1, 1::2], strain[2, ::2], strain[2, 1::2] = b, c, c, b
        at = np.stack([2 * t, 2 * t + 1], axis=1).ravel()
        stiffness[np.ix_(at, at)] += strain.T @ law @ strain / (4 * area)
    known = np.concatenate([2 * held, 2 * held + 1, 2 * drawn, 2 * drawn + 1])
    free = np.setdiff1d(np.arange(len(stiffness)), known)
    u = np.zeros(len(stiffness))
    u[2 * drawn + 1] = up
    u[free] = np.linalg.solve(stiffness[np.ix_(free, free)], -stiffness[np.ix_(free, known)] @ u[known])
    force = stiffness @ u
    return force[2 * drawn].sum(), force[2 * drawn + 1].sum()


@tools
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_the_deck_runs_and_finds_the_stiffness_of_the_plate(tmp_path, plane):
    vertices, triangles, _ = plate()
    y = vertices[:, 1]
    ends = np.flatnonzero(y == y.min()), np.flatnonzero(y == y.max())
    expected = stretched(vertices, triangles, plane, *ends, 0.001 * np.ptp(y))
    found = run(tmp_path, inp(made("triangle"), deck=True, plane=plane)[""])
    # In plane stress CalculiX has the thickness change from node to node, not from triangle to triangle.
    assert found[1] == pytest.approx(expected[1], rel=1e-4 if plane == "strain" else 0.01)
    assert found[0] == pytest.approx(expected[0], abs=(1e-4 if plane == "strain" else 0.01) * expected[1])


@tools
@pytest.mark.parametrize("kind", KINDS[1:4])
def test_the_deck_runs_with_every_kind_of_cell(tmp_path, kind):
    thick = HEIGHT if kind.startswith("wedge") else 1
    force = run(tmp_path, inp(made(kind), deck=True)[""])
    vertices, triangles, _ = plate()
    y = vertices[:, 1]
    linear = stretched(vertices, triangles, "stress", np.flatnonzero(y == y.min()), np.flatnonzero(y == y.max()), 0.001 * np.ptp(y))
    assert linear[1] * thick * 0.6 < force[1] < linear[1] * thick * 1.1  # quadratic cells yield more


@tools
def test_the_deck_runs_with_several_bodies_some_of_one_vertex_at_the_end(tmp_path):
    mask = np.zeros((9, 9), bool)
    mask[:2, :3] = mask[5:8, 2:4] = mask[4, 6:] = True
    vertices, triangles = cells(mask)
    turned = vertices @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    assert run(tmp_path, inp(flat_cells(turned, triangles), deck=True)[""])[1] > 0


def test_options_change_the_file_and_others_are_refused():
    mesh = made("triangle")
    assert b"TYPE=CPS3" in inp(mesh)[""]
    assert b"TYPE=CPE3" in inp(mesh, plane="strain")[""]
    assert b"TYPE=CPE6" in inp(made("triangle6"), plane="strain")[""]
    assert b"*STEP" in inp(mesh, deck=True)[""]
    assert b"*STEP" not in inp(mesh)[""]
    with pytest.raises(ParameterError, match="plane: expected one of 'stress', 'strain', found 'shell'"):
        inp(mesh, plane="shell")


def test_no_deck_is_made_of_wedges_whose_ends_are_not_known():
    mesh = made("wedge")
    loose = type(mesh)(**{**vars(mesh), "sides": {}, "tags": {}, "part_of": {}, "between": {}})
    assert inp(loose)[""]
    with pytest.raises(MeshError, match="deck: expected wedges in layers"):
        inp(loose, deck=True)
    with pytest.raises(MeshError, match="deck: expected wedges in layers, .* leave out cells="):
        inp(made("tetra"), deck=True)


def test_names_keep_their_case_and_no_two_are_alike():
    vertices, triangles, regions = plate()
    data = inp(flat_cells(vertices, triangles, regions, names={-1: "Left", 4: "Bone, hard"}, bounds=BOUNDS))[""]
    assert b"ELSET=Left_2\n" in data  # Abaqus would take it for left, which is a set
    assert b"ELSET=Bone_hard\n" in data
    assert b"** Bone_hard: named Bone, hard\n" in data
    assert b"NSET=left\n" in data
    assert b"NAME=Left_2__Bone_hard," in data
    deck = inp(flat_cells(vertices, triangles, regions, names={4: "Held"}), deck=True)[""]
    assert b"ELSET=Held_2\n" in deck


def test_numbers_have_all_the_digits_there_is_room_for():
    vertices, triangles, _ = plate()
    data = inp(flat_cells(vertices * 1e-7 / 3 - 1e-7, triangles))[""]
    rows = np.array([[float(x) for x in row[1:]] for row in cards(data)["*NODE"]])
    assert rows[:, :2] == pytest.approx(vertices * 1e-7 / 3 - 1e-7, rel=1e-12, abs=0)


@pytest.mark.parametrize("deck", [False, True])
@pytest.mark.parametrize("kind", KINDS[:4])
def test_plane_elements_lie_at_zero_and_their_height_is_put_back(kind, deck):
    """CalculiX takes no others, and whoever reads the file here finds the mesh where it was."""
    mesh = made(kind)
    data = inp(mesh, deck=deck)[""]
    nodes = data.decode().partition("*NODE\n")[2].partition("*")[0].splitlines()
    assert ({row.split(", ")[3] for row in nodes} == {"0.0"}) == (not mesh.solid)
    read = parse_inp(data)
    assert read.points == pytest.approx(mesh.points, rel=1e-12, abs=0)
    assert "z" not in read.texts


def test_texts_are_comments():
    lines = inp(made("triangle"))[""].decode().splitlines()
    assert lines[:2] == ["** written by img2tri", "** units: mm"]
    assert '** labels: {"region_minus1": -1, "bone": 4}' in lines
    comments = [line[3:] for line in lines[2 : lines.index("*NODE")] if "named" not in line and "labels" not in line]
    assert "".join(line.removeprefix("   ") for line in comments) == f"img2tri: {TEXTS['img2tri']}"
