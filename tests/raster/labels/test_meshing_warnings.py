"""What is hardly meant is told before the work, and nothing is said of ordinary images."""

from __future__ import annotations

import warnings
from pathlib import Path

import drawn_images
import numpy as np
import pytest
from PIL import Image, ImageDraw

import img2tri
from img2tri import mesh_image
from img2tri.errors import ConfettiWarning, ConnectivityWarning, Img2triWarning, SizeWarning
from img2tri.raster.labels.absorbed_labels import thin_separators
from img2tri.raster.labels.meshing_warnings import meshing_warnings, predicted_triangles
from img2tri.raster.labels.segmentation import Segmentation


def crack():
    img = Image.new("L", (120, 80), 1)
    draw = ImageDraw.Draw(img)
    draw.line([(5, 40), (60, 33), (115, 60)], fill=2)
    draw.line([(60, 33), (80, 4)], fill=2)
    return np.asarray(img)


def test_a_diagonal_crack_in_pieces():
    with pytest.warns(ConnectivityWarning, match=r"label 2 is 5\d pieces that touch at corners .*connectivity=8 joins them to 1"):
        mesh = mesh_image(crack(), labels=True)
    assert mesh.report.topology[2]["found"][0] > 50
    assert "connectivity=8" in mesh.report.notes[-1]
    assert mesh_image(crack(), labels=True, connectivity=8).report.topology[2]["found"][0] == 1


def test_a_noisy_page_is_told_before_the_work():
    labels = np.random.default_rng(0).random((600, 600)) < 0.5
    seen = []

    def progress(text, _):
        seen.append(text)
        if "triangles are to be expected" in text:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mesh_image(labels, progress=progress)
    assert "outlines" not in seen
    told = list(meshing_warnings(Segmentation(labels, 0), connectivity=8, asked=None))
    assert any(isinstance(warning, SizeWarning) for warning in told)
    assert not any(isinstance(w, SizeWarning) for w in meshing_warnings(Segmentation(labels[:100, :100], 0), connectivity=8, asked=None))


def test_predictions_are_of_the_right_size():
    rng = np.random.default_rng(0)
    for image in (rng.random((80, 80)) < 0.5, rng.integers(0, 5, (50, 50)), drawn_images.clouds(150, rng, 2) > 0.5):
        count = len(mesh_image(image, labels=True if image.dtype != bool else None).triangles)
        assert count / 3 < predicted_triangles(Segmentation(image, 0), 2000) < 3 * count


def test_colours_in_between_are_told():
    labels = drawn_images.cells(60, 3, np.random.default_rng(1)) * 80
    soft = drawn_images.enlarged(labels.astype(np.uint8), 2, Image.Resampling.BICUBIC)
    with pytest.warns(ConfettiWarning, match=r"\d+ of \d+ labels have no pixel off an edge.*colors="):
        mesh_image(soft, labels=True)
    assert set(mesh_image(soft, colors=3, background=None).regions) == {80, 160, 240}


@pytest.mark.parametrize("line", [0, 255])
def test_thin_separators_are_hinted_at(line):
    parted = drawn_images.parted(drawn_images.cells(80, 12, np.random.default_rng(2)), line)
    assert thin_separators(parted) == [line]
    assert f"absorb={line} would give them to their neighbours" in mesh_image(parted, labels=True).report.notes[-1]
    assert thin_separators(drawn_images.cells(80, 12, np.random.default_rng(2))) == []


def test_nothing_is_said_of_ordinary_images():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, labels in drawn_images.label_maps():
            if "colours" not in name and labels.size < 20_000:
                assert not list(meshing_warnings(Segmentation(labels.astype(int), 0), connectivity=4, asked=None)), name


def test_nothing_is_said_of_the_pictures_at_hand():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for path in sorted((Path(__file__).parents[3] / "data").glob("*.png")):
            mesh_image(path, labels=True if path.stem == "polycrystal" else None, edge_length=20)


def test_they_are_one_family():
    for kind in (SizeWarning, ConnectivityWarning, ConfettiWarning):
        assert issubclass(kind, Img2triWarning)
        assert getattr(img2tri, kind.__name__) is kind
    assert issubclass(Img2triWarning, UserWarning)
