"""What every decoder returns, and what it checks before it decodes: which page, and how many pixels."""

from __future__ import annotations

from typing import Any

from img2tri.errors import ImageError, ParameterError, shown
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.raster.metadata.pixel_size import PixelSize

Decoded = tuple[Pixels, dict[str, Any], PixelSize | None]
"""Pixels, notes, and the size of a pixel (dx, dy) in millimetres if the file knows it."""


def check_page(source: Source, page: int, pages: int, width: int, height: int, max_pixels: int) -> dict[str, Any]:
    """Check page and size before anything is decoded, and note the page."""
    if page >= pages:
        raise ParameterError(f"page: expected 0 to {pages - 1} in {str(source)!r}, found {shown(page)}")
    if width * height > max_pixels:
        raise ImageError(
            f"image: expected at most max_pixels={max_pixels} pixels, found {width} x {height} in {str(source)!r}; "
            "raise max_pixels if the file can be trusted"
        )
    return {"pages": pages, "page": page} if pages > 1 else {}


def turned(values: Pixels, turn: int, notes: dict[str, Any], size: PixelSize | None) -> Decoded:
    """Note that an image was turned, and turn the size of its pixels."""
    if turn > 1:
        notes = notes | {"orientation": turn}
    return values, notes, size[::-1] if size is not None and turn >= 5 else size
