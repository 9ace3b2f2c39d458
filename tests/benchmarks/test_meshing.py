"""Speed, growth, memory and quality of the conforming recipe. Others are in test_peers, the paper's listing in test_listing.

    pytest -m benchmark -s tests/benchmarks/test_meshing.py

Prints the table of .docs/figures.rst. Machines differ, so times are given as multiples of FLOOR: the time pythoncdt alone takes, in the
same process, to triangulate the final vertices with the final boundary edges. Ours is the time from the mask in memory to the
mesh in memory, everything included. All times are of the processor, so that other work on the machine counts little. Nothing here
fails for being slow.
"""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import oracles
import pytest
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
    times, result = [], None
    for _ in range(repeats):
        result = None  # its memory may serve again
        start = time.process_time()
        result = function()
        times.append(time.process_time() - start)
    return result, min(times)


def fixed_edges(mesh):
    return np.concatenate([oracles.boundary(mesh.triangles), oracles.interfaces(mesh.triangles, mesh.regions)])


def inserted(points, edges):
    import pythoncdt

    triangulation = pythoncdt.Triangulation(pythoncdt.VertexInsertionOrder.AUTO, pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0)
    triangulation.insert_vertices(np.ascontiguousarray(points))
    triangulation.insert_edges(np.ascontiguousarray(edges, np.uint32))
    return triangulation


def triangulating(mesh):
    """What FLOOR is the time of."""
    edges = fixed_edges(mesh)

    def bare():
        triangulation = inserted(mesh.vertices, edges)
        triangulation.erase_outer_triangles_and_holes()
        return triangulation.triangles_array()

    return bare


def floor(mesh):
    return seconds(triangulating(mesh), 5 if len(mesh.triangles) < LARGE else 1)[1]


def row(name, vertices, triangles, spent, base):
    angles = oracles.angles(vertices, triangles)
    # Twice the radius of the incircle over that of the circumcircle, 8 sin(a/2) sin(b/2) sin(c/2): 1 for equilateral triangles.
    quality = 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean()
    print(f"| {name:28} | {len(triangles):8} | {spent / base:8.2f} | {angles.min():5.1f} | {quality:.4f} |", flush=True)


def table(what="mask, edge length"):
    print(f"\n| {what:28} | {'triangles':8} | {'x FLOOR':8} | angle | q_mean |\n|{'---|' * 5}")


def test_speed_and_quality():
    table()
    for name, (mask, edge_length, labels) in MASKS.items():
        image = mask()
        options = {"edge_length": edge_length, "labels": labels or None}
        mesh_image(image, **options)
        mesh, spent = seconds(lambda i=image, o=options: mesh_image(i, **o))
        row(f"{name}, {edge_length}", mesh.vertices, mesh.triangles, spent, floor(mesh))


def test_graded():
    """Edge lengths that are a function of the place, gradation 0.3."""
    n = 1024
    image = blob(n)
    table("blob(1024), edge lengths")
    for name, wanted in {
        "3 to 12 from left to right": lambda p: 3 + 9 * p[:, 0] / n,
        "waves, 3 to 9": lambda p: 6 + 3 * np.sin(p[:, 0] / 40) * np.sin(p[:, 1] / 40),
        "growing from 2 at a spot": lambda p: 2 + 0.3 * np.hypot(*(p - [0.3 * n, 0.5 * n]).T),
    }.items():
        mesh, spent = seconds(lambda wanted=wanted: mesh_image(image, edge_length=wanted, gradation=0.3))
        row(name, mesh.vertices, mesh.triangles, spent, floor(mesh))


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
