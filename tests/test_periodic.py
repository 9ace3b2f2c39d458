"""Opposite sides divided alike: all other promises kept, the pairs exact; and clear errors where that cannot be."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens

from img2tri import mesh_image
from img2tri.errors import ImageError, MeshError, ParameterError
from img2tri.shapes.periodic.vertex_pairs import vertex_pairs


def wrapped(labels):
    """The first row and column once more at the end."""
    return np.pad(labels, ((0, 1), (0, 1)), mode="wrap")


def blots(seed, shape, count, width):
    """Smooth zones that repeat: white noise under a Gaussian, by Fourier transform."""
    rng = np.random.default_rng(seed)
    fy, fx = np.fft.fftfreq(shape[0])[:, None], np.fft.fftfreq(shape[1])
    blur = np.exp(-2 * np.pi**2 * width**2 * (fx**2 + fy**2))
    values = np.fft.ifft2(np.fft.fft2(rng.standard_normal(shape)) * blur).real
    return wrapped(np.searchsorted(np.quantile(values, np.arange(1, count) / count), values))


def grains(seed, shape, count):
    """Nearest of some seeds on a torus."""
    h, w = shape
    y, x = np.mgrid[:h, :w] + 0.5
    seeds = np.random.default_rng(seed).random((count, 2)) * shape
    away = [np.hypot((y - r + h / 2) % h - h / 2, (x - c + w / 2) % w - w / 2) for r, c in seeds]
    return wrapped(np.argmin(away, axis=0) + 1)


def check(labels, periodic, *, background=0, **options):
    mesh = mesh_image(labels, labels=True, background=background, periodic=periodic, **options)
    v = mesh.vertices
    oracles.check_valid(v, mesh.triangles)
    assert oracles.angles(v, mesh.triangles).min() >= 30 - 1e-6
    oracles.check_faithful(v, mesh.triangles, mesh.regions, labels, background=background)
    assert set(mesh.periodic_pairs) == set(periodic)
    for name, pairs in mesh.periodic_pairs.items():
        axis = "xy".index(name)
        one, other = v[pairs[:, 0]], v[pairs[:, 1]]
        assert (one[:, axis] == 0).all()
        assert (other[:, axis] == labels.shape[1 - axis]).all()
        assert (one[:, 1 - axis] == other[:, 1 - axis]).all(), "the same place, bit for bit"
        assert len(pairs) == (v[:, axis] == 0).sum() == (v[:, axis] == labels.shape[1 - axis]).sum(), "no vertex without its twin"
    return mesh


@pytest.mark.parametrize("periodic", ["x", "y", "xy"])
@pytest.mark.parametrize("seed", range(4))
def test_maps_that_repeat(seed, periodic):
    edge_length = [4, 6, 9, 16][seed]
    check(blots(seed, (40, 57), 2 + seed % 3, 3), periodic, background=[None, 0][seed % 2], edge_length=edge_length)
    check(grains(seed, (60, 44), 3 + 3 * seed), periodic, edge_length=edge_length)
    check(wrapped(np.random.default_rng(seed).integers(0, 3, (9, 12))), periodic, background=None, edge_length=edge_length)


@pytest.mark.parametrize("periodic", ["x", "y", "xy"])
def test_straight_sides_are_divided_evenly(periodic):
    labels = np.ones((61, 53), int)
    labels[22:] = 2
    labels = labels if periodic != "y" else labels.T
    mesh = mesh_image(labels, labels=True, background=None, periodic=periodic if periodic != "xy" else "x", edge_length=5)
    whole = mesh_image(np.ones((61, 53), int), labels=True, background=None, periodic=periodic, edge_length=5)
    axis = 1 if periodic == "y" else 0
    for wall in (0, 53):
        v = mesh.vertices
        places = np.sort(v[v[:, axis] == wall, 1 - axis])
        junction = 22 if periodic == "y" else 61 - 22
        assert abs(places - junction).min() < 1e-9
        for part in (places[places < junction + 1e-9], places[places > junction - 1e-9]):
            assert np.diff(part) == pytest.approx(np.ptp(part) / (len(part) - 1))
    for axis, wall in ((0, 0), (0, 53), (1, 0), (1, 61)):
        places = np.sort(whole.vertices[whole.vertices[:, axis] == wall, 1 - axis])
        assert np.diff(places) == pytest.approx(np.ptp(places) / (len(places) - 1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(300))
def test_many_maps_that_repeat(seed):
    rng = np.random.default_rng(seed)
    shape, periodic = rng.integers(12, 100, 2), ["x", "y", "xy"][seed % 3]
    labels = blots(seed, shape, int(rng.integers(2, 6)), rng.uniform(1, 6)) if seed % 2 else grains(seed, shape, int(rng.integers(2, 40)))
    check(labels, periodic, background=[None, 0][int(rng.integers(2))], edge_length=rng.uniform(4, 16))


@pytest.mark.parametrize("name", specimens.ALL)
def test_specimens_side_by_side(name):
    tiled = wrapped(np.tile(specimens.ALL[name], (2, 2)))
    check(tiled, "xy", edge_length=6)


def test_one_pixel():
    check(np.ones((1, 1), int), "xy", edge_length=8)


def test_shifted_maps_repeat_too():
    labels = grains(3, (40, 40), 9)
    rolled = wrapped(np.roll(labels[:-1, :-1], (13, 27), axis=(0, 1)))
    check(rolled, "xy", edge_length=6)


def test_corners_pair_in_both_directions():
    mesh = check(grains(1, (40, 50), 8), "xy", edge_length=7)
    places = {tuple(v): i for i, v in enumerate(mesh.vertices.tolist())}
    lower_left, lower_right, upper_left = (places[p] for p in ((0.0, 0.0), (51.0, 0.0), (0.0, 41.0)))
    assert [lower_left, lower_right] in mesh.periodic_pairs["x"].tolist()
    assert [lower_left, upper_left] in mesh.periodic_pairs["y"].tolist()


@pytest.mark.parametrize(
    "options",
    [
        {"keep_area": False},
        {"outline": "pixel"},
        {"corners": "keep", "min_angle": 20},
        {"elements_across": 3},
        {"segments_per_turn": 24},
        {"boundary_edge_length": 3, "edge_length": 12},
        {"edge_length": {1: 3, 2: 12}},
        {"smoothing": "uniform"},
        {"spacing": (0.3, 0.7), "origin": (11.1, -7.3)},
        {"origin": "upper"},
    ],
    ids=lambda o: next(iter(o)),
)
def test_with_other_options(options):
    for labels in (grains(5, (50, 44), 7), blots(5, (50, 44), 3, 3)):
        mesh = mesh_image(labels, labels=True, background=None, periodic="xy", **{"edge_length": "7px", **options})
        left, bottom, right, top = mesh.frame.bounds
        for name, walls in (("x", (left, right)), ("y", (bottom, top))):
            axis, pairs = "xy".index(name), mesh.periodic_pairs[name]
            one, other = mesh.vertices[pairs[:, 0]], mesh.vertices[pairs[:, 1]]
            assert (one[:, 1 - axis] == other[:, 1 - axis]).all()
            assert len(pairs) == (np.abs(mesh.vertices[:, axis] - walls[0]) < 1e-9).sum()
        assert mesh.report.kept


def test_masks_with_a_threshold():
    gray = (blots(2, (50, 60), 2, 4) * 200 + 20).astype(np.uint8)
    mesh = mesh_image(gray, threshold=128, edge_length=6, periodic="x")
    assert len(mesh.periodic_pairs["x"]) > 0
    assert mesh.report.kept


def test_copies_set_side_by_side_fit():
    mesh = check(grains(4, (40, 50), 8), "x", edge_length=7)
    n, pairs = len(mesh.vertices), mesh.periodic_pairs["x"]
    number = np.arange(n, 2 * n)
    number[pairs[:, 0]] = pairs[:, 1]
    used, triangles = np.unique(np.concatenate([mesh.triangles, number[mesh.triangles]]), return_inverse=True)
    oracles.check_valid(np.concatenate([mesh.vertices, mesh.vertices + [51, 0]])[used], triangles.reshape(-1, 3))


def test_it_is_the_same_every_time():
    one, other = (mesh_image(grains(6, (40, 40), 9), labels=True, edge_length=6, periodic="xy") for _ in range(2))
    assert one.vertices.tobytes() == other.vertices.tobytes()
    assert one.triangles.tobytes() == other.triangles.tobytes()


def test_a_mesh_made_without_has_no_pairs():
    assert mesh_image(specimens.disc(), edge_length=6).periodic_pairs == {}


def test_an_error_says_where_sides_differ():
    labels = grains(1, (20, 30), 5)
    labels[7, -1] = 99
    with pytest.raises(ImageError, match=r"last column, found \d+ and 99 in row 7 \(1 such\).*np\.pad\(image, \(\(0, 0\), \(0, 1\)\)"):
        mesh_image(labels, labels=True, periodic="x")
    labels = grains(1, (20, 30), 5)
    labels[0, [4, 9]] = 77
    words = r"first and the last row, found 77 and \d+ in column 4 \(2 such\).*np\.pad\(image, \(\(0, 1\), \(0, 0\)\)"
    with pytest.raises(ImageError, match=words):
        mesh_image(labels, labels=True, periodic="xy")


def test_what_does_not_go_with_it_is_an_error():
    mask = specimens.disc() * 255
    with pytest.raises(ParameterError, match="periodic: expected 'x', 'y', 'xy' or None, found 'z'"):
        mesh_image(mask, periodic="z")
    with pytest.raises(ParameterError, match="periodic: .* recipe 'structured'"):
        mesh_image(mask, periodic="x", recipe="structured")
    with pytest.raises(ParameterError, match="periodic: .* smoothing 'cotangent'"):
        mesh_image(mask, periodic="x", smoothing="cotangent")


def test_vertices_without_a_twin_are_an_error():
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.5]])
    with pytest.raises(MeshError, match="periodic: expected the same places on opposite sides"):
        vertex_pairs(corners, (0, 0, 1, 1), "x")
