"""An image by tiles: sound and faithful across seams, the same bits whatever the tiles, going on after a stop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import oracles
import pytest
from scipy import ndimage
from scipy.spatial import KDTree
from scipy.stats import ks_2samp
from specimens import MASKS, polycrystal

from img2tri import FileError, ImageError, ParameterError, mesh_image, mesh_tiles
from img2tri.arrays import as_complex
from img2tri.certificate.report import certify
from img2tri.options.all_options import checked
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.tiles import block_plan, mesh_block
from img2tri.tiles.parts.load_parts import load_tiles
from img2tri.tiles.seams.both_meshes import Territory, together
from img2tri.tiles.seams.gap_attempts import ALIKE, Attempt
from img2tri.tiles.seams.piece_seams import Piece
from img2tri.tiles.window_regions import cut_out
from img2tri.triangles.min_angle_tangents import smallest_angles
from img2tri.types import Frame


def blobs(n=400, sigma=8.0, seed=0):
    return ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((n, n)), sigma) > 0


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Blocks of 128 px, so that small images have seams; margins may overlap what is one block away, but for edges of 4 px do not."""
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 128)


def judged(image, folder, **options):
    """Mesh by tiles, check the whole by the oracles and by the certificate of the image in memory, and return it."""
    made = mesh_tiles(image, Path(folder) / "mesh.zarr", **options)
    vertices, triangles, regions = load_tiles(made.path)
    oracles.check_valid(vertices, triangles)
    in_memory = mesh_image(image, **options)
    report = certify(vertices, triangles, regions, in_memory.frame, in_memory.origin)
    assert report.warnings == [], report.warnings
    assert made.n_vertices == len(vertices)
    assert made.n_triangles == len(triangles)
    assert made.report["warnings"] == []
    assert made.report["smallest_angle"] >= 30
    assert made.report["distance"] <= 0.5 * (1 + 1e-6)
    return made, (vertices, triangles, regions)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_mask_across_many_seams_keeps_all_promises(seed, tmp_path):
    made, _ = judged(blobs(300, seed=seed), tmp_path, edge_length=4.0)
    assert made.report["seam_edges"] > 100


def test_a_label_map_across_seams_keeps_all_promises(tmp_path):
    judged(np.kron(polycrystal(64, 40), np.ones((4, 4), int)), tmp_path, edge_length=4.0, labels=True, background=None)


def test_gray_values_place_the_outlines_across_seams(tmp_path):
    y, x = np.mgrid[:260, :260] + 0.5
    gray = np.clip(128 + 20 * (90 - np.hypot(x - 130, y - 130)), 0, 255).astype(np.uint8)
    made, (vertices, triangles, _) = judged(gray, tmp_path, edge_length=4.0, threshold=127)
    assert abs(oracles.areas(vertices, triangles).sum() / (np.pi * 90**2) - 1) < 1e-3
    made, _ = judged(gray, tmp_path, edge_length=4.0)
    assert made.report["level"] == mesh_image(gray, edge_length=4.0).report.settings["threshold"]


@pytest.mark.parametrize("name", ["hole of a pixel", "touching corners"])
def test_seams_may_cut_a_specimen_at_any_place(name, monkeypatch, tmp_path):
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 64)
    specimen = MASKS[name]
    h, w = specimen.shape
    for offset in range(max(h, w) + 1):
        image = np.zeros((96, 96), int)
        image[64 - offset : 64 - offset + h, 64 - offset : 64 - offset + w] = specimen
        judged(image > 0, tmp_path, edge_length=2.0)


def in_bytes(arrays):
    return [np.ascontiguousarray(array).tobytes() for array in arrays]


def bits(mesh):
    return in_bytes((mesh.vertices, mesh.triangles, mesh.regions))


def test_the_bits_are_the_same_whatever_the_tile_size_and_in_memory(tmp_path):
    mask = blobs(300)
    in_memory = mesh_image(mask, edge_length=4.0, blocks=True)
    assert in_memory.report.kept
    assert in_memory.report.counted["blocks"] == 9
    assert bits(in_memory) != bits(mesh_image(mask, edge_length=4.0))
    for tile, parts in {1: 9, 256: 4, 10_000: 1}.items():
        made = mesh_tiles(mask, tmp_path / f"{tile}.zarr", tile=tile, edge_length=4.0)
        assert made.n_parts == parts
        assert in_bytes(load_tiles(made.path)) == bits(in_memory)


