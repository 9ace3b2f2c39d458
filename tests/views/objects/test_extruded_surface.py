from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from oracles import areas, pixel_topology
from views.plates import cells, euler, is_closed, ring, strip, volume

from img2tri.errors import MeshError, ParameterError
from img2tri.views.objects.extruded_surface import extrude


def test_a_ring_becomes_a_closed_solid_with_a_through_hole():
    vertices, triangles = ring()
    solid = extrude(vertices, triangles, 2.5, z=1.0)
    points, faces = solid.points, solid.faces
    assert points.shape == (48, 3)
    assert len(faces) == 2 * 24 + 2 * (16 + 8)
    assert is_closed(faces)
    assert volume(points, faces) == pytest.approx(12 * 2.5, rel=1e-14)
    assert euler(faces) == 0  # a torus
    assert points.min(axis=0).tolist() == [0, 0, 1]
    assert points.max(axis=0).tolist() == [4, 4, 3.5]
    # No face crosses the hole: a line through its middle meets none.
    assert not np.any((np.abs(points[faces][..., :2].mean(axis=1) - 2) < 1).all(axis=1))


def test_bottom_top_and_walls_look_outwards():
    vertices, triangles = ring()
    solid = extrude(vertices, triangles, 1)
    points, faces, sources = solid.points, solid.faces, solid.sources
    p, q, r = (points[faces[:, k]] for k in range(3))
    normal = np.cross(q - p, r - p)
    m = len(triangles)
    assert np.all(normal[:m, 2] < 0)
    assert np.all(normal[m : 2 * m, 2] > 0)
    assert np.all(normal[2 * m :, 2] == 0)
    inside = np.column_stack([vertices[triangles[sources]].mean(axis=1), np.full(len(faces), 0.5)])
    assert np.all((normal * (p - inside)).sum(axis=1) > 0)


def test_each_face_comes_from_the_triangle_it_lies_at():
    vertices, triangles, _ = strip()
    solid = extrude(vertices, triangles, 1)
    points, faces, sources = solid.points, solid.faces, solid.sources
    m = len(triangles)
    assert np.array_equal(sources[: 2 * m], np.tile(np.arange(m), 2))
    for face, source in zip(faces[2 * m :], sources[2 * m :], strict=True):
        corners = {tuple(point) for point in points[face][:, :2].tolist()}
        assert corners < {tuple(point) for point in vertices[triangles[source]].tolist()}


def test_parts_that_touch_in_a_vertex_stay_closed():
    vertices, triangles = cells(np.array([[True, False, True], [False, True, False], [True, False, True]]))
    solid = extrude(vertices, triangles, 3)
    points, faces = solid.points, solid.faces
    assert is_closed(faces)
    assert len(points) == 2 * (len(vertices) + 4)
    assert euler(faces) == 5 * 2
    assert volume(points, faces) == pytest.approx(15)


def test_many_fans_around_one_vertex_stay_closed():
    turn = np.arange(12) * np.pi / 6
    vertices = np.concatenate([[[0, 0]], np.stack([np.cos(turn), np.sin(turn)], axis=1)])
    every_other = np.stack([np.zeros(6, int), np.arange(1, 12, 2), np.arange(2, 13, 2)], axis=1)
    solid = extrude(vertices, every_other, 1)
    points, faces = solid.points, solid.faces
    assert is_closed(faces)
    assert euler(faces) == 6 * 2
    assert len(points) == 2 * (13 + 5)


@given(nps.arrays(bool, st.tuples(st.integers(1, 6), st.integers(1, 6))).filter(np.any), st.floats(0.01, 100))
def test_any_set_of_cells_becomes_a_closed_solid(mask, height):
    vertices, triangles = cells(mask)
    solid = extrude(vertices, triangles, height)
    points, faces, sources = solid.points, solid.faces, solid.sources
    assert is_closed(faces)
    assert volume(points, faces) == pytest.approx(areas(vertices, triangles).sum() * height, rel=1e-9)
    components, holes = pixel_topology(mask)  # joined through sides, as the solid is
    assert euler(faces) == 2 * (components - holes)
    assert len(sources) == len(faces)


def test_the_arguments_are_left_as_they_are():
    vertices, triangles = ring()
    before = vertices.copy(), triangles.copy()
    extrude(vertices, triangles, 1)
    assert np.array_equal(vertices, before[0])
    assert np.array_equal(triangles, before[1])


@pytest.mark.parametrize("height", [0, -1, np.nan, np.inf, "tall", None])
def test_height_has_to_be_above_zero(height):
    with pytest.raises(ParameterError, match="height: expected a number above 0, found"):
        extrude(*ring(), height)


def test_z_has_to_be_finite():
    with pytest.raises(ParameterError, match="z: expected a number, found nan"):
        extrude(*ring(), 1, z=np.nan)


def test_triangles_wound_against_each_other_are_refused():
    vertices, triangles = cells(np.ones((1, 1), bool))
    with pytest.raises(MeshError, match="found 1 that run along a side in the same direction"):
        extrude(vertices, np.array([triangles[0], triangles[1][::-1]]), 1)
