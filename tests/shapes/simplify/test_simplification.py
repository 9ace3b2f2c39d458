"""The first breaks of coarsening: as far apart as wanted, on the outlines, and the outlines they make."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import specimens

from img2tri.shapes.place.placement import place
from img2tri.shapes.simplify.simplification import RING, draft, remembered
from img2tri.shapes.simplify.tolerance import settle
from img2tri.shapes.trace.crack_edges import find_cracks
from img2tri.types import Frame

DISC = specimens.disc(100, 40.3, (50.1, 49.8))


def drafted(labels, background=0, **options):
    outlines, links = place(find_cracks(labels, background=background), Frame(labels.shape))
    return draft(outlines, links, **options)


def lengths(d):
    first, last = d.pieces
    return np.abs(d.places[last] - d.places[first])


@pytest.mark.parametrize("spacing", [2.0, 3.3, 8.0, 20.0])
def test_breaks_are_evenly_apart(spacing):
    d = drafted(DISC, spacing=spacing)
    expected = max(RING, round(2 * np.pi * 40.3 / spacing))
    length = lengths(d)
    assert abs(len(length) - expected) <= 1
    # As chords of the outline, which is a little longer than its circle.
    assert np.ptp(length) < 0.04 * length.mean()
    assert length.mean() == pytest.approx(2 * 40.3 * np.sin(np.pi / len(length)), rel=0.01)


def test_a_spacing_for_each_place():
    plain = drafted(DISC, spacing=6.0)
    x = plain.dense[plain.outlines.indices].real
    wanted = 2 + x / 10
    d = drafted(DISC, spacing=wanted)
    first, last = d.pieces
    middle = (d.places[first].real + d.places[last].real) / 2
    assert lengths(d) == pytest.approx(2 + middle / 10, rel=0.12)
    even = drafted(DISC, spacing=np.full(len(x), 6.0))
    assert np.array_equal(even.breaks, plain.breaks)
    np.testing.assert_allclose(even.moved, plain.moved, atol=1e-9)


@pytest.mark.parametrize("spacing", [0.5, 3.0, 7.0, 1000.0])
@pytest.mark.parametrize("name", specimens.ALL)
def test_any_draft(name, spacing):
    d = drafted(specimens.ALL[name], None, spacing=spacing)
    o = d.outlines
    begin, end = o.starts[:-1], o.starts[1:] - 1
    # Chains keep their ends, where they are; rings keep some points, however far apart they were wanted.
    assert d.breaks[begin].all()
    assert d.breaks[end].all()
    assert (d.moved[begin] == 0).all()
    assert (d.moved[end] == 0).all()
    count = np.bincount(d.links.chain[d.pieces[0]], minlength=len(o.left))
    size = np.diff(o.starts) - 1
    assert (count >= np.where(d.links.rings, np.minimum(RING, size), 1)).all()
    assert (count <= size).all()
    # Every break lies on the outline, at most half way to the next dense point.
    for chain in range(len(o.left)):
        at = np.arange(begin[chain], end[chain] + 1)
        z = d.dense[o.indices[at]]
        line = shapely.LineString(np.stack([z.real, z.imag], axis=1))
        kept = at[d.breaks[at]]
        p = d.places[kept]
        assert shapely.distance(line, shapely.points(p.real, p.imag)).max() < 1e-9
    beside = np.maximum(np.abs(np.diff(d.dense[o.indices], prepend=np.nan)), np.abs(np.diff(d.dense[o.indices], append=np.nan)))
    inner = d.breaks & (d.moved != 0)
    assert (np.abs(d.moved[inner]) <= beside[inner] / 2 + 1e-9).all()
    assert not d.moved[~d.breaks].any()
    assert not d.reset.any()


@pytest.mark.parametrize("name", specimens.ALL)
def test_pieces_join_the_breaks_of_each_chain(name):
    d = drafted(specimens.ALL[name], None, spacing=3.0)
    first, last = d.pieces
    expected = [
        pair for begin, end in pairwise(d.outlines.starts.tolist()) for pair in pairwise(i for i in range(begin, end) if d.breaks[i])
    ]
    assert list(zip(first.tolist(), last.tolist(), strict=True)) == expected


@pytest.mark.parametrize("name", specimens.ALL)
def test_coarse_outlines_run_from_break_to_break(name):
    d = drafted(specimens.ALL[name], None, spacing=3.0)
    coarse, (first, last) = d.coarse(), d.pieces
    segments, left, right = coarse.segments
    z = coarse.points[:, 0] + 1j * coarse.points[:, 1]
    np.testing.assert_array_equal(z[segments], np.stack([d.places[first], d.places[last]], axis=1))
    chain = d.links.chain[first]
    assert np.array_equal(left, d.outlines.left[chain])
    assert np.array_equal(right, d.outlines.right[chain])
    assert np.array_equal(coarse.labels, d.outlines.labels)
    # Each point is there once: nodes are shared, rings closed.
    assert len(np.unique(coarse.points, axis=0)) == len(coarse.points) == len(np.unique(coarse.indices))
    closed = coarse.indices[coarse.starts[:-1]] == coarse.indices[coarse.starts[1:] - 1]
    assert closed[d.links.rings].all()


def test_corners_can_be_kept():
    labels = np.pad(np.ones((20, 30), int), 4)
    assert drafted(labels, spacing=8.0).kept.sum() == 0
    d = drafted(labels, spacing=8.0, keep_corners=True)
    assert d.kept.sum() == 4
    p = d.dense[d.kept]
    assert sorted(zip(p.real.round(9), p.imag.round(9), strict=True)) == [(4, 4), (4, 24), (34, 4), (34, 24)]


def test_what_is_settled_is_not_tested_again():
    d = drafted(specimens.polycrystal(), spacing=6.0)
    settled = settle(d, tolerance=0.5)
    again = remembered(draft(d.outlines, d.links, spacing=6.0), settled)
    first, last = again.pieces
    known = again.tested[first] == last
    assert known.any()
    assert np.array_equal(again.bulge[first[known]], settled.bulge[first[known]])
    plain = settle(draft(d.outlines, d.links, spacing=6.0), tolerance=0.5)
    quick = settle(again, tolerance=0.5)
    for name in ("breaks", "moved", "reset"):
        assert np.array_equal(getattr(quick, name), getattr(plain, name))
    other = remembered(draft(d.outlines, d.links, spacing=2.0), settled)
    assert (other.tested[other.pieces[0]] == other.pieces[1]).sum() < len(other.pieces[0])


def test_a_draft_of_nothing():
    d = drafted(np.zeros((3, 3), int), spacing=4.0)
    assert len(d.pieces[0]) == 0
    assert len(d.coarse().points) == 0
    assert len(settle(d, tolerance=0.5).pieces[0]) == 0
    assert len(replace(d, moved=d.moved).places) == 0
