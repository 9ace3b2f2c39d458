"""Files that are whole or not there: written beside their places, and then put there."""

from __future__ import annotations

import os
import secrets
from contextlib import suppress
from pathlib import Path

from img2tri.errors import FileError


def write(path: Path, data: bytes) -> None:
    """Write a file beside its place, and then put it there."""
    temporary = path.with_name(f".{path.name}-{secrets.token_hex(6)}")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as problem:
        raise FileError(f"{path}: cannot be written: {problem.strerror or problem}; what is done stays, run it again then") from problem
    finally:
        with suppress(OSError):
            temporary.unlink()
