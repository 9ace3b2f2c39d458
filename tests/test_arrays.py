"""What all stages share about arrays."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from img2tri.arrays import ChainIndex, as_complex, as_rows, cross, runs


@given(st.lists(st.integers(0, 5), max_size=12))
def test_runs_are_numbered_one_after_the_other(counts):
    run, place = runs(np.array(counts, np.int64))
    assert list(zip(run.tolist(), place.tolist(), strict=True)) == [(i, j) for i, count in enumerate(counts) for j in range(count)]
    assert run.dtype == place.dtype == np.int64


@pytest.mark.parametrize(
    "rows", [np.zeros((0, 2)), np.arange(8.0).reshape(4, 2), np.asfortranarray([[1.0, -2.0], [3.5, 4.0]]), np.ones((5, 4))[:, ::3]]
)
def test_rows_and_complex_numbers_are_each_others_inverse(rows):
    z = as_complex(rows)
    assert (z.real == rows[:, 0]).all()
    assert (z.imag == rows[:, 1]).all()
    assert np.array_equal(as_rows(z), rows)
    assert np.array_equal(as_rows(z[::2]), rows[::2])


def test_the_cross_product_tells_left_from_right():
    a, b = np.array([1 + 0j, 3 + 4j, 2 + 1j]), np.array([0 + 1j, 3 + 4j, 1 - 1j])
    assert cross(a, b).tolist() == [1, 0, -3]
    assert cross(b, a).tolist() == [-1, 0, 3]


def test_chains_know_their_ends_and_segments():
    # An open chain from node 7 to node 8, a ring, and an open chain that comes back to its node.
    chains = ChainIndex(np.array([7, 0, 1, 8, 2, 3, 4, 2, 8, 5, 6, 8]), np.array([0, 4, 8, 12]), np.array([False, True, False]))
    assert chains.chain.tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert [end.tolist() for end in chains.ends] == [[7, 2, 8], [8, 2, 8]]
    assert [end.tolist() for end in chains.ring_ends] == [[4], [7]]
    assert chains.heads.tolist() == [0, 1, 2, 4, 5, 6, 8, 9, 10]
    assert (chains.first.tolist(), chains.last.tolist()) == ([0, 4, 8], [3, 7, 11])


def test_no_chains_are_chains_too():
    chains = ChainIndex(np.zeros(0, np.int64), np.zeros(1, np.int64), np.zeros(0, bool))
    assert len(chains.chain) == len(chains.heads) == len(chains.ends[0]) == 0
