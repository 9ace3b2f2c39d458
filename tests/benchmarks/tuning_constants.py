"""What each tuning constant of the rooms that make meshes is worth: halve it, double it, and see which measures move.

In: the package that Python imports. Out: a table of constants, and of measures that change by more than `SHOWN` of themselves.

    PYTHONPATH=.:tests python tests/benchmarks/tuning_constants.py [name ...]
"""

from __future__ import annotations

import sys
import warnings

import numpy as np
import pytest
import specimens
import tuning
from benchmarks.shapes import blob, gear

from img2tri import mesh_image
from img2tri.shapes.place.placement import place_outlines
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.types import Frame

SHOWN = 0.02
Y, X = np.mgrid[:128, :128] + 0.5
GRAY = np.rint(255 * np.clip(40.3 - np.hypot(X - 61.2, Y - 66.7) + 0.5, 0, 1)).astype(np.uint8)
RNG = np.random.default_rng(1)
NOISY = np.clip(GRAY + RNG.normal(0, 25, GRAY.shape), 0, 255).astype(np.uint8)
SCANNED = (gear(9, 110, 0.2) * 180 + RNG.integers(0, 9, (110, 110))).astype(np.uint8)  # hard edges, a little noise
COLOURED = np.where(X[..., None] < 64.3, (200, 30, 30), (30, 30, 200))
DRAWING = np.rint(GRAY[..., None] / 255 * COLOURED + 255 - GRAY[..., None]).astype(np.uint8)
IMAGES = {
    "blob": (blob(128, seed=4, holes=2).astype(np.uint8), {"edge_length": 7}),
    "thin": ((specimens.disc(80, 35.1) - specimens.disc(80, 31.9)).astype(np.uint8), {"edge_length": 7, "elements_across": 2}),
    "grains": (specimens.polycrystal(90, 14, 3), {"labels": True, "edge_length": 7}),
    "noise": (np.random.default_rng(0).integers(0, 2, (24, 27)).astype(np.uint8), {"edge_length": 5}),
    "gear": (gear(9, 110, 0.2), {"edge_length": 6}),
    "specks": (np.kron(RNG.integers(0, 3, (14, 14)), np.ones((4, 4), int)), {"labels": True, "edge_length": 8}),
    "noisy gray": (NOISY, {"edge_length": 6, "largest": True}),
    "scanned": (SCANNED, {"edge_length": 6, "labels": False}),
    "drawing": (DRAWING, {"edge_length": 6, "colors": 3}),
    "poisson": (specimens.disc(70, 28.2), {"edge_length": 6, "interior": "poisson"}),
    "smoothed": (blob(90, seed=2, holes=1).astype(np.uint8), {"edge_length": 5, "smoothing": "cotangent"}),
    "symmetric": (specimens.ellipse(80, (31.0, 19.0)), {"edge_length": 6, "symmetric": "xy"}),
    "turned": (specimens.rectangle(80, (50, 33), 27).astype(np.uint8), {"edge_length": 6}),
    "gray": (GRAY, {"edge_length": 6}),
    "graded": (specimens.disc(100, 40.3).astype(np.uint8), {"edge_length": lambda p: 3 + 0.08 * abs(p[:, 0]), "segments_per_turn": 40}),
    "periodic": (
        np.pad(specimens.polycrystal(60, 9, 1), ((0, 60), (0, 60)), mode="symmetric"),
        {"labels": True, "periodic": "x", "edge_length": 6},
    ),
}


def measures() -> dict[str, float]:
    """Everything that is looked at."""
    found: dict[str, float] = {}
    for radius in (8.0, 22.0, 60.0):
        off = []
        for seed in (0, 1, 2):
            centre = 65 + np.random.default_rng(seed).uniform(-0.5, 0.5, 2)  # row and column
            mask = specimens.disc(130, radius, tuple(centre))
            points = place_outlines(find_crack_edges(mask, upward=False), Frame(mask.shape, upward=False))[0].points
            off.append(np.hypot(*(points - centre[::-1]).T) - radius)
        found[f"rms disc {radius:g}"] = float(np.sqrt(np.mean(np.concatenate(off) ** 2)))
    for name, (image, options) in IMAGES.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = mesh_image(image, **options)
            report = mesh.report
        found[f"{name} angle"] = report.smallest_angle
        found[f"{name} triangles"] = len(mesh.triangles)
        found[f"{name} q"] = float(np.mean(mesh.quality().arrays["q"]))
        found[f"{name} off"] = report.hausdorff
        found[f"{name} area"] = max((abs(row["error"]) for row in report.areas.values()), default=0.0) * 100
    return found


def tried(name: str, factor: float) -> dict[str, float] | str:
    """Measure with one constant multiplied, in every module that has it."""
    with pytest.MonkeyPatch.context() as patch:
        try:
            tuning.change(patch, name, factor)
            return measures()
        except Exception as error:  # whatever a wrong constant leads to is a finding
            return f"{type(error).__name__}: {error}"[:60]


def main(names: list[str]) -> None:
    before = measures()
    print(", ".join(f"{key} {value:.3g}" for key, value in before.items()), flush=True)
    for name in names or sorted(tuning.constants()):
        for factor in (0.5, 2.0):
            after = tried(name, factor)
            if isinstance(after, str):
                moved = [after]
            else:
                moved = [
                    f"{key} {value:.3g}->{after[key]:.3g}"
                    for key, value in before.items()
                    if abs(after[key] - value) > SHOWN * abs(value) + 2e-3
                ]
            print(f"{name} x {factor:g}: {'; '.join(moved) or 'nothing'}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
