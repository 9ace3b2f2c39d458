"""TriangleMesh: frozen, checked, and one line away from smoothing, other libraries, files and figures."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import oracles
import pytest
import shapely
import specimens
from PIL import Image

from img2tri import FileError, MeshError, ParameterError, TriangleMesh, __version__, mesh_image
from img2tri.types import Frame
from img2tri.views.formats.readers.read_msh_bdf import parse_msh
from img2tri.views.formats.save_load import SURFACE_FORMATS, load
from img2tri.views.formats.solvers.save_for_solvers import EXPORTS
from img2tri.views.formats.svg_dxf_geojson import DRAWING_FORMATS

HOLED = specimens.disc(50, 22) - specimens.disc(50, 9, (20.5, 26.0))
GRAINS = specimens.polycrystal(40, 5)
SUFFIXES = [".stl", ".ply", ".obj", ".off", ".3mf", ".glb", ".vtp", ".vtu"]

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


@pytest.fixture(scope="module")
def holed():
    return mesh_image(HOLED, edge_length=5, spacing=0.5, names={1: "bone"})


@pytest.fixture(scope="module")
def grains():
    return mesh_image(GRAINS, labels=True, edge_length=5)


# ---- a value ----


def test_arrays_have_the_types_everybody_relies_on(grains):
    n, m = len(grains.vertices), len(grains.triangles)
    assert (grains.vertices.dtype, grains.vertices.shape) == (np.float64, (n, 2))
    assert (grains.triangles.dtype, grains.triangles.shape) == (np.int64, (m, 3))
    assert (grains.regions.dtype, grains.regions.shape) == (np.int64, (m,))
    assert (oracles.areas(grains.vertices, grains.triangles) > 0).all()


def test_it_cannot_be_changed(holed):
    for name in ("vertices", "triangles", "regions"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(holed, name)[0] = 0
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(holed, name, None)


def test_the_arrays_it_is_made_of_can_still_be_changed():
    vertices = SQUARE.copy()
    mesh = TriangleMesh(vertices, HALVES, np.ones(2, int))
    assert vertices.flags.writeable
    assert not mesh.vertices.flags.writeable


def test_other_types_of_numbers_are_taken():
    mesh = TriangleMesh(SQUARE.astype(np.float32), HALVES.astype(np.uint8), [7, 8])
    assert (mesh.vertices.dtype, mesh.triangles.dtype, mesh.regions.dtype) == (np.float64, np.int64, np.int64)
    assert mesh.regions.tolist() == [7, 8]


@pytest.mark.parametrize(
    ("vertices", "triangles", "regions", "words"),
    [
        (SQUARE[:, :1], HALVES, [1, 1], "vertices: expected shape (n, 2), found (4, 1)"),
        (np.column_stack([SQUARE, SQUARE[:, 0]]), HALVES, [1, 1], "leave out the third column"),
        (SQUARE * np.nan, HALVES, [1, 1], "vertices: expected finite numbers"),
        (SQUARE, np.array([[0, 1, 4]]), [1], "triangles: expected indices from 0 to 3 (there are 4 vertices), found 4"),
        (SQUARE, np.array([[0, 1, -1]]), [1], "triangles: expected indices from 0 to 3"),
        (SQUARE, np.array([[0, 1, 1]]), [1], "triangles: expected three different vertices each"),
        (SQUARE, np.zeros((0, 3), int), [], "triangles: expected shape (m, 3) with m of at least 1"),
        (SQUARE, np.array([[0, 1, 2, 3]]), [1], "quadrilaterals have to be split"),
        (SQUARE, HALVES * 1.0, [1, 1], "triangles: expected whole numbers, found dtype float64"),
        (SQUARE, HALVES, [1], "regions: expected one for each triangle, shape (2,), found shape (1,)"),
        (SQUARE, HALVES, [0.5, 1], "regions: expected whole numbers"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, triangles, regions, words):
    with pytest.raises(MeshError) as refused:
        TriangleMesh(vertices, triangles, regions)
    assert words in str(refused.value)
    assert isinstance(refused.value, ValueError)


def test_repr_tells_counts_and_bounds(grains):
    mesh = TriangleMesh(SQUARE * 2.5, HALVES, [1, 2])
    assert repr(mesh) == "TriangleMesh: 2 triangles, 4 vertices, 2 regions, 0 <= x <= 2.5, 0 <= y <= 2.5"
    assert repr(TriangleMesh(SQUARE, HALVES[:1], [1])).startswith("TriangleMesh: 1 triangle, 4 vertices, 1 region, ")
    assert f"{len(grains.triangles)} triangles, {len(grains.vertices)} vertices, 5 regions, 0 <= x <= 40" in repr(grains)


def test_without_an_image_there_is_nothing_to_be_judged_by():
    mesh = TriangleMesh(SQUARE, HALVES, [1, 1])
    with pytest.raises(MeshError, match="report: expected a mesh made by mesh_image"):
        _ = mesh.report
    with pytest.raises(MeshError, match="outlines: expected a mesh made by mesh_image"):
        mesh.outlines()
    assert mesh.frame == Frame((1, 1))
    assert mesh.names == {}
    assert len(mesh.quality().arrays["q"]) == 2


def test_the_report_is_made_once_when_asked_for(holed):
    mesh = holed.smoothed("uniform", iterations=1)
    assert "report" not in vars(mesh)
    assert mesh.report is mesh.report


# ---- quality and outlines ----


def test_quality_agrees_with_other_means(grains):
    arrays = grains.quality().arrays
    angles = oracles.angles(grains.vertices, grains.triangles)
    np.testing.assert_allclose(arrays["min_angle"], angles.min(axis=1), rtol=1e-9)
    np.testing.assert_allclose(arrays["area"], oracles.areas(grains.vertices, grains.triangles), rtol=1e-9)
    half = np.radians(angles) / 2
    np.testing.assert_allclose(arrays["q"], 8 * np.sin(half).prod(axis=1), rtol=1e-9)


def test_outlines_are_polygons_in_world_units(holed, grains):

    polygon = holed.outlines()[1]
    assert len(shapely.get_parts(polygon)) == 1
    assert abs(polygon.area / (HOLED.sum() / 4) - 1) < 0.01
    assert polygon.bounds == pytest.approx([*holed.vertices.min(axis=0), *holed.vertices.max(axis=0)], abs=0.25)
    regions = grains.outlines()
    assert sorted(regions) == [1, 2, 3, 4, 5]
    assert shapely.coverage_is_valid(list(regions.values()))
    assert sum(p.area for p in regions.values()) == pytest.approx(1600, rel=1e-12)


# ---- smoothing ----


def test_smoothing_gives_a_new_mesh_with_a_report_of_its_own(holed):
    before = holed.report
    vertices = holed.vertices.copy()
    after = holed.smoothed("uniform", iterations=3)
    assert isinstance(after, TriangleMesh)
    assert np.array_equal(holed.vertices, vertices)
    assert np.array_equal(after.triangles, holed.triangles)
    assert after.frame is holed.frame
    assert after.origin is holed.origin
    assert holed.report is before
    assert after.report.smallest_angle == pytest.approx(oracles.angles(after.vertices, after.triangles).min(), rel=1e-9)
    assert after.report.smallest_angle != before.smallest_angle or not np.array_equal(after.vertices, holed.vertices)


def test_uniform_smoothing_moves_the_inside_only(holed):
    after = holed.smoothed("uniform", iterations=2)
    moved = np.any(after.vertices != holed.vertices, axis=1)
    assert moved.any()
    assert not moved[np.unique(oracles.boundary(holed.triangles))].any()


def test_a_flat_mesh_is_a_fixed_point_of_cotangent_smoothing(holed):
    assert np.abs(holed.smoothed("cotangent", iterations=20).vertices - holed.vertices).max() < 1e-9


def test_a_free_boundary_is_rounded_within_the_tolerance():
    pixel = mesh_image(HOLED, edge_length=2, outline="pixel")
    for tolerance in (0.1, "0.4px"):
        after = pixel.smoothed("cotangent", boundary="free", tolerance=tolerance, iterations=20)
        moved = np.linalg.norm(after.vertices - pixel.vertices, axis=1)[np.unique(oracles.boundary(pixel.triangles))]
        assert 0.05 < moved.max() <= pixel.frame.length("tolerance", tolerance) * (1 + 1e-9)
        assert (oracles.areas(after.vertices, after.triangles) > 0).all()


def test_interfaces_stay_in_place_with_a_fixed_boundary(grains):
    after = grains.smoothed("uniform", iterations=5)
    curves = np.unique(oracles.interfaces(grains.triangles, grains.regions))
    assert np.array_equal(after.vertices[curves], grains.vertices[curves])
    assert after.report.kept


def test_the_guard_keeps_the_worst_angle(grains):
    worst = oracles.angles(grains.vertices, grains.triangles).min()
    guarded = grains.smoothed("uniform", iterations=10)
    assert oracles.angles(guarded.vertices, guarded.triangles).min() >= worst - 1e-9
    free = grains.smoothed("uniform", iterations=10, guard=False)
    assert not np.array_equal(free.vertices, guarded.vertices) or oracles.angles(free.vertices, free.triangles).min() >= worst


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"method": "hard"}, "method: expected one of 'uniform', 'cotangent', found 'hard'"),
        ({"method": "uniform", "boundary": "free"}, "boundary: expected one of 'fixed', found 'free'"),
        ({"boundary": "loose"}, "boundary: expected one of"),
        ({"iterations": -1}, "iterations: expected a whole number of at least 0, found -1"),
        ({"tolerance": 0}, "tolerance: expected a number above 0, found 0"),
        ({"tolerance": "1mm"}, "tolerance: expected a number with a unit"),
    ],
)
def test_smoothing_refuses(options, words, holed):
    with pytest.raises(ParameterError) as refused:
        holed.smoothed(**options)
    assert words in str(refused.value)


# ---- other libraries ----


def area(mesh):
    return oracles.areas(mesh.vertices, mesh.triangles).sum()


def test_to_trimesh_flat(grains):
    made = grains.to_trimesh()
    assert np.array_equal(made.vertices, np.column_stack([grains.vertices, np.zeros(len(grains.vertices))]))
    assert np.array_equal(made.faces, grains.triangles)
    assert np.array_equal(made.face_attributes["region"], grains.regions)
    np.testing.assert_allclose(made.face_attributes["q"], grains.quality().arrays["q"])
    assert made.area == pytest.approx(area(grains), rel=1e-12)


@pytest.mark.parametrize("name", ["holed", "grains"])
def test_to_trimesh_solid(name, request):
    mesh = request.getfixturevalue(name)
    made = mesh.to_trimesh(height=3)
    assert made.is_watertight
    assert made.is_winding_consistent
    assert made.volume == pytest.approx(3 * area(mesh), rel=1e-9)
    assert made.bounds[:, 2].tolist() == [0, 3]
    components, holes = oracles.mesh_topology(mesh.triangles)
    assert made.euler_number == 2 * components - 2 * holes


def test_to_pyvista_flat(grains):
    made = grains.to_pyvista()
    assert made.n_cells == len(grains.triangles)
    assert np.array_equal(made.cell_data["region"], grains.regions)
    np.testing.assert_allclose(made.cell_data["q"], grains.quality().arrays["q"])
    assert made.area == pytest.approx(area(grains), rel=1e-9)
    assert made.bounds[4:] == (0, 0)
    assert json.loads(made.field_data["img2tri"][0])["recipe"] == "conforming"


@pytest.mark.parametrize("name", ["holed", "grains"])
def test_to_pyvista_solid(name, request):
    mesh = request.getfixturevalue(name)
    made = mesh.to_pyvista(height=2.5)
    assert made.n_open_edges == 0
    assert made.is_manifold
    assert made.volume == pytest.approx(2.5 * area(mesh), rel=1e-6)
    assert made.bounds[4:] == (0, 2.5)


@pytest.mark.parametrize("height", [0, -1, np.nan, np.inf, "high"])
def test_a_height_that_is_none_is_refused(height, holed, tmp_path):
    for call in (holed.to_trimesh, holed.to_pyvista, lambda height: holed.save(tmp_path / "a.stl", height=height)):
        with pytest.raises(ParameterError, match="height: expected a number above 0"):
            call(height=height)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["holed", "grains"])
def test_split_gives_a_closed_body_for_each_region(name, request):
    mesh = request.getfixturevalue(name)
    scene = mesh.to_trimesh(height=3, split=True)
    assert len(scene.geometry) == len(set(mesh.regions.tolist()))
    for part in scene.geometry.values():
        mine = mesh.triangles[mesh.regions == part.metadata["region"]]
        assert part.is_watertight
        assert part.volume == pytest.approx(3 * oracles.areas(mesh.vertices, mine).sum(), rel=1e-9)
    assert set(scene.geometry) == ({"bone"} if name == "holed" else {f"region_{k}" for k in range(1, 6)})


def test_second_order_is_that_of_the_image(holed):
    made = holed.second_order()
    n, edges = len(holed.vertices), {tuple(sorted(e)) for t in holed.triangles.tolist() for e in zip(t, t[1:] + t[:1], strict=True)}
    assert (len(made.nodes), made.triangles.shape) == (n + len(edges), (len(holed.triangles), 6))
    bent = np.linalg.norm(made.nodes[n:] - [holed.vertices[list(e)].mean(axis=0) for e in sorted(edges)], axis=1)
    assert 0.01 < bent.max() < 0.5  # sides follow the discs, within a pixel of half a unit
    alone = TriangleMesh(holed.vertices, holed.triangles, holed.regions).second_order()
    assert np.array_equal(alone.nodes[:n], holed.vertices)  # without an image all sides are straight
    assert np.allclose(alone.nodes[n:], [holed.vertices[list(e)].mean(axis=0) for e in sorted(edges)])


def test_to_pyvista_makes_elements(holed):
    flat, solid = holed.to_pyvista(order=2), holed.to_pyvista(2.5, solid=True, layers=3)
    assert set(flat.celltypes.tolist()) == {22}  # VTK_QUADRATIC_TRIANGLE
    assert set(solid.celltypes.tolist()) == {13}  # VTK_WEDGE
    assert solid.n_cells == 3 * flat.n_cells == 3 * len(holed.triangles)
    assert solid.volume == pytest.approx(2.5 * area(holed), rel=1e-9)
    assert np.array_equal(solid.cell_data["region"], np.tile(holed.regions, 3))
    assert set(holed.to_pyvista(1, solid=True, order=2).celltypes.tolist()) == {26}  # VTK_QUADRATIC_WEDGE
    assert holed.to_pyvista(1, layers=2).n_cells == 2 * len(holed.triangles)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"height": 1, "order": 2}, "order: expected 1 for the surface of a solid, found 2; solid=True gives quadratic wedges"),
        ({"solid": True}, "height: expected a length with solid=True, found None"),
    ],
)
def test_to_pyvista_refuses(options, words, holed):
    with pytest.raises(ParameterError) as refused:
        holed.to_pyvista(**options)
    assert words in str(refused.value)


def test_a_notebook_shows_counts_and_a_drawing(holed):
    text = holed._repr_html_()
    assert text.count("<svg") == 1
    n, m = len(holed.vertices), len(holed.triangles)
    worst = oracles.angles(holed.vertices, holed.triangles).min()
    assert f"{m} triangles · {n} vertices · 1 region · smallest angle {worst:.1f}°" in text


# ---- files ----


@pytest.mark.parametrize("height", [None, 1.5])
@pytest.mark.parametrize("order", [1, 2])
def test_a_file_for_solvers_holds_the_elements_asked_for(order, height, grains, tmp_path):
    grains.save(tmp_path / "a.msh", height, order=order, layers=None if height is None else 2)
    found = parse_msh((tmp_path / "a.msh").read_bytes())
    kind = {1: ("triangle", "wedge"), 2: ("triangle6", "wedge15")}[order][height is not None]
    layers = 1 if height is None else 2
    assert found.kind == kind
    assert len(found.cells) == layers * len(grains.triangles)
    assert np.array_equal(found.regions, np.sort(np.tile(grains.regions, layers)))  # the cells of a region follow each other
    p = found.points[found.cells]
    (ux, uy), (vx, vy) = (p[:, 1, :2] - p[:, 0, :2]).T, (p[:, 2, :2] - p[:, 0, :2]).T
    high = 1 if height is None else p[:, 3, 2] - p[:, 0, 2]
    assert ((ux * vy - uy * vx) / 2 * high).sum() == pytest.approx(area(grains) * (height or 1), rel=1e-9)
    if order == 2:
        curved = grains.second_order().nodes
        assert {tuple(xy) for xy in found.points[:, :2].round(9).tolist()} == {tuple(xy) for xy in curved.round(9).tolist()}


@pytest.mark.parametrize("suffix", [".svg", ".dxf", ".geojson"])
def test_a_drawing_holds_the_outlines(suffix, holed, tmp_path):
    path = tmp_path / f"holed{suffix}"
    holed.save(path)
    assert "bone" in path.read_text()
    with pytest.raises(ParameterError, match=f"height: expected None for {suffix}, which is a drawing, found 4"):
        holed.save(tmp_path / f"high{suffix}", height=4)
    assert list(tmp_path.iterdir()) == [path]
    if suffix == ".geojson":
        (feature,) = json.loads(path.read_text())["features"]
        assert shapely.geometry.shape(feature["geometry"]).equals(holed.outlines()[1])


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.stl", {"layers": 2}, "layers: expected to be left out for .stl, found 2; it is for .msh, .inp"),
        ("a.ply", {"order": 2}, "order: expected to be left out for .ply, found 2; it is for .msh, .inp"),
        ("a.obj", {"deck": False}, "deck: expected to be left out for .obj, found False"),
        ("a.msh", {"order": 3}, "order: expected 1 or 2, found 3"),
        ("a.bdf", {"height": 1, "order": 0}, "order: expected 1 or 2, found 0"),
    ],
)
def test_options_of_other_formats_are_refused(name, options, words, holed, tmp_path):
    with pytest.raises(ParameterError) as refused:
        holed.save(tmp_path / name, **options)
    assert words in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_a_mesh_without_an_image_claims_none(tmp_path):
    TriangleMesh(SQUARE, HALVES, [1, 2], names={1: "bone"}).save(tmp_path / "a.ply")
    header = (tmp_path / "a.ply").read_bytes().split(b"end_header")[0].decode()
    told = next(line for line in header.splitlines() if line.startswith("comment img2tri: "))
    assert json.loads(told.removeprefix("comment img2tri: ")) == {"version": __version__, "names": {"1": "bone"}}


@pytest.mark.parametrize("suffix", [s for s in SUFFIXES if s != ".3mf"])
def test_a_file_comes_back(suffix, grains, tmp_path):
    path = tmp_path / f"grains{suffix}"
    grains.save(path)
    vertices, triangles, regions = load(path)
    back = TriangleMesh(vertices, triangles, regions)
    single = suffix in (".stl", ".glb")
    assert len(triangles) == len(grains.triangles)
    assert len(vertices) == len(grains.vertices)
    assert area(back) == pytest.approx(area(grains), rel=1e-6 if single else 1e-12)
    assert vertices.min(axis=0).tolist() == [0, 0]
    assert vertices.max(axis=0).tolist() == [40, 40]
    if suffix not in (".stl", ".off"):
        for region in range(1, 6):
            mine = grains.triangles[grains.regions == region]
            assert oracles.areas(vertices, triangles[regions == region]).sum() == pytest.approx(
                oracles.areas(grains.vertices, mine).sum(), rel=1e-6 if single else 1e-12
            )


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_solid_is_read_by_others(suffix, holed, tmp_path):
    path = tmp_path / f"solid{suffix.upper()}"
    holed.save(path, height=4)
    if suffix in (".vtp", ".vtu"):
        import pyvista

        made = pyvista.read(path)
        surface = made if suffix == ".vtp" else made.extract_surface(algorithm=None)
        volume, bounds = surface.volume, made.bounds
        assert surface.n_open_edges == 0
    else:
        import trimesh

        made = trimesh.load_scene(path).to_mesh()
        made.merge_vertices()
        volume, bounds = made.volume, made.bounds.T.ravel()
        assert made.is_watertight
    assert volume == pytest.approx(4 * area(holed), rel=1e-4)
    low, high = holed.vertices.min(axis=0), holed.vertices.max(axis=0)
    assert list(bounds) == pytest.approx([low[0], high[0], low[1], high[1], 0, 4], rel=1e-6)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_mesh_gives_the_same_bytes(suffix, holed, tmp_path):
    for name in "ab":
        holed.save(tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_a_file_tells_how_its_mesh_was_made(holed, tmp_path):
    path = tmp_path / "holed.ply"
    holed.save(path)
    text = path.read_bytes().split(b"end_header")[0].decode()
    line = next(line for line in text.splitlines() if line.startswith("comment img2tri: "))
    assert json.loads(line.removeprefix("comment img2tri: "))["spacing"] == [0.5, 0.5]


@pytest.mark.parametrize("name", ["a.dwg", "a", "none/a.stl"])
def test_a_file_that_cannot_be_written_is_refused(name, holed, tmp_path):
    with pytest.raises(FileError, match="expected") as refused:
        holed.save(tmp_path / name)
    assert isinstance(refused.value, OSError)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_one_may_not_write_to(holed, tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)  # the user root may write anywhere
    with pytest.raises(FileError, match="expected a folder one may write to"):
        holed.save(tmp_path / "a.stl")
    assert list(tmp_path.iterdir()) == []


# ---- figures ----


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_figure_is_saved(suffix, holed, tmp_path):
    from matplotlib.text import Text

    path = tmp_path / f"figure{suffix}"
    figure = holed.plot(HOLED, path)
    assert path.stat().st_size > 5000
    assert len(figure.axes) >= 2
    texts = " ".join(text.get_text() for text in figure.findobj(Text))
    assert f"{len(holed.triangles):,} triangles" in texts


def test_the_figure_shows_the_image_where_it_lies(holed):
    alone, over = holed.plot(), holed.plot(HOLED)
    assert len(alone.axes[0].images) == 0
    (image,) = over.axes[0].images
    assert tuple(image.get_extent()) == (0, 25, 0, 25)
    assert over.axes[0].get_xlim() == (0, 25)


def test_the_figure_of_a_crop_shows_the_image_where_it_lies():
    mesh = mesh_image(HOLED, crop=(20, 0, 50, 50), edge_length=5)
    (image,) = mesh.plot(HOLED).axes[0].images
    assert tuple(image.get_extent()) in {(0, 50, 0, 50), (20, 50, 0, 50)}


def test_the_figure_takes_a_path(holed, tmp_path):
    from PIL import Image

    path = tmp_path / "image.png"
    Image.fromarray((HOLED * 255).astype(np.uint8)).save(path)
    assert len(holed.plot(path).axes[0].images) == 1


def test_colour_by_changes_the_figure(grains, tmp_path):
    drawn = set()
    for colour in ("quality", "region", None):
        grains.plot(None, tmp_path / f"{colour}.svg", colour_by=colour)
        drawn.add((tmp_path / f"{colour}.svg").read_bytes())
    assert len(drawn) == 3
    with pytest.raises(ParameterError, match="colour_by: expected one of"):
        grains.plot(colour_by="taste")


def test_a_figure_of_unknown_kind_is_refused(holed, tmp_path):
    with pytest.raises(FileError, match=r"expected a name that ends in \.pdf, \.png or \.svg"):
        holed.plot(None, tmp_path / "a.stl")


def test_an_unknown_suffix_is_answered_with_all_that_are_known(tmp_path):
    with pytest.raises(FileError, match="expected a name that ends in") as problem:
        mesh_image(np.ones((9, 9), bool)).save(tmp_path / "a.dwg")
    for suffix in (*SURFACE_FORMATS, *EXPORTS, *DRAWING_FORMATS, ".html"):
        assert suffix in str(problem.value)


def test_a_page_says_how_the_mesh_is_made_again(tmp_path):
    image = np.zeros((30, 40), np.uint8)
    image[5:25, 5:35] = 200
    Image.fromarray(image).save(tmp_path / "a.png")
    for source, words in [
        (image, "mesh = img2tri.mesh_image(image, edge_length=5)"),
        (tmp_path / "a.png", f"img2tri mesh {tmp_path}/a.png -o mesh.vtu --edge-length 5"),
    ]:
        mesh = mesh_image(source, edge_length=5)
        mesh.save(tmp_path / "a.html", image=source)
        text = (tmp_path / "a.html").read_text(encoding="utf-8")
        assert f'<code id="command">{words}</code>' in text
        assert 'id="picture"' in text
    TriangleMesh(mesh.vertices, mesh.triangles, mesh.regions).save(tmp_path / "b.html")
    assert "There is no image to judge this mesh by." in (tmp_path / "b.html").read_text(encoding="utf-8")
    with pytest.raises(ParameterError, match="image: expected to be left out for .stl"):
        mesh.save(tmp_path / "a.stl", image=image)


@pytest.mark.parametrize("given", [{"height": 2.0}, {"layers": 3}, {"order": 2}, {"data": {"a": [1.0]}}])
def test_a_page_takes_nothing_that_it_would_not_show(given, tmp_path):
    with pytest.raises(ParameterError, match=f"{next(iter(given))}: expected"):
        mesh_image(np.ones((9, 9), bool)).save(tmp_path / "a.html", **given)
    assert list(tmp_path.iterdir()) == []
