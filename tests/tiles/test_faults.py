"""What can go wrong on the way: the block and the cause are named, what is done stays, and the next run gives the same bytes."""

from __future__ import annotations

import resource

import numpy as np
import pytest
import zarr
from scipy import ndimage

from img2tri import FileError, mesh_tiles
from img2tri.cli import main
from img2tri.tiles import block_plan
from img2tri.tiles.parts.load_parts import load_tiles

OPTIONS = {"edge_length": 4.0}


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Four blocks."""
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 128)


@pytest.fixture(scope="module")
def mask():
    return ndimage.gaussian_filter(np.random.default_rng(0).standard_normal((200, 220)), 8) > 0


@pytest.fixture
def whole(mask, tmp_path):
    return in_bytes(mesh_tiles(mask, tmp_path / "whole.zarr", **OPTIONS).path)


def in_bytes(path):
    return [array.tobytes() for array in load_tiles(path)]


def pieces(folder):
    return {path.name: path.stat().st_mtime_ns for path in (folder / ".mesh.zarr.work").glob("piece-*")}


def test_a_disk_without_room_ends_the_work_and_the_next_run_goes_on(mask, whole, tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)

    def full(stage, share):
        if stage == "mesh" and share > 0.4:
            resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))

    try:
        with pytest.raises(FileError, match=r"rows \d+ to \d+, columns \d+ to \d+: .*cannot be written: .*what is done stays"):
            mesh_tiles(mask, tmp_path / "mesh.zarr", progress=full, **OPTIONS)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    done = pieces(tmp_path)
    assert 0 < len(done) < 4
    assert not (tmp_path / "mesh.zarr").exists()
    kept = {}
    made = mesh_tiles(mask, tmp_path / "mesh.zarr", progress=lambda *_: kept.update(pieces(tmp_path)), **OPTIONS)
    assert in_bytes(made.path) == whole
    assert done.items() <= kept.items()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mesh.zarr", "whole.zarr"]


def test_no_room_for_the_parts_leaves_the_older_mesh_and_all_pieces(mask, whole, tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    mesh_tiles(~mask, tmp_path / "mesh.zarr", **OPTIONS)
    older = in_bytes(tmp_path / "mesh.zarr")

    def full(stage, _):
        if stage == "save":
            resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, before[1]))

    try:
        with pytest.raises(FileError, match=r"mesh.zarr: cannot be written"):
            mesh_tiles(mask, tmp_path / "mesh.zarr", progress=full, **OPTIONS)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert len(pieces(tmp_path)) == 4
    assert in_bytes(tmp_path / "mesh.zarr") == older
    assert in_bytes(mesh_tiles(mask, tmp_path / "mesh.zarr", **OPTIONS).path) == whole


def test_a_chunk_that_cannot_be_read_is_named_with_exit_status_2(mask, whole, tmp_path, capsys):
    zarr.create_array(tmp_path / "mask.zarr", data=mask, chunks=(64, 64))
    (chunk,) = (tmp_path / "mask.zarr").glob("c/2/1")
    kept = chunk.read_bytes()
    chunk.write_bytes(b"no chunk")
    command = ["tiles", str(tmp_path / "mask.zarr"), "-o", str(tmp_path / "mesh.zarr"), "--edge-length", "4", "--quiet"]
    assert main(command) == 2
    told = capsys.readouterr().err
    assert "mask.zarr: rows 128 to 200, columns 0 to 128: cannot be read" in told
    chunk.write_bytes(kept)
    assert main(command) == 0
    assert in_bytes(tmp_path / "mesh.zarr") == whole


class Shorter:
    """An image that has fewer rows than its shape says."""

    shape, dtype = (220, 220), np.dtype(bool)

    def __getitem__(self, window):
        return np.ones((200, 220), bool)[window]


def test_an_image_that_is_not_what_its_shape_says_is_named(tmp_path):
    with pytest.raises(FileError, match=r"rows 128 to 220, columns 0 to 128: expected pixels of shape \(92, 128\), .*found \(72, 128\)"):
        mesh_tiles(Shorter(), tmp_path / "mesh.zarr", **OPTIONS)
    np.save(tmp_path / "mask.npy", np.ones((300, 300), bool))
    (tmp_path / "mask.npy").write_bytes((tmp_path / "mask.npy").read_bytes()[:5000])
    with pytest.raises(FileError, match=r"mask.npy: cannot be read"):
        mesh_tiles(tmp_path / "mask.npy", tmp_path / "mesh.zarr")
