"""Vertices that slide: wherever a mesh wants them, the outlines stay within the tolerance, clear of each other, of the same topology."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import oracles
import pytest
import shapely
import specimens
from benchmarks.shapes import blob

from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.simplify.area_preservation import preserve_areas
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.tangential_relocation import SLIDE, _distance_to_outline, _nearest, relocate, slide_limits
from img2tri.shapes.simplify.tolerance import SHORTEST_CHORD, enforce_tolerance
from img2tri.shapes.simplify.vertex_offsets import NormalOffsets, offset_vertices
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

MAPS = {
    "disc": specimens.disc(100, 40.3, (50.1, 49.8)),
    "ring": specimens.disc(80, 35.1) - specimens.disc(80, 20.4, (40.3, 39.6)),
    "thin ring": specimens.disc(80, 35.1) - specimens.disc(80, 32.9),
    "polycrystal": specimens.polycrystal(),
    "blob": blob(128).astype(int),
    "noise": np.random.default_rng(0).integers(0, 2, (24, 27)),
}


def settled(labels, spacing=8.0, tolerance=0.5):
    d = space_evenly(*place_outlines(find_crack_edges(labels, background=0), Frame(labels.shape)), spacing=spacing)
    return enforce_tolerance(offset_vertices(d, tolerance=tolerance), tolerance=tolerance)


def chords(d):
    """Points of the coarse outline before and after each (n, 2), itself where there is no or more than one."""
    coarse = d.coarse()
    segments, n = coarse.segments[0], len(coarse.points)
    before, after = np.arange(n), np.arange(n)
    before[segments[:, 1]], after[segments[:, 0]] = segments.T
    return coarse, before, after


def asked(d, share):
    """Every point relocated by a share of its room, parallel to the line between its neighbours."""
    coarse, before, after = chords(d)
    along = coarse.points[after] - coarse.points[before]
    unit = along / np.maximum(np.hypot(*along.T), 1e-12)[:, None]
    return coarse.points + (share * slide_limits(d))[:, None] * unit


def check(d, points, labels, tolerance):
    coarse = replace(d.coarse(), points=points)
    dense = d.outlines
    apart = oracles.two_sided_distance(coarse.points[coarse.segments[0]], dense.points[dense.segments[0]])
    before = d.coarse()
    already = oracles.two_sided_distance(before.points[before.segments[0]], dense.points[dense.segments[0]])
    assert apart <= max(tolerance, already) + 1e-9
    oracles.check_coverage(region_polygons(coarse), labels, None)


@pytest.mark.parametrize("name", MAPS)
def test_room_is_a_share_of_the_shorter_piece_and_nodes_have_none(name):
    d = settled(MAPS[name])
    coarse, before, after = chords(d)
    room = slide_limits(d)
    length = np.minimum(*(np.hypot(*(coarse.points[end] - coarse.points).T) for end in (before, after)))
    assert (room >= 0).all()
    assert (room <= SLIDE * length + 1e-12).all()
    count = np.bincount(coarse.segments[0].ravel(), minlength=len(room))
    assert (room[count != 2] == 0).all()
    begins = coarse.chains.indices[coarse.chains.starts[:-1]]
    assert (room[begins] == 0).all()
    assert (room > 0).any() == bool(len(NormalOffsets(d).at) > len(np.unique(begins)))


def test_vertices_at_which_an_outline_turns_sharply_stay():
    octagon, dodecagon = (settled(specimens.disc(60, 20.3), spacing, tolerance=3.0) for spacing in (20.0, 2 * np.pi * 20.3 / 12))
    assert (len(slide_limits(octagon)), len(slide_limits(dodecagon))) == (8, 12)
    assert (slide_limits(octagon) == 0).all()
    assert (slide_limits(dodecagon) > 0).sum() == 11


@pytest.mark.parametrize("name", ["disc", "blob", "polycrystal"])
def test_vertices_become_those_of_the_dense_points_they_slide_to(name):
    d = settled(MAPS[name], 7.0)
    share = np.random.default_rng(0).uniform(-1, 1, len(d.coarse().points))
    entries, z = d.entries, d.dense
    goes = slide_limits(d) > 0
    places = (asked(d, share) @ [1, 1j])[goes]
    found = _nearest(d, entries[goes], places)
    around = np.clip(found[:, None] + np.arange(-4, 5), 0, len(z) - 1)
    assert (np.abs(places - z[found]) <= np.abs(places[:, None] - z[around]).min(axis=1) + 0.1).all()
    assert (np.diff(found[np.argsort(entries[goes])]) > 0).all()


@pytest.mark.parametrize("shortest", [3.0, 6.0, 7.5])
def test_chords_do_not_get_shorter_than_asked_for(shortest):
    d = settled(MAPS["disc"])
    coarse, room = d.coarse(), slide_limits(d, shortest=shortest)
    start, stop = coarse.segments[0].T
    lengths = np.hypot(*(coarse.points[stop] - coarse.points[start]).T)
    assert (lengths - room[start] - room[stop] >= shortest - 1e-9).all()
    assert (room.max() < slide_limits(d).max()) == (shortest > 0.4 * lengths.min())
    some = room > 0
    shorter = np.full(len(room), np.inf)
    np.minimum.at(shorter, start, lengths)
    np.minimum.at(shorter, stop, lengths)
    assert room[some] == pytest.approx(np.minimum(SLIDE * shorter, (shorter - shortest) / 2)[some])
    assert np.array_equal(slide_limits(d), slide_limits(d, shortest=SHORTEST_CHORD))


@pytest.mark.parametrize("name", MAPS)
def test_what_slides_nowhere_stays_to_the_last_bit(name):
    d = settled(MAPS[name])
    points = d.coarse().points
    assert np.array_equal(relocate(d, points, tolerance=0.5, keep_area=False).coarse().points, points)


@pytest.mark.parametrize("tolerance", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("name", MAPS)
def test_wherever_vertices_slide_the_outlines_keep_their_promises(name, tolerance):
    labels = MAPS[name]
    for seed, spacing in enumerate([3.0, 8.0, 15.0]):
        d = settled(labels, spacing, tolerance)
        share = np.random.default_rng(seed).uniform(-1, 1, len(d.coarse().points))
        for keep_area, wanted in enumerate((asked(d, share), asked(d, np.sign(share)), asked(d, 1.0))):
            check(d, relocate(d, wanted, tolerance=tolerance, keep_area=bool(keep_area)).coarse().points, labels, tolerance)


@pytest.mark.parametrize("name", ["disc", "ring", "blob"])
def test_most_vertices_of_smooth_outlines_get_where_they_are_wanted(name):
    d = settled(MAPS[name], 5.0)
    wanted = asked(d, np.random.default_rng(1).uniform(-1, 1, len(d.coarse().points)))
    found = relocate(d, wanted, tolerance=0.5, keep_area=False).coarse().points
    there = np.hypot(*(found - wanted).T) < 1e-6
    assert there[slide_limits(d) > 0].mean() > 0.9


@pytest.mark.parametrize("off", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("name", ["disc", "ring", "blob"])
def test_how_far_a_place_is_off_its_outline(name, off):
    d = settled(MAPS[name], 7.0)
    rng = np.random.default_rng(0)
    dense = d.outlines.points[d.outlines.segments[0]]
    which = d.entries[slide_limits(d) > 0]
    step = off * np.exp(2j * np.pi * rng.uniform(size=len(which)))
    places = asked(d, 0.2) @ [1, 1j]
    places = places[slide_limits(d) > 0] + step
    found = _distance_to_outline(d, _nearest(d, which, places), places)
    exact = shapely.distance(shapely.multilinestrings(shapely.linestrings(dense)), shapely.points(places.real, places.imag))
    assert (found >= exact - 1e-9).all()
    assert (found <= exact + 0.1).all()


def test_a_vertex_is_not_taken_off_its_outline():
    d = settled(MAPS["disc"], 5.0)
    wanted = d.coarse().points.copy()
    middle = np.array([50.1, 49.8])
    i = int(np.argmax(slide_limits(d)))
    out = (wanted[i] - middle) / np.hypot(*(wanted[i] - middle))
    wanted[i] += 0.7 * out
    assert np.array_equal(relocate(d, wanted, tolerance=0.5, keep_area=False).coarse().points, d.coarse().points)
    wanted[i] -= 0.5 * out
    assert np.allclose(relocate(d, wanted, tolerance=0.5, keep_area=False).coarse().points, wanted, rtol=0, atol=1e-9)


def test_vertices_that_would_leave_a_chord_too_long_for_the_tolerance_go_back():
    d = settled(MAPS["disc"], 11.0)  # chords already as long as the tolerance allows
    share = np.where(np.arange(len(d.coarse().points)) % 2, 2.0, -2.0)
    wanted = asked(d, share)
    found = relocate(d, wanted, tolerance=0.5, keep_area=False).coarse().points
    assert not np.allclose(found, wanted, rtol=0, atol=1e-3)
    check(d, found, MAPS["disc"], 0.5)
    # Some are halfway, others where they were.
    begin = d.coarse().points
    went = np.hypot(*(found - begin).T)[share * slide_limits(d) != 0] / np.hypot(*(wanted - begin).T)[share * slide_limits(d) != 0]
    assert np.isclose(went, 0.5, rtol=0, atol=1e-6).any()
    assert np.isclose(went[:, None], [0, 0.5, 1], rtol=0, atol=1e-6).any(axis=1).all()


@pytest.mark.parametrize("name", ["disc", "ring", "blob", "polycrystal"])
def test_areas_are_kept_if_asked_for(name):
    d = settled(MAPS[name], 5.0)
    d = enforce_tolerance(preserve_areas(d, tolerance=0.5), tolerance=0.5)
    wanted = asked(d, np.random.default_rng(2).uniform(-1, 1, len(d.coarse().points)))

    def error(points):
        after, dense = region_polygons(replace(d.coarse(), points=points)), region_polygons(d.outlines)
        return max(abs(after[region].area / dense[region].area - 1) for region in dense)

    kept, left = (error(relocate(d, wanted, tolerance=0.5, keep_area=keep).coarse().points) for keep in (True, False))
    assert kept < min(2e-3, left)
