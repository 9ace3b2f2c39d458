"""Where each of some whole numbers is: the labels of many triangles -> for each label its triangles, in the time of a few passes."""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Ints

_DENSE = 4  # numbers that lie closer than so many times their count are counted rather than sorted


def grouped(keys: Ints) -> tuple[Ints, list[Ints]]:
    """Return the numbers that are there, in ascending order, and for each of them where it is.

    Parameters
    ----------
    keys
        (k,) int64.

    Returns
    -------
    each
        (g,) int64.
    members
        The places of each, in ascending order.

    Examples
    --------
    >>> each, members = grouped(np.array([7, 3, 7]))
    >>> each.tolist(), [rows.tolist() for rows in members]
    ([3, 7], [[1], [0, 2]])
    """
    if not len(keys):
        return keys, []
    low = int(keys.min())
    if int(keys.max()) - low < _DENSE * len(keys):
        counts = np.bincount(keys - low)
        each = np.flatnonzero(counts)
        number = np.cumsum(counts > 0) - 1
        which, counts, each = number[keys - low], counts[each], each + low
    else:
        each, which, counts = np.unique(keys, return_inverse=True, return_counts=True)
    # numpy sorts numbers of 16 bits by counting them.
    narrow = which.astype(np.uint16) if len(each) < 2**16 else which
    return each, np.split(np.argsort(narrow, kind="stable"), np.cumsum(counts)[:-1])
