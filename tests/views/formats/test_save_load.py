from __future__ import annotations

import io
import json
import struct
import subprocess
import sys
import time
import zipfile
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import pyvista as pv
import trimesh
from views.plates import STRIP_AREA, is_closed, ring, strip, volume

from img2tri.errors import FileError
from img2tri.views.formats.save_load import SURFACE_FORMATS, save

HEIGHT = 1.5
TEXTS = {"units": "cm", "made": json.dumps({"edge": "--8px", "name": "Ü\n<&>"})}


def read_stl(path):
    """Normals (k, 3) and corners (k, 3, 3), read byte by byte."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count
    rows = [struct.unpack_from("<12fH", data, 84 + 50 * i) for i in range(count)]
    return np.array([row[:3] for row in rows]), np.array([row[3:12] for row in rows]).reshape(-1, 3, 3)


def read_obj(path):
    points, faces, groups, group = [], [], [], ""
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "v":
            points.append([float(x) for x in rest])
        elif word == "g":
            (group,) = rest
        elif word == "f":
            faces.append([int(x) - 1 for x in rest])
            groups.append(int(group.removeprefix("region_")))
    return np.array(points), np.array(faces), np.array(groups)


def read_3mf(path):
    space = {"c": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    material = "{http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
        for name in archive.namelist():
            ElementTree.fromstring(archive.read(name))
        root = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    points = [[float(v.attrib[axis]) for axis in "xyz"] for v in root.iterfind(".//c:vertex", space)]
    rows = [[int(t.attrib.get(key, 0)) for key in ("v1", "v2", "v3", "p1")] for t in root.iterfind(".//c:triangle", space)]
    colours = [colour.attrib["color"] for colour in root.iter(f"{material}color")]
    notes = {note.attrib["name"]: note.text for note in root.iterfind("c:metadata", space)}
    faces = np.array(rows)
    return root, np.array(points), faces[:, :3], faces[:, 3], colours, notes


@pytest.fixture
def plate():
    vertices, triangles, regions = strip()
    return {"vertices": vertices, "triangles": triangles, "regions": regions}


def test_stl_by_bytes(tmp_path, plate):
    save(tmp_path / "a.stl", **plate, height=HEIGHT)
    normals, corners = read_stl(tmp_path / "a.stl")
    assert not (tmp_path / "a.stl").read_bytes().startswith(b"solid")  # which readers take for the text format
    _, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    assert is_closed(faces.reshape(-1, 3))
    assert volume(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)) == pytest.approx(STRIP_AREA * HEIGHT, rel=1e-6)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert normals == pytest.approx(across / np.linalg.norm(across, axis=1, keepdims=True), abs=1e-6)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".off", ".vtu"])
def test_read_by_meshio(tmp_path, plate, suffix):
    path = tmp_path / f"a{suffix}"
    save(path, **plate, z=0.25, field_data=TEXTS)
    read = meshio.read(path)
    faces = read.cells_dict["triangle"]
    assert len(faces) == len(plate["triangles"])
    p, q, r = (np.asarray(read.points, float)[faces[:, k]] for k in range(3))
    assert np.cross(q - p, r - p)[:, 2].sum() / 2 == pytest.approx(STRIP_AREA, rel=1e-6)
    assert np.all(read.points[:, 2] == 0.25)
    if suffix == ".vtu":
        assert np.array_equal(read.points[:, :2], plate["vertices"])
        assert np.array_equal(read.cell_data["region"][0], plate["regions"])


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".off", ".3mf", ".glb"])
def test_a_solid_read_by_trimesh(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    save(path, *ring(), height=2, z=1)
    read = trimesh.load_mesh(path, process=True)
    assert read.is_watertight
    assert read.is_winding_consistent
    assert read.volume == pytest.approx(24)
    assert read.euler_number == 0
    assert read.bounds.tolist() == [[0, 0, 1], [4, 4, 3]]
    assert len(read.faces) == 96


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".vtp", ".vtu"])
def test_a_solid_read_by_pyvista(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    save(path, *ring(), height=2, z=1)
    read = pv.read(path)
    read = (read if suffix == ".vtp" else read.extract_surface(algorithm=None) if suffix == ".vtu" else read).clean()
    assert read.n_cells == 96
    assert read.n_points == 48
    assert read.n_open_edges == 0
    assert read.volume == pytest.approx(24)
    assert read.bounds == (0, 4, 0, 4, 1, 3)


def test_ply_keeps_every_digit_regions_values_and_texts(tmp_path, plate):
    q = np.linspace(0.1, 0.9, len(plate["triangles"]))
    save(tmp_path / "a.ply", **plate, cell_data={"q": q, "rank": np.arange(12), "good one": q > 0.5}, field_data=TEXTS)
    read = trimesh.load_mesh(tmp_path / "a.ply", process=False)
    assert np.array_equal(read.vertices[:, :2], plate["vertices"])
    assert np.array_equal(read.faces, plate["triangles"])
    stored = read.metadata["_ply_raw"]["face"]["data"]
    assert stored["region"].dtype == np.int32
    assert np.array_equal(stored["region"], plate["regions"])
    assert np.array_equal(stored["q"], q)
    assert np.array_equal(stored["rank"], np.arange(12))
    assert np.array_equal(stored["good_one"], q > 0.5)
    header = (tmp_path / "a.ply").read_bytes().split(b"end_header\n")[0].decode("ascii").splitlines()
    assert "comment units: cm" in header
    assert [line for line in header if "edge" in line] == [f"comment made: {TEXTS['made']}"]


def test_ply_values_may_have_any_name(tmp_path, plate):
    names = ["count", "corners", "x", "n"]
    save(tmp_path / "a.ply", **plate, cell_data={name: np.full(12, i) for i, name in enumerate(names)})
    stored = trimesh.load_mesh(tmp_path / "a.ply", process=False).metadata["_ply_raw"]["face"]["data"]
    assert [int(stored[name][0]) for name in names] == [0, 1, 2, 3]


def test_obj_keeps_every_digit_and_regions_as_groups(tmp_path, plate):
    save(tmp_path / "a.obj", **plate, field_data=TEXTS)
    points, faces, groups = read_obj(tmp_path / "a.obj")
    assert np.array_equal(points[:, :2], plate["vertices"])
    for region in (3, 7):
        assert np.array_equal(faces[groups == region], plate["triangles"][plate["regions"] == region])
    assert (tmp_path / "a.obj").read_text().startswith("# units: cm\n# made: {")


def test_off_keeps_every_digit(tmp_path, plate):
    save(tmp_path / "a.off", **plate)
    lines = (tmp_path / "a.off").read_text().splitlines()
    assert lines[:2] == ["OFF", "14 12 0"]
    assert np.array_equal(np.loadtxt(lines[2:16])[:, :2], plate["vertices"])
    assert np.array_equal(np.loadtxt(lines[16:], int), np.column_stack([np.full(12, 3), plate["triangles"]]))


def test_3mf_has_a_closed_object_in_its_colour_for_each_region(tmp_path, plate):
    """One colour in each group, and the group at the object: what slicers make filaments of."""
    save(tmp_path / "a.3mf", **plate, height=HEIGHT, names={3: 'bone "<a>"'}, field_data=TEXTS)
    root, *_, notes = read_3mf(tmp_path / "a.3mf")
    assert root.attrib["unit"] == "centimeter"
    space = {name: f"http://schemas.microsoft.com/3dmanufacturing/{long}/2015/02" for name, long in {"c": "core", "m": "material"}.items()}
    groups = {group.attrib["id"]: [c.attrib["color"] for c in group] for group in root.iterfind(".//m:colorgroup", space)}
    assert len(groups) == 2
    assert all(len(colours) == 1 for colours in groups.values())
    assert len({colour for (colour,) in groups.values()}) == 2
    objects = root.findall(".//c:object", space)
    assert [o.attrib["name"] for o in objects] == ['bone "<a>"', "region_7"]
    assert {(o.attrib["type"], o.attrib["pindex"]) for o in objects} == {("model", "0")}
    assert [o.attrib["pid"] for o in objects] == list(groups)
    assert [item.attrib["objectid"] for item in root.iterfind("c:build/c:item", space)] == [o.attrib["id"] for o in objects]
    assert len({r.attrib["id"] for r in root.find("c:resources", space)}) == 4
    for o, side in zip(objects, (-1, 1), strict=True):
        points = np.array([[float(v.attrib[axis]) for axis in "xyz"] for v in o.iterfind(".//c:vertex", space)])
        faces = np.array([[int(t.attrib[key]) for key in ("v1", "v2", "v3")] for t in o.iterfind(".//c:triangle", space)])
        assert is_closed(faces)
        assert volume(points, faces) == pytest.approx(STRIP_AREA * HEIGHT / 2, rel=1e-12)
        assert np.all(side * (points[:, 0] - 1.1) >= -1e-12)
    assert notes["img2tri:regions"] == "3 7"
    assert json.loads(notes["img2tri:made"].replace("\\xdc", "\\u00dc")) == json.loads(TEXTS["made"])


def test_3mf_of_a_flat_mesh_has_a_colour_for_each_triangle(tmp_path, plate):
    save(tmp_path / "a.3mf", **plate)
    _, points, faces, colour, colours, _ = read_3mf(tmp_path / "a.3mf")
    assert len(set(colours)) == 2
    middle = points[faces][..., 0].mean(axis=1)
    assert np.all(middle[colour == 0] < 1.1)
    assert np.all(middle[colour == 1] > 1.1)


def test_3mf_of_several_regions_is_read_by_trimesh(tmp_path, plate):
    save(tmp_path / "a.3mf", **plate, height=HEIGHT, names={3: "bone"})
    scene = trimesh.load_scene(tmp_path / "a.3mf")
    assert len(scene.geometry) == 2
    assert all(body.is_watertight and body.volume == pytest.approx(STRIP_AREA * HEIGHT / 2) for body in scene.geometry.values())


def test_3mf_is_in_millimetres_and_an_open_mesh_is_a_surface(tmp_path, plate):
    space = {"c": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    save(tmp_path / "flat.3mf", **plate)
    save(tmp_path / "solid.3mf", **plate, height=1)
    flat, solid = read_3mf(tmp_path / "flat.3mf")[0], read_3mf(tmp_path / "solid.3mf")[0]
    assert flat.attrib["unit"] == "millimeter"
    assert flat.find(".//c:object", space).attrib["type"] == "surface"
    assert solid.find(".//c:object", space).attrib["type"] == "model"


def test_glb_has_a_mesh_in_its_colour_for_each_region(tmp_path, plate):
    save(tmp_path / "a.glb", **plate, field_data=TEXTS)
    scene = trimesh.load_scene(tmp_path / "a.glb")
    assert set(scene.geometry) == {"region_3", "region_7"}
    assert scene.metadata["units"] == "cm"
    colours = {tuple(part.visual.material.baseColorFactor) for part in scene.geometry.values()}
    assert len(colours) == 2
    for name, region in (("region_3", 3), ("region_7", 7)):
        assert scene.geometry[name].area == pytest.approx(STRIP_AREA / 2)
        assert scene.geometry[name].metadata["region"] == region


@pytest.mark.parametrize("suffix", [".vtp", ".vtu"])
def test_vtk_files_keep_everything(tmp_path, plate, suffix):
    q = np.linspace(0.1, 0.9, 12)
    save(tmp_path / f"a{suffix}", **plate, z=-2.0, cell_data={"q": q}, field_data=TEXTS)
    read = pv.read(tmp_path / f"a{suffix}")
    assert read.points.dtype == np.float64
    assert np.array_equal(read.points[:, :2], plate["vertices"])
    assert np.all(read.points[:, 2] == -2)
    assert read.cell_data["region"].dtype == np.int32
    assert np.array_equal(read.cell_data["region"], plate["regions"])
    assert np.array_equal(read.cell_data["q"], q)
    if suffix == ".vtp":
        assert read.field_data["units"][0] == "cm"
        assert read.field_data["made"][0] == TEXTS["made"]
    else:
        assert b"<!-- units: cm -->" in (tmp_path / "a.vtu").read_bytes()
        assert b'{"edge": "-\\u002d8px"' in (tmp_path / "a.vtu").read_bytes()


def test_the_same_mesh_gives_the_same_bytes_at_any_time_in_any_process(tmp_path, monkeypatch):
    code = """
