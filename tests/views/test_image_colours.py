"""The image's own colours, and names made of them, wherever regions are shown."""

from __future__ import annotations

import base64
import io
import json
import re
import zipfile

import numpy as np
import pytest
import pyvista as pv
from matplotlib.collections import PolyCollection
from PIL import Image

import img2tri
from img2tri.views.figures import notebook
from img2tri.views.page.html_page import page

RED, BLUE, BLACK = (220, 40, 40), (20, 60, 160), (0, 0, 0)
HEXES = {"#dc2828", "#143ca0", "#000000"}


def drawing():
    """A red square and a black one on blue."""
    pixels = np.full((20, 30, 3), BLUE, np.uint8)
    pixels[5:15, 4:12], pixels[5:15, 18:26] = RED, BLACK
    return pixels


def meshed(kind):
    pixels, options = drawing(), {"edge_length": 5, "background": None}
    if kind == "rgb":
        return img2tri.mesh_image(pixels, labels=True, **options)
    if kind == "counted":
        return img2tri.mesh_image(pixels, colors=3, **options)
    file = io.BytesIO()
    Image.fromarray(pixels).quantize(3).save(file, "png")
    file.seek(0)
    return img2tri.mesh_image(Image.open(file), labels=True, **options)


@pytest.fixture(params=["rgb", "palette", "counted"], scope="module")
def mesh(request):
    return meshed(request.param)


def test_each_region_knows_its_colour(mesh):
    assert set(mesh.colours) == set(mesh.regions.tolist())
    assert set(mesh.colours.values()) == {RED, BLUE, BLACK}


def test_figures_have_the_colours_of_the_image(mesh):
    figure = mesh.plot(colour_by="region")
    (faces,) = (artist for artist in figure.axes[0].collections if isinstance(artist, PolyCollection))
    shown = np.round(255 * np.asarray(faces.get_facecolor())[:, :3])
    assert np.array_equal(shown, [mesh.colours[label] for label in mesh.regions.tolist()])
    legend = {text.get_text(): patch.get_facecolor() for text, patch in zip(*legend_of(figure), strict=True)}
    names = {mesh.names.get(label, str(label)): colour for label, colour in mesh.colours.items()}
    assert {name: tuple(np.round(255 * np.array(colour[:3]))) for name, colour in legend.items()} == names


def legend_of(figure):
    (legend,) = figure.legends
    return legend.get_texts(), legend.get_patches()


def test_pages_and_notebooks_have_the_colours_of_the_image(mesh, tmp_path):
    assert set(re.findall(r'fill="(#[0-9a-f]{6})" stroke="#fff"', mesh._repr_html_())) == HEXES
    mesh.save(tmp_path / "a.html")
    assert set(re.findall(r'class="swatch" style="background:(#\w+)"', (tmp_path / "a.html").read_text())) == HEXES


def test_a_large_mesh_in_a_notebook_has_the_colours_of_the_image(mesh, monkeypatch):
    monkeypatch.setattr(notebook, "LARGEST", 10)
    data = mesh._repr_html_().partition("base64,")[2].partition('"')[0]
    picture = np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB"))
    assert {RED, BLUE, BLACK} <= set(map(tuple, picture.reshape(-1, 3).tolist()))


def test_files_have_the_colours_of_the_image(mesh, tmp_path):
    mesh.save(tmp_path / "a.svg")
    assert set(re.findall(r'fill="(#[0-9a-f]{6})"', (tmp_path / "a.svg").read_text())) == HEXES
    for height in (None, 3):
        mesh.save(tmp_path / "a.3mf", height)
        model = zipfile.ZipFile(tmp_path / "a.3mf").read("3D/3dmodel.model").decode()
        assert {colour.lower() for colour in re.findall(r'<m:color color="(#\w+)"', model)} == HEXES
        mesh.save(tmp_path / "a.glb", height)
        data = (tmp_path / "a.glb").read_bytes()
        scene = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        found = {part["name"]: part["pbrMetallicRoughness"]["baseColorFactor"] for part in scene["materials"]}
        expected = {mesh.names.get(label, f"region_{label}"): colour for label, colour in mesh.colours.items()}
        assert {name: tuple(np.round(255 * np.array(colour[:3]))) for name, colour in found.items()} == expected


@pytest.mark.parametrize("options", [{}, {"height": 3, "solid": True}])
def test_pyvista_shows_the_colours_of_the_image(mesh, options):
    plotter = pv.Plotter(off_screen=True)
    dataset = mesh.to_pyvista(**options)
    assert dataset.img2tri.plot(plotter) is plotter
    (actor,) = (a for a in plotter.actors.values() if isinstance(a, pv.Actor))
    shown = np.asarray(actor.mapper.dataset.cell_data["region_rgb"])
    assert np.array_equal(shown, [mesh.colours[label] for label in dataset["region"].tolist()])


def test_labels_that_are_colours_are_named_so_that_one_can_type_them():
    mesh = meshed("rgb")
    assert mesh.names == {0xDC2828: "color_dc2828", 0x143CA0: "color_143ca0", 0: "color_000000"}
    assert meshed("counted").names == mesh.names
    assert meshed("palette").names == {}
    again = img2tri.mesh_image(drawing(), labels=True, background=None, edge_length=5, names={0xDC2828: "fire"})
    assert again.names == {**mesh.names, 0xDC2828: "fire"}
    wide = img2tri.mesh_image(drawing().astype(np.uint16) * 257, labels=True, background=None, edge_length=5)
    assert set(wide.names.values()) == {"color_dcdc28282828", "color_14143c3ca0a0", "color_000000000000"}
    assert set(wide.colours.values()) == {RED, BLUE, BLACK}


def test_regions_without_a_colour_get_one_of_their_own():
    disc = np.where(np.hypot(*np.mgrid[-9:9, -9:9]) < 6, 3, 8)
    mesh = img2tri.mesh_image(disc, labels=True, edge_length=4)
    assert mesh.colours == {}
    text = page(mesh.vertices, mesh.triangles, regions=mesh.regions, q=np.ones(len(mesh.triangles)),
                min_angle=np.ones(len(mesh.triangles)), frame=mesh.frame, report="{}", colours={3: RED})  # fmt: skip
    shown = re.findall(r'class="swatch" style="background:(#\w+)"', text)
    assert len(set(shown)) == 2
    assert "#dc2828" in shown
