"""How much memory a mesh takes on the way: little more than the image, and so much for each triangle."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

pytest.importorskip("resource")
import children

PER_PIXEL, PER_TRIANGLE = 2, 200  # bytes, beside the image
BASE = 40 * 2**20  # libraries and buffers


def highest():
    """The most memory this process has held since the mark was taken down."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024


def mesh_blob(case):
    from benchmarks.shapes import blob

    from img2tri import mesh_image

    size, edge_length = case
    image = blob(size)
    mesh_image(blob(64))  # loads what is loaded when used
    Path("/proc/self/clear_refs").write_text("5")
    before = highest()
    began = time.perf_counter()
    mesh = mesh_image(image, edge_length=edge_length, max_pixels=size * size)
    return f"{highest() - before} {len(mesh.triangles)} {time.perf_counter() - began:.2f}"


def check_peak(size, edge_length, seconds):
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("only Linux says what a process held at most")
    (outcome,) = children.run("test_memory:mesh_blob", [(size, edge_length)], seconds=seconds, memory=24 * children.GIGABYTE)
    assert outcome.kind == "done", outcome
    peak, triangles, took = outcome.text.split()
    print(f"{size} x {size}: peak {int(peak) / 2**20:.0f} MB beside the image, {triangles} triangles, {took} s")
    assert int(peak) <= PER_PIXEL * size**2 + PER_TRIANGLE * int(triangles) + BASE


def test_peak_of_a_large_image():
    check_peak(4096, 8.0, 60)


@pytest.mark.slow
@pytest.mark.parametrize(("size", "edge_length"), [(4096, 2.0), (16384, 32.0), (16384, 8.0)])
def test_peak_of_huge_images(size, edge_length):
    check_peak(size, edge_length, 600)
