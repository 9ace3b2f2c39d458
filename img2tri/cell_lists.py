"""Cell lists: which of many places are near each other, found in a grid by sorting, as search trees do, in a few array operations.

Cells are numbered row by row, with empty ones around all, so that those beside a cell are three stretches of numbers::

    . 7 8 9 .
    . 4 5 6 .      beside 5 are 1 to 3, 4 to 6 and 7 to 9
    . 1 2 3 .
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Ints, Points

MOST_MARKS, FEW_MARKS = 8, 1 << 14  # cells to each place, and cells in all: larger grids are folded


def cells(places: Points, width: float) -> tuple[Ints, int]:
    """Return the number of the cell each place (n,) is in, and by how much that of the cell above differs.

    Examples
    --------
    >>> cells(np.array([0.5 + 0.5j, 1.5 + 0.5j, 0.5 + 1.5j]), 1.0)
    (array([5, 6, 9]), 4)
    """
    column, row = (np.floor((part - part.min()) / width).astype(np.int64) + 1 for part in (places.real, places.imag))
    above = int(column.max()) + 2
    return row * above + column, above


def in_cells_beside(cell: Ints, above: int, chosen: Bools) -> Bools:
    """Tell which of all places lie in the cell of a chosen one, or in one beside it; and of some others, as if they did.

    Where places are few and far apart, a grid of marks would be larger than the image: it is folded, so that cells far apart share one.
    """
    count = min(int(cell.max(initial=0)) + above + 2, max(FEW_MARKS, MOST_MARKS * len(cell)))
    last = (1 << count.bit_length()) - 1
    own, marks = np.zeros(last + 1, bool), np.zeros(last + 1, bool)
    own[cell[chosen] & last] = True
    hit = own.nonzero()[0]
    for beside in _nine(above):
        marks[(hit + beside) & last] = True
    return np.asarray(marks[cell & last])


def _nine(above: int) -> list[int]:
    """By how much the numbers of a cell and those beside it differ from its own."""
    return [up + right for up in (-above, 0, above) for right in (-1, 0, 1)]


def pairs_beside(own: Ints, cell: Ints, above: int, part: slice = slice(None)) -> tuple[Ints, Ints]:
    """Pair all items that are in one cell or in two beside each other, each pair once; the cells (k,) of the items (k,) rise.

    With `part` only those pairs that are seen from some of the items: all parts together have them all.

    Examples
    --------
    >>> pairs_beside(np.array([7, 8, 9]), np.array([5, 6, 9]), 4)
    (array([7, 7, 8]), array([8, 9, 9]))
    """
    # Each pair is seen from the first of the two: the rest of its own cell and the one on the right, then three in the row above.
    at, here = np.arange(len(cell))[part], cell[part]
    first = np.concatenate([at + 1, cell.searchsorted(here + (above - 1))])
    last = cell.searchsorted(np.concatenate([here + 1, here + (above + 1)]), side="right")
    return _paired(np.tile(own[part], 2), own, first, last)


def pairs_across(own: Ints, at: Ints, others: Ints, cell: Ints, above: int) -> tuple[Ints, Ints]:
    """Pair items in the cells `at` with the others in these and beside them, whose cells rise; item by item in each of three rows."""
    rows = np.concatenate([at - above, at, at + above])
    return _paired(np.tile(own, 3), others, cell.searchsorted(rows - 1), cell.searchsorted(rows + 1, side="right"))


def _paired(own: Ints, others: Ints, first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Pair each item (k,) with those of the others from its first one (k,) to before its last one (k,)."""
    count = last - first
    begin = first - (count.cumsum() - count)
    return own.repeat(count), others[np.arange(int(count.sum())) + begin.repeat(count)]
