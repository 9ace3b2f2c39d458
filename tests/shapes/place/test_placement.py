"""Dense outlines: every pixel centre on its own side, the topology of the label map, areas of the pixels, a straight frame."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
import strategies
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage
from strategies import QUICK

from img2tri.shapes.place.placement import place_on_pixel_sides, place_outlines
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import BOUND, MOST_SHIFT
from img2tri.types import Frame

FRAMES = [{"upward": False}, {"spacing": (2.0, 1.0)}, {"spacing": (0.4, 0.5), "corner": (9.0, -3.0), "upward": False}]


def size_of_pixel(frame):
    return np.array(frame.spacing) / frame.pixel


def placed(labels, background=0, connectivity=4, on_sides=False, frame=None, **options):
    frame = Frame(labels.shape, **(frame or {}))
    crack_edges = find_crack_edges(labels, background=background, upward=frame.upward, connectivity=connectivity)
    made = place_on_pixel_sides(crack_edges, frame) if on_sides else place_outlines(crack_edges, frame, **options)
    return *made, frame


def check(labels, background=0, connectivity=4, **options):
    """All that must hold of dense outlines, wherever their crossings lie."""
    outlines, dual_edges, frame = placed(labels, background, connectivity, **options)
    h, w = labels.shape
    width, height = size_of_pixel(frame)
    centres = frame.plane(*(np.mgrid[:h, :w] + 0.5))
    polygons = region_polygons(outlines)
    oracles.check_coverage(polygons, labels, centres, background=background, connectivity=connectivity)

    # Regions that touch are those with a pixel side in common.
    parted = np.stack([outlines.left, outlines.right], axis=1)
    touching = {tuple(sorted(outlines.labels[pair].tolist())) for pair in parted[(parted > 0).all(axis=1)]}
    assert touching == oracles.pixel_neighbours(labels, background)

    # Crossings lie on their dual edges, strictly inside; nodes in their blocks; on the frame nodes slide along it, but not to a corner.
    z = outlines.points[:, 0] + 1j * outlines.points[:, 1]
    slide = (z - dual_edges.middle) / np.where(dual_edges.vector == 0, 1, dual_edges.vector)
    on_link = dual_edges.vector != 0
    assert np.abs(slide[on_link].imag).max(initial=0) < 1e-9
    assert np.abs(slide[on_link].real).max(initial=0) <= BOUND + 1e-9
    off = z - dual_edges.middle
    room_x, room_y = dual_edges.bounds.real.copy(), dual_edges.bounds.imag.copy()
    node = np.arange(len(z)) >= len(dual_edges.crossed)
    on_side, on_level = np.isin(dual_edges.middle.real, (0, w * width)), np.isin(dual_edges.middle.imag, (0, h * height))
    room_x[node & on_level & ~on_side], room_y[node & on_side & ~on_level] = BOUND * width, BOUND * height
    assert (np.abs(off.real[~on_link]) <= room_x[~on_link] + 1e-9).all()
    assert (np.abs(off.imag[~on_link]) <= room_y[~on_link] + 1e-9).all()

    # The frame stays straight, its corners exact: what touches it covers its pixels there, but for its ends.
    x, y = outlines.points.T
    assert x.min() >= 0
    assert y.min() >= 0
    assert x.max() <= w * width
    assert y.max() <= h * height
    numbers = numbered(labels, outlines.labels.tolist())
    segments, left, right = outlines.segments
    ends = outlines.points[segments]
    top, bottom = (h * height, 0.0) if frame.upward else (0.0, h * height)
    upright, level = ((0.0, numbers[:, 0]), (w * width, numbers[:, -1])), ((top, numbers[0]), (bottom, numbers[-1]))
    for axis, sides, unit in ((0, upright, height), (1, level, width)):
        for at, along in sides:
            on = (ends[:, :, axis] == at).all(axis=1)
            length = np.abs(np.diff(ends[on][:, :, 1 - axis], axis=1)).ravel()
            covered = np.bincount(np.maximum(left, right)[on], length, len(outlines.labels))
            size, changes = len(outlines.labels), np.flatnonzero(np.diff(along))
            wanted = np.bincount(along, minlength=size) * unit
            ends_of = np.bincount(along[changes], minlength=size) + np.bincount(along[changes + 1], minlength=size)
            assert (np.abs(covered - wanted) <= ends_of * BOUND * unit + 1e-9)[1:].all()
    return outlines, polygons, frame


def numbered(labels, values):
    """Region numbers of a label map: places of its labels among `values`, the first of which stands for nothing."""
    numbers = np.zeros(labels.shape, int)
    for i, value in enumerate(values[1:], start=1):
        numbers[labels == value] = i
    return numbers


def check_areas(labels, polygons, frame):
    for value, p in polygons.items():
        assert p.area == pytest.approx((labels == value).sum() * size_of_pixel(frame).prod(), abs=1e-9)


@pytest.mark.parametrize("background", [0, None])
@pytest.mark.parametrize("name", specimens.ALL)
def test_specimens_in_all_eight_turns(name, background):
    for labels in specimens.turned(specimens.ALL[name]):
        _, polygons, frame = check(labels, background)
        check_areas(labels, polygons, frame)


@pytest.mark.parametrize("options", [{"corners": False}, {"connectivity": 8}, {"on_sides": True}, *({"frame": f} for f in FRAMES)], ids=str)
@pytest.mark.parametrize("name", specimens.ALL)
def test_specimens_with_each_option(name, options):
    _, polygons, frame = check(specimens.ALL[name], **options)
    if "on_sides" not in options:
        check_areas(specimens.ALL[name], polygons, frame)


@QUICK
@given(strategies.maps_and_backgrounds(), st.sampled_from([4, 8]), st.booleans(), st.booleans(), st.sampled_from([{}, *FRAMES]))
def test_any_label_map(case, connectivity, corners, on_sides, frame):
    labels, background = case
    options = {"on_sides": True} if on_sides else {"corners": corners}
    _, polygons, placed_in = check(labels, background, connectivity, frame=frame, **options)
    if not on_sides:
        check_areas(labels, polygons, placed_in)
    if background is None:
        assert shapely.union_all(list(polygons.values())).area == pytest.approx(labels.size * size_of_pixel(placed_in).prod(), rel=1e-12)


@pytest.mark.slow
@strategies.THOROUGH
@given(strategies.maps_and_backgrounds(24), st.sampled_from([4, 8]), st.booleans(), st.sampled_from([{}, *FRAMES]))
def test_many_label_maps(case, connectivity, corners, frame):
    labels, background = case
    _, polygons, placed_in = check(labels, background, connectivity, frame=frame, corners=corners)
    check_areas(labels, polygons, placed_in)


@pytest.mark.parametrize("seed", [44, 131, 167, 235, 243, 624, 949, 1460])
def test_areas_are_kept_where_all_crossings_of_a_region_lie_beside_junctions(seed):
    """These had no other crossing to get their area by."""
    rng = np.random.default_rng(seed)
    size = rng.integers(3, 7), rng.integers(3, 7)
    labels = rng.integers(1, int(rng.integers(3, 7)), size)
    _, polygons, frame = check(labels, connectivity=8 if seed % 3 == 0 else 4, corners=bool(seed % 2))
    check_areas(labels, polygons, frame)


@pytest.mark.parametrize("corners", [True, False])
@pytest.mark.parametrize("sides", [(1, 1), (1, 7), (2, 2), (2, 3), (2, 5), (2, 6), (2, 9), (3, 7), (4, 5)])
def test_bars_keep_their_area_and_their_ends(sides, corners):
    labels = np.pad(np.ones(sides, int), 2)
    _, polygons, frame = check(labels, corners=corners)
    check_areas(labels, polygons, frame)
    h, w = sides
    np.testing.assert_allclose(polygons[1].bounds, [2, 2, 2 + w, 2 + h], atol=0.42)


@pytest.mark.parametrize("seed", range(6))
def test_gray_images_keep_every_centre_on_its_side(seed):
    """Noise, little or much of it smoothed away; some pixels at the level itself."""
    rng = np.random.default_rng(seed)
    gray = ndimage.gaussian_filter(rng.random((30, 34)), (0, 0.6, 1.5)[seed % 3])
    gray = np.round((gray - gray.min()) / np.ptp(gray) * 40)
    for level in (None, 12.5, 20.5, 20):
        labels = (gray > (20 if level is None else level)).astype(int)
        for corners in (True, False):
            check(labels, gray=gray, level=level, corners=corners)


def test_the_gray_values_decide_where_the_outline_runs():
    gray = specimens.gray_disc(40, 13, (20.3, 19.6))
    labels = (gray > 127).astype(int)
    by_mask, by_gray, higher = (placed(labels, **o)[0].points for o in ({}, {"gray": gray}, {"gray": gray, "level": 200.0}))
    off = [np.abs(np.hypot(p[:, 0] - 19.6, p[:, 1] - 19.7) - 13).mean() for p in (by_mask, by_gray, higher)]
    assert off[1] < 0.02 < off[0]
    assert off[1] < 0.15 < off[2]


def test_junctions_move_within_their_block_to_where_their_chains_lead():
    """Three sectors that meet off the corner of the pixels: the junction is found, and is the mean of nothing but its chains."""
    rng = np.random.default_rng(0)
    before, after = [], []
    for _ in range(60):
        centre, turn = 30 + rng.uniform(-0.5, 0.5, 2), rng.uniform(0, 2 * np.pi)
        y, x = np.mgrid[:60, :60] + 0.5
        sector = ((np.arctan2(60 - y - centre[1], x - centre[0]) + turn) % (2 * np.pi) // (2 * np.pi / 3)).astype(int) + 1
        outlines, dual_edges, _ = placed(sector)
        ends = np.concatenate(dual_edges.chains.ends)
        junction = np.flatnonzero((np.bincount(ends) == 3) & (dual_edges.bounds != 0))
        if len(junction) == 1:  # where the pixels make just one of it
            before.append(abs(dual_edges.middle[junction[0]] - complex(*centre)))
            after.append(np.hypot(*(outlines.points[junction[0]] - centre)))
    assert len(after) > 30
    assert np.mean(after) < 0.8 * np.mean(before)


def test_where_nothing_is_meshed_there_is_no_outline():
    for on_sides in (False, True):
        outlines, dual_edges, _ = placed(np.zeros((4, 5), int), on_sides=on_sides)
        assert len(outlines.points) == len(outlines.chains.indices) == len(dual_edges.crossed) == 0
        assert outlines.chains.starts.tolist() == [0]
        assert region_polygons(outlines) == {}


def test_areas_are_those_of_the_pixels_however_many_chains_part_a_region():
    labels = specimens.polycrystal(96, 25, seed=4)
    labels[labels == 3] = 0
    for background in (0, None):
        _, polygons, frame = check(labels, background)
        check_areas(labels, polygons, frame)


def test_the_arguments_are_not_changed():
    labels, gray = specimens.disc(20, 7), specimens.gray_disc(20, 7)
    frame = Frame(labels.shape)
    crack_edges = find_crack_edges(labels)
    kept = {name: getattr(crack_edges, name).copy() for name in ("tail", "head", "left", "right", "successor", "on_frame", "labels")}
    gray.flags.writeable = False
    place_outlines(crack_edges, frame, gray=gray)
    place_on_pixel_sides(crack_edges, frame)
    assert all(np.array_equal(getattr(crack_edges, name), value) for name, value in kept.items())


# ---- exactly along the sides of pixels ----


def tips(labels, background=0, connectivity=4):
    """For each label how many tips of its pixels are cut off at checkerboards, less how many such pieces it gains."""
    values = [v for v in np.unique(labels).tolist() if v != background]
    number = numbered(labels, [None, *values])
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    falling, rising = (a == d) & (b != a) & (c != a), (b == c) & (a != b) & (d != b)
    joins_falling = falling & (~rising | ((a < b) == (connectivity == 4)))
    cut = dict.fromkeys(values, 0)
    # The pixels of the joined diagonal meet in a bridge, which takes a tip of each of the other two.
    for joins, owner, others in ((joins_falling, a, (b, c)), (rising & ~joins_falling, b, (a, d))):
        for i, v in enumerate(values, start=1):
            cut[v] += sum(int((other[joins] == i).sum()) for other in others) - 2 * int((owner[joins] == i).sum())
    return cut


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("background", [0, None])
@pytest.mark.parametrize("name", specimens.ALL)
def test_on_sides_all_outlines_run_along_the_pixels(name, background, connectivity):
    labels = specimens.ALL[name]
    outlines, polygons, _ = check(labels, background, connectivity, on_sides=True)
    sides = shapely.union_all(shapely.linestrings(oracles.pixel_sides(labels, background)))
    cut = tips(labels, background, connectivity)
    # Each tip cut off is a triangle of half by half a pixel; the sides beside it are shifted, so that nothing is lost by that.
    for value, p in polygons.items():
        assert p.area == pytest.approx((labels == value).sum(), rel=1e-5)
    segments, _, _ = outlines.segments
    lines = shapely.union_all(shapely.linestrings(outlines.points[segments]))
    if not any(cut.values()):
        assert lines.symmetric_difference(sides).length < 1e-9
    else:
        assert shapely.hausdorff_distance(lines, sides, densify=0.25) <= 0.5 + 1e-9
        assert shapely.distance(sides, shapely.points(outlines.points)).max() <= MOST_SHIFT


@pytest.mark.parametrize("ratio", [2.5, 7.0])
def test_where_pixels_are_not_square_outlines_are_those_of_square_ones_stretched(ratio):
    labels = specimens.ellipse(70, (28.3, 17.1), 25, (34.6, 35.2))
    square = place_outlines(find_crack_edges(labels), Frame(labels.shape))[0]
    for spacing in ((1.0, ratio), (ratio, 1.0)):
        outlines, dual_edges = place_outlines(find_crack_edges(labels), Frame(labels.shape, spacing=spacing))
        np.testing.assert_allclose(outlines.points, square.points * spacing, atol=1e-9)
        np.testing.assert_allclose(dual_edges.pixel, complex(*spacing))
        assert np.array_equal(outlines.chains.indices, square.chains.indices)
