from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import pyvista

import img2tri
from img2tri.errors import MeshError
from img2tri.views.figures.region_colours import palette

IMAGE = np.kron(np.array([[1, 1], [2, 5]], np.uint8), np.ones((30, 30), np.uint8))


class Recorder:
    """Takes what a plotter would be told; VTK without GL would end the process."""

    def __init__(self):
        self.meshes, self.legends = [], []

    def add_mesh(self, mesh, **options):
        self.meshes.append((mesh, options))

    def add_legend(self, labels, **_options):
        self.legends.append(labels)


@pytest.mark.parametrize("options", [{}, {"height": 3.0}, {"height": 3.0, "solid": True, "layers": 2}])
def test_each_region_has_its_colour_and_name(options):
    dataset = img2tri.mesh_image(IMAGE, labels=True, edge_length=6, names={2: "bone"}).to_pyvista(**options)
    plotter = Recorder()
    assert dataset.img2tri.plot(plotter, opacity=0.5) is plotter
    ((mesh, given),) = plotter.meshes
    assert given["opacity"] == 0.5
    colours = mesh.cell_data[given["scalars"]]
    for i, label in enumerate((1, 2, 5)):
        assert np.all(colours[dataset.cell_data["region"] == label] == palette(3)[i])
    assert [name for name, _ in plotter.legends[0]] == ["region 1", "bone", "region 5"]
    assert "region_rgb" not in dataset.cell_data


def test_many_regions_have_no_legend():
    dataset = img2tri.mesh_image(np.kron(np.arange(1, 17).reshape(4, 4), np.ones((9, 9), int)), labels=True).to_pyvista()
    plotter = dataset.img2tri.plot(Recorder())
    assert plotter.legends == []


def test_without_regions_it_is_said():
    with pytest.raises(MeshError, match="region: expected this cell array"):
        pyvista.Plane().triangulate().img2tri.plot(Recorder())


@pytest.mark.tools
def test_it_is_seen(tmp_path):
    code = (
        "import numpy as np, pyvista, img2tri; pyvista.OFF_SCREEN = True;"
        "image = np.kron(np.array([[1, 1], [2, 5]], np.uint8), np.ones((30, 30), np.uint8));"
        "p = pyvista.Plotter(off_screen=True, window_size=(300, 300)); img2tri.mesh_image(image, labels=True).to_pyvista().img2tri.plot(p);"
        "p.view_xy(); p.screenshot('a.png')"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    if run.returncode:
        pytest.skip(f"VTK cannot render here: {run.stderr[-200:]}")
    from PIL import Image

    with Image.open(tmp_path / "a.png") as read:
        found = np.asarray(read.convert("RGB")).astype(int)
    for colour in palette(3).astype(int):
        assert (np.abs(found - colour).max(axis=2) < 40).mean() > 0.05
