"""Crossings placed by gray values, against edges that are known exactly: slopes, and discs drawn by area coverage."""

from __future__ import annotations

import numpy as np
import pytest
import specimens
from scipy import ndimage

from img2tri.raster.labels.segmentation import segment
from img2tri.raster.reading import read
from img2tri.recipes.conforming import trace_outlines
from img2tri.shapes.place.iso_crossings import HARD, SURE, SURE_AREA, iso_crossings
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import BOUND, lay_out
from img2tri.types import Frame


def outlines_of(image, **options):
    picture = read(image)
    return trace_outlines(segment(picture, **options), picture.frame)


def raw_crossings(gray, level, labels, frame=None):
    """Crossings by gray values alone, with their dual_edges."""
    frame = frame or Frame(gray.shape)
    dual_edges = lay_out(find_crack_edges(labels, upward=frame.upward), frame)
    return dual_edges, *iso_crossings(gray, level, dual_edges.middle, dual_edges.vector, frame)


def off_circle(points, radius, centre, n):
    """Signed distances from a circle; `centre` is its row and column in an image n high."""
    return np.hypot(points[:, 0] - centre[1], n - points[:, 1] - centre[0]) - radius


def slope(shape, gradient, at):
    """Gray values that grow evenly, 0 at the line through the point `at`, y up; and what they are at any point."""

    def value(x, y):
        return gradient[0] * (x - at[0]) + gradient[1] * (y - at[1])

    r, c = np.mgrid[: shape[0], : shape[1]] + 0.5
    return value(c, shape[0] - r), lambda p: value(p[:, 0], p[:, 1]) / np.hypot(*gradient)


def random_slopes(count=20, shape=(60, 80)):
    rng = np.random.default_rng(5)
    for _ in range(count):
        angle = rng.uniform(0, 2 * np.pi)
        yield slope(shape, rng.uniform(0.1, 30) * np.array([np.cos(angle), np.sin(angle)]), [40, 30] + rng.uniform(-3, 3, 2))


# ---- a level given as a number: the outline is an iso-line ----


def test_a_crossing_is_just_where_the_values_between_two_pixels_reach_the_level():
    for gray, distance in random_slopes():
        for level in (0.0, 1.7, -0.6):
            dual_edges, shift, slack = raw_crossings(gray, level, gray > level)
            z = dual_edges.middle + shift * dual_edges.vector
            off = np.abs(distance(np.stack([z.real, z.imag], axis=1)) - level / np.hypot(*np.gradient(gray))[0, 0])
            inner = dual_edges.vector != 0
            clipped = np.abs(shift) == BOUND
            assert off[inner & ~clipped].max() < 1e-9
            assert off[inner & clipped].max(initial=0) <= 0.5 - BOUND
            assert np.abs(shift).max() <= BOUND
            assert (shift[~inner] == 0).all()
            assert (slack[inner] == SURE).all()


def test_the_outline_of_an_even_slope_is_a_straight_line_from_frame_to_frame():
    for gray, distance in random_slopes():
        outlines, dual_edges = outlines_of(gray, threshold=0.0)
        off = np.abs(distance(outlines.points))
        inner = dual_edges.vector != 0
        assert off[inner].max() <= 0.02
        assert np.sqrt((off[inner] ** 2).mean()) < 0.005
        # An outline that runs along the frame would meet it more than half a pixel from where it has to end.
        node = np.flatnonzero(np.arange(len(off)) >= len(dual_edges.crossed))
        slid = node[
            np.abs(outlines.points[node] - np.stack([dual_edges.middle[node].real, dual_edges.middle[node].imag], axis=1)).sum(axis=1) > 0
        ]
        assert len(slid) == 2
        free = np.abs(outlines.points[slid, 0] + 1j * outlines.points[slid, 1] - dual_edges.middle[slid]) < BOUND - 1e-9
        assert (off[slid[free]] < 0.02).all()


