"""Colours, palettes and transparency -> one value per pixel, on the image's own scale.

Colours become gray by the weights of Rec. 601, as in ``cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)`` of the paper (section III-A).
Transparency is nothing to be seen: such pixels count as black, which is background, and half transparent ones are half as
bright. A picture of one colour on a transparent ground, such as a black logo, would vanish by that rule; there the alpha
channel is all the picture says, so it is the picture.
"""

from __future__ import annotations

import numpy as np

from img2tri.raster.in_memory.array_checks import Pixels, pixels

REC_601 = (0.299, 0.587, 0.114)


def to_gray(values: object, *, palette: Pixels | None = None, min_is_white: bool = False) -> Pixels:
    """Reduce an image to one value per pixel.

    Parameters
    ----------
    values
        (h, w), which is returned as it is, or (h, w, 3 or 4) red, green, blue and perhaps alpha.
    palette
        (n, 3 or 4) uint8: `values` are indices into it (`Picture.notes` has it for palette images). None: they are not.
    min_is_white
        The least value is white, as some TIFFs have it: what is returned is turned round, so that white is bright.

    Returns
    -------
    ndarray
        (h, w) of the type of `values` (of the palette, if there is one); whole numbers are rounded.

    Raises
    ------
    ImageError
        If `values` are not those of an image, see `array_checks.pixels`.

    Notes
    -----
    Alpha is full at the greatest value of uint8 and uint16, at 1 for bool and floats up to 1, else at the greatest alpha there is.

    Examples
    --------
    >>> import numpy as np
    >>> to_gray(np.array([[[255, 255, 255], [255, 0, 0]]], np.uint8))
    array([[255,  76]], dtype=uint8)

    A black dot on a transparent ground is its alpha:

    >>> to_gray(np.array([[[0, 0, 0, 0], [0, 0, 0, 255]]], np.uint8))
    array([[  0, 255]], dtype=uint8)
    """
    values = pixels(values)
    if palette is not None:
        values = pixels(np.take(palette, values, axis=0))
    if values.ndim == 2:
        return _turned_round(values) if min_is_white else values
    if alpha_is_the_picture(values):
        return values[..., 3]
    gray = _luminance(values[..., :3])
    if values.shape[2] == 3 or opaque(values).all():
        return gray
    return _seen(gray, values[..., 3], full_alpha(values))


def alpha_is_the_picture(values: Pixels) -> bool:
    """Tell whether an image has one colour wherever it can be seen, and an alpha channel that varies.

    Editors round colours multiplied by alpha, so a nearly transparent pixel may be off by much: colours count as equal if they
    differ by at most one step after that multiplication (one of 255 for floats).
    """
    if values.shape[2:] != (4,):
        return False
    alpha = values[..., 3]
    if alpha.min() == alpha.max():
        return False
    real = np.float32 if values.dtype == np.uint8 else np.float64
    colour = values[np.unravel_index(alpha.argmax(), alpha.shape)].astype(real)
    step = full_alpha(values) / (255 if values.dtype.kind == "f" else 1)
    return all(bool((abs(values[..., i] - colour[i]) * alpha <= step).all()) for i in range(3))


def full_alpha(values: Pixels) -> float:
    """Return the alpha of an opaque pixel of an (h, w, 4) image."""
    if values.dtype in (np.uint8, np.uint16):
        return float(np.iinfo(values.dtype).max)
    return max(1.0, float(values[..., 3].max()))


def opaque(values: Pixels) -> Pixels:
    """Return the mask of the pixels of an (h, w, 4) image that nothing shines through."""
    return np.asarray(values[..., 3] >= full_alpha(values))


def _turned_round(values: Pixels) -> Pixels:
    if values.dtype == bool or values.dtype.kind == "u":
        return ~values
    return np.asarray(values.max() - values + values.min())


def _luminance(colours: Pixels) -> Pixels:
    if colours.dtype in (np.uint8, np.uint16):
        import cv2  # exactly the rounding of the paper's recipe, and fast

        return np.asarray(cv2.cvtColor(np.ascontiguousarray(colours), cv2.COLOR_RGB2GRAY))
    return _as_type(sum(weight * colours[..., i] for i, weight in enumerate(REC_601)), colours.dtype)


def _seen(gray: Pixels, alpha: Pixels, full: float) -> Pixels:
    """Lay gray values over black."""
    if gray.dtype in (np.uint8, np.uint16):
        import cv2

        return np.asarray(cv2.multiply(gray, np.ascontiguousarray(alpha), scale=1 / full))
    return _as_type(gray * (alpha / full), gray.dtype)


def _as_type(values: Pixels | float, dtype: np.dtype[np.generic]) -> Pixels:
    return np.asarray(values if dtype.kind == "f" else np.rint(values)).astype(dtype, copy=False)
