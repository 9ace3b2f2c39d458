"""The images of data/ are those the script beside them draws, and are what they are said to be."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import cv2
import numpy as np
import pytest

from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.otsu_threshold import binarize
from img2tri.raster.labels.rgb_to_labels import distinct, label_map
from img2tri.raster.reading import read

DATA = Path(__file__).parents[1] / "data"
NAMES = ["femur.png", "femur_gray.png", "blobs.png", "blob_with_holes.png", "plate.png", "polycrystal.png", "gear.png"]
CONTENT = {  # components and holes of the white zone
    "femur.png": (1, 0),
    "femur_gray.png": (1, 0),
    "blobs.png": (3, 0),
    "blob_with_holes.png": (1, 4),
    "plate.png": (1, 1),
    "gear.png": (1, 7),
}


def load():
    spec = importlib.util.spec_from_file_location("draw", DATA / "draw.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


DRAW = load()


def test_the_folder_holds_what_the_script_draws():
    assert sorted(path.name for path in DATA.glob("*.png")) == sorted(NAMES) == sorted(DRAW.PICTURES)
    assert all((DATA / name).stat().st_size < 40_000 for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_drawn_again_it_is_the_same(name):
    drawn, kept = DRAW.PICTURES[name](), read(DATA / name).values
    assert (drawn.shape, drawn.dtype) == (kept.shape, kept.dtype)
    # Sines differ in their last bit between machines, which may move a sample or two over an edge.
    assert (drawn != kept).mean() < 1e-4


@pytest.mark.parametrize("name", CONTENT)
def test_components_and_holes(name):
    mask, _ = binarize(to_gray(read(DATA / name).values), threshold=30)
    components, holes = CONTENT[name]
    assert cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)[0] - 1 == components
    assert cv2.connectedComponents((~mask).astype(np.uint8), connectivity=8)[0] - 2 == holes
    assert np.count_nonzero(mask) == np.count_nonzero(mask[1:-1, 1:-1])  # nothing on the frame


@pytest.mark.parametrize("name", ["femur.png", "blobs.png", "blob_with_holes.png", "gear.png"])
def test_silhouettes_are_black_and_white(name):
    assert distinct(read(DATA / name).values).tolist() == [0, 255]


def test_the_gray_femur_is_the_femur():
    silhouette, gray = read(DATA / "femur.png").values > 0, read(DATA / "femur_gray.png").values
    assert (silhouette == (gray > 115)).mean() > 0.93  # but for the marrow
    whole = gray > 35
    assert np.count_nonzero(whole ^ silhouette) < 0.01 * silhouette.sum()
    levels = np.bincount(gray.reshape(-1), minlength=256)
    assert set(np.argsort(levels)[-4:].tolist()) == {0, 70, 150, 230}


def test_the_polycrystal_has_40_grains_in_one_piece_each():
    labels = label_map(read(DATA / "polycrystal.png").values).values
    assert distinct(labels).tolist() == list(range(1, 41))
    for label in range(1, 41):
        assert cv2.connectedComponents((labels == label).astype(np.uint8), connectivity=4)[0] == 2


def test_gray_edges_hold_the_area_covered():
    part = (read(DATA / "plate.png").values.astype(float) - 20) / 180
    assert part.sum() == pytest.approx(279.3 * 130.5 - np.pi * 30.4**2, rel=2e-4)
    for radius in (3.3, 20.1):
        disc = DRAW.coverage([DRAW.circle(30.3, 31.4, radius)], (60, 60))
        assert disc.sum() == pytest.approx(np.pi * radius**2, rel=0.005)
        rows, columns = np.indices(disc.shape) + 0.5
        assert (disc * columns).sum() / disc.sum() == pytest.approx(30.3, abs=0.01)
        assert (disc * rows).sum() / disc.sum() == pytest.approx(31.4, abs=0.01)
