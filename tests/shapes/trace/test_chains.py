"""Chains against walking by hand: every item once, each after the one before it, rings cut open at their lowest item."""

from __future__ import annotations

import numpy as np
import pytest
import specimens
from hypothesis import given
from hypothesis import strategies as st
from strategies import QUICK

from img2tri.shapes.trace.chains import follow, trace_chains
from img2tri.shapes.trace.crack_edges import NODE, find_crack_edges


@st.composite
def successors(draw):
    """RegionRings of all lengths, some of them cut."""
    n = draw(st.integers(0, 40))
    after = np.array(draw(st.permutations(range(n))), np.int64)
    cut = np.array(draw(st.lists(st.booleans(), min_size=n, max_size=n)), bool)
    return np.where(cut, NODE, after) if draw(st.booleans()) else after


def chains_by_hand(successor):
    """The same chains as a set of (items, whether it is a ring)."""
    after = successor.tolist()
    waiting, found = set(range(len(after))), set()
    for ring in (False, True):
        for begin in sorted(waiting if ring else waiting - set(after)):
            if begin not in waiting:
                continue
            items = [begin]
            while after[items[-1]] not in (NODE, begin):
                items.append(after[items[-1]])
            waiting -= set(items)
            found.add((tuple(items), ring))
    return found


def as_set(chains):
    parts = np.split(chains.order, chains.starts[1:-1]) if len(chains.closed) else []
    return {(tuple(part.tolist()), bool(ring)) for part, ring in zip(parts, chains.closed, strict=True)}


def check(successor):
    kept = successor.copy()
    chains = follow(successor)
    assert np.array_equal(successor, kept)
    assert as_set(chains) == chains_by_hand(successor)
    assert len(as_set(chains)) == len(chains.closed)
    n = len(successor)
    assert np.array_equal(np.sort(chains.order), np.arange(n))
    assert chains.order.dtype == chains.starts.dtype == np.int64
    assert (chains.starts[0], chains.starts[-1]) == (0, n)
    assert (np.diff(chains.starts) > 0).all()
    assert np.array_equal(chains.sequence, np.searchsorted(chains.starts[1:], np.arange(n), side="right"))


@QUICK
@given(successors())
def test_any_successors(successor):
    check(successor)


@pytest.mark.parametrize("n", [1, 2, 3, 1000])
def test_one_ring_one_chain_and_single_items(n):
    ring = np.roll(np.arange(n), -1)
    check(ring)
    check(ring[::-1].copy())
    check(np.append(np.arange(1, n), NODE))
    check(np.full(n, NODE))
    check(np.arange(n))  # each item is its own ring
    check(np.random.default_rng(n).permutation(n))


def test_nothing_has_no_chains():
    chains = follow(np.zeros(0, np.int64))
    assert len(chains.order) == len(chains.closed) == len(chains.sequence) == 0
    assert chains.starts.tolist() == [0]


def test_long_chains_and_many_short_ones_are_walked_all_the_same():
    n = 300_000
    order = np.random.default_rng(0).permutation(n)
    after = np.empty(n, np.int64)
    after[order] = np.roll(order, -1)
    chains = follow(after)
    assert chains.order[0] == 0
    assert np.array_equal(after[chains.order], np.roll(chains.order, -1))
    many = follow(np.arange(n).reshape(-1, 4)[:, [1, 2, 3, 0]].ravel())
    assert len(many.closed) == n // 4
    assert many.closed.all()
    assert np.array_equal(many.order, np.arange(n))


@pytest.mark.parametrize("name", specimens.ALL)
def test_crack_edges_are_traced_head_to_tail(name):
    crack_edges = find_crack_edges(specimens.ALL[name], background=None)
    chains = trace_chains(crack_edges)
    inside = np.ones(len(chains.order), bool)
    inside[chains.starts[1:] - 1] = False
    at = np.flatnonzero(inside)
    assert np.array_equal(crack_edges.head[chains.order[at]], crack_edges.tail[chains.order[at + 1]])
    first, last = chains.order[chains.starts[:-1]], chains.order[chains.starts[1:] - 1]
    assert np.array_equal(crack_edges.successor[last], np.where(chains.closed, first, NODE))
    for beside in (crack_edges.left, crack_edges.right, crack_edges.on_frame):
        assert np.array_equal(beside[chains.order], beside[first][chains.sequence])
