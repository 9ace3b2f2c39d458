"""Names and labels that formats have no place for: nothing is lost, renamed or taken for something else in silence."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
import pyvista as pv
import trimesh
from views.plates import cells

import img2tri
from img2tri import FileError, MeshError, ParameterError, TriangleMesh
from img2tri.views.formats.readers.read_any import read_file

NAMES = {
    1: "a b", 2: "naïve", 3: 'q"uo\'te', 4: "com,ma", 5: "new\nline", 6: "骨", 7: "<x>&y", 8: "q'uo'te", 9: "q:o", 10: "Left", 11: "a__b",
    12: "  pad  ", 13: "tab\tx", 14: "#$%", 15: "x" * 90, 16: "region_3", 17: "*NODE", 18: "]]>", 19: "-5", 20: "a_b", 21: "a  b",
    22: "q<o", -25: "region_4", 2**40: "region_5",
}  # fmt: skip
LABELS = [0, -1, -7, 2**31 - 1, 2**31, -(2**31), 2**63 - 1, -(2**63), 2**53 + 1, 5]
HOLDERS = (".ply", ".obj", ".3mf", ".vtp", ".vtu", ".vtkhdf", ".msh", ".inp", ".bdf", ".xdmf", ".mesh")
SOLVERS = HOLDERS[4:]


def strip_of(labels, names=None):
    """A strip of one cell, of two triangles, for each label."""
    vertices, triangles = cells(np.ones((1, len(labels)), bool))
    return TriangleMesh(vertices, triangles, np.repeat(np.array(labels, np.int64), 2), names=names or {})


def places(mesh):
    """The middle of each triangle, and its label."""
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    order = np.lexsort(middles.T)
    return middles[order].tolist(), mesh.regions[order].tolist()


@pytest.mark.parametrize("suffix", HOLDERS)
def test_labels_of_any_size_come_back(tmp_path, suffix):
    mesh = strip_of(LABELS)
    mesh.save(tmp_path / f"a{suffix}")
    back = img2tri.load(tmp_path / f"a{suffix}")
    (found, labels), (expected, wanted) = places(back), places(mesh)
    assert found == [pytest.approx(place) for place in expected]
    assert labels == wanted


@pytest.mark.parametrize(("suffix", "options"), [*((suffix, {}) for suffix in SOLVERS), (".msh", {"version": "2.2"})])
def test_names_of_any_kind_come_back_each_with_its_label_and_sets(tmp_path, suffix, options):
    mesh = strip_of(list(NAMES), NAMES)
    mesh.save(tmp_path / f"a{suffix}", **options)
    back = img2tri.load(tmp_path / f"a{suffix}")
    assert places(back)[1] == places(mesh)[1]
    assert back.sets().labels == mesh.sets().labels
    assert {name: len(rows) for name, rows in back.sets().edges.items()} == {name: len(rows) for name, rows in mesh.sets().edges.items()}


def test_a_3mf_comes_back_flat_and_solid(tmp_path):
    mesh = strip_of([3, -7, 2**40], {3: "bone & marrow", -7: "骨"})
    mesh.save(tmp_path / "a.3mf")
    back = img2tri.load(tmp_path / "a.3mf")
    assert places(back) == places(mesh)
    assert back.names == mesh.names
    mesh.save(tmp_path / "b.3mf", 2)
    solid = read_file(tmp_path / "b.3mf")
    assert solid.names == {3: "bone & marrow", -7: "骨", 2**40: f"region_{2**40}"}
    a, b, c = (solid.points[solid.cells[:, k]] for k in range(3))
    volume = {label: (a * np.cross(b, c))[solid.regions == label].sum() / 6 for label in solid.names}
    assert volume == pytest.approx(dict.fromkeys(solid.names, 2))
    with pytest.raises(MeshError, match="img2tri quality measures solids"):
        img2tri.load(tmp_path / "b.3mf")
    trimesh.creation.box().export(tmp_path / "c.3mf")
    assert len(read_file(tmp_path / "c.3mf").cells) == 12
    (tmp_path / "d.3mf").write_bytes((tmp_path / "a.3mf").read_bytes()[:300])
    with pytest.raises(FileError, match="d.3mf: cannot be read as .3mf"):
        img2tri.load(tmp_path / "d.3mf")


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_no_two_names_become_one_for_others(tmp_path, suffix):
    mesh = strip_of(list(NAMES), NAMES)
    mesh.save(tmp_path / f"a{suffix}")
    fields = meshio.read(tmp_path / f"a{suffix}").field_data
    assert len(fields) == len(NAMES) + len(mesh.sets().edges)
    if suffix == ".vtu":
        assert set(fields) == set(pv.read(tmp_path / "a.vtu").field_data.keys())


@pytest.mark.parametrize("suffix", [".ply", ".msh"])
def test_whole_numbers_a_double_cannot_hold_are_refused(tmp_path, suffix):
    mesh = strip_of([1, 2])
    mesh.save(tmp_path / f"a{suffix}", data={"ids": np.arange(4) + 2**53 - 3})
    with pytest.raises(
        ParameterError, match=r"ids: expected whole numbers up to 2\^53, which is all a double holds, found 9007199254740994"
    ):
        mesh.save(tmp_path / f"a{suffix}", data={"ids": np.arange(4) + 2**53 - 1})


def test_names_no_file_can_hold_are_refused():
    with pytest.raises(ParameterError, match="names: expected letters that can be written, found"):
        img2tri.mesh_image(np.ones((9, 9), np.uint8), labels=True, names={1: "bell\a"})


ARRAYS = (".ply", ".vtp", ".vtu", ".vtkhdf", ".msh", ".xdmf")


@pytest.mark.parametrize("suffix", ARRAYS)
@pytest.mark.parametrize("name", ["", "a/b", 'a"b', "a'b", "a<b", "a&b", "a\nb", " a"])
def test_names_of_arrays_that_would_be_lost_or_spoil_a_file_are_refused(tmp_path, suffix, name):
    mesh = strip_of([1, 2])
    with pytest.raises(ParameterError, match="data: expected names without quotes, slashes"):
        mesh.save(tmp_path / f"a{suffix}", data={name: np.arange(4)})
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("suffix", "data", "message"),
    [
        (".ply", {"a b": np.arange(4), "a_b": np.arange(4)}, "differ in .ply too, found 'a_b', whose property a_b is there already"),
        (".ply", {"x": np.arange(6)}, "differ in .ply too, found 'x'"),
        (".ply", {"v": np.ones((4, 2)), "v_1": np.ones(4)}, "differ in .ply too, found 'v_1'"),
        (".vtkhdf", {"T.1": np.arange(4)}, r"names without dots for .vtkhdf, found 'T\.1'"),
    ],
)
def test_names_that_a_format_would_change_are_refused(tmp_path, suffix, data, message):
    with pytest.raises(ParameterError, match=message):
        strip_of([1, 2]).save(tmp_path / f"a{suffix}", data=data)


@pytest.mark.parametrize("suffix", ARRAYS)
def test_arrays_of_other_names_are_kept(tmp_path, suffix):
    data = {"温度": np.arange(4.0), "flow (m)": np.ones((4, 3)), "T": np.where(np.arange(6) % 2, np.nan, 1.0)}
    strip_of([1, 2]).save(tmp_path / f"a{suffix}", data=data)
    if suffix in (".vtp", ".vtu"):
        found = pv.read(tmp_path / f"a{suffix}")
        assert set(data) <= {*found.cell_data.keys(), *found.point_data.keys()}
    elif suffix != ".ply":
        read = read_file(tmp_path / f"a{suffix}")
        assert set(data) <= {*read.cell_data, *read.point_data}
