"""Borders of blocks through specimens at every place, and through random label maps: as sound as without."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from specimens import LABELS, MASKS

from img2tri import mesh_image
from img2tri.tiles import block_plan

SIDE, SIZE = 64, 100  # px, of blocks and of images: four blocks, that meet in one corner
SPECIMENS = {f"mask: {name}": m > 0 for name, m in MASKS.items()} | {f"labels: {name}": m for name, m in LABELS.items()}


@pytest.fixture(autouse=True, scope="module")
def small():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(block_plan, "BLOCK_SIDE", SIDE)
        yield


def check(image):
    """Mesh an image in four blocks, and check it by the oracles and by its certificate, which counts components and holes."""
    options = {} if image.dtype == bool else {"labels": True}
    mesh = mesh_image(image, edge_length=2.0, blocks=True, **options)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert mesh.report.counted["blocks"] == 4
    told = set(mesh.report.warnings) - set(mesh_image(image, edge_length=2.0, **options).report.warnings)
    assert not told, told


def placed(specimen, offset):
    image = np.zeros((SIZE, SIZE), specimen.dtype)
    rest = image[SIDE - offset :, SIDE - offset :][: specimen.shape[0], : specimen.shape[1]]
    rest[:] = specimen[: rest.shape[0], : rest.shape[1]]
    return image


@pytest.mark.parametrize("name", SPECIMENS)
def test_the_corner_of_blocks_may_lie_in_the_middle_of_a_specimen(name):
    check(placed(SPECIMENS[name], max(SPECIMENS[name].shape) // 2))


@pytest.mark.parametrize("offset", [1, 3])
def test_junctions_that_windows_place_alike_but_for_rounding_are_one(offset):
    check(placed(SPECIMENS["labels: checkerboard of three"], offset))


@pytest.mark.slow
@pytest.mark.parametrize("name", SPECIMENS)
def test_the_corner_of_blocks_may_lie_anywhere_in_a_specimen(name):
    for offset in range(max(SPECIMENS[name].shape) + 1):
        check(placed(SPECIMENS[name], min(offset, SIDE)))


@settings(max_examples=10)
@given(arrays(np.int64, (10, 10), elements=st.integers(0, 3)))
def test_random_label_maps_keep_all_promises(coarse):
    coarse[4, 4] = 1
    check(np.kron(coarse, np.ones((SIZE // 10, SIZE // 10), int)))
