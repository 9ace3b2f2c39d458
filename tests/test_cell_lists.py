"""What is near in a grid of cells, against looking at all places."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.cell_lists import cells, in_cells_beside, pairs_across, pairs_beside


@pytest.mark.parametrize("reach", [0.3, 1.0, 4.0, 30.0])
def test_no_place_within_reach_is_left_out_and_none_far_away_is_looked_at(reach):
    rng = np.random.default_rng(0)
    places = rng.uniform(-10, 10, 2000) + 1j * rng.uniform(-5, 15, 2000)
    for count in (1, 20):
        chosen = np.isin(np.arange(2000), rng.choice(2000, count, replace=False))
        away = np.abs(places[:, None] - places[chosen]).min(axis=1)
        found = in_cells_beside(*cells(places, reach), chosen)
        assert found[away <= reach].all()
        assert not found[away > 2 * np.sqrt(2) * reach].any()


@pytest.mark.parametrize("width", [0.7, 3.0, 50.0])
def test_every_pair_nearer_than_a_cell_is_found_once(width):
    rng = np.random.default_rng(1)
    places = rng.uniform(-10, 10, 400) + 1j * rng.uniform(-5, 15, 400)
    cell, above = cells(places, width)
    order = np.argsort(cell)
    near = np.abs(places[:, None] - places) <= width
    pairs = [tuple(sorted(pair)) for pair in np.transpose(pairs_beside(order, cell[order], above)).tolist()]
    assert len(set(pairs)) == len(pairs)
    assert set(zip(*(part.tolist() for part in np.nonzero(np.triu(near, 1))), strict=True)) <= set(pairs)
    own, others = np.arange(100), order[order >= 100]
    pairs = list(map(tuple, np.transpose(pairs_across(own, cell[own], others, cell[others], above)).tolist()))
    assert len(set(pairs)) == len(pairs)
    i, j = np.nonzero(near[:100, 100:])
    assert set(zip(i.tolist(), (j + 100).tolist(), strict=True)) <= set(pairs)


def test_few_places_far_apart_cost_no_more_than_near_ones():
    places = np.array([0, 0.009, 1e6 + 1e6j])
    assert in_cells_beside(*cells(places, 0.01), np.array([True, False, False])).tolist() == [True, True, False]
