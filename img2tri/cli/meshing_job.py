"""Doing a job: an image is meshed and its files are written -> an outcome, with all there is to say about it.

Nothing is printed here, since this may be another process than the one that has the terminal. What a user can cause ends in the outcome;
what is a mistake of ours is raised.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from img2tri.cli.job import Job, Outcome
from img2tri.cli.stdin_stdout import DASH, STEM, from_stdin, named
from img2tri.errors import Img2triError, Img2triWarning

if TYPE_CHECKING:
    from img2tri.mesh import TriangleMesh
    from img2tri.raster.files.byte_sources import Source

Progress = Callable[[str, float], None]


def make(job: Job, progress: Progress) -> Outcome:
    """Mesh an image and write its files."""
    try:
        return _made(job, progress)
    except (Img2triError, MemoryError) as error:
        return Outcome(job.image, problem=problem(error))


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

    image = job.source or opened(job.image, job.options)
    with _forewarned() as told:
        mesh = mesh_image(image, progress=progress, **job.options)
    for path, given in job.meshes:
        mesh.save(path, **given)
    if job.plot:
        mesh.plot(meshed_pixels(image, job.options), job.plot, colour_by=job.colour_by)
    if job.report:
        store(writable(job.report, [".json"]), (mesh.report.to_json() + "\n").encode())
    return Outcome(
        job.image,
        () if job.quiet else (*about(job.image, mesh), *_chosen(job, mesh)),
        (*told, *(mesh.report.warnings if job.report else ())),
        data=None if job.sent is None else _bytes(mesh, job.sent, job.sent_with),
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


def mesh_of(path: str, suffix: str | None) -> TriangleMesh:
    """Load a mesh, or one of the format `suffix` from stdin."""
    from img2tri.mesh import TriangleMesh
    from img2tri.views.formats.save_load import load

    if path != DASH:
        return TriangleMesh(*load(path))
    with named(suffix or "") as place:
        Path(place).write_bytes(from_stdin().data)
        return TriangleMesh(*load(place))


def opened(image: str, options: dict[str, Any]) -> str | Source:
    """Return an image by its name, or what is on stdin, which can be read once only."""
    return from_stdin(**_of(options, "max_pixels")) if image == DASH else image


def meshed_pixels(image: str | Source, options: dict[str, Any]) -> Any:
    """Read the part of an image that was meshed."""
    from img2tri.raster.labels.cropping import crop
    from img2tri.raster.reading import read

    return crop(read(image, **_of(options, "spacing", "origin", "page", "max_pixels")), options.get("crop")).values


def _of(options: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: options[name] for name in names if name in options}


def _bytes(mesh: TriangleMesh, suffix: str, given: dict[str, Any]) -> bytes:
    """Return a mesh as the bytes of a file."""
    with named(suffix) as path:
        mesh.save(path, **given)
        return path.read_bytes()


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
    noted = [f"{'noted':<12}{note}" for note in mesh.report.notes]
    return [f"{'chosen':<12}{chosen}", *noted, *([f"{'saved':<12}{', '.join(job.files)}"] if job.files else [])]
