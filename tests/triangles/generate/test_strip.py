"""The strip beside outlines: which points lie in a region, and that finer ones are there where they are wanted."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
from networks import network, ring, wave

from img2tri.triangles.generate.filling import fill
from img2tri.triangles.generate.pslg import Pslg
from img2tri.triangles.generate.strip import _clear, _inside


def as_pslg(given):
    points, segments, left, right = given
    return Pslg(points[:, 0] + 1j * points[:, 1], segments, left, right, np.arange(len(segments)))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("regions", [(1, 0), (0, 1), (1, 2), (2, 0)])
def test_points_are_judged_by_the_side_of_the_nearest_segment(regions, turned):
    points, segments, _, _ = network((wave(300, 20, lobes=3), 1, 0))
    given = np.full(300, regions[0]), np.full(300, regions[1])
    if turned:
        segments, given = segments[:, ::-1], given[::-1]
    tried = np.random.default_rng(0).uniform(-30, 30, (4000, 2))
    within = shapely.contains_xy(shapely.Polygon(points), tried[:, 0], tried[:, 1])
    found = _inside(as_pslg((points, segments, *given)), tried[:, 0] + 1j * tried[:, 1])
    assert np.array_equal(found, np.where(within, regions[0], regions[1]) != 0)


def test_points_keep_clear_of_others_by_their_own_length():
    near, points, wanted = np.array([0, 10j]), np.array([0.6, 0.7, 7 + 10j, 6 + 10j]), np.array([1.0, 1.0, 10.0, 10.0])
    assert _clear(near, points, wanted).tolist() == [False, True, True, False]


@pytest.mark.parametrize("wanted", [1.5, 3.0])
def test_inside_of_outlines_that_are_coarse_triangles_are_as_fine_as_wanted(wanted):
    def size(places):
        return wanted + 0.3 * np.maximum(0, np.hypot(*places.T) - 15)

    given = network((ring(45, 60), 1, 0))
    vertices, triangles, _ = fill(*given, edge_length=8.0, size=size, gradation=0.3)
    areas = oracles.areas(vertices, triangles)
    middles = np.hypot(*vertices[triangles].mean(axis=1).T)
    assert areas[middles < 12].mean() == pytest.approx(3**0.5 / 4 * wanted**2, rel=0.25)
    assert areas[middles > 50].mean() > 3**0.5 / 4 * 6**2
    assert oracles.angles(vertices, triangles).min() > 30
