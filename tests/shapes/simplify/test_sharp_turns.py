"""Corners that gray pixels blur cost no more triangles than those of a mask."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from tuning import change

from img2tri import mesh_image
from img2tri.arrays import ChainIndex
from img2tri.shapes.simplify.sharp_turns import TIP_OFFSET, TURN_SIDE, TURNS_APART, sharp_turns
from img2tri.types import Outlines


def gear(teeth, turned, n=140, fine=8):
    """Shares of pixels, in eighths of their sides, as drawing programs do it."""
    y, x = (np.mgrid[: n * fine, : n * fine] + 0.5) / fine - n / 2
    radius = np.where(np.cos(teeth * (np.arctan2(y, x) + turned)) > 0, 0.42, 0.3) * n
    return (np.hypot(x, y) < radius).reshape(n, fine, n, fine).mean(axis=(1, 3))


GEARS = [gear(teeth, turned) for teeth, turned in ((8, 0.1), (11, 0.5), (6, 0.83))]


def triangles(blur=None):
    def drawn(share):
        return share > 0.5 if blur is None else np.round(255 * (gaussian_filter(share, blur) if blur else share)).astype(np.uint8)

    return sum(len(mesh_image(drawn(share), edge_length=8).triangles) for share in GEARS)


@pytest.mark.parametrize(("blur", "more"), [(0.0, 1.15), (0.5, 1.15), (1.0, 1.4), (1.5, 2.1)])
def test_corners_of_drawings_cost_what_those_of_masks_do(blur, more):
    assert triangles(blur) < more * triangles()


def outlines(points, ring=False):
    n = len(points)
    index = np.append(np.arange(n), 0) if ring else np.arange(n)
    return Outlines(points, ChainIndex(index, np.array([0, len(index)]), np.array([ring])), np.array([1]), np.array([0]), np.array([0, 1]))


def tips(dense):
    return sharp_turns(dense, tolerance=0.5)[0]


def bent(angle, length=12):
    away = np.arange(length + 1.0)
    ahead = np.stack([np.cos(angle) * away[1:], np.sin(angle) * away[1:]], axis=1)
    return np.concatenate([np.stack([away - length, 0 * away], axis=1), ahead])


@pytest.mark.parametrize("angle", np.radians([70, 90, 120]))
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_tip_of_a_turn_is_found(angle, sign):
    assert np.flatnonzero(tips(outlines(bent(sign * angle)))).tolist() == [12]


@pytest.mark.parametrize("cut", [0.0, 1.0, 2.0])
def test_the_tip_of_a_cut_corner_goes_towards_where_its_sides_meet(cut):
    away = cut + np.arange(12.0)
    line = np.concatenate([np.stack([-away[::-1], 0 * away], axis=1), np.stack([0 * away, away], axis=1)[cut == 0 :]])
    found, ways = sharp_turns(outlines(line), tolerance=2.0)
    assert TIP_OFFSET > 0
    (at,) = np.flatnonzero(found)
    meets = -(line[at] @ [1, 1j])
    assert ways[at] == pytest.approx(meets * min(1, 2 * TIP_OFFSET / max(abs(meets), 1e-9)), abs=1e-9)
    assert (np.delete(ways, at) == 0).all()


@pytest.mark.parametrize("angle", np.radians([0, 30, 65]))
def test_a_slight_turn_is_none(angle):
    assert not tips(outlines(bent(angle))).any()


def test_a_circle_has_none_and_a_square_ring_its_corners_wherever_it_begins():
    for radius in (2.5, 3.0, 4.0, 5.0, 7.0, 9.0, 14.0):
        t = np.linspace(0, 2 * np.pi, round(7 * radius), endpoint=False)
        assert not tips(outlines(radius * np.stack([np.cos(t), np.sin(t)], axis=1), ring=True)).any()
    side = np.stack([np.arange(20.0), np.zeros(20)], axis=1)
    square = np.concatenate([side, [20, 0] + side[:, ::-1], [20, 20] - side, [0, 20] - side[:, ::-1]])
    for begin in range(TURNS_APART, 20 - TURNS_APART):
        found = np.flatnonzero(tips(outlines(np.roll(square, -begin, axis=0), ring=True)))
        assert (found + begin).tolist() == [20, 40, 60, 80]


def test_the_round_end_of_a_slot_is_none(monkeypatch):
    """Its sides do not meet nearby: `MOST_BLUNT`."""
    t, away = np.linspace(0, np.pi, 9), np.arange(1.0, 12.0)
    side = np.stack([0 * away + 2.2, -away], axis=1)
    slot = np.concatenate([side[::-1], 2.2 * np.stack([np.cos(t), np.sin(t)], axis=1), side * [-1.0, 1]])
    slot[-11:, 0] += 0.02 * away  # no quite parallel sides
    assert not tips(outlines(slot)).any()
    change(monkeypatch, "MOST_BLUNT", 1000)
    assert tips(outlines(slot)).any()


def test_turns_near_each_other_or_near_the_end_are_none():
    zigzag = np.concatenate([bent(1.5, 6), [bent(1.5, 6)[-1] + [k + 1.0, 0] for k in range(12)]])
    assert not tips(outlines(zigzag)).any()
    assert not tips(outlines(bent(1.5)[12 - TURN_SIDE :])).any()


@pytest.mark.parametrize(
    ("name", "factor", "blurs"),
    [
        ("TURN_SIDE", 0.5, (0.0, 0.5)),
        ("SHARP_ANGLE", 2, (0.0, 0.5)),
        ("STRAIGHT_SIDE", 1.016, (0.0, 0.5)),
        ("TURNS_APART", 4, (0.0, 0.5)),
        ("MIXED_CROSSINGS", 0, (0.0, 0.5)),
        ("TIP", 0, (0.5, 1.0)),
    ],
)
def test_constants_matter(name, factor, blurs, monkeypatch):
    before = sum(map(triangles, blurs))
    change(monkeypatch, name, factor)
    assert sum(map(triangles, blurs)) > 1.05 * before