@pytest.mark.parametrize("frame", [{"upward": False}, {"spacing": (2.0, 1.0)}, {"spacing": (0.5, 1.25), "corner": (9.0, -3.0)}])
def test_in_any_frame_the_same_crossings(frame):
    gray = ndimage.gaussian_filter(np.random.default_rng(1).random((20, 30)), 2)
    level = float(np.median(gray))
    plain, shift, slack = raw_crossings(gray, level, gray > level)
    dual_edges, other_shift, other_slack = raw_crossings(gray, level, gray > level, Frame(gray.shape, **frame))

    def by_crack(dual_edges, values):
        """Along each dual edge from its darker side, whichever way the outline runs."""
        crack = dual_edges.crossed
        sides = np.sort(np.stack([dual_edges.crack_edges.tail[crack], dual_edges.crack_edges.head[crack]]), axis=0)
        return values[: len(crack)][np.lexsort(sides)]

    np.testing.assert_allclose(by_crack(dual_edges, other_shift), by_crack(plain, shift), atol=1e-9)
    np.testing.assert_allclose(by_crack(dual_edges, other_slack), by_crack(plain, slack), atol=1e-9)


@pytest.mark.parametrize("threshold", [0, 1, 5, 9, 13])
def test_of_whole_numbers_the_level_lies_above_the_threshold(threshold):
    rng = np.random.default_rng(threshold)
    image = ndimage.gaussian_filter(rng.random((24, 24)), 2)
    image = np.round((image - image.min()) / np.ptp(image) * 14).astype(np.uint8)
    _, shift, _ = raw_crossings(image, threshold + 0.5, image > threshold)
    assert np.abs(shift).max() <= BOUND
    outlines, _ = outlines_of(image, threshold=threshold)
    # Many pixels are equal to the threshold: no point of an outline lies on their centres, nor two of them in one place.
    off_centre = np.abs((outlines.points - 0.5 + 0.5) % 1 - 0.5).max(axis=1)
    assert off_centre.min() >= 0.0499
    assert len(np.unique(outlines.points.round(9), axis=0)) == len(outlines.points)


def test_the_level_moves_the_outline():
    gray, distance = slope((40, 40), (10.0, 3.0), (20, 20))
    for level in (-25.0, 0.0, 30.0):
        outlines, dual_edges = outlines_of(gray, threshold=level)
        inner = dual_edges.vector != 0
        assert distance(outlines.points[inner]).mean() == pytest.approx(level / np.hypot(10, 3), abs=0.03)


# ---- edges drawn by area coverage ----


def coverage_discs(radius, count=4):
    rng = np.random.default_rng(int(radius))
    for _ in range(count):
        n = int(2 * radius + 12)
        centre = tuple(n / 2 + rng.uniform(-0.5, 0.5, 2))
        yield specimens.gray_disc(n, radius, centre), n, centre


def errors(radius, count=4, **options):
    """Distances of the crossings of some discs from their circles, smoothed and as the gray values say."""
    smooth, raw = [], []
    for image, n, centre in coverage_discs(radius, count):
        outlines, _ = outlines_of(image, **options)
        smooth.append(off_circle(outlines.points, radius, centre, n))
        dual_edges, shift, _ = raw_crossings(image, None, image > 127)
        z = dual_edges.middle + shift * dual_edges.vector
        raw.append(off_circle(np.stack([z.real, z.imag], axis=1), radius, centre, n))
    return np.concatenate(smooth), np.concatenate(raw)


def rms(values):
    return np.sqrt((values**2).mean())


@pytest.mark.parametrize("options", [{}, {"threshold": 127}, {"threshold": "otsu"}], ids=["left out", "number", "otsu"])
@pytest.mark.parametrize("radius", [40, 50, 80, 150, 250, 400])
def test_discs_are_found_to_a_thirtieth_of_a_pixel(radius, options):
    smooth, _ = errors(radius, 1 if radius > 200 else 3, **options)
    assert rms(smooth) <= 0.03
    assert abs(smooth.mean()) <= 0.005
    assert np.abs(smooth).max() <= 0.15


@pytest.mark.parametrize("radius", [3, 5, 8, 10, 12, 16, 25, 30, 60, 80])
def test_smoothing_never_makes_it_worse(radius):
    smooth, raw = errors(radius, 12 if radius < 40 else 4)
    assert rms(smooth) <= rms(raw)


@pytest.mark.parametrize("radius", [1.2, 2, 3, 5, 12])
def test_small_discs_keep_their_place_and_size(radius):
    smooth, _ = errors(radius, 20)
    assert rms(smooth) <= 0.12
    assert abs(smooth.mean()) <= 0.04


