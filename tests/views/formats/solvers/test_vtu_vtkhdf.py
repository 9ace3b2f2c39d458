"""VTU and VTKHDF with named parts read back: by VTK through pyvista, by meshio, and by h5py."""

from __future__ import annotations

import json

import meshio
import numpy as np
import pytest
import pyvista as pv
from views.plates import cells
from views.solver_meshes import KINDS, TEXTS, made, plate

from img2tri.errors import FileError
from img2tri.views.formats.readers.read_any import read_file
from img2tri.views.formats.readers.read_vtp_vtu import by_xml
from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid, vtkhdf, vtu
from img2tri.views.objects.solver_cells import Cells, flat_cells

VTK_TYPES = {"triangle": 5, "triangle6": 22, "wedge": 13, "wedge15": 26, "tetra": 10, "tetra10": 24}
WRITERS = {".vtu": vtu, ".vtkhdf": vtkhdf}


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("kind", KINDS)
def test_pyvista_finds_cells_values_and_named_parts(tmp_path, kind, suffix):
    mesh = made(kind, cell_data={"q": np.linspace(0, 1, 34)})
    (tmp_path / f"a{suffix}").write_bytes(WRITERS[suffix](mesh)[""])
    read = pv.read(tmp_path / f"a{suffix}")
    assert read.points.dtype == np.float64
    assert np.array_equal(read.points, mesh.points)
    assert np.array_equal(read.cells_dict[VTK_TYPES[kind]], mesh.cells)
    assert np.array_equal(read.cell_data["region"], mesh.regions)
    assert np.array_equal(read.cell_data["q"], mesh.cell_data["q"])
    fields = {name: np.asarray(read.field_data[name]) for name in read.field_data}
    for name in mesh.sides:
        assert np.array_equal(fields.pop(name), mesh.facets(name))
    for label, name in mesh.names.items():
        assert fields.pop(name).tolist() == [label]
    assert {name: str(values[0]) for name, values in fields.items()} == (TEXTS if suffix == ".vtkhdf" else {})


@pytest.mark.parametrize("kind", KINDS)
def test_meshio_finds_the_named_parts_of_a_vtu(tmp_path, monkeypatch, kind):
    monkeypatch.setitem(meshio._mesh.topological_dimension, "wedge15", 3)
    mesh = made(kind)
    (tmp_path / "a.vtu").write_bytes(vtu(mesh)[""])
    read = meshio.read(tmp_path / "a.vtu")
    assert np.array_equal(read.points, mesh.points)
    assert [block.type for block in read.cells] == [kind]
    # meshio goes by the manual of VTK, which has linear wedges the other way round than VTK computes, and mirrors them.
    assert np.array_equal(read.cells[0].data, mesh.cells[:, [0, 2, 1, 3, 5, 4]] if kind == "wedge" else mesh.cells)
    assert np.array_equal(read.cell_data["region"][0], mesh.regions)
    expected = {name: mesh.facets(name).tolist() for name in mesh.sides} | {name: [label] for label, name in mesh.names.items()}
    assert {name: values.tolist() for name, values in read.field_data.items()} == expected


def test_texts_of_a_vtu_are_comments():
    head = vtu(made("triangle"))[""].decode().partition("<UnstructuredGrid")[0]
    assert "<!-- units: mm -->" in head
    assert json.loads(head.partition("<!-- img2tri: ")[2].partition(" -->")[0]) == json.loads(TEXTS["img2tri"])


def test_our_own_reader_reads_the_triangles_of_a_vtu():
    mesh = made("triangle")
    points, triangles, regions = by_xml(vtu(mesh)[""], ".vtu")
    assert np.array_equal(points, mesh.points)
    assert np.array_equal(triangles, mesh.cells)
    assert np.array_equal(regions, mesh.regions)


@pytest.mark.tools
@pytest.mark.parametrize("kind", KINDS)
def test_h5py_finds_a_vtkhdf_as_vtk_describes_it(tmp_path, kind):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed")
    mesh = made(kind)
    (tmp_path / "a.vtkhdf").write_bytes(vtkhdf(mesh)[""])
    with h5py.File(tmp_path / "a.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"UnstructuredGrid"
        assert np.array_equal(root["Points"], mesh.points)
        assert np.array_equal(root["Connectivity"][()].reshape(mesh.cells.shape), mesh.cells)
        assert set(root["Types"][()].tolist()) == {VTK_TYPES[kind]}
        assert np.array_equal(root["CellData/region"], mesh.regions)
        for name in mesh.sides:
            assert np.array_equal(root[f"FieldData/{name}"], mesh.facets(name))
        assert root["FieldData/units"][0] == b"mm"


def test_a_small_mesh_is_a_small_vtkhdf():
    assert len(vtkhdf(made("triangle"))[""]) < 100_000


def test_values_that_look_like_a_stamp_stay(tmp_path):
    labels = np.tile([0x00080012, 0, 1, 77], 9)[:34]
    mesh = made("triangle")
    stamped = Cells(**{**vars(mesh), "cell_data": {"a": labels.astype(np.int32)}})
    (tmp_path / "a.vtkhdf").write_bytes(vtkhdf(stamped)[""])
    assert np.array_equal(pv.read(tmp_path / "a.vtkhdf")["a"], labels)


def test_names_hold_only_what_vtk_writes_rightly(tmp_path):
    mesh = made("triangle", names={4: 'a/<b> & "c", é (1.5)'})
    for suffix, write in WRITERS.items():
        (tmp_path / f"a{suffix}").write_bytes(write(mesh)[""])
        assert "a__b_ _ _c_, é (1.5)" in pv.read(tmp_path / f"a{suffix}").field_data


def test_grids_carry_texts_if_wanted():
    assert to_grid(made("triangle")).field_data["units"][0] == "mm"
    assert "units" not in to_grid(made("triangle"), texts=False).field_data


class Failing:
    """A writer of VTK that says that it could not write."""

    def __getattr__(self, name):
        return lambda *_: 0


def test_a_failure_of_vtk_is_an_error(monkeypatch):
    monkeypatch.setattr("vtkmodules.vtkIOHDF.vtkHDFWriter", Failing)
    with pytest.raises(FileError, match="VTK could not write the mesh"):
        vtkhdf(made("triangle"))


def test_many_named_parts_take_little_room(tmp_path):
    """Each set once took a whole chunk of 25,000 rows: 200 regions made 264 MB."""
    vertices, triangles = cells(np.ones((20, 20), bool))
    mesh = flat_cells(vertices, triangles, np.arange(len(triangles)) // 2)
    data = vtkhdf(mesh)[""]
    assert len(mesh.sides) > 700
    assert len(data) < 4000 * (len(mesh.sides) + len(mesh.names))
    (tmp_path / "a.vtkhdf").write_bytes(data)
    assert np.array_equal(pv.read(tmp_path / "a.vtkhdf").field_data["region_5__region_6"], mesh.facets("region_5__region_6"))


@pytest.mark.parametrize("suffix", WRITERS)
def test_labels_beyond_32_bits_are_kept(tmp_path, suffix):
    vertices, triangles, regions = plate()
    labels = np.where(regions == 4, 720575940610453042, 2**32 + 5)
    (tmp_path / f"a{suffix}").write_bytes(WRITERS[suffix](flat_cells(vertices, triangles, labels))[""])
    assert np.array_equal(pv.read(tmp_path / f"a{suffix}")["region"], labels)
    assert read_file(tmp_path / f"a{suffix}").names == {label: f"region_{label}" for label in np.unique(labels).tolist()}
