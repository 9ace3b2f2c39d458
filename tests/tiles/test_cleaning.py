"""Specks, holes and largest components across blocks: the same labels as in memory, whatever borders cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import ndimage

from img2tri import ImageError, mesh_image, mesh_tiles
from img2tri.options.all_options import checked
from img2tri.raster.labels.rgb_to_labels import LabelMap
from img2tri.raster.labels.specks_and_holes import clean
from img2tri.tiles import block_plan
from img2tri.tiles.block_plan import planned
from img2tri.tiles.cleaning.clean_blocks import clean_blocks
from img2tri.tiles.parts.load_parts import load_tiles
from img2tri.tiles.pixel_source import PixelSource
from img2tri.types import Frame

WAYS = [
    {"min_area": 3.0},
    {"min_area": 8.0, "connectivity": 8},
    {"fill_holes": True},
    {"largest": True},
    {"min_area": 5.0, "fill_holes": 9.0, "largest": True},
]


def cleaned(labels, background, folder, **options):
    """Clean in blocks of three pixels; labels, what was removed, and how many pixels more are in regions."""
    for path in folder.glob("cleaned*"):
        path.unlink()
    o = dict(checked({"labels": True, "background": background, **options}, function="mesh_tiles"))
    plan = planned(Frame(labels.shape), o, 1)
    plan = replace(plan, block=3)
    found, removed, more = clean_blocks(None, PixelSource(labels), plan, folder, lambda _: None)
    rows, columns = (slice(0, n) for n in labels.shape)
    return (labels if found is None else found.over(labels, rows, columns)), removed, more


@pytest.mark.parametrize("background", [0, None])
@pytest.mark.parametrize("way", WAYS, ids=str)
def test_random_label_maps_are_cleaned_as_in_memory(way, background, tmp_path):
    @settings(max_examples=8, deadline=None)
    @given(arrays(np.int64, st.tuples(st.integers(1, 11), st.integers(1, 11)), elements=st.integers(0, 3)))
    def check(labels):
        inner = {**way, "fill_holes": np.inf if way.get("fill_holes") is True else way.get("fill_holes")}
        expected, removed = clean(LabelMap(labels, background), **inner)
        found, told, more = cleaned(labels, background, tmp_path, **way)
        assert np.array_equal(found, expected.values)
        assert told == removed
        if background is not None:
            assert more == (expected.values != background).sum() - (labels != background).sum()

    check()


NOISE = np.random.default_rng(3).standard_normal((150, 130))
MASK = (ndimage.gaussian_filter(NOISE, 6) > 0) ^ (ndimage.gaussian_filter(NOISE, 1.5) > 0.36)


def test_the_bits_are_those_of_the_image_in_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 128)
    options = {"edge_length": 4.0, "min_area": "60px2", "largest": True}
    made = mesh_tiles(MASK, tmp_path / "mesh.zarr", **options)
    mesh = mesh_image(MASK, blocks=True, **options)
    found = load_tiles(made.path)
    assert all(one.tobytes() == other.tobytes() for one, other in zip(found, (mesh.vertices, mesh.triangles, mesh.regions), strict=True))
    assert made.report["removed"]["pixels"] == mesh.report.counted["removed"]["pixels"] > 0
    assert made.report["warnings"] == []


def test_nothing_left_is_told(tmp_path):
    with pytest.raises(ImageError, match="expected pixels to mesh, found none.*9 were removed as too small"):
        mesh_tiles(np.pad(np.ones((3, 3), bool), 9), tmp_path / "mesh.zarr", min_area=20)
