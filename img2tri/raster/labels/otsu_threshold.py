"""Gray values -> a mask, and the level that parts them.

The paper (section III-A) takes T = 240 for white on black. Where no level is given, an image of two values is split in the
middle and any other by Otsu's method: the level that parts the values into the two classes with the greatest variance between
them. It separates classes well; where exactly an edge runs is a question for the outlines.

Otsu, N.: A threshold selection method from gray-level histograms. IEEE Trans. Syst. Man Cybern. 9 (1979), doi 10.1109/TSMC.1979.4310076.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, blocks
from img2tri.errors import ImageError, ParameterError, finite
from img2tri.raster.in_memory.array_checks import Pixels, pixels

BINS = 65536
BLOCK = 1 << 20  # pixels counted at a time, so that no wide copy of the whole image is made


@dataclass(frozen=True)
class Level:
    """The level that parts an image: values strictly greater are foreground.

    Attributes
    ----------
    value
        A number on the image's own scale; several for regions by level.
    how
        "given"; "otsu"; "middle", between the two values of the image; "uniform", 0 for an image of one value; "mask", for an
        image of True and False, which is one already; "alpha", half of the greatest opacity.
    """

    value: Any
    how: str


def binarize(gray: object, *, threshold: float | str | None = None, invert: bool = False) -> tuple[Bools, Level]:
    """Part an image into foreground and background.

    Parameters
    ----------
    gray
        (h, w) bool, integers or floats. A bool image is a mask already: no threshold is applied to it.
    threshold
        A number on the image's own scale: strictly greater is foreground. "otsu": the level of Otsu's method. None: an image of
        two values is split in the middle, one of more by Otsu's method; one of a single value is all foreground if that is
        above 0, else all background.
    invert
        Swap foreground and background: dark objects on a bright ground.

    Returns
    -------
    mask
        (h, w) bool, ``gray > level.value``, or the opposite with `invert`.
    level
        The level, and how it was found.

    Raises
    ------
    ImageError
        If `gray` is not an image of one value per pixel; with "otsu" if all values are equal; without a threshold if signed or
        32- or 64-bit integers have more than two values, as those are label numbers or measurements.
    ParameterError
        If `threshold` is neither finite nor "otsu".

    Notes
    -----
    Otsu is exact where values are integers within a range of 65536; any others are sorted into that many classes first. Of
    several levels equally good the lowest is taken, which is a value of the image.

    Examples
    --------
    >>> import numpy as np
    >>> mask, level = binarize(np.array([[0, 255]], np.uint8))
    >>> mask, level
    (array([[False,  True]]), Level(value=127.5, how='middle'))
    """
    values = pixels(gray, colours=False)
    number = _number(threshold)
    if values.dtype == bool:
        level, mask = Level(0.5, "mask"), values
    elif number is not None:
        level, mask = Level(number, "given"), _above(values, number)
    elif threshold is None and two_valued(values):
        level, mask = _middle(values)
    else:
        value = _otsu(values, chosen=threshold is not None)
        level, mask = Level(float(value), "otsu"), values > value
    return np.asarray(~mask if invert else mask), level


def _number(threshold: float | str | None) -> float | None:
    if threshold is None or isinstance(threshold, str):
        if threshold not in (None, "otsu"):
            raise ParameterError(f"threshold: expected a number, 'otsu' or None, found {threshold!r}")
        return None
    return finite("threshold", threshold)


def _above(values: Pixels, level: float) -> Bools:
    # Comparing whole numbers with whole numbers is exact and does not widen them.
    return np.asarray(values > (level if values.dtype.kind == "f" else math.floor(level)))


def two_valued(values: Pixels) -> bool:
    """Tell whether an image has at most two different values."""
    if values.dtype == bool:
        return True
    flat, least, greatest = values.reshape(-1), values.min(), values.max()
    parts = (flat[part] for part in blocks(flat.size))
    return all(((part == least) | (part == greatest)).all() for part in parts)


def _middle(values: Pixels) -> tuple[Level, Bools]:
    least, greatest = values.min(), values.max()
    if least == greatest:
        return Level(0.0, "uniform"), np.asarray(values > 0)
    return Level(float(least) / 2 + float(greatest) / 2, "middle"), np.asarray(values == greatest)


def _otsu(values: Pixels, *, chosen: bool) -> Any:
    """Return the greatest value of the lower class."""
    if values.min() == values.max():
        raise ImageError(f"threshold: 'otsu' expected at least two values in the image, found only {values.min()}")
    if not chosen and values.dtype.kind in "iu" and values.dtype not in (np.uint8, np.uint16):
        raise ImageError(
            f"image: expected a mask or gray values, found {values.dtype} with more than two values; "
            "labels=True makes each value a region of its own, threshold= a number or 'otsu' takes them as gray values"
        )
    classes, counts, sums = _histogram(values)
    best = otsu_class(counts, sums)
    flat = values.reshape(-1)
    return flat.max(where=classes <= best, initial=flat.min())


def otsu_class(counts: Floats, sums: Floats) -> int:
    """Return the last class of the lower part, as Otsu's method divides a histogram.

    Parameters
    ----------
    counts, sums
        (k,) float64, the number of values in each class, rising with the value, and their sum.

    Examples
    --------
    >>> otsu_class(np.array([5.0, 1, 0, 1, 5]), np.array([0.0, 1, 0, 3, 20]))
    1
    """
    # Number and sum of all values up to each class. Empty classes change neither, so ties are exact and the first wins.
    below, total = np.cumsum(counts), np.cumsum(sums)
    parts = (below > 0) & (below < below[-1])
    size, mean = below[-1], total[-1] / below[-1]
    below, total = below[parts], total[parts]
    between = (mean * below - total) ** 2 / (below * (size - below))
    return int(np.flatnonzero(parts)[between.argmax()])


def _histogram(values: Pixels) -> tuple[NDArray[np.uint8] | NDArray[np.uint16], Floats, Floats]:
    """Sort all values into at most 65536 classes, rising with the value; return the number and the sum of values in each.

    Integers close together have a class each. Values are moved and scaled before they are summed, which moves no level.
    """
    flat = values.reshape(-1)
    least, greatest = values.min(), values.max()
    exact = values.dtype.kind in "iu" and int(greatest) - int(least) < BINS
    own = values.dtype in (np.uint8, np.uint16)
    classes = flat if own else np.zeros(flat.size, np.uint16)
    counts, sums = np.zeros(BINS), np.zeros(BINS)
    # Scaled to -1..1 first, so that no difference overflows.
    scale = max(abs(float(least)), abs(float(greatest)))
    low, high = float(least) / scale, float(greatest) / scale
    for start in range(0, flat.size, BLOCK):
        part = slice(start, start + BLOCK)
        if exact and not own:
            classes[part] = flat[part].astype(np.int64) - least.astype(np.int64)
        elif not own:
            place = (flat[part].astype(np.float64) / scale - low) / (high - low)
            classes[part] = place * (BINS - 1)
            sums += np.bincount(classes[part], place, BINS)
        counts += np.bincount(classes[part], minlength=BINS)
    return classes, counts, counts * np.arange(BINS) if exact else sums
