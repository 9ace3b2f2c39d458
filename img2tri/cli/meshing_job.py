"""Doing a job: an image is meshed and its files are written -> an outcome, with all there is to say about it.

Nothing is printed here, since this may be another process than the one that has the terminal. What a user can cause ends in the outcome;
what is a mistake of ours is raised.
"""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

from img2tri.cli.job import Job, Outcome
from img2tri.cli.stdin_stdout import DASH, STEM, from_stdin, named
from img2tri.cli.summary_table import facts, in_one_line
from img2tri.errors import FileError, Img2triError, Img2triWarning

if TYPE_CHECKING:
    from img2tri.mesh import TriangleMesh
    from img2tri.raster.files.byte_sources import Source

Progress = Callable[[str, float], None]
ONE_FOLDER = Lock()  # a process works in one at a time


def make(job: Job, progress: Progress) -> Outcome:
    """Mesh an image and write its files."""
    try:
        with _within(job.folder):
            return _made(job, progress)
    except (Img2triError, MemoryError) as error:
        return Outcome(job.image, problem=problem(error))


@contextmanager
def _within(folder: str | None) -> Iterator[None]:
    """Work in a folder, so that names, which are told in files and messages, are those that were typed."""
    if folder is None or folder == os.getcwd():
        yield
        return
    with ONE_FOLDER:
        before = os.getcwd()
        try:
            os.chdir(folder)
        except OSError as problem:
            raise FileError(f"{folder!r}: expected a folder the worker can see, found that it cannot ({problem.strerror})") from problem
        try:
            yield
        finally:
            os.chdir(before)


def held(job: Job) -> Job | Outcome:
    """Return a job that another process can do, with the bytes of stdin in it, or what became of it."""
    try:
        image = opened(job.image, job.options)
        return job if isinstance(image, str) else replace(job, source=image)
    except (Img2triError, MemoryError) as error:
        return Outcome(job.image, problem=problem(error))


def problem(error: BaseException) -> str:
    """Say in one line what was wrong."""
    return "expected more memory than there is" if isinstance(error, MemoryError) else " ".join(str(error).split())


def _made(job: Job, progress: Progress) -> Outcome:
    from img2tri.pipeline import mesh_image
    from img2tri.views.formats.atomic_write import store, writable

    began = time.perf_counter()
    image = job.source or opened(job.image, job.options)
    with _forewarned() as told:
        mesh = mesh_image(image, progress=progress, **job.options)
    for path, given in job.meshes:
        mesh.save(path, **_with_arrays(mesh, given))
    if job.plot:
        mesh.plot(meshed_pixels(image, job.options), job.plot, colour_by=job.colour_by)
    if job.report:
        store(writable(job.report, [".json"]), (mesh.report.to_json() + "\n").encode())
    row = facts(job, mesh, time.perf_counter() - began) if job.summary else None
    return Outcome(
        job.image,
        () if job.quiet else (in_one_line(row),) if row else (*about(job.image, mesh), *_chosen(job, mesh)),
        (*told, *(mesh.report.warnings if job.report else ())),
        data=None if job.sent is None else _bytes(mesh, job.sent, job.sent_with),
        row=row,
    )


@contextmanager
def _forewarned() -> Iterator[list[str]]:
    """Collect what is told before the work; the progress has shown it by then."""
    told: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        warnings.simplefilter("always", Img2triWarning)
        yield told
    for warning in caught:
        if issubclass(warning.category, Img2triWarning):
            told.append(str(warning.message))
        else:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def view(job: Job, command: str, progress: Progress) -> tuple[Outcome, str]:
    """Mesh an image; return what there is to say about the mesh, and a page about it."""
    from img2tri.mesh_pictures import page_about
    from img2tri.pipeline import mesh_image

    image = opened(job.image, job.options)
    with _forewarned() as told:
        mesh = mesh_image(image, progress=progress, **job.options)
    title = os.path.basename(job.image) if job.image != DASH else STEM
    text = page_about(mesh, meshed_pixels(image, job.options), title=title, command=command)
    return Outcome(job.image, about(job.image, mesh), (*told, *mesh.report.warnings)), text


