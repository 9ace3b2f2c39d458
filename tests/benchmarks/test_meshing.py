"""Speed, growth, memory and quality of the conforming recipe, and of others that mesh the same outlines.

    pytest -m benchmark -s tests/benchmarks/test_meshing.py

Prints the table of the README. Machines differ, so times are given as multiples of FLOOR: the time pythoncdt alone takes, in the
same process, to triangulate the final vertices with the final boundary edges. Ours is the time from the mask in memory to the
mesh in memory, everything included; the others are given our outline. All times are of the processor, so that other work on the
machine counts little. Nothing here fails for being slow.
"""

from __future__ import annotations

import math
import subprocess
import sys
import time

import numpy as np
import oracles
import pytest
import shapely
from benchmarks import listing
from benchmarks.shapes import blob
from scipy.spatial import cKDTree

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark


def grains(n, k, seed=0):
    """A polycrystal of k grains."""
    places = np.random.default_rng(seed).random((k, 2)) * n
    y, x = np.mgrid[:n, :n] + 0.5
    return (cKDTree(places).query(np.stack([x.ravel(), y.ravel()], axis=1))[1].reshape(n, n) + 1).astype(np.int32)


MASKS = {
    "blob(512)": (lambda: blob(512), 8, False),
    "blob(2048)": (lambda: blob(2048), 8, False),
    "blob(4096)": (lambda: blob(4096), 6, False),
    "blob(4096), fine": (lambda: blob(4096), 3, False),
    "grains(512, 60)": (lambda: grains(512, 60), 8, True),
}
LARGE = 1_000_000  # triangles from which one run must do


def seconds(function, repeats=5):
    """What the function returns, and its shortest time."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = function()
        times.append(time.process_time() - start)
    return result, min(times)


def fixed_edges(mesh):
    return np.concatenate([oracles.boundary(mesh.triangles), oracles.interfaces(mesh.triangles, mesh.regions)])


def inserted(points, edges):
    import pythoncdt

    triangulation = pythoncdt.Triangulation(
        pythoncdt.VertexInsertionOrder.AUTO, pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
    )
    triangulation.insert_vertices(np.ascontiguousarray(points))
    triangulation.insert_edges(np.ascontiguousarray(edges, np.uint32))
    return triangulation


def floor(mesh):
    edges = fixed_edges(mesh)

    def bare():
        triangulation = inserted(mesh.vertices, edges)
        triangulation.erase_outer_triangles_and_holes()
        return triangulation.triangles_array()

    return seconds(bare, 5 if len(mesh.triangles) < LARGE else 1)[1]


def row(name, vertices, triangles, spent, base):
    angles = oracles.angles(vertices, triangles)
    # Twice the radius of the incircle over that of the circumcircle, 8 sin(a/2) sin(b/2) sin(c/2): 1 for equilateral triangles.
    quality = 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean()
    print(f"| {name:28} | {len(triangles):8} | {spent / base:8.2f} | {angles.min():5.1f} | {quality:.4f} |", flush=True)


def table():
    print(f"\n| {'mask, edge length':28} | {'triangles':8} | {'x FLOOR':8} | angle | q_mean |\n|{'---|' * 5}")


def test_speed_and_quality():
    table()
    for name, (mask, edge_length, labels) in MASKS.items():
        image = mask()
        options = {"edge_length": edge_length, "labels": labels or None}
        mesh_image(image, **options)
        mesh, spent = seconds(lambda i=image, o=options: mesh_image(i, **o))
        row(f"{name}, {edge_length}", mesh.vertices, mesh.triangles, spent, floor(mesh))


def test_growth():
    image, per_triangle = blob(4096), []
    print("\nblob(4096), all the same but the edge length; ns per triangle relative to the first")
    for edge_length in (35, 11, 3.5, 1.1):
        mesh, spent = seconds(lambda h=edge_length: mesh_image(image, edge_length=h), 3)
        per_triangle.append(spent / len(mesh.triangles))
        print(f"  {len(mesh.triangles):9} triangles   {per_triangle[-1] / per_triangle[0]:7.4f}", flush=True)


MEMORY = """
import sys
from pathlib import Path
sys.path[:0] = {path!r}
from benchmarks.shapes import blob
from img2tri import mesh_image
def peak():
    return 1024 * int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0])
