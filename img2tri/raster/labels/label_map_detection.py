"""Values -> whether they look like a label map, so that none is thresholded by mistake.

A label map is made of flat patches that meet without a transition. Gray images, even those of two colours with smooth edges, have pixels
in between where patches meet. For each pixel it is asked whether it can be such a *mix*::

    flat       one of the 2 x 2 blocks it is in has one value                                5 5
                                                                                             5 5
    mix        not flat, and its value lies strictly between two of its eight neighbours     0 4 9
    boundary   one of its neighbours through sides has another value

An image looks like a label map if

- three values or more stand for themselves: most of their pixels are no mixes, and they have a flat patch or many pixels;
- most pixels of at least half of all values are flat: in JPEG images most values are ripples around edges;
- less than one in ten of the boundary's pixels is a mix, or all values are mostly flat. In label maps up to 6 % are mixes, in
  anti-aliased, blurred and JPEG images 25 % and more.

Two kinds of images would pass without being label maps. Smooth shadings turn into bands, each of which differs by one step from the next:
where there are many values, patches have to meet that are farther apart. An image enlarged by repeating its pixels has no mixes:
it is judged at its own size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints
from img2tri.raster.labels.otsu_threshold import two_valued
from img2tri.raster.labels.rgb_to_labels import distinct, label_map

MOST_MIXED = 0.1  # of the boundary's pixels
LEAST_EQUAL = 0.5  # of neighbours in a row: less than that are no patches
MANY_VALUES = 32  # above them a shading is to be told from labels
LEAST_JUMPS = 0.1  # of the places where patches meet, in an image of many values
LEAST_SHARE = 0.002  # of the pixels: values without a patch, such as lines, that are not strays
SMALLEST = 24  # pixels on a side: less tells nothing about an image that was enlarged
ROWS_FIRST = 64  # rows looked at first


def flat_values(values: NDArray[Any]) -> NDArray[Any] | None:
    """Return the values of the regions of what looks like a label map, None for a gray image or a mask.

    Parameters
    ----------
    values
        (h, w) bool, integers or floats, or (h, w, 3 or 4) colours; colours are numbers as for `label_map`.

    Examples
    --------
    >>> three_phases = np.repeat(np.arange(3), 5) * np.ones((8, 1), int)
    >>> flat_values(three_phases)
    array([0, 1, 2])
    >>> flat_values(three_phases > 1)
    """
    if values.dtype == bool or min(values.shape[:2]) < 2 or not _has_patches(values if values.ndim == 2 else values[..., 0]):
        return None
    if values.ndim == 2 and two_valued(values):
        return None
    if values.ndim == 3:
        if values.dtype.kind == "f" or values.dtype.itemsize > 2:
            return None
        values = label_map(values, background=None).values
    h, w = values.shape
    found = _own_values(values)
    if found is not None:
        down, across = _repeats(values)
        if max(down, across) > 1 and min(h // down, w // across) >= SMALLEST:
            return _own_values(values[::down, ::across])
    return found


def _has_patches(values: NDArray[Any]) -> bool:
    """Tell whether neighbours in a row are equal often enough; of a large image a few rows say it, most photographs fail here."""
    rows = values[:: max(1, len(values) // ROWS_FIRST)]
    return bool((rows[:, 1:] == rows[:, :-1]).mean() >= LEAST_EQUAL)


def _own_values(values: NDArray[Any]) -> NDArray[Any] | None:
    h, w = values.shape
    right, down = values[:, 1:] == values[:, :-1], values[1:] == values[:-1]
    block = right[1:] & right[:-1] & down[:, 1:] & down[:, :-1]
    flat = np.zeros((h, w), bool)
    for rows in (slice(0, h - 1), slice(1, h)):
        for columns in (slice(0, w - 1), slice(1, w)):
            flat[rows, columns] |= block

    # The boundary's pixels, and which of them are mixes.
    edge = np.zeros((h, w), bool)
    edge[:-1] |= ~down
    edge[1:] |= ~down
    edge[:, :-1] |= ~right
    edge[:, 1:] |= ~right
    thin = np.flatnonzero(~flat)
    mixed = thin[_between(values, thin)]
    few_mixed = len(mixed) <= MOST_MIXED * np.count_nonzero(edge)

    # What each value is made of.
    labels = distinct(values)
    if not few_mixed and len(labels) > MANY_VALUES:
        return None
    everywhere, mixes, patches = (_counts(values, of, labels) for of in (slice(None), mixed, flat.reshape(-1)))
    held = 2 * patches >= everywhere
    own = (2 * mixes < everywhere) & ((patches > 0) | (everywhere > LEAST_SHARE * values.size))
    if own.sum() < 3 or 2 * held.sum() < len(labels) or not (few_mixed or held.all()):
        return None
    if own.sum() > MANY_VALUES and _is_shading(np.searchsorted(labels, values), flat, right, down):
        return None
    return labels[own]


def _counts(values: NDArray[Any], of: Any, labels: NDArray[Any]) -> Ints:
    """Return how many of some pixels have each of some values."""
    some = values.reshape(-1)[of]
    if values.dtype in (np.uint8, np.uint16):
        return np.asarray(np.bincount(some, minlength=int(labels[-1]) + 1)[labels])
    return np.bincount(np.searchsorted(labels, some), minlength=len(labels))


def _between(values: NDArray[Any], at: Ints) -> Bools:
    """Tell which pixels lie strictly between two of their eight neighbours."""
    h, w = values.shape
    row, column = np.divmod(at, w)
    here = values[row, column]
    below, above = np.zeros(len(at), bool), np.zeros(len(at), bool)
    for r in (-1, 0, 1):
        for c in (-1, 0, 1):
            there = values[np.clip(row + r, 0, h - 1), np.clip(column + c, 0, w - 1)]
            below |= there < here
            above |= there > here
    return below & above


def _is_shading(number: Ints, flat: Bools, right: Bools, down: Bools) -> bool:
    """Tell whether patches meet at neighbouring values only, as the bands of a smooth shading do."""
    across = abs(number[:, 1:] - number[:, :-1])[~right & flat[:, 1:] & flat[:, :-1]]
    along = abs(number[1:] - number[:-1])[~down & flat[1:] & flat[:-1]]
    steps = np.append(across, along)
    return bool(len(steps) and (steps > 1).mean() < LEAST_JUMPS)


def _repeats(values: NDArray[Any]) -> tuple[int, int]:
    """Return how often each row and each column of an image comes in a row."""
    changed_rows = np.flatnonzero((values[1:] != values[:-1]).any(axis=1)) + 1
    changed_columns = np.flatnonzero((values[:, 1:] != values[:, :-1]).any(axis=0)) + 1
    h, w = values.shape
    return int(np.gcd.reduce(np.append(changed_rows, h))), int(np.gcd.reduce(np.append(changed_columns, w)))
