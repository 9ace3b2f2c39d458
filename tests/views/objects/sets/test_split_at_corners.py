"""Pieces of sets: several inlets on one side, the bore and the rim of a ring, the sides of a square."""

from __future__ import annotations

import numpy as np
import pytest
from views.plates import cells

from img2tri import mesh_image
from img2tri.views.objects.sets.named_sets import named_sets
from img2tri.views.objects.sets.numbers_in_files import file_numbers, set_tags


def pieces(sets, whole):
    return [name for name, of in sets.part_of.items() if of == whole]


def test_two_inlets_on_the_left_are_two_sets_from_below_beside_the_whole():
    mask = np.zeros((9, 12), bool)
    mask[1:3, :8] = mask[6:8, :8] = mask[1:8, 6:8] = mask[4, 6:] = True
    vertices, triangles = cells(mask)
    sets = named_sets(vertices, triangles, np.ones(len(triangles), int), bounds=(0, 0, 12, 9))
    assert pieces(sets, "left") == ["left_1", "left_2"]
    assert [sorted(set(vertices[sets.edges[name]][..., 1].ravel())) for name in ("left_1", "left_2")] == [[1, 2, 3], [6, 7, 8]]
    assert len(sets.edges["left"]) == 4
    assert pieces(sets, "right") == []  # it is one piece
    assert len({*sets.tags.values()}) == len(sets.tags)


def test_the_bore_and_the_rim_of_a_quarter_ring_are_two_sets():
    y, x = np.mgrid[:80, :80] + 0.5
    r = np.hypot(x, 80 - y)
    mesh = mesh_image((r > 30) & (r < 70), edge_length=6)
    sets = mesh.sets()
    assert pieces(sets, "outer") == ["outer_1", "outer_2"]
    radii = [np.hypot(*mesh.vertices[sets.edges[name]].reshape(-1, 2).T) for name in ("outer_1", "outer_2")]
    assert radii[0] == pytest.approx(30, abs=0.5) or radii[0] == pytest.approx(70, abs=0.5)
    assert abs(radii[0].mean() - radii[1].mean()) == pytest.approx(40, abs=0.5)


def test_a_square_has_four_sides_counter_clockwise_from_the_lowest_left():
    vertices, triangles = cells(np.ones((3, 3), bool))
    sets = named_sets(vertices, triangles, np.ones(len(triangles), int))
    middles = [vertices[sets.edges[f"outer_{i}"]].mean(axis=(0, 1)).tolist() for i in (1, 2, 3, 4)]
    assert middles == [[1.5, 0], [3, 1.5], [1.5, 3], [0, 1.5]]
    assert pieces(sets, "outer") == ["outer_1", "outer_2", "outer_3", "outer_4"]


def test_a_disc_is_one_piece_and_steps_of_pixels_are_not_cut():
    y, x = np.mgrid[:60, :60] + 0.5
    assert pieces(mesh_image(np.hypot(x - 30, y - 30) < 20, edge_length=4).sets(), "outer") == []
    vertices, triangles = cells(np.hypot(x - 30, y - 30) < 28)
    assert pieces(named_sets(vertices, triangles, np.ones(len(triangles), int)), "outer") == []


def test_pieces_make_up_the_whole():
    rng = np.random.default_rng(3)
    for _ in range(20):
        vertices, triangles = cells(rng.random((6, 7)) < 0.6)
        sets = named_sets(vertices, triangles, np.ones(len(triangles), int), bounds=(0, 0, 7, 6))
        for whole in set(sets.part_of.values()):
            parts = np.concatenate([sets.edges[name] for name in pieces(sets, whole)])
            assert sorted(map(tuple, parts.tolist())) == sorted(map(tuple, sets.edges[whole].tolist()))


@pytest.mark.parametrize("labels", [[1, 2], [-1, 0, 5], [1005], [2**31 - 1], [720575940610453042, 720575940610453043], [999, 1001, 10_005]])
def test_no_number_is_there_twice_and_all_fit_32_bits(labels):
    numbers = file_numbers(labels)
    tags = set_tags(["left", "right", "bottom", "top", "outer", "hole_1", "a__b", "left_1", "z_min", "z_max"], numbers.values())
    every = [*numbers.values(), *tags.values()]
    assert len(set(every)) == len(every)
    assert min(every) >= 1
    assert max(every) < 2**31
    assert all(numbers[label] == label for label in labels if 1 <= label <= 2_000_000_000)
