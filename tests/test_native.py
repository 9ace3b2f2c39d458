"""Nothing a user can pass makes libigl, VTK, OpenCV, GEOS or pythoncdt end the process: their known killers, in a child."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("resource")
import children
import specimens

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
TWO = np.array([[0, 1, 2], [0, 2, 3]])

MESHES = {
    "sound": (SQUARE, TWO, [1, 1]),
    "index too large": (SQUARE, [[0, 1, 4]], [1]),
    "index far too large": (SQUARE, [[0, 1, 2**40]], [1]),
    "index of 64 bits": (SQUARE, np.array([[0, 1, 2**64 - 1]], np.uint64), [1]),
    "negative index": (SQUARE, [[0, 1, -1]], [1]),
    "most negative index": (SQUARE, [[0, 1, -(2**63)]], [1]),
    "fractional index": (SQUARE, [[0.0, 1.0, 2.5]], [1]),
    "nan index": (SQUARE, [[0.0, 1.0, np.nan]], [1]),
    "no triangles": (SQUARE, np.zeros((0, 3), int), np.zeros(0, int)),
    "no vertices": (np.zeros((0, 2)), [[0, 1, 2]], [1]),
    "nothing": (np.zeros((0, 2)), np.zeros((0, 3), int), np.zeros(0, int)),
    "nan": ([[0, 0], [1, 0], [np.nan, 1]], [[0, 1, 2]], [1]),
    "inf": ([[0, 0], [1, 0], [np.inf, 1]], [[0, 1, 2]], [1]),
    "three coordinates": (np.ones((3, 3)), [[0, 1, 2]], [1]),
    "one coordinate": (np.ones((3, 1)), [[0, 1, 2]], [1]),
    "flat list": ([0, 0, 1, 0, 0, 1], [0, 1, 2], [1]),
    "quadrilateral": (SQUARE, [[0, 1, 2, 3]], [1]),
    "repeated vertex": (SQUARE, [[0, 1, 1]], [1]),
    "all in one place": (np.zeros((3, 2)), [[0, 1, 2]], [1]),
    "in a line": ([[0, 0], [1, 0], [2, 0]], [[0, 1, 2]], [1]),
    "double triangle": (SQUARE, [[0, 1, 2], [0, 1, 2]], [1, 1]),
    "turned over": (SQUARE, [[0, 2, 1], [0, 3, 2]], [1, 1]),
    "one turned over": (SQUARE, [[0, 1, 2], [0, 3, 2]], [1, 1]),
    "three at an edge": ([*SQUARE, [2, 2]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]], [1, 1, 1]),
    "bow-tie": ([[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]], [[0, 1, 2], [0, 3, 4]], [1, 1]),
    "unused vertex": ([*SQUARE, [9, 9]], TWO, [1, 1]),
    "double vertex": ([*SQUARE, [1, 1]], [[0, 1, 2], [0, 4, 3]], [1, 1]),
    "huge": (SQUARE * 1e300, TWO, [1, 1]),
    "tiny": (SQUARE * 1e-300, TWO, [1, 1]),
    "subnormal": (SQUARE * 5e-324, TWO, [1, 1]),
    "needle": ([[0, 0], [1, 0], [0.5, 1e-300]], [[0, 1, 2]], [1]),
    "regions of another length": (SQUARE, TWO, [1]),
    "regions of fractions": (SQUARE, TWO, [1.5, 2.5]),
    "regions of nan": (SQUARE, TWO, [np.nan, 1]),
    "huge regions": (SQUARE, TWO, [2**62, -(2**62)]),
    "objects": (np.array([[None, None]] * 3), [[0, 1, 2]], [1]),
    "words": ([["a", "b"]] * 3, [[0, 1, 2]], [1]),
    "complex": (SQUARE * 1j, TWO, [1, 1]),
    "bool": (SQUARE.astype(bool), TWO, [1, 1]),
    "ragged": ([[0, 0], [1], [0, 1]], [[0, 1, 2]], [1]),
    "big-endian": (SQUARE.astype(">f8"), TWO.astype(">i4"), [1, 1]),
    "column order": (np.asfortranarray(SQUARE), np.asfortranarray(TWO), [1, 1]),
    "every second": (np.repeat(SQUARE, 2, axis=0)[::2], np.repeat(TWO, 2, axis=0)[::2], [1, 1]),
    "float16": (SQUARE.astype(np.float16), TWO.astype(np.uint8), [1, 1]),
    "long double": (SQUARE.astype(np.longdouble), TWO, [1, 1]),
    "four dimensions": (np.zeros((2, 2, 2, 2)), np.zeros((2, 2, 2), int), [1]),
}
SUFFIXES = (".stl", ".ply", ".obj", ".off", ".3mf", ".glb", ".vtp", ".vtu")


def _uses():
    yield from ((f"smoothed {m}", lambda mesh, _, m=m: mesh.smoothed(m, iterations=2)) for m in ("uniform", "cotangent"))
    yield "smoothed free", lambda mesh, _: mesh.smoothed("cotangent", boundary="free")
    yield "smoothed without guard", lambda mesh, _: mesh.smoothed("uniform", guard=False)
    yield "quality", lambda mesh, _: str(mesh.quality())
    yield "repr", lambda mesh, _: repr(mesh)
    for height in (None, 1.0, 1e-300, 1e300, -1, 0, float("nan"), "x"):
        yield f"trimesh {height}", lambda mesh, _, h=height: mesh.to_trimesh(height=h)
        yield f"pyvista {height}", lambda mesh, _, h=height: mesh.to_pyvista(height=h)
    for suffix in SUFFIXES:
        yield f"saved {suffix}", lambda mesh, folder, s=suffix: mesh.save(folder / f"m{s}")
        yield f"saved solid {suffix}", lambda mesh, folder, s=suffix: mesh.save(folder / f"m{s}", height=1.0)


def use(name):
    """Make a mesh and do everything with it; what fails must fail with an error of img2tri."""
    import warnings

    from img2tri import Img2triError, TriangleMesh

    warnings.simplefilter("ignore")
    mesh = TriangleMesh(*(np.array(a) if name != "ragged" else a for a in MESHES[name]))
    refused = []
    with tempfile.TemporaryDirectory() as folder:
        for use_name, work in _uses():
            try:
                work(mesh, Path(folder))
            except Img2triError as error:
                refused.append(f"{use_name}: {error}"[:90])
            except Exception as error:
                raise RuntimeError(f"{use_name}: {type(error).__name__}: {error}") from error
    return f"{len(refused)} refused {refused}"


def load(case):
    """Load a file of these bytes, and judge what is in it."""
    from img2tri import TriangleMesh
    from img2tri.views.formats.save_load import load as load_file

    suffix, data = case
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"m{suffix}"
        path.write_bytes(data)
        mesh = TriangleMesh(*load_file(path))
    str(mesh.quality())
    return len(mesh.triangles)


def saved_files():
    """A sound file of each format that can be read back."""
    from img2tri import mesh_image

    mesh = mesh_image(specimens.polycrystal(24, 3), labels=True, edge_length=8)
    with tempfile.TemporaryDirectory() as folder:
        for suffix in SUFFIXES:
            mesh.save(Path(folder) / f"m{suffix}")
        return {path.suffix: path.read_bytes() for path in sorted(Path(folder).iterdir()) if path.suffix != ".3mf"}


def test_no_mesh_of_arrays_ends_the_process():
    names = [name for name in MESHES if name != "in a line"]
    outcomes = dict(zip(names, children.run("test_native:use", names), strict=True))
    assert {name: o for name, o in outcomes.items() if o.kind not in ("done", "refused")} == {}
    for name in ("index too large", "negative index", "nan", "no triangles", "three coordinates", "ragged", "complex", "repeated vertex"):
        assert outcomes[name].kind == "refused", name
    for name in ("sound", "big-endian", "column order", "every second", "float16", "bow-tie", "turned over", "unused vertex"):
        assert outcomes[name].kind == "done", name


def damaged(count):
    from test_hostile_images import flipped

    for k, (suffix, data) in enumerate(saved_files().items()):
        rng = np.random.default_rng(k)
        yield suffix, data
        yield from ((suffix, data[:cut]) for cut in range(0, len(data), max(1, len(data) // 10)))
        yield from ((suffix, flipped(data, rng)) for _ in range(count))


@pytest.mark.parametrize("count", [20, pytest.param(2000, marks=pytest.mark.slow)])
def test_no_file_of_a_mesh_ends_the_process(count):
    cases = list(damaged(count))
    outcomes = children.run("test_native:load", cases)
    wrong = [(case[0], outcome) for case, outcome in zip(cases, outcomes, strict=True) if outcome.kind not in ("done", "refused")]
    assert wrong == []
    assert sum(outcome.kind == "done" for outcome in outcomes) >= len(SUFFIXES) - 1
