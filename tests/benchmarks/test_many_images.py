"""A thousand silhouettes on two processes: how much of the processors' time goes into meshes, and how much of two cores is used."""

from __future__ import annotations

import time

import numpy as np
import psutil
import pytest

from img2tri import mesh_images

COUNT = 1000
OVERHEAD = 0.2  # of processor time over what the meshes take here: sending them, and starting two processes


def silhouettes():
    y, x = np.mgrid[-60:60, -60:60]
    turn, radius = np.arctan2(y, x), np.hypot(x, y)
    for k in range(COUNT):
        yield radius < 40 + 8 * np.sin((2 + k % 5) * turn + k)


def processor_time():
    """Of this process and of all it has started, those too that run on: the one that others are forked from."""
    whole = psutil.Process()
    times = [process.cpu_times() for process in (whole, *whole.children(recursive=True))]
    return sum(one.user + one.system + one.children_user + one.children_system for one in times)


def taken(**where):
    began, used = time.perf_counter(), processor_time()
    count = sum(len(mesh.triangles) for _, mesh in mesh_images(silhouettes(), **where))
    return count, time.perf_counter() - began, processor_time() - used


@pytest.mark.benchmark
def test_a_thousand_silhouettes_keep_two_cores_busy():
    next(mesh_images(silhouettes(), workers=1))  # libraries are loaded
    alone, wall_alone, cpu_alone = taken(workers=1)
    both, wall, cpu = taken(workers=2)
    assert both == alone
    print(f"\n{COUNT} silhouettes, {alone:,} triangles: here {wall_alone:.1f} s, of them processor {cpu_alone:.1f} s;")
    print(
        f"two processes {wall:.1f} s, processor {cpu:.1f} s: {cpu_alone / cpu:.0%} of it meshes, {cpu_alone / (2 * wall):.0%} of two cores"
    )
    assert cpu < (1 + OVERHEAD) * cpu_alone