LABELS = (blobs(180) + 2 * blobs(180, seed=1)).astype(np.uint8)
WITH_GAPS = np.where(np.hypot(*np.mgrid[-60:120, -70:110]) < 25, np.nan, ndimage.gaussian_filter(LABELS.astype(float), 2))
COLOURS = np.array([[0, 0, 0], [200, 30, 30], [30, 200, 30], [30, 30, 200]], np.uint8)[LABELS]
CASES = {
    "labels": (LABELS, {"edge_length": "4px", "labels": True, "spacing": (0.5, 0.7)}),
    "some labels": (LABELS, {"edge_length": {1: 3.0, 2: 4.0, 3: 4.0}, "labels": [1, 2, 3], "origin": "upper"}),
    "gray": (LABELS, {"threshold": 1, "tolerance": 0.8, "elements_across": 2.0, "edge_length": 4.0, "invert": True}),
    "crop": (LABELS, {"edge_length": 4.0, "labels": True, "crop": (10, 20.5, 170, 175), "origin": (3, 4)}),
    "width": (LABELS, {"edge_length": 2.0, "labels": True, "width": 90, "crop": (10, 20, 80, 85)}),
    "colours": (COLOURS, {"edge_length": 4.0, "labels": True}),
    "a colour": (COLOURS, {"edge_length": 4.0, "labels": [0xC81E1E], "background": 0}),
    "luminance": (COLOURS, {"edge_length": 4.0, "threshold": 80}),
    "gaps": (WITH_GAPS, {"edge_length": 4.0, "threshold": 1.2}),
    "gaps in labels": (np.where(np.isnan(WITH_GAPS), np.nan, LABELS), {"edge_length": 4.0, "labels": True}),
    "masked": (np.ma.masked_array(LABELS, LABELS == 2), {"edge_length": 4.0, "threshold": 0}),
    "lengths": (LABELS, {"labels": True, "edge_length": 2.5 + np.mgrid[:180, :180][1] / 120}),
}


@pytest.mark.parametrize("name", CASES)
def test_images_and_options_mean_the_same_in_memory_and_by_tiles(name, tmp_path):
    image, options = CASES[name]
    made = mesh_tiles(image, tmp_path / "mesh.zarr", **options)
    assert made.report["seam_edges"] > 10
    assert in_bytes(load_tiles(made.path)) == bits(mesh_image(image, blocks=True, **options))


@pytest.mark.parametrize("options", [{}, {"edge_length": 5.0}, {"spacing": 0.25, "origin": (3, 4), "corners": "keep"}])
def test_an_image_of_one_block_is_meshed_as_without(options, tmp_path, monkeypatch):
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 2048)
    mask = blobs(160)
    plain = mesh_image(mask, **options)
    assert bits(plain) == bits(mesh_image(mask, blocks=True, **options))
    assert bits(plain) == in_bytes(load_tiles(mesh_tiles(mask, tmp_path / "mesh.zarr", **options).path))


def test_a_change_of_the_image_changes_the_mesh_in_its_block_and_those_around_only():
    mask, edge = blobs(384), 4.0
    changed = mask.copy()
    changed[20:40, 20:50] ^= True  # no window of another block sees this
    corners = []
    for image in (mask, changed):
        mesh = mesh_image(image, edge_length=edge, blocks=True, origin="upper")
        three = mesh.vertices[mesh.triangles]
        corners.append({row.tobytes() for row in three[(three > 256 + 8 * edge).any(axis=(1, 2))]})
    assert corners[0] == corners[1]
    assert len(corners[0]) > 3000


@pytest.mark.parametrize("options", [{"periodic": "x"}, {"symmetric": "x"}, {"interior": "poisson"}, {"smoothing": "uniform"}])
def test_what_takes_the_image_as_a_whole_is_refused_by_blocks(options):
    with pytest.raises(ParameterError, match=f"{next(iter(options))}: expected to be left out for an image by blocks"):
        mesh_image(np.ones((30, 30), bool), blocks=True, **options)


