"""What programs for printing and drawing find in our files: lib3mf, ADMesh and PrusaSlicer, ezdxf and GeoPandas."""

from __future__ import annotations

import re
import subprocess

import numpy as np
import pytest
from children import PATIENCE
from views.solver_meshes import program

import img2tri

pytestmark = pytest.mark.tools
NAMES = {0xDC2828: "bone & marrow", 0x143CA0: "färg"}
COLOURS = {"bone & marrow": (220, 40, 40), "färg": (20, 60, 160), "color_14a03c": (20, 160, 60)}
AREAS = {"bone & marrow": 400.0, "färg": 1550.0, "color_14a03c": 450.0}
HEIGHTS = {0xDC2828: 2.0, 0x143CA0: 3.0, 0x14A03C: 5.0}


@pytest.fixture(scope="module")
def mesh():
    """Two rectangles, red and green, on a blue sheet of 60 by 40."""
    pixels = np.full((40, 60, 3), (20, 60, 160), np.uint8)
    pixels[10:30, 10:30], pixels[5:35, 40:55] = (220, 40, 40), (20, 160, 60)
    return img2tri.mesh_image(pixels, labels=True, edge_length=6, names=NAMES, units="cm")


def said_by(*words, folder):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_lib3mf_finds_sound_bodies_with_names_and_colours(mesh, tmp_path):
    library = pytest.importorskip("lib3mf", reason="lib3mf is not installed")
    mesh.save(tmp_path / "a.3mf", 3)
    model = library.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == library.ModelUnit.CentiMeter
    found, bodies = {}, model.GetMeshObjects()
    while bodies.MoveNext():
        body = bodies.GetCurrentMeshObject()
        assert body.IsValid()
        assert body.IsManifoldAndOriented()
        resource, entry, _ = body.GetObjectLevelProperty()
        colour = model.GetColorGroupByID(resource).GetColor(entry)
        found[body.GetName()] = colour.Red, colour.Green, colour.Blue
    assert found == COLOURS


@pytest.mark.parametrize(("height", "base"), [(3, None), (HEIGHTS, None), (HEIGHTS, 2.0)])
def test_admesh_has_nothing_to_repair(mesh, tmp_path, height, base):
    mesh.save(tmp_path / "a.stl", height, base=base)
    said = said_by(program("admesh"), "a.stl", folder=tmp_path)
    figures = {name.strip(): float(value) for name, value in re.findall(r"([A-Z][\w ]+?)\s*:\s+([\d.]+)", said)}
    assert figures["Number of parts"] == 1
    done = ("Degenerate facets", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards edges", "Normals fixed")
    assert [figures[name] for name in (*done, "Total disconnected facets")] == [0] * 8
    by_name = {mesh.names[label]: tall for label, tall in HEIGHTS.items()}
    above = sum(area * (3 if height == 3 else by_name[name]) for name, area in AREAS.items())
    assert figures["Volume"] == pytest.approx(above + (0 if base is None else base * 64 * 44), rel=1e-5)


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".obj"])
def test_prusaslicer_finds_sound_solids_and_slices_them(mesh, tmp_path, suffix):
    slicer = program("prusa-slicer")
    mesh.save(tmp_path / f"a{suffix}", 3)
    said = said_by(slicer, "--info", f"a{suffix}", folder=tmp_path)
    bodies = 3 if suffix == ".3mf" else 1
    assert said.count("manifold = yes") == bodies
    assert said.count("number_of_parts =  1") == bodies
    scale = 1000 if suffix == ".3mf" else 1  # whose unit it knows
    assert sum(map(float, re.findall(r"volume = ([\d.]+)", said))) == pytest.approx(3 * 60 * 40 * scale, rel=1e-5)
    if suffix == ".stl":
        said_by(slicer, "--export-gcode", f"a{suffix}", "-o", "a.gcode", folder=tmp_path)
        assert (tmp_path / "a.gcode").read_text().count("\nG1 ") > 100


def test_ezdxf_finds_layers_units_and_closed_outlines(mesh, tmp_path):
    library = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    mesh.save(tmp_path / "a.dxf")
    drawing = library.readfile(tmp_path / "a.dxf")
    assert not drawing.audit().errors
    assert drawing.header["$INSUNITS"] == library.units.CM
    area = {}
    for line in drawing.modelspace().query("POLYLINE"):
        assert line.is_closed
        x, y = np.array([tuple(vertex.dxf.location)[:2] for vertex in line.vertices]).T
        twice = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        area[line.dxf.layer] = area.get(line.dxf.layer, 0) + twice / 2
    assert area == pytest.approx({"bone_marrow": 400, "farg": 1550, "color_14a03c": 450})


@pytest.mark.filterwarnings("ignore:Cannot set the CRS")  # it takes all GeoJSON for degrees, and wants pyproj for them
def test_geopandas_finds_polygons_with_their_names(mesh, tmp_path):
    library = pytest.importorskip("geopandas", reason="geopandas is not installed")
    mesh.save(tmp_path / "a.geojson")
    table = library.read_file(tmp_path / "a.geojson")
    assert table.geometry.is_valid.all()
    assert dict(zip(table["name"], table.geometry.area, strict=True)) == pytest.approx(AREAS)
    assert set(table["label"]) == set(HEIGHTS)
