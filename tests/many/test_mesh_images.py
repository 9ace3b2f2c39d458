"""Many images: the same meshes wherever they are made, in order, lazily; one bad image or a lost worker stops nothing."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest
import specimens
from children import hooked_workers
from PIL import Image

import img2tri
from img2tri import mesh_image, mesh_images
from img2tri.cli import main
from img2tri.errors import FileError, ImageError, MeshError, ParameterError
from img2tri.many.image_sources import each_image
from img2tri.many.in_order import in_order
from img2tri.many.local_workers import Processes

DISCS = [specimens.disc(30 + k, 10.0 + k / 2).astype(bool) for k in range(5)]
EMPTY = np.zeros((9, 9), bool)


def same(one, other):
    return one.vertices.tobytes() == other.vertices.tobytes() and one.triangles.tobytes() == other.triangles.tobytes()


def ours():
    """Processes that were started here and still run, but for those of Dask."""
    return [process for process in multiprocessing.active_children() if "Dask" not in process.name]


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture
def files(tmp_path):
    paths = []
    for k, disc in enumerate(DISCS):
        paths.append(tmp_path / f"s{k + 8}.png")
        Image.fromarray(disc).save(paths[-1])
    return paths


# ---- what a user has ----


def named(images, **options):
    return [name for name, _ in mesh_images(images, workers=1, edge_length=6, **options)]


def test_what_images_may_be(files, tmp_path):
    folder, paths = str(tmp_path), list(map(str, files))
    assert paths[1].endswith("s9.png")
    for images in (files, paths, iter(paths), folder, os.path.join(folder, "s*.png")):
        assert named(images) == paths
    assert named(files[0]) == [paths[0]]
    assert named(DISCS) == ["0", "1", "2", "3", "4"]
    assert named({"a": DISCS[0], "b": paths[1]}) == ["a", "b"]
    assert named(np.stack([DISCS[0]] * 3)) == ["0", "1", "2"]
    assert named(DISCS[0]) == ["0"]
    assert named({"stack": np.stack([DISCS[0]] * 2)}) == ["stack/0", "stack/1"]
    assert named(np.zeros((2, 9, 9, 3), np.uint8) + 255, threshold=3) == ["0", "1"]
    with pytest.raises(ParameterError, match="images: expected paths"):
        next(mesh_images(3, workers=1))
    with pytest.raises(ImageError, match=r"expected a stack \(n, h, w\)"):
        next(mesh_images(np.zeros((2, 3, 4, 5, 6)), workers=1))
    with pytest.raises(FileError, match="expected files that match"):
        next(mesh_images(str(tmp_path / "none*.png"), workers=1))


def test_each_page_is_an_image(tmp_path):
    path = tmp_path / "pages.tif"
    first, *others = (Image.fromarray(disc) for disc in DISCS[:3])
    first.save(path, save_all=True, append_images=others)
    found = dict(mesh_images(path, workers=1, spacing=(0.5, 0.5, 2)))
    assert list(found) == [f"{path}[{k}]" for k in range(3)]
    assert [mesh.frame.z for mesh in found.values()] == [0, 2, 4]
    for k, mesh in enumerate(found.values()):
        assert same(mesh, mesh_image(DISCS[k], spacing=0.5))
        assert mesh.report.options["page"] == k
        assert mesh.to_pyvista().bounds[4:] == (2 * k, 2 * k)
    assert [name for name, _ in mesh_images(path, workers=1, page=1)] == [str(path)]


def nifti(path, volume):
    nibabel = pytest.importorskip("nibabel")
    nibabel.save(nibabel.Nifti1Image(volume, np.diag([0.5, 0.5, 2.0, 1])), path)


def metaimage(path, volume):
    sizes = " ".join(map(str, volume.shape))
    head = f"NDims = 3\nDimSize = {sizes}\nElementType = MET_UCHAR\nElementSpacing = 0.5 0.5 2.0\nElementDataFile = LOCAL\n"
    path.write_bytes(head.encode() + volume.tobytes(order="F"))


def nrrd(path, volume):
    sizes = " ".join(map(str, volume.shape))
    head = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nspacings: 0.5 0.5 2.0\nencoding: raw\n\n"
    path.write_bytes(head.encode() + volume.tobytes(order="F"))


@pytest.mark.parametrize(("suffix", "save"), [(".nii", nifti), (".mha", metaimage), (".nrrd", nrrd)])
def test_slices_of_a_volume_lie_where_its_file_says(suffix, save, tmp_path):
    volume = np.zeros((30, 30, 3), np.uint8)
    volume[8:20, 6:22] = 1
    path = tmp_path / f"volume{suffix}"
    save(path, volume)
    found = dict(mesh_images(path, workers=1))
    assert [mesh.frame.z for mesh in found.values()] == [0, 2, 4]
    assert {mesh.frame.spacing for mesh in found.values()} == {(0.5, 0.5)}
    assert mesh_image(path, page=2).frame.z == 4
    assert mesh_image(path, page=2, spacing=1).frame.z == 0
    assert mesh_image(path, page=2, width=30).frame.z == 8


def test_a_zarr_group_and_a_dask_array():
    zarr, dask = pytest.importorskip("zarr"), pytest.importorskip("dask.array")
    group = zarr.create_group(store={})
    group.create_array("flat", data=DISCS[0].astype(np.uint8))
    group.create_array("stack", data=np.stack([DISCS[1], DISCS[1]]).astype(np.uint8))
    found = dict(mesh_images(group, workers=1))
    assert sorted(found) == ["flat", "stack/0", "stack/1"]
    assert same(found["flat"], mesh_image(DISCS[0]))
    lazy = dask.from_array(np.stack([DISCS[0]] * 3), chunks=(1, 10, 10))
    assert all(same(mesh, mesh_image(DISCS[0])) for _, mesh in mesh_images(lazy, workers=1))


# ---- where ----


def compared(found):
    assert [name for name, _ in found] == ["0", "1", "2", "3", "4", "5"]
    assert isinstance(found[2][1], ImageError)
    assert "expected pixels to mesh" in str(found[2][1])
    expected = [mesh_image(disc, edge_length=4) for disc in DISCS]
    for (_, mesh), one in zip(found[:2] + found[3:], expected, strict=True):
        assert same(mesh, one)
        assert mesh.report == one.report


IMAGES = [*DISCS[:2], EMPTY, *DISCS[2:]]


def test_processes_make_the_same_meshes_in_order():
    told = []
    compared(list(mesh_images(IMAGES, workers=2, edge_length=4, progress=told.append)))
    assert told == [1, 2, 3, 4, 5, 6]
    assert not ours()


def test_a_cluster_makes_the_same_meshes_in_order(client):
    compared(list(mesh_images(IMAGES, client=client, edge_length=4)))


def test_images_are_taken_as_they_are_needed(client):
    taken = []

    def endless():
        while True:
            taken.append(time.monotonic())
            yield DISCS[0]

    for where in ({"workers": 1}, {"workers": 2}, {"client": client}):
        taken.clear()
        meshes = mesh_images(endless(), **where)
        assert taken == []
        for _ in range(3):
            next(meshes)
        meshes.close()
        assert len(taken) <= 3 + 2 * 2 * 4, where
        assert not ours()


def test_options_are_checked_at_once():
    with pytest.raises(ParameterError, match="min_angle"):
        mesh_images(DISCS, min_angle=99)
    with pytest.raises(TypeError, match=r"mesh_images\(\) got an unexpected keyword argument 'edge_lenght'; did you mean 'edge_length'"):
        mesh_images(DISCS, edge_lenght=3)
    with pytest.raises(ParameterError, match="edge_length: expected what can be sent to other processes, found function"):
        mesh_images(DISCS, workers=2, edge_length=lambda places: np.full(len(places), 3.0))
    with pytest.raises(ParameterError, match="client: expected a distributed.Client"):
        mesh_images(DISCS, client="tcp://somewhere")
    with pytest.raises(ParameterError, match="workers: expected a whole number of at least 1"):
        mesh_images(DISCS, workers=0)
    assert same(next(mesh_images(DISCS, workers=1, edge_length=lambda p: np.full(len(p), 3.0)))[1],
                mesh_image(DISCS[0], edge_length=lambda p: np.full(len(p), 3.0)))  # fmt: skip
    assert [len(set(mesh.regions)) for _, mesh in mesh_images([DISCS[0] + 1] * 2, workers=1, labels=iter([1, 2]))] == [2, 2]


# ---- lost workers ----

# In every process that is started: opening "once.png" ends it the first time, opening "always.png" each time.
HOOK = """
import os, signal, sys

