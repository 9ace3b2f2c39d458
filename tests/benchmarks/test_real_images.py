"""Speed where real images are: small, thin, full of regions; and what the certificate costs beside the mesh.

    pytest -m benchmark -s tests/benchmarks/test_real_images.py

Prints one table. FLOOR is as in test_meshing: pythoncdt alone, given the final points and edges. All times are of the processor, in one
process, one mask after the other. Silhouettes are drawn by the project: letters, gears, leaves, bones. Nothing here fails for being slow.
"""

from __future__ import annotations

import subprocess
import sys
import time

import cv2
import numpy as np
import oracles
import pytest
from benchmarks.shapes import blob, grains, silhouettes
from benchmarks.test_meshing import floor

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark


def noise(n, share):
    return np.random.default_rng(0).random((n, n)) < share


def specks(n, count, radius):
    """Discs strewn over a mask, those that overlap joined."""
    mask, rng = np.zeros((n, n), np.uint8), np.random.default_rng(0)
    for x, y in rng.integers(0, n, (count, 2)).tolist():
        cv2.circle(mask, (x, y), radius, 1, -1)
    return mask.astype(bool)


ROWS = {
    "30 silhouettes, 8": (lambda: list(silhouettes().values()), {"edge_length": 8}, 3),
    "blob(512), 8": (lambda: [blob(512)], {"edge_length": 8}, 5),
    "grains(512, 60), 8": (lambda: [grains(512, 60)], {"edge_length": 8, "labels": True}, 3),
    "blob(2048), 8": (lambda: [blob(2048)], {"edge_length": 8}, 3),
    "grains(1500, 2000), 8": (lambda: [grains(1500, 2000)], {"edge_length": 8, "labels": True}, 1),
    "noise(256, .5), 8": (lambda: [noise(256, 0.5)], {"edge_length": 8}, 1),
    "2000 discs of 40 px in 3300^2, 8": (lambda: [specks(3300, 2000, 20)], {"edge_length": 8}, 1),
    "3000 discs of 40 px in 4096^2, 8": (lambda: [specks(4096, 3000, 20)], {"edge_length": 8}, 1),
    "blob(2048), 3": (lambda: [blob(2048)], {"edge_length": 3}, 1),
}


def timed(function, repeats):
    """What the function returns at last, and its shortest time."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = function()
        times.append(time.process_time() - start)
    return result, min(times)


def test_meshes_and_certificates():
    print(
        f"\n| {'masks, edge length':32} | {'triangles':9} | {'x FLOOR':7} | us/tri | report / mesh | worst angle | q_mean |\n|{'---|' * 7}"
    )
    for name, (masks, options, repeats) in ROWS.items():
        found = []
        for mask in masks():
            mesh_image(mask[:64, :64] if mask[:64, :64].any() else mask, **options)
            mesh, spent = timed(lambda m=mask, o=options: mesh_image(m, **o), repeats)
            judged = timed(lambda m=mesh: m.__dict__.pop("report", None) or m.report, 1)[1]
            angles = oracles.angles(mesh.vertices, mesh.triangles)
            quality = 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean()
            found.append(
                (len(mesh.triangles), spent / floor(mesh), 1e6 * spent / len(mesh.triangles), judged / spent, angles.min(), quality)
            )
        n, floors, micro, judged, angle, quality = np.median(found, axis=0)
        low = f" ({min(row[4] for row in found):.1f})" if len(found) > 1 else ""
        print(f"| {name:32} | {n:9.0f} | {floors:7.2f} | {micro:6.1f} | {judged:13.2f} | {angle:5.1f}{low:6} | {quality:.4f} |", flush=True)


def test_command_line(tmp_path):
    """From a PNG of 512^2 to an STL, the start of Python and of all libraries in it."""
    resource = pytest.importorskip("resource")
    cv2.imwrite(str(tmp_path / "mask.png"), blob(512).astype(np.uint8) * 255)
    commands = {
        "import numpy": ["-c", "import numpy"],
        "import scipy.sparse.csgraph, scipy.spatial": ["-c", "import scipy.sparse.csgraph, scipy.spatial"],
        "img2tri mesh": ["-m", "img2tri", "mesh", str(tmp_path / "mask.png"), "-o", str(tmp_path / "mesh.stl"), "--edge-length", "8"],
    }
    for name, command in commands.items():
        times = []
        for _ in range(4):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, *command], capture_output=True, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        print(f"{name:44} {min(times):.2f} s", flush=True)
