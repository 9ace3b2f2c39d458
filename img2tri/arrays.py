"""What all stages share about arrays: their types, the plane as complex numbers, numbers within runs, chains.

Places and vectors of the plane are complex numbers x + iy wherever there is much to compute with them: turning, scaling and shifting
are one operation each. Where they are handed on to users they are rows (n, 2).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import bounded
from img2tri.scipy_kernels import sparse_sorts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Points = NDArray[np.complex128]  # places or vectors of the plane


def as_complex(rows: Floats) -> Points:
    """Turn rows (n, 2) of x and y into complex numbers (n,) x + iy, without a copy where the rows lie side by side.

    Examples
    --------
    >>> as_complex(np.array([[1.0, 2.0], [3.0, 0.0]]))
    array([1.+2.j, 3.+0.j])
    """
    result: Points = np.ascontiguousarray(rows, np.float64).reshape(-1).view(np.complex128)
    return result


def as_rows(z: Points) -> Floats:
    """Turn complex numbers (n,) into rows (n, 2) of x and y, the inverse of `as_complex`.

    Examples
    --------
    >>> as_rows(np.array([1 + 2j, 3]))
    array([[1., 2.],
           [3., 0.]])
    """
    result: Floats = np.ascontiguousarray(z, np.complex128).view(np.float64).reshape(-1, 2)
    return result


def cross(a: Points, b: Points) -> Floats:
    """Cross product of plane vectors written as complex numbers: positive where b points to the left of a.

    Examples
    --------
    >>> cross(np.array([1 + 0j]), np.array([3 + 2j]))
    array([2.])
    """
    result: Floats = a.real * b.imag - a.imag * b.real
    return result


def runs(counts: Ints) -> tuple[Ints, Ints]:
    """Lay out runs of so many items one after the other.

    Parameters
    ----------
    counts
        (r,) integer, the number of items of each run, 0 or more.

    Returns
    -------
    run : (n,) int64
        The run each item belongs to.
    place : (n,) int64
        The number of each item within its run.

    Examples
    --------
    >>> runs(np.array([2, 0, 3]))
    (array([0, 0, 2, 2, 2]), array([0, 1, 0, 1, 2]))
    """
    run = np.arange(len(counts)).repeat(counts)
    return run, np.arange(len(run)) - (counts.cumsum() - counts)[run]


def unique_edges(triangles: Ints) -> tuple[Ints, Ints]:
    r"""Return each edge of a triangle mesh once, and which edges each triangle has.

    Everywhere in img2tri the sides of a triangle are numbered by the corner they begin in, as in VTK and Gmsh::

              2
             / \             side 0 runs from corner 0 to corner 1
      side 2/   \side 1      side 1 runs from corner 1 to corner 2
           /     \           side 2 runs from corner 2 to corner 0
          0-------1
            side 0

    Parameters
    ----------
    triangles
        (m, 3) int64.

    Returns
    -------
    edges : (e, 2) int64
        Lower vertex first, sorted: the order in which values per edge are expected everywhere.
    sides : (m, 3) int64
        The row in `edges` of each side of each triangle.

    Examples
    --------
    >>> edges, sides = unique_edges(np.array([[0, 1, 2], [0, 2, 3]]))
    >>> edges.tolist(), sides.tolist()
    ([[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]], [[0, 3, 1], [1, 4, 2]])
    """
    order, lower, higher = sorted_sides(triangles)
    new = np.ones(len(order), bool)
    new[1:] = (lower[1:] != lower[:-1]) | (higher[1:] != higher[:-1])
    first, sides = new.nonzero()[0], np.empty(len(order), np.int64)
    sides[order] = np.cumsum(new, dtype=lower.dtype) - 1
    edges = np.empty((len(first), 2), np.int64)
    edges[:, 0], edges[:, 1] = lower.take(first), higher.take(first)
    return edges, sides.reshape(triangles.shape)


def sorted_sides(triangles: Ints) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return the order (3 m,) that sorts the sides of triangles by their ends, and the lower and the higher end of each in that order.

    Sides of one edge follow each other, in the order they have in the triangles. All are int32 where that is enough.

    Examples
    --------
    >>> [part.tolist() for part in sorted_sides(np.array([[2, 1, 0]]))]
    [[1, 2, 0], [0, 0, 1], [1, 2, 2]]
    """
    count, n = triangles.size, int(triangles.max(initial=-1)) + 1
    # Half the memory to go through, where numbers are small enough.
    kind = np.int32 if max(n, count) < 2**31 else np.int64
    lower, higher = np.empty((2, len(triangles), 3), kind)
    for block in blocks(len(triangles), 1 << 13):
        start = triangles[block].astype(kind)
        end = start.take([1, 2, 0], axis=1)
        np.minimum(start, end, out=lower[block])
        np.maximum(start, end, out=higher[block])
    # Sides are the entries of a sparse matrix. To store it by rows SciPy counts, and once more to store it by columns: each pass of this
    # radix sort, least significant key first, keeps the order of the one before where keys are equal.
    to_csr, to_csc = sparse_sorts()
    order, (ends, columns_end), (columns, numbers) = np.arange(count, dtype=kind), np.empty((2, n + 1), kind), np.empty((2, count), kind)
    to_csr(n, n, count, higher.ravel(), lower.ravel(), order, ends, columns, numbers)
    to_csc(n, n, ends, columns, numbers, columns_end, higher.ravel(), order)
    return order, np.arange(n, dtype=kind).repeat(np.diff(columns_end)), higher.ravel()


