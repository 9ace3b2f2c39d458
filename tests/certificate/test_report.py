"""The certificate can fail: each way of damaging a good mesh is found, called by its name, and put in its place."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import oracles
import pytest
import specimens

from img2tri import MeshError, mesh_image
from img2tri.certificate.report import Report

# Two white shapes, one with a hole, apart from each other and from the frame.
SHAPES = np.zeros((60, 90), int)
SHAPES[5:45, 5:45] = specimens.disc(40, 18)
SHAPES[19:31, 19:31] -= specimens.disc(12, 5)
SHAPES[30:55, 60:85] = specimens.disc(25, 10)
# A label map: an island (4) in a grain, three grains that meet in a point.
GRAINS = np.full((48, 48), 1)
GRAINS[:, 24:] = 2
GRAINS[30:, :] = 3
GRAINS[10:18, 8:16] = 4


@pytest.fixture(scope="module")
def shapes():
    return mesh_image(SHAPES, edge_length=5)


@pytest.fixture(scope="module")
def grains():
    return mesh_image(GRAINS, labels=True, edge_length=5)


def damaged(mesh, **arrays):
    """A mesh with other arrays; the origin it is judged by stays."""
    return dataclasses.replace(mesh, **arrays)


def without(mesh, drop):
    """A mesh without some triangles, and without the vertices only they had."""
    keep = ~drop
    used, triangles = np.unique(mesh.triangles[keep], return_inverse=True)
    return damaged(mesh, vertices=mesh.vertices[used], triangles=triangles.reshape(-1, 3), regions=mesh.regions[keep])


def middles(mesh):
    return mesh.vertices[mesh.triangles].mean(axis=1)


def at_border(mesh):
    """(m,) how many sides of each triangle are at the edge of the mesh."""
    border = {tuple(e) for e in oracles.boundary(mesh.triangles).tolist()}
    t = np.sort(mesh.triangles, axis=1)
    return sum(np.array([tuple(e) in border for e in t[:, pair].tolist()], int) for pair in ([0, 1], [1, 2], [0, 2]))


def is_inner(mesh):
    """(n,) which vertices are on no curve."""
    inner = np.ones(len(mesh.vertices), bool)
    inner[oracles.boundary(mesh.triangles)] = False
    inner[oracles.interfaces(mesh.triangles, mesh.regions)] = False
    return inner


def broken(report):
    """Names of what the report complains about."""
    facts = report.to_dict()
    names = {name for name in COUNTS if facts[name]}
    if report.tolerance is not None and report.hausdorff > report.tolerance * (1 + 1e-9):
        names.add("hausdorff")
    if any(row["found"] != row["expected"] for row in report.topology.values()):
        names.add("topology")
    assert report.kept == (not names)
    assert len(report.warnings) >= len(names - {"topology"})
    return names


COUNTS = (
    "inverted", "degenerate", "nonmanifold_edges", "pinched_vertices", "duplicate_vertices", "unused_vertices",
    "neighbours_missing", "neighbours_extra", "wrong_pixels", "narrow",
)  # fmt: skip


def near(place, point, distance):
    return np.linalg.norm(np.subtract(place, point)) <= distance


def place_in(line):
    """The place a warning names."""
    text = line[line.rindex("(") + 1 : line.rindex(")")]
    return [float(number) for number in text.split(",")]


# ---- a good mesh ----


@pytest.mark.parametrize("name", ["shapes", "grains"])
def test_a_good_mesh_keeps_everything(name, request):
    report = request.getfixturevalue(name).report
    assert broken(report) == set()
    assert report.warnings == []


@pytest.mark.parametrize(("name", "labels"), [("shapes", SHAPES), ("grains", GRAINS)])
def test_its_numbers_are_those_found_by_other_means(name, labels, request):
    mesh = request.getfixturevalue(name)
    report, (v, t, r) = mesh.report, (mesh.vertices, mesh.triangles, mesh.regions)
    assert (report.n_vertices, report.n_triangles) == (len(v), len(t))
    angles = oracles.angles(v, t).min(axis=1)
    assert report.smallest_angle == pytest.approx(angles.min(), rel=1e-9)
    assert near(report.smallest_angle_at, middles(mesh)[angles.argmin()], 1e-5)
    for label in np.unique(r).tolist():
        mine = t[r == label]
        row = report.areas[label]
        assert row["mesh"] == pytest.approx(oracles.areas(v, mine).sum(), rel=1e-12)
        assert row["image"] == (labels == label).sum()
        assert row["error"] == pytest.approx(row["mesh"] / row["image"] - 1, abs=1e-12)
        assert report.topology[label]["found"] == oracles.mesh_topology(mine)
        assert report.topology[label]["expected"] == oracles.pixel_topology(labels == label)
    outlines = mesh.origin.outlines
    curves = v[np.concatenate([oracles.boundary(t), oracles.interfaces(t, r)])]
    distance = oracles.two_sided_distance(curves, outlines.points[outlines.segments[0]], step=0.05)
    assert report.hausdorff == pytest.approx(distance, abs=0.02)


@pytest.mark.parametrize("spacing", [0.5, 0.7, (0.5, 1.25)])
def test_numbers_are_world_units(spacing):
    one, other = (mesh_image(SHAPES, edge_length="5px", spacing=s).report for s in (1, spacing))
    if isinstance(spacing, float):
        assert other.hausdorff == pytest.approx(spacing * one.hausdorff, rel=1e-9)
        assert other.smallest_angle == pytest.approx(one.smallest_angle, rel=1e-9)
    assert other.tolerance == pytest.approx(0.5 * np.min(spacing))
    assert other.areas[1]["image"] == pytest.approx(SHAPES.sum() * (spacing**2 if isinstance(spacing, float) else np.prod(spacing)))
    assert other.kept


def test_json_holds_all_of_it(grains):
    told = json.loads(grains.report.to_json())
    assert set(told) == {field.name for field in dataclasses.fields(Report)}
    assert told["n_triangles"] == grains.report.n_triangles
    assert told["hausdorff"] == grains.report.hausdorff
    assert told["areas"]["4"] == grains.report.areas[4]
    assert told["topology"]["1"]["found"] == [1, 1]
    assert told["settings"]["labels"] is True
    assert json.dumps(told) == grains.report.to_json(indent=None)


def test_a_mesh_without_a_boundary_cannot_be_judged(shapes):
    folded = damaged(
        shapes,
        vertices=np.array([[10.0, 10.0], [30.0, 10.0], [20.0, 30.0], [20.0, 17.0]]),
        triangles=np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]),
        regions=np.ones(4, int),
    )
    with pytest.raises(MeshError, match="report: expected a mesh with a boundary, found one folded upon itself"):
        _ = folded.report


def test_json_holds_settings_of_any_type():
    y, x = np.mgrid[:20, :20]
    image = np.hypot(x - 9.5, y - 9.5) < 8

    settings = {"edge_length": np.float32(3), "tolerance": np.longdouble(0.5), "gradation": np.float16(0.25), "seed": np.int64(7)}
    told = json.loads(mesh_image(image, **settings).report.to_json())["settings"]
    assert {name: told[name] for name in settings} == {"edge_length": 3, "tolerance": 0.5, "gradation": 0.25, "seed": 7}
    told = json.loads(mesh_image(image, edge_length=lambda places: np.full(len(places), 3.0)).report.to_json())["settings"]
    assert told["edge_length"] == "field"


def test_settings_are_plain_numbers_in_json():
    told = json.loads(mesh_image(GRAINS, labels=np.array([1, 2]), seed=np.int64(3), min_angle=np.float64(25)).report.to_json())["settings"]
    assert told["labels"] == [1, 2]
    assert told["seed"] == 3
    assert told["min_angle"] == 25


# ---- damage ----


@pytest.mark.parametrize("which", range(0, 30, 3))
def test_a_vertex_of_the_boundary_that_is_moved(which, shapes):
    vertices = shapes.vertices.copy()
    edges = oracles.boundary(shapes.triangles)
    curve = np.unique(edges)
    moved = curve[which % len(curve)]
    # Across the outline: along it, a vertex may move without harm.
    one, other = vertices[np.setdiff1d(edges[(edges == moved).any(axis=1)], moved)]
    vertices[moved] += (other - one)[::-1] * [-1, 1] / np.linalg.norm(other - one)
    report = damaged(shapes, vertices=vertices).report
    assert "hausdorff" in broken(report)
    assert report.hausdorff > 0.5
    line = next(line for line in report.warnings if "apart at" in line)
    assert near(place_in(line), vertices[moved], 3)


def test_a_vertex_inside_that_is_moved_over_its_neighbours(shapes):
    inner = int(np.flatnonzero(is_inner(shapes))[0])
    beside = shapes.triangles[(shapes.triangles == inner).any(axis=1)]
    vertices = shapes.vertices.copy()
    others = vertices[beside[0][beside[0] != inner]]
    vertices[inner] += 1.5 * (others.mean(axis=0) - vertices[inner])
    report = damaged(shapes, vertices=vertices).report
    assert report.inverted == (oracles.areas(vertices, shapes.triangles) < 0).sum() > 0
    assert "inverted" in broken(report)


def test_a_vertex_inside_that_is_moved_a_little_only_makes_angles_worse(shapes):
    inner = int(np.flatnonzero(is_inner(shapes))[0])
    beside = shapes.triangles[(shapes.triangles == inner).any(axis=1)]
    vertices = shapes.vertices.copy()
    others = vertices[beside[0][beside[0] != inner]]
    vertices[inner] += 0.8 * (others.mean(axis=0) - vertices[inner])
    report = damaged(shapes, vertices=vertices).report
    assert broken(report) == {"narrow"}
    angles = oracles.angles(vertices, shapes.triangles).min(axis=1)
    assert report.narrow == (angles < 30 - 1e-9).sum()
    assert len(report.narrow_at) == report.narrow
    assert all(near(place, vertices[inner], 5) for place in report.narrow_at)
    assert near(place_in(report.warnings[-1]), middles(damaged(shapes, vertices=vertices))[angles.argmin()], 1e-4)


def test_a_triangle_inside_that_is_missing_is_a_hole(shapes):
    inner = is_inner(shapes)
    lost = int(np.flatnonzero(inner[shapes.triangles].all(axis=1))[0])
    drop = np.arange(len(shapes.triangles)) == lost
    report = without(shapes, drop).report
    assert {"topology", "hausdorff"} <= broken(report)
    assert report.topology[1] == {"found": (2, 2), "expected": (2, 1)}
    line = next(line for line in report.warnings if "apart at" in line)
    assert near(place_in(line), middles(shapes)[lost], 5)
    assert report.areas[1]["error"] < 0


def test_a_triangle_at_the_border_that_is_missing_is_a_dent(shapes):
    lost = int(np.flatnonzero(at_border(shapes) == 1)[0])
    report = without(shapes, np.arange(len(shapes.triangles)) == lost).report
    assert "hausdorff" in broken(report)
    line = next(line for line in report.warnings if "apart at" in line)
    assert near(place_in(line), middles(shapes)[lost], 5)


def test_a_triangle_of_another_region(grains):
    inner = is_inner(grains)
    mine = np.flatnonzero(inner[grains.triangles].all(axis=1) & (grains.regions == 3))
    regions = grains.regions.copy()
    regions[mine[0]] = 4
    report = damaged(grains, regions=regions).report
    assert {"topology", "neighbours_extra", "hausdorff"} <= broken(report)
    assert report.neighbours_extra == [(3, 4)]
    assert "labels 3 and 4 touch in the mesh, not in the image" in report.warnings
    assert report.topology[4] == {"found": (2, 0), "expected": (1, 0)}
    assert report.topology[3]["found"] == (1, 1)


def test_two_regions_that_are_swapped(grains):
    regions = np.select([grains.regions == 1, grains.regions == 2], [2, 1], grains.regions)
    report = damaged(grains, regions=regions).report
    found = broken(report)
    assert {"wrong_pixels", "neighbours_missing", "neighbours_extra"} <= found
    assert report.displaced == [1, 2]
    assert (report.neighbours_missing, report.neighbours_extra) == ([(1, 4)], [(2, 4)])
    assert "hausdorff" not in found


def test_two_halves_that_are_swapped():
    """Nothing but the sides of the one straight line between them tells."""
    halves = np.repeat([[1, 2]], 20, axis=0).repeat(10, axis=1)
    mesh = mesh_image(halves, labels=True, edge_length=4)
    assert mesh.report.kept
    assert not damaged(mesh, regions=3 - mesh.regions).report.kept


def test_pixels_are_looked_at_where_outlines_follow_them():
    smooth, pixel = (mesh_image(specimens.disc(40, 12.3), edge_length=4, outline=outline) for outline in ("smooth", "pixel"))
    assert sorted(smooth.origin.pixels.tolist()) == sorted(pixel.origin.pixels.tolist())
    assert pixel.report.wrong_pixels == 0
    apart = np.hypot(*(middles(pixel) - 20).T) > 10
    assert damaged(pixel, triangles=pixel.triangles[~apart], regions=pixel.regions[~apart]).report.wrong_pixels > 50


def test_a_triangle_that_is_turned_over(shapes):
    triangles = shapes.triangles.copy()
    triangles[3] = triangles[3, ::-1]
    report = damaged(shapes, triangles=triangles).report
    assert report.inverted == 1
    assert "inverted" in broken(report)
    assert "inverted: 1" in report.warnings


def test_a_triangle_without_area(shapes):
    inner = int(np.flatnonzero(is_inner(shapes))[0])
    corners = next(t for t in shapes.triangles if inner in t)
    vertices = shapes.vertices.copy()
    vertices[inner] = vertices[corners[corners != inner]].mean(axis=0)
    report = damaged(shapes, vertices=vertices).report
    assert report.degenerate == 1
    assert {"degenerate", "narrow"} <= broken(report)


def test_a_triangle_that_is_there_twice(shapes):
    report = damaged(
        shapes, triangles=np.vstack([shapes.triangles, shapes.triangles[:1]]), regions=np.append(shapes.regions, shapes.regions[0])
    ).report
    assert report.nonmanifold_edges >= 1
    assert "nonmanifold_edges" in broken(report)


def test_vertices_that_are_there_twice(shapes):
    """All triangles with vertices of their own: they no longer hang together."""
    n = 3 * len(shapes.triangles)
    loose = damaged(shapes, vertices=shapes.vertices[shapes.triangles.ravel()], triangles=np.arange(n).reshape(-1, 3))
    report = loose.report
    assert report.duplicate_vertices == n - len(shapes.vertices)
    assert {"duplicate_vertices", "topology", "hausdorff"} <= broken(report)
    assert report.topology[1]["found"] == (len(shapes.triangles), 0)


def test_a_seam_that_is_not_joined(grains):
    """Regions with vertices of their own along an interface: as meshes made one by one would be."""
    n = len(grains.vertices)
    triangles = grains.triangles.copy()
    triangles[grains.regions == 4] += n
    used, triangles = np.unique(triangles, return_inverse=True)
    apart = damaged(grains, vertices=np.vstack([grains.vertices] * 2)[used], triangles=triangles.reshape(-1, 3))
    assert apart.report.duplicate_vertices > 3
    assert apart.report.neighbours_missing == [(1, 4)]
    assert {"duplicate_vertices", "neighbours_missing"} <= broken(apart.report)


def test_a_vertex_no_triangle_has(shapes):
    report = damaged(shapes, vertices=np.vstack([shapes.vertices, [[40.0, 3.0]]])).report
    assert broken(report) == {"unused_vertices"}
    assert report.unused_vertices == 1


def test_regions_that_touch_in_a_point(shapes):
    """One vertex of the small shape is made the same as one of the large one, moved there."""
    right = middles(shapes)[:, 0] > 52
    one = int(shapes.triangles[right].ravel()[np.argmin(shapes.vertices[shapes.triangles[right].ravel()][:, 0])])
    other = int(shapes.triangles[~right].ravel()[np.argmax(shapes.vertices[shapes.triangles[~right].ravel()][:, 0])])
    triangles = shapes.triangles.copy()
    triangles[triangles == one] = other
    used, triangles = np.unique(triangles, return_inverse=True)
    report = damaged(shapes, vertices=shapes.vertices[used], triangles=triangles.reshape(-1, 3)).report
    assert report.pinched_vertices == 1
    assert {"pinched_vertices", "hausdorff"} <= broken(report)


def test_regions_of_a_label_map_that_touch_in_a_point():
    """Two triangles of a region that touch in a vertex, in the midst of another region."""
    mesh = mesh_image(np.ones((20, 20), int) * [[1] * 20], labels=True, edge_length=4)
    inner = is_inner(mesh)
    for vertex in np.flatnonzero(inner):
        around = np.flatnonzero((mesh.triangles == vertex).any(axis=1))
        first = mesh.triangles[around[0]]
        apart = [t for t in around if len(np.intersect1d(mesh.triangles[t], first)) == 1]
        if apart:
            break
    regions = mesh.regions.copy()
    regions[[around[0], apart[0]]] = 7
    outlines = mesh.origin.outlines
    outlines = dataclasses.replace(outlines, labels=np.append(outlines.labels, 7))
    origin = dataclasses.replace(mesh.origin, outlines=outlines, areas=np.append(mesh.origin.areas, 2.0))
    report = damaged(mesh, regions=regions, origin=origin).report
    assert report.pinched_vertices >= 1
    assert "pinched_vertices" in broken(report)


def test_a_hole_that_is_filled(shapes):
    """A fan over the hole."""
    edges = oracles.boundary(shapes.triangles)
    centre = np.array([25.0, 35.0])
    ring = edges[(np.linalg.norm(shapes.vertices[edges].mean(axis=1) - centre, axis=1) < 8)]
    assert len(ring) >= 4
    ends = shapes.vertices[ring]
    left = _cross(ends, centre) > 0
    ring = np.where(left[:, None], ring, ring[:, ::-1])
    n = len(shapes.vertices)
    fan = np.column_stack([ring, np.full(len(ring), n)])
    report = damaged(
        shapes,
        vertices=np.vstack([shapes.vertices, centre]),
        triangles=np.vstack([shapes.triangles, fan]),
        regions=np.append(shapes.regions, np.ones(len(fan), int)),
    ).report
    assert {"topology", "hausdorff", "wrong_pixels"} <= broken(report)
    assert report.topology[1] == {"found": (2, 0), "expected": (2, 1)}
    assert "label 1: 2 components with 0 holes, expected 2 with 1" in report.warnings
    line = next(line for line in report.warnings if "wrong region" in line)
    assert near(place_in(line), centre, 8)
    assert report.areas[1]["error"] > 0.03


def _cross(ends, centre):
    a, b = ends[:, 1] - ends[:, 0], centre - ends[:, 0]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def test_an_island_that_is_lost(shapes):
    right = middles(shapes)[:, 0] > 52
    report = without(shapes, right).report
    assert {"topology", "hausdorff", "wrong_pixels"} <= broken(report)
    assert report.topology[1]["found"] == (1, 1)
    assert report.hausdorff > 15
    assert report.areas[1]["error"] == pytest.approx(-SHAPES[:, 55:].sum() / SHAPES.sum(), abs=0.01)
    assert all(place_in(line)[0] > 52 for line in report.warnings if " at (" in line)


def test_a_region_that_is_lost(grains):
    report = without(grains, grains.regions == 4).report
    assert {"topology", "neighbours_missing"} <= broken(report)
    assert report.areas[4] == {"mesh": 0, "image": 64, "error": -1}
    assert report.topology[4]["found"] == (0, 0)
    assert report.neighbours_missing == [(1, 4)]


def test_a_region_the_image_does_not_have(grains):
    regions = np.where(grains.regions == 2, 9, grains.regions)
    report = damaged(grains, regions=regions).report
    assert not report.kept
    assert report.areas[2]["mesh"] == 0


def test_a_mesh_of_another_place(shapes):
    report = damaged(shapes, vertices=shapes.vertices + np.array([10, 0])).report
    assert {"hausdorff", "wrong_pixels"} <= broken(report)
    assert report.hausdorff == pytest.approx(10, abs=1)


def test_a_mesh_of_the_mirrored_image(shapes):
    mirrored = mesh_image(SHAPES[:, ::-1], edge_length=5)
    assert not dataclasses.replace(mirrored, origin=shapes.origin).report.kept


def test_warnings_name_places_of_the_world():
    mesh = mesh_image(SHAPES, edge_length="5px", spacing=0.1, origin=(1000, -50))
    right = middles(mesh)[:, 0] > 1005.2
    report = without(mesh, right).report
    places = [place_in(line) for line in report.warnings if " at (" in line]
    assert len(places) >= 2
    assert all(1005 < x < 1009 and -50 < y < -44 for x, y in places)


def test_no_more_places_than_one_can_read():
    mesh = mesh_image(SHAPES, edge_length=3)
    vertices = mesh.vertices * [4, 1]
    report = dataclasses.replace(mesh, vertices=vertices).report
    assert report.narrow > 20
    assert len(report.narrow_at) == 20


@pytest.mark.parametrize("recipe", ["structured", "unstructured"])
def test_nothing_is_promised_for_the_recipes_of_the_paper_and_all_is_measured(recipe):
    report = mesh_image(SHAPES * 255, recipe=recipe, edge_length=4).report
    assert (report.tolerance, report.min_angle, report.narrow) == (None, None, 0)
    assert report.topology[1]["found"][1] == 0
    assert report.topology[1]["expected"] == (2, 1)
    assert report.hausdorff > 0.5
    assert report.areas[1]["mesh"] != report.areas[1]["image"]
    assert not report.kept


def test_areas_are_promised_unless_they_need_not_be_kept():
    disc = specimens.disc(40, 12)
    free = mesh_image(disc, edge_length=12, tolerance="1px", keep_area=False, segments_per_turn=3).report
    assert free.areas[1]["error"] < -0.05
    assert free.kept
    assert not free.areas_off
    assert abs(mesh_image(disc, edge_length=12, tolerance="1px").report.areas[1]["error"]) < 0.01


def test_what_a_prompt_shows_is_a_short_table(shapes):
    lines = repr(shapes.report).splitlines()
    assert lines[0] == f"Report: {len(shapes.triangles)} triangles, {len(shapes.vertices)} vertices, every promise kept"
    assert [line[:16].strip() for line in lines[1:]] == ["distance", "smallest angle", "areas", "topology", "defects"]
    assert lines[1].split()[1:] == [f"{shapes.report.hausdorff:.4g}", "of", "at", "most", "0.5"]
    bad = dataclasses.replace(shapes.report, warnings=[f"warning {i}" for i in range(99)], notes=["a note"])
    lines = repr(bad).splitlines()
    assert lines[0].endswith("99 not kept of what was promised")
    assert lines[-2:] == ["not kept        warning 4", "noted           a note"]


def test_a_mesh_that_lies_beside_its_image_is_told_from_any_side():
    mesh = mesh_image(specimens.disc(30, 12), edge_length=4)
    for way in ((40, 0), (-40, 0), (0, 40), (0, -40), (25, -25)):
        assert any("pixel" in warning for warning in dataclasses.replace(mesh, vertices=mesh.vertices + way).report.warnings)