def hook(event, arguments):
    name = str(arguments[0]) if event == "open" else ""
    first = name.endswith("once.png") and not os.path.exists(name + ".done")
    if first:
        os.close(os.open(name + ".done", os.O_CREAT | os.O_WRONLY))
    if first or name.endswith("always.png"):
        os.kill(os.getpid(), signal.SIGKILL)

sys.addaudithook(hook)
"""


@pytest.fixture
def deadly(tmp_path, monkeypatch):
    """Images among which are some that end the process that opens them."""
    paths = [str(tmp_path / name) for name in ("a.png", "once.png", "b.png", "always.png", "c.png", "d.png")]
    for path in paths:
        Image.fromarray(DISCS[0]).save(path)
    with hooked_workers(tmp_path, monkeypatch, HOOK):
        yield paths


def all_but_one(found, paths):
    assert [name for name, _ in found] == paths
    meshes = dict(found)
    assert isinstance(meshes.pop(paths[3]), MeshError)
    assert all(same(mesh, mesh_image(DISCS[0])) for mesh in meshes.values())
    assert Path(paths[1] + ".done").exists()


@pytest.mark.skipif(os.name == "nt", reason="signals are those of POSIX")
def test_a_lost_process_costs_a_retry_and_what_takes_two_is_given_up(deadly):
    all_but_one(list(mesh_images(deadly, workers=2)), deadly)
    assert not ours()


@pytest.mark.skipif(os.name == "nt", reason="signals are those of POSIX")
def test_a_lost_worker_of_a_cluster_costs_a_retry(deadly):
    distributed = pytest.importorskip("distributed")
    import dask

    two = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(**two) as cluster,
        distributed.Client(cluster) as other,
    ):
        all_but_one(list(mesh_images(deadly, client=other)), deadly)


SLOW = """
import os, time

