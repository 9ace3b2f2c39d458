"""The command line: ``img2tri mesh``, ``view-report`` and ``quality``. All that is printed is printed here.

Options go to `img2tri.mesh_image` under the names it knows, and only if they were given, so its defaults and its checks are the only
ones. Whatever is not as it must be becomes one line on stderr and exit status 2; one bad file does not stop the others. Nothing heavy is
imported before there is work for it, so that ``--help`` answers at once.
"""

from __future__ import annotations

import io
import os
import re
import shlex
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from img2tri.errors import FileError, Img2triError, ParameterError, finite
from img2tri.options import MESH_OPTIONS, parse

if TYPE_CHECKING:
    from rich.progress import Progress

    from img2tri.mesh import TriangleMesh

DONE, BAD, INTERRUPTED = 0, 2, 130
PATIENCE = 0.5  # seconds; shorter work is over before a progress bar could be read


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv
        The arguments; None takes those of the process.

    Returns
    -------
    int
        0; 2 where a file or an option is not as it must be; 130 after Ctrl-C.

    Raises
    ------
    SystemExit
        With status 0 for --help and --version, 2 for options that cannot be understood.
    """
    typed = sys.argv[1:] if argv is None else argv
    arguments = parse(typed)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # the name of a file may hold what the terminal cannot show
    try:
        if arguments.command == "view-report":
            return _view_report(arguments, typed)
        return (_mesh if arguments.command == "mesh" else _quality)(arguments)
    except Img2triError as error:
        return _complain(error)
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output has left; what is still to be flushed when Python ends goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE


@dataclass(frozen=True)
class _Job:
    """One image, and the files to be made of it."""

    image: str
    meshes: list[str]
    plot: str | None
    report: str | None


def _mesh(arguments: Namespace) -> int:
    """Run ``img2tri mesh``. The names of all files are checked before the first image is read."""
    if arguments.height is not None:
        finite("height", arguments.height, above=0)
    jobs = _jobs(arguments)
    shown = sys.stderr.isatty() and not arguments.quiet
    status = DONE
    for number, job in enumerate(jobs):
        place = f"{job.image}: " if len(jobs) > 1 else ""
        try:
            with _Bar(place, number / len(jobs), 1 / len(jobs), shown=shown) as bar:
                mesh = _made(job, arguments, bar)
            _tell_mesh(job, mesh, arguments.quiet)
        except (Img2triError, MemoryError) as error:
            status = _complain(error, place)
    if not (arguments.outputs or arguments.plot or arguments.report):
        print("img2tri: no file was asked for, none was written; -o mesh.stl writes one", file=sys.stderr)
    return status


def _made(job: _Job, arguments: Namespace, progress: Callable[[str, float], None]) -> TriangleMesh:
    """Mesh one image and write its files."""
    from img2tri.pipeline import mesh_image
    from img2tri.views.storing import store, writable

    options = _mesh_options(arguments)
    mesh = mesh_image(job.image, progress=progress, **options)
    for path in job.meshes:
        mesh.save(path, height=arguments.height)
    if job.plot:
        mesh.plot(_pixels(job.image, options), job.plot, colour_by=None if arguments.colour_by == "none" else arguments.colour_by)
    if job.report:
        store(writable(job.report, [".json"]), (mesh.report.to_json() + "\n").encode())
    return mesh


def _mesh_options(arguments: Namespace) -> dict[str, Any]:
    """Collect the options that go on to mesh_image, if they were given."""
    return {name: getattr(arguments, name) for name in MESH_OPTIONS if name in arguments}


def _pixels(image: str, options: dict[str, Any]) -> Any:
    """Read the part of an image that was meshed."""
    from img2tri.raster.cropping import crop
    from img2tri.raster.reading import read

    place = {name: options[name] for name in ("spacing", "origin", "page", "max_pixels") if name in options}
    return crop(read(image, **place), options.get("crop")).values


def _view_report(arguments: Namespace, typed: Sequence[str]) -> int:
    """Run ``img2tri view-report``."""
    from img2tri.pipeline import mesh_image
    from img2tri.triangles.quality import measure
    from img2tri.views.page import page
    from img2tri.views.storing import store, writable

    target, options = writable(arguments.output, [".html"]), _mesh_options(arguments)
    with _Bar("", 0.0, 1.0, shown=sys.stderr.isatty() and not arguments.quiet) as bar:
        mesh = mesh_image(arguments.image, progress=bar, **options)
    text = page(
        mesh.vertices,
        mesh.triangles,
        **measure(mesh.vertices, mesh.triangles, ["q", "min_angle"]),
        frame=mesh.frame,
        report=mesh.report.to_json(),
        regions=mesh.regions,
        image=_pixels(arguments.image, options),
        names=mesh.names,
        title=os.path.basename(arguments.image),
        command=shlex.join(["img2tri", *typed]),
        unit="",
    )
    store(target, text.encode())
    if not arguments.quiet:
        _tell(arguments.image, mesh)
        print(f"{'saved':<12}{arguments.output}")
    return DONE


def _jobs(arguments: Namespace) -> list[_Job]:
    """Name the files of every image; see that each can be written, and that none is there twice or an image itself."""
    from img2tri.views import export, files, vectors
    from img2tri.views.storing import writable

    formats = {**files.FORMATS, **export.EXPORTS, **vectors.FORMATS}
    wanted: list[tuple[str, str, Collection[str]]] = [("-o", name, formats) for name in arguments.outputs]
    if arguments.plot:
        from img2tri.views.figure import SUFFIXES

        wanted.append(("--plot", arguments.plot, SUFFIXES))
    if arguments.report:
        wanted.append(("--report", arguments.report, (".json",)))
    owners = {os.path.realpath(image): image for image in arguments.images}
    jobs = []
    for image in arguments.images:
        names: dict[str, list[str]] = {"-o": [], "--plot": [], "--report": []}
        for option, name, suffixes in wanted:
            path = _named(name, option, image, len(arguments.images))
            target = os.fspath(writable(path, suffixes))
            if target in owners:
                raise FileError(f"{option}: expected a file of its own, found {path!r}, which is in use for {owners[target]!r}")
            owners[target] = image
            names[option].append(path)
        jobs.append(_Job(image, names["-o"], *(names[option][0] if names[option] else None for option in ("--plot", "--report"))))
    return jobs


def _named(name: str, option: str, image: str, images: int) -> str:
    """Return the name of a file for an image: ``{stem}`` in it is the image's name without folder and suffix."""
    if images > 1 and "{stem}" not in name:
        folder, suffix = os.path.dirname(name), os.path.splitext(name)[1]
        example = os.path.join(folder, "{stem}" + suffix)
        raise ParameterError(f"{option}: expected a name with {{stem}} for {images} images, found {name!r}; for example {example!r}")
    return name.replace("{stem}", os.path.splitext(os.path.basename(image))[0])


