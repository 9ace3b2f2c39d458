"""What a mesh hands on: arrays of the user, labels of 64 bits, names in any letters, heights of regions; and all of it back."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
import pyvista as pv
from views.plates import is_closed, volume

from img2tri import ParameterError, mesh_image
from img2tri.views.formats.readers.read_any import FILE_READERS, read_file

FORMATS = (
    ".stl",
    ".ply",
    ".obj",
    ".off",
    ".3mf",
    ".glb",
    ".vtp",
    ".vtu",
    ".msh",
    ".inp",
    ".bdf",
    ".xdmf",
    ".mesh",
    ".vtkhdf",
    ".svg",
    ".dxf",
)
HOLDS = {".ply", ".vtp", ".vtu", ".msh", ".xdmf", ".vtkhdf"}  # arrays of the user


def labels(*values):
    image = np.zeros((24, 40), np.int64)
    image[4:20, 4:20], image[4:20, 20:36] = values
    return image


@pytest.fixture(scope="module")
def mesh():
    return mesh_image(labels(1, 2), labels=True, edge_length=5, names={1: "bone", 2: "骨髓"})


def test_names_of_trimesh_and_pyvista(mesh):
    assert mesh.area == pytest.approx(2 * 16 * 16, rel=1e-6)
    assert mesh.bounds == pytest.approx((4, 4, 36, 20), abs=0.6)
    assert mesh.points.shape == (len(mesh.vertices), 3)
    assert mesh.faces is mesh.triangles


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("low", [65_536 * 40_000, 720575940610453042])
def test_labels_beyond_32_bits_can_be_saved_in_every_format(tmp_path, suffix, low):
    large = mesh_image(labels(low, low + 1), labels=True, edge_length=8)
    large.save(tmp_path / f"a{suffix}")
    if suffix in FILE_READERS and suffix not in (".stl", ".off"):
        found = read_file(tmp_path / f"a{suffix}")
        assert set(found.regions.tolist()) == {low, low + 1} or (suffix == ".ply" and low > 2**53)
    assert set(large.to_trimesh().face_attributes["region"].tolist()) == {low, low + 1}
    assert set(large.to_pyvista()["region"].tolist()) == {low, low + 1}


@pytest.mark.parametrize("suffix", FORMATS)
def test_arrays_of_the_user_are_carried_or_refused_by_name(tmp_path, mesh, suffix):
    data = {"temperature": np.arange(len(mesh.vertices)) / 7, "euler angles": np.ones((len(mesh.triangles), 3)), "phase": mesh.regions}
    if suffix not in HOLDS:
        with pytest.raises(ParameterError, match=r"data: expected .*"):
            mesh.save(tmp_path / f"a{suffix}", data=data)
        assert not list(tmp_path.iterdir())
        return
    mesh.save(tmp_path / f"a{suffix}", data=data)
    if suffix == ".ply":
        head = (tmp_path / "a.ply").read_bytes().partition(b"end_header")[0]
        assert b"property double temperature" in head
        assert b"property double euler_angles_3" in head
        return
    found = read_file(tmp_path / f"a{suffix}")
    assert found.point_data["temperature"] == pytest.approx(data["temperature"])
    assert found.cell_data["euler angles"] == pytest.approx(np.ones((len(mesh.triangles), 3)))
    assert np.array_equal(found.cell_data["phase"], found.regions)


def test_meshio_finds_arrays_in_msh(tmp_path, mesh):
    mesh.save(tmp_path / "a.msh", data={"t": np.arange(len(mesh.vertices)), "phase": mesh.regions})
    read = meshio.read(tmp_path / "a.msh")
    assert read.point_data["t"].ravel().tolist() == list(range(len(mesh.vertices)))
    assert np.array_equal(np.concatenate(read.cell_data["phase"])[-len(mesh.triangles) :].ravel(), np.sort(mesh.regions))


def test_data_of_another_length_is_refused(tmp_path, mesh):
    with pytest.raises(ParameterError, match=r"data: expected \d+ values, one for each triangle, or \d+, one for each vertex, found shape"):
        mesh.save(tmp_path / "a.vtu", data={"t": [1, 2]})


@pytest.mark.parametrize("cells", [None, "tetrahedra"])
@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".inp", ".bdf", ".xdmf", ".vtkhdf"])
def test_solids_come_back_with_regions_names_and_sets(tmp_path, mesh, suffix, cells):
    mesh.save(tmp_path / f"a{suffix}", 3, layers=1, cells=cells)
    found = read_file(tmp_path / f"a{suffix}")
    assert found.kind == ("tetra" if cells else "wedge")
    assert found.names == {1: "bone", 2: "骨髓"}
    assert {"outer", "outer_1", "z_min", "z_max", "bone__骨髓"} <= set(found.facets)
    assert found.points[:, 2].max() == pytest.approx(3)


def test_names_that_are_not_ascii_stay_different_and_interfaces_are_composed_of_them(tmp_path):
    mesh = mesh_image(labels(1, 2), labels=True, edge_length=8, names={1: "骨", 2: "髓"})
    mesh.save(tmp_path / "a.inp")
    mesh.save(tmp_path / "a.dxf")
    text = (tmp_path / "a.inp").read_text()
    assert "ELSET=u9aa8\n" in text
    assert "NSET=u9aa8__u9ad3\n" in text
    assert read_file(tmp_path / "a.inp").names == {1: "骨", 2: "髓"}
    assert {"u9aa8", "u9ad3"} <= set((tmp_path / "a.dxf").read_text().split("\n"))


@pytest.mark.parametrize(("units", "code"), [("mm", 4), ("um", 13), (None, 0)])
def test_dxf_says_its_units(tmp_path, units, code):
    mesh_image(labels(1, 2), labels=True, edge_length=8, units=units).save(tmp_path / "a.dxf")
    assert f"$INSUNITS\n70\n{code}\n" in "\n".join(line.strip() for line in (tmp_path / "a.dxf").read_text().splitlines())


def test_a_height_for_each_region_makes_one_closed_body(tmp_path, mesh):
    solid = mesh.to_trimesh({1: 2.0, 2: 5.0})
    assert solid.is_watertight
    areas = {label: mesh.to_trimesh(1, split=True).geometry[name].volume for label, name in mesh.names.items()}
    assert solid.volume == pytest.approx(2 * areas[1] + 5 * areas[2])
    assert is_closed(np.asarray(solid.faces))
    assert volume(np.asarray(solid.vertices), np.asarray(solid.faces)) == pytest.approx(solid.volume)
    mesh.save(tmp_path / "a.stl", {1: 2.0, 2: 5.0})
    assert pv.read(tmp_path / "a.stl").n_open_edges == 0
    with pytest.raises(ParameterError, match="height: expected one for each region, found none for 2"):
        mesh.save(tmp_path / "b.stl", {1: 2.0})
    with pytest.raises(ParameterError, match="height: expected one length for cells"):
        mesh.save(tmp_path / "b.msh", {1: 2.0, 2: 5.0})


def test_many_heights_of_grains_that_meet_in_points_stay_closed():
    rng = np.random.default_rng(5)
    image = rng.integers(1, 5, (12, 13))
    solid = mesh_image(image, labels=True, edge_length=2, background=None).to_trimesh({1: 1, 2: 2, 3: 3, 4: 1.5})
    assert solid.is_watertight
    assert solid.is_winding_consistent


def test_skfem_of_second_order_follows_the_outlines():
    pytest.importorskip("skfem", reason="scikit-fem is not installed")
    y, x = np.mgrid[:60, :60] + 0.5
    mesh = mesh_image(np.hypot(x - 30, y - 30) < 25, edge_length=12)
    import skfem

    curved = mesh.to_skfem(order=2)
    assert isinstance(curved, skfem.MeshTri2)
    whole = skfem.asm(skfem.Functional(lambda w: 1.0 + 0 * w.x[0]), skfem.Basis(curved, skfem.ElementTriP2()))
    assert whole > mesh.area + 1  # what lies between chords and curves
    assert {"outer"} <= set(curved.boundaries)
    rim = curved.doflocs[:, curved.dofs.get_facet_dofs(curved.boundary_facets()).flatten()]
    assert np.hypot(*(rim - 30)) == pytest.approx(25, abs=0.6)  # vertices lie outside, to keep the area


def test_periodic_meshes_pair_their_nodes(tmp_path):
    rng = np.random.default_rng(1)
    image = np.kron(rng.integers(1, 3, (6, 6)), np.ones((8, 8), int))
    mesh = mesh_image(np.pad(image, ((0, 1), (0, 1)), mode="wrap"), labels=True, background=None, periodic="xy", edge_length=6)
    for version in ("4.1", "2.2"):
        mesh.save(tmp_path / "a.msh", version=version)
        text = (tmp_path / "a.msh").read_text()
        links = text.partition("$Periodic\n")[2].partition("$EndPeriodic")[0].splitlines()
        pairs = {tuple(map(int, line.split())) for line in links if len(line.split()) == 2}
        expected = {(int(b) + 1, int(a) + 1) for rows in mesh.periodic_pairs.values() for a, b in rows}
        assert pairs == expected or pairs == {(b, a) for a, b in expected}
    mesh.save(tmp_path / "a.inp")
    text = (tmp_path / "a.inp").read_text()
    assert text.count("*EQUATION") == 6
    assert "*NODE, NSET=PERIODIC_X" in text
    tied = [line.split(", ")[:2] for line in text.splitlines() if ", 1., " in line]
    assert len(set(map(tuple, tied))) == len(tied)  # no displacement is tied twice


def test_a_base_joins_loose_parts_in_one_closed_body(tmp_path):
    y, x = np.mgrid[:60, :80]
    image = (np.hypot(x - 20, y - 30) < 15) & ~(np.hypot(x - 20, y - 30) < 7) | ((x > 50) & (x < 70))
    mesh = mesh_image(image, edge_length=4)
    solid = mesh.to_trimesh(3, base=2)
    assert solid.is_watertight
    assert solid.body_count == 1
    assert mesh.to_trimesh(3).body_count == 2
    plate = (80 + 4) * (60 + 4) * 2  # it reaches beyond the image by its thickness
    assert solid.volume == pytest.approx(plate + 3 * mesh.area)
    bodies = mesh.to_trimesh({1: 3}, split=True, base=2).geometry
    assert {name: body.is_watertight for name, body in bodies.items()} == {"base": True, "region_1": True}
    assert bodies["base"].volume == pytest.approx(plate)
    assert bodies["region_1"].bounds[:, 2].tolist() == [2, 5]
    for suffix in (".stl", ".3mf", ".glb", ".ply", ".vtp"):
        mesh.save(tmp_path / f"a{suffix}", 3, base=2)
    assert pv.read(tmp_path / "a.stl").n_open_edges == 0
    with pytest.raises(ParameterError, match="base: expected a height too"):
        mesh.save(tmp_path / "b.stl", base=2)
    with pytest.raises(ParameterError, match="base: expected to be left out with cells"):
        mesh.to_pyvista(3, solid=True, base=2)
    with pytest.raises(ParameterError, match="base: expected to be left out for .msh"):
        mesh.save(tmp_path / "b.msh", 3, base=2)


def test_files_have_the_colours_of_the_image(tmp_path):
    import trimesh

    image = np.zeros((20, 30, 3), np.uint8)
    image[2:18, 2:15], image[2:18, 15:28] = (220, 40, 40), (40, 160, 220)
    mesh = mesh_image(image, labels=True, edge_length=5)
    assert mesh.origin.colours == {0xDC2828: (220, 40, 40), 0x28A0DC: (40, 160, 220)}
    mesh.save(tmp_path / "a.svg")
    assert 'fill="#dc2828"' in (tmp_path / "a.svg").read_text()
    mesh.save(tmp_path / "a.glb", 2)
    scene = trimesh.load_scene(tmp_path / "a.glb", process=False)
    shown = {tuple(body.visual.material.baseColorFactor[:3].tolist()) for body in scene.geometry.values()}
    assert shown == {(220, 40, 40), (40, 160, 220)}
    assert all(trimesh.Trimesh(body.vertices, body.faces).is_watertight for body in scene.geometry.values())
    mesh.save(tmp_path / "a.3mf", 2)
    import zipfile

    model = zipfile.ZipFile(tmp_path / "a.3mf").read("3D/3dmodel.model").decode()
    assert '<m:color color="#DC2828"/>' in model
    palette = np.arange(20 * 30).reshape(20, 30) % 30 // 15 + 1
    from PIL import Image

    with_palette = Image.fromarray(palette.astype(np.uint8))
    with_palette.putpalette([0, 0, 0, 250, 10, 10, 10, 250, 10])
    with_palette.save(tmp_path / "a.png")
    assert mesh_image(tmp_path / "a.png", labels=True).origin.colours == {1: (250, 10, 10), 2: (10, 250, 10)}
