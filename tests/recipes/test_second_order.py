"""Quadratic triangles: where their nodes lie, that no element folds, and what curved sides are good for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import oracles
import pytest
import shapely
import specimens
from benchmarks.shapes import blob

import img2tri.recipes.second_order as recipe
from img2tri import mesh_image
from img2tri.recipes.second_order import second_order

CENTRE, RADIUS = (60.2, 59.7), 50.0


def curved(mesh):
    return second_order(mesh.vertices, mesh.triangles, mesh.regions, mesh.frame, mesh.origin)


def gray_disc(n=120, fine=8):
    y, x = (np.mgrid[: n * fine, : n * fine] + 0.5) / fine
    inside = np.hypot(x - CENTRE[0], n - y - CENTRE[1]) < RADIUS
    return np.round(255 * inside.reshape(n, fine, n, fine).mean(axis=(1, 3))).astype(np.uint8)


MASK, GRAY = specimens.disc(120, RADIUS, (60.3, 60.2)), gray_disc()


def jacobians(made, steps=12):
    """Determinants (m, k) at many places of each element, from the shape functions."""
    s, t = (x.ravel() for x in np.meshgrid(*2 * [np.linspace(0, 1, steps)]))
    s, t = s[s + t <= 1 + 1e-12], t[s + t <= 1 + 1e-12]
    r, zero = 1 - s - t, np.zeros_like(s)
    by_s = np.stack([1 - 4 * r, 4 * s - 1, zero, 4 * (r - s), 4 * t, -4 * t])
    by_t = np.stack([1 - 4 * r, zero, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t)])
    x, y = made.nodes[made.triangles].transpose(2, 0, 1)
    return (x @ by_s) * (y @ by_t) - (x @ by_t) * (y @ by_s)


def area(made):
    """By Green's theorem: that of the straight triangles, and 2 / 3 of width times height under each parabola."""
    p = made.nodes[made.triangles]
    total = oracles.areas(made.nodes, made.triangles[:, :3]).sum()
    for k in range(3):
        a, b, m = p[:, k], p[:, (k + 1) % 3], p[:, 3 + k]
        chord, rise = b - a, m - (a + b) / 2
        total += 2 / 3 * (rise[:, 0] * chord[:, 1] - rise[:, 1] * chord[:, 0]).sum()
    return total


def drawn(made, steps=9):
    """The elements as polygons with many corners."""
    t = np.linspace(0, 1, steps)[:-1, None, None]
    p = made.nodes[made.triangles]
    sides = []
    for k in range(3):
        a, b, m = p[:, k], p[:, (k + 1) % 3], p[:, 3 + k]
        sides.append((1 - t) * (1 - 2 * t) * a + t * (2 * t - 1) * b + 4 * t * (1 - t) * m)
    return shapely.polygons(np.concatenate(sides).transpose(1, 0, 2))


def boundary_nodes(mesh, made):
    edges, count = oracles.edge_counts(mesh.triangles)
    on = np.flatnonzero(count == 1)
    return made.nodes[np.concatenate([np.unique(edges[on]), len(mesh.vertices) + on])]


def test_nodes_are_the_vertices_then_one_for_each_edge_in_order():
    mesh = mesh_image(specimens.polycrystal(), labels=True, background=None, edge_length=6)
    made = curved(mesh)
    edges, _ = oracles.edge_counts(mesh.triangles)
    assert made.nodes.shape == (len(mesh.vertices) + len(edges), 2)
    assert (made.triangles[:, :3] == mesh.triangles).all()
    assert (made.regions == mesh.regions).all()
    for k in range(3):
        ends = np.sort(mesh.triangles[:, [k, (k + 1) % 3]], axis=1)
        assert (edges[made.triangles[:, 3 + k] - len(mesh.vertices)] == ends).all()


def test_sides_inside_and_on_the_frame_are_straight_with_their_node_in_the_middle():
    labels = specimens.polycrystal()
    mesh = mesh_image(labels, labels=True, background=None, edge_length=6)
    made, n = curved(mesh), len(mesh.vertices)
    edges, count = oracles.edge_counts(mesh.triangles)
    interfaces = set(map(tuple, np.sort(oracles.interfaces(mesh.triangles, mesh.regions)).tolist()))
    straight = np.array([tuple(e) not in interfaces for e in edges.tolist()])
    assert (made.nodes[n:][straight] == made.nodes[edges[straight]].mean(axis=1)).all()
    assert (made.nodes[n:][~straight] != made.nodes[edges[~straight]].mean(axis=1)).any()
    frame = np.unique(edges[count == 1])
    assert (made.nodes[frame] == mesh.vertices[frame]).all()


@pytest.mark.parametrize("keep_area", [True, False])
@pytest.mark.parametrize(("image", "off", "area_error"), [(MASK, 0.25, 1e-3), (GRAY, 0.2, 2e-4)])
def test_curved_sides_lie_on_the_circle_and_keep_its_area(image, off, area_error, keep_area):
    for edge_length in (4, 10, 20):
        mesh = mesh_image(image, threshold=image.max() / 2, edge_length=edge_length, keep_area=keep_area)
        made = curved(mesh)
        far = np.hypot(*(boundary_nodes(mesh, made) - CENTRE).T) - RADIUS
        assert np.abs(far).max() < off
        assert abs(area(made) / (np.pi * RADIUS**2) - 1) < area_error


