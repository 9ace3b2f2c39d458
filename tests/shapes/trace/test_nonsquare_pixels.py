"""Pixels that are not square: points are added, outlines stay; their middles nowhere turn sharply, and meshes keep all promises."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
from scipy.spatial import cKDTree
from shapes.simplify.test_tolerance import angles_between

from img2tri import mesh_image
from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.nonsquare_pixels import with_turning_points
from img2tri.types import Frame

STRETCHED = [(5.0, 1.0), (1.0, 5.0), (12.0, 1.0), (1.0, 20.0)]
NAMES = ["comb", "disc", "polycrystal", "three meet", "checkerboard of two", "islands of a pixel"]


def placed(labels, spacing):
    return place_outlines(find_crack_edges(labels, background=0), Frame(labels.shape, spacing=spacing))


def lines(outlines):
    chains = outlines.chains
    return [shapely.LineString(outlines.points[chains.indices[i:j]]) for i, j in zip(chains.starts[:-1], chains.starts[1:], strict=True)]


def test_where_pixels_are_square_nothing_is_added():
    outlines, dual_edges = placed(specimens.ALL["polycrystal"], (1.0, 1.0))
    same = with_turning_points(outlines, dual_edges)
    assert same[0] is outlines
    assert same[1] is dual_edges


@pytest.mark.parametrize("spacing", STRETCHED)
@pytest.mark.parametrize("name", NAMES)
def test_outlines_stay_and_their_middles_turn_by_right_angles_at_most(name, spacing):
    outlines, dual_edges = placed(specimens.ALL[name], spacing)
    more, finer = with_turning_points(outlines, dual_edges)
    for one, other in zip(lines(outlines), lines(more), strict=True):
        assert one.hausdorff_distance(other) < 1e-9
        assert one.length == pytest.approx(other.length, rel=1e-12)
    assert len(more.points) > len(outlines.points)
    assert np.array_equal(more.left, outlines.left)
    assert all(np.array_equal(a, b) for a, b in zip(finer.regions, dual_edges.regions, strict=True))
    assert angles_between(finer.outlines(finer.blunt_middle)) > 80


def test_the_tip_of_a_row_of_flat_pixels():
    """Half a small side before each of its two corners there is a point: a right angle, where the middles alone have 2 atan(1 / 5)."""
    outlines, dual_edges = placed(specimens.ALL["one pixel"], (5.0, 1.0))
    _, finer = with_turning_points(outlines, dual_edges)
    assert angles_between(dual_edges.outlines(dual_edges.middle)) == pytest.approx(2 * np.degrees(np.arctan(1 / 5)))
    assert angles_between(finer.outlines(finer.middle)) == pytest.approx(90)


@pytest.mark.parametrize("spacing", [(3.0, 1.0), (1.0, 3.0), (5.0, 1.0), (1.0, 5.0)])
def test_label_maps_keep_all_promises(spacing):
    rng = np.random.default_rng(1)
    h, w = round(60 / spacing[1]), round(60 / spacing[0])
    y, x = np.mgrid[:h, :w] + 0.5
    places = np.stack([(x * spacing[0]).ravel(), (y * spacing[1]).ravel()], axis=1)
    cells = cKDTree(rng.uniform(0, 60, (9, 2))).query(places)[1].reshape(h, w) + 1
    discs = np.where(np.hypot(*(places - (25, 30)).T).reshape(h, w) < 15, 1, 0) + np.where(
        np.hypot(*(places - (38, 33)).T).reshape(h, w) < 9, 2, 0
    )
    for labels in (cells, discs):
        mesh = mesh_image(labels, labels=True, spacing=spacing, edge_length=6)
        assert mesh.report.kept, mesh.report.warnings
        oracles.check_valid(mesh.vertices, mesh.triangles)
        assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6


def check_kept(labels, spacing, **options):
    mesh = mesh_image(labels, labels=True, spacing=spacing, **options)
    assert mesh.report.kept, mesh.report.warnings
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6


@pytest.mark.parametrize("spacing", [(20.0, 1.0), (1.0, 8.0)])
@pytest.mark.parametrize("name", ["one pixel", "islands of a pixel", "checkerboard of two", "comb", "three meet"])
def test_needles_go_back_where_no_chord_is_blunt_enough(name, spacing):
    check_kept(specimens.ALL[name].astype(int), spacing)


@pytest.mark.parametrize("seed", range(12))
def test_random_label_maps_keep_all_promises_up_to_a_ratio_of_twenty(seed):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, rng.integers(2, 5), rng.integers(2, 6, 2))
    spacing = (1.0, float(rng.choice([5, 12, 20])))[:: rng.choice([1, -1])]
    options = ({}, {"tolerance": 1.25}, {"periodic": "xy"}, {"outline": "pixel"})[seed % 4]
    check_kept(labels, spacing, edge_length=float(rng.uniform(3, 12)), **options)
