"""What looks like a label map is not thresholded; what does not, is. On drawn images of all kinds, and the real ones at hand."""

from __future__ import annotations

from pathlib import Path

import drawn_images
import numpy as np
import pytest

from img2tri import mesh_image
from img2tri.errors import ImageError
from img2tri.raster.labels.label_map_detection import flat_values
from img2tri.raster.reading import read

DATA = Path(__file__).parents[3] / "data"
MORE = Path(__file__).parents[4] / "shared" / "data"


def test_no_gray_image_is_taken_for_a_label_map():
    assert [name for name, values in drawn_images.gray_images() if flat_values(values) is not None] == []


def test_no_label_map_is_missed():
    assert [name for name, values in drawn_images.label_maps() if flat_values(values) is None] == []


def test_both_kinds_are_many():
    assert len(list(drawn_images.gray_images())) > 350
    assert len(list(drawn_images.label_maps())) > 270


@pytest.mark.parametrize("name", [path.name for path in sorted(DATA.glob("*.png"))])
def test_own_pictures(name):
    assert (flat_values(read(DATA / name).values) is not None) == (name == "polycrystal.png")


@pytest.mark.skipif(not MORE.exists(), reason="real images are not there")
def test_real_images():
    label_maps = {"sag_104.png", "seg_ax_005.png", "electrode_3phase_128.png", "mask2d.tif"}
    pictures = [path for path in sorted(MORE.iterdir()) if path.suffix != ".md"]
    assert {path.name for path in pictures if flat_values(read(path).values) is not None} == label_maps


def test_it_is_an_error_that_names_both_ways_on():
    grains = np.repeat(np.array([0, 1, 3, 4, 5, 6, 7, 9], np.uint8), 6) * np.ones((30, 1), np.uint8)
    with pytest.raises(ImageError, match=r"label map, 8 flat values .*0, 1, 3, 4, 5, 6, 7, 9.*labels=True.*threshold="):
        mesh_image(grains)
    assert set(mesh_image(grains, labels=True).regions) == {1, 3, 4, 5, 6, 7, 9}
    assert set(mesh_image(grains, threshold="otsu").regions) == {1}
    assert mesh_image(grains, threshold=4.5).report.settings["threshold_from"] == "given"


def test_colours_and_floats_are_looked_at_too():
    colours = np.repeat(np.eye(3, dtype=np.uint8) * 200, 8, axis=0)[None] * np.ones((20, 1, 1), np.uint8)
    assert len(flat_values(colours)) == 3
    with pytest.raises(ImageError, match="label map"):
        mesh_image(colours)
    with pytest.raises(ImageError, match="label map"):
        mesh_image(np.repeat([0.0, 0.5, 1.0], 8) * np.ones((20, 1)))


@pytest.mark.parametrize("seed", range(100, 103))
def test_images_the_rule_was_not_made_with(seed):
    rng = np.random.default_rng(seed)
    for kind in ("polygon", "lines", "pores"):
        large = drawn_images.shape(96 * 5, rng, kind)
        assert flat_values(np.rint(large.reshape(96, 5, 96, 5).mean(axis=(1, 3)))) is None
        assert flat_values(drawn_images.jpeg(large, 75)) is None
    assert flat_values(drawn_images.cells(150, 60, rng)) is not None
    assert flat_values(drawn_images.parted(drawn_images.cells(150, 25, rng), 0)) is not None
