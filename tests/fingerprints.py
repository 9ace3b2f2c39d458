"""Fingerprints of what img2tri makes, to show that a change of the code leaves every mesh and every file as it was, bit for bit.

In: the img2tri that Python imports, `data` and the drawn shapes of the tests beside it; with ``--more FOLDER`` real images too.
Out: lines ``name sha256`` for meshes, ``report name sha256`` for the numbers of their reports, ``object name sha256`` for what methods
return, ``format name sha256`` for files. Where there is an error, its class stands for the sum. Only public names are used.

    PYTHONPATH=. python tests/fingerprints.py --write before.txt      # before the change
    PYTHONPATH=. python tests/fingerprints.py --compare before.txt    # after it; status 1 if a line differs
"""

from __future__ import annotations

import argparse
import hashlib
import io
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pyvista
from PIL import Image
from scipy.ndimage import gaussian_filter

import img2tri

ROOT = next(folder for folder in Path(img2tri.__file__).resolve().parents if (folder / "data" / "femur.png").exists())
sys.path.insert(0, str(ROOT / "tests"))
import specimens  # noqa: E402
from benchmarks.shapes import blob  # noqa: E402

Options = dict[str, Any]


def each(name: str, *values: Any) -> list[Options]:
    """Options that differ in one value."""
    return [{name: value} for value in values]


def over(first: Options, *several: Options) -> list[Options]:
    """Options that begin with the same ones."""
    return [first | more for more in several]