def test_a_second_run_goes_on_where_the_first_was_stopped(tmp_path, monkeypatch):
    mask = blobs(300)
    mesh_tiles(mask, tmp_path / "whole.zarr", edge_length=4.0)

    def stop(_, share):
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mesh_tiles(mask, tmp_path / "mesh.zarr", edge_length=4.0, progress=stop)
    made = len(list((tmp_path / ".mesh.zarr.work").glob("piece-*")))
    assert 0 < made < 9
    calls, fitting = [], mesh_block._fitting
    monkeypatch.setattr(mesh_block, "_fitting", lambda *given: (calls.append(given[-1]), fitting(*given))[1])
    mesh_tiles(mask, tmp_path / "mesh.zarr", edge_length=4.0)
    assert len(calls) == 9 - made
    one, other = load_tiles(tmp_path / "whole.zarr"), load_tiles(tmp_path / "mesh.zarr")
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mesh.zarr", "whole.zarr"]


def test_other_pixels_or_options_do_not_go_on_with_old_pieces(tmp_path):
    def stop(_, share):
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mesh_tiles(blobs(300), tmp_path / "mesh.zarr", edge_length=4.0, progress=stop)
    judged(blobs(300, seed=5), tmp_path, edge_length=4.0)


@pytest.mark.parametrize("suffix", [".pvtu", ".vtkhdf"])
def test_pyvista_reads_the_whole_and_each_part(suffix, tmp_path):
    import pyvista

    mask = blobs(160)
    made = mesh_tiles(mask, tmp_path / f"mesh{suffix}", tile=128, edge_length=4.0, spacing=0.5)
    grid = pyvista.read(made.path)
    assert grid.n_cells == made.n_triangles
    assert len(np.unique(grid.point_data["number"])) == made.n_vertices == grid.clean(tolerance=0).n_points
    assert set(grid.cell_data["region"]) == {1}
    assert np.isclose(grid.compute_cell_sizes()["Area"].sum(), made.report["areas"][1])
    if suffix == ".pvtu":
        parts = [pyvista.read(path) for path in sorted((tmp_path / "mesh").glob("*.vtu"))]
        assert sum(part.n_cells for part in parts) == made.n_triangles


class Broken:
    """An image with a chunk that cannot be read."""

    shape, dtype = (300, 300), np.dtype(bool)

    def __getitem__(self, window):
        rows, columns = window
        if rows.start <= 200 < rows.stop and columns.start <= 150 < columns.stop:
            raise OSError("bad block on disk")
        return np.ones((rows.stop - rows.start, columns.stop - columns.start), bool)


def test_errors_name_what_is_wrong(tmp_path):
    with pytest.raises(FileError, match="bad block on disk"):
        mesh_tiles(Broken(), tmp_path / "mesh.zarr")
    with pytest.raises(ImageError, match="found shape"):
        mesh_tiles(np.zeros((3, 4, 5)), tmp_path / "mesh.zarr")
    with pytest.raises(ImageError, match="looks like a label map"):
        mesh_tiles(np.kron(LABELS[:50, :50], np.ones((3, 3), np.uint8)), tmp_path / "mesh.zarr")
    with pytest.raises(ParameterError, match="background: expected a label that pixels which are not there get"):
        mesh_tiles(CASES["gaps in labels"][0], tmp_path / "mesh.zarr", labels=True, background=None)
    with pytest.raises(ParameterError, match="edge_length: expected an array of shape"):
        mesh_tiles(LABELS, tmp_path / "mesh.zarr", edge_length=np.ones((3, 4)))
    with pytest.raises(ImageError, match="expected pixels to mesh"):
        mesh_tiles(np.zeros((30, 40), bool), tmp_path / "mesh.zarr")
    with pytest.raises(ParameterError, match="periodic: expected to be left out"):
        mesh_tiles(np.ones((30, 40), bool), tmp_path / "mesh.zarr", periodic="x")
    with pytest.raises(FileError, match="expected a name that ends in"):
        mesh_tiles(np.ones((30, 40), bool), tmp_path / "mesh.stl")
    with pytest.raises(FileError, match="expected an existing folder"):
        mesh_tiles(np.ones((30, 40), bool), tmp_path / "none" / "mesh.zarr")


