"""Which files are made of which image: arguments -> jobs, one for each image.

All names are checked here, before the first image is read: whether each can be written, and that none is meant for two images, or is an
image itself. A job holds all there is to know to do it, so that another process can.
"""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

from img2tri.cli.job import Job
from img2tri.cli.save_arguments import of_image, save_options
from img2tri.cli.stdin_stdout import DASH, STEM, check_stdin, check_stdout
from img2tri.errors import FileError, ParameterError
from img2tri.options import OPTIONS
from img2tri.options.all_options import load_options
from img2tri.raster.files.image_names import images_named

USUAL_FORMAT = ".ply"  # keeps all digits and the regions, and is read everywhere
SEVERAL_FILES = (".xdmf",)
LETTERS_ALIKE = ("darwin", "win32")  # where names in large and small letters are one


def images_typed(names: Sequence[str]) -> list[str]:
    """Return the names of images, in the order typed: a folder is its images, a pattern that no shell expanded what it matches."""
    return [image for name in names for image in ([name] if name == DASH else images_named(name))]


def mesh_options(arguments: Namespace) -> dict[str, Any]:
    """Collect the options that go on to mesh_image: those of a report, if one was named, and those that were typed, which win."""
    again = {} if arguments.options is None else load_options(arguments.options)
    return again | {name: getattr(arguments, name) for name in OPTIONS if name in arguments}


@contextmanager
def folders(arguments: Namespace) -> Iterator[None]:
    """Make the folders for the results if they are not there: that of --out-dir, and those of names with ``{stem}``.

    Folders that stay empty go again.
    """
    wanted = {} if arguments.out_dir is None else {arguments.out_dir: "--out-dir"}
    named = [("-o", name) for name in arguments.outputs] + [("--plot", arguments.plot), ("--report", arguments.report)]
    wanted |= {os.path.dirname(name): flag for flag, name in named if name and "{stem}" in os.path.basename(name) and os.path.dirname(name)}
    with ExitStack() as stack:
        for path, flag in wanted.items():
            stack.enter_context(_folder(path, flag))
        yield


@contextmanager
def _folder(path: str, flag: str) -> Iterator[None]:
    made = False
    try:
        os.mkdir(path)
        made = True
    except FileExistsError:
        pass  # if it is no folder, the first name in it says so
    except (OSError, ValueError) as problem:
        text = getattr(problem, "strerror", None) or problem
        raise FileError(f"{flag}: expected a folder, or the name of one to be made, found {path!r}: {text}") from problem
    try:
        yield
    finally:
        if made:
            with suppress(OSError):
                os.rmdir(path)  # refused unless empty


def jobs_of(arguments: Namespace, images: Sequence[str]) -> list[Job]:
    """Name the files of every image; see that each can be written, and that none is there twice or an image itself."""
    from img2tri.views.formats import save_load as files
    from img2tri.views.formats import svg_dxf_geojson as vectors
    from img2tri.views.formats.atomic_write import writable
    from img2tri.views.formats.solvers import save_for_solvers as export

    if DASH in images:
        _check_stdin(images.count(DASH))
    known = {**files.SURFACE_FORMATS, **export.EXPORTS, **vectors.DRAWING_FORMATS}
    formats = _formats(arguments, known)
    sent, wanted = _sent(arguments, formats, len(images)), _wanted(arguments, known, formats)
    meshes = {_ending(name) for option, _, name, _ in wanted if option in ("-o", "--out-dir")} | ({sent} if sent else set())
    saved_with, options = save_options(arguments, sorted(meshes)), mesh_options(arguments)
    owners = {_same(os.path.realpath(image)): image for image in images if image != DASH}
    jobs = []
    for image in images:
        names: dict[str, list[str]] = {option: [] for option in ("-o", "--out-dir", "--plot", "--report")}
        for option, where, name, suffixes in wanted:
            path = os.path.join(where, _named(name, option, image, len(images)))
            for place in map(_same, _with_companions(os.fspath(writable(path, suffixes)))):
                if place in owners:
                    raise FileError(f"{option}: expected a file of its own, found {path!r}, which is in use for {owners[place]!r}")
                owners[place] = image
            names[option].append(path)
        mine = {suffix: of_image(given, stem(image)) for suffix, given in saved_with.items()}
        job = Job(
            image, options, meshes=tuple((path, mine[_ending(path)]) for path in (*names["-o"], *names["--out-dir"])),
            plot=next(iter(names["--plot"]), None), colour_by=None if arguments.colour_by == "none" else arguments.colour_by,
            report=next(iter(names["--report"]), None), sent=sent, sent_with=mine[sent] if sent else {}, quiet=arguments.quiet,
        )  # fmt: skip
        jobs.append(job)
    return jobs


