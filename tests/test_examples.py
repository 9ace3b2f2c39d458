"""Every example runs, quietly correct: a number of each is asserted."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

EXAMPLES = Path(__file__).parent.parent / "examples"


def load(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(name, out):
    return load(name).main(out)


def test_one_call(tmp_path):
    found = run("01_one_call", tmp_path)
    assert found["min_angle"] >= 30
    assert found["q_mean"] > 0.95
    assert found["hausdorff"] <= 0.25  # half of a pixel of 0.5
    assert (tmp_path / "femur.png").stat().st_size > 10_000


def test_smoothing(tmp_path):
    found = run("04_smoothing", tmp_path)
    assert found["blob_cotangent_edge_factor"] == pytest.approx(1, abs=1e-12)
    assert found["blob_uniform_worst_angle"] >= 30
    assert found["femur_then_free_boundary_bend"] < 0.5 * found["femur_as_made_boundary_bend"]


def test_femur_under_load(tmp_path):
    pytest.importorskip("skfem")
    found = run("05_femur_under_load", tmp_path)
    assert found["kept"]
    assert found["work"] > 0
    assert found["work_if_twice_as_stiff"] == pytest.approx(found["work"] / 2)
    assert 1 < found["head_goes_down"] < 10
    assert 10 < found["stress"] < 100


def test_poisson_on_a_disc(tmp_path):
    pytest.importorskip("skfem")
    found = run("06_poisson_on_a_disc", tmp_path)
    assert found["kept_10_P1"] <= 0.09
    assert found["kept_10_P2"] <= 0.03
    assert found["kept_10_P1"] < 0.5 * found["plain_10_P1"]
    assert np.log2(found["kept_20_P1"] / found["kept_10_P1"]) >= 1.9  # second order


def test_stress_at_curves():
    pytest.importorskip("skfem")
    example = load("16_stress_at_curves")
    found = example.main(count=1)
    for name in example.EXACT:
        for kind in ("mask", "gray"):
            # The outline costs no more than the size of the edges does; rings of a mask are a little wavy.
            allowed = 1.6 if (name, kind) == ("ring, R 40", "mask") else 2 * abs(found[f"{name}, {kind}, exact curve"])
            assert abs(found[f"{name}, {kind}"]) <= allowed
    assert example.reference("ring, R 40", 2) == pytest.approx(example.EXACT["ring, R 40"], rel=2e-3)
    assert example.reference("slot, R 6", 0.8) == pytest.approx(example.EXACT["slot, R 6"], rel=0.01)


def test_extrude_to_stl(tmp_path):
    found = run("03_extrude_to_stl", tmp_path)
    assert found["watertight"]
    assert found["width"] == pytest.approx(40, abs=0.1)
    assert found["height"] == pytest.approx(6)
    assert found["volume_over_area"] == pytest.approx(6)


def test_effective_conductivity(tmp_path):
    pytest.importorskip("skfem")
    found = run("08_effective_conductivity", tmp_path)
    assert found["inclusion: outlines, 4 px, quadratic"] <= 0.1
    assert found["polycrystal: outlines, 4 px, quadratic"] <= 0.3
    for kind in ("inclusion", "polycrystal"):
        assert 3 * found[f"{kind}: outlines, 4 px, quadratic"] < found[f"{kind}: pixels, linear"]


def test_polycrystal_stiffness(tmp_path):
    found = run("09_polycrystal_stiffness", tmp_path)
    assert found["kept"]
    assert found["asymmetry"] < 1e-10
    assert found["patch"] < 1e-10
    assert found["least_step"] > 0.1  # GPa, between Reuss, tractions, periodic, displacements and Voigt
    assert 0.005 < found["gap"] < 0.05
    assert (tmp_path / "polycrystal_stiffness.png").stat().st_size > 50_000


def test_pictures_of_the_readme(tmp_path):
    """They are what the script draws, but for where single lines of a mesh lie: compared as thumbnails."""
    sizes = run("10_pictures_of_the_readme", tmp_path)
    assert max(sizes.values()) < 150_000
    stored = {path.name for path in (EXAMPLES.parent / "data" / "pictures").iterdir()}
    assert stored == {*sizes, "image_to_mesh.gif"}
    for name in sizes:
        drawn, shown = (Image.open(folder / name).convert("RGB") for folder in (tmp_path, EXAMPLES.parent / "data" / "pictures"))
        assert drawn.size == shown.size
        one, other = (np.asarray(picture.reduce(24), float) for picture in (drawn, shown))
        assert abs(one - other).mean() < 4
        assert abs(one - other).max() < 80


@pytest.mark.parametrize("count", [2, pytest.param(8, marks=pytest.mark.slow)])
def test_stress_at_a_hole(tmp_path, count):
    pytest.importorskip("skfem")
    example = load("07_stress_at_a_hole")
    if count == 2:
        example.ROUTES.pop("pixels")
    found = example.main(tmp_path, count)
    assert found["binary_60_4"] <= 1.5
    assert found["gray_60_4"] <= 1
    for kind in ("binary", "gray"):
        # A rough outline gets worse with finer edges.
        assert found[f"{kind}_60_2_raw"] <= found[f"{kind}_60_4_raw"] + 0.5
        assert found[f"{kind}_20_2_raw"] <= 3
    if "pixels_60_4" in found:
        assert found["pixels_60_4"] > 20
    assert found["paper"] < -60
    assert (tmp_path / "stress_at_a_hole.png").stat().st_size > 10_000


def test_animation_of_the_readme(tmp_path):
    found = run("11_animation_of_the_readme", tmp_path)
    assert found["bytes"] < 400_000
    stored = EXAMPLES.parent / "data" / "pictures" / "image_to_mesh.gif"
    with Image.open(tmp_path / "image_to_mesh.gif") as drawn, Image.open(stored) as shown:
        assert drawn.n_frames == shown.n_frames == found["frames"]
        for frame in (0, drawn.n_frames - 1):
            drawn.seek(frame)
            shown.seek(frame)
            one, other = (np.asarray(picture.convert("RGB").reduce(24), float) for picture in (drawn, shown))
            assert abs(one - other).mean() < 4


def test_solid_in_trame(tmp_path):
    found = run("12_solid_in_trame", tmp_path)
    assert found["volume"] == pytest.approx(found["wanted"], rel=1e-9)
    assert found["grains"] > 5
    assert found["wedges"] % 3 == 0


def test_labels_in_napari(tmp_path):
    found = run("13_labels_in_napari", tmp_path)
    assert found["area"] == pytest.approx(found["pixels"], rel=1e-9)
    assert found["regions"] > 5


def test_many_images_on_a_cluster(tmp_path):
    pytest.importorskip("distributed")
    found = run("14_many_images_on_a_cluster", tmp_path)
    assert found["volume"] == pytest.approx(found["truth"], rel=0.03)
    assert found["top"] > 4
    assert found["missed"] >= 1
    assert len(list(tmp_path.glob("*.vtp"))) == 12 - found["missed"]


@pytest.mark.filterwarnings("ignore")  # those of distributed, when its processes end
def test_larger_than_memory(tmp_path):
    pytest.importorskip("distributed")
    found = run("15_larger_than_memory", tmp_path)
    assert found["warnings"] == 0
    assert found["in_parts"] == found["triangles"] > 3_000
    assert abs(found["area_error"]) < 1e-4
