"""Names as a user gives them -> names of images: folders become the images in them, patterns that no shell expanded what they match."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Iterator
from pathlib import Path

from img2tri.errors import FileError

STORES = (".zarr",)  # folders that are one image, or a group of them
IMAGE_SUFFIXES = (
    *(".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".gif", ".webp", ".pgm", ".ppm", ".pbm", ".pnm", ".jp2", ".tga", ".ico", ".avif"),
    *(".dcm", ".nii", ".nii.gz", ".npy", ".npz", ".nrrd", ".nhdr", ".mha", ".mhd"),
)


def images_named(name: str) -> list[str]:
    """Return the names of the images that a name stands for; those of a folder or pattern sorted, with numbers in order of size.

    Raises
    ------
    FileError
        If a pattern matches nothing, or a folder has no image.
    """
    if os.path.isfile(name):
        return [name]
    if os.path.isdir(name) and not name.rstrip(os.sep).lower().endswith(STORES):
        found = sorted((str(path) for path in Path(name).iterdir() if _is_image(path)), key=by_number)
        if not found:
            raise FileError(f"{name!r} is a folder without images; expected files that end in {', '.join(IMAGE_SUFFIXES[:4])} and others")
        return found
    if glob.has_magic(name) and not os.path.exists(name):
        found = sorted(glob.glob(name, recursive=True), key=by_number)
        if not found:
            raise FileError(f"image: expected files that match {name!r}, found none")
        return found
    return [name]


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
