"""Threads and processes: many meshes at once are the same as one after the other, and nothing global changes."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import warnings

import numpy as np
import pytest
import specimens
from PIL import Image

from img2tri import mesh_image

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
    from img2tri.views.files import load

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
