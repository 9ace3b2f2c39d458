"""Filling networks: valid meshes with the outlines as edges, good angles, the options, and what is refused."""

from __future__ import annotations

import hashlib
import subprocess
import sys

import numpy as np
import oracles
import pytest
from networks import NETWORKS, RING, area_of_ring, network, ring, wave

from img2tri.errors import ParameterError
from img2tri.triangles.generate import constrained_delaunay as delaunay
from img2tri.triangles.generate import filling
from img2tri.triangles.generate.filling import begin, fill, finish
from img2tri.triangles.generate.graded_lattice import lengths_near
from img2tri.triangles.generate.interior_sizes import SizeFunction
from img2tri.triangles.generate.pslg import Pslg


def enclosed(points, segments, left, right):
    """Area of each region by the shoelace formula: each segment counts for the regions on both sides."""
    (x0, y0), (x1, y1) = points[segments[:, 0]].T, points[segments[:, 1]].T
    swept = 0.5 * (x0 * y1 - x1 * y0)
    names = sorted({*left.tolist(), *right.tolist()} - {0})
    return {r: swept[left == r].sum() - swept[right == r].sum() for r in names}


def check(given, mesh):
    points, segments = given[:2]
    vertices, triangles, regions = mesh
    oracles.check_valid(vertices, triangles)
    a = oracles.areas(vertices, triangles)
    assert (a > 0).all()
    assert len(np.unique(triangles)) == len(vertices)
    assert oracles.edge_counts(triangles)[1].max() <= 2
    assert (vertices[: len(points)] == points).all()
    assert {int(r): a[regions == r].sum() for r in np.unique(regions)} == pytest.approx(enclosed(*given), rel=1e-9)
    # The boundary and interfaces of the mesh have the length of the outlines, and lie on their lines.
    outer, inner = oracles.boundary(triangles), oracles.interfaces(triangles, regions)
    edges = np.concatenate([outer, inner])
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1).sum()
    assert length == pytest.approx(np.linalg.norm(points[segments[:, 0]] - points[segments[:, 1]], axis=1).sum(), rel=1e-9)
    assert oracles.two_sided_distance(vertices[edges], points[segments], 0.5) < 1e-9


@pytest.mark.parametrize("name", NETWORKS)
def test_meshes_are_valid_and_keep_outlines_and_areas(name):
    given, edge_length = NETWORKS[name]
    mesh = fill(*given, edge_length=edge_length)
    check(given, mesh)
    assert oracles.angles(mesh[0], mesh[1]).min() >= 30 - 1e-9


@pytest.mark.parametrize("edge_length", [3.0, 3.7, 5.0, 8.0])
@pytest.mark.parametrize("seed", range(4))
def test_even_outlines_give_40_degrees_and_nearly_equilateral_triangles(edge_length, seed):
    outer, inner = round(660 / edge_length), round(2 * np.pi * 25 / edge_length)
    given = network((wave(outer, 100, lobes=3), 1, 0), (ring(inner, 25), 0, 1))
    vertices, triangles, _ = fill(*given, edge_length=edge_length, seed=seed)
    assert oracles.angles(vertices, triangles).min() > 40
    best = np.sqrt(3) / 4 * edge_length**2
    assert oracles.areas(vertices, triangles).mean() == pytest.approx(best, rel=0.1)
    assert oracles.angles(vertices, triangles).min(axis=1).mean() > 54


def test_segments_stay_whole_where_they_are_short_enough():
    _, triangles, _ = fill(*RING, edge_length=4.0)
    edges = set(map(tuple, oracles.edge_counts(triangles)[0].tolist()))
    assert all(tuple(sorted(s)) in edges for s in RING[1].tolist())


def test_long_segments_are_divided():
    given, edge_length = NETWORKS["square"]
    vertices, triangles, _ = fill(*given, edge_length=edge_length)
    edges = oracles.boundary(triangles)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    assert lengths == pytest.approx(2.0)


def test_parts_of_a_segment_grow_with_the_wanted_length():
    line = Pslg(np.array([0, 100.0]) + 0j, np.array([[0, 1]]), np.array([1]), np.array([0]), np.array([0]))
    sizes = SizeFunction(50.0, 0.3, np.array([0j]), np.array([1.0]))
    divided, at_points, at_middles = line.divided(sizes)
    places = np.sort(divided.points.real)
    assert divided.points[:2] == pytest.approx(line.points)
    assert np.diff(places) == pytest.approx(sizes.at((places[1:] + places[:-1]) / 2 + 0j), rel=0.25)
    assert set(divided.origin) == {0}
    assert divided.lengths.sum() == pytest.approx(100)
    assert (at_points == sizes.at(divided.points)).all()
    assert (at_middles == sizes.at(divided.middles)).all()


def test_the_wanted_length_grows_from_its_sources():
    sources, lengths = np.array([0, 3 + 1j, 20j]), np.array([1.0, 0.2, 2.0])
    places = np.random.default_rng(1).uniform(-30, 30, 200) + 1j * np.random.default_rng(2).uniform(-30, 30, 200)
    found = SizeFunction(6.0, 0.3, sources, lengths).at(places)
    exact = np.minimum(6, (lengths + 0.3 * np.abs(places[:, None] - sources)).min(axis=1))
    assert found == pytest.approx(exact)


