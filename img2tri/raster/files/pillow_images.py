"""PNG, JPEG, TIFF, GIF, BMP and all else that Pillow knows -> values, notes and the size of a pixel in millimetres.

Pillow keeps palette indices and bit depth, reports truncated files and knows EXIF. It loses bits in two places, which are read
otherwise: PNG colours of 16 bit by OpenCV, and TIFFs of types it has no mode for by tifffile.
"""

from __future__ import annotations

import math
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from PIL import Image
from PIL.TiffImagePlugin import COMPRESSION_INFO

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page, turned
from img2tri.raster.files.tiff import MIN_IS_WHITE, of_tiff
from img2tri.raster.files.windows_icons import check_icon
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.raster.metadata.exif_orientation import exif, orientation, upright
from img2tri.raster.metadata.pixel_size import pixel_size

BITS, COMPRESSION, PHOTOMETRIC, SAMPLE_FORMAT = 258, 259, 262, 339  # tags of TIFF
DRAWINGS = ("EPS", "WMF")

# Modes of Pillow whose arrays are the values in the file; the others become one of these.
PLAIN_MODES = ("1", "L", "P", "RGB", "RGBA", "I", "F", "I;16", "I;16B", "I;16L", "I;16N")
CONVERTED_MODES = {"LA": "RGBA", "RGBa": "RGBA", "PA": "RGBA", "RGBX": "RGB", "CMYK": "RGB", "YCbCr": "RGB"}

_limit_lock = threading.Lock()
_limits: list[float] = []  # Pillow's own limit, then those in force at the moment


def pillow_reads_tiff(source: Source, page: int) -> bool:
    """Tell whether Pillow has a mode for the values of a TIFF that loses nothing.

    Values of mode I and F come out in the wrong byte order if the file is big-endian and compressed (13.0).
    """
    try:
        with _opened(source) as img:
            if page < int(getattr(img, "n_frames", 1)):
                img.seek(page)
            bits, kinds = set(img.tag_v2.get(BITS, (1,))), set(img.tag_v2.get(SAMPLE_FORMAT, (1,)))  # type: ignore[attr-defined]
            wide = ("I;16", "I;16B", "I", "F") if img.tag_v2.prefix == b"II" else ("I;16", "I;16B")  # type: ignore[attr-defined]
            if img.tag_v2.get(COMPRESSION, 1) not in COMPRESSION_INFO:  # type: ignore[attr-defined]
                return False
            return (max(bits) <= 8 and kinds == {1}) or (max(bits) <= 32 and img.mode in wide)
    except (OSError, SyntaxError, ValueError, KeyError, struct.error):
        return False


@contextmanager
def _limit(pixels: float) -> Iterator[None]:
    """Set Pillow's limit of pixels, a global one that TIFF and GIF ask for while they decode, to ours if that is greater.

    Where several threads decode, the greatest limit holds until the last of them is done.
    """
    with _limit_lock:
        if not _limits:
            _limits.append(Image.MAX_IMAGE_PIXELS or math.inf)
        _limits.append(pixels)
        Image.MAX_IMAGE_PIXELS = max(_limits)  # type: ignore[assignment]
    try:
        yield
    finally:
        with _limit_lock:
            _limits.remove(pixels)
            Image.MAX_IMAGE_PIXELS = max(_limits)  # type: ignore[assignment]
            if len(_limits) == 1:
                usual = _limits.pop()
                Image.MAX_IMAGE_PIXELS = None if usual == math.inf else int(usual)


@contextmanager
def _opened(source: Source, max_pixels: float = math.inf) -> Iterator[Image.Image]:
    """Open a file with Pillow, whatever size it claims; what is decoded may have `max_pixels`.

    Pillow is not given the path, as it would map the file into memory, and scrambles turned TIFFs when it does (13.0).
    """
    with source.open() as file:
        with _limit(math.inf):
            img = Image.open(file)
        with img, _limit(max_pixels):
            yield img


