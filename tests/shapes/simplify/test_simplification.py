"""The first vertices of a simplification: as far apart as wanted, on the outlines, and the outlines they make."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import specimens

from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.simplify.simplification import RING, space_evenly
from img2tri.shapes.simplify.tolerance import enforce_tolerance
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

DISC = specimens.disc(100, 40.3, (50.1, 49.8))


def drafted(labels, background=0, **options):
    outlines, dual_edges = place_outlines(find_crack_edges(labels, background=background), Frame(labels.shape))
    return space_evenly(outlines, dual_edges, **options)


def lengths(d):
    first, last = d.chords
    return np.abs(d.places[last] - d.places[first])


@pytest.mark.parametrize("spacing", [2.0, 3.3, 8.0, 20.0])
def test_vertices_are_evenly_apart(spacing):
    d = drafted(DISC, spacing=spacing)
    expected = max(RING, round(2 * np.pi * 40.3 / spacing))
    length = lengths(d)
    assert abs(len(length) - expected) <= 1
    # As chords of the outline, which is a little longer than its circle.
    assert np.ptp(length) < 0.04 * length.mean()
    assert length.mean() == pytest.approx(2 * 40.3 * np.sin(np.pi / len(length)), rel=0.01)


def test_a_spacing_for_each_place():
    plain = drafted(DISC, spacing=6.0)
    x = plain.dense.real
    wanted = 2 + x / 10
    d = drafted(DISC, spacing=wanted)
    first, last = d.chords
    middle = (d.places[first].real + d.places[last].real) / 2
    assert lengths(d) == pytest.approx(2 + middle / 10, rel=0.12)
    even = drafted(DISC, spacing=np.full(len(x), 6.0))
    assert np.array_equal(even.kept, plain.kept)
    np.testing.assert_allclose(even.offset, plain.offset, atol=1e-9)


@pytest.mark.parametrize("spacing", [0.5, 3.0, 7.0, 1000.0])
@pytest.mark.parametrize("name", specimens.ALL)
def test_evenly_spaced(name, spacing):
    d = drafted(specimens.ALL[name], None, spacing=spacing)
    o = d.outlines
    begin, end = o.chains.starts[:-1], o.chains.starts[1:] - 1
    # Chains keep their ends, where they are; rings keep some points, however far apart they were wanted.
    assert d.kept[begin].all()
    assert d.kept[end].all()
    assert (d.offset[begin] == 0).all()
    assert (d.offset[end] == 0).all()
    count = np.bincount(d.dual_edges.chains.chain[d.chords[0]], minlength=len(o.left))
    size = np.diff(o.chains.starts) - 1
    assert (count >= np.where(d.dual_edges.chains.rings, np.minimum(RING, size), 1)).all()
    assert (count <= size).all()
    # Every vertex lies on the outline, at most half way to the next dense point.
    for chain in range(len(o.left)):
        at = np.arange(begin[chain], end[chain] + 1)
        z = d.dense[at]
        line = shapely.LineString(np.stack([z.real, z.imag], axis=1))
        vertices = at[d.kept[at]]
        p = d.places[vertices]
        assert shapely.distance(line, shapely.points(p.real, p.imag)).max() < 1e-9
    beside = np.maximum(np.abs(np.diff(d.dense, prepend=np.nan)), np.abs(np.diff(d.dense, append=np.nan)))
    inner = d.kept & (d.offset != 0)
    assert (np.abs(d.offset[inner]) <= beside[inner] / 2 + 1e-9).all()
    assert not d.offset[~d.kept].any()
    assert not d.snapped.any()


@pytest.mark.parametrize("name", specimens.ALL)
def test_chords_join_the_vertices_of_each_chain(name):
    d = drafted(specimens.ALL[name], None, spacing=3.0)
    first, last = d.chords
    expected = [
        pair for begin, end in pairwise(d.outlines.chains.starts.tolist()) for pair in pairwise(i for i in range(begin, end) if d.kept[i])
    ]
    assert list(zip(first.tolist(), last.tolist(), strict=True)) == expected


@pytest.mark.parametrize("name", specimens.ALL)
def test_coarse_outlines_arc_from_vertex_to_vertex(name):
    d = drafted(specimens.ALL[name], None, spacing=3.0)
    coarse, (first, last) = d.coarse(), d.chords
    segments, left, right = coarse.segments
    z = coarse.points[:, 0] + 1j * coarse.points[:, 1]
    np.testing.assert_array_equal(z[segments], np.stack([d.places[first], d.places[last]], axis=1))
    chain = d.dual_edges.chains.chain[first]
    assert np.array_equal(left, d.outlines.left[chain])
    assert np.array_equal(right, d.outlines.right[chain])
    assert np.array_equal(coarse.labels, d.outlines.labels)
    # Each point is there once: nodes are shared, rings closed.
    assert len(np.unique(coarse.points, axis=0)) == len(coarse.points) == len(np.unique(coarse.chains.indices))
    closed = coarse.chains.indices[coarse.chains.starts[:-1]] == coarse.chains.indices[coarse.chains.starts[1:] - 1]
    assert closed[d.dual_edges.chains.rings].all()


def test_corners_can_be_kept():
    labels = np.pad(np.ones((20, 30), int), 4)
    assert drafted(labels, spacing=8.0).pinned.sum() == 0
    d = drafted(labels, spacing=8.0, keep_corners=True)
    assert d.pinned.sum() == 4
    p = d.outlines.points[d.pinned]
    assert sorted(map(tuple, p.round(9).tolist())) == [(4, 4), (4, 24), (34, 4), (34, 24)]


def test_a_simplification_of_nothing():
    d = drafted(np.zeros((3, 3), int), spacing=4.0)
    assert len(d.chords[0]) == 0
    assert len(d.coarse().points) == 0
    assert len(enforce_tolerance(d, tolerance=0.5).chords[0]) == 0
    assert len(replace(d, offset=d.offset).places) == 0