@pytest.mark.parametrize("gradation", [0.17, 0.3])
@pytest.mark.parametrize("name", ["ring", "grains", "speck"])
def test_edges_are_as_long_as_wanted(name, gradation):
    given, edge_length = NETWORKS[name]
    vertices, triangles, _ = fill(*given, edge_length=edge_length, gradation=gradation)
    z = vertices[:, 0] + 1j * vertices[:, 1]
    edges, _ = oracles.edge_counts(triangles)
    start, stop = given[0][given[1][:, 0]], given[0][given[1][:, 1]]
    middles, lengths = (start + stop) / 2, np.linalg.norm(stop - start, axis=1)
    sizes = lengths_near(middles[:, 0] + 1j * middles[:, 1], lengths, edge_length, gradation)
    ratio = np.abs(z[edges[:, 0]] - z[edges[:, 1]]) / sizes.at(z[edges].mean(axis=1))
    assert 0.9 < np.median(ratio) < 1.1
    assert ((ratio > 0.6) & (ratio < 1.5)).mean() > 0.95


@pytest.mark.parametrize("name", ["ring", "grains", "drop"])
def test_scaling_the_network_does_so_with_the_mesh(name):
    given, edge_length = NETWORKS[name]
    vertices, triangles, regions = fill(*given, edge_length=edge_length)
    larger = fill(given[0] * 4, *given[1:], edge_length=4 * edge_length)
    assert (larger[1] == triangles).all()
    assert (larger[2] == regions).all()
    assert (larger[0] == vertices * 4).all()


@pytest.mark.parametrize("name", ["ring", "grains", "drop"])
def test_a_network_far_away_gets_as_good_a_mesh(name):
    given, edge_length = NETWORKS[name]
    here = fill(*given, edge_length=edge_length)
    shifted = (given[0] + np.array([12345.6, -654.3]), *given[1:])
    there = fill(*shifted, edge_length=edge_length)
    assert len(there[1]) == pytest.approx(len(here[1]), rel=0.02)
    assert oracles.angles(*there[:2]).min() > 30 - 1e-9
    assert oracles.angles(*there[:2]).min(axis=1).mean() == pytest.approx(oracles.angles(*here[:2]).min(axis=1).mean(), abs=0.5)


CODE = """
import sys, hashlib
sys.path[:0] = {path!r}
from networks import NETWORKS
from img2tri.triangles.generate.filling import fill
given, edge_length = NETWORKS["grains"]
print(hashlib.sha256(b"".join(a.tobytes() for a in fill(*given, edge_length=edge_length))).hexdigest())
"""


def test_the_same_network_gives_the_same_bytes_in_another_process():
    given, edge_length = NETWORKS["grains"]
    here = hashlib.sha256(b"".join(a.tobytes() for a in fill(*given, edge_length=edge_length))).hexdigest()
    there = subprocess.run([sys.executable, "-c", CODE.format(path=sys.path)], capture_output=True, text=True, check=True).stdout.strip()
    assert here == there


def test_arguments_are_not_changed():
    given = [a.copy() for a in NETWORKS["grains"][0]]
    for a in given:
        a.setflags(write=False)
    fill(*given, edge_length=4.0)


def test_a_seed_shifts_the_lattice_only():
    one, two, three = (fill(*RING, edge_length=4.0, seed=seed) for seed in (0, 1, 1))
    assert len(one[0]) != len(two[0]) or not np.allclose(one[0], two[0])
    assert all((a == b).all() for a, b in zip(two, three, strict=True))
    check(RING, two)


def test_gradation_changes_how_fast_triangles_grow():
    given, edge_length = NETWORKS["speck"]
    slow, fast = (fill(*given, edge_length=edge_length, gradation=g) for g in (0.15, 0.6))
    assert len(slow[1]) > len(fast[1])
    check(given, slow)


def test_a_size_for_each_point():
    size = np.where(RING[0][:, 0] > 90, 1.0, 4.0)
    mesh = fill(*RING, edge_length=4.0, size=size)
    check(RING, mesh)
    a, x = oracles.areas(*mesh[:2]), mesh[0][mesh[1]].mean(axis=1)[:, 0]
    assert np.median(a[x > 95]) < 0.3 * np.median(a[x < 60])


def test_a_field_of_sizes():
    def field(places):
        return 1.2 + 0.2 * np.linalg.norm(places - [50, 20], axis=1)

    mesh = fill(*RING, edge_length=4.0, size=field)
    check(RING, mesh)
    middles = mesh[0][mesh[1]].mean(axis=1)
    edge = np.sqrt(4 / np.sqrt(3) * oracles.areas(*mesh[:2]))
    ratio = edge / np.minimum(4, field(middles))
    assert 0.9 < np.median(ratio) < 1.1
    assert ((ratio > 0.6) & (ratio < 1.5)).mean() > 0.95
    assert oracles.angles(*mesh[:2]).min() > 30 - 1e-9


