"""Areas of coarse outlines: measured as those of polygons, kept as those of the dense ones."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
import specimens
from benchmarks.shapes import blob

from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.simplify.area_preservation import LACKING_AREA, SMALL_REGION, area_errors, preserve_areas
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.tolerance import enforce_tolerance
from img2tri.shapes.simplify.vertex_offsets import MOST_OFFSET
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

SMOOTH = {
    "disc": specimens.disc(100, 40.3, (50.1, 49.8)),
    "small disc": specimens.disc(20, 6.2, (10.1, 9.7)),
    "ellipse": specimens.ellipse(90, (36.2, 17.7), 33, (45.3, 44.6)),
    "ring": specimens.disc(80, 35.1) - specimens.disc(80, 20.4, (40.3, 39.6)),
    "blob": (blob(160, holes=2) > 0).astype(int),
    "two labels": specimens.disc(80, 35.1) + specimens.disc(80, 20.4, (40.3, 39.6)),
}


def settled(labels, spacing, tolerance=0.5, background=0):
    outlines, dual_edges = place_outlines(find_crack_edges(labels, background=background), Frame(labels.shape))
    return enforce_tolerance(space_evenly(outlines, dual_edges, spacing=spacing), tolerance=tolerance)


def preserved(d, rounds=4, tolerance=0.5):
    for _ in range(rounds):
        d = enforce_tolerance(preserve_areas(d, tolerance=tolerance), tolerance=tolerance)
    return d


def error_by_polygons(d, labels):
    """The same by polygons: of the regions that are not small, how far their areas are off at most."""
    coarse, dense = region_polygons(d.coarse()), region_polygons(d.outlines)
    sizes = {label: (labels == label).sum() for label in dense}
    return max((abs(coarse[label].area - dense[label].area) / size for label, size in sizes.items() if size > SMALL_REGION), default=0.0)


@pytest.mark.parametrize("spacing", [2.0, 6.0, 20.0])
@pytest.mark.parametrize("name", [*SMOOTH, *specimens.ALL])
def test_the_error_is_that_of_the_polygons(name, spacing):
    labels = (SMOOTH | specimens.ALL)[name]
    for d in (settled(labels, spacing), preserve_areas(settled(labels, spacing), tolerance=0.5)):
        assert area_errors(d).max() == pytest.approx(error_by_polygons(d, labels), abs=1e-9)


def test_chords_on_a_disc_lose_what_theory_says():
    """h^2 / 6 R^2 of the area, for chords of length h between points of the circle."""
    for spacing in (6.0, 9.0, 14.0):
        d = settled(SMOOTH["disc"], spacing, tolerance=3.0)
        assert area_errors(d).max() == pytest.approx(spacing**2 / (6 * 40.3**2), rel=0.25)


@pytest.mark.parametrize(("spacing", "most"), [(2.0, 1e-4), (4.0, 2e-4), (8.0, LACKING_AREA), (16.0, LACKING_AREA), (40.0, LACKING_AREA)])
@pytest.mark.parametrize("name", SMOOTH)
def test_after_some_rounds_the_areas_are_kept(name, spacing, most):
    d = settled(SMOOTH[name], spacing)
    if name in ("disc", "blob"):
        most = min(most, 1e-3)
    assert area_errors(preserved(d)).max() <= most
    assert area_errors(preserved(d, 1)).max() <= max(4 * most, area_errors(d).max() / 5)


@pytest.mark.parametrize("spacing", [3.0, 6.0, 12.0])
def test_on_a_disc_one_round_leaves_the_cube_of_the_error(spacing):
    """Chords lose a share e of the disc; vertices that move outwards by half of it win e, and by then turn a little: e^2 / 2 is left.

    All of them then move by what that is of the whole: again the share e of it is left, or less.
    """
    d = settled(SMOOTH["disc"], spacing)
    assert area_errors(preserve_areas(d, tolerance=2.0)).max() < area_errors(d).max() ** 3 / 2


@pytest.mark.parametrize("tolerance", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("name", SMOOTH)
def test_no_vertex_ends_farther_from_the_outline_than_it_may(name, tolerance):
    d = settled(SMOOTH[name], 8.0, tolerance)
    dense = shapely.union_all(shapely.linestrings(d.outlines.points[d.outlines.segments[0]]))
    for _ in range(4):
        d = preserve_areas(d, tolerance=tolerance)
        at = d.places[d.kept & ~d.snapped[d.outlines.chains.indices]]
        farthest = shapely.distance(dense, shapely.points(at.real, at.imag)).max()
        assert farthest <= MOST_OFFSET * tolerance + 1e-9
        d = enforce_tolerance(d, tolerance=tolerance)


def test_nodes_and_the_frame_stay_where_they_are():
    labels = specimens.polycrystal()
    d = settled(labels, 6.0, background=None)
    offset = preserve_areas(d, tolerance=0.5)
    fixed = d.dual_edges.vector[d.outlines.chains.indices] == 0
    assert np.array_equal(offset.offset[fixed], d.offset[fixed])
    # Of a ring both ends move together.
    ring = preserve_areas(settled(SMOOTH["disc"], 8.0), tolerance=0.5)
    assert ring.offset[0] == ring.offset[-1] != 0


def test_the_two_regions_beside_a_chain_share_what_is_moved():
    d = preserved(settled(SMOOTH["two labels"], 8.0))
    coarse = region_polygons(d.coarse())
    assert shapely.coverage_is_valid(list(coarse.values()))
    for label, p in coarse.items():
        assert p.area == pytest.approx((SMOOTH["two labels"] == label).sum(), rel=LACKING_AREA)
    # What one gains the other loses.
    whole = region_polygons(settled(SMOOTH["two labels"] > 0, 8.0).outlines)[1].area
    assert sum(p.area for p in coarse.values()) == pytest.approx(whole, rel=LACKING_AREA)


def test_a_small_region_that_lacks_much_gets_more_vertices():
    labels = specimens.disc(24, 7.3, (12.2, 11.9))
    outlines, dual_edges = place_outlines(find_crack_edges(labels), Frame(labels.shape))
    sparse = space_evenly(outlines, dual_edges, spacing=100.0)
    more = preserve_areas(sparse, tolerance=0.05)
    assert more.kept.sum() > sparse.kept.sum()
    assert preserve_areas(sparse, tolerance=2.0).kept.sum() <= more.kept.sum()


def test_where_there_is_nothing_there_is_no_error():
    d = settled(np.zeros((3, 4), int), 4.0)
    assert area_errors(d).max() == 0
    assert area_errors(settled(specimens.MASKS["one pixel"], 4.0)).max() == 0  # too small to be looked after
