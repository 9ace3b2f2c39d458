"""Contours through pixel centres: what they enclose, what they lose."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import shapely
import specimens
from scipy import ndimage

from img2tri.errors import ImageError, ParameterError
from img2tri.paper.contours import contour_polygon, external_contours

CORNERS_TOO = np.ones((3, 3))


def test_a_square_loses_half_a_pixel_all_around():
    (contour,) = external_contours(np.pad(np.ones((51, 51), bool), 3))
    assert contour_polygon(contour).area == 50 * 50
    assert contour_polygon(contour).bounds == (3, 3, 53, 53)
    assert contour.dtype == np.float64


def test_columns_are_x_and_rows_are_y():
    (contour,) = external_contours(np.pad(np.ones((3, 9), bool), ((5, 0), (1, 0))))
    assert contour.min(axis=0).tolist() == [1, 5]
    assert contour.max(axis=0).tolist() == [9, 7]


def straight(rows, columns):
    """Pixels on one line: what such contours run around has no area."""
    return np.linalg.matrix_rank(np.stack([rows - rows[0], columns - columns[0]])) < 2


@pytest.mark.parametrize("name", specimens.MASKS)
def test_every_component_next_to_the_outside_has_a_contour_around_it(name):
    mask = np.pad(specimens.MASKS[name] != 0, 1)
    parts, n = ndimage.label(mask, CORNERS_TOO)
    empty, _ = ndimage.label(~mask)
    outside = ndimage.binary_dilation(empty == empty[0, 0])
    boxes = []
    for k in range(1, n + 1):
        rows, columns = np.nonzero(parts == k)
        if (outside & (parts == k)).any() and not straight(rows, columns):
            boxes.append((columns.min(), rows.min(), columns.max(), rows.max()))
    found = [(*c.min(axis=0), *c.max(axis=0)) for c in external_contours(mask)]
    assert sorted(found) == sorted(boxes)


def test_holes_are_passed_over():
    mask = np.pad(np.ones((9, 9), bool), 1)
    filled = external_contours(mask)
    mask[4:7, 4:7] = False
    np.testing.assert_array_equal(external_contours(mask)[0], filled[0])
    mask[5, 5] = True
    assert len(external_contours(mask)) == 1, "an island in a hole has no contour either"


def test_it_is_what_opencv_finds():
    mask = ndimage.gaussian_filter(np.random.default_rng(3).random((80, 90)), 3) > 0.5
    found, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    found = [c.reshape(-1, 2) for c in found if len(c) >= 3]
    assert len(found) > 3
    for ours, theirs in zip(external_contours(mask), found, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_any_numbers_but_zero_are_white():
    mask = np.pad(np.ones((4, 4), bool), 1)
    for white in (255, -1, 0.25):
        np.testing.assert_array_equal(external_contours(mask * white)[0], external_contours(mask)[0])


def test_nothing_white_has_no_contours():
    assert external_contours(np.zeros((5, 5))) == []


def test_a_wrong_mask():
    with pytest.raises(ImageError, match="mask: expected rows and columns"):
        external_contours(np.ones((3, 3, 3)))


def test_a_spur_is_left_out_of_the_polygon():
    mask = np.pad(np.ones((6, 6), bool), ((2, 2), (2, 8)))
    plain = contour_polygon(external_contours(mask)[0])
    mask[5, 8:13] = True
    (contour,) = external_contours(mask)
    polygon = contour_polygon(contour)
    assert contour[:, 0].max() == 12
    assert polygon.is_valid
    # At its root the contour cuts the corner between the spur and the square: one triangle of half a pixel on either side.
    assert polygon.covers(plain)
    assert polygon.area == plain.area + 1


def test_a_pinched_contour_becomes_several_polygons():
    mask = np.zeros((12, 12), bool)
    mask[1:5, 1:5] = mask[5:9, 5:9] = True
    (contour,) = external_contours(mask)
    polygon = contour_polygon(contour)
    assert polygon.is_valid
    assert polygon.geom_type == "MultiPolygon"
    assert polygon.area == 9 + 9


def test_a_bent_line_encloses_nothing():
    mask = np.zeros((5, 8), bool)
    mask[[0, 1, 2, 1, 0], [1, 2, 3, 4, 5]] = True
    (contour,) = external_contours(mask)
    assert contour_polygon(contour).is_empty


@pytest.mark.parametrize("seed", range(5))
def test_polygons_of_noise_are_valid_and_hold_what_the_papers_polygon_holds(seed):
    mask = np.random.default_rng(seed).random((30, 30)) < 0.6
    places = np.random.default_rng(seed).uniform(0, 30, (400, 2))
    for contour in external_contours(mask):
        polygon = contour_polygon(contour)
        assert polygon.is_valid
        assert polygon.geom_type in ("Polygon", "MultiPolygon")
        theirs = shapely.contains_xy(shapely.Polygon(contour), places[:, 0], places[:, 1])
        np.testing.assert_array_equal(shapely.contains_xy(polygon, places[:, 0], places[:, 1]), theirs)


@pytest.mark.parametrize("contour", [[], [[0, 0], [1, 1]], [[0, 0, 0]] * 4, [[0, 0], [1, 0], [np.nan, 1]]])
def test_a_wrong_contour(contour):
    with pytest.raises(ParameterError, match="contour: expected at least three finite points"):
        contour_polygon(contour)


def test_the_smallest_contour_has_three_corners():
    (contour,) = external_contours([[0, 0, 0, 0], [0, 1, 1, 0], [0, 1, 0, 0]])
    assert sorted(contour.tolist()) == [[1, 1], [1, 2], [2, 1]]
    assert contour_polygon(contour).area == 0.5
