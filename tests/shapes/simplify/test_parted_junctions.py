"""Junctions that are near each other are moved apart, and nothing else is."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens

from img2tri import mesh_image
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes.conforming import trace_outlines
from img2tri.shapes.simplify import parted_junctions
from img2tri.shapes.simplify.parted_junctions import JUNCTIONS_APART, part_junctions
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.vertex_offsets import MOST_OFFSET
from img2tri.types import Frame


def spaced(labels, spacing=8.0):
    outlines, dual_edges = trace_outlines(Segmentation(labels, 0), Frame(labels.shape))
    return space_evenly(outlines, dual_edges, spacing=spacing), np.full(len(outlines.chains.indices), spacing)


def quarters(turn, centre=(30.3, 29.6), n=60):
    """Four regions that meet in a point."""
    y, x = np.mgrid[:n, :n] + 0.5
    z = ((x - centre[0]) + 1j * (y - centre[1])) * np.exp(1j * turn)
    return 1 + (z.real > 0) + 2 * (z.imag > 0)


def joined(s):
    """The two junctions of chains that have one at both ends, by chain."""
    one, other = s.chains.ends
    return [(a, b) for a, b in zip(one, other, strict=True) if a != b and s.dual_edges.is_junction[[a, b]].all()]


def places(s):
    z = np.zeros(len(s.dual_edges.middle), complex)
    z[s.chains.indices[s.kept]] = s.places[s.kept]
    return z


@pytest.mark.parametrize("turn", np.linspace(0.25, 1.35, 9))
def test_four_regions_that_meet_in_a_point_have_two_junctions_far_enough_apart(turn):
    s, spacing = spaced(quarters(turn))
    (pair,) = joined(s)
    before, after = (abs(np.subtract(*places(part)[list(pair)])) for part in (s, part_junctions(s, spacing=spacing, tolerance=0.5)))
    assert before < JUNCTIONS_APART
    assert min(JUNCTIONS_APART, before + 2 * MOST_OFFSET * 0.5) - 0.1 < after < JUNCTIONS_APART + 0.1


@pytest.mark.parametrize("tolerance", [0.1, 0.5])
@pytest.mark.parametrize("length", [0.7, 8.0])
def test_junctions_nearby_go_apart_within_the_tolerance_and_all_else_stays(length, tolerance):
    s, spacing = spaced(specimens.polycrystal(160, 250, 4), length)
    parted = part_junctions(s, spacing=spacing, tolerance=tolerance)
    moved = np.abs(parted.offset - s.offset)
    near = [pair for pair in joined(s) if abs(np.subtract(*places(s)[list(pair)])) < min(JUNCTIONS_APART, length)]
    assert len(near) > 3
    assert 0 < moved.max() <= MOST_OFFSET * tolerance + 1e-12
    at = s.chains.indices[moved > 0]
    assert np.isin(at, near).all()
    # All chains that end there end at the same place, in the block of the junction.
    for point in np.unique(near):
        ends = parted.places[s.chains.indices == point]
        assert np.ptp(ends.real) == np.ptp(ends.imag) == 0
    off = places(parted)[at] - s.dual_edges.middle[at]
    assert (np.maximum(np.abs(off.real), np.abs(off.imag)) <= 0.49 + 1e-12).all()
    gained = [abs(np.subtract(*places(parted)[list(pair)])) - abs(np.subtract(*places(s)[list(pair)])) for pair in near]
    assert np.mean(gained) > 0.05


def test_where_no_junctions_are_near_nothing_is_done():
    for labels in (specimens.disc(40, 12.3), quarters(0.3)[:, :25], specimens.polycrystal(90, 5, 3)):
        s, spacing = spaced(labels)
        assert part_junctions(s, spacing=spacing, tolerance=0.5) is s


def test_many_grains_cost_less_than_with_junctions_left_where_they_are(monkeypatch):
    labels = specimens.polycrystal(150, 120, 7)
    mesh = mesh_image(labels, edge_length=8, labels=True)
    assert mesh.report.kept
    assert oracles.angles(mesh.vertices, mesh.triangles).min() > 30
    monkeypatch.setattr(parted_junctions, "JUNCTIONS_APART", 0.0)
    left = mesh_image(labels, edge_length=8, labels=True)
    assert len(mesh.triangles) < 0.9 * len(left.triangles)
