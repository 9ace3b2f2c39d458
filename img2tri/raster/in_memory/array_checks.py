"""What an array of pixels is: the check every stage of this room makes at its door.

In: anything a user may pass as an image. Out: the same values as an array of one of the types the room works with, without
a copy where there is nothing to change.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ImageError

Pixels = NDArray[Any]


def pixels(image: object, *, colours: bool = True, name: str = "image") -> Pixels:
    """Return `image` as an array of pixels, or say why it is not one.

    Parameters
    ----------
    image
        Array-like of shape (h, w), or (h, w, 3 or 4) with `colours`; bool, integer or floating point, all values finite. Axes of
        length one beside these are dropped.
    colours
        Whether a third axis of red, green, blue and perhaps alpha is allowed.
    name
        What messages call it.

    Returns
    -------
    ndarray
        The values in the byte order of the machine. float16 becomes float32 and longer floats float64; all else keeps its type.

    Raises
    ------
    ImageError
        For any other type, shape or value.

    Examples
    --------
    >>> pixels([[0, 255], [255, 0]]).shape
    (2, 2)
    >>> pixels(np.zeros((1, 20, 30, 1))).shape
    (20, 30)
    >>> pixels([0, 1, 2])
    Traceback (most recent call last):
    ...
    img2tri.errors.ImageError: image: expected shape (h, w), or (h, w, 3 or 4) with colours, found (3,)
    """
    values = as_array(image, colours=colours, name=name)
    # A NaN is the minimum of all it is among, so two numbers tell about all.
    if values.dtype.kind == "f" and not (np.isfinite(values.min()) and np.isfinite(values.max())):
        count = int((~np.isfinite(values)).sum())
        raise ImageError(f"{name}: expected finite values, found {count} NaN or infinite; put NaN where there is nothing to mesh")
    return values


def as_array(image: object, *, colours: bool = True, name: str = "image") -> Pixels:
    """Return `image` as an array of the right shape and type, whose values may be NaN or infinite, or masked."""
    try:
        values = image if isinstance(image, np.ndarray) else np.asarray(image)
    except ValueError as error:
        raise ImageError(f"{name}: expected an array of pixels, found rows of unequal length") from error
    except Exception as error:
        # Libraries have errors of every type for what they cannot turn into an array, such as a tensor on a graphics card.
        raise ImageError(f"{name}: expected an array of pixels, found a {type(image).__name__} that is none ({error})") from error
    if values.dtype.kind not in "buif":
        what = type(image).__name__ if values.ndim == 0 else f"an array of type {values.dtype}"
        raise ImageError(f"{name}: expected an array of bool, integer or floating point values, found {what}")
    values = _without_axes_of_one(values)
    if not (values.ndim == 2 or (colours and values.ndim == 3 and values.shape[2] in (3, 4))):
        expected = "shape (h, w), or (h, w, 3 or 4) with colours" if colours else "shape (h, w)"
        raise ImageError(f"{name}: expected {expected}, found {values.shape}{_advice(values.shape)}")
    if values.size == 0:
        raise ImageError(f"{name}: expected at least one pixel, found shape {values.shape}")
    return _plain(values)


def _without_axes_of_one(values: Pixels) -> Pixels:
    """Drop axes of length one before and after those of the image, as (1, h, w), (h, w, 1) or (1, h, w, 3) have them."""
    while values.ndim > 2 and values.shape[0] == 1 and not (values.ndim == 3 and values.shape[2] in (3, 4)):
        values = values[0]
    while values.ndim > 2 and values.shape[-1] == 1:
        values = values[..., 0]
    return values


def _advice(shape: tuple[int, ...]) -> str:
    """Say what to do about an array of more axes: the shortest of them is hardly one of the image's."""
    if len(shape) < 3:
        return ""
    if len(shape) == 3 and shape[0] in (3, 4):
        return "; colours come last, as numpy.moveaxis(image, 0, -1) puts them"
    if len(shape) == 3 and shape[2] < min(shape[:2]):
        return "; pick one channel, for example image[..., 0]"
    return "; pick one image of a stack, for example image[0]"


def _plain(values: Pixels) -> Pixels:
    """Give values the types numpy, OpenCV and the other rooms all know."""
    dtype = values.dtype.newbyteorder("=")
    if dtype.kind == "f" and dtype.itemsize not in (4, 8):
        dtype = np.dtype(np.float32 if dtype.itemsize < 4 else np.float64)
    return values.astype(dtype, copy=False)