POISSON, SIDES = {"interior": "poisson"}, each("periodic", "x", "y", "xy")
EVERY = [  # for every kind of image
    {}, *each("edge_length", 4, "9px", "4%", {1: 5}), {"progress": lambda *_: None}, *each("boundary_edge_length", 3, "2px"),
    *over({"edge_length": lambda places: 3 + 0.1 * abs(places[:, 0])}, {}, *each("gradation", 0.08, 0.4), POISSON),
    *over({"min_edge_length": 3}, {"boundary_edge_length": 2}, {"elements_across": 3}), *each("min_angle", 0, 20, 32),
    *each("elements_across", 2, 3.5), *each("segments_per_turn", 12, 60), *each("tolerance", 0.1, "1px", 2), {"keep_area": False},
    *over(POISSON, {}, {"seed": 7}, {"min_angle": 20, "keep_area": False}), *each("corners", "keep", "round"), {"connectivity": 8},
    *over({"outline": "pixel"}, {}, {"corners": "keep"}), *each("seed", 3), *each("smoothing", "none", "uniform", "cotangent"),
    {"smoothing": "cotangent", "iterations": 40}, {"smoothing": "uniform", "iterations": 3}, *each("spacing", 0.25, (0.5, 0.8), (3, 1)),
    *each("origin", "upper", (10.3, -4)), {"spacing": 0.1, "origin": "upper", "edge_length": 0.7}, *each("units", "um"), {"largest": True},
    {"crop": (10, 5, 70, 62)}, {"crop": (5.4, 4, 30, 31), "spacing": (0.5, 0.6)}, *each("min_area", 30, "200px2"), {"names": {1: "bone"}},
]  # fmt: skip
WHITE = [  # for one white zone
    *EVERY, {"invert": True}, *over({"recipe": "structured", "threshold": 90}, {}, *each("step", 5, "3%"), {"spacing": (0.5, 0.8)}),
    *over({"recipe": "unstructured", "threshold": 90}, {}, {"n_boundary_points": 70}, {"n_interior_points": 90, "seed": 5},
          {"min_distance": 5, "min_distance_to_boundary": "2px"}, {"edge_length": 6, "iterations": 0},
          *each("smoothing", "none", "uniform")),
]  # fmt: skip
LABELS = [
    *each("background", None, 3), {"labels": [2, 5, 7]}, {"labels": [4], "largest": True}, {"edge_length": {1: 3, 2: "8px"}},
]  # fmt: skip
DATA = {
    "femur.png": [{"edge_length": 12}, {"recipe": "unstructured"}, {"recipe": "structured"}], "femur_gray.png": each("edge_length", 12),
    "plate.png": [{}, {"threshold": 80.5, "edge_length": 7}], "gear.png": over({"edge_length": 8}, {}, {"corners": "keep"}),
    "blobs.png": over({"edge_length": 8}, {}, *each("max_pixels", 120_000, 119_999)), "blob_with_holes.png": [{}, {"elements_across": 2}],
    "polycrystal.png": over({"edge_length": 9}, {"labels": True}, {"labels": range(1, 20)}),
}  # fmt: skip
MORE = {
    "sag_104.png": {"labels": True}, "seg_ax_005.png": {"labels": True}, "ct16_ax_512.png": {"edge_length": 10, "min_area": "40px2"},
    "Ti_sample24_c5restored.png": {"labels": True, "min_area": 8}, "electrode_3phase_128.png": {"labels": True, "background": None},
    "nanomesh_segmented.png": {}, "aluminum_micro.png": {}, "mask2d.tif": {"labels": True}, "aegean_1320x960.png": {"edge_length": 12},
    "shade.tif": {"edge_length": 16}, "Landscape_6.jpg": {"min_area": 400, "edge_length": 30}, "basn3p01.png": {"labels": True},
}  # fmt: skip
SOLVERS = ("vtu", "msh", "inp", "bdf", "xdmf", "vtkhdf")
FORMATS = [
    *[(end, more) for end in ("stl", "ply", "obj", "off", "3mf", "glb", "vtp", *SOLVERS) for more in ({}, {"height": 2.5})],
    *[(end, more) for end in SOLVERS for more in ({"height": 2.5, "layers": 3}, {"order": 2}, {"order": 2, "height": 2.5, "layers": 2})],
    *[("msh", more) for more in over({"version": "2.2"}, {}, {"order": 2}, {"height": 2.5})], ("svg", {}), ("dxf", {}), ("geojson", {}),
    *[("inp", more) for more in over({"deck": True}, {}, {"plane": "strain"}, {"order": 2}, {"height": 2.5})],
]  # fmt: skip
COMMANDS = ("mesh data/plate.png -o - --format stl --edge-length 9", "view-report data/plate.png -o - --edge-length 9")
METHODS: dict[str, Callable[[Any], Any]] = {
    "sets": lambda m: asdict(m.sets()), "second order": lambda m: asdict(m.second_order()), "periodic pairs": lambda m: m.periodic_pairs,
    "outlines": lambda m: {label: shape.wkb for label, shape in m.outlines().items()}, "shown": lambda m: [repr(m), m._repr_html_()],
    "quality": lambda m: [m.quality().arrays, m.quality().summary()], "skfem": lambda m: arrays(m.to_skfem()),
    "uniform": lambda m: m.smoothed("uniform", iterations=5, guard=False), "cotangent": lambda m: m.smoothed(),
    "free": lambda m: m.smoothed(boundary="free", tolerance=1.0), "pyvista": lambda m: arrays(m.to_pyvista()),
    "pyvista solid": lambda m: arrays(m.to_pyvista(2.5)), "wedges": lambda m: arrays(m.to_pyvista(2.5, solid=True, layers=2)),
    "pyvista order 2": lambda m: arrays(m.to_pyvista(order=2)), "wedges order 2": lambda m: arrays(m.to_pyvista(2.5, solid=True, order=2)),
    "trimesh": lambda m: arrays(m.to_trimesh()), "trimesh solid": lambda m: arrays(m.to_trimesh(2.5)),
    "trimesh split": lambda m: {name: arrays(body) for name, body in m.to_trimesh(2.5, split=True).geometry.items()},
}  # fmt: skip


def clouds(shape: tuple[int, int], width: float, seed: int) -> Any:
    """Gray values 0 to 255 that repeat on both axes, the first row and column once more at the end."""
    values = gaussian_filter(np.random.default_rng(seed).standard_normal(shape), width, mode="wrap")
    return np.pad(np.interp(values, (values.min(), values.max()), (0, 255)).astype(np.uint8), ((0, 1), (0, 1)), mode="wrap")


