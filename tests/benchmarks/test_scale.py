"""Images by tiles: time against the same image in memory, memory of a worker, seams; and what 100,000 x 100,000 pixels would take.

pytest -m benchmark -s tests/benchmarks/test_scale.py
"""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import time

import numpy as np
import pytest
from scipy import ndimage

pytestmark = pytest.mark.benchmark
MEGABYTE = 2**20

BLOCK = 2048  # px
# Run in a process of its own, whose peak memory is that of a worker; pixels come from a memory map.
ALONE = """
import json, resource, sys, time
from pathlib import Path
from img2tri import mesh_image, mesh_tiles
import numpy as np
how, source, out, length = sys.argv[1], sys.argv[2], Path(sys.argv[3]), float(sys.argv[4])
labels = {"labels": True} if np.load(source, mmap_mode="r").dtype.kind == "i" else {}
spent, now, pieces = {}, ["start", time.process_time()], 0

def size(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())

def watch(stage, _):
    global pieces
    if stage == "save" and not pieces:
        pieces = size(out.with_name(f".{out.name}.work"))
    spent[now[0]] = spent.get(now[0], 0) + time.process_time() - now[1]
    now[:] = stage, time.process_time()

begun = time.process_time()
if how == "tiles":
    made = mesh_tiles(source, out, edge_length=length, progress=watch, **labels)
    found = {name: made.report[name] for name in ("n_triangles", "seam_edges", "smallest_angle", "replaced")}
    found |= {"pieces": pieces, "output": size(out), "spent": spent}
else:
    mesh = mesh_image(np.load(source), edge_length=length, **labels)
    found = {"n_triangles": len(mesh.triangles), "cpu": time.process_time() - begun}
    mesh.report
found["judged"] = time.process_time() - begun
print(json.dumps(found | {"peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))
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
    """What a process of its own found: triangles, seam edges, CPU seconds without and with the certificate, peak MB."""
    command = [sys.executable, "-c", ALONE, how, str(source), str(out), str(length)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@pytest.mark.parametrize(("name", "n", "length"), [("blobs", 4096, 8.0), ("cells", 4096, 8.0)])
def test_time_and_memory_against_in_memory(name, n, length, tmp_path):
    np.save(tmp_path / "image.npy", blobs(n, 40) if name == "blobs" else cells(n, 50))
    whole = alone("memory", tmp_path / "image.npy", "-", length)
    tiled = alone("tiles", tmp_path / "image.npy", tmp_path / "mesh.zarr", length)
    print(f"\n{name} {n}^2, edge {length:g}: in memory {whole['n_triangles']:,} triangles, {whole['cpu']:.1f} s, with its certificate")
    print(f"  {whole['judged']:.1f} s, {whole['peak']:.0f} MB")
    print(f"  by tiles {tiled['n_triangles']:,} triangles, {tiled['seam_edges']:,} seam edges, {tiled['replaced']} replaced,")
    print(f"  {tiled['smallest_angle']:.2f} degrees, {tiled['judged']:.1f} s with the certificate, {tiled['peak']:.0f} MB")
    print(f"  CPU x {tiled['judged'] / whole['cpu']:.2f}, x {tiled['judged'] / whole['judged']:.2f} with both certificates")
    assert tiled["smallest_angle"] >= 30


def test_a_hundred_thousand_pixels_squared_on_paper(tmp_path):
    """10^8 triangles on 100 workers, from blocks with as many triangles as those would have."""
    np.save(tmp_path / "image.npy", blobs(4096, 80))
    found = alone("tiles", tmp_path / "image.npy", tmp_path / "mesh.zarr", 18.0)
    blocks, here, workers = math.ceil(100_000 / BLOCK) ** 2, 4, 100
    share, tasks = blocks / here, 4 * blocks
    rounds = 4 * math.ceil(blocks / (4 * workers))
    seconds = {stage: found["spent"].get(stage, 0.0) / here for stage in ("survey", "mesh", "seams", "save")}
    wall = rounds * seconds["mesh"] + math.ceil(blocks / workers) * (seconds["survey"] + seconds["seams"] + seconds["save"])
    margin = 2 * (8 * 18 + 32)
    pixels = 1e10 * (1 + ((BLOCK + margin) / BLOCK) ** 2)
    print(f"\n  {blocks:,} blocks, {found['n_triangles'] * share:.2g} triangles; {tasks:,} tasks, {tasks / 1000:.0f} s of a scheduler")
    print("  CPU seconds a block: " + ", ".join(f"{stage} {value:.2f}" for stage, value in seconds.items()))
    print(f"  {wall / 60:.1f} minutes on {workers} workers, {rounds} rounds of meshing in four colours")
    print(
        f"  pixels read {pixels / 1e9:.0f} GB at a byte each; pieces {found['pieces'] * share / 1e9:.1f} GB written, read some six times;"
    )
    print(f"  output {found['output'] * share / 1e9:.1f} GB; seams on the client {found['seam_edges'] * share * 2 * 40 / 1e6:.0f} MB")
    assert found["smallest_angle"] >= 30


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


def near_seams(mesh, block, within=8.0):
    """Smallest angles, sizes (px) of triangles within so many px of borders of blocks, and which far from these and the frame."""
    p = mesh.vertices[mesh.triangles]
    side = np.stack([np.linalg.norm(p[:, (k + 1) % 3] - p[:, (k + 2) % 3], axis=1) for k in range(3)], axis=1)
    a, b, c = np.sort(side, axis=1).T
    angle = np.degrees(np.arccos(np.clip((b**2 + c**2 - a**2) / (2 * b * c), -1, 1)))
    middle, n = p.mean(axis=1), mesh.frame.shape[0]
    inside = ((middle > 64) & (middle < n - 64)).all(axis=1)
    off = abs(middle - block * np.clip(np.round(middle / block), 1, n // block - 1)).min(axis=1)
    return angle, np.sqrt(a * b * np.sqrt(1 - ((a**2 + b**2 - c**2) / (2 * a * b)) ** 2) / 2), inside & (off < within), inside & (off > 64)


@pytest.mark.parametrize("name", ["blobs", "cells"])
def test_seams_are_as_elsewhere(name, monkeypatch):
    from scipy.stats import ks_2samp

    from img2tri import mesh_image
    from img2tri.tiles import block_plan

    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 256)
    samples = {"by blocks": [], "in memory": []}
    for seed in range(4):
        image = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((1024, 1024)), 10) > 0 if name == "blobs" else None
        given = {} if name == "blobs" else {"labels": True}
        image = cells(1024, 50, seed) if image is None else image
        for how, found in samples.items():
            found.append(near_seams(mesh_image(image, edge_length=8.0, blocks=how == "by blocks", **given), 256))
    angles, sizes, near, far = (np.concatenate(parts) for parts in zip(*samples["by blocks"], strict=True))
    same = [np.concatenate([one[k][one[2]] for one in samples["in memory"]]) for k in range(2)]
    print()
    for what, values, there in (("angles", angles, same[0]), ("sizes", sizes, same[1])):
        for where, others in (("elsewhere", values[far]), ("the same places in memory", there)):
            found, here = ks_2samp(values[near], others), values[near]
            least = 1.358 * math.sqrt(1 / len(here) + 1 / len(others))
            print(f"  {name}, {what} at seams and {where}: {len(here):,} and {len(others):,} triangles")
            print(f"    D {found.statistic:.4f}, p {found.pvalue:.2g}; p is .05 at D {least:.4f}")
    assert ks_2samp(angles[near], same[0]).statistic < 0.03
