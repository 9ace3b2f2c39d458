"""Coarse outlines: within the tolerance of the dense ones, clear of each other, of the same topology."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
import strategies
from hypothesis import given
from hypothesis import strategies as st
from strategies import QUICK

from img2tri.shapes.place.placement import place, place_on_sides
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.simplify.area_preservation import keep_areas
from img2tri.shapes.simplify.clearance import crowded_pieces, sharp_pieces
from img2tri.shapes.simplify.simplification import draft
from img2tri.shapes.simplify.tolerance import SHORT, refine, settle
from img2tri.shapes.trace.crack_edges import find_cracks
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
    cracks = find_cracks(labels, background=background)
    made = place_on_sides(cracks, Frame(labels.shape)) if on_sides else place(cracks, Frame(labels.shape))
    return draft(*made, spacing=spacing, keep_corners=keep_corners)


def settled(labels, spacing=8.0, tolerance=0.5, rounds=0, **options):
    d = settle(drafted(labels, spacing, **options), tolerance=tolerance)
    for _ in range(rounds):
        d = settle(keep_areas(d, tolerance=tolerance), tolerance=tolerance)
    return d


def distances(d):
    """Two-sided distance (c,) of each coarse chain from its dense one, both sampled densely."""
    dense, coarse = d.outlines, d.coarse()
    result = []
    for i in range(len(dense.left)):
        lines = [shapely.LineString(o.points[o.indices[o.starts[i] : o.starts[i + 1]]]) for o in (dense, coarse)]
        samples = [shapely.points(shapely.get_coordinates(shapely.segmentize(line, 0.2))) for line in lines]
        result.append(max(shapely.distance(samples[k], lines[1 - k]).max() for k in (0, 1)))
    return np.array(result)


def angles_between(outlines):
    """The least angle, in degrees, between pieces that meet."""
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
        at = [o.indices[o.starts[:-1] if end == 0 else o.starts[1:] - 1] for o in (dense, coarse)]
        moved = np.hypot(*(dense.points[at[0]] - coarse.points[at[1]]).T)
        assert (moved[~d.reset[at[0]] & ~d.links.rings] == 0).all()

    lines = shapely.linestrings(coarse.points[coarse.segments[0]])
    i, j = shapely.STRtree(lines).query(lines, predicate="intersects")
    i, j = i[i < j], j[i < j]
    ends = coarse.segments[0]
    joined = (ends[i][:, :, None] == ends[j][:, None, :]).any(axis=(1, 2))
    assert joined.all(), "pieces cross"
    assert (shapely.length(shapely.intersection(lines[i], lines[j])) == 0).all(), "pieces lie on each other"
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
    """No piece is crowded or sharp but those that can neither be split nor moved; settling again changes nothing."""
    d = settled(EVERYTHING[name])
    again = settle(d, tolerance=0.5)
    for field in ("breaks", "moved", "reset"):
        assert np.array_equal(getattr(again, field), getattr(d, field))
    first, last = d.pieces
    every = np.ones(len(first), bool)
    conflicting = crowded_pieces(d, first, last, every) | sharp_pieces(d, first, last, every)
    conflicting |= np.abs(d.places[last] - d.places[first]) < SHORT
    at = d.outlines.indices
    stuck = (last - first == 1) & d.reset[at[first]] & d.reset[at[last]]
    assert not (conflicting & ~stuck).any()


@pytest.mark.parametrize("spacing", [4.0, 10.0, 25.0])
def test_more_tolerance_needs_fewer_pieces(spacing):
    counts = [len(settled(SMOOTH["ellipse"], spacing, tolerance).pieces[0]) for tolerance in (0.05, 0.2, 0.5, 2.0)]
    assert counts == sorted(counts, reverse=True)
    assert spacing < 5 or counts[0] > counts[-1]


@pytest.mark.parametrize("spacing", [3.0, 6.0, 12.0])
def test_pieces_are_as_long_as_wanted(spacing):
    """On a disc so large that the tolerance asks for nothing."""
    first, last = (d := settled(SMOOTH["disc"], spacing, 2.0)).pieces
    assert np.abs(d.places[last] - d.places[first]) == pytest.approx(spacing, rel=0.12)


@pytest.mark.parametrize("name", ["polycrystal", "rings", "comb", "noise"])
def test_refining_splits_what_is_near_and_nothing_else(name):
    d = settled(EVERYTHING[name])
    before = set(zip(*(ends.tolist() for ends in d.pieces), strict=True))
    place = d.places[d.pieces[0][:1]]
    finer = refine(d, place, within=0.1, tolerance=0.5)
    after = set(zip(*(ends.tolist() for ends in finer.pieces), strict=True))
    gone = np.array(sorted(before - after)).reshape(-1, 2)
    for first, last in gone:
        run = d.places[first : last + 1]
        assert np.abs(run - place).min() <= 0.1
        middle = (first + last) // 2
        assert {(first, middle), (middle, last)} <= after
    # What could not be split goes back to the middle of its link.
    back = np.flatnonzero(finer.reset & ~d.reset)
    assert len(gone) + len(back) > 0
    for point in back:
        entry = np.flatnonzero(d.outlines.indices == point)[0]
        at = finer.places[entry]
        assert abs(at - finer.links.middle[point]) <= max(0, abs(d.dense[point] - finer.links.middle[point]) - 0.5) + 1e-9
    check(settle(finer, tolerance=0.5), EVERYTHING[name], 0.5)
    far = refine(d, np.array([-50 + 0j]), within=1.0, tolerance=0.5)
    assert np.array_equal(far.breaks, d.breaks)
    assert not (far.reset & ~d.reset).any()


@pytest.mark.parametrize("name", ["polycrystal", "noise", "ring", "comb"])
def test_refining_everywhere_again_and_again_ends_in_the_middles(name):
    """The safe end of the loop: every crossing a break, in the middle of its link as far as half a pixel of tolerance goes."""
    d = settled(EVERYTHING[name])
    for _ in range(12):
        d = settle(refine(d, d.dense, within=2.0, tolerance=0.5), tolerance=0.5)
    assert d.breaks.all()
    assert d.reset.all()
    np.testing.assert_allclose(d.places, d.links.middle[d.outlines.indices], atol=0.25)
    check(d, EVERYTHING[name], 0.5)
    assert angles_between(d.coarse()) > 80


def test_corners_that_are_kept_are_never_blunted():
    """Two squares joined by a bridge of one pixel: its inner corners crowd each other."""
    labels = np.zeros((20, 40), int)
    labels[4:16, 3:15] = labels[4:16, 24:36] = 1
    labels[9, 15:24] = 1
    blunted, kept = (settled(labels, keep_corners=keep) for keep in (False, True))
    assert kept.kept.sum() == kept.links.corner.sum() > 8
    assert not kept.reset[kept.kept].any()
    for chosen in (blunted, kept):
        chosen = refine(chosen, chosen.dense, within=2.0, tolerance=0.5)
        chosen = settle(refine(chosen, chosen.dense, within=2.0, tolerance=0.5), tolerance=0.5)
        at_corner = chosen.links.corner[chosen.outlines.indices]
        assert (chosen.moved[at_corner] == 0).all() or chosen.kept.sum() == 0


def test_a_draft_is_not_changed():
    d = drafted(HARD["noise"], 8.0)
    names = ("reset", "breaks", "moved", "measured", "tested", "bulge", "dense", "kept")
    before = {name: getattr(d, name).copy() for name in names}
    done = settle(d, tolerance=0.5)
    kept = {name: getattr(done, name).copy() for name in names}
    refine(done, done.dense[:5], within=1.0, tolerance=0.5)
    keep_areas(done, tolerance=0.5)
    assert all(np.array_equal(getattr(d, name), before[name]) for name in names)
    assert all(np.array_equal(getattr(done, name), kept[name]) for name in names)
