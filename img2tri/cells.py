"""Cells: which of many places are near each other, found in a grid by sorting; what search trees do, in a few array operations.

Cells are numbered row by row, with empty ones around all, so that those beside a cell are three stretches of numbers::

    . 7 8 9 .
    . 4 5 6 .      beside 5 are 1 to 3, 4 to 6 and 7 to 9
    . 1 2 3 .
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Ints, Points, runs


def cells(places: Points, width: float) -> tuple[Ints, int]:
    """Return the number of the cell each place (n,) is in, and by how much that of the cell above differs.

    Examples
    --------
    >>> cells(np.array([0.5 + 0.5j, 1.5 + 0.5j, 0.5 + 1.5j]), 1.0)
    (array([4, 5, 7]), 3)
    """
    column, row = (np.floor((part - part.min()) / width).astype(np.int64) + 1 for part in (places.real, places.imag))
    above = int(column.max()) + 2
    return row * above + column, above


def in_cells_beside(cell: Ints, above: int, chosen: Bools) -> Bools:
    """Tell which of all places lie in the cell of a chosen one, or in one beside it."""
    marked = np.zeros(int(cell.max()) + 2 + above, bool)
    hit = cell[chosen]
    for up in (-above, 0, above):
        for right in (-1, 0, 1):
            marked[hit + up + right] = True
    return marked[cell]


def pairs_beside(own: Ints, cell: Ints, above: int) -> Ints:
    """Pair (2, p) all items that are in one cell or in two beside each other, each pair once; the cells (k,) of the items (k,) rise.

    Examples
    --------
    >>> pairs_beside(np.array([7, 8, 9]), np.array([5, 6, 9]), 4).tolist()
    [[7, 7, 8], [8, 9, 9]]
    """
    # Each pair is seen from the first of the two: the rest of its own cell, the one on the right, three in the row above.
    later = np.arange(1, len(cell) + 1)
    below = _stretch(own, own, later, np.searchsorted(cell, cell + 1, side="right"))
    return np.concatenate([below, _in_cells(own, own, cell, cell + above - 1, cell + above + 1)], axis=1)


def pairs_across(own: Ints, at: Ints, others: Ints, cell: Ints, above: int) -> Ints:
    """Pair (2, p) items in the cells `at` with the others in these and beside them, whose cells rise."""
    return np.concatenate([_in_cells(own, others, cell, row - 1, row + 1) for row in (at - above, at, at + above)], axis=1)


def _in_cells(own: Ints, others: Ints, cell: Ints, first: Ints, last: Ints) -> Ints:
    return _stretch(own, others, np.searchsorted(cell, first), np.searchsorted(cell, last, side="right"))


def _stretch(own: Ints, others: Ints, begin: Ints, end: Ints) -> Ints:
    run, place = runs(end - begin)
    return np.stack([own[run], others[begin[run] + place]])
