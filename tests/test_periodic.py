"""Opposite sides divided alike: all other promises kept, the pairs exact; and clear errors where that cannot be."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens

from img2tri import mesh_image
from img2tri.errors import MeshError, ParameterError
from img2tri.shapes.periodic.paired_mesh_vertices import vertex_pairs


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


def torus_disc(n, centre, radius):
    """A disc on a torus of n x n pixels."""
    y, x = np.mgrid[:n, :n] + 0.5
    return np.hypot(*(np.minimum(abs(p - c), n - abs(p - c)) for p, c in ((x, centre[0]), (y, centre[1])))) < radius


@pytest.mark.parametrize("centre", [(0, 0), (3.2, 60.7), (31.9, 0.4), (32, 32)])
def test_the_cell_is_as_wide_as_the_image(centre):
    disc = torus_disc(64, centre, 20)
    mesh = mesh_image(disc, periodic="xy")
    assert mesh.frame.bounds == (0, 0, 64, 64)
    assert mesh.report.areas[1]["mesh"] == pytest.approx(disc.sum(), rel=1e-3)
    assert mesh.report.kept
    assert set(mesh.periodic_pairs) == {"x", "y"}


def glued(mesh, *, shift):
    """Vertices and triangles of a mesh with its copies to the right and above, vertices of a pair being one."""
    n, pairs, offset = len(mesh.vertices), mesh.periodic_pairs, np.array(mesh.frame.bounds[2:])
    vertices, triangles = [mesh.vertices], [mesh.triangles]
    for k, name in enumerate(shift, 1):
        number = np.arange(k * n, (k + 1) * n)
        number[pairs[name][:, 0]] = pairs[name][:, 1]
        vertices.append(mesh.vertices + offset * [name == "x", name == "y"])
        triangles.append(number[mesh.triangles])
    used, corners = np.unique(np.concatenate(triangles), return_inverse=True)
    return np.concatenate(vertices)[used], corners.reshape(-1, 3)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("background", [None, 0])
def test_labels_may_differ_across_the_seam(seed, background):
    rng = np.random.default_rng(seed)
    for labels in (
        grains(seed, (40, 36), 6)[:-1, :-1],
        blots(seed, (30, 41), 2 + seed % 3, 2)[:-1, :-1],
        rng.integers(0, 3, (21, 18)),
        np.roll(np.kron(rng.integers(0, 2, (4, 4)), np.ones((5, 5), int)), (2, 3), (0, 1)),
    ):
        mesh = mesh_image(labels, labels=True, background=background, periodic="xy", edge_length=5)
        h, w = labels.shape
        assert mesh.frame.bounds == (0, 0, w, h)
        assert mesh.report.kept
        v, pairs = mesh.vertices, mesh.periodic_pairs
        for name, axis, size in (("x", 0, w), ("y", 1, h)):
            one, other = pairs[name].T
            assert (v[one, axis] == 0).all()
            assert (v[other, axis] == size).all()
            assert (v[one, 1 - axis] == v[other, 1 - axis]).all()
            if background is None:
                assert len(one) == (v[:, axis] == 0).sum() == (v[:, axis] == size).sum(), "no vertex without its twin"
            # Where the pixels on both sides are meshed, all along the seam, both have the same vertices.
            first, last = (labels[::-1, [0, -1]].T if axis == 0 else labels[[-1, 0]]) != (-1 if background is None else background)
            for at in np.flatnonzero(first & last):
                on = [
                    np.sort(v[(v[:, axis] == wall) & (v[:, 1 - axis] >= at) & (v[:, 1 - axis] <= at + 1), 1 - axis]) for wall in (0, size)
                ]
                assert np.array_equal(*on)
        if background is None:
            oracles.check_valid(*glued(mesh, shift="x"))
            oracles.check_valid(*glued(mesh, shift="y"))
        for label in set(np.unique(labels)) - {background}:
            assert mesh.report.areas[label]["mesh"] == pytest.approx((labels == label).sum(), rel=0.02)


def test_it_makes_no_difference_where_the_seam_is():
    """Rolled images give cells of the same fractions, with the seam through regions, along an interface, and in the void."""
    whole = torus_disc(48, (24, 24), 15).astype(int) + 1
    for roll in ((0, 0), (24, 0), (13, 24), (9, 9), (20, 31)):
        labels = np.roll(whole, roll, (0, 1))
        mesh = mesh_image(labels, labels=True, background=None, periodic="xy", edge_length=5)
        assert mesh.report.areas[2]["mesh"] == pytest.approx((whole == 2).sum(), rel=1e-3)
        assert mesh.report.areas[1]["mesh"] == pytest.approx((whole == 1).sum(), rel=1e-3)


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
