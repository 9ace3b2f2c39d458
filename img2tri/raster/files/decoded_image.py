"""What every decoder returns, and what it checks before it decodes: which page, and how many pixels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from img2tri.arrays import Bools
from img2tri.errors import ImageError, ParameterError, shown
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.raster.metadata.pixel_size import PixelSize


@dataclass(frozen=True, eq=False)
class DecodedImage:
    """One image of a file.

    Attributes
    ----------
    values
        (h, w) or (h, w, 3 or 4), upright, as stored.
    notes
        What was found, for `Picture.notes`.
    size
        (dx, dy), the size of a pixel, if the file knows it.
    unit
        What `size` is in; None if the file does not say.
    corner
        Where the lower-left corner of the image lies in the world, with y up, if the file knows it.
    missing
        (h, w) bool, pixels the file says are not there; None: none.
    height
        Of its plane above that of page 0, in `unit`, if the file is a volume that knows it.
    """

    values: Pixels
    notes: dict[str, Any]
    size: PixelSize | None = None
    unit: str | None = "mm"
    corner: tuple[float, float] | None = None
    missing: Bools | None = None
    height: float | None = None


def plane_height(page: int, steps: Sequence[float]) -> float | None:
    """Return how high a page of a volume lies; None where it is not known, or has more axes than three."""
    step = steps[0] if len(steps) == 1 else math.nan
    return page * step if math.isfinite(step) and step > 0 else None


class NoSuchPageError(ParameterError):
    """A file has fewer pages than the one asked for; `pages` is how many."""

    pages = 1


def check_page(source: Source, page: int, pages: int, width: int, height: int, max_pixels: int) -> dict[str, Any]:
    """Check page and size before anything is decoded, and note the page."""
    if page >= pages:
        beyond = NoSuchPageError(f"page: expected 0 to {pages - 1} in {str(source)!r}, found {shown(page)}")
        beyond.pages = pages
        raise beyond
    if width * height > max_pixels:
        raise ImageError(
            f"image: expected at most max_pixels={max_pixels} pixels, found {width} x {height} in {str(source)!r}; "
            "raise max_pixels if the file can be trusted"
        )
    return {"pages": pages, "page": page} if pages > 1 else {}


def turned(image: DecodedImage, turn: int) -> DecodedImage:
    """Note that an image was turned by its EXIF orientation, and turn the size of its pixels."""
    notes = image.notes | {"orientation": turn} if turn > 1 else image.notes
    return replace(image, notes=notes, size=image.size[::-1] if image.size is not None and turn >= 5 else image.size)
