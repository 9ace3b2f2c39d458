"""Meshes come back from every format with all it holds, and nothing that is no plane mesh is taken for one."""

from __future__ import annotations

import numpy as np
import pytest
import specimens

import img2tri
from img2tri import mesh_image
from img2tri.errors import FileError, MeshError
from img2tri.views.formats.readers.read_any import FILE_READERS

GRAINS = specimens.polycrystal(40, 4)
NAMES = {1: "bone", 2: "fat & skin"}
BARE = (".stl", ".off")  # triangles alone
REGIONS_ONLY = (".ply", ".obj", ".glb")


@pytest.fixture(scope="module")
def mesh():
    labels = np.unique(GRAINS)[:2].tolist()
    names = dict(zip(labels, NAMES.values(), strict=True))
    return mesh_image(GRAINS, labels=True, background=None, edge_length=5, spacing=0.5, origin=(10, -3), names=names)


def by_place(vertices):
    """Vertices in an order of their own."""
    return vertices[np.lexsort(np.round(vertices, 3).T)]


def of_places(mesh):
    """Regions in the order of the places of triangles: some formats put the triangles of a region together."""
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    return mesh.regions[np.lexsort(np.round(middles, 3).T)]


@pytest.mark.parametrize("suffix", FILE_READERS)
def test_back_again(mesh, tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    mesh.save(path)
    again = img2tri.load(path)
    exact = suffix not in (".stl", ".glb", ".obj", ".bdf")
    assert len(again.triangles) == len(mesh.triangles)
    assert np.abs(by_place(again.vertices) - by_place(mesh.vertices)).max() < (1e-9 if exact else 1e-5)
    assert again.quality().summary()["min_angle"]["min"] == pytest.approx(mesh.quality().summary()["min_angle"]["min"], abs=1e-3)
    assert again.origin is None
    if suffix in BARE:
        assert set(again.regions) == {1}
        return
    assert np.array_equal(np.sort(again.regions), np.sort(mesh.regions))
    if suffix in REGIONS_ONLY:
        return
    assert np.array_equal(of_places(again), of_places(mesh))
    assert again.names == mesh.names
    assert again.frame == mesh.frame
    assert repr(again.sets()) == repr(mesh.sets())


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".xdmf"])
def test_quadratic_triangles_come_back_by_their_corners(mesh, tmp_path, suffix):
    mesh.save(tmp_path / f"mesh{suffix}", order=2)
    again = img2tri.load(tmp_path / f"mesh{suffix}")
    assert np.abs(by_place(again.vertices) - by_place(mesh.second_order().nodes[: len(mesh.vertices)])).max() < 1e-9
    assert len(again.triangles) == len(mesh.triangles)


@pytest.mark.parametrize("suffix", [".vtu", ".vtp", ".msh", ".ply"])
def test_a_second_time_is_the_same_file(mesh, tmp_path, suffix):
    mesh.save(tmp_path / f"one{suffix}")
    once = img2tri.load(tmp_path / f"one{suffix}")
    once.save(tmp_path / f"two{suffix}")
    twice = img2tri.load(tmp_path / f"two{suffix}")
    assert twice.vertices.tobytes() == once.vertices.tobytes()
    assert twice.triangles.tobytes() == once.triangles.tobytes()
    assert twice.regions.tobytes() == once.regions.tobytes()


def test_y_may_point_down(tmp_path):
    mesh = mesh_image(GRAINS > 2, origin="upper", edge_length=5)
    mesh.save(tmp_path / "down.vtu")
    again = img2tri.load(tmp_path / "down.vtu")
    assert again.frame == mesh.frame
    assert (again.quality().summary()["area"]["min"]) > 0


@pytest.mark.parametrize(("name", "options"), [("a.stl", {}), ("a.msh", {}), ("a.vtu", {"cells": "tetrahedra"})])
def test_a_solid_is_no_plane_mesh(mesh, tmp_path, name, options):
    mesh.save(tmp_path / name, height=3, **options)
    with pytest.raises(MeshError, match=r"img2tri quality measures solids"):
        img2tri.load(tmp_path / name)


def test_what_is_no_mesh(tmp_path):
    (tmp_path / "a.msh").write_text("no mesh")
    for name in ("a.msh", "none.vtu", "a.dwg"):
        with pytest.raises(FileError):
            img2tri.load(tmp_path / name)
