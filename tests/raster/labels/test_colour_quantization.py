"""Drawings of a few flat colours: what lies between the colours is no region, and places the edges."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image, ImageDraw

from img2tri import mesh_image
from img2tri.errors import ParameterError
from img2tri.raster.labels.colour_quantization import label_by_colours
from img2tri.raster.labels.flat_colours import assigned, find_colours

RED, BLUE, YELLOW = (220, 40, 40), (40, 160, 220), (250, 210, 60)
LABELS = [0xDC2828, 0x28A0DC, 0xFAD23C]


def drawing(scale, n=96, ground=(0, 0, 0)):
    img = Image.new("RGB", (n * scale, n * scale), ground)
    draw = ImageDraw.Draw(img)
    draw.ellipse([8 * scale, 8 * scale, 60 * scale - 1, 60 * scale - 1], fill=RED)
    draw.polygon([(40 * scale, 86 * scale), (90 * scale, 80 * scale), (70 * scale, 30 * scale)], fill=BLUE)
    draw.rectangle([10 * scale, 64 * scale, 36 * scale - 1, 90 * scale - 1], fill=YELLOW)
    return img


FINE = np.asarray(drawing(8))
SOFT = np.asarray(drawing(8).resize((96, 96), Image.Resampling.BOX))
AREAS = {label: (FINE == colour).all(axis=2).sum() / 64 for label, colour in zip(LABELS, (RED, BLUE, YELLOW), strict=True)}


def jpeg(values, quality):
    file = io.BytesIO()
    Image.fromarray(values).save(file, "JPEG", quality=quality)
    return np.asarray(Image.open(file))


@pytest.mark.parametrize("colors", [3, 4, LABELS, ["#dc2828", "#28A0DC", "#fad23c"], [RED, BLUE, YELLOW], [0, *LABELS]])
def test_an_anti_aliased_drawing_has_the_areas_it_was_drawn_with(colors):
    if colors == [0, *LABELS]:
        with pytest.raises(ParameterError, match="colors: .*different"):
            mesh_image(SOFT, colors=[*colors, 0])
    mesh = mesh_image(SOFT, colors=colors)
    assert set(mesh.regions) == set(LABELS)
    for label, area in AREAS.items():
        assert mesh.report.areas[label]["mesh"] == pytest.approx(area, rel=0.01)
    assert mesh.report.kept
    assert len(mesh.triangles) < 1000
    assert "4 colours" in mesh.report.notes[0]


def test_the_mix_places_the_edge_between_the_pixels():
    for covered in (0.2, 0.35, 0.6, 0.9):
        row = np.array([200, 200, 200 * covered + 80 * (1 - covered), 80, 80])
        image = np.repeat(np.rint(row)[None].astype(np.uint8), 12, axis=0)
        mesh = mesh_image(image, colors=[200, 80], background=80, edge_length=2)
        assert mesh.report.areas[200]["mesh"] == pytest.approx(12 * (2 + covered), rel=0.008)
        hard = mesh_image(np.where(image > 140, 200, 80).astype(np.uint8), labels=[200], background=80, edge_length=2)
        assert abs(mesh.report.areas[200]["mesh"] - hard.report.areas[200]["mesh"]) > 0.05 * 12


@pytest.mark.parametrize("quality", [60, 85, 95])
def test_a_drawing_as_jpeg_has_three_regions(quality):
    mesh = mesh_image(jpeg(SOFT, quality), colors=LABELS)
    assert set(mesh.regions) == set(LABELS)
    for label, area in AREAS.items():
        assert mesh.report.areas[label]["mesh"] == pytest.approx(area, rel=0.02)
        assert mesh.report.topology[label]["found"][0] == 1
    assert len(set(mesh_image(jpeg(SOFT, quality), colors=3).regions)) == 3


def test_labels_saved_as_jpeg():
    values = np.zeros((120, 160), np.uint8)
    values[10:60, 10:80], values[60:110, 10:80], values[np.hypot(*np.mgrid[-60:60, -110:50]) < 35] = 80, 160, 240
    for colors in (3, [80, 160, 240]):
        mesh = mesh_image(jpeg(values, 80), colors=colors)
        assert mesh.report.topology == {label: {"found": (1, 0), "expected": (1, 0)} for label in (80, 160, 240)}
        for label in (80, 160, 240):
            assert mesh.report.areas[label]["mesh"] == pytest.approx((values == label).sum(), rel=0.01)


def test_no_third_colour_between_two():
    """Between black and white there is a gray that is listed, and drawn elsewhere."""
    fine = np.zeros((8 * 60, 8 * 60), np.uint8)
    fine[np.hypot(*np.mgrid[-200:280, -200:280]) < 150] = 255
    fine[8 * 44 : 8 * 56, 8 * 44 : 8 * 56] = 128
    soft = np.rint(fine.reshape(60, 8, 60, 8).mean(axis=(1, 3))).astype(np.uint8)
    labels, _ = label_by_colours(soft, [128, 255], background=0)
    assert (labels.values == 128).sum() == 144
    mesh = mesh_image(soft, colors=[128, 255])
    assert {label: t["found"] for label, t in mesh.report.topology.items()} == {128: (1, 0), 255: (1, 0)}


def test_a_thin_line_keeps_its_colour():
    image = np.zeros((30, 30, 3), np.uint8)
    image[14] = RED
    image[:, 20:] = BLUE
    found, _ = label_by_colours(image, [0xDC2828, 0x28A0DC], background=0)
    assert (found.values[14, :18] == 0xDC2828).all()
    assert (found.values[:14, :20] == 0).all()


def test_colours_are_found_whatever_the_order_and_by_no_chance():
    found = find_colours(SOFT, 3, np.zeros(3), None)
    assert {tuple(colour) for colour in found.astype(int)} == {(0, 0, 0), RED, BLUE, YELLOW}
    assert (found == find_colours(SOFT, 3, np.zeros(3), None)).all()
    turned = find_colours(SOFT[::-1, ::-1], 3, np.zeros(3), None)
    assert {tuple(c) for c in turned} == {tuple(c) for c in found}
    white = np.asarray(drawing(4, ground=(255, 255, 255)).resize((96, 96), Image.Resampling.BOX))
    assert {tuple(c) for c in find_colours(white, 4, None, None).astype(int)} == {(255, 255, 255), RED, BLUE, YELLOW}
    assert set(mesh_image(white, colors=3, background=0xFFFFFF).regions) == set(LABELS)


def test_more_colours_than_there_are_is_an_error():
    with pytest.raises(ParameterError, match=r"colors: expected 9 flat colours in the image, found 4"):
        mesh_image(SOFT, colors=9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"colors": 0}, "colors: expected a whole number of at least 1"),
        ({"colors": []}, "colors: expected 1 to 256 different colours"),
        ({"colors": "red"}, "colors: expected how many colours, or a list"),
        ({"colors": ["red"]}, "colors: expected colours like '#dc2828'"),
        ({"colors": [(1, 2, 300)]}, "colors: expected a whole number of at most 255"),
        ({"colors": 2, "labels": True}, "labels: expected to be left out with colors"),
        ({"colors": 2, "threshold": 3}, "threshold: expected to be left out with colors"),
        ({"colors": 2, "absorb": 3}, "absorb: expected to be left out with colors"),
    ],
)
def test_what_colors_cannot_be(options, message):
    with pytest.raises(ParameterError, match=message):
        mesh_image(SOFT, **options)


def test_transparent_pixels_are_no_colour():
    image = np.dstack([SOFT, np.full((96, 96), 255, np.uint8)])
    image[:, :5, 3] = 0
    mesh = mesh_image(image, colors=4)
    assert set(mesh.regions) == {0, *LABELS}
    assert mesh.vertices[:, 0].min() == pytest.approx(5)


def test_other_depths():
    for values, scale in ((SOFT.astype(np.uint16) * 257, 257), (SOFT[..., 0], 1), (SOFT[..., 0] / 255.0, 1 / 255)):
        mesh = mesh_image(values, colors=3 if values.ndim == 3 else 2)
        assert mesh.report.kept
        assert len(set(mesh.regions)) in (2, 3)
        assert scale


def test_a_hard_drawing_is_meshed_as_its_label_map_is():
    hard = np.asarray(drawing(1))
    one, other = mesh_image(hard, colors=3), mesh_image(hard, labels=True)
    assert (one.vertices == other.vertices).all()
    assert (one.regions == other.regions).all()


def test_every_pixel_of_an_exact_drawing_keeps_its_colour():
    hard = np.asarray(drawing(1))
    colours = np.array([(0, 0, 0), RED, BLUE, YELLOW])
    index, distance = assigned(hard, colours.astype(float))
    assert (colours[index] == hard).all()
    assert (distance == 0).all()
