"""Label map -> label map without some labels: each of their pixels gets the label of the nearest pixel of another.

Watershed lines, the border of 255 around the objects of VOC, and pixels an EBSD camera could not index part regions by a pixel or two, so
that regions that touch in truth have no interface. Given to their neighbours, such pixels get the label that most of
their neighbours have; those farther inside of wide gaps that of the nearest pixel, by the exact Euclidean distance transform (Maurer et al.
2003, doi 10.1109/TPAMI.2003.1177156).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints, label_changes
from img2tri.errors import ImageError

THIN_SHARE = 0.01  # of the pixels: less than that are no lines that part regions
MOST_INSIDE = 0.1  # of the pixels of a label that are off its edges: more are no lines
LOOKED_AT = 2000  # rows and columns: enough for a hint


def absorb_labels(
    labels: NDArray[Any], absorbed: list[int], *, spacing: tuple[float, float] = (1.0, 1.0), missing: Bools | None = None
) -> tuple[NDArray[Any], int]:
    """Give the pixels of some labels to their nearest neighbours.

    Parameters
    ----------
    labels
        (h, w) integers.
    absorbed
        The labels that are given away.
    spacing
        (dx, dy), the size of a pixel.
    missing
        (h, w) pixels that are not there: they stay what they are, and take no pixels.

    Returns
    -------
    labels
        (h, w), a copy.
    count
        How many pixels were given away.

    Raises
    ------
    ImageError
        If none of these labels occurs, or no others do.

    Examples
    --------
    >>> absorb_labels(np.array([[1, 1, 0, 2, 2, 2]]), [0])
    (array([[1, 1, 1, 2, 2, 2]]), 1)
    """
    from scipy.ndimage import distance_transform_edt

    given = np.isin(labels, absorbed)
    if missing is not None:
        given &= ~missing
    if not given.any():
        raise ImageError(f"absorb: expected labels of the image, found {', '.join(map(str, absorbed))}, none of which is one")
    takers = ~given if missing is None else ~given & ~missing
    if not takers.any():
        raise ImageError("absorb: expected other labels beside those that are absorbed, found none")
    copy = labels.copy()
    at = np.flatnonzero(given)
    # Lines are mostly one pixel wide: beside them a vote keeps the new border smooth, where the nearest would change from pixel to pixel.
    voted, found = _voted(labels, takers, at)
    copy.reshape(-1)[at[found]] = voted[found]
    if not found.all():
        row, column = distance_transform_edt(~takers, sampling=spacing[::-1], return_distances=False, return_indices=True)
        far = at[~found]
        copy.reshape(-1)[far] = labels[row.reshape(-1)[far], column.reshape(-1)[far]]
    return copy, len(at)


def _voted(labels: NDArray[Any], takers: Bools, at: Ints) -> tuple[NDArray[Any], Bools]:
    """Return the label most of the eight neighbours of each pixel have, of several the lowest, and whether any neighbour takes pixels."""
    h, w = labels.shape
    row, column = np.divmod(at, w)
    beside = [(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if (r, c) != (0, 0)]
    there, candidate = np.zeros((8, len(at)), bool), np.zeros((8, len(at)), labels.dtype)
    for k, (r, c) in enumerate(beside):
        inside = (row + r >= 0) & (row + r < h) & (column + c >= 0) & (column + c < w)
        y, x = np.clip(row + r, 0, h - 1), np.clip(column + c, 0, w - 1)
        there[k], candidate[k] = inside & takers[y, x], labels[y, x]
    votes = np.stack([(there & there[k] & (candidate == candidate[k])).sum(axis=0) for k in range(8)])
    most = (votes == votes.max(axis=0)) & there
    lowest = np.where(most, candidate, np.iinfo(labels.dtype).max).min(axis=0)
    return lowest, np.asarray(there.any(axis=0))


def thin_separators(labels: NDArray[Any]) -> list[int]:
    """Return the labels that are thin lines between three others or more, which `absorb_labels` would give to their neighbours.

    Examples
    --------
    >>> lines = np.kron(np.arange(1, 10).reshape(3, 3), np.ones((6, 6), int))
    >>> lines[5::6] = lines[:, 5::6] = 0
    >>> thin_separators(lines)
    [0]
    """
    labels = labels[:LOOKED_AT, :LOOKED_AT]
    # Labels come in runs, of which there are few; and so are the pixels beside another label, or at the edge.
    flat, w = np.ascontiguousarray(labels).reshape(-1), labels.shape[1]
    right, below = label_changes(flat, 1), label_changes(flat, w)
    first = np.append(0, right + 1)
    every, number = np.unique(flat[first], return_inverse=True)
    count = np.bincount(number, np.diff(first, append=len(flat)))
    edge = np.ones(labels.shape, bool)
    edge[1:-1, 1:-1] = False
    for at, step in ((right, 1), (below, w)):
        edge.reshape(-1)[at] = edge.reshape(-1)[at + step] = True
    inner = count - np.bincount(np.searchsorted(every, flat[np.flatnonzero(edge)]), minlength=len(every))
    lines = []
    for label in every[(count > THIN_SHARE * labels.size) & (inner < MOST_INSIDE * count)].tolist():
        here = labels == label
        beside = np.zeros(labels.shape, bool)
        for one, other in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
            beside[one] |= here[other]
            beside[:, one] |= here[:, other]
        if len(np.unique(labels[beside & ~here])) >= 3:
            lines.append(int(label))
    return lines