# ---- judging ----


def _quality(arguments: Namespace) -> int:
    """Run ``img2tri quality``."""
    from img2tri.mesh import TriangleMesh
    from img2tri.views.files import load

    status = DONE
    for path in arguments.meshes:
        try:
            _tell(path, TriangleMesh(*load(path)))
        except (Img2triError, MemoryError) as error:
            status = _complain(error)
    return status


# ---- telling ----


def _tell(name: str, mesh: TriangleMesh) -> None:
    """Print what a mesh is, and the table of its quality."""
    head, _, table = str(mesh.quality()).partition("\n")
    defects = head.partition(", ")[2]
    print(f"{name}: {repr(mesh).partition(': ')[2]}" + (f"; {defects}" if defects else ""))
    print(table)


def _tell_mesh(job: _Job, mesh: TriangleMesh, quiet: bool) -> None:
    """Print what came of an image, what was chosen for the user, and which promises are not kept if there is a report on it."""
    if not quiet:
        _tell(job.image, mesh)
        settings = mesh.origin.settings if mesh.origin else {}
        length, threshold = settings["edge_length"], settings["threshold"]
        chosen = f"edge length {length if isinstance(length, str) else f'{length:g}'}"
        chosen += "" if threshold is None else f", threshold {threshold:g} ({settings['threshold_from']})"
        print(f"{'chosen':<12}{chosen}")
        files = [*job.meshes, *filter(None, (job.plot, job.report))]
        if files:
            print(f"{'saved':<12}{', '.join(files)}")
    for warning in mesh.report.warnings if job.report else ():
        print(f"img2tri: warning: {job.image}: {warning}", file=sys.stderr)


def _complain(error: BaseException, place: str = "") -> int:
    """Print an error as one line, and return the exit status it means."""
    text = "expected more memory than there is" if isinstance(error, MemoryError) else _with_options(str(error))
    print(f"img2tri: {place}{' '.join(text.split())}", file=sys.stderr)
    return BAD


def _with_options(message: str) -> str:
    """Name parameters the way they are typed here.

    Examples
    --------
    >>> _with_options("edge_length: expected a number above 0, found -1")
    '--edge-length: expected a number above 0, found -1'
    >>> _with_options("labels: expected values other than the background, found 0; give background=None to mesh it too")
    '--labels: expected values other than the background, found 0; give --background none to mesh it too'
    """
    names = "|".join((*MESH_OPTIONS, "height"))
    # Either the name a message begins with, or a name with a value somewhere in it.
    pattern = rf"^({names})(?=:)|\b({names})=(True|None|[\d.]+|)"

    def option(match: re.Match[str]) -> str:
        value = {None: "", "": "", "True": "", "None": " none"}.get(match[3], f" {match[3]}")
        return "--" + (match[1] or match[2]).replace("_", "-") + value

    return re.sub(pattern, option, message)


class _Bar:
    """A progress bar on stderr, once the work has taken a while; nothing where stderr is no terminal."""

    def __init__(self, place: str, start: float, share: float, *, shown: bool) -> None:
        self.place, self.start, self.share, self.shown = place, start, share, shown
        self.began = time.monotonic()
        self.progress: Progress | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.progress is not None:
            self.progress.stop()

    def __call__(self, stage: str, fraction: float) -> None:
        """Show a stage and how much of all the work is done."""
        if not self.shown or time.monotonic() - self.began < PATIENCE:
            return
        if self.progress is None:
            from rich.console import Console
            from rich.progress import Progress

            # Gone when done, and no way for what is printed meanwhile: stdout may be a file.
            self.progress = Progress(console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False)
            self.progress.start()
            self.progress.add_task("", total=1.0)
        from rich.markup import escape

        task = self.progress.task_ids[0]
        self.progress.update(task, description=escape(self.place + stage), completed=self.start + self.share * fraction)
