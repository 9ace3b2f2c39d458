"""How much memory a mesh takes on the way: little more than the image, and so much for each triangle."""

from __future__ import annotations

import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("resource")
import children

from img2tri import mesh_image
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes.conforming import trace_outlines
from img2tri.shapes.place import constrained_smoothing
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

PER_CROSSING, PER_JUDGED = 300, 550  # bytes for each crossing of an outline: to trace and place it, and to judge a mesh by it
PER_PIXEL, PER_TRIANGLE = 2, 200  # bytes, beside the image
BASE = 40 * 2**20  # libraries and buffers


def highest():
    """The most memory this process has held since the mark was taken down."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024


def discs(n):
    """A mask full of discs of 40 px: outlines are the most of it."""
    r, c = np.ogrid[:n, :n]
    return np.hypot(r % 44 - 21.5, c % 44 - 21.5) < 20


def peak_of(function):
    tracemalloc.start()
    result = function()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return result, peak


def test_peak_of_tracing_and_placing(monkeypatch):
    monkeypatch.setattr(constrained_smoothing, "BATCH", 1 << 12)  # what a batch takes is no matter of how many crossings there are
    mask = discs(1408)
    trace_outlines(Segmentation(mask[:88], 0), Frame((88, 1408)))  # loads what is loaded when used
    (_, dual_edges), peak = peak_of(lambda: trace_outlines(Segmentation(mask, 0), Frame(mask.shape)))
    print(f"{len(dual_edges.crossed)} crossings, {peak / len(dual_edges.crossed):.0f} bytes each")
    assert peak <= PER_CROSSING * len(dual_edges.crossed)


def test_peak_of_a_report_of_many_outlines():
    assert mesh_image(discs(88), edge_length=8).report.kept  # loads what is loaded when used
    mesh = mesh_image(discs(704), edge_length=8)
    crossings = len(find_crack_edges(discs(704)).tail)
    report, peak = peak_of(lambda: mesh.report)
    print(f"{crossings} crossings, {peak / crossings:.0f} bytes each")
    assert report.kept
    assert peak <= PER_JUDGED * crossings


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
