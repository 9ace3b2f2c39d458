"""Curves that lack area get as many vertices as theory says, evenly; all else stays as it is."""

from __future__ import annotations

import numpy as np
import pytest
import specimens

import img2tri
from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.simplify.area_preservation import area_errors, preserve_areas
from img2tri.shapes.simplify.closer_spacing import spaced_closer
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.vertex_offsets import MOST_OFFSET
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame


def drafted(labels, spacing=100.0):
    outlines, dual_edges = place_outlines(find_crack_edges(labels), Frame(labels.shape))
    return space_evenly(outlines, dual_edges, spacing=spacing)


@pytest.mark.parametrize("radius", [9.3, 14.2, 25.1, 38.4])
@pytest.mark.parametrize("tolerance", [0.2, 0.5])
def test_a_circle_gets_the_vertices_it_takes_and_has_its_area_the_next_time(radius, tolerance):
    once = preserve_areas(drafted(specimens.disc(90, radius, (45.2, 44.9))), tolerance=tolerance)
    first, last = once.chords
    # Vertices outside by h^2 / 12 R keep the area, and by no more than `MOST_OFFSET` of the tolerance.
    fewest = 2 * np.pi * radius / np.sqrt(12 * radius * MOST_OFFSET * tolerance)
    assert fewest - 0.5 < len(first) <= fewest + 2
    length = np.abs(once.places[last] - once.places[first])
    assert length.max() < 1.2 * length.min()
    assert area_errors(preserve_areas(once, tolerance=tolerance)).max() < 3e-3


def test_only_runs_near_the_regions_that_are_off_change():
    labels = np.zeros((60, 120), int)
    labels[:, :60], labels[:, 60:] = specimens.disc(60, 22.3), 2 * specimens.disc(60, 22.3)
    s = drafted(labels, 12.0)
    new = spaced_closer(s, np.array([False, True, False]), tolerance=0.5)
    beyond = ((s.outlines.left == 2) | (s.outlines.right == 2))[s.chains.chain]
    assert (new.kept != s.kept).any()
    assert not ((new.kept != s.kept) | (new.offset != s.offset))[beyond].any()


@pytest.mark.parametrize(("edge_length", "most"), [(15.7, 160), (31.4, 100), (80.0, 100)])
def test_discs_in_discs_have_their_areas_with_few_triangles(edge_length, most):
    """What the outer circle cannot hold is shared by ring and disc."""
    labels = specimens.disc(80, 35.1) + specimens.disc(80, 20.4, (40.3, 39.6))
    mesh = img2tri.mesh_image(labels, labels=True, edge_length=edge_length)
    assert len(mesh.triangles) <= most
    assert max(abs(area["error"]) for area in mesh.report.areas.values()) <= 2e-5


@pytest.mark.parametrize("radius", [5.0, 8.3, 9.6, 10.4, 14.1, 17.7])
def test_discs_smaller_than_the_edges_take_few_triangles(radius):
    mesh = img2tri.mesh_image(specimens.disc(44, radius, (22.13, 21.9)) == 1, edge_length=2.5 * radius)
    assert len(mesh.triangles) <= 45
    assert mesh.report.kept
    assert abs(mesh.report.areas[1]["error"]) < 1e-3