def _ending(name: str) -> str:
    return os.path.splitext(name)[1].lower()


def _formats(arguments: Namespace, known: Collection[str]) -> list[str]:
    """Return the suffixes that --format names."""
    suffixes = list(map(_suffix, arguments.formats))
    for name, suffix in zip(arguments.formats, suffixes, strict=True):
        if suffix not in known:
            raise ParameterError(f"--format: expected one of {', '.join(sorted(s[1:] for s in known))}, found {name!r}")
    if suffixes and arguments.out_dir is None and DASH not in arguments.outputs:
        raise ParameterError("--format: expected with --out-dir or -o -, found neither; other names have the format as their suffix")
    return list(dict.fromkeys(suffixes))


def _sent(arguments: Namespace, suffixes: list[str], images: int) -> str | None:
    """Return the suffix of the mesh that goes to stdout, if one does."""
    count = arguments.outputs.count(DASH)
    if not count:
        return None
    if count > 1 or images > 1:
        found = f"{count} times" if count > 1 else f"{images} images"
        raise ParameterError(f"-o -: expected once, and with one image, found {found}; for several, --out-dir names a folder")
    if len(suffixes) != 1:
        found = ", ".join(suffix[1:] for suffix in suffixes) or "none"
        raise ParameterError(f"--format: expected one with -o -, as in --format stl, found {found}")
    if suffixes[0] in SEVERAL_FILES:
        raise ParameterError(f"-o -: expected a format of one file, found {suffixes[0][1:]}, which is several; give it a name")
    check_stdout(suffixes[0])
    return suffixes[0]


def _wanted(arguments: Namespace, known: Collection[str], formats: list[str]) -> list[tuple[str, str, str, Collection[str]]]:
    """List the files wanted for each image: the option, folder and name as typed, and the suffixes the name may have."""
    wanted: list[tuple[str, str, str, Collection[str]]] = [("-o", "", name, known) for name in arguments.outputs if name != DASH]
    if arguments.out_dir is not None:
        wanted += [("--out-dir", arguments.out_dir, "{stem}" + suffix, known) for suffix in formats or [USUAL_FORMAT]]
    if arguments.plot:
        from img2tri.views.figures.plot import SUFFIXES

        wanted.append(("--plot", "", arguments.plot, SUFFIXES))
    if arguments.report:
        wanted.append(("--report", "", arguments.report, (".json",)))
    return wanted


def stem(image: str) -> str:
    """Return the name of an image without folder and suffix."""
    return STEM if image == DASH else os.path.splitext(os.path.basename(image))[0]


def _named(name: str, option: str, image: str, images: int) -> str:
    """Return the name of a file for an image, with its stem in place of ``{stem}``."""
    if images > 1 and "{stem}" not in name:
        where, suffix = os.path.dirname(name), os.path.splitext(name)[1]
        example = os.path.join(where, "{stem}" + suffix)
        raise ParameterError(f"{option}: expected a name with {{stem}} for {images} images, found {name!r}; for example {example!r}")
    return name.replace("{stem}", stem(image))


def suffix_of_stdin(arguments: Namespace) -> str | None:
    """Return the suffix of a mesh on stdin, if ``img2tri quality`` is to read one."""
    count = arguments.meshes.count(DASH)
    if bool(count) != (arguments.format is not None):
        raise ParameterError(f"--format: expected with a mesh on stdin, and with nothing else, found {arguments.format or 'none'}")
    if count:
        _check_stdin(count)
    return None if arguments.format is None else _suffix(arguments.format)


def _check_stdin(count: int) -> None:
    if count > 1:
        raise ParameterError(f"-: expected once, as stdin is read once, found {count} times")
    check_stdin()


def _suffix(name: str) -> str:
    return "." + name.lower().removeprefix(".")


def _with_companions(path: str) -> list[str]:
    """Return the name of a file, and those of the files that may be written beside it."""
    from img2tri.views.formats.solvers.xdmf import ENDS_FILE, FACETS_FILE

    name, suffix = os.path.splitext(path)
    return [name + ending + suffix for ending in (("", FACETS_FILE, ENDS_FILE) if suffix.lower() in SEVERAL_FILES else ("",))]


def _same(path: str) -> str:
    return path.casefold() if sys.platform in LETTERS_ALIKE else path