def test_the_least_angle_asked_for_is_reached_by_adding_points():
    given = network((ring(60, 10), 1, 0), (ring(60, 8.8, (1, 0)), 0, 1))
    low, high = (fill(*given, edge_length=1.05, min_angle=a) for a in (5.0, 30.0))
    assert 5 <= oracles.angles(*low[:2]).min() < 30
    assert oracles.angles(*high[:2]).min() >= 30 - 1e-9
    assert len(high[1]) > len(low[1])
    check(given, high)


def test_a_sharp_corner_stays_and_all_ends():
    given = network((np.array([[0.0, 0], [30, 0], [30, 3.0]]), 1, 0))
    mesh = fill(*given, edge_length=4.0)
    check(given, mesh)


def test_nothing_to_mesh():
    points, segments, _, _ = RING
    none = np.zeros(len(segments), np.int64)
    vertices, triangles, regions = fill(points, segments, none, none, edge_length=4.0)
    assert (vertices == points).all()
    assert triangles.shape == (0, 3)
    assert regions.shape == (0,)


def test_a_large_area_costs_its_outline():
    calls = []
    original = delaunay.insert

    def counted(points, segments):
        calls.append(len(points))
        return original(points, segments)

    given = network((ring(314, 400), 1, 0))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(delaunay, "insert", counted)
        vertices, triangles, _ = fill(*given, edge_length=8.0)
    assert max(calls) < len(vertices) / 3
    assert oracles.areas(vertices, triangles).sum() == pytest.approx(area_of_ring(314, 400))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"edge_length": 0.0}, "edge_length: expected a number above 0"),
        ({"edge_length": np.nan}, "edge_length"),
        ({"min_angle": 41.0}, "min_angle"),
        ({"gradation": 0.0}, "gradation"),
        ({"seed": -1}, "seed"),
        ({"size": np.ones(3)}, "size: expected a positive length"),
        ({"size": -np.ones(200)}, "size: expected a positive length"),
    ],
)
def test_options_that_cannot_be(options, message):
    with pytest.raises(ParameterError, match=message):
        fill(*RING, **{"edge_length": 4.0, **options})


def test_errors_name_the_segments_that_were_given():
    points, segments, left, right = NETWORKS["square"][0]
    square = np.concatenate([points, points + np.array([100.0, 0])])
    segments = np.concatenate([segments, segments + 4])
    left, right = np.concatenate([left, left]), np.concatenate([right, right])
    left[5] = 2
    with pytest.raises(delaunay.PslgError) as caught:
        fill(square, segments, left, right, edge_length=2.0)
    assert set(caught.value.segments) <= {4, 5, 6, 7}
    assert len(caught.value.segments)


@pytest.mark.parametrize("seed", range(4))
def test_points_slide_as_far_as_they_may_and_triangles_get_better(seed):
    """Two rings, one in the other, of as many segments: what is between is as good as these stand."""
    turn = 2 * np.pi * np.random.default_rng(seed).uniform() / 60
    inner = ring(60, 25) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    given = network((ring(60, 30), 1, 0), (inner, 0, 1))
    points = given[0]
    limits = np.where(np.arange(len(points)) % 5, 0.6, 0)
    fixed, fixed_triangles, _ = fill(*given, edge_length=3.0)
    begun = begin(*given, edge_length=3.0, limits=limits)
    way = np.hypot(*(begun.wanted - points).T)
    assert (way <= limits + 1e-12).all()
    assert way.max() > 0.05
    # Of the inner ones the outlines let none go.
    places = np.where(np.arange(len(points))[:, None] < 60, begun.wanted, points)
    vertices, triangles, _, irregular = finish(begun, places)
    assert (abs(oracles.angles(vertices, triangles[irregular:]) - 60) < 1e-9).all()
    oracles.check_valid(vertices, triangles)
    assert np.array_equal(vertices[: len(points)], places)
    both = finish(begun)
    assert np.array_equal(both[0][: len(points)], begun.wanted)
    quality = [oracles.angles(v, t).min(axis=1).mean() for v, t in ((fixed, fixed_triangles), both[:2])]
    assert quality[1] > quality[0]


@pytest.mark.parametrize("failures", [1, 2, 3])
def test_where_refinement_would_have_to_split_the_core_there_is_less_of_it(failures, monkeypatch):
    given = network((wave(220, 100, lobes=3), 1, 0))
    cores, refine_locally = [], filling.refine_with_reserve

    def reluctant(vertices, triangles, codes, constraints, n_outline, min_angle):
        cores.append(len(constraints.segments) - n_outline)
        return None if len(cores) < failures else refine_locally(vertices, triangles, codes, constraints, n_outline, min_angle)

    monkeypatch.setattr(filling, "refine_with_reserve", reluctant)
    mesh = fill(*given, edge_length=3.0)
    check(given, mesh)
    assert cores == sorted(cores, reverse=True)
    assert len(set(cores)) == failures == len(cores)
    assert cores[-1] == 0 or failures < 3
