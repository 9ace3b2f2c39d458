from __future__ import annotations

import base64
import struct
import zlib

import meshio
import numpy as np
import pytest
import pyvista as pv
import trimesh
from views.plates import cells, ring, strip
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from img2tri.errors import FileError, Img2triError, MeshError
from img2tri.views.formats.save_load import SURFACE_FORMATS, load, save
from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid
from img2tri.views.objects.flat_or_extruded import surface
from img2tri.views.objects.solver_cells import flat_cells
from img2tri.views.objects.to_pyvista import to_pyvista

READABLE = [suffix for suffix, form in SURFACE_FORMATS.items() if form.read]


def corners_with_regions(vertices, triangles, regions):
    """Each triangle by its corners and region, in an order of its own: what must survive any renumbering."""
    first = np.argmin(vertices[triangles] @ [1, 1e-3], axis=1)
    turned = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    rows = np.column_stack([vertices[turned].reshape(-1, 6), regions])
    return rows[np.lexsort(rows.T)]


@pytest.mark.parametrize("suffix", READABLE)
def test_what_was_saved_is_loaded(tmp_path, suffix):
    vertices, triangles, regions = strip()
    path = tmp_path / f"a{suffix}"
    save(path, vertices, triangles, regions, z=3.25, cell_data={"q": np.ones(12)}, field_data={"units": "mm"})
    v, t, r = load(path)
    assert (v.shape, v.dtype) == ((14, 2), np.float64)
    assert (t.shape, t.dtype) == ((12, 3), np.int64)
    assert r.dtype == np.int64
    single, known = SURFACE_FORMATS[suffix].single, suffix not in {".stl", ".off"}
    rounded = vertices.astype(np.float32).astype(float) if single else vertices
    expected = corners_with_regions(rounded, triangles, regions if known else np.ones(12))
    assert np.array_equal(corners_with_regions(v, t, r), expected)


