"""An image as the bytes of a PNG file: an array -> 8 bits per channel, compressed.

In a dozen lines of the standard library, so that neither Pillow nor matplotlib has to be loaded to show a picture on a page. The format is
that of the PNG specification, third edition, W3C 2025.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.errors import ParameterError

_COLOUR_TYPE = {1: 0, 3: 2, 4: 6}


def png(image: ArrayLike) -> bytes:
    r"""Return the bytes of a PNG file.

    Parameters
    ----------
    image
        (h, w): gray, black at its least and white at its greatest value; (h, w, 3) or (h, w, 4): colours, unsigned integers
        over their whole range or floats over 0..1. NaN is black.

    Raises
    ------
    ParameterError
        If it is not an image.

    Examples
    --------
    >>> png([[0, 1], [1, 0]])[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    pixels = np.asarray(image)
    channels = 1 if pixels.ndim == 2 else pixels.shape[2] if pixels.ndim == 3 else 0
    if channels not in _COLOUR_TYPE or not pixels.size or pixels.dtype.kind not in "biuf":
        raise ParameterError(f"image: expected shape (h, w), (h, w, 3) or (h, w, 4), found {pixels.shape} of {pixels.dtype}")
    h, w = pixels.shape[:2]
    rows = np.zeros((h, 1 + w * channels), np.uint8)  # each row begins with its filter: 0, none
    rows[:, 1:] = _eight_bits(pixels).reshape(h, -1)
    header = struct.pack(">IIBBBBB", w, h, 8, _COLOUR_TYPE[channels], 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 6)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )


def _eight_bits(pixels: NDArray[Any]) -> NDArray[np.uint8]:
    """Scale to 0..255."""
    if pixels.dtype == np.uint8 and pixels.ndim == 3:
        return pixels
    values = np.nan_to_num(pixels.astype(np.float64), posinf=0.0, neginf=0.0)
    if pixels.ndim == 3:
        least, most = 0.0, float(np.iinfo(pixels.dtype).max) if pixels.dtype.kind in "iu" else 1.0
    else:
        least, most = float(values.min()), float(values.max())
    span = most - least or 1.0
    return np.round(255 * ((values - least) / span).clip(0, 1)).astype(np.uint8)
