"""Coarse outlines: within the tolerance of the dense ones, clear of each other, of the same topology."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import oracles
import pytest
import shapely
import specimens
import strategies
from hypothesis import given
from hypothesis import strategies as st
from strategies import QUICK

from img2tri.errors import Img2triError
from img2tri.shapes.place.placement import place_on_pixel_sides, place_outlines
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.simplify import tolerance as tolerance_loop
from img2tri.shapes.simplify.area_preservation import preserve_areas
from img2tri.shapes.simplify.clearance import crowded_chords, sharp_chords
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.tolerance import SHORTEST_CHORD, _in_both, deviations, enforce_tolerance, split_near
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

SURE = 0.5  # px: a tolerance that can be kept anywhere; below it narrow places may need more
LEAST_ANGLE = 50
SMOOTH = {
    "disc": specimens.disc(100, 40.3, (50.1, 49.8)),
    "ellipse": specimens.ellipse(90, (36.2, 17.7), 33, (45.3, 44.6)),
    "ring": specimens.disc(80, 35.1) - specimens.disc(80, 20.4, (40.3, 39.6)),
    "rectangle": np.pad(np.ones((40, 60), int), 5),
    "turned rectangle": specimens.rectangle(80, (50, 33), 27),
}
HARD = {
    "polycrystal": specimens.polycrystal(),
    "noise": np.random.default_rng(0).integers(0, 2, (24, 27)),
    "random labels": np.random.default_rng(1).integers(0, 4, (18, 20)),
}
EVERYTHING = specimens.ALL | SMOOTH | HARD


def drafted(labels, spacing, background=0, on_sides=False, keep_corners=False):
    crack_edges = find_crack_edges(labels, background=background)
    made = place_on_pixel_sides(crack_edges, Frame(labels.shape)) if on_sides else place_outlines(crack_edges, Frame(labels.shape))
    return space_evenly(*made, spacing=spacing, keep_corners=keep_corners)


def settled(labels, spacing=8.0, tolerance=0.5, rounds=0, **options):
    d = enforce_tolerance(drafted(labels, spacing, **options), tolerance=tolerance)
    for _ in range(rounds):
        d = enforce_tolerance(preserve_areas(d, tolerance=tolerance), tolerance=tolerance)
    return d


def distances(d):
    """Two-sided distance (c,) of each coarse chain from its dense one, both sampled densely."""
    dense, coarse = d.outlines, d.coarse()
    result = []
    for i in range(len(dense.left)):
        lines = [shapely.LineString(o.points[o.chains.indices[o.chains.starts[i] : o.chains.starts[i + 1]]]) for o in (dense, coarse)]
        samples = [shapely.points(shapely.get_coordinates(shapely.segmentize(line, 0.2))) for line in lines]
        result.append(max(shapely.distance(samples[k], lines[1 - k]).max() for k in (0, 1)))
    return np.array(result)


def angles_between(outlines):
    """The least angle, in degrees, between chords that meet."""
    segments = outlines.segments[0]
    p, least = outlines.points, 180.0
    heads = np.concatenate([segments, segments[:, ::-1]])
    for at in range(len(p)):
        away = p[heads[heads[:, 0] == at, 1]] - p[at]
        heading = np.sort(np.degrees(np.arctan2(away[:, 1], away[:, 0])))
        if len(heading) > 1:
            least = min(least, np.diff(heading, append=heading[0] + 360).min())
    return least


def check(d, labels, tolerance, background=0):
    """Within the tolerance, no crossings, the ends where they were, the topology of the label map."""
    coarse = d.coarse()
    assert distances(d).max(initial=0) <= max(tolerance, SURE) + 1e-9
    dense = d.outlines
    for end in (0, -1):
        at = [o.chains.indices[o.chains.starts[:-1] if end == 0 else o.chains.starts[1:] - 1] for o in (dense, coarse)]
        offset = np.hypot(*(dense.points[at[0]] - coarse.points[at[1]]).T)
        assert (offset[~d.snapped[at[0]] & ~d.dual_edges.chains.rings] == 0).all()

    lines = shapely.linestrings(coarse.points[coarse.segments[0]])
    i, j = shapely.STRtree(lines).query(lines, predicate="intersects")
    i, j = i[i < j], j[i < j]
    ends = coarse.segments[0]
    joined = (ends[i][:, :, None] == ends[j][:, None, :]).any(axis=(1, 2))
    assert joined.all(), "chords cross"
    assert (shapely.length(shapely.intersection(lines[i], lines[j])) == 0).all(), "chords lie on each other"
    oracles.check_coverage(region_polygons(coarse), labels, None, background=background)


@pytest.mark.parametrize(("tolerance", "rounds"), [(0.1, 0), (0.5, 3), (2.0, 1)])
@pytest.mark.parametrize("name", EVERYTHING)
def test_everything_at_any_tolerance(name, tolerance, rounds):
    labels = EVERYTHING[name]
    for spacing in (2.0, 12.0):
        d = settled(labels, spacing, tolerance, rounds)
        check(d, labels, tolerance)
        assert angles_between(d.coarse()) > LEAST_ANGLE - 1e-6


@pytest.mark.parametrize("name", specimens.LABELS)
def test_without_background_and_along_the_sides_of_pixels(name):
    labels = specimens.LABELS[name]
    check(settled(labels, background=None), labels, 0.5, background=None)
    check(settled(labels, on_sides=True), labels, 0.5)


@QUICK
@given(strategies.maps_and_backgrounds(), st.floats(1, 40), st.floats(0.3, 3), st.integers(0, 2))
def test_any_label_map(case, spacing, tolerance, rounds):
    labels, background = case
    check(settled(labels, spacing, tolerance, rounds, background=background), labels, tolerance, background)


@pytest.mark.parametrize("tolerance", [0.05, 0.1, 0.25, 0.5])
@pytest.mark.parametrize("name", ["disc", "ellipse", "ring", "rectangle"])
def test_where_nothing_is_narrow_any_tolerance_is_kept(name, tolerance):
    for spacing in (2.0, 5.0, 20.0):
        d = settled(SMOOTH[name], spacing, tolerance)
        assert distances(d).max() <= tolerance + 1e-9
        d = settled(SMOOTH[name], spacing, tolerance, rounds=3)
        assert distances(d).max() <= tolerance + 1e-9


@pytest.mark.parametrize("name", EVERYTHING)
def test_what_is_settled_stays_so(name):
    """No chord is crowded or sharp but those that can neither be split nor offset; settling again changes nothing."""
    d = settled(EVERYTHING[name])
    again = enforce_tolerance(d, tolerance=0.5)
    for field in ("kept", "offset", "snapped"):
        assert np.array_equal(getattr(again, field), getattr(d, field))
    first, last = d.chords
    every = np.ones(len(first), bool)
    conflicting = crowded_chords(d, first, last, deviations(d, first, last), every) | sharp_chords(d, first, last, every)
    conflicting |= np.abs(d.places[last] - d.places[first]) < SHORTEST_CHORD
    at = d.outlines.chains.indices
    stuck = (last - first == 1) & d.snapped[at[first]] & d.snapped[at[last]]
    assert not (conflicting & ~stuck).any()


@pytest.mark.parametrize("spacing", [4.0, 10.0, 25.0])
def test_more_tolerance_needs_fewer_chords(spacing):
    counts = [len(settled(SMOOTH["ellipse"], spacing, tolerance).chords[0]) for tolerance in (0.05, 0.2, 0.5, 2.0)]
    assert counts == sorted(counts, reverse=True)
    assert spacing < 5 or counts[0] > counts[-1]


@pytest.mark.parametrize("spacing", [3.0, 6.0, 12.0])
def test_chords_are_as_long_as_wanted(spacing):
    """On a disc so large that the tolerance asks for nothing."""
    first, last = (d := settled(SMOOTH["disc"], spacing, 2.0)).chords
    assert np.abs(d.places[last] - d.places[first]) == pytest.approx(spacing, rel=0.12)


@pytest.mark.parametrize("name", ["polycrystal", "rings", "comb", "noise"])
def test_refining_splits_what_is_near_and_nothing_else(name):
    d = settled(EVERYTHING[name])
    before = set(zip(*(ends.tolist() for ends in d.chords), strict=True))
    place = d.places[d.chords[0][:1]]
    finer = split_near(d, place, within=0.1, tolerance=0.5)
    after = set(zip(*(ends.tolist() for ends in finer.chords), strict=True))
    gone = np.array(sorted(before - after)).reshape(-1, 2)
    for first, last in gone:
        run = d.places[first : last + 1]
        assert np.abs(run - place).min() <= 0.1
        middle = (first + last) // 2
        assert {(first, middle), (middle, last)} <= after
    # What could not be split goes back to the middle of its crack edge.
    back = np.flatnonzero(finer.snapped & ~d.snapped)
    assert len(gone) + len(back) > 0
    for point in back:
        entry = np.flatnonzero(d.outlines.chains.indices == point)[0]
        at = finer.places[entry]
        assert abs(at - finer.dual_edges.middle[point]) <= max(0, abs(d.dense[entry] - finer.dual_edges.middle[point]) - 0.5) + 1e-9
    check(enforce_tolerance(finer, tolerance=0.5), EVERYTHING[name], 0.5)
    far = split_near(d, np.array([-50 + 0j]), within=1.0, tolerance=0.5)
    assert np.array_equal(far.kept, d.kept)
    assert not (far.snapped & ~d.snapped).any()


@pytest.mark.parametrize("name", ["polycrystal", "noise", "ring", "comb"])
def test_refining_everywhere_again_and_again_ends_in_the_middles(name):
    """The safe end of the loop: every crossing a vertex, in the middle of its crack edge as far as half a pixel of tolerance goes."""
    d = settled(EVERYTHING[name])
    for _ in range(12):
        d = enforce_tolerance(split_near(d, d.dense, within=2.0, tolerance=0.5), tolerance=0.5)
    assert d.kept.all()
    assert d.snapped.all()
    np.testing.assert_allclose(d.places, d.dual_edges.blunt_middle[d.outlines.chains.indices], atol=0.25)
    check(d, EVERYTHING[name], 0.5)
    assert angles_between(d.coarse()) > 80


def test_corners_that_are_kept_are_never_blunted():
    """Two squares joined by a bridge of one pixel: its inner corners crowd each other."""
    labels = np.zeros((20, 40), int)
    labels[4:16, 3:15] = labels[4:16, 24:36] = 1
    labels[9, 15:24] = 1
    blunted, sharp = (settled(labels, keep_corners=keep) for keep in (False, True))
    assert sharp.pinned.sum() == sharp.dual_edges.is_corner.sum() > 8
    assert not sharp.snapped[sharp.pinned].any()
    for chosen in (blunted, sharp):
        chosen = split_near(chosen, chosen.dense, within=2.0, tolerance=0.5)
        chosen = enforce_tolerance(split_near(chosen, chosen.dense, within=2.0, tolerance=0.5), tolerance=0.5)
        at_corner = chosen.dual_edges.is_corner[chosen.outlines.chains.indices]
        assert (chosen.offset[at_corner] == 0).all() or chosen.pinned.sum() == 0


def test_a_simplification_is_not_changed():
    d = drafted(HARD["noise"], 8.0)
    names = ("snapped", "kept", "offset", "dense", "pinned")
    before = {name: getattr(d, name).copy() for name in names}
    done = enforce_tolerance(d, tolerance=0.5)
    after = {name: getattr(done, name).copy() for name in names}
    split_near(done, done.dense[:5], within=1.0, tolerance=0.5)
    preserve_areas(done, tolerance=0.5)
    assert all(np.array_equal(getattr(d, name), before[name]) for name in names)
    assert all(np.array_equal(getattr(done, name), after[name]) for name in names)


@pytest.mark.parametrize("name", ["polycrystal", "noise", "ring", "comb"])
def test_what_has_passed_is_not_tested_again_and_the_result_is_the_same(name):
    d = drafted(EVERYTHING[name], 6.0)
    done = enforce_tolerance(d, tolerance=0.5)
    again = drafted(EVERYTHING[name], 6.0)
    first, last = _in_both(again, done)
    assert len(first) > 0
    assert set(zip(first.tolist(), last.tolist(), strict=True)) <= set(zip(*(ends.tolist() for ends in done.chords), strict=True))
    plain, quick = enforce_tolerance(again, tolerance=0.5), enforce_tolerance(again, tolerance=0.5, passed=done)
    for field in ("kept", "offset", "snapped"):
        assert np.array_equal(getattr(quick, field), getattr(plain, field))
    assert len(_in_both(drafted(EVERYTHING[name], 2.0), done)[0]) < len(done.chords[0])
    # Nothing is left to test of what has passed: not even a look is taken at which chords are crowded.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tolerance_loop, "crowded_chords", None)
        assert np.array_equal(enforce_tolerance(done, tolerance=0.5, passed=done).kept, done.kept)
        with pytest.raises(TypeError):
            enforce_tolerance(done, tolerance=0.5)


def test_a_chord_with_another_end_or_another_place_is_new():
    done = settled(SMOOTH["disc"])
    first, last = done.chords
    offset = done.offset.copy()
    offset[last[3]] += 0.01
    kept = _in_both(replace(done, offset=offset), done)
    assert np.array_equal(kept[0], np.delete(first, [3, 4]))
    snapped = done.snapped.copy()
    snapped[done.chains.indices[last[3]]] = True
    assert np.array_equal(_in_both(replace(done, snapped=snapped), done)[1], np.delete(last, [3, 4]))


def test_deviations_are_distances_of_arcs_from_chords():
    d = settled(SMOOTH["ellipse"], 12.0)
    first, last = d.chords
    for one, other, found in zip(first, last, deviations(d, first, last), strict=True):
        line = shapely.LineString([(p.real, p.imag) for p in d.places[[one, other]]])
        arc = d.dense[one + 1 : other]
        expected = shapely.distance(line, shapely.points(arc.real, arc.imag)).max(initial=0)
        assert found == pytest.approx(max(expected, *np.abs(d.offset[[one, other]])), abs=1e-12)


def test_a_loop_without_end_is_an_error(monkeypatch):
    monkeypatch.setattr(tolerance_loop, "MOST_ROUNDS", 1)
    with pytest.raises(Img2triError, match="tolerance of outlines: expected to be done within 1 rounds"):
        settled(HARD["noise"])
