"""Periodic pairs are divided alike: stretch by stretch as the finer of both, or with the vertices of both."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from img2tri.errors import Img2triError
from img2tri.shapes.periodic.paired_outlines import find_periodic_pairs
from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

LABELS = np.ones((40, 44), int)
LABELS[11:25], LABELS[25:] = 2, 3


def drafted(periodic, seed=0):
    """Pairs of three stretches, divided at random and differently on both sides, some vertices of them offset."""
    labels = LABELS if periodic == "x" else LABELS.T
    outlines, dual_edges = place_outlines(find_crack_edges(labels, background=None), Frame(labels.shape))
    pairs, d = find_periodic_pairs(outlines, dual_edges, periodic), space_evenly(outlines, dual_edges, spacing=6.0)
    rng = np.random.default_rng(seed)
    ends = np.isin(np.arange(len(d.kept)), [d.outlines.chains.starts[:-1], d.outlines.chains.starts[1:] - 1])
    kept, offset = d.kept.copy(), d.offset.copy()
    for entries in (pairs.one, pairs.other):
        kept[entries] = ends[entries] | (rng.random(len(entries)) < rng.choice([0.1, 0.4]))
        along = np.where(kept[entries] & ~ends[entries], rng.uniform(-0.4, 0.4, len(entries)), 0)
        offset[entries] = along * (1j if periodic == "x" else 1)
    return pairs, replace(d, kept=kept, offset=offset)


@pytest.mark.parametrize("periodic", ["x", "y"])
@pytest.mark.parametrize("seed", range(6))
def test_the_finer_of_two_divisions_is_taken(periodic, seed):
    pairs, d = drafted(periodic, seed)
    made = pairs._matched(d, both=False)
    shared = np.flatnonzero(d.kept[pairs.one] & d.kept[pairs.other])
    assert len(shared) >= 6  # the ends of three stretches
    for a, b in pairwise(shared):
        one, other = pairs.one[a + 1 : b], pairs.other[a + 1 : b]
        finer = other if d.kept[other].sum() > d.kept[one].sum() else one
        for entries in (one, other):
            assert np.array_equal(made.kept[entries], d.kept[finer])
            assert np.array_equal(made.offset[entries], d.offset[finer])
    assert d.kept[pairs.one[shared]].all()
    away = np.setdiff1d(np.arange(len(d.kept)), np.concatenate([pairs.one, pairs.other]))
    assert np.array_equal(made.kept[away], d.kept[away])
    assert np.array_equal(made.offset[away], d.offset[away])


@pytest.mark.parametrize("periodic", ["x", "y"])
@pytest.mark.parametrize("seed", range(6))
def test_or_the_vertices_of_both(periodic, seed):
    pairs, d = drafted(periodic, seed)
    made = pairs._matched(d, both=True)
    expected = d.kept[pairs.one] | d.kept[pairs.other]
    # Where both have a vertex, that of the first side stays.
    offset = np.where(d.kept[pairs.one], d.offset[pairs.one], d.offset[pairs.other])
    for entries in (pairs.one, pairs.other):
        assert np.array_equal(made.kept[entries], expected)
        assert np.array_equal(made.offset[entries], np.where(expected, offset, 0))


def test_a_point_that_goes_back_takes_its_partner_with_it():
    pairs, d = drafted("x", 3)
    inner = np.flatnonzero(d.kept[pairs.other] & ~d.kept[pairs.one])[0]
    snapped = d.snapped.copy()
    snapped[d.outlines.chains.indices[pairs.other[inner]]] = True
    made = pairs._matched(replace(d, snapped=snapped), both=False)
    one, other = pairs.one[inner], pairs.other[inner]
    assert made.snapped[d.outlines.chains.indices[[one, other]]].all()
    assert made.offset[one] == made.offset[other] == d.offset[other]
    assert made.snapped.sum() == 2


def test_pairs_get_the_shorter_of_their_lengths():
    pairs, d = drafted("y")
    lengths = np.random.default_rng(0).uniform(1, 9, len(d.kept))
    shared = pairs.shared(lengths)
    assert np.array_equal(shared[pairs.one], np.minimum(lengths[pairs.one], lengths[pairs.other]))
    assert np.array_equal(shared[pairs.one], shared[pairs.other])
    sides = np.concatenate([pairs.one, pairs.other])
    assert np.array_equal(np.delete(shared, sides), np.delete(lengths, sides))


def test_sides_that_never_agree_are_an_error(monkeypatch):
    pairs, d = drafted("x")
    monkeypatch.setattr(type(pairs), "_agree", lambda *_: False)
    monkeypatch.setattr("img2tri.shapes.periodic.paired_outlines.MOST_MATCHES", 3)
    with pytest.raises(Img2triError, match="opposite sides: expected to be done within 3 rounds"):
        pairs.enforce_tolerance(d, tolerance=0.5)
