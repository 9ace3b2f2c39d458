"""Cracks -> chains: the order in which the outlines run.

A chain runs from node to node, or is a ring. It is traced once, and shared by the regions on its two sides: whatever
is done to it later is done for both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.shapes.trace.crack_edges import NODE, Cracks
from img2tri.types import Bools, Ints


@dataclass(frozen=True, eq=False)
class Chains:
    """Items in the order in which they follow each other.

    Attributes
    ----------
    order
        (n,) int64, all items, chain after chain.
    starts
        (c + 1,) int64: chain i is ``order[starts[i]:starts[i + 1]]``.
    rings
        (c,) bool, the chain closes on itself; it starts at its item of the lowest number.
    """

    order: Ints
    starts: Ints
    rings: Bools

    @property
    def chain(self) -> Ints:
        """(n,) the chain each entry of `order` belongs to."""
        return np.repeat(np.arange(len(self.rings)), np.diff(self.starts))


def trace(cracks: Cracks) -> Chains:
    """Order the cracks into chains.

    Examples
    --------
    >>> from img2tri.shapes.trace.crack_edges import find_cracks
    >>> trace(find_cracks(np.pad([[True]], 1))).starts
    array([0, 4])
    """
    return walk(cracks.successor)


def walk(successor: Ints) -> Chains:
    """Order items into chains, given the item that follows each, or `NODE` where nothing does.

    Each ring is cut open, all chains are strung on one long path, and a graph search walks it in linear time.

    Examples
    --------
    >>> walk(np.array([3, 2, 1, NODE])).order
    array([0, 3, 1, 2])
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components, depth_first_order

    n = len(successor)
    if n == 0:
        return Chains(np.zeros(0, np.int64), np.zeros(1, np.int64), np.zeros(0, bool))
    path = successor.copy()
    follows = np.flatnonzero(path != NODE)
    has_predecessor = np.zeros(n, bool)
    has_predecessor[path[follows]] = True

    def graph(sources: Ints, targets: Ints) -> csr_array:
        return csr_array((np.ones(len(sources), np.int8), (sources, targets)), shape=(n, n))

    _, chain = connected_components(graph(follows, path[follows]), directed=False)
    by_chain = np.lexsort((has_predecessor, chain))
    begin = by_chain[np.flatnonzero(np.diff(chain[by_chain], prepend=-1))]
    rings = has_predecessor[begin]
    opens = np.zeros(n, bool)
    opens[begin] = True
    last = np.flatnonzero((path == NODE) | opens[path])
    end = np.zeros(len(begin), np.int64)
    end[chain[last]] = last
    path[end[:-1]] = begin[1:]
    path[end[-1]] = NODE
    follows = np.flatnonzero(path != NODE)
    order = depth_first_order(graph(follows, path[follows]), begin[0], return_predecessors=False).astype(np.int64)
    starts = np.append(np.flatnonzero(np.diff(chain[order], prepend=-1)), n)
    return Chains(order, starts, rings)
