"""Crowded and sharp chords against looking at every pair."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely
import specimens

from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.simplify import clearance
from img2tri.shapes.simplify.clearance import GAP, crowded_chords, sharp_chords, to_segment
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

LEAST_ANGLE = 50
SHAPES = {
    "dent with an island": specimens.MASKS["dent with an island"],
    "comb": specimens.MASKS["comb"],
    "polycrystal": specimens.polycrystal(24, 6),
    "thin cross": specimens.MASKS["thin cross"],
    "spiral": specimens.spiral(2),
    "noise": np.random.default_rng(5).integers(0, 2, (8, 9)),
    "labels": np.random.default_rng(6).integers(0, 4, (6, 7)),
}


def drafted(name, spacing, seed=0):
    """A simplification before anything is split, and deviations made up."""
    labels = SHAPES[name]
    d = space_evenly(*place_outlines(find_crack_edges(labels), Frame(labels.shape)), spacing=spacing)
    deviation = np.random.default_rng(seed).uniform(0, 0.6, len(d.chords[0]))
    return d, deviation


def pairs_by_hand(d, deviation):
    """Pairs of chords that are crowded, and that are sharp."""
    first, last = d.chords
    at, z, chain = d.outlines.chains.indices, d.dense, d.dual_edges.chains.chain
    place = d.places
    lines = shapely.linestrings([[(p.real, p.imag) for p in place[[a, b]]] for a, b in zip(first, last, strict=True)])
    step = np.abs(np.diff(z))
    crowded, sharp = [], []
    for i, j in combinations(range(len(first)), 2):
        ends = [{at[first[k]], at[last[k]]} for k in (i, j)]
        shared = ends[0] & ends[1]
        if not shared:
            distance = lines[i].distance(lines[j])
            way = np.inf
            if chain[first[i]] == chain[first[j]]:
                way = step[last[i] : first[j]].sum()
                if d.dual_edges.chains.rings[chain[first[i]]]:
                    begin, end = d.outlines.chains.starts[chain[first[i]]], d.outlines.chains.starts[chain[first[i]] + 1] - 1
                    way = min(way, step[begin : first[i]].sum() + step[last[j] : end].sum())
            if distance < GAP + deviation[i] + deviation[j] and way > max(4 * distance, 1):
                crowded.append((i, j))
        for point in shared:
            headings = []
            for k in (i, j):
                a, b = (first[k], last[k]) if at[first[k]] == point else (last[k], first[k])
                headings.append(place[b] - place[a])
            if abs(np.degrees(np.angle(headings[0] / headings[1]))) < LEAST_ANGLE:
                sharp.append((i, j))
    return crowded, sharp


def marked(pairs, fresh):
    found = np.zeros(len(fresh), bool)
    for i, j in pairs:
        if fresh[i] or fresh[j]:
            found[[i, j]] = True
    return found


@pytest.mark.parametrize("spacing", [1.5, 4.0, 9.0])
@pytest.mark.parametrize("name", SHAPES)
def test_chords_are_those_found_by_looking_at_every_pair(name, spacing):
    d, deviation = drafted(name, spacing)
    first, last = d.chords
    crowded, sharp = pairs_by_hand(d, deviation)
    rng = np.random.default_rng(1)
    for share in (1.0, 0.5, 0.1, 0.02):
        fresh = rng.random(len(first)) < share
        fresh[rng.integers(len(first))] = True
        assert np.array_equal(crowded_chords(d, first, last, deviation, fresh), marked(crowded, fresh))
        # Others that meet in the same point as a fresh chord may be told as well.
        found = sharp_chords(d, first, last, fresh)
        assert (found >= marked(sharp, fresh)).all()
        assert (found <= marked(sharp, np.ones(len(first), bool))).all()


def test_there_is_something_to_find():
    found = [pairs_by_hand(*drafted(name, 4.0)) for name in SHAPES]
    assert sum(bool(crowded) for crowded, _ in found) >= 4
    assert sum(bool(sharp) for _, sharp in found) >= 3


def test_distance_to_segments():
    rng = np.random.default_rng(0)
    p, a, b = (rng.uniform(-5, 5, 200) + 1j * rng.uniform(-5, 5, 200) for _ in range(3))
    b[:10] = a[:10]  # segments that are a point
    lines = shapely.linestrings(np.stack([np.stack([q.real, q.imag], axis=1) for q in (a, b)], axis=1))
    np.testing.assert_allclose(to_segment(p, a, b), shapely.distance(lines, shapely.points(p.real, p.imag)), atol=1e-12)


def test_where_nothing_is_fresh_nothing_is_sharp():
    d, _ = drafted("noise", 4.0)
    first, last = d.chords
    assert sharp_chords(d, first, last, np.ones(len(first), bool)).any()
    assert not sharp_chords(d, first, last, np.zeros(len(first), bool)).any()


@pytest.mark.parametrize("count", [0, 1, 7, 300])
@pytest.mark.parametrize("longest", [3, 40])
def test_the_pairs_that_are_found_are_those_of_which_all_are_looked_at(count, longest):
    rng = np.random.default_rng(count)
    a = rng.uniform(0, 60, 300) + 1j * rng.uniform(0, 60, 300)
    b = a + rng.exponential(longest, 300) * (rng.random(300) < 0.3) * np.exp(2j * np.pi * rng.uniform(size=300))
    reach, fresh = rng.uniform(0.01, 1, 300), np.arange(300) < count
    pairs = [tuple(sorted(pair)) for pair in np.transpose(clearance._within(a, b, reach, fresh)).tolist()]
    middle, meet = (a + b) / 2, np.ones((300, 300), bool)
    for part in ("real", "imag"):
        half = np.abs(getattr(b - a, part)) / 2 + reach
        meet &= np.abs(getattr(middle[:, None] - middle, part)) <= half[:, None] + half
    i, j = np.nonzero(np.triu(meet & (fresh[:, None] | fresh), 1))
    assert len(set(pairs)) == len(pairs)
    assert set(pairs) == set(zip(i.tolist(), j.tolist(), strict=True))
