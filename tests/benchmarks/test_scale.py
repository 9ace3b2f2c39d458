"""Images by tiles: time against the same image in memory, memory of a worker, seams; and what 100,000 x 100,000 pixels would take.

pytest -m benchmark -s tests/benchmarks/test_scale.py
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time

import numpy as np
import pytest
from scipy import ndimage

pytestmark = pytest.mark.benchmark
MEGABYTE = 2**20

# Run in a process of its own, whose peak memory is that of a worker; pixels come from a memory map.
ALONE = """
import resource, sys, time
from img2tri import mesh_image, mesh_tiles
import numpy as np
how, source, out, length = sys.argv[1], sys.argv[2], sys.argv[3], float(sys.argv[4])
labels = {"labels": True} if np.load(source, mmap_mode="r").dtype.kind == "i" else {}
begun = time.process_time()
if how == "tiles":
    made = mesh_tiles(source, out, edge_length=length, **labels)
    facts = made.n_triangles, made.report["seam_edges"], made.report["smallest_angle"], made.report["replaced"]
else:
    mesh = mesh_image(np.load(source), edge_length=length, **labels)
    facts = len(mesh.triangles), 0, 0.0, 0
print(*facts, time.process_time() - begun, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def blobs(n, size, seed=0):
    """A mask with features of about so many px."""
    coarse = np.random.default_rng(seed).standard_normal((n // 4 + 8, n // 4 + 8)).astype(np.float32)
    coarse = ndimage.gaussian_filter(coarse, size / 16)
    return ndimage.zoom(coarse, 4, order=1)[:n, :n] > 0


def cells(n, size, seed=0):
    """A label map of touching cells about so many px wide."""
    rng = np.random.default_rng(seed)
    side = n // size + 1
    y, x = (np.mgrid[:side, :side] + rng.random((2, side, side)) * 0.8) * size
    marks = np.ones((n, n), bool)
    marks[np.minimum(y, n - 1).astype(int), np.minimum(x, n - 1).astype(int)] = False
    where = ndimage.distance_transform_edt(marks, return_distances=False, return_indices=True)
    return (np.cumsum(~marks).reshape(n, n)[tuple(where)]).astype(np.int32)


def alone(how, source, out, length):
    """Triangles, seam edges, worst angle, replaced triangles, CPU seconds, peak MB."""
    done = subprocess.run(
        [sys.executable, "-c", ALONE, how, str(source), str(out), str(length)], capture_output=True, text=True, check=True
    )
    return [float(word) for word in done.stdout.split()]


@pytest.mark.parametrize(("name", "n", "length"), [("blobs", 4096, 8.0), ("cells", 4096, 8.0)])
def test_time_and_memory_against_in_memory(name, n, length, tmp_path):
    np.save(tmp_path / "image.npy", blobs(n, 40) if name == "blobs" else cells(n, 50))
    m, _, _, _, memory_cpu, memory_peak = alone("memory", tmp_path / "image.npy", "-", length)
    t, seams, angle, replaced, cpu, peak = alone("tiles", tmp_path / "image.npy", tmp_path / "mesh.zarr", length)
    print(f"\n{name} {n}^2, edge {length:g}: in memory {m:,.0f} triangles, {memory_cpu:.1f} s, {memory_peak:.0f} MB")
    print(
        f"  by tiles {t:,.0f} triangles, {seams:,.0f} seam edges, {replaced:.0f} replaced, {angle:.2f} degrees, {cpu:.1f} s, {peak:.0f} MB"
    )
    print(f"  CPU x {cpu / memory_cpu:.2f}")
    assert angle >= 30
    blocks = (1e5 / 2048) ** 2
    share = blocks / (n / 2048) ** 2
    minutes, output = cpu * share / 100 / 60, t * share * (24 + 8 + 8) / 1e9
    print(f"  100,000^2 on 100 workers, on paper: {blocks:,.0f} blocks, {minutes:.1f} minutes of meshing, {t * share:.2g} triangles,")
    print(f"  {output:.0f} GB of output, {seams * share * 32 / 1e9:.2f} GB of seams on the client")


def test_two_workers_against_one(tmp_path):
    import distributed

    from img2tri import mesh_tiles

    np.save(tmp_path / "image.npy", blobs(8192, 40))
    times = []
    for workers in (1, 2):
        with (
            distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
            distributed.Client(cluster) as client,
        ):
            begun = time.perf_counter()
            mesh_tiles(tmp_path / "image.npy", tmp_path / f"{workers}.zarr", edge_length=8.0, client=client)
            times.append(time.perf_counter() - begun)
    print(f"\n8192^2: {times[0]:.1f} s with one worker, {times[1]:.1f} s with two, x {times[1] / times[0]:.2f}")
    print(f"  peak of this process {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")
