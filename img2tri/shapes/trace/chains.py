"""Crack edges -> chains: the order in which the outlines run.

A chain runs from node to node, or is a ring. It is traced once, and shared by the regions on its two sides: whatever
is done to it later is done for both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Ints
from img2tri.shapes.trace.crack_edges import NODE, CrackEdges


@dataclass(frozen=True, eq=False)
class Sequences:
    """Items in the order in which they follow each other.

    Attributes
    ----------
    order
        (n,) int64, all items, sequence after sequence.
    starts
        (c + 1,) int64: sequence i is ``order[starts[i]:starts[i + 1]]``.
    closed
        (c,) bool, the last item of the sequence is followed by its first, which has the lowest number of them.
    """

    order: Ints
    starts: Ints
    closed: Bools

    @property
    def sequence(self) -> Ints:
        """(n,) the sequence each entry of `order` belongs to."""
        return np.repeat(np.arange(len(self.closed)), np.diff(self.starts))


def trace_chains(crack_edges: CrackEdges) -> Sequences:
    """Order the crack edges into chains.

    Examples
    --------
    >>> from img2tri.shapes.trace.crack_edges import find_crack_edges
    >>> trace_chains(find_crack_edges(np.pad([[True]], 1))).starts
    array([0, 4])
    """
    return follow(crack_edges.successor)


def follow(successor: Ints) -> Sequences:
    """Order items into sequences, given the item that follows each, or `NODE` where nothing does.

    Each closed sequence is cut open, all are strung on one long path, and a graph search walks it in linear time.

    Examples
    --------
    >>> follow(np.array([3, 2, 1, NODE])).order
    array([0, 3, 1, 2])
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components, depth_first_order

    n = len(successor)
    if n == 0:
        return Sequences(np.zeros(0, np.int64), np.zeros(1, np.int64), np.zeros(0, bool))
    path = successor.copy()
    has_predecessor = np.zeros(n, bool)
    has_predecessor[path[path != NODE]] = True

    def graph() -> csr_array:
        """Each item, and at most one that follows it: a matrix with at most one entry in a row."""
        follows = path != NODE
        ends = np.concatenate([[0], np.cumsum(follows)])
        return csr_array((np.ones(ends[-1], np.int8), path[follows], ends), shape=(n, n))

    _, sequence = connected_components(graph(), directed=False)
    # Sequences are numbered by their lowest items; an open one begins with the item that follows none.
    begin = np.flatnonzero(np.diff(np.maximum.accumulate(sequence), prepend=-1))
    closed = np.ones(len(begin), bool)
    first = np.flatnonzero(~has_predecessor)
    begin[sequence[first]], closed[sequence[first]] = first, False
    opens = np.zeros(n, bool)
    opens[begin] = True
    last = np.flatnonzero((path == NODE) | opens[path])
    end = np.zeros(len(begin), np.int64)
    end[sequence[last]] = last
    path[end[:-1]] = begin[1:]
    path[end[-1]] = NODE
    order = depth_first_order(graph(), begin[0], return_predecessors=False).astype(np.int64)
    starts = np.append(np.flatnonzero(np.diff(sequence[order], prepend=-1)), n)
    return Sequences(order, starts, closed)
