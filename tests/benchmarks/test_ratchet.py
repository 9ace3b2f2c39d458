"""The ratchet: what was reached once is kept. Compares figures with those in ``ratchet.toml``, and fails when one got worse.

    pytest -m benchmark -s tests/benchmarks/test_ratchet.py

Figures are, for some meshes, the time as a multiple of FLOOR (see test_meshing), the number of calls into compiled code, which is the
number of rounds of numpy and does not depend on the machine, the worst angle and the mean quality; and for discs, seen as a mask and in
gray, the root mean square of the distance between the dense outline and the circle. All figures are printed; one that is better than the
kept one by more than the margin may be tightened: change the number in ``ratchet.toml`` in the commit that made it better. One that is
worse by more than the margin fails; where that is the price of something, the commit that changes the number says of what.
"""

from __future__ import annotations

import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import oracles
import pytest
import specimens
from benchmarks.shapes import blob
from benchmarks.test_meshing import grains, triangulating

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark

KEPT = tomllib.loads(Path(__file__).with_name("ratchet.toml").read_text(encoding="utf-8"))
MESHES = {
    "blob(512), 8": (lambda: blob(512), {"edge_length": 8}),
    "blob(2048), 8": (lambda: blob(2048), {"edge_length": 8}),
    "blob(4096), 6": (lambda: blob(4096), {"edge_length": 6}),
    "grains(512, 60), 8": (lambda: grains(512, 60), {"edge_length": 8, "labels": True}),
    "blob(1024), 3 to 12": (lambda: blob(1024), {"edge_length": lambda p: 3 + 9 * p[:, 0] / 1024, "gradation": 0.3}),
}
DISCS = {12: 20, 20: 16, 40: 8, 80: 8, 150: 4, 400: 2}  # so many with this radius, their centres anywhere within a pixel
BETTER_IS = {"ratio": -1, "calls": -1, "rms": -1, "angle": 1, "quality": 1}
ROUNDS = 5


def compare(case, found):
    """Print figures beside the kept ones; return a line for each that got worse."""
    worse = []
    for kind, value in found.items():
        kept, margin, sign = KEPT[case][kind], KEPT["margin"][kind], BETTER_IS[kind]
        gain = sign * (value - kept) / (kept if sign < 0 else 1)  # a share of what costs, a difference of what is good
        verdict = "WORSE" if gain < -margin else "may be tightened" if gain > margin else ""
        print(f"  {case:22} {kind:8} {kept:10.5g} kept {value:10.5g} found  {verdict}", flush=True)
        if verdict == "WORSE":
            worse.append(f"{case}: {kind} was {kept:g}, is {value:.5g}, margin {margin:g}")
    return worse


def spent(function):
    start = time.process_time()
    function()
    return time.process_time() - start


def calls_of(function):
    """How often it calls something compiled."""
    count = 0

    def hear(_, event, __):
        nonlocal count
        count += event == "c_call"

    sys.setprofile(hear)
    try:
        function()
    finally:
        sys.setprofile(None)
    return count


def figures(image, options):
    mesh = mesh_image(image, **options)
    bare = triangulating(mesh)
    # Turn by turn, so that a machine that gets slower is slower for both.
    times = [(spent(lambda: mesh_image(image, **options)), spent(bare)) for _ in range(ROUNDS)]
    ours, floor = np.min(times, axis=0)
    angles = oracles.angles(mesh.vertices, mesh.triangles)
    return {
        "ratio": ours / floor,
        "calls": calls_of(lambda: mesh_image(image, **options)),
        "angle": angles.min(),
        "quality": 8 * np.prod(np.sin(np.radians(angles) / 2), axis=1).mean(),
    }


@pytest.mark.parametrize("case", MESHES)
def test_meshes(case):
    draw, options = MESHES[case]
    print()
    assert compare(case, figures(draw(), options)) == []


@pytest.mark.parametrize("kind", ["mask", "gray"])
@pytest.mark.parametrize("radius", DISCS)
def test_discs(kind, radius):
    rng, off, n = np.random.default_rng(radius), [], 2 * radius + 14
    for _ in range(DISCS[radius]):
        y, x = n / 2 + rng.uniform(-0.5, 0.5, 2)
        image = (specimens.disc if kind == "mask" else specimens.gray_disc)(n, radius, (y, x))
        dense = mesh_image(image, edge_length=radius / 2, threshold=None if kind == "mask" else 127.5).origin.outlines
        off.append(np.hypot(*(dense.points - (x, n - y)).T) - radius)
    print()
    assert compare(f"disc {radius}, {kind}", {"rms": np.sqrt(np.mean(np.concatenate(off) ** 2))}) == []


def test_worse_is_worse():
    good = KEPT["blob(512), 8"]
    print()
    assert compare("blob(512), 8", good) == []
    assert len(compare("blob(512), 8", {"ratio": 1.3 * good["ratio"], "calls": 1.1 * good["calls"]})) == 2
    assert len(compare("blob(512), 8", {"angle": good["angle"] - 1, "quality": good["quality"] - 0.01})) == 2