def images() -> Iterator[tuple[str, Any, list[Options]]]:
    """Yield the name of each image, its array, path, object or bytes, and the options it is meshed with."""
    mask, gray, torus = blob(96, seed=4, holes=2), clouds((84, 96), 5, 1), clouds((70, 56), 4, 2)
    phases, lengths = torus // 86, np.linspace(3, 11, mask.size).reshape(mask.shape)
    yield "blob", mask * np.uint8(255), [*WHITE, {"edge_length": lengths}, {"edge_length": lengths} | POISSON]
    yield "gray", gray, [*WHITE, *each("threshold", 100, 127.5, "otsu"), {"threshold": 150, "invert": True}]
    yield "grains", specimens.polycrystal(80, 16, 3), over({"labels": True}, *EVERY, *LABELS)
    for name, image in specimens.ALL.items():
        first: Options = {"labels": True, "background": None} if name in specimens.LABELS else {}
        yield name, image, over(first, {}, {"edge_length": 2, "connectivity": 8, "corners": "keep"})
    for turn, image in enumerate(specimens.turned(specimens.rectangle(44, (29.3, 11.8), 33.0, (20.2, 23.9)))):
        yield f"turned {turn}", image, each("edge_length", 5)
    for seed in range(3):
        noise = np.random.default_rng(seed).integers(0, 2 + seed, (16, 21))
        yield f"noise {seed}", noise, over({"labels": True}, {"background": None}, {"connectivity": 8} | POISSON, {"min_area": 3})
    yield "torus", torus > 120, [*SIDES, *over(POISSON, *SIDES), {"periodic": "xy", "boundary_edge_length": 3}]
    yield "phases", phases, over({"labels": True, "background": None, "edge_length": 5}, *SIDES)
    yield "gray disc", specimens.gray_disc(64, 21.7, (30.3, 33.1), 20, 220), each("threshold", None, 60)
    yield "floats", gray / 255.0, each("threshold", 0.4, "otsu")
    yield "large blob", blob(400), over({"edge_length": 8}, {}, POISSON)
    yield "large grains", specimens.polycrystal(300, 60), over({"edge_length": 8, "labels": True}, {}, POISSON)
    yield "colours", np.stack([phases * 80, phases * 40, 255 - phases], axis=2).astype(np.uint8), [{"labels": True}, {}]
    first_page, *others = (Image.fromarray(page) for page in (torus, torus[::-1], torus.T))
    tiff, png = io.BytesIO(), io.BytesIO()
    first_page.save(tiff, "TIFF", save_all=True, append_images=others)
    first_page.save(png, "PNG", dpi=(254, 127))
    yield "tiff", tiff.getvalue(), each("page", 0, 2)
    yield "png", png.getvalue(), each("spacing", "file")
    placed = pyvista.ImageData(dimensions=(58, 72, 1), spacing=(0.2, 0.3, 1), origin=(3, -2, 1.5))
    placed.cell_data["values"] = torus.ravel()
    yield "pyvista", placed, each("edge_length", None, 0.9)
    yield from ((name, ROOT / "data" / name, several) for name, several in DATA.items())


def meshed(image: Any, options: Options) -> img2tri.TriangleMesh:
    """Mesh an image; bytes are a file."""
    return img2tri.mesh_image(io.BytesIO(image) if isinstance(image, bytes) else image, **options)


def judged(mesh: img2tri.TriangleMesh) -> Options:
    """Return the numbers of the report."""
    return {name: value for name, value in mesh.report.to_dict().items() if name not in ("options", "settings", "warnings", "recipe")}


def arrays(made: Any) -> Options:
    """Take apart what pyvista, trimesh and scikit-fem hold."""
    names = ("points", "vertices", "faces", "cells", "celltypes", "p", "t", "subdomains", "boundaries")
    data = getattr(made, "cell_data", None) or getattr(made, "face_attributes", {})
    return {name: getattr(made, name) for name in names if hasattr(made, name)} | dict(data.items())


def saved(save: Callable[..., Any], end: str, options: Options) -> dict[str, bytes]:
    """Return the files that are written under a name with this end."""
    with TemporaryDirectory() as folder:
        save(path=Path(folder) / f"mesh.{end}", **options)
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def printed(command: str) -> bytes:
    """Return what a command writes to stdout."""
    return subprocess.run([sys.executable, "-m", "img2tri", *command.split()], cwd=ROOT, capture_output=True, check=True).stdout


