"""What the places of points may be: dual_edges, chains through them, cuts; all in frames of any spacing and direction."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import specimens

from img2tri.shapes.trace.crack_edges import cut_chains, find_crack_edges
from img2tri.shapes.trace.dual_edges import BOUND, lay_out, pixel_areas, pixels_beside
from img2tri.types import Frame

FRAMES = {
    "plain": {},
    "y down": {"upward": False},
    "wide pixels": {"spacing": (2.0, 1.0)},
    "high pixels, elsewhere": {"spacing": (0.5, 1.25), "corner": (100.0, -7.0)},
    "wide pixels, y down": {"spacing": (3.0, 2.0), "upward": False},
}


def laid_out(labels, background=0, connectivity=4, **frame):
    frame = Frame(labels.shape, **frame)
    crack_edges = find_crack_edges(labels, background=background, upward=frame.upward, connectivity=connectivity)
    return lay_out(crack_edges, frame), crack_edges, frame


def in_image(z, frame):
    """Row and column of points of the plane."""
    return frame.row_column(frame.world(np.stack([z.real, z.imag], axis=1)))


def sizes(frame):
    return np.array(frame.spacing) / frame.pixel


@pytest.mark.parametrize("name", specimens.ALL)
@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_every_crossing_lies_on_its_dual_edge_and_every_node_on_its_corner(name, frame):
    labels = specimens.ALL[name]
    dual_edges, crack_edges, frame = laid_out(labels, None, **frame)
    n, (h, w) = len(crack_edges.tail), labels.shape
    assert np.array_equal(np.sort(dual_edges.crossed), np.arange(n))

    def corners(number):
        return np.array(np.divmod(number, w + 1), float)

    middle, heads = (
        (corners(crack_edges.tail) + corners(crack_edges.head))[:, dual_edges.crossed] / 2,
        corners(crack_edges.head)[:, dual_edges.crossed],
    )
    np.testing.assert_allclose(in_image(dual_edges.middle[:n], frame), middle, atol=1e-9)
    np.testing.assert_allclose(in_image(dual_edges.corner_after, frame), heads, atol=1e-9)
    np.testing.assert_allclose(in_image(dual_edges.middle[n:], frame), corners(dual_edges.node_corner), atol=1e-9)

    # Inside the image a dual edge joins two pixel centres, its own regions beside it.
    inner = np.flatnonzero(dual_edges.vector)
    assert np.array_equal(np.sort(dual_edges.crossed[inner]), np.flatnonzero(~crack_edges.on_frame))
    for sign, beside in ((1, crack_edges.left), (-1, crack_edges.right)):
        r, c = in_image(dual_edges.middle[inner] + sign * dual_edges.vector[inner] / 2, frame)
        np.testing.assert_allclose([r % 1, c % 1], 0.5, atol=1e-9)
        assert np.array_equal(crack_edges.labels[beside[dual_edges.crossed[inner]]], labels[r.astype(int), c.astype(int)])

    # Crossings have no room but along their dual_edges; nodes have their block, if that is in the image.
    assert (dual_edges.bounds[:n] == 0).all()
    r, c = np.divmod(dual_edges.node_corner, w + 1)
    inside = (r > 0) & (r < h) & (c > 0) & (c < w)
    np.testing.assert_allclose(dual_edges.bounds[n:], np.where(inside, BOUND * complex(*sizes(frame)), 0))
    assert dual_edges.pixel == complex(*sizes(frame))


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("name", specimens.ALL)
def test_chains_run_from_node_to_node_or_are_rings(name, connectivity):
    labels = specimens.ALL[name]
    dual_edges, crack_edges, _ = laid_out(labels, None, connectivity)
    n, used = len(crack_edges.tail), np.zeros(len(dual_edges.middle), int)
    assert (dual_edges.chains.starts[0], dual_edges.chains.starts[-1]) == (0, len(dual_edges.chains.indices))
    for ring, (begin, end) in zip(dual_edges.chains.rings, pairwise(dual_edges.chains.starts), strict=True):
        items = dual_edges.chains.indices[begin:end]
        assert (items[0] == items[-1]) == ring or items[0] >= n
        between = items[:-1] if ring else items[1:-1]
        assert (between < n).all()
        used[between] += 1
        if not ring:
            assert (items[[0, -1]] >= n).all()
        # From one crossing to the next it is straight on to the next side, or round a corner; and half a side to a node.
        steps = np.abs(np.diff(dual_edges.middle[items]))
        if not ring:
            assert steps[[0, -1]].tolist() == [0.5, 0.5]
            steps = steps[1:-1]
        assert np.isclose(steps[:, None], (2**-0.5, 1)).any(axis=1).all()
    assert (used[:n] == 1).all()
    assert np.array_equal(np.unique(dual_edges.chains.indices), np.arange(len(dual_edges.middle)))
    assert np.array_equal(dual_edges.chains.chain, np.repeat(np.arange(len(dual_edges.chains.rings)), np.diff(dual_edges.chains.starts)))
    first, last = dual_edges.chains.ends
    assert np.array_equal(first, dual_edges.chains.indices[dual_edges.chains.starts[:-1]])
    assert np.array_equal(last, dual_edges.chains.indices[dual_edges.chains.starts[1:] - 1])
    left, right = dual_edges.regions
    crossings = dual_edges.chains.indices < n
    for chain, point in zip(dual_edges.chains.chain[crossings].tolist(), dual_edges.chains.indices[crossings].tolist(), strict=True):
        assert (left[chain], right[chain]) == (crack_edges.left[dual_edges.crossed[point]], crack_edges.right[dual_edges.crossed[point]])


@pytest.mark.parametrize("name", specimens.ALL)
@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_areas_of_regions_are_those_of_their_pixels(name, frame):
    labels = specimens.ALL[name]
    for background in (0, None):
        dual_edges, crack_edges, placed = laid_out(labels, background, **frame)
        expected = [(labels == value).sum() * sizes(placed).prod() for value in crack_edges.labels[1:]]
        np.testing.assert_allclose(pixel_areas(dual_edges)[1:], expected, rtol=1e-12)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_pixels_beside_the_outlines(frame):
    labels = specimens.polycrystal(20, 5) - 1
    dual_edges, crack_edges, placed = laid_out(labels, **frame)
    centres, regions = pixels_beside(dual_edges)
    r, c = (v.astype(int) for v in placed.row_column(placed.world(centres)))
    assert np.array_equal(np.where(regions == 0, 0, crack_edges.labels[regions]), labels[r, c])
    at_an_edge = np.zeros(labels.shape, bool)
    for a, b in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        differ = labels[a] != labels[b]
        at_an_edge[a] |= differ
        at_an_edge[b] |= differ
    touched = np.zeros(labels.shape, bool)
    touched[r, c] = True
    assert np.array_equal(touched, at_an_edge)


def test_a_cut_makes_a_node_and_leaves_all_else():
    labels = specimens.disc(20, 6)
    dual_edges, crack_edges, frame = laid_out(labels)
    assert dual_edges.chains.rings.tolist() == [True]
    assert not dual_edges.is_corner.any()
    kept = crack_edges.successor.copy()
    one = lay_out(cut_chains(dual_edges.crack_edges, dual_edges.crossed[[5]]), frame)
    assert one.chains.rings.tolist() == [False]
    assert one.node_corner.tolist() == [crack_edges.head[dual_edges.crossed[5]]]
    assert np.array_equal(one.chains.ends[0], one.chains.ends[1])  # the chain begins and ends in the same node
    assert one.is_corner.sum() == 1
    three = lay_out(cut_chains(dual_edges.crack_edges, dual_edges.crossed[[5, 11, 20]]), frame)
    assert three.chains.rings.tolist() == [False] * 3
    assert three.is_corner.sum() == 3
    assert sorted(three.node_corner.tolist()) == sorted(crack_edges.head[dual_edges.crossed[[5, 11, 20]]].tolist())
    for other in (one, three):
        n = len(crack_edges.tail)
        assert np.array_equal(np.sort_complex(other.middle[:n]), np.sort_complex(dual_edges.middle[:n]))
        np.testing.assert_allclose(pixel_areas(other), pixel_areas(dual_edges))
    assert np.array_equal(crack_edges.successor, kept)


def test_junctions_and_places_on_the_frame_are_no_corners():
    labels = specimens.LABELS["three meet"]
    dual_edges, _, _ = laid_out(labels)
    ends = np.bincount(np.concatenate(dual_edges.chains.ends), minlength=len(dual_edges.middle))
    place = dict(zip(dual_edges.middle[len(dual_edges.crossed) :].tolist(), dual_edges.is_corner[len(dual_edges.crossed) :], strict=True))
    assert not place[2 + 2j]  # where the three regions meet
    assert not place[2 + 4j]  # where the upper two reach the frame
    assert place[4 + 4j]  # a corner of the image
    assert set(ends[len(dual_edges.crossed) :].tolist()) == {2, 3}


def test_where_nothing_is_meshed_there_are_no_dual_edges():
    dual_edges, _, _ = laid_out(np.zeros((3, 4), int))
    assert len(dual_edges.crossed) == len(dual_edges.middle) == len(dual_edges.chains.indices) == 0
    assert dual_edges.chains.starts.tolist() == [0]
    assert pixels_beside(dual_edges)[0].shape == (0, 2)
    assert pixel_areas(dual_edges).tolist() == [0]
