"""What the places of points may be: links, chains through them, cuts; all in frames of any spacing and direction."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import specimens

from img2tri.shapes.trace.crack_edges import find_cracks
from img2tri.shapes.trace.dual_edges import REACH, cut, lay_out, pixel_areas, pixels_beside
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
    cracks = find_cracks(labels, background=background, upward=frame.upward, connectivity=connectivity)
    return lay_out(cracks, frame), cracks, frame


def in_image(z, frame):
    """Row and column of points of the plane."""
    return frame.row_column(frame.world(np.stack([z.real, z.imag], axis=1)))


def sizes(frame):
    return np.array(frame.spacing) / frame.pixel


@pytest.mark.parametrize("name", specimens.ALL)
@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_every_crossing_lies_on_its_link_and_every_node_on_its_corner(name, frame):
    labels = specimens.ALL[name]
    links, cracks, frame = laid_out(labels, None, **frame)
    n, (h, w) = len(cracks.tail), labels.shape
    assert np.array_equal(np.sort(links.crack), np.arange(n))

    def corners(number):
        return np.array(np.divmod(number, w + 1), float)

    middle, heads = (corners(cracks.tail) + corners(cracks.head))[:, links.crack] / 2, corners(cracks.head)[:, links.crack]
    np.testing.assert_allclose(in_image(links.middle[:n], frame), middle, atol=1e-9)
    np.testing.assert_allclose(in_image(links.head, frame), heads, atol=1e-9)
    np.testing.assert_allclose(in_image(links.middle[n:], frame), corners(links.node), atol=1e-9)

    # Inside the image a link joins two pixel centres, its own regions beside it.
    inner = np.flatnonzero(links.axis)
    assert np.array_equal(np.sort(links.crack[inner]), np.flatnonzero(~cracks.on_frame))
    for sign, beside in ((1, cracks.left), (-1, cracks.right)):
        r, c = in_image(links.middle[inner] + sign * links.axis[inner] / 2, frame)
        np.testing.assert_allclose([r % 1, c % 1], 0.5, atol=1e-9)
        assert np.array_equal(cracks.labels[beside[links.crack[inner]]], labels[r.astype(int), c.astype(int)])

    # Crossings have no room but along their links; nodes have their block, if that is in the image.
    assert (links.room[:n] == 0).all()
    r, c = np.divmod(links.node, w + 1)
    inside = (r > 0) & (r < h) & (c > 0) & (c < w)
    np.testing.assert_allclose(links.room[n:], np.where(inside, REACH * complex(*sizes(frame)), 0))
    assert links.pixel == complex(*sizes(frame))


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("name", specimens.ALL)
def test_chains_run_from_node_to_node_or_are_rings(name, connectivity):
    labels = specimens.ALL[name]
    links, cracks, _ = laid_out(labels, None, connectivity)
    n, used = len(cracks.tail), np.zeros(len(links.middle), int)
    assert (links.starts[0], links.starts[-1]) == (0, len(links.indices))
    for ring, (begin, end) in zip(links.rings, pairwise(links.starts), strict=True):
        items = links.indices[begin:end]
        assert (items[0] == items[-1]) == ring or items[0] >= n
        between = items[:-1] if ring else items[1:-1]
        assert (between < n).all()
        used[between] += 1
        if not ring:
            assert (items[[0, -1]] >= n).all()
        # From one crossing to the next it is straight on to the next side, or round a corner; and half a side to a node.
        steps = np.abs(np.diff(links.middle[items]))
        if not ring:
            assert steps[[0, -1]].tolist() == [0.5, 0.5]
            steps = steps[1:-1]
        assert np.isclose(steps[:, None], (2**-0.5, 1)).any(axis=1).all()
    assert (used[:n] == 1).all()
    assert np.array_equal(np.unique(links.indices), np.arange(len(links.middle)))
    assert np.array_equal(links.chain, np.repeat(np.arange(len(links.rings)), np.diff(links.starts)))
    first, last = links.ends
    assert np.array_equal(first, links.indices[links.starts[:-1]])
    assert np.array_equal(last, links.indices[links.starts[1:] - 1])
    left, right = links.sides
    crossings = links.indices < n
    for chain, point in zip(links.chain[crossings].tolist(), links.indices[crossings].tolist(), strict=True):
        assert (left[chain], right[chain]) == (cracks.left[links.crack[point]], cracks.right[links.crack[point]])


@pytest.mark.parametrize("name", specimens.ALL)
@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_areas_of_regions_are_those_of_their_pixels(name, frame):
    labels = specimens.ALL[name]
    for background in (0, None):
        links, cracks, placed = laid_out(labels, background, **frame)
        expected = [(labels == value).sum() * sizes(placed).prod() for value in cracks.labels[1:]]
        np.testing.assert_allclose(pixel_areas(links)[1:], expected, rtol=1e-12)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_pixels_beside_the_outlines(frame):
    labels = specimens.polycrystal(20, 5) - 1
    links, cracks, placed = laid_out(labels, **frame)
    centres, regions = pixels_beside(links)
    r, c = (v.astype(int) for v in placed.row_column(placed.world(centres)))
    assert np.array_equal(np.where(regions == 0, 0, cracks.labels[regions]), labels[r, c])
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
    links, cracks, frame = laid_out(labels)
    assert links.rings.tolist() == [True]
    assert not links.corner.any()
    kept = cracks.successor.copy()
    one = cut(links, np.array([5]), frame)
    assert one.rings.tolist() == [False]
    assert one.node.tolist() == [cracks.head[links.crack[5]]]
    assert np.array_equal(one.ends[0], one.ends[1])  # the chain begins and ends in the same node
    assert one.corner.sum() == 1
    three = cut(links, np.array([5, 11, 20]), frame)
    assert three.rings.tolist() == [False] * 3
    assert three.corner.sum() == 3
    assert sorted(three.node.tolist()) == sorted(cracks.head[links.crack[[5, 11, 20]]].tolist())
    for other in (one, three):
        n = len(cracks.tail)
        assert np.array_equal(np.sort_complex(other.middle[:n]), np.sort_complex(links.middle[:n]))
        np.testing.assert_allclose(pixel_areas(other), pixel_areas(links))
    assert np.array_equal(cracks.successor, kept)


def test_junctions_and_places_on_the_frame_are_no_corners():
    labels = specimens.LABELS["three meet"]
    links, _, _ = laid_out(labels)
    ends = np.bincount(np.concatenate(links.ends), minlength=len(links.middle))
    place = dict(zip(links.middle[len(links.crack) :].tolist(), links.corner[len(links.crack) :], strict=True))
    assert not place[2 + 2j]  # where the three regions meet
    assert not place[2 + 4j]  # where the upper two reach the frame
    assert place[4 + 4j]  # a corner of the image
    assert set(ends[len(links.crack) :].tolist()) == {2, 3}


def test_where_nothing_is_meshed_there_are_no_links():
    links, _, _ = laid_out(np.zeros((3, 4), int))
    assert len(links.crack) == len(links.middle) == len(links.indices) == 0
    assert links.starts.tolist() == [0]
    assert pixels_beside(links)[0].shape == (0, 2)
    assert pixel_areas(links).tolist() == [0]
