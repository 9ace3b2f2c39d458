"""A full disk, a killed process, Ctrl-C, folders that refuse: the older file stays whole, and nothing is left beside it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import specimens
from children import PATIENCE

from img2tri import mesh_image
from img2tri.errors import FileError
from img2tri.views.formats.atomic_write import store, writable
from img2tri.views.formats.save_load import SURFACE_FORMATS, load

resource = pytest.importorskip("resource")
OLD = b"what was there before"
DISC = specimens.disc(40, 15.0).astype(bool)


def child(code, *arguments, **options):
    env = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], env=env, stderr=subprocess.PIPE, **options)


@pytest.fixture(scope="module")
def mesh():
    return mesh_image(DISC, edge_length=2)


FULL = """
import resource, signal, sys
from pathlib import Path
import numpy as np
from img2tri import mesh_image
mesh = mesh_image(np.hypot(*np.mgrid[-20:20, -20:20]) < 15, edge_length=2)
paths = [Path(sys.argv[1]) / ("mesh" + suffix) for suffix in sys.argv[2:]]
for path in paths:
    mesh.save(path)  # all libraries are in memory
    path.write_bytes(b"what was there before")
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
for path in paths:
    try:
        mesh.save(path)
    except OSError as error:
        print(type(error).__name__, "cannot be written" in str(error))
    else:
        print("saved", path.suffix)
"""


def test_a_full_disk_leaves_the_older_files_whole(tmp_path):
    done = child(FULL, tmp_path, *SURFACE_FORMATS, stdout=subprocess.PIPE)
    out, err = done.communicate(timeout=PATIENCE)
    assert out.decode().split("\n") == ["FileError True"] * len(SURFACE_FORMATS) + [""], err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {f"mesh{suffix}": OLD for suffix in SURFACE_FORMATS}


STOPPED = f"""
import os, sys, time
from pathlib import Path
from img2tri.views.formats import atomic_write as storing
wait = os.fsync
def slow(number):
    wait(number)
    print("written", flush=True)
    time.sleep({PATIENCE:g})
os.fsync = slow
storing.store(storing.writable(sys.argv[1], [".stl"]), b"new" * 1000)
"""


def stopped(path, how):
    with child(STOPPED, path, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"written\n"
        process.send_signal(how)
        process.wait(timeout=PATIENCE)


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
@pytest.mark.parametrize("there", [True, False])
def test_a_stopped_process_leaves_the_older_file_whole(tmp_path, how, there):
    path = tmp_path / "mesh.stl"
    if there:
        path.write_bytes(OLD)
    stopped(path, how)
    assert path.exists() == there
    if there:
        assert path.read_bytes() == OLD


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_leaves_no_litter(tmp_path):
    stopped(tmp_path / "mesh.stl", signal.SIGINT)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "O_TMPFILE"), reason="only Linux has files without a name")
def test_a_killed_process_leaves_no_litter(tmp_path):
    stopped(tmp_path / "mesh.stl", signal.SIGKILL)
    assert list(tmp_path.iterdir()) == []


def test_a_process_killed_at_any_moment(tmp_path):
    code = (
        "import sys, numpy as np; from img2tri import mesh_image\n"
        "mesh = mesh_image(np.hypot(*np.mgrid[-20:20, -20:20]) < 15, edge_length=2)\n"
        "print('ready', flush=True)\n"
        "while True: mesh.save(sys.argv[1])\n"
    )
    path = tmp_path / "mesh.stl"
    with child(code, path, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        deadline = time.monotonic() + PATIENCE
        while not path.exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.05)
        process.kill()
    assert len(load(path)[1]) > 100


NAMES = ["two words", " before and after ", "größe-密度-🦴", "line\nbreak", "-o", "{stem}", "a'b\"c", "%s%d", "x" * 240]


@pytest.mark.parametrize("name", NAMES)
def test_names_of_all_kinds(tmp_path, mesh, name):
    for suffix in (".stl", ".vtu", ".ply"):
        path = tmp_path / (name + suffix)
        mesh.save(path)
        assert len(load(path)[1]) == len(mesh.triangles)
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize("name", ["x" * 300 + ".stl", "nul\0.stl", "", "folder.stl", "file/mesh.stl", "none/mesh.stl", "loop.stl"])
def test_names_that_cannot_be(tmp_path, mesh, name, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("folder.stl").mkdir()
    Path("file").write_bytes(b"")
    Path("loop.stl").symlink_to("loop.stl")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(FileError):
        mesh.save(name)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_link_is_followed_and_stays_one(tmp_path, mesh):
    (tmp_path / "real.stl").write_bytes(OLD)
    link = tmp_path / "link.stl"
    link.symlink_to("real.stl")
    mesh.save(link)
    assert link.is_symlink()
    assert len(load(tmp_path / "real.stl")[1]) == len(mesh.triangles)


def test_an_image_with_a_name_of_all_kinds(tmp_path):
    from PIL import Image

    path = tmp_path / "line\nbreak größe 密度.png"
    Image.fromarray(DISC).save(path)
    assert len(mesh_image(path).triangles) > 10


def test_permissions_of_an_older_file_stay(tmp_path):
    path = tmp_path / "mesh.stl"
    path.write_bytes(OLD)
    path.chmod(0o640)
    store(writable(path, [".stl"]), b"new")
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("where", ["reading", "labels", "outlines", "points", "spacing", "triangles", "smoothing", "done"])
def test_what_progress_raises_ends_the_work(where):
    class Enough(Exception):
        pass

    def progress(stage, _):
        if stage == where:
            raise Enough

    with pytest.raises(Enough):
        mesh_image(np.asarray(DISC), progress=progress)
    assert len(mesh_image(np.asarray(DISC)).triangles) > 10
