"""Crack edges -> chains: the order in which the outlines run.

A chain runs from node to node, or is a ring. It is traced once, and shared by the regions on its two sides: whatever
is done to it later is done for both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Ints
from img2tri.shapes.trace.crack_edges import NODE, CrackEdges

STEPS = 32  # bits for the number of steps to a goal


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

    By pointer jumping (J. C. Wyllie, "The complexity of parallel computations", 1979): each item knows the best goal within 1, 2, 4, ...
    steps ahead, and how far that is, until it has seen all of its sequence. Best are last items, and in closed sequences the lowest.

    Examples
    --------
    >>> follow(np.array([3, 2, 1, NODE])).order
    array([0, 3, 1, 2])
    """
    n = len(successor)
    if n == 0:
        return Sequences(np.zeros(0, np.int64), np.zeros(1, np.int64), np.zeros(0, bool))
    item, last = np.arange(n), (successor == NODE).nonzero()[0]
    goal, steps = _goals(successor, item, last)

    # Sequences are numbered by their lowest items.
    lowest = np.empty(n, np.int64)
    lowest[goal[::-1]] = item[::-1]
    begin = lowest[goal]
    sequence = (np.cumsum(begin == item) - 1)[begin]
    size = np.bincount(sequence)
    starts, closed = np.concatenate([[0], np.cumsum(size)]), np.ones(len(size), bool)
    closed[sequence[last]] = False
    # A closed sequence begins with its goal, an open one ends with it.
    place = np.where(closed[sequence], -steps, -1 - steps)
    place %= size[sequence]
    place += starts[sequence]
    order = np.empty(n, np.int64)
    order[place] = item
    return Sequences(order, starts, closed)


def _goals(successor: Ints, item: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Return the goal of each item (n,), and the steps to it; `last` are the items that nothing follows."""
    n, jump = len(successor), successor.copy()
    jump[last] = last
    # One number tells both, and the least of two the better goal: the goal, a last item as a negative number, and the steps to it.
    known = item << STEPS
    known[last] -= n << STEPS
    for doublings in range(STEPS):
        farther = known[jump]
        farther += 1 << doublings
        np.minimum(known, farther, out=farther)
        if np.array_equal(farther, known):
            break
        known, jump = farther, jump[jump]
    goal = known >> STEPS
    goal[goal < 0] += n
    known &= (1 << STEPS) - 1
    return goal, known
