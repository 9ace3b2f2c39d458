"""Pixels that are not there -> a mask of them, by the rules of the formats that can say so.

GDAL notes one value for "no data" in a tag of TIFF, DICOM one for padding, numpy has masked arrays, and floats have NaN. None of them is
a gray value or a label: such pixels are not meshed, and edges beside them are not placed by their values.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools

GDAL_NODATA = 42113  # tag of TIFF: one number, as text


def equal_to(values: NDArray[Any], noted: object) -> Bools | None:
    """Return the mask of pixels with a value a file notes as "no data", NaN too; None if it can be no value of the image.

    A colour is missing if all its channels are.

    Examples
    --------
    >>> equal_to(np.array([[0, 255]], np.uint8), "255")
    array([[False,  True]])
    """
    try:
        number = float(noted)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    if values.dtype.kind == "f":
        with np.errstate(over="ignore"):
            same = np.isnan(values) if np.isnan(number) else values == values.dtype.type(number)
    elif not number.is_integer() or not _fits(values.dtype, int(number)):
        return None
    else:
        same = values == int(number)
    return np.asarray(same.all(axis=2) if values.ndim == 3 else same)


def gdal_nodata(tags: Mapping[int, Any], values: NDArray[Any]) -> Bools | None:
    """Return the mask of pixels that GDAL's tag says are not there."""
    noted = tags.get(GDAL_NODATA)
    return None if noted is None else equal_to(values, str(noted).strip("\0 "))


def either(one: Bools | None, other: Bools | None) -> Bools | None:
    """Return the mask of pixels missing in one or the other; None if none is."""
    both = one if other is None else other if one is None else one | other
    return both if both is not None and both.any() else None


def present(values: NDArray[Any]) -> tuple[NDArray[Any], Bools | None]:
    """Part an array into values that are all numbers, and the mask of those that were masked or NaN; None if none was.

    In their place are zeros, which nothing is to be read from.

    Examples
    --------
    >>> present(np.array([[1.0, np.nan]]))
    (array([[1., 0.]]), array([[False,  True]]))
    """
    masked: NDArray[np.bool_] | None = None
    if hasattr(values, "filled") and hasattr(values, "mask"):  # numpy.ma takes long to load, and is hardly ever met
        masked = np.broadcast_to(np.asarray(values.mask, bool), values.shape)
        values = np.asarray(values.filled(0))
    # A NaN is the minimum of all it is among, so one number tells about all.
    if values.dtype.kind == "f" and values.size and np.isnan(values.min()):
        nan = np.isnan(values)
        masked = nan if masked is None else masked | nan
    if masked is None or not masked.any():
        return values, None
    missing = np.asarray(masked.any(axis=2) if masked.ndim == 3 else masked)
    return np.where(masked, np.zeros((), values.dtype), values), missing


def _fits(dtype: np.dtype[Any], number: int) -> bool:
    return dtype.kind == "b" or np.iinfo(dtype).min <= number <= np.iinfo(dtype).max
