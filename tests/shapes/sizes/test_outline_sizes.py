"""Lengths wanted along outlines: how thick regions are, how much outlines turn, and how fast lengths may grow along them."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import specimens
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from img2tri.arrays import ChainIndex
from img2tri.shapes.sizes.outline_sizes import ROOM_TO_EVEN, arc_lengths, by_chords, by_curvature, by_thickness, limit_growth
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import lay_out
from img2tri.types import Frame

LONGEST = 12.0


def laid_out(labels, background=0):
    """The chains of a label map, and the places of their entries: the middles of crack edges."""
    frame = Frame(labels.shape)
    dual_edges = lay_out(find_crack_edges(labels, background=background, upward=True, connectivity=4), frame)
    return dual_edges, dual_edges.middle[dual_edges.chains.indices]


def least_of_all(size, z, dual_edges, gradation):
    """The least, over all points of the network, of the length there and what is grown on the shortest way from there."""
    n = len(dual_edges.middle)
    own = np.full(n, np.inf)
    np.minimum.at(own, dual_edges.chains.indices, size)
    inner = np.flatnonzero(dual_edges.chains.chain[:-1] == dual_edges.chains.chain[1:])
    one, other, way = dual_edges.chains.indices[inner], dual_edges.chains.indices[inner + 1], gradation * abs(z[inner + 1] - z[inner])
    rows, columns = np.concatenate([np.full(n, n), one, other]), np.concatenate([np.arange(n), other, one])
    network = coo_array((np.concatenate([own, way, way]), (rows, columns)), shape=(n + 1, n + 1)).tocsr()
    return dijkstra(network, indices=n)[dual_edges.chains.indices]


@pytest.mark.parametrize("gradation", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("labels", [specimens.disc(), specimens.disc(40, 18) - specimens.disc(40, 6)])
def test_along_rings_lengths_grow_no_faster_than_the_gradation(labels, gradation):
    dual_edges, z = laid_out(labels)
    size = np.random.default_rng(0).uniform(1, 20, len(z))
    given = size.copy()
    np.testing.assert_allclose(
        limit_growth(size, z, dual_edges.chains, gradation), least_of_all(size, z, dual_edges, gradation), rtol=1e-12
    )
    assert (size == given).all()


@pytest.mark.parametrize("seed", range(3))
def test_growth_goes_on_where_chains_meet(seed):
    dual_edges, z = laid_out(specimens.polycrystal(64, 12, seed), None)
    size = np.random.default_rng(seed).uniform(3, 30, len(z))
    size[np.random.default_rng(seed).integers(len(z), size=3)] = 1
    # So steep that no length is felt beyond two junctions.
    np.testing.assert_allclose(limit_growth(size, z, dual_edges.chains, 0.5), least_of_all(size, z, dual_edges, 0.5), rtol=1e-12)


def test_arcs_are_lengths_from_the_start_of_each_chain():
    dual_edges, z = laid_out(specimens.polycrystal(30, 6), None)
    expected = [np.concatenate([[0], np.cumsum(abs(np.diff(z[a:b])))]) for a, b in pairwise(dual_edges.chains.starts)]
    np.testing.assert_allclose(arc_lengths(z, dual_edges.chains), np.concatenate(expected), atol=1e-9)


def inner(z, dual_edges, low, high):
    """Entries that are no ends of chains, with x between two values."""
    at = np.arange(1, len(z) - 1)
    at = at[
        (dual_edges.chains.chain[at - 1] == dual_edges.chains.chain[at]) & (dual_edges.chains.chain[at + 1] == dual_edges.chains.chain[at])
    ]
    return at[(z.real[at] > low) & (z.real[at] < high)]


@pytest.mark.parametrize("thick", [3, 6, 15])
@pytest.mark.parametrize("elements", [1, 3])
def test_across_a_bar_there_is_room_for_the_elements_asked_for(thick, elements):
    labels = np.zeros((40, 100), int)
    labels[10 : 10 + thick, 5:95] = 1
    dual_edges, z = laid_out(labels)
    size = by_thickness(z, dual_edges, LONGEST, elements)
    along = inner(z, dual_edges, 30, 70)
    measured = along[along % 3 == 0]
    np.testing.assert_allclose(size[measured], min(LONGEST, thick / elements), rtol=1e-9)
    # Between the points it is measured at, nothing is asked for.
    assert (size[np.setdiff1d(along, measured)] == LONGEST).all()
    assert size.max() == LONGEST


def test_what_is_no_region_may_be_thin():
    labels = np.zeros((60, 100), int)
    labels[5:25, 5:95] = labels[29:55, 5:95] = 1
    for background, thin in ((0, np.inf), (None, 4)):
        dual_edges, z = laid_out(labels, background)
        size = by_thickness(z, dual_edges, LONGEST, 4)
        on_slit = inner(z, dual_edges, 30, 70)
        on_slit = on_slit[(on_slit % 3 == 0) & np.isin(z.imag[on_slit], (31, 35))]
        assert len(on_slit) > 10
        beside = np.minimum(thin, np.where(z.imag[on_slit] == 35, 20, 26)) / 4
        np.testing.assert_allclose(size[on_slit], beside, rtol=1e-9)


def test_of_neighbours_the_thinner_one_counts():
    labels = np.ones((60, 100), int)
    labels[20:26], labels[26:] = 2, 3
    dual_edges, z = laid_out(labels)
    size = by_thickness(z, dual_edges, LONGEST, 2)
    at = inner(z, dual_edges, 30, 70)
    at = at[(at % 3 == 0) & np.isin(z.imag[at], (34, 40))]
    assert len(at) > 20
    np.testing.assert_allclose(size[at], 3, rtol=1e-9)


@pytest.mark.parametrize("radius", [8.0, 14.0])
def test_a_disc_is_as_thick_as_its_diameter_and_turns_once(radius):
    dual_edges, z = laid_out(specimens.disc(40, radius))
    ring = radius * np.exp(-2j * np.pi * np.arange(len(z)) / (len(z) - 1))  # the disc on its right
    assert (dual_edges.regions[0].tolist(), dual_edges.regions[1].tolist()) == ([0], [1])
    thick = by_thickness(ring, dual_edges, 100.0, 2)
    measured = np.arange(3, len(z) - 1, 3)
    np.testing.assert_allclose(thick[measured], radius, rtol=1e-3)
    size = by_curvature(ring, dual_edges.chains, 100.0, 24)
    np.testing.assert_allclose(size[4:-4], 2 * np.pi * radius / 24, rtol=0.03)
    assert (by_curvature(ring, dual_edges.chains, 1.0, 24) == 1).all()
    np.testing.assert_allclose(by_curvature(ring, dual_edges.chains, 100.0, 48)[4:-4], size[4:-4] / 2)


def test_what_is_straight_asks_for_nothing():
    labels = np.ones((30, 40), int)
    labels[:, 20:] = 2
    dual_edges, z = laid_out(labels)
    chain = np.flatnonzero(z.real == 20)
    assert (by_curvature(z, dual_edges.chains, LONGEST, 360)[chain[4:-4]] == LONGEST).all()


def test_a_corner_asks_for_short_chords_beside_it():
    labels = np.ones((30, 40), int)
    labels[:10, :20] = 2
    dual_edges, z = laid_out(labels)
    size = by_curvature(z, dual_edges.chains, LONGEST, 20)
    near = abs(z - (20 + 20j)) < 1.1
    assert (size[near] < 5).all()
    far = (abs(z - (20 + 20j)) > 6) & (dual_edges.chains.chain == dual_edges.chains.chain[np.flatnonzero(near)[0]])
    assert (size[far] == LONGEST).all()


def bent(radius, turn, side=30.0):
    """A mask's outline whose dense points are put 0.8 px apart on a straight line, an arc, and a straight line, as one open chain."""
    way = np.arange(-side, side + radius * turn, 0.8)
    angle = np.clip(way / radius, 0, turn)
    z = radius * np.exp(1j * (angle - np.pi / 2)) + np.exp(1j * angle) * (way - radius * angle)
    return z, ChainIndex(np.arange(len(z)), np.array([0, len(z)]), np.array([False])), (way > 3) & (way < radius * turn - 3)


