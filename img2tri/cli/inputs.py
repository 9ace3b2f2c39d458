"""Images as typed -> names of images: folders become the images in them, patterns that no shell expanded the names they match."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from img2tri.cli.stdin_stdout import DASH
from img2tri.errors import FileError

STORES = (".zarr", ".ome.zarr")  # folders that are one image
IMAGE_SUFFIXES = (
    *(".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".gif", ".webp", ".pgm", ".ppm", ".pbm", ".pnm", ".jp2", ".tga", ".ico", ".avif"),
    *(".dcm", ".nii", ".nii.gz", ".npy", ".npz", ".nrrd", ".nhdr", ".mha", ".mhd"),
)


def expanded(typed: Sequence[str]) -> list[str]:
    """Return the names of images, in the order typed; those of a folder or pattern sorted, with numbers in order of size.

    Raises
    ------
    FileError
        If a pattern matches nothing, or a folder has no image.
    """
    return [name for text in typed for name in _names(text)]


def _names(text: str) -> list[str]:
    if text == DASH or os.path.isfile(text):
        return [text]
    if os.path.isdir(text) and not text.rstrip(os.sep).lower().endswith(STORES):
        found = sorted((str(path) for path in Path(text).iterdir() if _is_image(path)), key=by_number)
        if not found:
            raise FileError(f"{text!r} is a folder without images; expected files that end in {', '.join(IMAGE_SUFFIXES[:4])} and others")
        return found
    if glob.has_magic(text) and not os.path.exists(text):
        found = sorted(glob.glob(text, recursive=True), key=by_number)
        if not found:
            raise FileError(f"image: expected files that match {text!r}, found none")
        return found
    return [text]


def _is_image(path: Path) -> bool:
    name = path.name.lower()
    return not name.startswith(".") and ((path.is_file() and name.endswith(IMAGE_SUFFIXES)) or (path.is_dir() and name.endswith(STORES)))


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Sort names as people count: slice9 before slice10.

    Examples
    --------
    >>> sorted(["slice10.png", "slice9.png"], key=by_number)
    ['slice9.png', 'slice10.png']
    """
    return list(_parts(name))


def _parts(name: str) -> Iterator[tuple[int, int, str]]:
    for part in re.split(r"(\d+)", name):
        yield (0, int(part), part) if part.isdigit() and part.isascii() else (1, 0, part)