def slow(number):
    time.sleep(0.2)
    return number, os.getpid()
"""


@pytest.mark.skipif(os.name == "nt", reason="signals are those of POSIX")
def test_a_process_killed_in_the_middle(tmp_path, monkeypatch):
    (tmp_path / "slowly.py").write_text(SLOW)
    monkeypatch.syspath_prepend(tmp_path)
    from slowly import slow

    pids, done = [], []
    for number, pid in in_order(slow, range(12), Processes(2), lost=lambda thing: pytest.fail(f"{thing} given up")):
        done.append(number)
        pids.append(pid)
        if number == 2:
            os.kill(pid, signal.SIGKILL)
    assert done == list(range(12))
    assert not ours()


# ---- the command line ----


def test_a_scheduler_writes_the_same_bytes(client, files, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    typed = ["mesh", *[path.name for path in files], "none.png", "--report", "rep/{stem}.json", "--out-dir", "out", "--format", "vtu"]
    client.write_scheduler_file(str(tmp_path / "scheduler.json"))
    told = []
    for where in ([], ["--scheduler", client.scheduler.address], ["--scheduler-file", "scheduler.json"]):
        assert main([*typed, *where]) == 2
        told.append((capsys.readouterr(), {p.name: p.read_bytes() for folder in ("out", "rep") for p in Path(folder).iterdir()}))
        for folder in ("out", "rep"):
            for path in Path(folder).iterdir():
                path.unlink()
    assert told[0] == told[1] == told[2]
    assert len(told[0][1]) == 2 * len(files)
    assert len(client.run(os.getpid)) == 2  # the cluster is still there


def test_no_scheduler_and_two_places(files, capsys, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("img2tri.many.dask_cluster.ANSWER_WITHIN", 0.5)
    assert main(["mesh", str(files[0]), "--scheduler", "tcp://127.0.0.1:9"]) == 2
    assert "--scheduler: expected one at tcp://127.0.0.1:9, found none that answers" in capsys.readouterr().err
    assert main(["mesh", str(files[0]), "--scheduler", "tcp://127.0.0.1:9", "--workers", "2"]) == 2
    assert "--workers: expected without a scheduler" in capsys.readouterr().err


def test_names_of_one_image():
    assert [(one.name, one.z) for one in each_image(np.zeros((2, 4, 5)), step=0.5)] == [("0", 0.0), ("1", 0.5)]
    assert img2tri.mesh_images is mesh_images
