from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from views.plates import STRIP_AREA, ring, strip
from views.solver_meshes import elements

from img2tri.errors import MeshError, ParameterError
from img2tri.views.objects.flat_or_extruded import surface
from img2tri.views.objects.to_pyvista import to_pyvista
from img2tri.views.objects.to_trimesh import to_trimesh


def test_trimesh_flat():
    vertices, triangles, regions = strip()
    q = np.linspace(0.5, 1, len(triangles))
    made = to_trimesh(surface(vertices, triangles, regions, z=2.0, cell_data={"q": q}, field_data={"units": "mm", "recipe": "x"}))
    assert np.array_equal(made.vertices, np.column_stack([vertices, np.full(len(vertices), 2.0)]))
    assert np.array_equal(made.faces, triangles)
    assert made.face_attributes["region"].dtype == np.int32
    assert np.array_equal(made.face_attributes["region"], regions)
    assert np.array_equal(made.face_attributes["q"], q)
    assert made.units == "mm"
    assert made.metadata["regions"] == [3, 7]
    assert made.metadata["recipe"] == "x"
    assert made.area == pytest.approx(STRIP_AREA)


def test_trimesh_solid():
    vertices, triangles = ring()
    made = to_trimesh(surface(vertices, triangles, height=2))
    assert made.is_watertight
    assert made.is_winding_consistent
    assert made.is_volume
    assert made.volume == pytest.approx(24)
    assert made.euler_number == 0
    assert made.bounds.tolist() == [[0, 0, 0], [4, 4, 2]]


def test_trimesh_exports_of_the_object_work_too():
    vertices, triangles, regions = strip()
    made = to_trimesh(surface(vertices, triangles, regions))
    for kind in ("stl", "ply", "obj"):
        assert made.export(file_type=kind)


def test_pyvista_flat():
    vertices, triangles, regions = strip()
    q = np.linspace(0.5, 1, len(triangles))
    made = to_pyvista(surface(vertices, triangles, regions, z=2.0, cell_data={"q": q}, field_data={"units": "µm"}))
    assert made.points.dtype == np.float64
    assert np.array_equal(made.points[:, :2], vertices)
    assert np.all(made.points[:, 2] == 2)
    assert np.array_equal(made.regular_faces, triangles)
    assert made.cell_data["region"].dtype == np.int32
    assert np.array_equal(made.cell_data["region"], regions)
    assert np.array_equal(made.cell_data["q"], q)
    assert made.active_scalars_name == "region"
    assert made.field_data["units"][0] == "\\xb5m"
    assert made.area == pytest.approx(STRIP_AREA)


def test_pyvista_solid():
    made = to_pyvista(surface(*ring(), height=2))
    assert made.is_all_triangles
    assert made.n_open_edges == 0
    assert made.is_manifold
    assert made.volume == pytest.approx(24)
    assert made.bounds == (0, 4, 0, 4, 0, 2)


def test_pyvista_grid():
    vertices, triangles, regions = strip()
    made = elements(vertices, triangles, regions)
    assert np.array_equal(made.cells_dict[5], triangles)
    assert made.points.dtype == np.float64
    assert np.array_equal(made.cell_data["region"], regions)


def test_faces_of_a_solid_keep_region_and_values():
    vertices, triangles, regions = strip()
    q = np.linspace(0.5, 1, len(triangles))
    made = to_pyvista(surface(vertices, triangles, regions, height=1.5, cell_data={"q": q}))
    # Each face lies at the triangle whose value it has.
    middles = made.cell_centers().points[:, :2]
    for middle, value, region in zip(middles, made.cell_data["q"], made.cell_data["region"], strict=True):
        t = np.flatnonzero(q == value)[0]
        corners = vertices[triangles[t]]
        assert np.all(middle >= corners.min(axis=0) - 1e-12)
        assert np.all(middle <= corners.max(axis=0) + 1e-12)
        assert region == regions[t]
    assert made.n_open_edges == 0
    assert made.volume == pytest.approx(STRIP_AREA * 1.5)


def test_without_regions_all_is_region_one():
    assert set(surface(*ring()).regions.tolist()) == {1}


def test_an_stl_is_written_without_loading_any_heavy_library(tmp_path):
    code = """
import sys, img2tri.views.formats.save_load, img2tri.views.figures.plot
img2tri.views.formats.save_load.save(sys.argv[1], [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], height=1)
print(sorted({"trimesh", "pyvista", "vtkmodules", "matplotlib", "scipy", "cv2", "igl"} & set(sys.modules)))
"""
    run = subprocess.run([sys.executable, "-c", code, tmp_path / "x.stl"], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
    assert (tmp_path / "x.stl").stat().st_size == 84 + 50 * 8


CORNER = ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])


@pytest.mark.parametrize(
    ("arrays", "options", "words"),
    [
        (([[0, 0, 0]] * 3, [[0, 1, 2]]), {}, r"vertices: expected shape \(n, 2\), found \(3, 3\)"),
        (([[0, 0], [1, 0], [0, np.nan]], [[0, 1, 2]]), {}, "vertices: expected finite numbers, found NaN or infinity"),
        ((CORNER[0], np.zeros((0, 3), int)), {}, r"triangles: expected at least one row of three indices, found shape \(0, 3\)"),
        ((CORNER[0], [[0.0, 1.0, 2.0]]), {}, "triangles: expected at least one row of three indices, found .* of float64"),
        ((CORNER[0], [[0, 1, 3]]), {}, "triangles: expected indices from 0 to 2, found 0 to 3"),
        ((CORNER[0], [[0, 1, -1]]), {}, "triangles: expected indices from 0 to 2, found -1 to 1"),
        ((*CORNER, [1, 2]), {}, r"regions: expected one number for each of 1 triangles, found shape \(2,\)"),
        ((*CORNER, [1.5]), {}, "regions: expected whole numbers within 64 bits, found float64"),
        (
            (*CORNER, np.array([2**63], np.uint64)),
            {},
            "regions: expected whole numbers within 64 bits, found uint64 from 9223372036854775808",
        ),
        (CORNER, {"cell_data": {"q": [1, 2]}}, "q: expected one number for each of 1 triangles"),
        (CORNER, {"cell_data": {"q": ["good"]}}, "q: expected one number for each of 1 triangles"),
    ],
)
def test_arrays_that_are_no_mesh_are_refused(arrays, options, words):
    with pytest.raises(MeshError, match=words):
        surface(*arrays, **options)


def test_options_that_cannot_be_are_refused():
    with pytest.raises(ParameterError, match="cell_data: expected names other than 'region'"):
        surface(*CORNER, cell_data={"region": [1]})
    with pytest.raises(ParameterError, match="height: expected a number above 0, found -2"):
        surface(*CORNER, height=-2)
    with pytest.raises(ParameterError, match="z: expected a number"):
        surface(*CORNER, z=np.inf)