@pytest.mark.parametrize("suffix", READABLE)
def test_the_surface_of_a_solid_is_refused(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    save(path, *ring(), height=5)
    with pytest.raises(MeshError, match=rf"a\{suffix}: expected a plane mesh, found z from 0 to 5; .* save it without"):
        load(path)


@pytest.mark.parametrize("kind", ["ply", "obj", "off", "stl", "glb"])
def test_what_trimesh_writes_is_loaded(tmp_path, kind):
    vertices, triangles = ring()
    trimesh.Trimesh(np.column_stack([vertices, np.zeros(24)]), triangles, process=False).export(tmp_path / f"a.{kind}")
    v, t, r = load(tmp_path / f"a.{kind}")
    assert np.array_equal(corners_with_regions(v, t, r), corners_with_regions(vertices, triangles, np.ones(24)))


@pytest.mark.parametrize("kind", ["ply", "stl", "vtp"])
def test_what_pyvista_writes_is_loaded(tmp_path, kind):
    vertices, triangles = ring()
    to_pyvista(surface(vertices, triangles)).save(tmp_path / f"a.{kind}")
    v, t, r = load(tmp_path / f"a.{kind}")
    assert np.array_equal(corners_with_regions(v, t, r), corners_with_regions(vertices, triangles, np.ones(24)))


def test_what_meshio_writes_is_loaded(tmp_path):
    vertices, triangles, regions = strip()
    points = np.column_stack([vertices, np.zeros(14)])
    lines = [[0, 1], [1, 2]]
    blocks = [("line", lines), ("triangle", triangles)]
    meshio.Mesh(points, blocks, cell_data={"region": [np.array([8, 9]), regions]}).write(tmp_path / "a.vtu")
    v, t, r = load(tmp_path / "a.vtu")
    assert np.array_equal(v, vertices)
    assert np.array_equal(t, triangles)
    assert np.array_equal(r, regions)


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("compressed", [True, False])
@pytest.mark.parametrize("wide", [True, False])
@pytest.mark.parametrize("way", ["ascii", "binary", "appended", "raw"])
def test_every_way_vtk_writes_xml_is_read(tmp_path, grid, compressed, wide, way):
    # Enough cells for several blocks of compression.
    vertices, triangles = cells(np.ones((60, 80), bool))
    regions = np.arange(len(triangles)) % 5
    writer = vtkXMLUnstructuredGridWriter() if grid else vtkXMLPolyDataWriter()
    writer.SetInputData(to_grid(flat_cells(vertices, triangles, regions)) if grid else to_pyvista(surface(vertices, triangles, regions)))
    writer.SetFileName(str(tmp_path / ("a.vtu" if grid else "a.vtp")))
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(way, writer.SetDataModeToAppended)()
    writer.SetEncodeAppendedData(way != "raw")
    writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
    writer.SetCompressorTypeToZLib() if compressed else writer.SetCompressorTypeToNone()
    writer.SetByteOrderToBigEndian()
    assert writer.Write()
    v, t, r = load(writer.GetFileName())
    assert np.array_equal(v, vertices)
    assert np.array_equal(t, triangles)
    assert np.array_equal(r, regions)


def test_lines_and_vertices_of_polydata_are_passed_over(tmp_path):
    vertices, triangles, regions = strip()
    made = to_pyvista(surface(vertices, triangles))
    made = pv.PolyData(made.points, faces=made.faces, lines=[2, 0, 1, 2, 1, 2], verts=[1, 4])
    made.cell_data["region"] = np.concatenate([[91, 92, 93], regions]).astype(np.int32)
    made.save(tmp_path / "a.vtp")
    _, t, r = load(tmp_path / "a.vtp")
    assert np.array_equal(t, triangles)
    assert np.array_equal(r, regions)


def test_pieces_are_joined(tmp_path):
    piece = """<Piece NumberOfPoints="3" NumberOfCells="1">
    <Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
    <Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray>
    <DataArray type="Int32" Name="offsets" format="ascii">3</DataArray>
    <DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells>
    <CellData><DataArray type="Int32" Name="region" format="ascii">{region}</DataArray></CellData></Piece>"""
    pieces = piece.format(points="0 0 0 1 0 0 0 1 0", region=4) + piece.format(points="5 5 0 6 5 0 5 6 0", region=2)
    head = '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
    (tmp_path / "a.vtu").write_text(f"{head}{pieces}</UnstructuredGrid></VTKFile>")
    v, t, r = load(tmp_path / "a.vtu")
    assert t.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert v[3].tolist() == [5, 5]
    assert r.tolist() == [4, 2]


def test_a_clockwise_mesh_is_turned_over_but_single_triangles_stay(tmp_path):
    vertices, triangles = ring()
    save(tmp_path / "a.ply", vertices, triangles[:, ::-1])
    v, t, _ = load(tmp_path / "a.ply")
    p, q, r = (v[t[:, k]] for k in range(3))
    assert np.all(np.cross(np.pad(q - p, [(0, 0), (0, 1)]), np.pad(r - p, [(0, 0), (0, 1)]))[:, 2] > 0)
    one = triangles.copy()
    one[0] = one[0, ::-1]
    save(tmp_path / "b.ply", vertices, one)
    assert np.array_equal(load(tmp_path / "b.ply")[1], one)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileError, match=r"none\.stl: cannot be read: No such file or directory"):
        load(tmp_path / "none.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(FileError, match=r"folder\.stl: cannot be read: Is a directory"):
        load(tmp_path / "folder.stl")


def test_an_unknown_suffix_lists_the_known_ones(tmp_path):
    with pytest.raises(FileError, match=r"ends in \.bdf, \.glb, \.msh, \.obj, \.off, \.ply, \.stl, \.vtp or \.vtu, found '\.3mf'"):
        load(tmp_path / "a.3mf")


def test_cells_that_are_no_triangles_are_refused(tmp_path):
    plane = pv.Plane(i_resolution=2, j_resolution=2)
    plane.save(tmp_path / "a.vtp")
    plane.cast_to_unstructured_grid().save(tmp_path / "a.vtu")
    for suffix in ("vtp", "vtu"):
        with pytest.raises(MeshError, match=f"a.{suffix}: expected triangles only, found cells of another kind; triangulate it first"):
            load(tmp_path / f"a.{suffix}")


def test_a_file_without_triangles_is_refused(tmp_path):
    pv.PolyData([[0.0, 0, 0], [1, 0, 0]]).save(tmp_path / "a.vtp")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (tmp_path / "a.stl").write_bytes(bytes(84))
    for suffix in ("vtp", "obj", "stl"):
        with pytest.raises(Img2triError, match=rf"a\.{suffix}: "):
            load(tmp_path / f"a.{suffix}")


def test_regions_have_to_be_whole_numbers(tmp_path):
    made = to_pyvista(surface(*ring()))
    made.cell_data["region"] = np.linspace(0, 1, 24)
    made.save(tmp_path / "a.vtp")
    with pytest.raises(MeshError, match="region: expected whole numbers, found others"):
        load(tmp_path / "a.vtp")
    made.cell_data["region"] = np.full(24, 4.0)
    made.save(tmp_path / "a.vtp")
    assert set(load(tmp_path / "a.vtp")[2].tolist()) == {4}


@pytest.mark.parametrize("suffix", READABLE)
def test_a_damaged_file_is_an_error_of_its_own_or_still_a_mesh(tmp_path, suffix):
    vertices, triangles, regions = strip()
    path = tmp_path / f"a{suffix}"
    save(path, vertices, triangles, regions)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    damaged = [b"", b"\x00", b"no mesh at all " * 9, *(whole[: int(share * len(whole))] for share in (0.1, 0.5, 0.9, 0.99))]
    for _ in range(60):
        one = bytearray(whole)
        for place in rng.integers(len(one), size=rng.integers(1, 4)):
            one[place] = rng.integers(256)
        damaged.append(bytes(one))
    refused = kept = 0
    for data in damaged:
        path.write_bytes(data)
        try:
            v, t, r = load(path)
        except Img2triError as problem:
            refused += str(path) in str(problem)
        else:
            assert np.isfinite(v).all()
            assert 0 <= t.min() <= t.max() < len(v)
            assert len(r) == len(t)
            kept += 1
    assert refused + kept == len(damaged)
    assert refused >= 4


def compressed_array(blocks, length, last, sizes, data):
    head = struct.pack(f"<{3 + len(sizes)}I", blocks, length, last, *sizes)
    return (base64.b64encode(head) + base64.b64encode(data)).decode()


@pytest.mark.parametrize(
    "array",
    [
        compressed_array(0xF4000001, 32768, 0, [8], b"12345678"),  # VTK ends the process here
        compressed_array(1, 2**31, 0, [len(zlib.compress(bytes(72)))], zlib.compress(bytes(72))),
        compressed_array(1, 72, 0, [2**31], zlib.compress(bytes(72))),
        compressed_array(1, 72, 0, [20], b"this is no zlib data"),
        "AAAA",
        "",
    ],
)
def test_sizes_that_cannot_be_are_refused(tmp_path, array):
    text = f"""<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" compressor="vtkZLibDataCompressor"><UnstructuredGrid>
    <Piece NumberOfPoints="3" NumberOfCells="1"><Points><DataArray type="Float64" format="binary">{array}</DataArray></Points></Piece>
    </UnstructuredGrid></VTKFile>"""
    (tmp_path / "a.vtu").write_text(text)
    with pytest.raises(FileError, match=r"a\.vtu: cannot be read as \.vtu"):
        load(tmp_path / "a.vtu")


@pytest.mark.parametrize(("offsets", "points"), [("9", "Points"), ("-3", "Points"), ("3", "Nothing")])
def test_cells_and_points_that_do_not_fit_together_are_refused(tmp_path, offsets, points):
    text = f"""<VTKFile type="UnstructuredGrid" byte_order="LittleEndian"><UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1">
    <{points}><DataArray type="Float64" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></{points}>
    <Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray>
    <DataArray type="Int32" Name="offsets" format="ascii">{offsets}</DataArray>
    <DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"""
    (tmp_path / "a.vtu").write_text(text)
    with pytest.raises(FileError, match=r"cannot be read as \.vtu: (its cells do not fit together|an array is missing)"):
        load(tmp_path / "a.vtu")
