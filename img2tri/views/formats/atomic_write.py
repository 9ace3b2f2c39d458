"""A file is whole or it is not there: bytes -> a file, checked before the work and put in place after it.

The bytes go to a new file beside the target, which then takes the target's name in one step. Whatever goes wrong before that step leaves an
older file as it was, and nothing beside it. Where the system knows files without a name (Linux), the new one has none until it is whole, so
that not even a process that is killed leaves one.
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import IO

from img2tri.errors import FileError, shown


def writable(path: str | os.PathLike[str], suffixes: Collection[str]) -> Path:
    """Return the place a file is to be written to, links followed, or say why it cannot be.

    Meant to be called before the work whose result is to be written.

    Parameters
    ----------
    path
        Where to write. Its suffix, in capitals or not, names the format.
    suffixes
        The known suffixes, such as ".stl".

    Raises
    ------
    FileError
        If the suffix is not known, the folder is missing or not writable, or `path` is something else than a writable file.

    Examples
    --------
    >>> writable("femur.docx", [".ply", ".stl"])
    Traceback (most recent call last):
    ...
    img2tri.errors.FileError: femur.docx: expected a name that ends in .ply or .stl, found '.docx'
    """
    known_suffix(path, suffixes)
    try:
        target = Path(os.path.realpath(path))
        with suppress(FileNotFoundError, NotADirectoryError):
            os.stat(target)
    except (OSError, ValueError) as problem:
        # A name too long or with a zero byte in it, or a link to itself.
        raise FileError(f"{shown(os.fspath(path))}: cannot be written: {getattr(problem, 'strerror', None) or problem}") from problem
    if not target.parent.is_dir():
        raise FileError(f"{path}: expected an existing folder, found none at {target.parent}; make it first")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise FileError(f"{path}: expected a folder one may write to, found {target.parent}, where this is not allowed")
    if target.exists() and not target.is_file():
        raise FileError(f"{path}: expected a file or a new name, found {'a folder' if target.is_dir() else 'a device'} of that name")
    if target.exists() and not os.access(target, os.W_OK):
        raise FileError(f"{path}: expected a file one may write to, found one that is read-only")
    return target


def known_suffix(path: str | os.PathLike[str], suffixes: Collection[str]) -> str:
    """Return the suffix of `path` in small letters, or list the known ones."""
    suffix = Path(path).suffix.lower()
    if suffix not in suffixes:
        *most, last = sorted(suffixes)
        expected = f"{', '.join(most)} or {last}" if most else last
        raise FileError(f"{os.fspath(path)}: expected a name that ends in {expected}, found {suffix or 'no suffix'!r}")
    return suffix


def store(target: Path, data: bytes, *, advice: str = "") -> None:
    """Write `data` to `target`, which must be no link; an older file is replaced in one step, and keeps its permissions.

    Raises
    ------
    FileError
        If the system refuses, for want of space or otherwise; it ends with the `advice`.
    """
    temporary = target.with_name(f".img2tri-{secrets.token_hex(8)}.tmp")
    try:
        nameless = _nameless(target.parent)
        with nameless or open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
            if nameless:
                # os.link follows the link that stands for the open file only where a folder is named.
                os.link(f"/proc/self/fd/{file.fileno()}", temporary, src_dir_fd=file.fileno())
        if target.exists():
            shutil.copymode(target, temporary)
        os.replace(temporary, target)
    except OSError as problem:
        raise FileError(f"{target}: cannot be written: {problem.strerror or problem}{advice}") from problem
    finally:
        # After the last step above there is nothing left to remove.
        with suppress(OSError):
            temporary.unlink()


def _nameless(folder: Path) -> IO[bytes] | None:
    """Open a file without a name in `folder`; None where there is no such thing."""
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):
        with suppress(OSError):
            return os.fdopen(os.open(folder, os.O_TMPFILE | os.O_WRONLY, 0o666), "wb")
    return None
