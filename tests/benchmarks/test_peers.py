"""The same masks meshed by others, where they are installed: time, quality, and how true the mesh is to its mask.

    pip install triangle gmsh nanomesh
    pytest -m benchmark -s tests/benchmarks/test_peers.py

Prints the table of .docs/figures.rst. Times are from the mask in memory to the mesh in memory, of the processor, the
least of several, as multiples of FLOOR, see test_meshing.py. Those that mesh outlines, not masks, are given what their users would give
them at best: the level one half of the mask, blurred by one pixel, in pieces of the edge length. Area is compared with the number of
pixels; a pixel is wrong if its centre is on the wrong side. Nothing here fails for being slow, or for not being installed.
"""

from __future__ import annotations

import math
import warnings
from importlib.metadata import version
from importlib.util import find_spec

import cv2
import numpy as np
import oracles
import pytest
import shapely
from benchmarks.shapes import blob
from benchmarks.test_meshing import floor, inserted, seconds

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark

MASKS = {"blob(512)": (lambda: blob(512), 8), "blob(2048)": (lambda: blob(2048), 8)}


def test_peers():
    columns = f"{'mask, edge length':17} | {'mesher':18} | triangles | x FLOOR | min angle | mean q | area, % | wrong pixels"
    print(f"\n\n| {columns} |\n|{'---|' * 8}")
    missing = {}
    for name, (draw, h) in MASKS.items():
        mask = draw()
        base = floor(mesh_image(mask, edge_length=h))
        for peer, mesher in PEERS.items():
            try:
                (vertices, triangles), spent = seconds(lambda m=mesher, i=mask, h=h: m(i, h))
            except (ImportError, OSError) as absent:  # the latter where a library of the system lacks
                missing[peer] = getattr(absent, "name", None) or absent
                continue
            angles = oracles.angles(vertices, triangles)
            # Twice the radius of the incircle over that of the circumcircle.
            quality = 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean()
            area = 100 * (abs(oracles.areas(vertices, triangles)).sum() / mask.sum() - 1)
            wrong = (covered(vertices, triangles, mask.shape) != mask).sum()
            figures = f"{spent / base:7.1f} | {angles.min():9.1f} | {quality:6.4f} | {area:+7.3f} | {wrong:12,}"
            print(f"| {f'{name}, {h}':17} | {peer:18} | {len(triangles):9,} | {figures} |", flush=True)
    for peer, package in missing.items():
        print(f"{peer}: skipped, {package} is not there")
    known = {package: version(package) for package in ("triangle", "pythoncdt", "nanomesh", "gmsh", "scipy") if find_spec(package)}
    print("with " + ", ".join(f"{package} {number}" for package, number in known.items()))


def covered(vertices, triangles, shape):
    """Which pixels have their centres inside the mesh: each edge of its boundary toggles those to its right, in each row it crosses."""
    ends = (vertices * (1, -1) + (0, shape[0]) - 0.5)[oracles.boundary(triangles)]
    here, there = ends[:, 0], ends[:, 1]
    low, high = np.minimum(here[:, 1], there[:, 1]), np.maximum(here[:, 1], there[:, 1])
    first = np.ceil(low).astype(int)
    count = np.ceil(high).astype(int) - first
    edge = np.repeat(np.arange(len(ends)), count)
    row = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    part = (row - here[edge, 1]) / (there[edge, 1] - here[edge, 1])
    column = np.ceil(here[edge, 0] + part * (there[edge, 0] - here[edge, 0])).clip(0, shape[1]).astype(int)
    toggles = np.zeros((shape[0], shape[1] + 1), int)
    np.add.at(toggles, (row, column), 1)
    return np.cumsum(toggles[:, :-1], axis=1) % 2 == 1


def outlines(mask, h):
    """RegionRings of points, about h apart, y up; and a polygon that knows the inside."""
    import contourpy

    soft = cv2.GaussianBlur(np.pad(mask, 4).astype(np.float32), (0, 0), 1)
    rings = []
    for line in contourpy.contour_generator(z=soft).lines(0.5):
        place = shapely.LineString(line * (1, -1) + (-3.5, mask.shape[0] + 3.5))
        if abs(shapely.Polygon(place).area) >= 1:
            pieces = max(6, round(place.length / h))
            rings.append(shapely.get_coordinates(shapely.line_interpolate_point(place, np.arange(pieces) / pieces, normalized=True)))
    following = [np.roll(np.arange(len(ring)), -1) for ring in rings]
    starts = np.cumsum([0, *map(len, rings)])
    edges = np.concatenate([np.stack([np.arange(len(to)), to], axis=1) + start for to, start in zip(following, starts, strict=False)])
    inside = shapely.make_valid(shapely.MultiPolygon([shapely.Polygon(max(rings, key=len))]))
    for ring in sorted(rings, key=len)[:-1]:
        inside = inside.symmetric_difference(shapely.Polygon(ring))
    return np.concatenate(rings), edges, inside


