"""Where the bytes of an image come from: a file by its path, or one that is open already -> a `Source`.

Decoders go back and forth in what they read, and may read it twice, so they get a source to open as often as they like. A file that is
open already may be a pipe, which can be read once; its bytes are held in memory, and no more of them than an image of `max_pixels`
may need, so that a stream without end is refused.
"""

from __future__ import annotations

import io
import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from img2tri.errors import FileError, ImageError, Img2triError, ParameterError, integer

BYTES_PER_PIXEL = 8  # four colours of 16 bit, or one float64, not compressed
HEADROOM = 2**20  # bytes for what is no pixel
PART = 2**20
HOLD_SEVERAL = ("h5", "hdf5", "hdf", "nc", "ilp", "zarr", "npz")  # suffixes of formats that hold several arrays
GZIP = b"\x1f\x8b"  # what a compressed file begins with


class _File(io.BufferedReader):
    """A file that is never asked for more bytes than it has: a damaged length would make room for gigabytes first."""

    def read(self, size: int | None = -1, /) -> bytes:
        """Read `size` bytes, or what there is."""
        if size is None or size < 0:
            return super().read()
        return super().read(min(size, max(0, os.fstat(self.fileno()).st_size - self.tell())))


@dataclass(frozen=True)
class Source:
    """The bytes of an image.

    Attributes
    ----------
    name
        What messages call it; its suffix tells formats that cannot be told by their content.
    path
        The file; None where `data` are the bytes.
    data
        The bytes, where there is no path.
    inner
        The name of an array in the file, for formats that hold several; empty: none is named.
    """

    name: str
    path: Path | None = None
    data: bytes = b""
    inner: str = ""

    def __str__(self) -> str:
        return self.name

    def open(self) -> BinaryIO:
        """Open it anew, at its beginning; a file is not mapped into memory."""
        return _File(self.path.open("rb", buffering=0)) if self.path else io.BytesIO(self.data)

    def start(self, count: int) -> bytes:
        """Return the first `count` bytes, or say why there are none.

        Raises
        ------
        FileError
            If the file is missing, empty, a folder, a pipe or a device, or cannot be opened.
        """
        start = self.data[:count] if self.path is None else _start(self.path, count)
        if not start:
            raise FileError(f"image: {self.name!r} is empty")
        return start


def _start(path: Path, count: int) -> bytes:
    try:
        mode = path.stat().st_mode
        if not stat.S_ISREG(mode):
            # A pipe without a writer would be waited for without end, and none of these can be read twice.
            what = "folder" if stat.S_ISDIR(mode) else "pipe or device"
            raise FileError(f"image: expected a file, found the {what} {str(path)!r}")
        with path.open("rb") as file:
            return file.read(count)
    except Img2triError:
        raise
    except FileNotFoundError as error:
        raise FileError(f"image: there is no file {str(path)!r}") from error
    except (OSError, ValueError) as error:
        raise FileError(f"image: {str(path)!r} cannot be opened ({error})") from error


def is_file(image: object) -> bool:
    """Tell whether an image is a file, by its path or open."""
    return isinstance(image, (str, os.PathLike, Source)) or callable(getattr(image, "read", None))


def _parted(name: str) -> tuple[str, str]:
    """Part the name of a file and of an array in it: ``scan.h5:/raw/labels``.

    Examples
    --------
    >>> _parted("scan.h5:/raw/labels"), _parted("C:/a.png")
    (('scan.h5', '/raw/labels'), ('C:/a.png', ''))
    """
    match = re.fullmatch(rf"(.*\.(?:{'|'.join(HOLD_SEVERAL)}))/?:(/.*)", name, re.DOTALL | re.IGNORECASE)
    return (match[1], match[2]) if match else (name, "")


def source_of(image: Any, *, max_pixels: int = 2**28) -> Source:
    r"""Return where the bytes of a file are; those of an open file are read from where it stands to its end.

    Parameters
    ----------
    image
        A path, which may name an array in the file, as ``scan.h5:/labels`` does; a file opened in binary mode; or a source, which is
        returned as it is.
    max_pixels
        An open file may give 8 bytes for each, and 1 MiB; memory is taken for no more than it gives.

    Raises
    ------
    FileError
        If the file cannot be read.
    ImageError
        If it gives more bytes.
    ParameterError
        If it gives something else than bytes, or `max_pixels` is not a whole number above 0.

    Examples
    --------
    >>> source_of(io.BytesIO(b"P5 1 1 255 \0"))
    Source(name='<file>', path=None, data=b'P5 1 1 255 \x00', inner='')
    """
    if isinstance(image, Source):
        return image
    if isinstance(image, (str, os.PathLike)):
        file, inner = _parted(os.fspath(image))
        return Source(str(Path(file)), Path(file), inner=inner)
    noted = getattr(image, "name", None)
    name = noted if isinstance(noted, str) else "<file>"
    most = BYTES_PER_PIXEL * integer("max_pixels", max_pixels, least=1) + HEADROOM
    held = io.BytesIO()
    while part := _part(image, name):
        held.write(part)
        if held.tell() > most:
            raise ImageError(
                f"image: expected at most {most} bytes, {BYTES_PER_PIXEL} for each of max_pixels={max_pixels}, found more in {name!r}; "
                "raise max_pixels, or give the path of a file"
            )
    return Source(name, data=held.getvalue())


def _part(file: Any, name: str) -> bytes:
    if isinstance(file, io.TextIOBase):
        raise ParameterError(f"image: expected a file opened in binary mode, as by open(path, 'rb'), found {name!r} opened as text")
    try:
        part = file.read(PART)
    except Exception as error:
        # Files of all kinds, such as members of an archive, with errors of their own.
        raise FileError(f"image: {name!r} cannot be read ({error})") from error
    if part is not None and not isinstance(part, bytes):
        given = type(part).__name__
        raise ParameterError(f"image: expected a file opened in binary mode, found a {type(file).__name__} that gives {given}")
    return part or b""
