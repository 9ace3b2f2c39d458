"""Threads, processes and workers: many meshes at once are the same as one after the other, and nothing global changes."""

from __future__ import annotations

import concurrent.futures
import io
import multiprocessing
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
import specimens
from children import PATIENCE, hooked_workers
from PIL import Image

from img2tri import mesh_image
from img2tri.cli import main, printing
from img2tri.cli import run_jobs as pool
from img2tri.cli.job import Job
from img2tri.many.local_workers import _context, local_workers

IMAGES = [specimens.disc(30 + k, 10.0 + k / 2).astype(bool) for k in range(4)]
CASES = [(image, {"recipe": "conforming"}) for image in IMAGES] + [(image, {"recipe": "unstructured", "threshold": 0}) for image in IMAGES]


def made(case):
    image, options = case
    mesh = mesh_image(image if options["recipe"] == "conforming" else image.astype(np.uint8), **options)
    return mesh.vertices.tobytes(), mesh.triangles.tobytes(), mesh.report.to_json()


def test_threads_make_the_same_meshes():
    alone = [made(case) for case in CASES]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert list(pool.map(made, CASES * 4)) == alone * 4


def read(path):
    return mesh_image(path).vertices.tobytes()


def test_threads_read_the_same_files(tmp_path):
    limit = Image.MAX_IMAGE_PIXELS
    paths = []
    for k, image in enumerate(IMAGES):
        paths += [tmp_path / f"{k}.png", tmp_path / f"{k}.tif"]
        for path in paths[-2:]:
            Image.fromarray(image).save(path)
    alone = [read(path) for path in paths]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert list(pool.map(read, paths * 6)) == alone * 6
    assert limit == Image.MAX_IMAGE_PIXELS


def test_threads_save_to_one_name(tmp_path):
    meshes = [mesh_image(image) for image in IMAGES]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda mesh: mesh.save(tmp_path / "mesh.ply"), meshes * 8))
    from img2tri.views.formats.save_load import load

    assert len(load(tmp_path / "mesh.ply")[1]) in {len(mesh.triangles) for mesh in meshes}
    assert len(list(tmp_path.iterdir())) == 1


def test_spawned_processes_make_the_same_meshes():
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        others = list(pool.map(mesh_image, IMAGES[:2]))  # a mesh comes back from another process whole
    for image, other in zip(IMAGES[:2], others, strict=True):
        mesh = mesh_image(image)
        assert other.vertices.tobytes() == mesh.vertices.tobytes()
        assert other.triangles.tobytes() == mesh.triangles.tobytes()
        assert other.report == mesh.report


def test_nothing_global_changes():
    np.random.seed(7)  # noqa: NPY002
    before = np.random.get_state()[1].copy(), np.geterr(), list(warnings.filters), np.get_printoptions()  # noqa: NPY002
    for case in CASES[::4]:
        made(case)
    after = np.random.get_state()[1].copy(), np.geterr(), list(warnings.filters), np.get_printoptions()  # noqa: NPY002
    assert (before[0] == after[0]).all()
    assert before[1:] == after[1:]


@pytest.mark.parametrize("case", CASES[::4])
def test_the_image_stays_as_it_was(case):
    image = case[0].copy()
    image.flags.writeable = False
    made((image, case[1]))
    assert (image == case[0]).all()


# ---- img2tri mesh --workers ----

# In every process that is started: what happens when files of certain names are opened.
HOOK = """
import os, signal, sys, time

def hook(event, arguments):
    name = str(arguments[0]) if event == "open" else ""
    if name.endswith("kills.png"):
        os.kill(os.getpid(), signal.SIGKILL)
    if name.endswith("exits.png"):
        os._exit(7)
    if name.endswith("raises.png"):
        raise ZeroDivisionError("a mistake")
    if name.endswith("waits.png"):
        os.close(os.open(f"{name}.{os.getpid()}", os.O_CREAT | os.O_WRONLY))
        time.sleep(600)

sys.addaudithook(hook)
"""


@pytest.fixture
def hooked(tmp_path, monkeypatch):
    with hooked_workers(tmp_path, monkeypatch, HOOK):
        yield


@pytest.fixture
def images(tmp_path, monkeypatch):
    """Names of images in the working folder, made when asked for."""
    monkeypatch.chdir(tmp_path)

    def written(*names):
        for k, name in enumerate(names):
            if name.startswith("bad"):
                Path(name).write_bytes(b"not an image")
            else:
                Image.fromarray(IMAGES[k % len(IMAGES)]).save(name)
        return list(names)

    return written


def contents(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir() if path.is_file()}


