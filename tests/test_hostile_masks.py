"""Masks and label maps made to be difficult: all oracles hold, and the time goes with the triangles."""

from __future__ import annotations

import time

import numpy as np
import oracles
import pytest
import specimens

from img2tri import mesh_image


def noise(density, n=40, seed=1):
    return (np.random.default_rng(seed).random((n, n)) < density).astype(int)


def grid(n, step):
    m = np.zeros((n, n), int)
    m[::step] = m[:, ::step] = 1
    return m


def islands(n, step=3):
    return np.kron(np.ones((n, n), int), np.pad([[1]], ((1, step - 2), (1, step - 2))))


def carpet(depth):
    m = np.ones((1, 1), int)
    for _ in range(depth):
        m = np.block([[m, m, m], [m, 0 * m, m], [m, m, m]])
    return m


def cantor(depth):
    m = np.ones(1, int)
    for _ in range(depth):
        m = np.concatenate([m, 0 * m, m])
    return np.outer(m, m)


def sierpinski(n):
    y, x = np.mgrid[:n, :n]
    return ((y & x) == 0).astype(int)


def hilbert(order):
    """The Hilbert curve, a line of one pixel with gaps of one pixel."""
    way = np.zeros(1, complex)
    for k in range(order):
        side = 2**k
        turned = way.imag + 1j * way.real
        way = np.concatenate([turned, way + 1j * side, way + side + 1j * side, 2 * side - 1 - way.imag + 1j * (side - 1 - way.real)])
    y, x = way.imag.astype(int), way.real.astype(int)
    m = np.zeros((2 * 2**order - 1,) * 2, int)
    m[2 * y, 2 * x] = 1
    m[y[1:] + y[:-1], x[1:] + x[:-1]] = 1
    return m


def at_the_frame():
    m = np.zeros((20, 20), int)
    m[[0, 0, -1, -1, 0, 10, -1, 10], [0, -1, 0, -1, 10, 0, 10, -1]] = 1
    return m


MASKS = {f"noise {d}": noise(d) for d in (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99)} | {
    "checkerboard": np.indices((24, 24)).sum(0) % 2,
    "grid of lines": grid(30, 2),
    "wider grid": grid(36, 5),
    "dots": 1 - grid(31, 2),
    "a line": np.pad(np.ones((1, 200), int), 3),
    "diagonal chain": np.eye(60, dtype=int),
    "thicker diagonal": np.eye(60, dtype=int) + np.eye(60, k=1, dtype=int),
    "many diagonals": (np.add(*np.mgrid[:40, :40]) % 4 == 0).astype(int),
    "islands": islands(16),
    "holes": 1 - islands(16),
    "1 x n": noise(0.5, 300)[:1],
    "n x 1": noise(0.5, 300)[:, :1],
    "2 x n": noise(0.5, 200)[:2],
    "full row": np.ones((1, 500), int),
    "spiral": specimens.spiral(10),
    "rings": specimens.rings(41),
    "carpet": carpet(3),
    "dust": cantor(3),
    "sieve": sierpinski(32),
    "curve": hilbert(4),
    "between the curve": 1 - hilbert(4),
    "pixels at the frame": at_the_frame(),
    "notches at the frame": 1 - at_the_frame(),
    "a frame": np.pad(np.zeros((30, 30), int), 1, constant_values=1),
}
LABELS = {
    "all different": np.arange(32 * 32).reshape(32, 32),
    "all different, mixed": np.random.default_rng(2).permutation(32 * 32).reshape(32, 32),
    "noise of 3": np.random.default_rng(2).integers(0, 3, (30, 30)),
    "noise of 30": np.random.default_rng(3).integers(0, 30, (30, 30)),
    "a row of labels": np.arange(300)[None],
}


@pytest.mark.parametrize("name", MASKS)
def test_all_promises_hold_for_a_mask(name):
    mask = MASKS[name]
    mesh = mesh_image(mask.astype(bool))
    oracles.check_valid(mesh.vertices, mesh.triangles)
    oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, mask)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6
    assert mesh.report.kept, mesh.report.warnings


@pytest.mark.parametrize("name", MASKS)
def test_corners_join_the_pixels_of_a_mask(name):
    mesh = mesh_image(MASKS[name].astype(bool), connectivity=8)
    assert oracles.mesh_topology(mesh.triangles) == oracles.pixel_topology(MASKS[name] == 1, 8)
    assert mesh.report.kept, mesh.report.warnings


@pytest.mark.parametrize("name", LABELS)
@pytest.mark.parametrize("background", [0, None])
def test_all_promises_hold_for_a_label_map(name, background):
    labels = LABELS[name]
    mesh = mesh_image(labels, labels=True, background=background)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert mesh.report.kept, mesh.report.warnings
    assert oracles.mesh_neighbours(mesh.triangles, mesh.regions) == oracles.pixel_neighbours(labels, background)


LARGE = {
    "noise": lambda k: noise(0.5, 80 * k),
    "checkerboard": lambda k: np.indices((48 * k, 48 * k)).sum(0) % 2,
    "islands": lambda k: islands(40 * k),
    "rings": lambda k: specimens.rings(40 * k + 1),
    "many diagonals": lambda k: (np.add(*np.mgrid[: 60 * k, : 60 * k]) % 4 == 0).astype(int),
    "full row": lambda k: np.ones((1, 1500 * k * k), int),
    "2 x n": lambda k: noise(0.5, 800 * k * k)[:2] if k == 1 else (np.random.default_rng(1).random((2, 800 * k * k)) < 0.5).astype(int),
    "grid of lines": lambda k: grid(80 * k, 2),
}


def spent(image):
    began = time.process_time()
    mesh = mesh_image(image.astype(bool))
    made = time.process_time()
    assert mesh.report.kept
    return np.array([made - began, time.process_time() - made, len(mesh.triangles)])


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_time_goes_with_the_triangles(name):
    spent(LARGE[name](1))
    small, large = spent(LARGE[name](1)), spent(LARGE[name](3))
    per = {"mesh": (small[0] / small[2], large[0] / large[2]), "report": (small[1] / small[2], large[1] / large[2])}
    print(name, {k: [f"{v * 1e6:.0f} us" for v in pair] for k, pair in per.items()}, f"{large[2]:.0f} triangles")
    assert all(after <= 3 * max(before, 2e-5) for before, after in per.values()), per


@pytest.mark.slow
def test_a_hundred_thousand_islands():
    mesh = mesh_image(islands(316).astype(bool))
    assert oracles.mesh_topology(mesh.triangles) == (316**2, 0)


@pytest.mark.parametrize("seed", [10, 19, 40, 47, 59])
def test_gray_noise_with_little_tolerance_has_no_sharp_triangles(seed):
    """Its crossings lie far from the middles of their links, all over the image, and may not go back there for the tolerance's sake."""
    noise = np.random.default_rng(seed).uniform(-3, 7, (22, 30))
    mesh = mesh_image(noise, threshold=2.0, tolerance=0.1, edge_length=1.0)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6
    assert oracles.mesh_topology(mesh.triangles) == oracles.pixel_topology(noise > 2, 4)
    assert mesh.report.hausdorff <= 0.7 + 1e-9
    assert all("apart at" in line for line in mesh.report.warnings)
