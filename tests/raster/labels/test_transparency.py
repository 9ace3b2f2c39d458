"""Transparent is not black: alpha says what is there."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from img2tri import mesh_image
from img2tri.errors import ImageError, ParameterError

STICKER = np.zeros((60, 80, 4), np.uint8)
STICKER[10:50, 10:70] = (0, 0, 0, 255)
STICKER[14:46, 14:66] = (230, 40, 40, 255)
RED = 0xE62828


def areas(mesh):
    return {label: area["mesh"] for label, area in mesh.report.areas.items()}


def test_the_silhouette_is_meshed_black_border_and_all():
    for options in ({}, {"threshold": "alpha"}):
        mesh = mesh_image(STICKER, **options)
        assert areas(mesh) == pytest.approx({1: 2400})
        assert mesh.report.settings["threshold_from"] == "alpha"
        assert "silhouette" in mesh.report.notes[0]
    assert areas(mesh_image(STICKER, threshold="alpha", invert=True)) == pytest.approx({1: 2400})


def test_labels_know_black_from_transparent():
    mesh = mesh_image(STICKER, labels=True)
    assert areas(mesh) == pytest.approx({0: 736, RED: 1664})
    assert "black, 0, is a region" in mesh.report.notes[0]
    assert areas(mesh_image(STICKER, labels=[0])) == pytest.approx({0: 736})
    assert areas(mesh_image(STICKER, labels=True, background=RED)) == pytest.approx({0: 736})
    assert areas(mesh_image(STICKER, labels=True, background=None)) == pytest.approx({0: 736, RED: 1664})


def test_gray_values_part_what_is_opaque():
    assert areas(mesh_image(STICKER, threshold="otsu")) == pytest.approx({1: 1664})
    assert areas(mesh_image(STICKER, threshold="otsu", invert=True)) == pytest.approx({1: 736})


def test_hidden_colours_are_never_seen():
    noise = STICKER.copy()
    hidden = noise[..., 3] == 0
    noise[hidden, :3] = np.random.default_rng(0).integers(0, 256, (hidden.sum(), 3))
    for options in ({}, {"labels": True}, {"threshold": "otsu"}, {"colors": 2}):
        one, other = mesh_image(STICKER, **options), mesh_image(noise, **options)
        assert areas(one) == areas(other)


def test_palettes_with_a_transparent_colour(tmp_path):
    values = np.zeros((60, 80), np.uint8)
    values[10:50, 10:70], values[14:46, 14:66] = 1, 2
    img = Image.fromarray(values).convert("P")
    img.putdata(values.ravel().tolist())
    img.putpalette([255, 255, 255, 0, 0, 0, 230, 40, 40])
    img.save(tmp_path / "a.png", transparency=0)
    assert areas(mesh_image(tmp_path / "a.png")) == pytest.approx({1: 2400})
    assert areas(mesh_image(tmp_path / "a.png", labels=True)) == pytest.approx({1: 736, 2: 1664})


def test_a_soft_silhouette_is_placed_by_its_coverage():
    fine = np.hypot(*np.mgrid[-240:240, -240:240] + 0.5) < 150
    image = np.zeros((60, 60, 4), np.uint8)
    image[..., 3] = np.rint(fine.reshape(60, 8, 60, 8).mean(axis=(1, 3)) * 255)
    image[..., 0] = 40
    mesh = mesh_image(image, edge_length=3)
    assert areas(mesh)[1] == pytest.approx(np.pi * (150 / 8) ** 2, rel=2e-3)


def test_alpha_that_hides_nothing_only_dims():
    image = np.full((40, 40, 4), 255, np.uint8)
    image[..., :3] = 200
    image[:, :20, 3] = 60
    assert areas(mesh_image(image)) == pytest.approx({1: 800})


def test_what_has_no_silhouette():
    with pytest.raises(ParameterError, match="threshold: 'alpha' expected an image with an alpha channel"):
        mesh_image(STICKER[..., 0], threshold="alpha")
    with pytest.raises(ImageError, match="expected pixels to mesh, found none"):
        mesh_image(STICKER * np.array([1, 1, 1, 0], np.uint8))
