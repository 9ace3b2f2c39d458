"""XDMF read back: by FEniCSx, which measures every part, by meshio, and by VTK through pyvista."""

from __future__ import annotations

import json
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest
import pyvista as pv
from children import PATIENCE
from views.solver_meshes import KINDS, PIECES, TAGS, TEXTS, made, plate, python_with, sizes

from img2tri.views.formats.solvers.xdmf import xdmf
from img2tri.views.objects.solver_cells import flat_cells

IDS = {"region_-1": 5, "bone": 4}
tools = pytest.mark.tools

FENICSX = """
import json, sys
import ufl
from dolfinx import fem
from dolfinx.io import XDMFFile
from mpi4py import MPI

text = XDMFFile.Encoding.ASCII
for stem in sys.argv[1:]:
    with XDMFFile(MPI.COMM_WORLD, stem + ".xdmf", "r", encoding=text) as file:
        mesh = file.read_mesh(name="Grid")
        regions = file.read_meshtags(mesh, name="Grid")
    mesh.topology.create_connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    with XDMFFile(MPI.COMM_WORLD, stem + "_facets.xdmf", "r", encoding=text) as file:
        facets = file.read_meshtags(mesh, name="Grid")
    inside = ufl.Measure("dx", mesh, subdomain_data=regions)
    border = ufl.Measure("ds", mesh, subdomain_data=facets)
    between = ufl.Measure("dS", mesh, subdomain_data=facets)
    one = fem.Constant(mesh, 1.0)
    size = lambda measure, tags: {tag: fem.assemble_scalar(fem.form(one * measure(tag))) for tag in tags}
    tags = sorted(set(facets.values.tolist()))
    print(json.dumps([mesh.geometry.dim, size(inside, sorted(set(regions.values.tolist()))), size(border, tags), size(between, tags)]))
"""


def written(folder, mesh, stem="a", **options):
    for ending, data in xdmf(mesh, **options).items():
        (folder / f"{stem}{ending}.xdmf").write_bytes(data)


@tools
def test_fenicsx_finds_every_part_with_its_size(tmp_path):
    python = python_with("dolfinx")
    kinds = ("triangle", "triangle6", "tetra", "tetra10")
    for kind in kinds:
        written(tmp_path, made(kind), kind)
    written(tmp_path, made("triangle"), "timed", timed=True)
    stems = [*kinds, "timed"]
    done = subprocess.run([python, "-c", FENICSX, *stems], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("[")]
    assert len(found) == len(stems)
    for stem, (dimension, regions, border, between) in zip(stems, found, strict=True):
        areas, lengths = sizes(stem.startswith("tetra"))
        lengths = {name: length for name, length in lengths.items() if name not in PIECES}
        assert dimension == 3  # the plate lies at z = 0.5
        assert regions == pytest.approx({str(IDS[name]): area for name, area in areas.items()})
        assert border == pytest.approx({str(TAGS[name]): 0 if "__" in name else length for name, length in lengths.items()}, abs=1e-12)
        assert between == pytest.approx({str(TAGS[name]): length if "__" in name else 0 for name, length in lengths.items()}, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_meshio_finds_cells_facets_tags_and_names(tmp_path, monkeypatch, kind):
    pytest.importorskip("h5py", reason="h5py, which meshio wants for XDMF, is not installed")
    import meshio

    monkeypatch.setitem(meshio._mesh.topological_dimension, "wedge15", 3)
    mesh = made(kind)
    written(tmp_path, mesh)
    inside = 3 if mesh.solid else 2
    read = meshio.read(tmp_path / "a.xdmf")
    assert np.array_equal(read.points, mesh.points)
    assert [block.type for block in read.cells] == [kind]
    assert np.array_equal(read.cells[0].data, mesh.cells)
    assert np.array_equal(read.cell_data["region"][0], np.where(mesh.regions == -1, 5, 4))
    assert {name: list(values) for name, values in read.field_data.items()} == {name: [number, inside] for name, number in IDS.items()}
    found = {}
    for ending in ("_facets", "_ends")[: 1 + kind.startswith("wedge")]:
        part = meshio.read(tmp_path / f"a{ending}.xdmf")
        assert np.array_equal(part.points, read.points)
        for name, (number, dimension) in part.field_data.items():
            assert dimension == inside - 1
            found[name] = part.cells[0].data[part.cell_data["piece" if name in PIECES else "boundary"][0] == number].tolist()
            assert number == TAGS[name]
    assert found == {name: mesh.facets(name).tolist() for name in mesh.sides}


@pytest.mark.parametrize("kind", KINDS)
def test_pyvista_reads_it_with_a_time(tmp_path, kind):
    mesh = made(kind)
    written(tmp_path, mesh, timed=True)
    # Its own reader: with img2tri installed, pv.read takes ours.
    read = pv.XdmfReader(str(tmp_path / "a.xdmf")).read()
    assert np.array_equal(read.points[:, :2], mesh.points[:, :2])
    ((_, cells),) = read.cells_dict.items()
    assert np.array_equal(cells, mesh.cells)
    assert np.array_equal(read.cell_data["region"], np.where(mesh.regions == -1, 5, 4))
    facets = pv.XdmfReader(str(tmp_path / "a_facets.xdmf")).read()
    apart = {*PIECES, *(("z_min", "z_max") if kind.startswith("wedge") else ())}
    assert facets.n_cells == sum(len(rows) for name, rows in mesh.sides.items() if name not in apart)


@pytest.mark.parametrize("z", [0, 3])
def test_z_is_there_unless_it_is_nothing(z):
    for data in xdmf(flat_cells(*plate(), z=z)).values():
        geometry = ElementTree.fromstring(data).find(".//Geometry")
        assert geometry.get("GeometryType") == ("XYZ" if z else "XY")
        assert {row.split()[2:] == ["3.0"] for row in geometry[0].text.strip().splitlines()} == {bool(z)}


def test_the_time_changes_the_files():
    assert b"<Time " not in b"".join(xdmf(made("triangle")).values())
    assert [data.count(b"<Time ") for data in xdmf(made("triangle"), timed=True).values()] == [1, 1]


def test_texts_are_comments_and_two_hyphens_do_not_end_them():
    head = xdmf(made("triangle"))[""].decode().partition("<Xdmf")[0]
    assert "<!-- units: mm -->" in head
    text = head.partition("<!-- img2tri: ")[2].partition(" -->")[0]
    assert json.loads(text) == json.loads(TEXTS["img2tri"])


def test_names_may_hold_what_means_something_in_xml(tmp_path):
    pytest.importorskip("h5py", reason="h5py, which meshio wants for XDMF, is not installed")
    import meshio

    written(tmp_path, made("triangle", names={4: "a<b> & \"c\" ]]> 'é'"}))
    assert meshio.read(tmp_path / "a.xdmf").field_data.keys() == {"region_-1", "a<b> & \"c\" ]]> 'é'"}
