"""Which edges of a triangle mesh can be seen from afar: those that bound it, and those that part two regions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints


def bordering(sides: Ints, labels: NDArray[Any]) -> Bools:
    """Return a mask (e,) of the edges that bound the mesh or part two regions.

    Parameters
    ----------
    sides
        (m, 3) int64 from `img2tri.arrays.unique_edges`.
    labels
        (m,), the region of each triangle.

    Examples
    --------
    >>> from img2tri.arrays import unique_edges
    >>> bordering(unique_edges(np.array([[0, 1, 2], [0, 2, 3]]))[1], np.array([7, 7])).tolist()
    [True, False, True, True, True]
    """
    order = np.argsort(sides, axis=None, kind="stable")
    edge, label = sides.ravel()[order], np.repeat(labels, 3)[order]
    # The two sides of an inner edge follow each other.
    alike = (edge[1:] == edge[:-1]) & (label[1:] == label[:-1])
    border = np.ones(int(sides.max(initial=-1)) + 1, bool)
    border[edge[1:][alike]] = False
    return border
