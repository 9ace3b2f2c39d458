"""How near outlines and meshes come to the shapes that were drawn, against formulas; and what the options change."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
import specimens

from img2tri import mesh_image
from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.polygons import region_polygons
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame


def dense_points(labels, **options):
    return place_outlines(find_crack_edges(labels), Frame(labels.shape), **options)[0].points


def rms(values):
    return np.sqrt((values**2).mean())


def random_discs(radius, count):
    rng = np.random.default_rng(radius)
    for _ in range(count):
        n = 2 * radius + 12
        centre = tuple(n / 2 + rng.uniform(-0.5, 0.5, 2))
        yield specimens.disc(n, radius, centre), n, centre


def from_circle(points, radius, centre, n):
    """Signed distances of points from a circle; `centre` is its row and column in an image n high."""
    return np.hypot(points[:, 0] - centre[1], n - points[:, 1] - centre[0]) - radius


# ---- dense outlines of masks ----


@pytest.mark.parametrize(
    ("radius", "count", "most", "bias", "farthest"),
    [(5, 20, 0.16, 0.1, 0.45), (12, 20, 0.12, 0.12, 0.45), (20, 12, 0.11, 0.06, 0.45), (40, 8, 0.09, 0.05, 0.45)]
    + [(80, 8, 0.08, 0.03, 0.45), (150, 5, 0.08, 0.03, 0.46), (410, 2, 0.08, 0.03, 0.46)],
)
def test_discs(radius, count, most, bias, farthest):
    off = [from_circle(dense_points(labels), radius, centre, n) for labels, n, centre in random_discs(radius, count)]
    assert rms(np.concatenate(off)) <= most
    assert max(abs(o.mean()) for o in off) <= bias
    assert np.abs(np.concatenate(off)).max() <= farthest


@pytest.mark.parametrize(("n", "most"), [(180, 0.06), (181, 0.12)])
def test_discs_in_the_middle_of_their_pixels(n, most):
    """About the corner of a pixel, or about its centre, which makes the longest straight runs."""
    for radius in (80, 81):
        assert rms(from_circle(dense_points(specimens.disc(n, radius)), radius, (n / 2, n / 2), n)) <= most


def ellipse_ring(axes, angle, centre, n):
    turn = np.linspace(0, 2 * np.pi, 4000)
    z = (axes[0] * np.cos(turn) + 1j * axes[1] * np.sin(turn)) * np.exp(1j * np.radians(angle)) + complex(centre[1], n - centre[0])
    return shapely.LinearRing(np.stack([z.real, z.imag], axis=1))


@pytest.mark.parametrize(("axes", "most"), [((70, 40), 0.085), ((70, 20), 0.1), ((30, 20), 0.11), ((12, 8), 0.15)])
def test_ellipses(axes, most):
    rng = np.random.default_rng(axes[0])
    off = []
    for angle in np.linspace(0, 180, 8, endpoint=False):
        n = 2 * axes[0] + 12
        centre = tuple(n / 2 + rng.uniform(-0.5, 0.5, 2))
        points = dense_points(specimens.ellipse(n, axes, angle, centre))
        off.append(shapely.distance(ellipse_ring(axes, angle, centre, n), shapely.points(points)))
    assert rms(np.concatenate(off)) <= most


def test_the_middles_between_pixels_are_three_times_as_far_off():
    """What the smoothing is worth: without it the outline is its own steps."""
    radius, n, centre = 80, 172, (86.2, 85.9)
    labels = specimens.disc(n, radius, centre)
    middles = oracles.pixel_sides(labels).mean(axis=1)
    rough = rms(from_circle(middles, radius, centre, n))
    assert 0.2 < rough < 0.3
    assert rms(from_circle(dense_points(labels), radius, centre, n)) < rough / 3


# ---- meshes of masks and of gray images ----


def from_edges(mesh, radius, centre, n):
    """Signed distances from a circle of places all along the boundary of a mesh."""
    ends = mesh.vertices[oracles.boundary(mesh.triangles)]
    share = np.linspace(0, 1, 9)[:, None, None]
    return from_circle(((1 - share) * ends[:, 0] + share * ends[:, 1]).reshape(-1, 2), radius, centre, n)


@pytest.mark.parametrize(("radius", "edge_length"), [(80, 4), (80, 8), (150, 4), (150, 8), (410, 8)])
def test_the_boundary_of_the_mesh_of_a_disc(radius, edge_length):
    n, centre = 2 * radius + 14, (radius + 7.3, radius + 6.8)
    mesh = mesh_image(specimens.disc(n, radius, centre), edge_length=edge_length)
    off = from_edges(mesh, radius, centre, n)
    assert rms(off) <= 0.09
    assert abs(off.mean()) <= 0.02
    assert oracles.areas(mesh.vertices, mesh.triangles).sum() == pytest.approx(np.pi * radius**2, rel=2e-3)


@pytest.mark.parametrize("edge_length", [4, 8])
def test_the_mesh_of_a_disc_drawn_in_gray_is_three_times_as_exact(edge_length):
    radius, n, centre = 80, 174, (87.3, 86.8)
    mesh = mesh_image(specimens.gray_disc(n, radius, centre), edge_length=edge_length, keep_area=False)
    ends = np.unique(oracles.boundary(mesh.triangles))
    off = from_circle(mesh.vertices[ends], radius, centre, n)
    assert rms(off) <= 0.03
    assert abs(off.mean()) <= 0.01
    kept = mesh_image(specimens.gray_disc(n, radius, centre), edge_length=edge_length)
    assert oracles.areas(kept.vertices, kept.triangles).sum() == pytest.approx(np.pi * radius**2, rel=2e-4)


def test_small_shapes_keep_their_size():
    for radius in (1.2, 2.0, 3.3, 5.0):
        labels = specimens.disc(16, radius, (8.2, 7.9))
        mesh = mesh_image(labels, edge_length=4)
        assert oracles.areas(mesh.vertices, mesh.triangles).sum() == pytest.approx(labels.sum(), rel=0.15)
        centre = np.average(mesh.vertices[mesh.triangles].mean(axis=1), axis=0, weights=oracles.areas(mesh.vertices, mesh.triangles))
        r, c = np.nonzero(labels)
        np.testing.assert_allclose(centre, [c.mean() + 0.5, 15.5 - r.mean()], atol=0.15)


# ---- corners and sides ----


@pytest.mark.parametrize("edge_length", [3, 8, 50])
@pytest.mark.parametrize("corners", ["auto", "keep"])
def test_the_mesh_of_a_rectangle_has_its_corners_and_its_sides(corners, edge_length):
    labels = np.zeros((50, 70), int)
    labels[8:41, 11:62] = 1
    mesh = mesh_image(labels, edge_length=edge_length, corners=corners)
    sides = shapely.box(11, 9, 62, 42).exterior
    ends = np.unique(oracles.boundary(mesh.triangles))
    assert shapely.distance(sides, shapely.points(mesh.vertices[ends])).max() <= 1e-9
    for corner in ((11, 9), (62, 9), (62, 42), (11, 42)):
        assert np.hypot(*(mesh.vertices[ends] - corner).T).min() <= 1e-9
    assert oracles.areas(mesh.vertices, mesh.triangles).sum() == pytest.approx(33 * 51, rel=1e-12)


def test_corners_can_be_rounded_in_the_mesh():
    labels = np.pad(np.ones((33, 51), int), 9)
    auto, rounded = (mesh_image(labels, edge_length=6, corners=corners) for corners in ("auto", "round"))
    to_corner = [np.hypot(*(mesh.vertices - [9, 9]).T).min() for mesh in (auto, rounded)]
    assert to_corner[0] <= 1e-9
    assert to_corner[1] > 0.2
    # Apart from its corners the outline is the same, and so is the area.
    off = shapely.distance(
        shapely.box(9, 9, 60, 42).exterior, shapely.points(rounded.vertices[np.unique(oracles.boundary(rounded.triangles))])
    )
    assert np.quantile(off, 0.8) < 0.2
    assert oracles.areas(rounded.vertices, rounded.triangles).sum() == pytest.approx(33 * 51, rel=2e-3)
    assert rounded.report.kept


@pytest.mark.parametrize("angle", [7, 20, 33, 45, 61, 78])
def test_the_mesh_of_a_turned_rectangle(angle):
    labels, centre = specimens.rectangle(90, (60, 40), angle, (45.3, 44.6)), complex(44.6, 44.7)
    half = np.array([30 + 20j, -30 + 20j, -30 - 20j, 30 - 20j]) * np.exp(1j * np.radians(angle)) + centre
    truth = shapely.Polygon(np.stack([half.real, half.imag], axis=1))
    mesh = mesh_image(labels, edge_length=6)
    curve = shapely.multilinestrings(list(mesh.vertices[oracles.boundary(mesh.triangles)]))
    assert shapely.hausdorff_distance(curve, truth.exterior, densify=0.01) <= 1.2
    off = shapely.distance(truth.exterior, shapely.points(mesh.vertices[np.unique(oracles.boundary(mesh.triangles))]))
    assert rms(off) <= 0.2
    assert oracles.areas(mesh.vertices, mesh.triangles).sum() == pytest.approx(2400, rel=0.01)


def wedges(count=13):
    """Tips of 18, 20 and 34 degrees in any direction."""
    y, x = np.mgrid[:100, :100] + 0.5
    for degrees in (18, 20, 34):
        rng = np.random.default_rng(0)
        for _ in range(count):
            heading, half = rng.uniform(0, 2 * np.pi), np.radians(degrees / 2)
            tip = 50 + rng.uniform(-0.5, 0.5, 2) + 14 * np.array([np.cos(heading), np.sin(heading)])
            away = [tip - 36 * np.array([np.cos(heading + turn), np.sin(heading + turn)]) for turn in (half, -half)]
            yield shapely.contains_xy(shapely.Polygon([tip, *away]), x, 100 - y)


def test_a_sharp_tip_is_blunted_or_kept_and_told():
    told = 0
    for labels in wedges():
        blunt, sharp = (mesh_image(labels, edge_length=6, min_angle=32, corners=corners) for corners in ("auto", "keep"))
        # Blunted, no angle is too small, and the tolerance is kept.
        assert oracles.angles(blunt.vertices, blunt.triangles).min() >= 32 - 1e-6
        assert blunt.report.kept
        # Kept, every corner of the outline is a vertex, and the report tells of the angles there and of no other ones.
        oracles.check_valid(sharp.vertices, sharp.triangles)
        outlines, dual_edges = place_outlines(find_crack_edges(labels), Frame(labels.shape))
        corners = outlines.points[dual_edges.is_corner]
        assert all(np.hypot(*(sharp.vertices - corner).T).min() < 1e-9 for corner in corners)
        least = oracles.angles(sharp.vertices, sharp.triangles).min(axis=1)
        report, narrow = sharp.report, least < 32 - 1e-6
        assert report.smallest_angle == pytest.approx(least.min(), abs=1e-6)
        assert report.narrow == narrow.sum()
        assert any("below 32 degrees" in line for line in report.warnings) == narrow.any()
        assert len(report.warnings) == int(narrow.any())
        middles = sharp.vertices[sharp.triangles[narrow]].mean(axis=1)
        assert all(np.hypot(*(corners - middle).T).min() < 6 for middle in middles)
        told += bool(narrow.any())
    assert told >= 1


# ---- exactly along the sides of pixels ----

WITHOUT_CHECKERBOARDS = {
    "disc": specimens.disc(60, 22.3, (30.2, 29.7)),
    "ring": specimens.MASKS["ring"],
    "spiral": specimens.spiral(),
    "comb": specimens.MASKS["comb"],
    "rings": specimens.rings(),
    "one pixel": specimens.MASKS["one pixel"],
    "island in island": specimens.LABELS["island in island"],
    "stripes": specimens.LABELS["stripes"],
    "polycrystal": specimens.polycrystal(),
}


@pytest.mark.parametrize("edge_length", [1.5, 8])
@pytest.mark.parametrize("name", WITHOUT_CHECKERBOARDS)
def test_along_the_sides_of_pixels_nothing_is_off(name, edge_length):
    labels = WITHOUT_CHECKERBOARDS[name]
    mesh = mesh_image(labels, labels=True, outline="pixel", edge_length=edge_length)
    v, t, r = mesh.vertices, mesh.triangles, mesh.regions
    oracles.check_valid(v, t)
    curves = shapely.union_all(shapely.linestrings(v[np.concatenate([oracles.boundary(t), oracles.interfaces(t, r)])]))
    sides = shapely.union_all(shapely.linestrings(oracles.pixel_sides(labels)))
    assert curves.symmetric_difference(sides).length <= 1e-9
    for label in np.unique(r):
        assert oracles.areas(v, t[r == label]).sum() == pytest.approx((labels == label).sum(), rel=1e-12)
    assert oracles.angles(v, t).min() >= 30 - 1e-6
    assert mesh.report.hausdorff <= 1e-9


@pytest.mark.parametrize("gradation", [0.17, 0.3])
def test_at_a_checkerboard_tips_are_parted_and_areas_kept(gradation):
    labels = specimens.MASKS["touching corners inside"].repeat(3, 0).repeat(3, 1)
    mesh = mesh_image(labels, outline="pixel", edge_length=4, gradation=gradation)
    area = oracles.areas(mesh.vertices, mesh.triangles).sum()
    # What tips lose where they are parted, points beside them give back.
    assert area == pytest.approx(labels.sum(), abs=0.01)
    assert oracles.mesh_topology(mesh.triangles) == (2, 0)
    sides = shapely.union_all(shapely.linestrings(oracles.pixel_sides(labels)))
    ends = mesh.vertices[np.unique(oracles.boundary(mesh.triangles))]
    off = shapely.distance(sides, shapely.points(ends))
    # Two tips meet where four pixels do. By triangles of half a pixel they lose an eighth each; a shift t of the points half a
    # pixel from there gives t (3/4 + t / 2) back at each of two sides: t is 1 / 12, less than 1 / 8 whatever else moves. No others move.
    rows, columns = np.nonzero(
        (labels[1:, 1:] == labels[:-1, :-1]) & (labels[1:, :-1] == labels[:-1, 1:]) & (labels[1:, 1:] != labels[1:, :-1])
    )
    tips = np.stack([columns + 1, labels.shape[0] - rows - 1], axis=1)
    assert len(tips) > 0
    beside = np.abs(ends[:, None] - tips).max(axis=2).min(axis=1) <= 0.6
    assert off[beside].max() <= 1 / 8
    assert off[~beside].max() <= 1e-9


def test_smooth_and_pixel_outlines_enclose_the_same():
    labels = specimens.polycrystal(64, 12)
    by_outline = {outline: mesh_image(labels, labels=True, outline=outline, edge_length=4) for outline in ("smooth", "pixel")}
    for label in np.unique(labels):
        one, other = (oracles.areas(m.vertices, m.triangles[m.regions == label]).sum() for m in by_outline.values())
        assert one == pytest.approx(other, rel=0.01)
    dense = region_polygons(place_outlines(find_crack_edges(labels), Frame(labels.shape))[0])
    assert [p.area for p in dense.values()] == pytest.approx([(labels == label).sum() for label in dense], rel=1e-9)
