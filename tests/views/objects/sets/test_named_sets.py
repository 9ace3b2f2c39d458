"""Named parts of a mesh, against polygons of shapely and edges counted one by one."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens
from views.plates import cells, ring
from views.solver_meshes import AREAS, BOUNDS, LENGTHS, NAMES, SIZE, TAGS, plate

from img2tri import MeshError, ParameterError, mesh_image
from img2tri.views.objects.sets.named_sets import FRAME, boundary_rings, named_sets

MAPS = {**specimens.MASKS, **specimens.LABELS}


def as_sets(edges):
    return {tuple(sorted(edge)) for edge in np.asarray(edges).reshape(-1, 2).tolist()}


def joined(sets, names):
    return set().union(*(as_sets(sets.edges[name]) for name in names if name in sets.edges))


def made_of(labels, **options):
    mesh = mesh_image(labels, labels=True, edge_length=3, **options)
    return mesh, named_sets(mesh.vertices, mesh.triangles, mesh.regions, bounds=mesh.frame.bounds)


@pytest.fixture(scope="module", params=[name for name in MAPS if (np.asarray(MAPS[name]) != 0).any()])
def case(request):
    return made_of(np.asarray(MAPS[request.param]))


def test_every_edge_of_boundary_and_interfaces_is_in_one_set_and_no_other_edge_in_any(case):
    mesh, sets = case
    wholes = [edges for name, edges in sets.edges.items() if name not in sets.part_of]
    every = [edge for edges in wholes for edge in map(tuple, np.sort(edges, axis=1).tolist())]
    assert len(every) == len(set(every))
    inner = {name for name in sets.edges if "__" in name}
    assert joined(sets, sets.edges.keys() - inner) == as_sets(oracles.boundary(mesh.triangles))
    assert joined(sets, inner) == as_sets(oracles.interfaces(mesh.triangles, mesh.regions))


def test_holes_are_those_of_the_polygon_by_area_and_the_rest_of_it_is_outer(case):
    mesh, sets = case
    whole = shapely.union_all(shapely.polygons(mesh.vertices[mesh.triangles]))
    parts = [whole] if whole.geom_type == "Polygon" else list(whole.geoms)
    holes = sorted((shapely.Polygon(inner) for part in parts for inner in part.interiors), key=lambda hole: -hole.area)
    names = [name for name in sets.edges if name.startswith("hole_")]
    assert names == [f"hole_{i + 1}" for i in range(len(holes))]
    areas = []
    for name in names:
        lines = shapely.union_all(shapely.linestrings(mesh.vertices[sets.edges[name]]))
        (found,) = shapely.get_parts(shapely.polygonize([lines])) if lines.geom_type != "Polygon" else [lines]
        areas.append(found.area)
    assert areas == pytest.approx([hole.area for hole in holes], rel=1e-9)
    around = shapely.MultiLineString([part.exterior for part in parts])
    outer = [sets.edges[name] for name in (*FRAME, "outer") if name in sets.edges]
    length = np.linalg.norm(np.diff(mesh.vertices[np.concatenate(outer)], axis=1), axis=2).sum()
    assert length == pytest.approx(around.length, rel=1e-9)


def test_sides_of_the_frame_are_what_lies_there(case):
    mesh, sets = case
    left, bottom, right, top = mesh.frame.bounds
    boundary = oracles.boundary(mesh.triangles)
    for name, axis, value in (("left", 0, left), ("right", 0, right), ("bottom", 1, bottom), ("top", 1, top)):
        there = as_sets(boundary[np.all(mesh.vertices[boundary][:, :, axis] == value, axis=1)])
        assert joined(sets, [name]) == there
        assert (name in sets.edges) == bool(there)


def test_edges_are_sides_of_their_triangles_and_interfaces_those_of_the_lower_label(case):
    mesh, sets = case
    for name, sides in sets.sides.items():
        triangle, side = sides.T
        ends = [mesh.triangles[triangle, side], mesh.triangles[triangle, (side + 1) % 3]]
        assert np.array_equal(sets.edges[name], np.stack(ends, axis=1))
        if "__" in name:
            a, b = (sets.labels[part] for part in name.split("__"))
            assert a < b
            assert set(mesh.regions[triangle].tolist()) == {a}


def test_regions_are_all_triangles(case):
    mesh, sets = case
    assert list(sets.labels.values()) == sorted(set(mesh.regions.tolist()))
    for name, label in sets.labels.items():
        assert np.array_equal(sets.regions[name], np.flatnonzero(mesh.regions == label))


def plate_sets(**options):
    return named_sets(*plate(), **{"bounds": BOUNDS, "names": NAMES, **options})


def wholes(sets):
    return {name: len(edges) for name, edges in sets.edges.items() if name not in sets.part_of}


def test_the_sets_of_the_plate():
    sets = plate_sets()
    assert {name: len(edges) for name, edges in sets.edges.items()} == LENGTHS
    assert sets.labels == {"region_-1": -1, "bone": 4}
    assert {name: len(rows) for name, rows in sets.regions.items()} == {name: 2 * area for name, area in AREAS.items()}
    assert sets.tags == {name: TAGS[name] for name in LENGTHS}


def test_tags_of_the_frame_do_not_depend_on_what_is_there():
    plain = plate_sets(bounds=None)
    expected = {"outer": 1005, "hole_1": 1011, "hole_2": 1012, "region_-1__bone": 1013}
    assert {name: tag for name, tag in plain.tags.items() if name not in plain.part_of} == expected
    wide = plate_sets(bounds=(*BOUNDS[:2], BOUNDS[2] - SIZE, BOUNDS[3])).tags
    assert wide == {"left": 1001, "right": 1002, "bottom": 1003, **expected}


def test_a_mesh_as_large_as_the_image_has_all_four_sides_and_no_outer():
    vertices, triangles, regions = plate()
    sets = named_sets(vertices, triangles, regions, bounds=(*vertices.min(axis=0), *vertices.max(axis=0)))
    assert {name: len(sets.edges[name]) for name in FRAME} == {"left": 4, "right": 4, "bottom": 5, "top": 5}
    assert "outer" not in sets.edges
    assert [sets.tags[name] for name in FRAME] == [1001, 1002, 1003, 1004]


def test_without_a_frame_all_of_it_is_outer():
    assert len(plate_sets(bounds=None).edges["outer"]) == 18


def test_the_frame_is_met_though_coordinates_are_rounded():
    vertices, triangles, regions = plate()
    far = vertices * 0.1 + 1e6 / 3
    assert not np.array_equal((far - 1e6 / 3) / 0.1, vertices)
    bounds = tuple(np.array(BOUNDS) * 0.1 + 1e6 / 3)
    assert set(named_sets(far, triangles, regions, bounds=bounds).edges) >= {"left", "bottom"}


def test_names_are_the_users_and_unique():
    sets = plate_sets(names={-1: "wood", 4: "wood"})
    assert list(sets.labels) == ["wood_-1", "wood_4"]
    assert "wood_-1__wood_4" in sets.edges
    assert list(plate_sets(names=None).labels) == ["region_-1", "region_4"]


def test_no_interface_is_lost_if_names_read_alike():
    vertices, triangles = cells(np.ones((1, 4), bool))
    sets = named_sets(vertices, triangles, np.repeat([1, 2, 3, 4], 2), names={1: "a__b", 2: "c", 3: "a", 4: "b__c"})
    assert sorted(set(sets.edges).difference(sets.part_of)) == ["a__b__c", "a__b__c_3_4", "c__a", "outer"]


def test_a_region_named_like_a_set_is_refused():
    with pytest.raises(ParameterError, match="names: expected names other than those of sets of edges, found 'hole_1' for region 4"):
        plate_sets(names={4: "hole_1"})
    assert "right" in plate_sets(names={4: "right"}).labels  # there is no such set here


def test_upside_down_bottom_is_where_y_is_least():
    labels = np.zeros((4, 6), int)
    labels[0] = 1
    mesh, sets = made_of(labels, origin="upper")
    assert mesh.vertices[:, 1].max() == pytest.approx(1)
    assert set(sets.edges) == {"left", "right", "bottom", "outer"}


def test_a_hole_that_touches_the_outside_in_a_vertex_is_no_hole():
    mask = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 0]], bool)
    vertices, triangles = cells(mask)
    sets = named_sets(vertices, triangles, np.ones(len(triangles), int))
    assert wholes(sets) == {"outer": 16}
    assert oracles.pixel_topology(mask)[1] == 0


def test_two_holes_that_touch_in_a_vertex_are_one():
    mask = np.ones((4, 4), bool)
    mask[1, 1] = mask[2, 2] = False
    vertices, triangles = cells(mask)
    sets = named_sets(vertices, triangles, np.ones(len(triangles), int))
    assert wholes(sets) == {"outer": 16, "hole_1": 8}
    assert oracles.pixel_topology(mask)[1] == 1


def test_boundary_rings_enclose_what_they_do():
    sides, number, area = boundary_rings(*ring())
    assert sorted(area.tolist()) == [-4, 16]
    assert np.bincount(number).tolist() in ([16, 8], [8, 16])
    assert len(sides) == 24


def test_an_island_in_a_hole_is_outer():
    mask = np.ones((5, 5), bool)
    mask[1:4, 1:4] = False
    mask[2, 2] = True
    vertices, triangles = cells(mask)
    sets = named_sets(vertices, triangles, np.ones(len(triangles), int))
    assert wholes(sets) == {"outer": 24, "hole_1": 12}


def test_triangles_that_are_wound_differently_are_refused():
    with pytest.raises(MeshError, match="found 1 that run along a side in the same direction"):
        named_sets(np.array([[0, 0], [1, 0], [0, 1.0], [1, 1]]), np.array([[0, 1, 2], [1, 2, 3]])[:, [0, 1, 2]], np.ones(2, int))


def test_nothing_is_changed():
    vertices, triangles, regions = plate()
    before = [array.copy() for array in (vertices, triangles, regions)]
    named_sets(vertices, triangles, regions, bounds=BOUNDS)
    assert all(np.array_equal(a, b) for a, b in zip(before, (vertices, triangles, regions), strict=True))


def test_it_tells_what_there_is():
    assert repr(plate_sets()).startswith("Sets: regions region_-1 (")
