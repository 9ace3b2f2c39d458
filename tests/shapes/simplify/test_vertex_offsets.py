"""Breaks moved sideways: zigzags go, arcs stay, pieces lean towards their runs, and fewer have to be split."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
import specimens
from benchmarks.shapes import blob

from img2tri.shapes.place.placement import place, place_on_sides
from img2tri.shapes.simplify.area_preservation import area_error
from img2tri.shapes.simplify.simplification import draft
from img2tri.shapes.simplify.tolerance import settle
from img2tri.shapes.simplify.vertex_offsets import FARTHEST, Sideways, cut_off, fitted, lenses, towards_runs
from img2tri.shapes.trace.crack_edges import find_cracks
from img2tri.types import Frame

MASKS = {
    "disc": specimens.disc(100, 40.3, (50.1, 49.8)),
    "ellipse": specimens.ellipse(90, (36.2, 17.7), 33, (45.3, 44.6)),
    "ring": specimens.disc(80, 35.1) - specimens.disc(80, 20.4, (40.3, 39.6)),
    "polycrystal": specimens.polycrystal(),
}


def drafted(labels, spacing, background=0, make=place):
    return draft(*make(find_cracks(labels, background=background), Frame(labels.shape)), spacing=spacing)


def turns(d):
    """Angles (b,) by which the outline turns at the breaks that may move."""
    free, z = Sideways(d), d.places
    return np.angle((z[free.ahead] - z[free.at]) * (z[free.at] - z[free.behind]).conj())


def shaken(d, by):
    """Every other break a little to the right, the ones between to the left."""
    free = Sideways(d)
    return replace(d, moved=free.moved(d.moved, by * (-1.0) ** np.arange(len(free.at)), 10.0))


@pytest.mark.parametrize("name", MASKS)
def test_breaks_that_may_move_have_the_ends_of_their_pieces_beside_them(name):
    d = drafted(MASKS[name], 5.0)
    free, (first, last) = Sideways(d), d.pieces
    pieces = set(zip(first.tolist(), last.tolist(), strict=True))
    starts = dict(zip((d.outlines.starts[1:] - 1).tolist(), d.outlines.starts[:-1].tolist(), strict=True))
    ends = {start: end for end, start in starts.items()}
    rings = {int(start) for start in d.outlines.starts[:-1][d.links.rings]}
    for at, behind, ahead in zip(free.at.tolist(), free.behind.tolist(), free.ahead.tolist(), strict=True):
        assert (at, ahead) in pieces
        assert (behind, ends[at] if at in rings else at) in pieces
    inner = set(first.tolist()) & (set(last.tolist()) | rings)
    assert set(free.at.tolist()) == {i for i in inner if d.links.axis[d.outlines.indices[i]] != 0}


@pytest.mark.parametrize("tolerance", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("name", MASKS)
def test_breaks_stay_near_the_outline_however_far_they_are_sent(name, tolerance):
    d = drafted(MASKS[name], 6.0)
    dense = shapely.union_all(shapely.linestrings(d.outlines.points[d.outlines.segments[0]]))
    for step in (0.3, -5.0, 7.0):
        free = Sideways(d)
        d = replace(d, moved=free.moved(d.moved, np.full(len(free.at), step), tolerance))
        at = d.places[d.breaks]
        assert shapely.distance(dense, shapely.points(at.real, at.imag)).max() <= FARTHEST * tolerance + 1e-9
        first, last = d.outlines.starts[:-1][d.links.rings], d.outlines.starts[1:][d.links.rings] - 1
        assert np.array_equal(d.moved[first], d.moved[last])


def test_what_cannot_move_stays():
    d = drafted(specimens.polycrystal(), 6.0, background=None)
    fixed = d.links.axis[d.outlines.indices] == 0
    assert np.array_equal(fitted(d, tolerance=0.5).moved[fixed], d.moved[fixed])
    on_sides = drafted(MASKS["disc"], 6.0, make=place_on_sides)
    assert np.array_equal(fitted(on_sides, tolerance=0.5).moved, on_sides.moved)


def test_lenses_are_what_lies_between_pieces_and_runs():
    d = fitted(drafted(MASKS["ellipse"], 7.0), tolerance=0.5)
    z, place = d.dense[d.outlines.indices], d.places
    for first, last, lens in zip(*d.pieces, cut_off(d), strict=True):
        lap = np.concatenate([[place[first]], z[first : last + 1], [place[last]]])
        area = np.sum(lap.real * np.roll(lap.imag, -1) - lap.imag * np.roll(lap.real, -1)) / 2
        assert lens == pytest.approx(area, abs=1e-9)
    # What breaks take up is half of the lenses beside them.
    area, width = lenses(d)
    at = np.flatnonzero(d.breaks)[:-1]
    assert area[at].sum() == pytest.approx(2 * cut_off(d).sum())
    assert width[at].sum() == pytest.approx(2 * np.abs(place[d.pieces[1]] - place[d.pieces[0]]).sum())


@pytest.mark.parametrize("spacing", [4.0, 7.0])
def test_zigzags_go_and_arcs_stay(spacing):
    d = drafted(MASKS["disc"], spacing)
    smooth = fitted(d, tolerance=0.5, keep_area=False)
    assert np.abs(smooth.moved - d.moved).max() < 0.06
    rough = shaken(d, 0.2)
    again = fitted(rough, tolerance=0.5, keep_area=False)
    assert np.std(turns(again)) < 0.3 * np.std(turns(rough))


@pytest.mark.parametrize("name", ["disc", "ellipse", "ring"])
def test_to_keep_areas_lenses_are_taken_up(name):
    d = drafted(MASKS[name], 6.0)
    assert area_error(fitted(d, tolerance=0.5)) < 0.3 * area_error(fitted(d, tolerance=0.5, keep_area=False))


def test_a_piece_leans_by_what_it_is_too_far_from_its_run():
    d = drafted(MASKS["disc"], 12.0)
    first, last = (end[3:4] for end in d.pieces)
    middle = (first + last) // 2
    moves = towards_runs(d, first, last, middle, np.array([0.1]), 0.5) - d.moved
    assert np.array_equal(np.flatnonzero(moves), np.concatenate([first, last]))
    outwards = d.dense[d.outlines.indices] - (50.1 + 1j * (100 - 49.8))
    outwards /= np.abs(outwards)
    # Both ends go outwards, and the place between them that is farthest from its run by the excess.
    assert ((moves * outwards.conj()).real[[first, last]] > 0.09).all()
    share = np.abs(d.dense[d.outlines.indices[middle]] - d.places[first]) / np.abs(d.places[last] - d.places[first])
    assert np.abs((1 - share) * moves[first] + share * moves[last]) == pytest.approx(0.1, abs=0.003)


def test_pieces_that_lean_need_not_be_split():
    """On a mask with many small jogs, hardly any piece comes out much shorter than wanted."""
    d = drafted((blob(1024) > 0).astype(int), 8.0)
    for start, most in ((d, 40), (fitted(d, tolerance=0.5), 4)):
        done = settle(start, tolerance=0.5)
        first, last = done.pieces
        short = np.abs(done.places[last] - done.places[first]) < 6
        assert short.sum() <= most


@pytest.mark.parametrize("tolerance", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("name", MASKS)
def test_settling_ends_wherever_breaks_were_moved(name, tolerance):
    """Breaks far from their points lean back, or return: not for ever."""
    d = drafted(MASKS[name], 6.0)
    free = Sideways(d)
    z = d.places
    moved = d.moved.copy()
    moved[free.at] += np.random.default_rng(0).uniform(-0.4, 0.4, len(free.at)) * (z[free.ahead] - z[free.behind]) / 2
    moved[d.outlines.starts[1:] - 1] = moved[d.outlines.starts[:-1]]
    done = settle(replace(d, moved=moved), tolerance=tolerance)
    assert done.breaks.sum() >= d.breaks.sum()
