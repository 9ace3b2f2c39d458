"""The regions of a gap are told by its walls, which must agree wherever triangles may be taken."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.tiles.seams.gap_triangulation import Gap, GapWalls, gap_filled
from img2tri.tiles.seams.piece_seams import SeamError

# A strip of region 1, closed at x = 0 and open at x = 6; beyond, a wall with region 2 on its right is left of those that are too far away.
#   7---6---5---4
#   |           . 8-9
#   0---1---2---3
Z = np.array([0, 2, 4, 6, 6 + 2j, 4 + 2j, 2 + 2j, 2j, 7 + 1j, 7.5 + 1j])
SEGMENTS = np.array([[0, 1], [1, 2], [2, 3], [4, 5], [5, 6], [6, 7], [7, 0], [8, 9]])
LEFT = np.array([1, 1, 1, 1, 1, 1, 1, 1])
RIGHT = np.array([0, 0, 0, 0, 0, 0, 0, 2])


def filled(met, left=LEFT):
    walls = GapWalls(SEGMENTS, left, RIGHT)
    return gap_filled(Gap(Z, walls, np.zeros(0, np.int64), lambda places: places.real < 7, lambda places: places.real < met))


def test_a_wall_beyond_what_may_be_taken_does_not_contradict_nearer_ones():
    z, triangles, codes = filled(met=5)
    assert set(codes) == {1}
    p = z[triangles[(z[triangles].real <= 6).all(axis=1)]]
    area = ((p[:, 1] - p[:, 0]).conj() * (p[:, 2] - p[:, 0])).imag / 2
    assert (area > 0).all()
    assert area.sum() == pytest.approx(12)


@pytest.mark.parametrize("met", [7.2, -1])
def test_walls_that_contradict_each_other_are_told_where_triangles_may_be_taken_or_no_wall_is_nearer(met):
    with pytest.raises(SeamError, match="contradict"):
        filled(met=met)


def test_walls_that_are_met_must_agree():
    with pytest.raises(SeamError, match="contradict"):
        filled(met=5, left=np.array([1, 2, 1, 1, 1, 1, 1, 1]))
