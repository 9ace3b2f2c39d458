from __future__ import annotations

import hashlib

import numpy as np
import pytest

from img2tri.raster.in_memory.image_hash import image_hash

IMAGE = np.random.default_rng(0).integers(0, 256, (30, 40), np.uint16)


def test_it_is_the_sha256_of_type_shape_and_bytes():
    expected = hashlib.sha256(b"<u2 (30, 40)" + IMAGE.astype("<u2").tobytes()).hexdigest()
    assert image_hash(IMAGE) == expected


def test_of_a_mask_eight_pixels_are_a_byte():
    mask = IMAGE > 100
    expected = hashlib.sha256(b"|b1 (30, 40)" + np.packbits(mask).tobytes()).hexdigest()
    assert image_hash(mask) == expected
    assert image_hash(mask) != image_hash(mask.astype(np.uint8))


def test_it_does_not_depend_on_how_the_numbers_lie_in_memory():
    assert len({image_hash(array) for array in (IMAGE, IMAGE.astype(">u2"), np.asfortranarray(IMAGE), np.repeat(IMAGE, 2, 1)[:, ::2])}) == 1


@pytest.mark.parametrize("other", [IMAGE.T, IMAGE.astype(np.uint32), IMAGE.reshape(40, 30), IMAGE ^ (np.arange(40) == 7)])
def test_it_is_another_for_another_image(other):
    assert image_hash(other) != image_hash(IMAGE)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int64, np.float32])
def test_it_takes_what_images_are_made_of(dtype):
    assert len(image_hash(np.ones((3, 4, 3), dtype))) == 64