def decode_with_pillow(source: Source, start: bytes, page: int, max_pixels: int) -> DecodedImage:
    """Decode one image of a file by Pillow, as `format_detection.decode` does; `start` are its first bytes."""
    check_icon(source, max_pixels)
    with _opened(source, max_pixels) as img:
        kind = str(img.format)
        if kind in DRAWINGS:
            raise FileError(f"image: {str(source)!r} is a drawing ({kind}), not pixels; convert it to PNG first")
        pages = int(getattr(img, "n_frames", 1))
        notes = {"format": kind} | check_page(source, page, pages, *img.size, max_pixels)
        if page:
            img.seek(page)
            check_page(source, page, pages, *img.size, max_pixels)
        turn, tags = orientation(exif(img)), dict(img.tag_v2) if kind == "TIFF" else None  # type: ignore[attr-defined]
        size = pixel_size(img)
        img.load()
        deep = _deep_png(source, start) if page == 0 else None
        values, palette = (deep, None) if deep is not None else _values(img)
        if palette is not None:
            notes["palette"] = palette
    if tags is None:
        return turned(DecodedImage(upright(values, turn), notes, size), turn)
    if tags.get(PHOTOMETRIC) == MIN_IS_WHITE and values.ndim == 2:
        notes["min_is_white"] = True
        if values.dtype in (bool, np.uint8):
            values = ~values  # Pillow has turned these round, and no others
    # Pillow turns TIFFs upright itself while loading.
    return turned(of_tiff(values, notes, tags, turn), turn)


def of_pillow(img: Image.Image) -> DecodedImage:
    """Take an image Pillow has opened or made, as it is."""
    values, palette = _values(img)
    notes: dict[str, Any] = {"format": "PIL"} | ({} if palette is None else {"palette": palette})
    return DecodedImage(values, notes, pixel_size(img))


def _values(img: Image.Image) -> tuple[Pixels, Pixels | None]:
    """Return the values of a loaded image, and the palette if they are indices."""
    if img.mode == "P":
        return np.asarray(img), _palette(img)
    if img.mode == "La":  # gray multiplied by alpha
        gray, alpha = img.split()
        img = Image.merge("RGBa", (gray, gray, gray, alpha))
    if img.mode in CONVERTED_MODES:
        img = img.convert(CONVERTED_MODES[img.mode])
    if img.mode not in PLAIN_MODES:
        raise ImageError(f"image: expected gray values, a palette, RGB or CMYK, found the colour space {img.mode}; convert it first")
    values = np.asarray(img)
    if img.mode == "I":
        values = values.astype(_whole_type(img), copy=False)
    key = img.info.get("transparency")
    if key is None or img.mode == "RGBA":
        return values, None
    # One gray value or colour of the file stands for full transparency.
    seen = (values != np.asarray(key)).reshape(*values.shape[:2], -1).any(axis=2)
    colours = np.broadcast_to(values.reshape(*values.shape[:2], -1), (*values.shape[:2], 3))
    most = 1 if values.dtype == bool else np.iinfo(values.dtype).max
    return np.dstack([colours, seen * np.asarray(most, values.dtype)]), None


def _whole_type(img: Image.Image) -> type[np.integer[Any]]:
    """Return the type of the values in the file: Pillow has int32 for all whole numbers it has no other mode for."""
    if img.format != "TIFF":
        return np.uint16 if img.format == "PPM" else np.int32
    bits, kind = (img.tag_v2.get(tag, (1,))[0] for tag in (BITS, SAMPLE_FORMAT))  # type: ignore[attr-defined]
    return np.uint32 if kind == 1 else np.int16 if bits == 16 else np.int32


def _palette(img: Image.Image) -> Pixels:
    """Return the 256 colours of a palette, with alpha where it has any; colours beyond its end are black."""
    assert img.palette is not None
    channels = "RGBA" if "transparency" in img.info or img.palette.mode == "RGBA" else "RGB"
    img.apply_transparency()
    table = np.asarray(img.getpalette(channels), np.uint8).reshape(-1, len(channels))
    black = np.array([0, 0, 0, 255], np.uint8)[: len(channels)]
    return np.vstack([table, np.broadcast_to(black, (max(0, 256 - len(table)), len(channels)))])


def _deep_png(source: Source, start: bytes) -> Pixels | None:
    """Return the values of a PNG with colours of 16 bit, of which Pillow keeps 8; None for any other image.

    Pillow has decoded the file before, so it is whole.
    """
    if start[:8] != b"\x89PNG\r\n\x1a\n" or start[24] != 16 or start[25] not in (2, 4, 6):
        return None
    import cv2

    with source.open() as file:
        whole = file.read()
    values: Pixels = np.asarray(cv2.imdecode(np.frombuffer(whole, np.uint8), cv2.IMREAD_UNCHANGED))
    return values[..., [2, 1, 0, 3][: values.shape[2]]]  # OpenCV's order is blue, green, red
