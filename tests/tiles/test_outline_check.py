"""What fills a gap may not be off the outlines of the image, nor leave out a part of them."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.tiles.seams.both_meshes import Both
from img2tri.tiles.seams.outline_check import DenseOutlines, check_outlines
from img2tri.tiles.seams.piece_seams import SeamError

# A region below a straight outline with a thin spike, and the mesh of a window that has it.
Z = np.array([0, 4.9, 5 + 1j, 5.1, 10, 5 - 5j, 5 + 3j])
NEW = np.array([[5, 4, 3], [5, 3, 2], [5, 2, 1], [5, 1, 0]])
SPIKE = DenseOutlines(Z[:6], np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]]))


def checked(triangles, tolerance, new=NEW):
    none = np.zeros((0, 2), np.int64)
    ones, empty = np.ones(len(new), np.int64), np.zeros((0, 3), np.int64)
    both = Both(
        Z, np.zeros(len(Z)), new, ones, empty, none[:, 0], none, none[:, 0], none[:, 0], np.zeros(0, bool), none, np.zeros(len(Z), bool)
    )
    check_outlines(Z, np.array(triangles), np.ones(len(triangles), np.int64), both, 1.0, SPIKE, tolerance)


def test_a_spike_that_is_left_out_is_told_though_no_edge_is_off():
    without = [[5, 4, 0]]
    assert SPIKE.off(Z, np.array([[4, 0]])).max() < 0.2
    with pytest.raises(SeamError, match="left out") as told:
        checked(without, 0.5)
    assert told.value.at.tolist() == [5 + 1j]
    checked(without, 1.1)
    # What the window's own mesh leaves out is not the seam's fault.
    checked(without, 0.5, new=np.array([[5, 4, 3], [5, 3, 1], [5, 1, 0]]))


def test_an_edge_that_is_off_is_told():
    with pytest.raises(SeamError, match="is off"):
        checked([[5, 4, 6], [5, 6, 0]], 0.5)
    checked(NEW, 1e-9)