def independent(lower: Ints, higher: Ints, n: int) -> Bools:
    """Choose items of which no two are in conflict: in the order of their numbers, each that is in conflict with none chosen before.

    This greedy maximal independent set is found in rounds: an open item with no open conflict with a lower one is chosen, and those in
    conflict with it are refused.

    Parameters
    ----------
    lower, higher
        (k,) int64, pairs of items in conflict, the lower number first; a pair may come twice.
    n
        Number of items.

    Returns
    -------
    chosen : (n,) bool

    Examples
    --------
    >>> independent(np.array([0, 1, 2]), np.array([1, 2, 3]), 4).tolist()
    [True, False, True, False]
    """
    chosen = np.ones(n, bool)
    # Each round settles at least the pair with the lowest item.
    for _ in bounded("independent set", len(lower) + 1):
        if not len(lower):
            break
        sure = np.ones(n, bool)
        sure[higher] = False
        chosen[higher[sure[lower]]] = False
        open_ = chosen[lower] & chosen[higher]
        lower, higher = lower[open_], higher[open_]
    return chosen


def blocks(count: int, size: int = 1 << 15) -> Iterator[slice]:
    """Cut a large array into blocks that fit the cache: fetching memory for all of it, again and again, takes longer than the work.

    Examples
    --------
    >>> [(block.start, block.stop) for block in blocks(5, 2)]
    [(0, 2), (2, 4), (4, 5)]
    """
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


@dataclass(frozen=True, eq=False)
class ChainIndex:
    """Points joined to chains: open ones between two nodes, and rings.

    ::

        open  N a b c M         ring  a b c d a        one after the other in `indices`, each from `starts[i]` on

    Attributes
    ----------
    indices
        (k,) int64, the points of all chains one after the other, ends included. A ring repeats its first point. A place in
        this array is an *entry*: a node has one in each chain that ends there, a ring's first point two.
    starts
        (c + 1,) int64: chain i is ``indices[starts[i]:starts[i + 1]]``.
    rings
        (c,) bool, the chains that are rings. An open chain may begin and end at one node.
    """

    indices: Ints
    starts: Ints
    rings: Bools

    @cached_property
    def chain(self) -> Ints:
        """(k,) the chain of each entry."""
        return np.repeat(np.arange(len(self.rings)), np.diff(self.starts))

    @property
    def first(self) -> Ints:
        """(c,) the first entry of each chain."""
        return self.starts[:-1]

    @property
    def last(self) -> Ints:
        """(c,) the last entry of each chain."""
        return self.starts[1:] - 1

    @property
    def ends(self) -> tuple[Ints, Ints]:
        """First and last point of each chain; the same for a ring."""
        return self.indices[self.first], self.indices[self.last]

    @property
    def ring_ends(self) -> tuple[Ints, Ints]:
        """First and last entry of each ring: two entries of one point."""
        return self.first[self.rings], self.last[self.rings]

    @property
    def heads(self) -> Ints:
        """(s,) the entries that another one follows in their chain: the first entry of each segment."""
        followed = np.ones(len(self.indices), bool)
        followed[self.last] = False
        return followed.nonzero()[0]


def label_changes(flat: NDArray[Any], shift: int) -> Ints:
    """Return all i with ``flat[i] != flat[i + shift]``, comparing eight bytes at a time.

    Examples
    --------
    >>> label_changes(np.array([5, 5, 7, 7, 7], np.uint8), 1)
    array([1])
    """
    n, size = len(flat) - shift, flat.itemsize
    if n <= 0:
        return np.zeros(0, np.int64)
    words, per_word = n * size // 8, 8 // size
    here = np.frombuffer(flat, np.uint64, words)
    there = np.frombuffer(flat, np.uint64, words, offset=shift * size)
    differ = (here != there).nonzero()[0]
    # Of these words, which of the values in each; then the last few values, which fill no word.
    which, of_word = np.divmod(((here[differ] ^ there[differ]).view(f"u{size}") != 0).nonzero()[0], per_word)
    rest = words * per_word
    return np.concatenate([differ[which] * per_word + of_word, rest + (flat[rest:n] != flat[rest + shift :]).nonzero()[0]])


def neighbour_changes(values: NDArray[Any]) -> tuple[Ints, Ints]:
    """Return the flat places of the pixels of an image (h, w) that differ from the one right of them, and from the one below.

    Examples
    --------
    >>> [places.tolist() for places in neighbour_changes(np.array([[1, 1, 2], [1, 3, 2]]))]
    [[1, 3, 4], [1]]
    """
    flat, w = np.ascontiguousarray(values).reshape(-1), values.shape[1]
    right = label_changes(flat, 1)
    return right[right % w != w - 1], label_changes(flat, w)
