"""Vertices of 4 triangles go, those of 8 are split in two, where it costs least; looked at one by one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from img2tri.triangles.generate.valence_repair import excess, flip_valences, repair_valences

CENTRE = 30 - 20j


def wheel(count, radius=1.0):
    """A vertex with `count` triangles around it, 0, and its neighbours counter-clockwise; shuffled, so that no order is relied upon."""
    rim = CENTRE + radius * np.exp(2j * np.pi * np.arange(count) / count)
    triangles = np.stack([np.zeros(count, int), 1 + np.arange(count), 1 + (1 + np.arange(count)) % count], axis=1)
    triangles = np.array([np.roll(t, k % 3) for k, t in enumerate(triangles)])
    return np.concatenate([[CENTRE], rim]), np.random.default_rng(count).permutation(triangles)


def free_hub(vertices):
    return np.arange(len(vertices)) == 0


@pytest.mark.parametrize("count", range(3, 10))
def test_the_excess_is_counted_against_the_angle(count):
    vertices, triangles = wheel(count)
    extra = excess(vertices, triangles)
    assert extra[0] == pytest.approx(count - 6)
    # Two triangles for an angle of 180 - 360 / count degrees.
    assert extra[1:] == pytest.approx(2 - (180 - 360 / count) / 60)


@pytest.mark.parametrize(
    ("count", "added", "stays"),
    [(3, 0, False), (4, 0, False), (5, 0, True), (6, 0, True), (7, 0, True), (8, 2, False)],
)
def test_too_few_go_too_many_are_split(count, added, stays):
    vertices, triangles = wheel(count)
    points, kept = repair_valences(vertices, triangles, free_hub(vertices))
    assert len(points) == added
    assert kept.tolist() == [stays] + count * [True]
    nothing, all_kept = repair_valences(vertices, triangles, np.zeros(len(vertices), bool))
    assert len(nothing) == 0
    assert all_kept.all()


@pytest.mark.parametrize("cheapest", range(4))
@pytest.mark.parametrize("count", [8, 9, 10])
def test_the_split_is_across_the_pair_that_bears_it_best(count, cheapest):
    vertices, triangles = wheel(count)
    half = count // 2
    # More triangles outside at all neighbours but one pair: a fan around each that fills the outside.
    pair = {1 + cheapest, 1 + (cheapest + half) % count}
    outside, new = [], [vertices]
    for k in range(1, count + 1):
        if k in pair:
            continue
        first = len(np.concatenate(new))
        around = vertices[k] + 0.3 * (vertices[k] - CENTRE) * np.exp(1j * np.linspace(-0.9, 0.9, 6))
        new.append(around)
        outside += [[k, first + i, first + i + 1] for i in range(5)]
    all_vertices, all_triangles = np.concatenate(new), np.concatenate([triangles, outside])
    assert {1 + int(i) for i in np.argsort(excess(all_vertices, all_triangles)[1 : count + 1])[:2]} == pair
    points, _ = repair_valences(all_vertices, all_triangles, free_hub(all_vertices))
    # Halves of the ring, both with the two of the pair.
    places = [(cheapest + np.arange(half + 1)) % count, (cheapest + half + np.arange(count - half + 1)) % count]
    expected = [(vertices[1 + at].mean() + CENTRE) / 2 for at in places]
    found = sorted(points, key=lambda z: abs(z - expected[0]))
    assert found == pytest.approx(expected)


def test_of_rings_that_share_a_vertex_only_the_first_is_changed():
    vertices, triangles = wheel(8)
    shifted = np.where(triangles == 1, 1, np.where(triangles == 0, 9, triangles + 8))
    # A second wheel, mirrored about the first neighbour of the first.
    second = 2 * vertices[1] - vertices
    both = np.concatenate([vertices, [second[0]], second[2:]])
    hubs = np.isin(np.arange(len(both)), (0, 9))
    points, stays = repair_valences(both, np.concatenate([triangles, shifted]), hubs)
    assert not stays[0]
    assert stays[9]
    assert len(points) == 2
    assert abs(points - CENTRE).max() < 0.5


def test_free_vertices_without_triangles_go():
    vertices, triangles = wheel(6)
    lonely = np.concatenate([vertices, [CENTRE + 5, CENTRE - 5]])
    free = np.isin(np.arange(len(lonely)), (0, 7))
    _, stays = repair_valences(lonely, triangles, free)
    assert stays.tolist() == 7 * [True] + [False, True]


def lattice(n=8):
    """Equilateral triangles: nodes (n * n,), triangles, and which nodes are inside."""
    row, column = np.divmod(np.arange(n * n), n)
    at = np.flatnonzero((row < n - 1) & (column < n - 1))
    triangles = np.concatenate([np.stack([at, at + 1, at + n], axis=1), np.stack([at + 1, at + n + 1, at + n], axis=1)])
    return column + row * (0.5 + 0.75**0.5 * 1j), triangles, (np.minimum(row, column) > 0) & (np.maximum(row, column) < n - 1)


def test_valences_of_5_and_7_side_by_side_become_6():
    vertices, good, inside = lattice()
    a, b, c, d = 27, 28, 35, 36  # b and c share an edge; the flip to a and d makes valences of 5, 7, 5, 7
    spoilt = good[~np.isin(good, [a, b, c, d]).all(axis=1)]
    spoilt = np.concatenate([spoilt, [[a, b, d], [a, d, c]]])
    assert np.bincount(spoilt.ravel())[[a, b, c, d]].tolist() == [7, 5, 5, 7]
    mended, flipped = flip_valences(vertices, spoilt, inside)
    assert flipped
    assert (np.bincount(mended.ravel())[inside] == 6).all()
    assert {tuple(sorted(t)) for t in mended.tolist()} == {tuple(sorted(t)) for t in good.tolist()}
    assert ((vertices[mended[:, 1]] - vertices[mended[:, 0]]).conj() * (vertices[mended[:, 2]] - vertices[mended[:, 0]])).imag.min() > 0
    # Not at vertices that stay where they are.
    for fixed in (a, b, c, d):
        kept, flipped = flip_valences(vertices, spoilt, inside & (np.arange(len(vertices)) != fixed))
        assert not flipped
        assert np.array_equal(kept, spoilt)


def test_even_valences_and_flat_triangles_are_left():
    vertices, good, inside = lattice()
    assert not flip_valences(vertices, good, inside)[1]
    a, b, c, d = 27, 28, 35, 36
    spoilt = np.concatenate([good[~np.isin(good, [a, b, c, d]).all(axis=1)], [[a, b, d], [a, d, c]]])
    moved = vertices.copy()
    moved[a] += 0.9 * ((moved[b] + moved[c]) / 2 - moved[a])  # all but on the edge that would come
    assert not flip_valences(moved, spoilt, inside)[1]


def test_what_is_done_does_not_depend_on_numbers():
    rng = np.random.default_rng(0)
    z = rng.random(4000) + 1j * rng.random(4000)
    triangles = Delaunay(np.stack([z.real, z.imag], axis=1)).simplices.astype(np.int64)
    free = np.minimum(np.minimum(z.real, z.imag), np.minimum(1 - z.real, 1 - z.imag)) > 0.1
    order = rng.permutation(len(z))
    number = np.argsort(order)
    points, stays = repair_valences(z, triangles, free)
    again, still = repair_valences(z[order], number[triangles][rng.permutation(len(triangles))], free[order])
    assert len(points) > 1
    assert not stays.all()
    assert np.allclose(np.sort_complex(points), np.sort_complex(again))
    assert (stays[order] == still).all()

    def flipped(z, triangles, free):
        found, any_ = flip_valences(z, triangles, free)
        assert any_
        return np.sort_complex(z[found].mean(axis=1))

    shuffled = number[triangles][rng.permutation(len(triangles))]
    assert np.allclose(flipped(z, triangles, free), flipped(z[order], shuffled, free[order]))