@pytest.mark.parametrize("radius", [6.0, 10.0, 40.0])
@pytest.mark.parametrize("side", [1, -1])
def test_an_arc_that_lasts_is_no_corner(radius, side):
    z, chains, on_arc = bent(radius, np.pi)
    z = z if side == 1 else z.conj()
    np.testing.assert_allclose(by_curvature(z, chains, LONGEST, 20, lasting=15)[on_arc], 2 * np.pi * radius / 20, rtol=0.05)


def test_a_corner_that_is_rounded_asks_for_nothing_unless_all_turns_count():
    z, chains, _ = bent(2.0, np.pi / 2)
    assert (by_curvature(z, chains, LONGEST, 20) < 4).any()
    assert (by_curvature(z, chains, LONGEST, 20, lasting=15) == LONGEST).all()


def test_waves_of_the_steps_of_pixels_ask_for_nothing():
    x = np.arange(0, 200, 0.8)
    z, chains = x + 0.3j * np.sin(x / 2), ChainIndex(np.arange(250), np.array([0, 250]), np.array([False]))
    assert (by_curvature(z, chains, LONGEST, 20) < LONGEST).any()
    assert (by_curvature(z, chains, LONGEST, 20, lasting=15) == LONGEST).all()


@pytest.mark.parametrize("start", [0, 7, 31])
def test_a_ring_has_no_beginning(start):
    radius, n = 12.0, 90
    z = np.where(np.arange(n) < 45, 1, 0.5) * radius * np.exp(2j * np.pi * np.arange(n) / n)
    at = np.append((np.arange(n) + start) % n, start)
    size = by_curvature(z[at], ChainIndex(at, np.array([0, n + 1]), np.array([True])), LONGEST, 20, lasting=15)
    first = np.append(np.arange(n), 0)
    expected = by_curvature(z[first], ChainIndex(first, np.array([0, n + 1]), np.array([True])), LONGEST, 20, lasting=15)
    np.testing.assert_allclose(size, expected[at], rtol=1e-12)


def test_chords_that_came_out_short_stay_so():
    places = np.array([0, 1, 2, 3, 10, 11, 12 + 5j, 20])
    made = SimpleNamespace(places=places, chords=(np.array([0, 3, 5]), np.array([3, 5, 6])))
    wanted = np.array([9.0, 9, 2, 9, 9, 9, 9, 9])
    short = ROOM_TO_EVEN * abs(np.array([3, 8, 1 + 5j]))
    expected = [short[0], short[0], 2, short[0], 9, short[2], short[2], 9]
    np.testing.assert_allclose(by_chords(made, wanted), expected)
    assert wanted[0] == 9