def test_every_kind_of_source_gives_the_same_mesh(tmp_path):
    import dask.array
    import h5py
    import tifffile
    import zarr

    xarray = pytest.importorskip("xarray")

    mask = blobs(140, 16.0).astype(np.uint8)
    np.save(tmp_path / "mask.npy", mask)
    zarr.save(tmp_path / "mask.zarr", mask)
    with h5py.File(tmp_path / "mask.h5", "w") as file:
        file["mask"] = mask
    tifffile.imwrite(tmp_path / "mask.tif", mask, tile=(64, 64))
    sources = [mask, *(tmp_path / f"mask{suffix}" for suffix in (".npy", ".zarr", ".h5", ".tif"))]
    sources += [dask.array.from_array(mask, chunks=50), xarray.DataArray(mask)]
    found = set()
    for source in sources:
        made = mesh_tiles(source, tmp_path / "mesh.zarr", edge_length=4.0)
        found.add(b"".join(array.tobytes() for array in load_tiles(made.path)))
    assert len(found) == 1


@pytest.mark.parametrize("seed", [1, 2])
def test_windows_make_nearly_the_same_mesh_around_their_common_border(seed, monkeypatch):
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 256)
    mask, edge = blobs(512, 12.0, seed=seed), 4.0
    zones = Segmentation(mask, 0)
    plan = block_plan.planned(Frame(mask.shape), dict(checked({"edge_length": edge}, function="mesh_tiles")), int(mask.sum()))
    found = []
    for cell in ((0, 0), (0, 1)):
        rows, columns = plan.window(cell, plan.margin + block_plan.SMOOTHED)
        mesh, _ = mesh_block.window_mesh(cut_out(zones, rows, columns), plan, rows, columns)
        near = (abs(mesh.vertices.real - 256) < 2 * edge) & (mesh.vertices.imag > 300)
        found.append(np.stack([mesh.vertices[near].real, mesh.vertices[near].imag], axis=1))
    one, other = found
    alike = KDTree(other).query(one)[0] < ALIKE[0] * edge
    assert len(alike) > 100
    assert alike.all()  # .86 where valences are repaired in the order of numbers


def test_no_seam_is_to_be_seen():
    mask = blobs(512, 10.0)
    borders = 128 * np.arange(1, 4)
    angles = []
    for blocks in (False, True):
        mesh = mesh_image(mask, edge_length=4.0, blocks=blocks)
        middle = mesh.vertices[mesh.triangles].mean(axis=1)
        near = (abs(middle[:, :, None] - borders) < 4).any(axis=(1, 2))
        angles.append(smallest_angles(as_complex(mesh.vertices), mesh.triangles)[near])
    plain, by_blocks = angles
    assert len(by_blocks) > 1500
    assert np.percentile(by_blocks, 1) > np.percentile(plain, 1) - 3
    assert ks_2samp(plain, by_blocks).statistic < 0.05  # .10 without posts and one lattice


def test_where_a_way_did_not_do_vertices_take_no_places():
    attempt = Attempt(0, [np.array([10 + 0j])], 5.0)
    assert attempt.of(ALIKE, np.array([10 + 1j, 30 + 0j])).tolist() == [0.0, ALIKE[0]]
    # Two triangles, and the same ones finished, one vertex of which lies a twentieth of an edge away.
    none = np.zeros((0, 2), np.int64)
    z, two = np.array([0, 1, 1 + 1j, 1j]), np.array([[0, 1, 2], [0, 2, 3]])
    finished = Piece(z + np.array([0, 0, 0.05, 0]), two, np.ones(2, np.int64), none, none[:, 0])
    territory = Territory(lambda places: np.zeros(places.shape), lambda places: np.ones(places.shape, bool), 9.0)
    for alike, moved, count in ((0.12, 1, 4), (0.0, 0, 5)):
        mesh = Piece(z, two, np.ones(2, np.int64), none, none[:, 0])
        both = together(mesh, finished, np.zeros(2, bool), np.array([1]), territory, none, np.full(4, alike))
        assert (both.moved.sum(), len(both.z)) == (moved, count)
