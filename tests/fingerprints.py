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
from functools import partial
from itertools import chain, product
from operator import attrgetter
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
    {}, *each("edge_length", 3, "9px", "4%", {1: 5}), {"progress": lambda *_: None}, *each("boundary_edge_length", 3, "2px"),
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
    *over({"recipe": "unstructured", "threshold": 90}, {}, {"n_boundary_points": 70}, {"n_interior_points": 90}, {"origin": "upper"},
          {"seed": 5}, {"min_distance": 5, "min_distance_to_boundary": "2px"}, {"iterations": 0}, *each("smoothing", "none", "cotangent")),
]  # fmt: skip
LABELS: list[Options] = [
    *each("background", None, 3), {"labels": [2, 5, 7]}, {"labels": [4], "largest": True}, {"edge_length": {1: 3, 2: "8px"}},
]  # fmt: skip
LABEL_MAPS = {"polycrystal.png", "sag_104.png", "seg_ax_005.png", "Ti_sample24_c5restored.png", "electrode_3phase_128.png", "mask2d.tif"}
LAYERS: Options = {"height": 2.5, "layers": 2}
PRINTED: list[Options] = [{}, {"height": 2.5}]
SOLVED: list[Options] = [*PRINTED, LAYERS, {"order": 2}, {"order": 2} | LAYERS]
FORMATS = [
    ("stl ply obj off 3mf glb vtp", PRINTED), ("svg dxf geojson", PRINTED[:1]), ("vtu vtkhdf msh inp bdf xdmf", SOLVED),
    ("msh", over({"version": "2.2"}, *SOLVED)), ("inp", over({"deck": True}, *SOLVED, {"plane": "strain"})),
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


def drawn() -> Iterator[tuple[str, Any, list[Options]]]:
    """Yield the name of each image, its array, object or bytes, and the options it is meshed with."""
    mask, grains = np.asarray(blob(96, seed=4, holes=2)), specimens.polycrystal(96, 16, 3)  # type: ignore[no-untyped-call]
    gray, torus = clouds((84, 96), 5, 1), clouds((70, 56), 4, 2)
    phases, lengths = torus // 86, np.linspace(3, 11, mask.size).reshape(mask.shape)
    y, x = np.indices(mask.shape)
    sharp = (abs(y - 86) < 0.15 * (x - 8)) & (x < 47)
    specks = (y // 4 < 3) & (x // 4 < 3) & ((y // 4 + x // 4) % 2 == 0)  # they touch in corners
    yield "blob", (mask | sharp | specks) * np.uint8(255), [*WHITE, {"edge_length": lengths}, {"edge_length": lengths} | POISSON]
    yield "gray", gray, [*WHITE, *each("threshold", 100, 127.5), {"threshold": 150, "invert": True}]
    yield "grains", np.select([sharp, specks], [17, 18], grains), over({"labels": True}, *EVERY, *LABELS)
    for name, image in specimens.ALL.items():
        first: Options = {"labels": True, "background": None} if name in specimens.LABELS else {}
        yield name, image, over(first, {}, {"edge_length": 2, "connectivity": 8, "corners": "keep"})
    for turn, image in enumerate(specimens.turned(specimens.rectangle(44, (29.3, 11.8), 33.0, (20.2, 23.9)))):
        yield f"turned {turn}", image, each("edge_length", 5)
    for seed in range(3):
        noise = np.random.default_rng(seed).integers(0, 2 + seed, (16, 21))
        several: list[Options] = [{"background": None}, {"connectivity": 8} | POISSON, {"min_angle": 5}, {"min_area": 3}]
        yield f"noise {seed}", noise, over({"labels": True}, *several)
    yield "torus", torus > 120, [*SIDES, *over(POISSON, *SIDES), {"periodic": "xy", "boundary_edge_length": 3}]
    yield "phases", phases, over({"labels": True, "background": None, "edge_length": 5}, *SIDES)
    yield "gray disc", specimens.gray_disc(64, 21.7, (30.3, 33.1), 20, 220), each("threshold", None, 60)
    yield "floats", gray / 255.0, each("threshold", 0.4, "otsu")
    yield "large", specimens.polycrystal(300, 60), over({"edge_length": 8, "labels": True}, {}, {"background": 7} | POISSON)
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


def files(more: Path | None) -> Iterator[tuple[str, Any, list[Options]]]:
    """Yield the same for the images of `data`, and of a folder of real ones."""
    for path in sorted((ROOT / "data").glob("*.png")):
        first = {"labels": True} if path.name in LABEL_MAPS else {"threshold": 100}
        several = over({"edge_length": 8}, {"tolerance": 1.5, "corners": "keep"}, {"elements_across": 3}, {"max_pixels": 120_000})
        yield path.name, path, over(first, {}, *several, *each("recipe", "structured", "unstructured"))
    for path in sorted(more.iterdir()) if more else ():
        if path.suffix in (".png", ".jpg", ".tif"):
            yield f"more/{path.name}", path, [{"edge_length": "2%", "min_area": "10px2", "labels": path.name in LABEL_MAPS}]


def meshed(image: Any, options: Options) -> img2tri.TriangleMesh:
    """Mesh an image; bytes are a file."""
    return img2tri.mesh_image(io.BytesIO(image) if isinstance(image, bytes) else image, **options)


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


def digest(part: Any) -> str:
    """Sum up a mesh, the numbers of a report, arrays, whatever holds them, and plain data; the order of keys does not count."""
    if isinstance(part, img2tri.TriangleMesh):
        part = [part.vertices, part.triangles, part.regions]
    if isinstance(part, img2tri.Report):
        words = {"options", "settings", "warnings", "recipe", "removed", "notes"}
        part = {name: value for name, value in part.to_dict().items() if name not in words}
    if isinstance(part, dict):
        part = [(str(key), part[key]) for key in sorted(part, key=str)]
    if isinstance(part, list | tuple):
        part = ",".join(map(digest, part)).encode()
    elif isinstance(part, np.generic):
        part = part.item()
    elif isinstance(part, np.ndarray) and part.dtype.kind in "biuf":
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
    for name, image, several in chain(drawn(), files(more)):
        for options in several:
            mesh = note(lines, name, options, meshed, image, options)
            if mesh is not None:
                note(lines, f"report {name}", options, attrgetter("report"), mesh)
    ring = meshed(specimens.MASKS["ring"], {"edge_length": 5, "spacing": 0.5, "units": "mm", "names": {1: "bone"}})
    grains = meshed(specimens.polycrystal(40, 5, 1), {"labels": True, "edge_length": 6, "origin": "upper", "names": {2: "a b"}})
    torus = meshed(clouds((40, 50), 4, 2), {"threshold": 120, "periodic": "xy", "crop": (0, 0, 51, 41)})
    bare = img2tri.TriangleMesh(grains.vertices, grains.triangles, grains.regions)
    for name, mesh in {"ring": ring, "grains": grains, "torus": torus, "bare": bare}.items():
        for method, call in METHODS.items():
            note(lines, f"object {name} {method}", {}, call, mesh)
        for ends, several in FORMATS:
            for end, options in product(ends.split(), several):
                note(lines, f"format {name}.{end}", options, saved, mesh.save, end, options)
        for end in ("png", "svg", "pdf"):
            note(lines, f"format {name} plot.{end}", {}, saved, mesh.plot, end, {})
    for command in COMMANDS:
        run = partial(subprocess.check_output, cwd=ROOT, stderr=subprocess.DEVNULL)
        note(lines, f"format {command}", {}, run, [sys.executable, "-m", "img2tri", *command.split()])
    return lines


def main() -> int:
    """Run the command line; return 1 if a line differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, text in (("--write", "save the lines"), ("--compare", "print lines that differ"), ("--more", "folder of real images")):
        parser.add_argument(name, type=Path, help=text)
    chosen, start = parser.parse_args(), time.process_time()
    more: Path | None = chosen.more if chosen.more and chosen.more.is_dir() else None
    if more is None:
        print("left out: real images, from the folder named by --more", file=sys.stderr)
    lines = collect(more)
    print(f"{len(lines)} lines in {time.process_time() - start:.0f} s, of {ROOT}", file=sys.stderr)
    if chosen.write:
        chosen.write.write_text("".join(f"{name} {total}\n" for name, total in lines.items()))
    if chosen.compare:
        before = dict(line.rsplit(" ", 1) for line in chosen.compare.read_text().splitlines())
        before = {name: total for name, total in before.items() if more or "more/" not in name}
        different = [name for name in before | lines if before.get(name) != lines.get(name)]
        print(*(f"{name}: {before.get(name)} before, {lines.get(name)} now\n" for name in different), sep="", end="")
        return int(bool(different))
    if not chosen.write:
        print(*(f"{name} {total}" for name, total in lines.items()), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
