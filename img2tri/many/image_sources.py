"""What a user has -> images with their names, one at a time.

A path is an image; a folder is the images in it; a pattern is the files it matches; a file or an array with several pages or planes is a
stack, each an image of its own at its height; a zarr group is the arrays in it. Nothing is read before its turn comes.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from img2tri.errors import ImageError, Img2triError, ParameterError, shown
from img2tri.raster.files.decoded_image import NoSuchPageError
from img2tri.raster.files.image_names import images_named

Named = tuple[str, Any]
WITH_PAGES = (".tif", ".tiff", ".nii", ".nii.gz", ".gif", ".webp", ".dcm", ".nrrd", ".nhdr", ".mha", ".mhd", ".npy", ".npz")
BEYOND = 2**31 - 1  # a page no file has
CHANNELS = (3, 4)  # of the last axis of one image in colours


@dataclass(frozen=True)
class OneImage:
    """An image of many.

    Attributes
    ----------
    name
        Its path, or that of its stack and its number, or its number.
    image
        What `mesh_image` takes.
    options
        The options that are its own: `page`.
    z
        The height of its plane; None: what the image says, or 0.
    """

    name: str
    image: Any
    options: dict[str, Any] = field(default_factory=dict)
    z: float | None = None


def each_image(images: Any, *, step: float | None = None, page: int | None = None) -> Iterator[OneImage]:
    """Yield the images one by one.

    Parameters
    ----------
    images
        A path, a pattern, a folder; an array (n, h, w), or (n, h, w, 3 or 4) with colours; a zarr group or array, a dask array; a mapping
        or an iterable of any of these.
    step
        Distance from plane to plane of a stack, in world units; None puts all at 0.
    page
        Take this one of the pages of a file; None: all.

    Examples
    --------
    >>> import numpy as np
    >>> [(one.name, one.image.shape, one.z) for one in each_image(np.zeros((2, 4, 5)), step=0.5)]
    [('0', (4, 5), 0.0), ('1', (4, 5), 0.5)]
    """
    if isinstance(images, (str, os.PathLike)):
        for path in images_named(os.fspath(images)):
            yield from _pages(path, step, page)
    elif hasattr(images, "ndim") and hasattr(images, "shape"):
        yield from _planes("", images, step)
    elif isinstance(images, Mapping) or (hasattr(images, "arrays") and hasattr(images, "groups")):
        for name, entry in images.items() if isinstance(images, Mapping) else images.arrays():
            yield from _one_or_planes(str(name), entry, step, page)
    elif isinstance(images, Iterable):
        for number, entry in enumerate(images):
            yield from _one_or_planes(None if isinstance(entry, (str, os.PathLike)) else str(number), entry, step, page)
    else:
        raise ParameterError(f"images: expected paths, arrays, a stack or a group of them, found {shown(images)}")


def _one_or_planes(name: str | None, entry: Any, step: float | None, page: int | None) -> Iterator[OneImage]:
    if isinstance(entry, (str, os.PathLike)):
        for path in images_named(os.fspath(entry)):
            for one in _pages(path, step, page):
                yield one if name is None else OneImage(one.name.replace(path, name), one.image, one.options, one.z)
    elif getattr(entry, "ndim", 2) > 2 and not _is_one(entry.shape):
        yield from _planes(f"{name}/", entry, step)
    else:
        yield OneImage(name or "", entry)


def _pages(path: str, step: float | None, page: int | None) -> Iterator[OneImage]:
    count = 1 if page is not None else _page_count(path)
    if count == 1:
        yield OneImage(path, path, {} if page is None else {"page": page})
        return
    heights = _heights(path, count, step)
    for number in range(count):
        yield OneImage(f"{path}[{number}]", path, {"page": number}, None if heights is None else heights[number])


def _heights(path: str, count: int, step: float | None) -> list[float] | None:
    """Return at which heights the pages of a file lie: as said, or as a DICOM file says."""
    if step is not None:
        return [number * step for number in range(count)]
    if not path.lower().endswith(".dcm"):
        return None
    from img2tri.raster.files.dicom import frame_heights

    found = frame_heights(path)
    return found if found is not None and len(found) == count else None


def _planes(prefix: str, stack: Any, step: float | None) -> Iterator[OneImage]:
    if _is_one(stack.shape):
        yield OneImage(prefix.rstrip("/") or "0", stack)
        return
    if stack.ndim not in (3, 4) or (stack.ndim == 4 and stack.shape[3] not in CHANNELS):
        raise ImageError(f"images: expected a stack (n, h, w) or (n, h, w, 3 or 4), found shape {tuple(stack.shape)}")
    for number in range(stack.shape[0]):
        yield OneImage(f"{prefix}{number}", stack[number], {}, None if step is None else number * step)


def _is_one(shape: tuple[int, ...]) -> bool:
    """Whether an array is one image: (h, w), or (h, w, 3 or 4)."""
    return len(shape) == 2 or (len(shape) == 3 and shape[2] in CHANNELS)


def _page_count(path: str) -> int:
    """Return how many pages a file has: asked for one beyond all, a decoder says so before it reads any.

    One for a file that cannot be read: the error is for its reader to raise.
    """
    from img2tri.raster.reading import read

    if path.lower().endswith(WITH_PAGES):
        try:
            read(path, page=BEYOND)
        except NoSuchPageError as beyond:
            return beyond.pages
        except Img2triError:
            return 1
    return 1