image = blob(4096)
mesh_image(blob(512), edge_length=8)
before = peak()
mesh = mesh_image(image, edge_length={edge_length})
print(len(mesh.triangles), (peak() - before) / len(mesh.triangles))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_peak_memory():
    print("\nblob(4096), each in a process of its own: peak over what was there with the image, mesh included")
    for edge_length in (3.5, 1.1):
        code = MEMORY.format(path=sys.path, edge_length=edge_length)
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
        print(f"  {found[0]:>9} triangles   {float(found[1]):6.1f} bytes per triangle", flush=True)


def test_others():
    """On the outline of our mesh of blob(512); scipy, which has no outlines, on its vertices; the listing, on the mask."""
    image, edge_length = blob(512), 8
    mesh = mesh_image(image, edge_length=edge_length)
    mesh, spent = seconds(lambda: mesh_image(image, edge_length=edge_length))
    base = floor(mesh)
    edges = oracles.boundary(mesh.triangles)
    at, ends = np.unique(edges, return_inverse=True)
    points, edges = mesh.vertices[at], ends.reshape(-1, 2)
    area = 1.5 * math.sqrt(3) / 4 * edge_length**2  # the largest, which makes the mean edge about as long as wanted
    table()
    row("img2tri", mesh.vertices, mesh.triangles, spent, base)
    for name, peer in {
        "pythoncdt, refined": lambda: refined_by_pythoncdt(points, edges, area),
        "Triangle, pq30a": lambda: refined_by_triangle(points, edges, area),
        "Gmsh, frontal": lambda: meshed_by_gmsh(points, edges, edge_length),
        "scipy Delaunay, same vertices": lambda: delaunay_by_scipy(mesh.vertices),
        "the paper's listing": lambda: by_the_listing(image, edge_length),
    }.items():
        try:
            repeats = 1 if "listing" in name else 5
            (vertices, triangles), theirs = seconds(peer, repeats)
        except ImportError as missing:
            print(f"| {name:28} | {missing.name} is not installed")
            continue
        row(name, vertices, triangles, theirs, base)


def refined_by_pythoncdt(points, edges, area):
    import pythoncdt

    triangulation = inserted(points, edges)
    outside, criterion = triangulation.collect_outer_triangles_and_holes(), pythoncdt.RefinementCriterion
    for what, threshold in (
        (criterion.SMALLEST_ANGLE, math.radians(20)),
        (criterion.LARGEST_AREA, area),
        (criterion.SMALLEST_ANGLE, math.radians(30)),
    ):
        triangulation.refine_triangles(1_000_000, what, threshold, outside, 0.0)
    triangulation.finalize_triangulation(outside)
    corners = triangulation.vertices_array()
    return np.stack([corners["x"], corners["y"]], axis=1), triangulation.triangles_array()["vertices"].astype(np.int64)


def refined_by_triangle(points, edges, area):
    import triangle

    given = {"vertices": points, "segments": edges}
    holes = [h for p in shapely.get_parts(shapely.polygonize(shapely.linestrings(points[edges]))) for h in holes_of(p)]
    mesh = triangle.triangulate({**given, "holes": holes} if holes else given, f"pq30a{area:.6f}")
    return mesh["vertices"], mesh["triangles"]


def holes_of(polygon):
    return [shapely.get_coordinates(shapely.point_on_surface(shapely.Polygon(ring)))[0] for ring in polygon.interiors]


def meshed_by_gmsh(points, edges, edge_length):
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.MeshSizeMax", edge_length)
        gmsh.option.setNumber("Mesh.Algorithm", 6)
        for x, y in points:
            gmsh.model.geo.addPoint(x, y, 0, edge_length)
        lines = [gmsh.model.geo.addLine(int(a) + 1, int(b) + 1) for a, b in edges]
        for line in lines:
            gmsh.model.geo.mesh.setTransfiniteCurve(line, 2)
        loops = gmsh.model.geo.addCurveLoops(lines)
        gmsh.model.geo.addPlaneSurface(loops)
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        corners = gmsh.model.mesh.getElementsByType(2)[1].reshape(-1, 3).astype(np.int64)
    finally:
        gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    return places.reshape(-1, 3)[:, :2], number[corners]


def delaunay_by_scipy(vertices):
    from scipy.spatial import Delaunay

    return vertices, Delaunay(vertices).simplices


def by_the_listing(image, edge_length):
    binary, distance = image * np.uint8(255), 0.7 * edge_length
    [(vertices, triangles, _)] = listing.put_together(binary, 150, 1300, distance, distance, np.random.default_rng(0))
    return vertices, triangles
