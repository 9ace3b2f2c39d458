"""What writing a mesh costs, as a share of making it: CPU of both, taken in turns in one process.

    pytest -m benchmark -s tests/benchmarks/test_writers.py

Kept figures are in ``ratchet.toml``; goals, at 1.4 million triangles, are printed beside what was found.
"""

from __future__ import annotations

import pytest
from benchmarks.shapes import blob
from benchmarks.test_ratchet import compare, spent

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark

SUFFIXES = (".stl", ".ply", ".obj", ".off", ".3mf", ".glb", ".vtp", ".vtu", ".vtkhdf", ".msh", ".inp", ".bdf", ".xdmf", ".mesh")
GOALS = {".stl": 2, ".vtu": 3, ".msh": 4}
ROUNDS = 3


def shares(image, edge_length, suffixes, folder, rounds):
    """CPU of writing each format over that of meshing; the least of some rounds of each."""
    mesh = mesh_image(image, edge_length=edge_length)
    print(f"  {len(mesh.triangles)} triangles")
    meshing, writing = [], {suffix: [] for suffix in suffixes}
    for _ in range(rounds):
        meshing.append(spent(lambda: mesh_image(image, edge_length=edge_length)))
        for suffix, times in writing.items():
            times.append(spent(lambda suffix=suffix: mesh.save(folder / f"a{suffix}")))
    return {suffix: min(times) / min(meshing) for suffix, times in writing.items()}


def test_writers_are_as_quick_as_they_were(tmp_path):
    found = shares(blob(1024), 2, SUFFIXES, tmp_path, ROUNDS)
    worse = [line for suffix, share in found.items() for line in compare(f"write {suffix}", {"ratio": share})]
    assert not worse


def test_writing_millions_of_triangles_is_as_quick_as_it_was(tmp_path):
    found = shares(blob(4096), 3, GOALS, tmp_path, 2)
    print("  " + ", ".join(f"{suffix} {share:.2f} (goal {GOALS[suffix]})" for suffix, share in found.items()))
    worse = [line for suffix, share in found.items() for line in compare(f"write {suffix}, 1.4 M", {"ratio": share})]
    assert not worse