import sys
from img2tri.views.formats.save_load import SURFACE_FORMATS, save
vertices, triangles = [[0, 0], [1, 0], [1, 1], [0, 1 / 3]], [[0, 1, 2], [0, 2, 3]]
for suffix in SURFACE_FORMATS:
    for name, height in (("flat", None), ("solid", 2.0)):
        options = {"height": height, "cell_data": {"q": [0.1, 0.2]}, "field_data": {"b": "1", "a": "2"}}
        save(f"{folder}/{name}{suffix}", vertices, triangles, [3, 7], **options)
"""
    there, here = tmp_path / "there", tmp_path / "here"
    there.mkdir()
    here.mkdir()
    subprocess.run([sys.executable, "-c", f"folder = {str(there)!r}\n{code}"], check=True)
    later = time.time() + 1e8
    monkeypatch.setattr(time, "time", lambda: later)
    exec(code, {"folder": str(here)})
    assert len(list(here.iterdir())) == 2 * len(SURFACE_FORMATS)
    for path in here.iterdir():
        assert path.read_bytes() == (there / path.name).read_bytes(), path.name


@pytest.mark.parametrize("suffix", list(SURFACE_FORMATS))
def test_the_options_change_the_file(tmp_path, plate, suffix):
    """Each of z, height and regions; cell_data and field_data where the format can hold them."""

    def written(**options):
        save(tmp_path / f"a{suffix}", **{**plate, **options})
        return (tmp_path / f"a{suffix}").read_bytes()

    plain = written()
    assert written(z=1.0) != plain
    assert written(height=1.0) != plain
    assert (written(regions=None) != plain) == (suffix not in {".stl", ".off"})
    assert (written(cell_data={"q": np.ones(12)}) != plain) == (suffix in {".ply", ".vtp", ".vtu"})
    assert (written(field_data={"units": "m"}) != plain) == (suffix not in {".stl", ".off"})


def test_the_suffix_may_be_in_capitals(tmp_path, plate):
    save(tmp_path / "A.STL", **plate)
    assert len(read_stl(tmp_path / "A.STL")[0]) == 12


@pytest.mark.parametrize("suffix", [".stl", ".glb"])
def test_a_mesh_that_float32_cannot_hold_is_refused(tmp_path, suffix):
    vertices, triangles, regions = strip()
    path = tmp_path / f"far{suffix}"
    words = r"far\.\w+: holds coordinates as float32, .* coordinates up to 5e\+06, \d+ of \d+ triangles would collapse .* save it as \.ply"
    with pytest.raises(FileError, match=words):
        save(path, vertices * 0.1 + 5e6, triangles, regions)
    with pytest.raises(FileError, match="float32"):
        save(path, vertices * 1e39, triangles, regions)
    with pytest.raises(FileError, match="float32"):
        save(path, vertices, triangles, regions, z=1e6, height=1e-3)
    assert not list(tmp_path.iterdir())
    # The same place is no trouble for triangles of its size, nor for a format with all digits.
    save(path, vertices * 100 + 5e6, triangles, regions)
    save(tmp_path / "far.ply", vertices * 0.1 + 5e6, triangles, regions)


def test_two_vertices_that_float32_makes_one_are_refused(tmp_path):
    # Two triangles that all but touch, tip to tip: neither collapses, but they would share a point.
    vertices = [[1, 0], [0, 1], [0, -1], [1 + 1e-9, 0], [2, -1], [2, 1]]
    triangles = [[0, 1, 2], [3, 4, 5]]
    with pytest.raises(FileError, match="0 of 2 triangles would collapse and 1 vertices fall together"):
        save(tmp_path / "a.stl", vertices, triangles)
    save(tmp_path / "a.obj", vertices, triangles)


def test_a_triangle_of_no_area_is_written_as_it_is(tmp_path):
    save(tmp_path / "a.stl", [[0, 0], [1, 0], [2, 0]], [[0, 1, 2]])
    normals, _ = read_stl(tmp_path / "a.stl")
    assert normals.tolist() == [[0, 0, 0]]


def test_colours_are_apart():
    from img2tri.views.figures.region_colours import palette

    colours = palette(60).astype(int)
    assert len(np.unique(colours, axis=0)) == 60
    apart = np.abs(colours[:24, None] - colours[None, :24]).sum(axis=2) + 999 * np.eye(24)
    assert apart.min() > 40
    assert np.array_equal(palette(5), palette(60)[:5])


def test_bytes_of_a_zip_hold_no_clock(tmp_path, plate):
    save(tmp_path / "a.3mf", **plate)
    with zipfile.ZipFile(io.BytesIO((tmp_path / "a.3mf").read_bytes())) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