def about_file(path: str, suffix: str | None) -> list[str]:
    """Say what a file of a mesh holds, plane or solid; or one of the format `suffix` from stdin."""
    if path != DASH:
        return _measured(path, path)
    with named(suffix or "") as place:
        Path(place).write_bytes(from_stdin().data)
        return _measured(path, place)


def _measured(name: str, path: str | Path) -> list[str]:
    from img2tri.mesh import load_mesh
    from img2tri.views.formats.readers.flat_mesh import PLANE_KINDS, NotFlatError

    try:
        return about(name, load_mesh(path))
    except NotFlatError as solid:
        from img2tri.views.formats.readers.solid_quality import solid_table

        found = solid.found
        head, *table = solid_table(found.points, found.cells, found.kind)
        x, y, z = zip(found.points.min(axis=0), found.points.max(axis=0), strict=True)
        places = f"{x[0]:g} <= x <= {x[1]:g}, {y[0]:g} <= y <= {y[1]:g}, {z[0]:g} <= z <= {z[1]:g}"
        what = "surface of a solid" if found.kind in PLANE_KINDS else "solid"
        return [f"{name}: {what}, {head}, {len(set(found.regions.tolist()))} regions, {places}", *table]


def opened(image: str, options: dict[str, Any]) -> str | Source:
    """Return an image by its name, or what is on stdin, which can be read once only."""
    return from_stdin(**_of(options, "max_pixels")) if image == DASH else image


def meshed_pixels(image: str | Source, options: dict[str, Any]) -> Any:
    """Read the part of an image that was meshed."""
    from img2tri.raster.labels.cropping import crop
    from img2tri.raster.metadata.wanted_width import as_wide_as
    from img2tri.raster.reading import read

    whole = read(image, **_of(options, "spacing", "origin", "page", "max_pixels"))
    return crop(as_wide_as(whole, options.get("width")), options.get("crop")).values


def _of(options: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: options[name] for name in names if name in options}


def _bytes(mesh: TriangleMesh, suffix: str, given: dict[str, Any]) -> bytes:
    """Return a mesh as the bytes of a file."""
    with named(suffix) as path:
        mesh.save(path, **_with_arrays(mesh, given))
        return path.read_bytes()


def _with_arrays(mesh: TriangleMesh, given: dict[str, Any]) -> dict[str, Any]:
    """Return the options of saving with arrays in place of the images these are read from."""
    if "data" not in given:
        return given
    return {**given, "data": {name: mesh.sample(image) for name, image in given["data"].items()}}


# ---- what there is to say ----


def about(name: str, mesh: TriangleMesh) -> list[str]:
    """Say what a mesh is, and give the table of its quality."""
    head, _, table = str(mesh.quality()).partition("\n")
    defects = head.partition(", ")[2]
    return [f"{name}: {repr(mesh).partition(': ')[2]}" + (f"; {defects}" if defects else ""), table]


def _chosen(job: Job, mesh: TriangleMesh) -> list[str]:
    """Say what was chosen for the user, and which files there are."""
    from img2tri.recipes.conforming import CONFETTI

    settings = mesh.origin.settings if mesh.origin else {}
    length, threshold = settings["edge_length"], settings["threshold"]
    chosen = f"edge length {length if isinstance(length, str) else f'{length:g}'}"
    levels = threshold if isinstance(threshold, (list, tuple)) else [threshold]
    chosen += "" if threshold is None else f", threshold {', '.join(f'{level:g}' for level in levels)} ({settings['threshold_from']})"
    count = len(mesh.origin.outlines.left) if mesh.origin and "min_area" not in job.options else 0
    chosen += "" if count < CONFETTI else f"; {count:,} outlines, of which --min-area 20px2 would drop specks"
    noted = [f"{'noted':<12}{note}" for note in (mesh.origin.notes if mesh.origin else [])]
    return [f"{'chosen':<12}{chosen}", *noted, *([f"{'saved':<12}{', '.join(job.files)}"] if job.files else [])]
