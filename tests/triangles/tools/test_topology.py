"""Index helpers against loops that anyone can check."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from img2tri.arrays import unique_edges
from img2tri.triangles.tools.topology import (
    adjacency,
    boundary_edges,
    curve_edges,
    curve_vertices,
    directed_curves,
    directed_edges,
    interface_edges,
)


def random_mesh(seed, n=60):
    """Delaunay triangles of random points, counter-clockwise, with three regions."""
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    triangles = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    clockwise = np.cross(np.c_[b - a, np.zeros(len(a))], np.c_[c - a, np.zeros(len(a))])[:, 2] < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return points, triangles, (3 * points[triangles].mean(axis=1)[:, 0]).astype(np.int64)


def owners(triangles):
    """Undirected edge -> triangles at it."""
    found = {}
    for i, t in enumerate(triangles.tolist()):
        for k in range(3):
            found.setdefault(frozenset((t[k], t[(k + 1) % 3])), []).append(i)
    return found


def as_sets(edges):
    return {frozenset(e) for e in edges.tolist()}


seeds = given(st.integers(0, 10**6))
few = settings(max_examples=25, deadline=None)


@few
@seeds
def test_unique_edges_are_those_of_the_triangles(seed):
    _, triangles, _ = random_mesh(seed)
    edges, sides = unique_edges(triangles)
    found = owners(triangles)
    assert as_sets(edges) == set(found)
    assert len(edges) == len(found)
    assert (edges[:, 0] < edges[:, 1]).all()
    assert np.bincount(sides.ravel()).tolist() == [len(found[frozenset(e)]) for e in edges.tolist()]
    assert (np.sort(directed_edges(triangles), axis=1) == edges[sides.ravel()]).all()


def test_side_k_begins_in_corner_k():
    _, triangles, _ = random_mesh(0)
    sides = directed_edges(triangles).reshape(-1, 3, 2)
    for k in range(3):
        assert (sides[:, k] == triangles[:, [k, (k + 1) % 3]]).all()


@few
@seeds
def test_boundary_edges_are_the_hull_with_the_mesh_on_the_left(seed):
    points, triangles, _ = random_mesh(seed)
    edges = boundary_edges(triangles)
    assert as_sets(edges) == {e for e, at in owners(triangles).items() if len(at) == 1}
    middle = points.mean(axis=0)
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    assert ((b[:, 0] - a[:, 0]) * (middle[1] - a[:, 1]) > (b[:, 1] - a[:, 1]) * (middle[0] - a[:, 0])).all()
    # A closed curve: each of its vertices is left once and reached once.
    assert (np.sort(edges[:, 0]) == np.sort(edges[:, 1])).all()


@few
@seeds
def test_interface_and_curve_edges(seed):
    points, triangles, regions = random_mesh(seed)
    found = owners(triangles)
    interfaces = {e for e, at in found.items() if len(set(regions[at])) > 1}
    boundary = {e for e, at in found.items() if len(at) == 1}
    assert as_sets(interface_edges(triangles, regions)) == interfaces
    assert as_sets(curve_edges(triangles, regions)) == interfaces | boundary
    assert as_sets(curve_edges(triangles)) == boundary
    mask = curve_vertices(triangles, len(points), regions)
    assert set(np.flatnonzero(mask).tolist()) == set().union(*(interfaces | boundary))


@few
@seeds
def test_directed_curves_have_the_lower_region_on_the_left(seed):
    _, triangles, regions = random_mesh(seed)
    directed = directed_curves(triangles, regions)
    assert as_sets(directed) == as_sets(curve_edges(triangles, regions))
    assert len(directed) == len(curve_edges(triangles, regions))
    left = {tuple(e): i // 3 for i, e in enumerate(directed_edges(triangles).tolist())}
    for a, b in directed.tolist():
        assert (b, a) not in left or regions[left[a, b]] < regions[left[b, a]]
    assert (np.sort(directed_curves(triangles), axis=0) == np.sort(boundary_edges(triangles), axis=0)).all()


def test_an_edge_of_three_triangles_belongs_to_the_curves():
    triangles = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert frozenset((0, 1)) in as_sets(curve_edges(triangles))


@few
@seeds
def test_adjacency_is_the_neighbour_search_of_the_paper(seed):
    points, triangles, _ = random_mesh(seed, n=30)
    matrix = adjacency(triangles, len(points) + 1)
    for i in range(len(points) + 1):
        neighbours = set()
        for t in triangles.tolist():
            if i in t:
                neighbours.update(t)
        neighbours.discard(i)
        assert matrix.indices[matrix.indptr[i] : matrix.indptr[i + 1]].tolist() == sorted(neighbours)
    assert (matrix.data == 1).all()


def test_arguments_are_not_changed():
    points, triangles, regions = random_mesh(1)
    before = triangles.copy(), regions.copy()
    adjacency(triangles, len(points))
    directed_curves(triangles, regions)
    assert (triangles == before[0]).all()
    assert (regions == before[1]).all()


@pytest.mark.parametrize("function", [boundary_edges, curve_edges, directed_curves, directed_edges])
def test_no_triangles_have_no_edges(function):
    assert function(np.zeros((0, 3), np.int64)).shape == (0, 2)