def test_workers_write_the_same_bytes_and_say_the_same_words(images, tmp_path, monkeypatch, capsys):
    names = images("d.png", "bad1.png", "b.png", "a.png", "bad2.png", "c.png")
    typed = ["--out-dir", "out", "--format", "stl", "--format", "ply", "-o", "{stem}.vtu", "--report", "{stem}.json"]
    told = []
    for workers in ("1", "2"):
        folder = tmp_path / workers
        folder.mkdir()
        for name in names:
            (folder / name).write_bytes((tmp_path / name).read_bytes())
        monkeypatch.chdir(folder)
        assert main(["mesh", *names, *typed, "--workers", workers]) == 2
        told.append((capsys.readouterr(), contents("out"), contents(".")))
    assert told[0] == told[1]
    (out, err), written, others = told[0]
    assert sorted(written) == sorted(f"{name}.{suffix}" for name in "abcd" for suffix in ("ply", "stl"))
    assert set(others) - set(names) == {f"{name}.{suffix}" for name in "abcd" for suffix in ("vtu", "json")}
    assert [line.partition(":")[0] for line in out.splitlines() if "triangles" in line] == ["d.png", "b.png", "a.png", "c.png"]
    assert err.splitlines()[-1] == "img2tri: 2 of 6 images failed: bad1.png, bad2.png"
    assert [line.split(": ")[1] for line in err.splitlines()[:-1]] == ["bad1.png", "bad2.png"]


@pytest.mark.skipif(os.name == "nt", reason="signals are those of POSIX")
@pytest.mark.usefixtures("hooked")
def test_a_worker_that_dies_fails_its_image_only(images, capsys):
    names = images("kills.png", "a.png", "exits.png", "b.png")
    assert main(["mesh", *names, "--out-dir", "out", "--workers", "2", "--quiet"]) == 2
    assert sorted(contents("out")) == ["a.ply", "b.ply"]
    assert capsys.readouterr().err.splitlines() == [
        "img2tri: kills.png: the process that meshed it ended twice; if memory ran out, fewer --workers need less",
        "img2tri: exits.png: the process that meshed it ended twice; if memory ran out, fewer --workers need less",
        "img2tri: 2 of 4 images failed: kills.png, exits.png",
    ]
    assert not multiprocessing.active_children()


@pytest.mark.usefixtures("hooked")
def test_a_mistake_of_ours_in_a_worker_is_not_hidden(images):
    # In the process itself no file is opened that way, so it must be a worker that raised.
    jobs = [Job(name, {}) for name in images("raises.png", "a.png")]
    with pytest.raises(ZeroDivisionError, match="a mistake"):
        list(pool.run(jobs, local_workers(2), lambda *_: None))
    assert not multiprocessing.active_children()


@pytest.mark.skipif(os.name == "nt", reason="signals to groups of processes are those of POSIX")
@pytest.mark.parametrize("workers", ["1", "2"])
@pytest.mark.usefixtures("hooked", "ctrl_c")
def test_ctrl_c_stops_all_workers_and_leaves_nothing(images, tmp_path, workers):
    names = images("1waits.png", "2waits.png", "3waits.png")
    command = [sys.executable, "-m", "img2tri", "mesh", *names, "--out-dir", "out", "--workers", workers]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True, text=True) as process:
        deadline = time.monotonic() + PATIENCE
        while len(waiting := list(tmp_path.glob("*waits.png.*"))) < int(workers) and time.monotonic() < deadline:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out, err) == (130, "", "")
    assert len(waiting) == int(workers)
    for path in waiting:
        with pytest.raises(ProcessLookupError):
            os.kill(int(path.name.rpartition(".")[2]), 0)
    assert sorted({path.name for path in tmp_path.iterdir()} - {path.name for path in waiting}) == sorted([*names, "hook"])


class _Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("workers", ["1", "2"])
def test_one_bar_for_all_images(workers, images, monkeypatch, capsys):
    names = images("a.png", "bad.png", "b.png")
    monkeypatch.setattr(printing, "PATIENCE", 0)
    monkeypatch.setattr(sys, "stderr", _Terminal())
    monkeypatch.setenv("TERM", "xterm")
    assert main(["mesh", *names, "--out-dir", "out", "--workers", workers]) == 2
    text = sys.stderr.getvalue()
    assert "0 of 3 images, " in text
    assert "3 of 3 images, " in text
    # Words have a line to themselves.
    assert "\nimg2tri: bad.png: " in text.replace("\x1b[2K", "\n")
    assert "%" not in capsys.readouterr().out.replace("1 %", "").replace("99 %", "")


def test_the_bar_only_goes_forward(images):
    calls = []
    jobs = [Job(name, {"edge_length": 8}) for name in images("a.png", "bad.png", "b.png")]
    for workers in (1, 2):
        calls.clear()
        outcomes = list(pool.run(jobs, local_workers(workers), lambda *call: calls.append(call)))
        assert [outcome.image for outcome in outcomes] == ["a.png", "bad.png", "b.png"]
        for number in range(3):
            done = [fraction for k, _, fraction in calls if k == number]
            assert done == sorted(done)
            assert done[-1] == 1


def test_as_many_workers_as_the_system_allows(images, monkeypatch, capsys):
    def refuse(_):
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(_context().Process, "start", refuse)
    assert main(["mesh", *images("a.png", "b.png"), "--out-dir", "out", "--workers", "2"]) == 2
    assert "--workers: expected no more than the system allows" in capsys.readouterr().err
    assert not Path("out").exists()


def test_workers_are_a_whole_number_above_0(images, capsys):
    for text in ("0", "-2"):
        assert main(["mesh", *images("a.png"), "--out-dir", "out", f"--workers={text}"]) == 2
        assert capsys.readouterr().err == f"img2tri: --workers: expected a whole number of at least 1, found {text}\n"
        assert not Path("out").exists()