def most(h):
    """Largest area of a triangle, so that edges are about h long on average."""
    return 1.5 * math.sqrt(3) / 4 * h**2


def by_img2tri(mask, h):
    mesh = mesh_image(mask, edge_length=h)
    return mesh.vertices, mesh.triangles


def by_pythoncdt(mask, h):
    import pythoncdt

    points, edges, _ = outlines(mask, h)
    triangulation = inserted(points, edges)
    outside, criterion = triangulation.collect_outer_triangles_and_holes(), pythoncdt.RefinementCriterion
    angle, area = criterion.SMALLEST_ANGLE, criterion.LARGEST_AREA
    for what, threshold in ((angle, math.radians(20)), (area, most(h)), (angle, math.radians(30))):
        triangulation.refine_triangles(1_000_000, what, threshold, outside, 0.0)
    triangulation.finalize_triangulation(outside)
    corners = triangulation.vertices_array()
    return np.stack([corners["x"], corners["y"]], axis=1), triangulation.triangles_array()["vertices"].astype(np.int64)


def by_triangle(mask, h):
    import triangle

    points, edges, inside = outlines(mask, h)
    holes = [shapely.Polygon(ring) for part in shapely.get_parts(inside) for ring in part.interiors]
    given = {"vertices": points, "segments": edges}
    if holes:
        given["holes"] = shapely.get_coordinates(shapely.point_on_surface(holes))
    mesh = triangle.triangulate(given, f"pq30a{most(h):.6f}")
    return mesh["vertices"], mesh["triangles"]


def by_gmsh(mask, h, optimized=False):
    import gmsh

    points, edges, _ = outlines(mask, h)
    gmsh.initialize(interruptible=False)
    try:
        for option, value in (("General.Terminal", 0), ("General.NumThreads", 1), ("Mesh.MeshSizeMax", h), ("Mesh.Algorithm", 6)):
            gmsh.option.setNumber(option, value)
        for x, y in points:
            gmsh.model.geo.addPoint(x, y, 0, h)
        lines = [gmsh.model.geo.addLine(int(a) + 1, int(b) + 1) for a, b in edges]
        for line in lines:
            gmsh.model.geo.mesh.setTransfiniteCurve(line, 2)
        gmsh.model.geo.addPlaneSurface(gmsh.model.geo.addCurveLoops(lines))
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)
        for method in ("Relocate2D", "Laplace2D") if optimized else ():
            gmsh.model.mesh.optimize(method, niter=3)
        tags, places, _ = gmsh.model.mesh.getNodes()
        corners = gmsh.model.mesh.getElementsByType(2)[1].reshape(-1, 3).astype(np.int64)
    finally:
        gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    return places.reshape(-1, 3)[:, :2], number[corners]


def by_gmsh_optimized(mask, h):
    return by_gmsh(mask, h, optimized=True)


def by_nanomesh(mask, h):
    """By its own way from the mask; it marks what is inside by the mask at the centroids."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from nanomesh import Mesher2D

        mesher = Mesher2D(mask.astype(np.uint8))
        mesher.generate_contour(level=0.5, precision=1, max_edge_dist=h)
        found = mesher.triangulate(opts=f"pAq30a{most(h):.6f}").get("triangle")
    points, triangles = np.asarray(found.points)[:, :2], np.asarray(found.cells)
    row, column = np.rint(points[triangles].mean(axis=1)).astype(int).T.clip(0, np.array(mask.shape)[:, None] - 1)
    return points[:, ::-1] * (1, -1) + (0.5, mask.shape[0] - 0.5), triangles[mask[row, column]]


def by_scipy(mask, h):
    """What one writes by hand: the outline and a hexagonal grid, Delaunay's triangles of all, those with their centroids inside."""
    from scipy.spatial import Delaunay

    points, _, inside = outlines(mask, h)
    y, x = np.meshgrid(np.arange(0, mask.shape[0], h * math.sqrt(3) / 2), np.arange(0.0, mask.shape[1], h), indexing="ij")
    x[1::2] += h / 2
    inner = inside.buffer(-0.6 * h)
    shapely.prepare([inner, inside])
    grid = np.stack([x.ravel(), y.ravel()], axis=1)
    points = np.concatenate([points, grid[shapely.contains_xy(inner, *grid.T)]])
    triangles = Delaunay(points).simplices
    return points, triangles[shapely.contains_xy(inside, *points[triangles].mean(axis=1).T)]


PEERS = {
    "img2tri": by_img2tri,
    "Triangle": by_triangle,
    "pythoncdt, refined": by_pythoncdt,
    "nanomesh": by_nanomesh,
    "Gmsh": by_gmsh,
    "Gmsh, optimized": by_gmsh_optimized,
    "Delaunay by hand": by_scipy,
}
