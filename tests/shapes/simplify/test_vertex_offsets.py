"""Vertices offset along the normal: zigzags go, arcs stay, chords move towards their arcs, and fewer have to be split."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
import specimens
from benchmarks.shapes import blob

from img2tri.shapes.place.placement import place_on_pixel_sides, place_outlines
from img2tri.shapes.simplify.area_preservation import area_errors
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.tolerance import enforce_tolerance
from img2tri.shapes.simplify.vertex_offsets import (
    CHORD_SHARE,
    MOST_OFFSET,
    NormalOffsets,
    areas_beside,
    chord_arc_areas,
    offset_towards_arcs,
    offset_vertices,
)
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

MASKS = {
    "disc": specimens.disc(100, 40.3, (50.1, 49.8)),
    "ellipse": specimens.ellipse(90, (36.2, 17.7), 33, (45.3, 44.6)),
    "ring": specimens.disc(80, 35.1) - specimens.disc(80, 20.4, (40.3, 39.6)),
    "polycrystal": specimens.polycrystal(),
}


def drafted(labels, spacing, background=0, make=place_outlines):
    return space_evenly(*make(find_crack_edges(labels, background=background), Frame(labels.shape)), spacing=spacing)


def turns(d):
    """Angles (b,) by which the outline turns at the vertices that may move."""
    free, z = NormalOffsets(d), d.places
    return np.angle((z[free.ahead] - z[free.at]) * (z[free.at] - z[free.behind]).conj())


def shaken(d, by):
    """Every other vertex a little to the right, the ones between to the left."""
    free = NormalOffsets(d)
    return replace(d, offset=free.shifted(d.offset, by * (-1.0) ** np.arange(len(free.at)), 10.0))


@pytest.mark.parametrize("name", MASKS)
def test_vertices_that_may_move_have_the_ends_of_their_chords_beside_them(name):
    d = drafted(MASKS[name], 5.0)
    free, (first, last) = NormalOffsets(d), d.chords
    chords = set(zip(first.tolist(), last.tolist(), strict=True))
    starts = dict(zip((d.outlines.chains.starts[1:] - 1).tolist(), d.outlines.chains.starts[:-1].tolist(), strict=True))
    ends = {start: end for end, start in starts.items()}
    rings = {int(start) for start in d.outlines.chains.starts[:-1][d.dual_edges.chains.rings]}
    for at, behind, ahead in zip(free.at.tolist(), free.behind.tolist(), free.ahead.tolist(), strict=True):
        assert (at, ahead) in chords
        assert (behind, ends[at] if at in rings else at) in chords
    inner = set(first.tolist()) & (set(last.tolist()) | rings)
    assert set(free.at.tolist()) == {i for i in inner if d.dual_edges.slides[d.outlines.chains.indices[i]]}


@pytest.mark.parametrize("tolerance", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("name", MASKS)
def test_vertices_stay_near_the_outline_however_far_they_are_sent(name, tolerance):
    d = drafted(MASKS[name], 6.0)
    dense = shapely.union_all(shapely.linestrings(d.outlines.points[d.outlines.segments[0]]))
    for step in (0.3, -5.0, 7.0):
        free = NormalOffsets(d)
        d = replace(d, offset=free.shifted(d.offset, np.full(len(free.at), step), tolerance))
        at = d.places[d.kept]
        assert shapely.distance(dense, shapely.points(at.real, at.imag)).max() <= MOST_OFFSET * tolerance + 1e-9
        first, last = d.outlines.chains.starts[:-1][d.dual_edges.chains.rings], d.outlines.chains.starts[1:][d.dual_edges.chains.rings] - 1
        assert np.array_equal(d.offset[first], d.offset[last])


def test_small_rings_do_not_vanish():
    """The ring around one pixel has four vertices, which smoothing takes for a zigzag, and a great tolerance does not hold them."""
    d = drafted(specimens.MASKS["one pixel"], 6.0)
    first, last = d.chords
    shortest = np.abs(d.places[last] - d.places[first]).min()
    moved = offset_vertices(d, tolerance=2.0, keep_area=False)
    assert 0.1 < np.abs(moved.offset).max() <= CHORD_SHARE * shortest + 1e-9


def test_what_cannot_move_stays():
    d = drafted(specimens.polycrystal(), 6.0, background=None)
    fixed = d.dual_edges.vector[d.outlines.chains.indices] == 0
    assert np.array_equal(offset_vertices(d, tolerance=0.5).offset[fixed], d.offset[fixed])
    on_sides = drafted(MASKS["disc"], 6.0, make=place_on_pixel_sides)
    assert np.array_equal(offset_vertices(on_sides, tolerance=0.5).offset, on_sides.offset)


def test_chord_arc_areas_are_what_lies_between_chords_and_arcs():
    d = offset_vertices(drafted(MASKS["ellipse"], 7.0), tolerance=0.5)
    z, place = d.dense, d.places
    for first, last, lens in zip(*d.chords, chord_arc_areas(d), strict=True):
        lap = np.concatenate([[place[first]], z[first : last + 1], [place[last]]])
        area = np.sum(lap.real * np.roll(lap.imag, -1) - lap.imag * np.roll(lap.real, -1)) / 2
        assert lens == pytest.approx(area, abs=1e-9)
    # What vertices take up is half of the areas beside them.
    area, width = areas_beside(d)
    at = np.flatnonzero(d.kept)[:-1]
    assert area[at].sum() == pytest.approx(2 * chord_arc_areas(d).sum())
    assert width[at].sum() == pytest.approx(2 * np.abs(place[d.chords[1]] - place[d.chords[0]]).sum())


@pytest.mark.parametrize("spacing", [4.0, 7.0])
def test_zigzags_go_and_arcs_stay(spacing):
    d = drafted(MASKS["disc"], spacing)
    smooth = offset_vertices(d, tolerance=0.5, keep_area=False)
    assert np.abs(smooth.offset - d.offset).max() < 0.06
    rough = shaken(d, 0.2)
    again = offset_vertices(rough, tolerance=0.5, keep_area=False)
    assert np.std(turns(again)) < 0.3 * np.std(turns(rough))


@pytest.mark.parametrize("name", ["disc", "ellipse", "ring"])
def test_to_keep_areas_chord_arc_areas_are_taken_up(name):
    d = drafted(MASKS[name], 6.0)
    assert (
        area_errors(offset_vertices(d, tolerance=0.5)).max() < 0.3 * area_errors(offset_vertices(d, tolerance=0.5, keep_area=False)).max()
    )


def test_a_chord_moves_by_what_it_is_too_far_from_its_arc():
    d = drafted(MASKS["disc"], 12.0)
    first, last = (end[3:4] for end in d.chords)
    middle = (first + last) // 2
    moves = offset_towards_arcs(d, first, last, middle, np.array([0.1]), 0.5) - d.offset
    assert np.array_equal(np.flatnonzero(moves), np.concatenate([first, last]))
    outwards = d.dense - (50.1 + 1j * (100 - 49.8))
    outwards /= np.abs(outwards)
    # Both ends go outwards, and the place between them that is farthest from its arc by the excess.
    assert ((moves * outwards.conj()).real[[first, last]] > 0.09).all()
    share = np.abs(d.dense[middle] - d.places[first]) / np.abs(d.places[last] - d.places[first])
    assert np.abs((1 - share) * moves[first] + share * moves[last]) == pytest.approx(0.1, abs=0.003)


def test_chords_that_move_need_not_be_split():
    """On a mask with many small jogs, hardly any chord comes out much shorter than wanted."""
    d = drafted((blob(1024) > 0).astype(int), 8.0)
    for start, most in ((d, 40), (offset_vertices(d, tolerance=0.5), 4)):
        done = enforce_tolerance(start, tolerance=0.5)
        first, last = done.chords
        short = np.abs(done.places[last] - done.places[first]) < 6
        assert short.sum() <= most


@pytest.mark.parametrize("tolerance", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("name", MASKS)
def test_settling_ends_wherever_vertices_were_moved(name, tolerance):
    """Vertices far from their points move back, or return: not for ever."""
    d = drafted(MASKS[name], 6.0)
    free = NormalOffsets(d)
    z = d.places
    offset = d.offset.copy()
    offset[free.at] += np.random.default_rng(0).uniform(-0.4, 0.4, len(free.at)) * (z[free.ahead] - z[free.behind]) / 2
    offset[d.outlines.chains.starts[1:] - 1] = offset[d.outlines.chains.starts[:-1]]
    done = enforce_tolerance(replace(d, offset=offset), tolerance=tolerance)
    assert done.kept.sum() >= d.kept.sum()
