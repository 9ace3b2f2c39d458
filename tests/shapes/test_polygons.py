"""Chains joined to rings and polygons: neighbours share their vertices, holes go to the component around them."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
import strategies
from hypothesis import given
from strategies import QUICK

from img2tri.shapes.polygons import component_polygons, enclosed_areas, region_polygons, region_rings
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import lay_out
from img2tri.types import Frame


def outlines_of(labels, background=0, connectivity=4):
    """The outlines through the middles of all crack_edges."""
    crack_edges = find_crack_edges(labels, background=background, connectivity=connectivity)
    dual_edges = lay_out(crack_edges, Frame(labels.shape))
    return dual_edges.outlines(dual_edges.middle)


def targets(size=41):
    """RegionRings in rings of two labels in turn, off the centre, and two of them side by side."""
    y, x = np.mgrid[:size, :size]
    one = np.maximum(abs(x - 18), abs(y - 22)) // 3 % 3
    return np.concatenate([one, one[::-1]], axis=1)


SHAPES = specimens.ALL | {"targets": targets(), "random": np.random.default_rng(1).integers(0, 3, (15, 18))}


@pytest.mark.parametrize("background", [0, None])
@pytest.mark.parametrize("name", SHAPES)
def test_rings_go_round_their_region(name, background):
    outlines = outlines_of(SHAPES[name], background)
    r = region_rings(outlines)
    assert (r.starts[0], r.starts[-1]) == (0, len(r.points))
    expected = oracles.joined_topology(SHAPES[name], background=background)
    for number, value in enumerate(outlines.labels[1:].tolist(), start=1):
        assert ((r.areas[r.regions == number] > 0).sum(), (r.areas[r.regions == number] < 0).sum()) == expected[value]
    assert (r.regions > 0).all()
    for i, area in enumerate(r.areas):
        ring = r.points[r.starts[i] : r.starts[i + 1]]
        assert np.array_equal(ring[0], ring[-1])
        linear = shapely.LinearRing(ring)
        assert linear.is_simple
        assert linear.is_ccw == (area > 0)
        assert shapely.Polygon(ring).area == pytest.approx(abs(area), rel=1e-12)


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("background", [0, None])
@pytest.mark.parametrize("name", SHAPES)
def test_polygons_are_a_coverage_with_the_topology_of_the_labels(name, background, connectivity):
    labels = SHAPES[name]
    outlines = outlines_of(labels, background, connectivity)
    r, c = np.mgrid[: labels.shape[0], : labels.shape[1]] + 0.5
    centres = np.stack([c, labels.shape[0] - r], axis=-1)
    oracles.check_coverage(region_polygons(outlines), labels, centres, background=background, connectivity=connectivity)


@QUICK
@given(strategies.maps_and_backgrounds())
def test_any_label_map(case):
    labels, background = case
    outlines = outlines_of(labels, background)
    by_region = region_polygons(outlines)
    oracles.check_coverage(by_region, labels, None, background=background)
    values, parts = component_polygons(outlines)
    assert values.dtype == np.int64
    for value, whole in by_region.items():
        mine = parts[values == value]
        assert sum(p.area for p in mine) == pytest.approx(whole.area, rel=1e-12)
        assert shapely.union_all(mine).equals(whole)
    expected = [by_region[v].area for v in outlines.labels[1:].tolist()]
    np.testing.assert_allclose(enclosed_areas(outlines), [0, *expected], rtol=1e-12, atol=1e-12)


def test_neighbours_share_the_vertices_of_their_interface():
    outlines = outlines_of(specimens.polycrystal(), None)
    by_region = region_polygons(outlines)
    for one, other in oracles.pixel_neighbours(specimens.polycrystal(), None):
        shared = by_region[one].intersection(by_region[other])
        assert shared.length > 0
        assert shared.area == 0
        corners = {tuple(p) for p in shapely.get_coordinates(shared)}
        for region in (one, other):
            assert corners <= {tuple(p) for p in shapely.get_coordinates(by_region[region])}


def test_islands_in_islands_of_the_same_region():
    """Squares of the labels 1 . 1 . 1 within each other: three components, of which the outer two have a hole."""
    y, x = np.mgrid[:27, :27]
    labels = 1 - np.maximum(abs(x - 13), abs(y - 13)) // 3 % 2
    values, parts = component_polygons(outlines_of(labels))
    assert values.tolist() == [1, 1, 1]
    parts = sorted(parts, key=lambda p: p.bounds[0])
    assert [len(p.interiors) for p in parts] == [1, 1, 0]
    assert all(shapely.Polygon(p.exterior).contains(q) for i, p in enumerate(parts) for q in parts[i + 1 :])
    assert not any(p.intersects(q) for i, p in enumerate(parts) for q in parts[:i])


def test_a_hole_that_touches_the_next_ring_in_a_corner_of_pixels():
    labels = specimens.MASKS["hole touching the outside by a corner"]
    for connectivity, expected in ((4, (1, 0)), (8, (1, 1))):
        oracles.check_coverage(region_polygons(outlines_of(labels, 0, connectivity)), labels, None, connectivity=connectivity)
        assert oracles.polygon_topology(region_polygons(outlines_of(labels, 0, connectivity)))[1] == expected


def test_one_polygon_or_several_by_ascending_label():
    labels = np.array([[7, 0, 7, 0, -3]])
    by_region = region_polygons(outlines_of(labels))
    assert list(by_region) == [-3, 7]
    assert [p.geom_type for p in by_region.values()] == ["Polygon", "MultiPolygon"]
    assert [p.area for p in by_region.values()] == [1, 2]


def test_of_no_outlines_there_is_no_polygon():
    outlines = outlines_of(np.zeros((3, 3), int))
    values, parts = component_polygons(outlines)
    assert len(values) == len(parts) == 0
    assert region_polygons(outlines) == {}
    assert enclosed_areas(outlines).tolist() == [0]
    r = region_rings(outlines)
    assert r.points.shape == (0, 2)
    assert r.starts.tolist() == [0]


def test_areas_are_exact_far_from_the_origin():
    labels = np.zeros((400, 3000), int)
    labels[-4:-1, -4:-1] = labels[1, 1] = 1
    # Through the middles of the sides: the four corners of each ring are cut off, an eighth of a pixel each.
    assert sorted(region_rings(outlines_of(labels)).areas.tolist()) == pytest.approx([0.5, 8.5], abs=1e-9)
    assert enclosed_areas(outlines_of(labels)) == pytest.approx([0, 9.0], abs=1e-9)
