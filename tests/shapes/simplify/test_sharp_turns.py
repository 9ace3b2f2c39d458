"""Corners that gray pixels blur cost no more triangles than those of a mask."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from tuning import change

from img2tri import mesh_image
from img2tri.arrays import ChainIndex
from img2tri.shapes.simplify.sharp_turns import TURN_SIDE, TURNS_APART, sharp_turns
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


@pytest.mark.parametrize("blur", [0.0, 0.5])
def test_corners_of_drawings_cost_what_those_of_masks_do(blur):
    assert triangles(blur) < 1.15 * triangles()


def outlines(points, ring=False):
    n = len(points)
    index = np.append(np.arange(n), 0) if ring else np.arange(n)
    return Outlines(points, ChainIndex(index, np.array([0, len(index)]), np.array([ring])), np.array([1]), np.array([0]), np.array([0, 1]))


def bent(angle, length=12):
    away = np.arange(length + 1.0)
    ahead = np.stack([np.cos(angle) * away[1:], np.sin(angle) * away[1:]], axis=1)
    return np.concatenate([np.stack([away - length, 0 * away], axis=1), ahead])


@pytest.mark.parametrize("angle", np.radians([70, 90, 120]))
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_tip_of_a_turn_is_found(angle, sign):
    assert np.flatnonzero(sharp_turns(outlines(bent(sign * angle)))).tolist() == [12]


@pytest.mark.parametrize("angle", np.radians([0, 30, 65]))
def test_a_slight_turn_is_none(angle):
    assert not sharp_turns(outlines(bent(angle))).any()


def test_a_circle_has_none_and_a_square_ring_its_corners_wherever_it_begins():
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    assert not sharp_turns(outlines(np.stack([9 * np.cos(t), 9 * np.sin(t)], axis=1), ring=True)).any()
    side = np.stack([np.arange(20.0), np.zeros(20)], axis=1)
    square = np.concatenate([side, [20, 0] + side[:, ::-1], [20, 20] - side, [0, 20] - side[:, ::-1]])
    for begin in range(TURNS_APART, 20 - TURNS_APART):
        found = np.flatnonzero(sharp_turns(outlines(np.roll(square, -begin, axis=0), ring=True)))
        assert (found + begin).tolist() == [20, 40, 60, 80]


def test_turns_near_each_other_or_near_the_end_are_none():
    zigzag = np.concatenate([bent(1.5, 6), [bent(1.5, 6)[-1] + [k + 1.0, 0] for k in range(12)]])
    assert not sharp_turns(outlines(zigzag)).any()
    assert not sharp_turns(outlines(bent(1.5)[12 - TURN_SIDE :])).any()


@pytest.mark.parametrize(
    ("name", "factor"), [("TURN_SIDE", 0.5), ("SHARP_ANGLE", 2), ("STRAIGHT_SIDE", 1.016), ("TURNS_APART", 4), ("MIXED_CROSSINGS", 0)]
)
def test_constants_matter(name, factor, monkeypatch):
    before = triangles(0.0) + triangles(0.5)
    change(monkeypatch, name, factor)
    assert triangles(0.0) + triangles(0.5) > 1.05 * before
