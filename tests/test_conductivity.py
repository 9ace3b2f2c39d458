"""The exact values of the example of effective conductivity, computed again on the curves it draws, without an image."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.spatial import KDTree

from img2tri.triangles.generate.filling import fill

PATH = Path(__file__).parent.parent / "examples" / "08_effective_conductivity.py"


@pytest.fixture(scope="module")
def example():
    pytest.importorskip("skfem")
    spec = importlib.util.spec_from_file_location(PATH.stem, PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def rings(example, seed, spacing):
    """The curves of the inclusion, cut into chords, and the frame: rings with the region within and the one around."""
    for centre, radius, within, around in (
        ((example.SIZE / 2,) * 2, lambda angle: example.radius(angle, seed), 2, 1),
        *((centre, lambda angle: np.full(len(angle), example.HOLE_RADIUS), 1, 2) for centre in example.hole_centres()),
    ):
        angle = np.arange(0, 2 * np.pi, spacing / radius(np.zeros(1))[0])
        yield centre + radius(angle)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1), within, around
    yield np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)]) * example.SIZE, 1, 0


def cells(example, seed):
    """Cells of the grains: their rings with their labels."""
    centres, box = example.grain_centres(seed), shapely.box(0, 0, example.SIZE, example.SIZE)
    for cell in shapely.get_parts(shapely.voronoi_polygons(shapely.MultiPoint(centres), extend_to=box)):
        part = shapely.normalize(cell & box).reverse()  # counter-clockwise
        label = KDTree(centres).query(shapely.get_coordinates(part.centroid)[0])[1] + 1
        yield shapely.get_coordinates(part)[:-1], label, 0


def network(parts):
    """Points, segments and the regions on both sides of them; what two rings share becomes one."""
    parts = list(parts)
    corners = np.concatenate([ring for ring, *_ in parts])
    _, first, number = np.unique(corners.round(6), axis=0, return_index=True, return_inverse=True)
    sides, start = {}, 0
    for ring, within, around in parts:
        own = number.ravel()[start : start + len(ring)]
        start += len(ring)
        for a, b in zip(own.tolist(), np.roll(own, -1).tolist(), strict=True):
            if (b, a) in sides:
                sides[b, a] = (sides[b, a][0], within)
            else:
                sides[a, b] = (within, around)
    return corners[first], np.array(list(sides)), *np.array(list(sides.values())).T


def value(example, parts, edge_length, levels):
    """Effective conductivity of the geometry itself, the mesh made finer `levels` times around all points of its network."""
    from skfem import MeshTri

    points, segments, left, right = network(parts)
    vertices, triangles, regions = fill(points, segments, left, right, edge_length=edge_length)
    size = example.SIZE
    fem = MeshTri(vertices.T.copy(), triangles.T.copy()).with_subdomains({str(r): np.flatnonzero(regions == r) for r in set(regions)})
    for _ in range(levels):
        at = KDTree(fem.p.T).query(points)[1]
        fem = fem.refined(np.flatnonzero(np.isin(fem.t, at).any(axis=0)))
    local = np.zeros(fem.nelements)
    for name, own in fem.subdomains.items():
        local[own] = example.conductivity(np.array([int(name)]))
    assert local.all()
    fem = fem.with_boundaries({"left": lambda x: x[0] < 1e-9, "right": lambda x: x[0] > size - 1e-9})
    return example.effective(fem, local, 2)


@pytest.mark.slow
def test_inclusion(example):
    """Chords of half the length are four times as near to the curve."""
    for seed, exact in enumerate(example.EXACT["inclusion"]):
        coarse, fine = (value(example, rings(example, seed, spacing), 3, 0) for spacing in (2, 1))
        assert fine + (fine - coarse) / 3 == pytest.approx(exact, rel=1e-5)


@pytest.mark.slow
def test_polycrystal(example):
    """Cells have straight sides: no error but in the corners, where the mesh is graded."""
    for seed, exact in enumerate(example.EXACT["polycrystal"]):
        assert value(example, cells(example, seed), 2, 10) == pytest.approx(exact, rel=1e-5)


def test_the_image_shows_the_curves(example):
    """Labels by formula and by the polygons of the reference agree, wherever they can."""
    places = np.random.default_rng(0).uniform(0, example.SIZE, (2000, 2))
    for draw, parts in ((example.inclusion, rings(example, 1, 0.5)), (example.polycrystal, cells(example, 1))):
        labels, expected = draw(places, 1), np.zeros(len(places), int)
        # The rings of the inclusion lie in each other, the frame around all: smallest last.
        for ring, within, _ in sorted(parts, key=lambda part: -shapely.Polygon(part[0]).area):
            expected[shapely.contains_xy(shapely.Polygon(ring), *places.T)] = within
        assert (labels != expected).mean() < 1e-3
