"""stdin and stdout as files, which are called ``-`` on the command line.

Images come in and meshes go out as bytes; text goes to stderr meanwhile. A terminal is neither: nobody types an image, and a binary file
would upset it. What can be written or read only by the name of a file has one for a moment, in a folder that is gone afterwards.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from img2tri.errors import FileError, Img2triError

if TYPE_CHECKING:
    from img2tri.raster.files.byte_sources import Source

DASH = "-"
STEM = "stdin"  # takes the place of a name
TEXTS = (".obj", ".off", ".msh", ".inp", ".bdf", ".svg", ".dxf", ".geojson", ".html")  # what a terminal can show


def check_stdin() -> None:
    """See that there can be bytes on stdin."""
    if sys.stdin is None or sys.stdin.closed:
        raise FileError("-: expected bytes on stdin, found it closed")
    if sys.stdin.isatty():
        raise FileError("-: expected bytes on stdin, found a terminal; send a file there, as in  img2tri mesh - < image.png")


def from_stdin(**given: Any) -> Source:
    """Hold the bytes of stdin, as an image or a mesh to be read; `given` may have `max_pixels`, which limits them."""
    from img2tri.raster.files.byte_sources import source_of

    check_stdin()
    return source_of(sys.stdin.buffer, **given)


def check_stdout(suffix: str) -> None:
    """See that a file can go to stdout."""
    if sys.stdout is None or sys.stdout.closed:
        raise FileError("-o -: expected a file or a pipe on stdout, found it closed")
    if sys.stdout.isatty() and suffix not in TEXTS:
        raise FileError(f"-o -: expected a file or a pipe on stdout, found a terminal; send it on, as in  img2tri ... -o - > mesh{suffix}")


def to_stdout(data: bytes) -> None:
    """Write bytes to stdout."""
    try:
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        raise
    except OSError as problem:
        abandon_stdout()
        raise FileError(f"stdout: cannot be written: {problem.strerror or problem}") from problem


def abandon_stdout() -> None:
    """Let what is still to be flushed when Python ends go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def named(suffix: str) -> Iterator[Path]:
    """Lend the name of a file that is not there yet; errors call it ``-``."""
    try:
        folder = TemporaryDirectory(prefix="img2tri-")
    except OSError as problem:
        raise FileError(f"-: cannot be held for a moment: {problem.strerror or problem}; TMPDIR names another folder") from problem
    with folder:
        path = Path(os.path.realpath(folder.name), STEM + suffix)
        try:
            yield path
        except Img2triError as error:
            raise type(error)(str(error).replace(str(path), DASH)) from error