@pytest.mark.parametrize(("middle", "bright"), [(180, 255), (170, 240), (200, 255), (160, 220)])
def test_of_three_levels_each_edge_is_in_the_middle_of_its_own_sides(middle, bright):
    radius, centres = 40, ((50.2, 49.7), (49.6, 50.3))
    image = np.concatenate([specimens.gray_disc(100, radius, c, 0, g) for c, g in zip(centres, (middle, bright), strict=True)], axis=1)

    def bias(outlines):
        x = outlines.points[:, 0]
        halves = (outlines.points[x < 100], outlines.points[x > 100] - [100, 0])
        return [off_circle(half, radius, c, 100).mean() for half, c in zip(halves, centres, strict=True)]

    zones = segment(read(image))
    assert zones.threshold.how == "otsu"
    assert zones.level is None
    assert np.abs(bias(outlines_of(image)[0])).max() < 0.02
    # One level for all is too high for one disc and too low for the other.
    dim, bright_one = bias(outlines_of(image, threshold=zones.threshold.value)[0])
    assert dim < -0.06
    assert bright_one > 0.06


def test_thin_parts_survive_that_the_gray_values_hardly_show():
    """A wedge drawn by area coverage, down to half a pixel: what the threshold leaves of it is one part, in the right place."""
    fine = np.zeros((320, 960))
    y, x = np.mgrid[:320, :960] + 0.5
    fine = np.abs(y - 163) < (960 - x) / 960 * 30 + 6
    image = np.round(255 * fine.reshape(40, 8, 120, 8).mean(axis=(1, 3))).astype(np.uint8)
    outlines, dual_edges = outlines_of(image, threshold=127)
    inner = dual_edges.vector != 0
    x, y = outlines.points[inner].T
    wanted = ((120 - x) / 120 * 30 + 6) / 8
    off = np.abs(np.abs(40 - y - 163 / 8) - wanted)
    assert x.max() > 116
    assert off[(wanted > 1) & (x > 3)].max() < 0.12


# ---- edges that say no more than a mask ----


@pytest.mark.parametrize("pair", [(0, 255), (10, 11), (0.0, 1.0), (-3.5, 2.25)], ids=str)
@pytest.mark.parametrize("how", ["left out", "given", "otsu"])
def test_an_image_of_two_values_is_its_mask(pair, how):
    mask = specimens.ellipse(40, (15.2, 9.1), 30, (20.3, 19.1)).astype(bool)
    image = np.where(mask, *pair[::-1])
    level = {"left out": {}, "given": {"threshold": sum(pair) / 2}, "otsu": {"threshold": "otsu"}}[how]
    outlines, expected = outlines_of(image, **level)[0], outlines_of(mask)[0]
    assert np.array_equal(outlines.points, expected.points)
    assert np.array_equal(outlines.chains.indices, expected.chains.indices)


def test_only_soft_edges_are_taken_at_their_word():
    image = np.zeros((9, 12))
    image[:, 6:] = 100.0
    soft = image.copy()
    soft[:, 5] = 70.0  # between column 4, dark, and column 6: the edge is 0.7 of a pixel before column 6
    for gray, expected, known in ((image, 0.0, False), (soft, 0.3, True)):
        dual_edges, shift, slack = raw_crossings(gray, None, gray > 50)
        inner = dual_edges.vector != 0
        np.testing.assert_allclose(np.abs(shift[inner]), abs(expected), atol=1e-12)
        assert (slack[inner] == (SURE_AREA if known else BOUND)).all()
    # Almost as great a contrast as that of the two sides counts as hard.
    for share, known in ((0.99 * HARD, True), (1.01 * HARD, False)):
        gray = image.copy()
        gray[:, 5] = 100 * (1 - share)
        dual_edges, shift, slack = raw_crossings(gray, None, gray > 50)
        assert (slack[dual_edges.vector != 0] == (SURE_AREA if known else BOUND)).all()


@pytest.mark.parametrize("radius", [1.2, 3.3, 8])
def test_a_hard_edge_encloses_its_pixels_whatever_else_is_in_the_image(radius):
    mask = specimens.disc(24, radius, (12.2, 11.9))
    image = np.where(mask, 200, 20).astype(np.uint8)
    image[0, 0] = 90  # a third value: this is no mask
    outlines, _ = outlines_of(image)
    assert region_polygons(outlines)[1].area == pytest.approx(mask.sum(), abs=1e-9)


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.float32, np.float64])
def test_the_type_of_the_gray_values_does_not_matter(dtype):
    image = specimens.gray_disc(40, 13, (20.3, 19.6), 10, 110)
    one, other = outlines_of(image.astype(float), threshold=60.5)[0], outlines_of(image.astype(dtype), threshold=60.5)[0]
    np.testing.assert_allclose(one.points, other.points, atol=1e-6)
