"""Twins on opposite sides are divided alike: stretch by stretch as the finer of both, or with the breaks of both."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from img2tri.shapes.periodic import find_twins
from img2tri.shapes.place.placement import place
from img2tri.shapes.simplify.simplification import draft
from img2tri.shapes.trace.crack_edges import find_cracks
from img2tri.types import Frame

LABELS = np.ones((40, 44), int)
LABELS[11:25], LABELS[25:] = 2, 3


def drafted(periodic, seed=0):
    """Twins of three stretches, divided at random and differently on both sides, some breaks of them moved."""
    labels = LABELS if periodic == "x" else LABELS.T
    outlines, links = place(find_cracks(labels, background=None), Frame(labels.shape))
    twins, d = find_twins(outlines, links, periodic), draft(outlines, links, spacing=6.0)
    rng = np.random.default_rng(seed)
    ends = np.isin(np.arange(len(d.breaks)), [d.outlines.starts[:-1], d.outlines.starts[1:] - 1])
    breaks, moved = d.breaks.copy(), d.moved.copy()
    for entries in (twins.one, twins.other):
        breaks[entries] = ends[entries] | (rng.random(len(entries)) < rng.choice([0.1, 0.4]))
        along = np.where(breaks[entries] & ~ends[entries], rng.uniform(-0.4, 0.4, len(entries)), 0)
        moved[entries] = along * (1j if periodic == "x" else 1)
    return twins, replace(d, breaks=breaks, moved=moved)


@pytest.mark.parametrize("periodic", ["x", "y"])
@pytest.mark.parametrize("seed", range(6))
def test_the_finer_of_two_divisions_is_taken(periodic, seed):
    twins, d = drafted(periodic, seed)
    made = twins._matched(d, both=False)
    shared = np.flatnonzero(d.breaks[twins.one] & d.breaks[twins.other])
    assert len(shared) >= 6  # the ends of three stretches
    for a, b in pairwise(shared):
        one, other = twins.one[a + 1 : b], twins.other[a + 1 : b]
        finer = other if d.breaks[other].sum() > d.breaks[one].sum() else one
        for entries in (one, other):
            assert np.array_equal(made.breaks[entries], d.breaks[finer])
            assert np.array_equal(made.moved[entries], d.moved[finer])
    assert d.breaks[twins.one[shared]].all()
    away = np.setdiff1d(np.arange(len(d.breaks)), np.concatenate([twins.one, twins.other]))
    assert np.array_equal(made.breaks[away], d.breaks[away])
    assert np.array_equal(made.moved[away], d.moved[away])


@pytest.mark.parametrize("periodic", ["x", "y"])
@pytest.mark.parametrize("seed", range(6))
def test_or_the_breaks_of_both(periodic, seed):
    twins, d = drafted(periodic, seed)
    made = twins._matched(d, both=True)
    expected = d.breaks[twins.one] | d.breaks[twins.other]
    # Where both have a break, that of the first side stays.
    moved = np.where(d.breaks[twins.one], d.moved[twins.one], d.moved[twins.other])
    for entries in (twins.one, twins.other):
        assert np.array_equal(made.breaks[entries], expected)
        assert np.array_equal(made.moved[entries], np.where(expected, moved, 0))


def test_what_was_known_of_pieces_on_the_sides_is_forgotten():
    twins, d = drafted("x")
    known = replace(d, measured=np.arange(len(d.breaks)), tested=np.arange(len(d.breaks)))
    made = twins._matched(known, both=False)
    sides = np.concatenate([twins.one, twins.other])
    away = np.setdiff1d(np.arange(len(d.breaks)), sides)
    for before, after in ((known.measured, made.measured), (known.tested, made.tested)):
        assert (after[sides] == -1).all()
        assert np.array_equal(after[away], before[away])


def test_a_point_that_goes_back_takes_its_twin_with_it():
    twins, d = drafted("x", 3)
    inner = np.flatnonzero(d.breaks[twins.other] & ~d.breaks[twins.one])[0]
    reset = d.reset.copy()
    reset[d.outlines.indices[twins.other[inner]]] = True
    made = twins._matched(replace(d, reset=reset), both=False)
    one, other = twins.one[inner], twins.other[inner]
    assert made.reset[d.outlines.indices[[one, other]]].all()
    assert made.moved[one] == made.moved[other] == d.moved[other]
    assert made.reset.sum() == 2


def test_twins_get_the_shorter_of_their_lengths():
    twins, d = drafted("y")
    lengths = np.random.default_rng(0).uniform(1, 9, len(d.breaks))
    shared = twins.shared(lengths)
    assert np.array_equal(shared[twins.one], np.minimum(lengths[twins.one], lengths[twins.other]))
    assert np.array_equal(shared[twins.one], shared[twins.other])
    sides = np.concatenate([twins.one, twins.other])
    assert np.array_equal(np.delete(shared, sides), np.delete(lengths, sides))
