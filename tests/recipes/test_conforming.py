"""The conforming recipe on tiny difficult label maps: all promises, under rotation and mirroring."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens
from benchmarks.shapes import gear, leaf

from img2tri import mesh_image
from img2tri.options.all_options import checked, of
from img2tri.options.mesh_options import FillOptions
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes import conforming
from img2tri.recipes.conforming import conform, trace_outlines
from img2tri.recipes.wanted_sizes import Sizes
from img2tri.types import Frame


def check(labels, *, background=0, edge_length=8.0):
    outlines, dual_edges = trace_outlines(Segmentation(labels, background), Frame(labels.shape))
    made = conform(outlines, dual_edges, Sizes(edge_length, 0.17), tolerance=0.5, corners="auto", **of(FillOptions, checked({})))
    regions = outlines.labels[made.regions]
    oracles.check_valid(made.vertices, made.triangles)
    assert oracles.angles(made.vertices, made.triangles).min() >= 30 - 1e-6
    oracles.check_faithful(made.vertices, made.triangles, regions, labels, background=background)
    return made


@pytest.mark.parametrize("name", specimens.ALL)
def test_specimens_keep_all_promises(name):
    for labels in specimens.turned(specimens.ALL[name]):
        check(labels)


@pytest.mark.parametrize("name", specimens.ALL)
def test_specimens_without_background(name):
    check(specimens.ALL[name], background=None)


@pytest.mark.parametrize("density", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_noise(density):
    labels = (np.random.default_rng(7).random((32, 32)) < density).astype(int)
    check(labels)


@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_random_labels(count):
    labels = np.random.default_rng(count).integers(0, count, (20, 20))
    check(labels)
    check(labels, background=None)


@pytest.mark.parametrize("edge_length", [1.0, 2.5, 16.0, 100.0])
def test_any_edge_length(edge_length):
    check(specimens.disc(30, 12), edge_length=edge_length)
    check(specimens.polycrystal(), edge_length=edge_length)


def test_where_no_outlines_can_be_filled_its_error_is_what_one_gets(monkeypatch):
    """Also where refining the outlines changes nothing any more, before all attempts are used up."""
    from img2tri.errors import MeshError
    from img2tri.triangles.generate import filling
    from img2tri.triangles.generate.constrained_delaunay import PslgError

    tried = []

    def never(*_, **__):
        tried.append(1)
        raise PslgError("points: expected another one")

    monkeypatch.setattr(filling, "begin", never)
    with pytest.raises(MeshError, match="expected another one"):
        mesh_image(np.ones((1, 1), bool), edge_length=8)
    assert 1 < len(tried) <= conforming.ATTEMPTS


def rim(radius, **options):
    """How many edges a disc has along its outline."""
    disc = np.hypot(*np.mgrid[-radius - 3 : radius + 3, -radius - 3 : radius + 3] + 0.5) < radius
    return len(oracles.boundary(mesh_image(disc, **options).triangles))


@pytest.mark.parametrize(("radius", "edge_length"), [(18, 8), (25, 12), (12, 6)])
def test_edges_turn_by_no_more_than_a_twentieth_of_a_full_turn(radius, edge_length):
    assert 20 <= rim(radius, edge_length=edge_length) <= 24


def test_for_that_edges_get_no_shorter_than_a_third_of_what_is_wanted():
    assert rim(18, edge_length=8, segments_per_turn=3) < 16
    assert rim(8, edge_length=9) < 18 < rim(8, edge_length=9, segments_per_turn=20)


def test_corners_are_not_taken_for_curves():
    mask = gear(20, 380, 0.3)
    count, least = (len(mesh_image(mask, edge_length=8, **o).triangles) for o in ({}, {"segments_per_turn": 3}))
    assert count < 1.05 * least


def test_silhouettes_have_angles_better_than_promised():
    meshes = [mesh_image(mask, edge_length=8) for mask in (leaf(9, 360, 1.0), leaf(12, 300, 4.0), leaf(16, 440, 2.0), gear(28, 412, 5.0))]
    assert min(oracles.angles(mesh.vertices, mesh.triangles).min() for mesh in meshes) >= 32 - 1e-9
