"""An image as the bytes of a PNG file: an array -> 8 bits per channel, compressed.

Pillow writes the file: no date or other chance in it, so that the same image gives the same bytes with the same Pillow.
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from img2tri.views.figures.figure_parts import as_picture


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
    pixels = as_picture(image)
    file = io.BytesIO()
    Image.fromarray(_eight_bits(pixels)).save(file, "PNG")
    return file.getvalue()


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
