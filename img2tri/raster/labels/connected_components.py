"""Label map -> its components: the pieces of each region that hang together, and how they touch.

Pixels hang together through their sides. At the corner of four pixels that all differ from their neighbours a diagonal of two
equal ones may be joined as well, by the rule the outlines follow, so that a component here is a component of the mesh::

        a | b        one diagonal equal: it is joined
       ---+---       both equal, a checkerboard: with connectivity 4 the lower label is joined, the background being the
        c | d        lowest, so that the foreground of a mask hangs together through sides alone; with 8 the higher one

All is done on *runs*, stretches of equal pixels in a row, so that after one look at each pixel the work grows with the number
of runs. Two rows of runs touch in *pieces*, which begin wherever a run begins in either row::

        row r      | 5 5 5 5 | 7 7 |
        row r + 1  | 5 5 | 3 3 3 3 |
        pieces     |     |   |     |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Ints


@dataclass(frozen=True, eq=False)
class Components:
    """The components of a label map, numbered by their first pixels, row by row.

    Attributes
    ----------
    values
        (v,) int64, the background, or 0 if there is none, and then all other labels that occur, rising.
    number
        (k,) int64, the label of each component as an index into `values`; 0 is the background.
    area
        (k,) int64, its number of pixels.
    start, length
        (n,) int64, the first pixel of each run, counted row by row, and the number of its pixels.
    component
        (n,) int64, the component of each run.
    touching
        (t, 2) int64, pairs of components of different labels that touch; a pair may come several times.
    sides
        (t,) int64, the number of sides of pixels a pair shares there.
    corners
        (c, 4) int64, the components a, b, c, d around each corner where all four neighbours through sides differ.
    """

    values: Ints
    number: Ints
    area: Ints
    start: Ints
    length: Ints
    component: Ints
    touching: Ints
    sides: Ints
    corners: Ints


def find_components(labels: NDArray[Any], *, background: int | None = 0, connectivity: int = 4) -> Components:
    """Find the components of a label map.

    Parameters
    ----------
    labels
        (h, w) bool or integer, not empty; each value is a region.
    background
        The label that counts as the lowest; None: there is none.
    connectivity
        4 or 8: which diagonal of a checkerboard is joined.

    Examples
    --------
    >>> mask = np.array([[1, 0], [0, 1]])
    >>> find_components(mask).area, find_components(mask, connectivity=8).area
    (array([1, 2, 1]), array([2, 1, 1]))
    """
    h, w = labels.shape
    flat = np.ascontiguousarray(labels).reshape(-1)
    begins = np.ones(h * w, bool)
    np.not_equal(flat[1:], flat[:-1], out=begins[1:])
    begins[::w] = True
    start = np.flatnonzero(begins)
    length = np.diff(start, append=h * w)
    seen, which = np.unique(flat[start], return_inverse=True)
    is_region = np.ones(len(seen), bool) if background is None else seen.astype(np.int64) != background
    number = np.where(is_region, np.cumsum(is_region), 0)[which]

    # Where runs of neighbouring rows touch, and where four of them meet in a corner.
    pieces = np.sort(np.concatenate([start[start >= w], start[start < (h - 1) * w] + w]), kind="stable")
    pieces = pieces[np.diff(pieces, prepend=-1) > 0]
    above, below = (np.searchsorted(start, at, "right") - 1 for at in (pieces - w, pieces))
    across = np.diff(pieces, append=h * w)
    inner = np.flatnonzero((start % w > 0) & (start < (h - 1) * w))
    under = np.searchsorted(start, start[inner] + w)
    meet = start[np.minimum(under, len(start) - 1)] == start[inner] + w
    b, d = inner[meet], under[meet]
    corners = np.stack([b - 1, b, d - 1, d], axis=1)
    of_four = number[corners]
    corners = corners[(of_four[:, 0] != of_four[:, 2]) & (of_four[:, 1] != of_four[:, 3])]

    same = number[above] == number[below]
    pairs = np.concatenate([np.stack([above[same], below[same]], axis=1), joined(corners, number, connectivity)])
    component = connected(len(start), pairs)
    count = int(component.max()) + 1
    of_component = np.zeros(count, np.int64)
    of_component[component] = number
    area = np.bincount(component, length, count).astype(np.int64)

    beside = np.flatnonzero(start[1:] % w > 0)
    touching = np.concatenate([np.stack([beside, beside + 1], axis=1), np.stack([above[~same], below[~same]], axis=1)])
    sides = np.concatenate([np.ones(len(beside), np.int64), across[~same]])
    values = np.append(0 if background is None else background, seen[is_region].astype(np.int64))
    return Components(values, of_component, area, start, length, component, component[touching], sides, component[corners])


def joined(corners: Ints, number: Ints, connectivity: int) -> Ints:
    """Return the pairs (p, 2) that are joined through corners of pixels.

    Parameters
    ----------
    corners
        (c, 4) int64, what lies at a, b, c, d around each corner.
    number
        The label of each of these, 0 for the background.
    connectivity
        4 or 8.
    """
    a, b, c, d = number[corners].T
    wanted = np.minimum(a, b) if connectivity == 4 else np.maximum(a, b)
    falling = (a == d) & ((b != c) | (a == wanted))
    rising = (b == c) & ~falling
    return np.concatenate([corners[falling][:, [0, 3]], corners[rising][:, [1, 2]]])


def connected(n: int, pairs: Ints) -> Ints:
    """Return for each of n things the group it is in if pairs (p, 2) hang together; groups are numbered by their first member."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    # Groups are searched from each thing in turn that is in none yet.
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