def digest(part: Any) -> str:
    """Sum up a mesh, arrays as float64 or int64, whatever holds them, and plain data; the order of keys does not count."""
    if isinstance(part, img2tri.TriangleMesh):
        part = [part.vertices, part.triangles, part.regions]
    if isinstance(part, dict):
        part = [(str(key), part[key]) for key in sorted(part, key=str)]
    if isinstance(part, list | tuple):
        part = ",".join(map(digest, part)).encode()
    elif isinstance(part, np.ndarray | np.generic) and part.dtype.kind in "biuf":
        kind = np.float64 if part.dtype.kind == "f" else np.int64
        part = str(part.shape).encode() + np.ascontiguousarray(part, kind).tobytes()
    return hashlib.sha256(part if isinstance(part, bytes) else repr(part).encode()).hexdigest()


def note(lines: dict[str, str], name: str, options: Options, make: Callable[..., Any], *given: Any) -> Any:
    """Note the sum of what `make` returns, and return it; if it raises an error, note its class."""
    plain = {key: "array" if isinstance(value, np.ndarray) else "function" if callable(value) else value for key, value in options.items()}
    name = " ".join([name, *(f"{key}={value}" for key, value in plain.items())])
    assert name not in lines, name
    try:
        made = make(*given)
        lines[name] = digest(made)
    except Exception as error:
        made, lines[name] = None, type(error).__name__
    return made


def collect(more: Path | None) -> dict[str, str]:
    """Mesh all images, judge the meshes, and put some of them through all methods and formats."""
    lines: dict[str, str] = {}
    real = [(f"more/{name}", more / name, [options]) for name, options in MORE.items() if more and (more / name).exists()]
    for name, image, several in [*images(), *real]:
        for options in several:
            mesh = note(lines, name, options, meshed, image, options)
            if mesh is not None:
                note(lines, f"report {name}", options, judged, mesh)
    bone = meshed(blob(64), {"edge_length": 7, "spacing": 0.5, "units": "mm", "names": {1: "bone"}})
    grains = meshed(specimens.polycrystal(40, 5, 1), {"labels": True, "edge_length": 6, "origin": "upper", "names": {2: "a b"}})
    torus = meshed(clouds((40, 50), 4, 2), {"threshold": 120, "periodic": "xy", "recipe": "conforming"})
    bare = img2tri.TriangleMesh(bone.vertices.copy(), bone.triangles.copy(), bone.regions.copy())
    for name, mesh in {"bone": bone, "grains": grains, "torus": torus, "bare": bare}.items():
        for method, call in METHODS.items():
            note(lines, f"object {name} {method}", {}, call, mesh)
        for end, options in FORMATS:
            note(lines, f"format {name}.{end}", options, saved, mesh.save, end, options)
        for end in ("png", "svg", "pdf"):
            note(lines, f"format {name} plot.{end}", {}, saved, mesh.plot, end, {})
    for command in COMMANDS:
        note(lines, f"format {command}", {}, printed, command)
    return lines


def main() -> int:
    """Run the command line; return 1 if a line differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, text in (("--write", "save the lines"), ("--compare", "print lines that differ"), ("--more", "folder of real images")):
        parser.add_argument(name, type=Path, help=text)
    chosen, start = parser.parse_args(), time.perf_counter()
    lines = collect(chosen.more)
    absent = [name for name in MORE if not any(line.startswith(f"more/{name}") for line in lines)]
    spent = time.perf_counter() - start
    print(f"{len(lines)} lines in {spent:.0f} s, of {ROOT}; not there: {', '.join(absent) or 'none'}", file=sys.stderr)
    if chosen.write:
        chosen.write.write_text("".join(f"{name} {total}\n" for name, total in lines.items()))
    if chosen.compare:
        before = dict(line.rsplit(" ", 1) for line in chosen.compare.read_text().splitlines())
        before = {name: total for name, total in before.items() if not any(f"more/{image}" in name for image in absent)}
        different = [name for name in before | lines if before.get(name) != lines.get(name)]
        print(*(f"{name}: {before.get(name)} before, {lines.get(name)} now\n" for name in different), sep="", end="")
        return int(bool(different))
    if not chosen.write:
        print(*(f"{name} {total}" for name, total in lines.items()), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