@pytest.mark.parametrize("name", specimens.ALL)
def test_no_element_folds_and_none_overlap(name):
    for edge_length in (3, 8):
        mesh = mesh_image(specimens.ALL[name], labels=True, edge_length=edge_length)
        made = curved(mesh)
        assert (jacobians(made) > 0).all()
        polygons = drawn(made)
        assert shapely.is_valid(polygons).all()
        union = shapely.area(shapely.union_all(polygons, grid_size=1e-9))
        assert union == pytest.approx(shapely.area(polygons).sum(), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_noise_does_not_fold_elements(seed):
    """The Jacobian is at least a tenth of that of the straight triangle everywhere."""
    mesh = mesh_image(np.random.default_rng(seed).integers(0, 3, (24, 24)), labels=True, edge_length=8)
    least = jacobians(curved(mesh)).min(axis=1)
    assert (least >= 0.1 * 2 * oracles.areas(mesh.vertices, mesh.triangles)).all()


def test_a_side_that_would_fold_its_element_is_pulled_back():
    mesh = mesh_image(1 - specimens.disc(60, 20.0), edge_length=12)
    edges, count = oracles.edge_counts(mesh.triangles)
    on_hole = (count == 1) & (np.abs(np.hypot(*(mesh.vertices[edges] - 30).transpose(2, 0, 1)) - 20) < 2).all(axis=1)
    edge = np.flatnonzero(on_hole)[0]
    ends = edges[edge]
    triangle = next(t for t in mesh.triangles if set(ends) <= set(t))
    apex = next(iter(set(triangle) - set(ends)))
    before = curved(mesh).nodes[len(mesh.vertices) + edge]
    vertices, middle = mesh.vertices.copy(), mesh.vertices[ends].mean(axis=0)
    vertices[apex] = middle + 0.5 * (before - middle)  # where the curved side would pass over it
    squeezed = replace(mesh, vertices=vertices)
    assert (oracles.areas(vertices, mesh.triangles) > 0).sum() >= len(mesh.triangles) - 3
    upright = oracles.areas(vertices, mesh.triangles) > 0
    squeezed = replace(squeezed, triangles=mesh.triangles[upright], regions=mesh.regions[upright])
    made = curved(squeezed)
    assert (jacobians(made) > 0).all()


def bends(image, edge_length):
    """How far all sides are bent, in total."""
    mesh = mesh_image(image, edge_length=edge_length)
    made = second_order(mesh.vertices, mesh.triangles, mesh.regions, mesh.frame, mesh.origin)
    corners, nodes = made.nodes[made.triangles[:, :3]], made.nodes[made.triangles[:, 3:]]
    return np.abs(nodes - (corners + np.roll(corners, -1, axis=1)) / 2).sum()


@pytest.mark.parametrize(
    ("constant", "image", "edge_length"),
    [
        ("SEARCH", blob(128, seed=4, holes=2).astype(np.uint8), 12),
        ("HALVINGS", np.random.default_rng(0).integers(0, 2, (24, 27)) > 0, 5),
    ],
)
def test_without_it_fewer_sides_bend(constant, image, edge_length, monkeypatch):
    with_it = bends(image, edge_length)
    monkeypatch.setattr(recipe, constant, 0)
    assert bends(image, edge_length) < 0.97 * with_it


def test_without_outlines_all_sides_are_straight():
    mesh = mesh_image(specimens.disc() * 255, recipe="structured", edge_length=6)
    for origin in (None, mesh.origin):
        made = second_order(mesh.vertices, mesh.triangles, mesh.regions, mesh.frame, origin)
        edges, _ = oracles.edge_counts(mesh.triangles)
        assert (made.nodes == np.concatenate([mesh.vertices, mesh.vertices[edges].mean(axis=1)])).all()


def test_spacing_and_origin_only_scale_and_shift():
    one = curved(mesh_image(specimens.disc(), edge_length=6))
    other = curved(mesh_image(specimens.disc(), edge_length=1.5, spacing=0.25, origin=(7, -3)))
    assert np.allclose(other.nodes, one.nodes * 0.25 + (7, -3), atol=1e-9)


@pytest.mark.parametrize(("image", "most", "kink"), [(MASK, 1.5e-3, 0.05), (GRAY, 1e-3, 0.03)])
def test_poisson_on_a_disc(image, most, kink):
    """Energy and greatest error of the gradient, each against the exact solution; straight sides are much worse in the first."""
    fem = pytest.importorskip("skfem")
    poisson = pytest.importorskip("skfem.models.poisson")

    def solved(nodes, elements):
        basis = fem.Basis(fem.MeshTri2(nodes.T.copy(), elements.T.copy(), sort_t=False), fem.ElementTriP2(), intorder=6)
        load = poisson.unit_load.assemble(basis)
        u = fem.solve(*fem.condense(poisson.laplace.assemble(basis), load, D=basis.get_dofs()))
        exact = -(np.asarray(basis.global_coordinates()) - np.reshape(CENTRE, (2, 1, 1))) / 2
        error = np.hypot(*(np.asarray(basis.interpolate(u).grad) - exact))
        return abs(u @ load / (np.pi * RADIUS**4 / 8) - 1), error.max() / (RADIUS / 2)

    for edge_length in (4, 16):
        mesh = mesh_image(image, threshold=image.max() / 2, edge_length=edge_length, keep_area=False)
        made = curved(mesh)
        energy, worst = solved(made.nodes, made.triangles)
        straight = second_order(mesh.vertices, mesh.triangles, mesh.regions, mesh.frame)
        assert energy < most
        assert worst < kink
        if edge_length == 16:
            assert solved(straight.nodes, straight.triangles)[0] > 10 * energy


def test_what_a_prompt_shows_is_one_line():
    mesh = mesh_image(specimens.disc(30, 10), edge_length=5)
    made = mesh.second_order()
    shown = f"SecondOrder: {len(mesh.triangles)} quadratic triangles, {len(made.nodes)} nodes, 1 region, "
    assert repr(made).startswith(shown)
