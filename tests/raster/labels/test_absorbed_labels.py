"""Thin separators given to their neighbours: regions touch again."""

from __future__ import annotations

import drawn_images
import numpy as np
import pytest

from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.absorbed_labels import absorb_labels

CELLS = drawn_images.cells(120, 25, np.random.default_rng(7))


@pytest.mark.parametrize("line", [0, 255])
def test_watershed_lines(line):
    parted = drawn_images.parted(CELLS, line)
    whole, given = mesh_image(CELLS, labels=True), mesh_image(parted, absorb=line)
    assert len(given.triangles) < 1.2 * len(whole.triangles) < len(mesh_image(parted, labels=True).triangles) / 4
    assert set(given.regions) == set(whole.regions)
    interfaces = [{name for name in mesh.sets().sides if "__" in name} for mesh in (given, whole)]
    assert len(interfaces[0] & interfaces[1]) >= 0.9 * len(interfaces[1]) > 20
    assert given.report.notes == [f"{(parted == line).sum():,} pixels of {line} were given to their nearest neighbours"]
    for label in set(whole.regions):
        assert given.report.areas[label]["mesh"] == pytest.approx((CELLS == label).sum(), abs=4 * np.sqrt((CELLS == label).sum()))


def test_pixels_go_to_a_neighbour_of_theirs_and_no_others_change():
    parted = drawn_images.parted(CELLS, 0)
    labels, count = absorb_labels(parted, [0])
    assert count == (parted == 0).sum()
    assert (labels[parted != 0] == parted[parted != 0]).all()
    padded = np.pad(parted, 2, mode="edge")
    for r, c in np.argwhere(parted == 0):
        assert labels[r, c] in padded[r : r + 5, c : c + 5]


def test_wide_gaps_are_halved():
    labels, _ = absorb_labels(np.array([[1] * 3 + [9] * 8 + [2] * 3] * 5), [9])
    assert (labels == np.array([[1] * 7 + [2] * 7] * 5)).all()
    labels, _ = absorb_labels(np.array([[1] * 3 + [9] * 8 + [8] * 3 + [2]] * 5), [9, 8])
    assert set(np.unique(labels)) == {1, 2}


def test_pixels_that_are_not_there_take_none_and_stay():
    labels = np.array([[1, 9, 9, 9, 0, 0]] * 4)
    found, count = absorb_labels(labels, [9], missing=labels == 0)
    assert (found == [1, 1, 1, 1, 0, 0]).all()
    assert count == 12


def test_labels_picked_afterwards():
    mesh = mesh_image(drawn_images.parted(CELLS, 255), absorb=[255], labels=[3, 4, 5])
    assert set(mesh.regions) == {3, 4, 5}


def test_what_cannot_be_absorbed():
    with pytest.raises(ImageError, match="absorb: expected labels of the image, found 77"):
        mesh_image(CELLS, absorb=77)
    with pytest.raises(ImageError, match="absorb: expected other labels"):
        mesh_image(np.ones((9, 9), int), absorb=1)
    with pytest.raises(ParameterError, match="absorb: expected a list of integers"):
        mesh_image(CELLS, absorb="lines")
