"""The command line: every option arrives, every failure is one line and exit status 2, and no file is left behind."""

from __future__ import annotations

import base64
import inspect
import io
import json
import os
import re
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
import specimens
from children import PATIENCE
from PIL import Image

import img2tri
from img2tri import mesh_image, pipeline
from img2tri.cli import main, printing
from img2tri.options import OPTIONS
from img2tri.views.formats.readers.read_any import FILE_READERS
from img2tri.views.formats.save_load import SURFACE_FORMATS, load
from img2tri.views.formats.solvers.save_for_solvers import EXPORTS
from img2tri.views.formats.svg_dxf_geojson import DRAWING_FORMATS as DRAWINGS

# Each option of `img2tri mesh` that goes to mesh_image, as typed and as it must arrive.
ARRIVE = {
    "recipe": (["--recipe", "structured"], "structured"),
    "threshold": (["--threshold", "otsu"], "otsu"),
    "labels": (["--labels", "1,2,3"], [1, 2, 3]),
    "background": (["--background", "none"], None),
    "invert": (["--invert"], True),
    "connectivity": (["--connectivity", "8"], 8),
    "outline": (["--outline", "pixel"], "pixel"),
    "corners": (["--corners", "round"], "round"),
    "edge_length": (["--edge-length", "8px"], "8px"),
    "gradation": (["--gradation", "0.5"], 0.5),
    "min_edge_length": (["--min-edge-length", "2"], "2"),
    "boundary_edge_length": (["--boundary-edge-length", "2px"], "2px"),
    "elements_across": (["--elements-across", "2"], 2.0),
    "segments_per_turn": (["--segments-per-turn", "16"], 16.0),
    "min_angle": (["--min-angle", "28.5"], 28.5),
    "tolerance": (["--tolerance", "0.25px"], "0.25px"),
    "keep_area": (["--no-keep-area"], False),
    "blocks": (["--blocks"], True),
    "periodic": (["--periodic", "xy"], "xy"),
    "symmetric": (["--symmetric", "xy"], "xy"),
    "interior": (["--interior", "poisson"], "poisson"),
    "smoothing": (["--smoothing", "cotangent"], "cotangent"),
    "iterations": (["--iterations", "3"], 3),
    "spacing": (["--spacing", "0.5,0.7"], (0.5, 0.7)),
    "origin": (["--origin=-5,2.5"], (-5.0, 2.5)),
    "units": (["--units", "mm"], "mm"),
    "page": (["--page", "2"], 2),
    "crop": (["--crop", "1,2.5,30,40"], (1.0, 2.5, 30.0, 40.0)),
    "min_area": (["--min-area", "20px2"], "20px2"),
    "colors": (["--colors", "#dc2828,0x28a0dc"], [0xDC2828, 0x28A0DC]),
    "absorb": (["--absorb", "0,255"], [0, 255]),
    "fill_holes": (["--fill-holes", "20px2"], "20px2"),
    "largest": (["--largest"], True),
    "max_pixels": (["--max-pixels", "1000"], 1000),
    "names": (["--name", "1=bone", "--name", "2=a = b"], {1: "bone", 2: "a = b"}),
    "seed": (["--seed", "7"], 7),
    "width": (["--width", "80"], 80.0),
    "step": (["--step", "2%"], "2%"),
    "n_boundary_points": (["--n-boundary-points", "40"], 40),
    "n_interior_points": (["--n-interior-points", "0"], 0),
    "min_distance": (["--min-distance", "4"], "4"),
    "min_distance_to_boundary": (["--min-distance-to-boundary", "0"], "0"),
}
# Other ways to type a value.
ALSO_ARRIVE = [
    (["--keep-area"], "keep_area", True),
    (["--edge-length", "1=4,2=8px"], "edge_length", {1: "4", 2: "8px"}),
    (["--threshold", "240"], "threshold", 240.0),
    (["--threshold", "-0.5"], "threshold", -0.5),
    (["--labels"], "labels", True),
    (["--threshold", "110,190"], "threshold", (110.0, 190.0)),
    (["--threshold", "alpha"], "threshold", "alpha"),
    (["--colors", "3"], "colors", 3),
    (["--fill-holes"], "fill_holes", True),
    (["--labels=all"], "labels", True),
    (["--labels", "-5,7"], "labels", [-5, 7]),
    (["--labels", "0xdc2828"], "labels", [0xDC2828]),
    (["--labels", "#dc2828,#00ff00"], "labels", [0xDC2828, 0x00FF00]),
    (["--background", "#ffffff"], "background", 0xFFFFFF),
    (["--name", "#dc2828=bone"], "names", {0xDC2828: "bone"}),
    (["--background", "3"], "background", 3),
    (["--background", "-1"], "background", -1),
    (["--spacing", "0.5"], "spacing", 0.5),
    (["--spacing", "file"], "spacing", "file"),
    (["--origin", "upper"], "origin", "upper"),
]


@pytest.fixture
def disc(tmp_path):
    return _saved(specimens.disc(40, 15) * 255, tmp_path / "disc.png")


@pytest.fixture
def arrived(monkeypatch):
    """What mesh_image is called with."""
    calls = []

    def spy(image, **given):
        assert callable(given.pop("progress"))
        calls.append((image, given))
        return mesh_image(image, edge_length=6)

    monkeypatch.setattr(pipeline, "mesh_image", spy)
    return calls


def _saved(values, path):
    Image.fromarray(np.asarray(values).astype(np.uint8)).save(path)
    return str(path)


def _complaint(capsys):
    """The one line on stderr."""
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("img2tri: ")
    assert err.endswith("\n")
    assert err.count("\n") == 1
    return err


def _process(*arguments, **given):
    command = [sys.executable, "-m", "img2tri", *arguments]
    env = os.environ | {"PYTHONPATH": str(Path(img2tri.__file__).parents[1])}  # from any folder
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE, env=env, **given)


# ---- options ----


def test_every_option_of_mesh_image_is_there_but_callables():
    keyword_only = {name for name, p in inspect.signature(mesh_image).parameters.items() if p.kind == inspect.Parameter.KEYWORD_ONLY}
    assert set(OPTIONS) == keyword_only - {"progress"}
    assert set(ARRIVE) == set(OPTIONS)


@pytest.mark.parametrize("name", ARRIVE)
def test_an_option_reaches_mesh_image_and_nothing_else_does(name, arrived, disc):
    typed, value = ARRIVE[name]
    assert main(["mesh", disc, *typed]) == 0
    assert arrived == [(disc, {name: value})]


@pytest.mark.parametrize(("typed", "name", "value"), ALSO_ARRIVE)
def test_other_ways_to_type_a_value(typed, name, value, arrived, disc):
    assert main(["mesh", *typed, disc]) == 0
    assert arrived == [(disc, {name: value})]


WITH_DEFAULT = [name for name, p in inspect.signature(mesh_image).parameters.items() if p.default not in (None, p.empty, False)]


@pytest.mark.parametrize("name", WITH_DEFAULT)
def test_help_states_the_default(name, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["mesh", "--help"])
    assert stopped.value.code == 0
    text = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
    option = f"--{name.replace('_', '-')}"
    about = re.search(rf"^  {option}\b.*\n(?: {{10,}}.*\n)*", text, re.MULTILINE)
    default = inspect.signature(mesh_image).parameters[name].default
    shown = option if default is True else f"{default:g}" if isinstance(default, float) else str(default)
    assert f"(default {shown}" in " ".join(about[0].split())


def test_help_lists_the_formats(capsys):
    listed = []
    for command in ("mesh", "quality"):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        listed.append(set(re.findall(r"(?<![\w.])\.[a-z0-9]+", capsys.readouterr().out)))
    assert listed[0] >= {*SURFACE_FORMATS, *EXPORTS, *DRAWINGS}
    assert listed[1] == set(FILE_READERS)


def test_labels_before_the_image_does_not_swallow_it(arrived, disc):
    assert main(["mesh", "--labels", disc, "--quiet"]) == 0
    assert arrived == [(disc, {"labels": True})]


def test_options_without_an_image_of_their_own_are_not_abbreviated(disc, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["mesh", disc, "--edge", "8"])
    assert stopped.value.code == 2
    assert "--edge" in _complaint(capsys)


# ---- files and what is printed ----


def test_one_image_to_every_format_a_figure_and_a_report(disc, tmp_path, capsys):
    names = [f"out{suffix}" for suffix in (".stl", ".ply", ".obj", ".off", ".3mf", ".glb", ".vtp", ".vtu")]
    wanted = [part for name in names for part in ("-o", str(tmp_path / name))]
    figure, report = tmp_path / "figure.png", tmp_path / "report.json"
    assert main(["mesh", disc, "--edge-length", "6", *wanted, "--plot", str(figure), "--report", str(report)]) == 0

    mesh = mesh_image(disc, edge_length=6)
    for name in set(names) - {"out.3mf"}:
        vertices, triangles, _ = load(tmp_path / name)
        assert len(triangles) == len(mesh.triangles), name
        assert np.abs(np.sort(vertices, axis=0) - np.sort(mesh.vertices, axis=0)).max() < 1e-5, name
    assert (tmp_path / "out.3mf").stat().st_size > 0
    with Image.open(figure) as image:
        assert image.size[0] > 300
    told = json.loads(report.read_text())
    assert told == json.loads(mesh.report.to_json())
    out, err = capsys.readouterr()
    assert err == ""
    assert f"{len(mesh.triangles)} triangles" in out
    assert "threshold 127.5 (middle)" in out
    assert "edge length 6" in out
    assert all(name in out for name in names)
    assert str(mesh.quality()).partition("\n")[2] in out


def test_lengths_by_region(tmp_path, capsys):
    grains = specimens.polycrystal(40, 3)
    image = _saved(grains, tmp_path / "grains.png")
    assert main(["mesh", image, "--labels", "--edge-length", "1=2,2=8px,3=10%", "-o", str(tmp_path / "a.ply")]) == 0
    assert "edge length field" in capsys.readouterr().out
    _, triangles, _ = load(tmp_path / "a.ply")
    assert len(triangles) == len(mesh_image(grains, labels=True, edge_length={1: 2, 2: "8px", 3: "10%"}).triangles)


def test_labels_may_be_the_last_word(arrived, disc):
    assert main(["mesh", disc, "--labels"]) == 0
    assert arrived == [(disc, {"labels": True})]


def test_a_folder_is_all_its_images_and_a_pattern_those_it_matches(tmp_path, monkeypatch, arrived):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scans" / "more").mkdir(parents=True)
    for name in ("s10.png", "s9.png", "S1.PNG", ".hidden.png", "more/deep.png"):
        _saved(specimens.disc(20, 8) * 255, tmp_path / "scans" / name)
    (tmp_path / "scans" / "notes.txt").write_text("no image")
    assert main(["mesh", "scans", "--quiet"]) == 0
    assert [Path(image).name for image, _ in arrived] == ["S1.PNG", "s9.png", "s10.png"]
    arrived.clear()
    assert main(["mesh", os.path.join("scans", "s*.png"), "--quiet"]) == 0
    assert [Path(image).name for image, _ in arrived] == ["s9.png", "s10.png"]
    arrived.clear()
    _saved(specimens.disc(20, 8) * 255, tmp_path / "a[1].png")
    assert main(["mesh", "a[1].png", "--quiet"]) == 0
    assert [image for image, _ in arrived] == ["a[1].png"]


def test_folders_of_names_with_a_stem_are_made_and_go_if_they_stay_empty(disc, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    typed = ["--report", "rep/{stem}.json", "-o", "out/{stem}.stl", "--plot", "fig/{stem}.svg", "--quiet"]
    assert main(["mesh", "none.png", *typed]) == 2
    assert sorted(os.listdir(tmp_path)) == ["disc.png"]
    assert main(["mesh", disc, *typed]) == 0
    assert sorted(os.listdir(tmp_path)) == ["disc.png", "fig", "out", "rep"]
    assert os.listdir("rep") == ["disc.json"]


def test_options_of_saving_reach_the_formats_that_take_them(disc, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    calls = {}
    monkeypatch.setattr("img2tri.mesh.TriangleMesh.save", lambda _, path, **given: calls.update({path: given}))
    typed = ["--height", "5", "--layers", "3", "--order", "2", "--deck", "--plane", "strain", "--msh-version", "2.2"]
    assert main(["mesh", disc, "-o", "a.msh", "-o", "b.inp", "-o", "c.stl", *typed, "--quiet"]) == 0
    solid = {"height": 5.0, "layers": 3, "order": 2}
    assert calls == {"a.msh": solid | {"version": "2.2"}, "b.inp": solid | {"deck": True, "plane": "strain"}, "c.stl": {"height": 5.0}}


def test_files_are_those_of_the_library(disc, tmp_path):
    mesh = mesh_image(disc, edge_length=6.0)
    for suffix, typed, given in (
        (".msh", ["--msh-version", "2.2", "--order", "2"], {"version": "2.2", "order": 2}),
        (".inp", ["--deck", "--plane", "strain"], {"deck": True, "plane": "strain"}),
        (".vtu", ["--height", "4", "--layers", "2"], {"height": 4.0, "layers": 2}),
    ):
        typed_path, path = tmp_path / f"typed{suffix}", tmp_path / f"mesh{suffix}"
        assert main(["mesh", disc, "--edge-length", "6", "-o", str(typed_path), *typed, "--quiet"]) == 0
        mesh.save(path, **given)
        assert typed_path.read_bytes() == path.read_bytes(), suffix


def test_heights_by_label_a_plate_and_arrays_are_those_of_the_library(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    labels = np.full((20, 30), 1, np.uint8)
    labels[:, 15:] = 2
    Image.fromarray(labels).save("two.png")
    Image.fromarray(np.arange(600, dtype=np.uint16).reshape(20, 30)).save("two_heat.png")
    mesh = mesh_image("two.png", labels=True, edge_length=6.0)
    typed = ["mesh", "two.png", "--labels", "--edge-length", "6", "--quiet"]
    assert main([*typed, "-o", "typed.stl", "--height", "1=2,2=5", "--base", "1.5"]) == 0
    mesh.save("mesh.stl", {1: 2, 2: 5}, base=1.5)
    assert main([*typed, "-o", "typed.vtu", "--data", "T={stem}_heat.png", "--data", "U=two.png"]) == 0
    mesh.save("mesh.vtu", data={"T": mesh.sample("two_heat.png"), "U": mesh.sample("two.png")})
    assert main([*typed, "-o", "typed.xdmf", "--height", "3", "--cells", "tetrahedra"]) == 0
    mesh.save("mesh.xdmf", 3, cells="tetrahedra")
    for suffix in (".stl", ".vtu", ".xdmf"):
        assert Path(f"typed{suffix}").read_bytes() == Path(f"mesh{suffix}").read_bytes(), suffix


def test_height_gives_a_closed_solid(disc, tmp_path):
    flat, solid = tmp_path / "flat.stl", tmp_path / "solid.stl"
    assert main(["mesh", disc, "-o", str(flat), "--quiet"]) == 0
    assert main(["mesh", disc, "-o", str(solid), "--height", "5", "--quiet"]) == 0
    z = np.frombuffer(solid.read_bytes()[84:], np.dtype([("f", "<f4", (4, 3)), ("a", "<u2")]))["f"][:, 1:, 2]
    assert (z.min(), z.max()) == (0, 5)
    count = [struct.unpack("<I", p.read_bytes()[80:84])[0] for p in (flat, solid)]
    assert count[1] > 2 * count[0]


def test_colour_by_changes_the_figure(disc, tmp_path):
    drawn = []
    for colour in (["--colour-by", "quality"], ["--colour-by", "region"], ["--colour-by", "none"], []):
        path = tmp_path / f"{len(drawn)}.svg"
        assert main(["mesh", disc, "--edge-length", "6", "--quiet", "--plot", str(path), *colour]) == 0
        drawn.append(path.read_bytes())
    assert len(set(drawn)) == 3
    assert drawn[0] == drawn[3]


def test_the_figure_shows_the_part_that_was_meshed(disc, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr("img2tri.mesh.TriangleMesh.plot", lambda *given, **_: seen.append(given[1]))
    assert main(["mesh", disc, "--crop", "0,0,10,20", "--spacing", "0.5", "--quiet", "--plot", str(tmp_path / "figure.png")]) == 0
    assert np.array_equal(seen[0], specimens.disc(40, 15)[:, :20] * 255)


def test_the_figure_shows_the_page_that_was_meshed(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr("img2tri.mesh.TriangleMesh.plot", lambda *given, **_: seen.append(given[1]))
    pages = [specimens.disc(40, r) * np.uint8(255) for r in (10, 15)]
    path = tmp_path / "pages.tif"
    first, second = (Image.fromarray(p.astype(np.uint8)) for p in pages)
    first.save(path, save_all=True, append_images=[second])
    assert main(["mesh", str(path), "--page", "1", "--quiet", "--plot", str(tmp_path / "figure.png")]) == 0
    assert (seen[0] == pages[1]).all()


def test_quiet_says_nothing(disc, tmp_path, capsys):
    assert main(["mesh", disc, "-o", str(tmp_path / "a.stl"), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_without_a_file_to_write_it_says_so(disc, capsys):
    assert main(["mesh", disc]) == 0
    out, err = capsys.readouterr()
    assert "triangles" in out
    assert err == "img2tri: no file was asked for, none was written; -o mesh.stl writes one\n"


def test_broken_promises_are_warnings_with_their_place(disc, tmp_path, capsys):
    report = tmp_path / "report.json"
    assert main(["mesh", disc, "--recipe", "structured", "--edge-length", "6", "--quiet", "--report", str(report)]) == 0
    out, err = capsys.readouterr()
    warnings = json.loads(report.read_text())["warnings"]
    assert out == ""
    assert warnings
    assert err.splitlines() == [f"img2tri: warning: {disc}: {line}" for line in warnings]
    assert re.search(r"at \([\d.]+, [\d.]+\)", err)


def test_several_images_each_get_their_files(tmp_path, capsys):
    images = [_saved(specimens.disc(30, r) * 255, tmp_path / f"disc{r}.png") for r in (8, 12)]
    out = tmp_path / "out"
    out.mkdir()
    typed = ["-o", f"{out}/{{stem}}.stl", "-o", f"{out}/{{stem}}.ply", "--report", f"{out}/{{stem}}.json"]
    assert main(["mesh", *images, *typed]) == 0
    assert sorted(os.listdir(out)) == [f"disc{r}.{s}" for r in (12, 8) for s in ("json", "ply", "stl")]
    areas = [json.loads((out / f"disc{r}.json").read_text())["areas"]["1"]["image"] for r in (8, 12)]
    assert areas == [specimens.disc(30, r).sum() for r in (8, 12)]
    printed = capsys.readouterr().out
    assert all(f"{image}: " in printed for image in images)


def test_one_bad_file_does_not_stop_the_others(tmp_path, capsys):
    good = [_saved(specimens.disc(30, 8) * 255, tmp_path / f"{name}.png") for name in "ac"]
    bad = tmp_path / "b.png"
    bad.write_bytes(b"not an image")
    assert main(["mesh", good[0], str(bad), good[1], "-o", str(tmp_path / "{stem}.stl"), "--quiet"]) == 2
    assert sorted(p.name for p in tmp_path.glob("*.stl")) == ["a.stl", "c.stl"]
    why, summary = capsys.readouterr().err.splitlines()
    assert why == f"img2tri: {bad}: image: '{bad}' is not an image in a known format"
    assert summary == f"img2tri: 1 of 3 images failed: {bad}"


# ---- a folder for the results ----


@pytest.mark.parametrize("there", [False, True])
def test_a_folder_gets_a_file_of_each_format_for_each_image(there, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    images = [_saved(specimens.disc(30, r) * 255, tmp_path / f"disc{r}.png") for r in (8, 12)]
    if there:
        Path("out").mkdir()
    assert main(["mesh", *images, "--out-dir", "out", "--format", "stl", "--format", ".OBJ", "--format", "stl", "--quiet"]) == 0
    assert sorted(os.listdir("out")) == ["disc12.obj", "disc12.stl", "disc8.obj", "disc8.stl"]


def test_a_folder_gets_ply_if_no_format_is_named_beside_what_is_named(disc, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["mesh", disc, "--out-dir", "{stem}", "-o", "x_{stem}.stl"]) == 0
    assert sorted(p.as_posix() for p in Path().rglob("*.*")) == ["disc.png", "x_disc.stl", "{stem}/disc.ply"]
    assert "saved       x_disc.stl, {stem}/disc.ply" in capsys.readouterr().out.splitlines()


def test_names_that_collide_are_refused_before_any_image_is_read(arrived, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for folder in "ab":
        Path(folder).mkdir()
        _saved(specimens.disc(30, 8), Path(folder, "x.png"))
    assert main(["mesh", "a/x.png", "b/x.png", "--out-dir", "out"]) == 2
    assert _complaint(capsys) == ("img2tri: --out-dir: expected a file of its own, found 'out/x.ply', which is in use for 'a/x.png'\n")
    assert arrived == []
    assert not Path("out").exists()
    assert main(["mesh", "a/x.png", "b/x_facets.png", "--out-dir", "out", "--format", "xdmf"]) == 2
    assert "which is in use for 'a/x.png'" in _complaint(capsys)


def test_names_in_large_letters_collide_where_they_are_the_same(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    images = [_saved(specimens.disc(30, 8), tmp_path / name) for name in ("x.png", "X.png")]
    assert main(["mesh", *images, "--out-dir", "out", "--quiet"]) == 0
    assert sorted(os.listdir("out")) == ["X.ply", "x.ply"]
    monkeypatch.setattr(sys, "platform", "darwin")
    assert main(["mesh", *images, "--out-dir", "out", "--quiet"]) == 2
    assert "in use for" in _complaint(capsys)


def test_a_new_folder_without_results_goes_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["mesh", "none.png", "--out-dir", "out"]) == 2
    assert os.listdir() == []
    Path("old").mkdir()
    assert main(["mesh", "none.png", "--out-dir", "old"]) == 2
    assert os.listdir() == ["old"]


def test_an_older_file_is_replaced(disc, tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(b"old")
    assert main(["mesh", disc, "-o", str(path), "--quiet"]) == 0
    assert path.read_bytes().startswith(b"binary STL")


def test_quality_of_files(disc, tmp_path, capsys):
    paths = [str(tmp_path / name) for name in ("a.ply", "a.stl")]
    main(["mesh", disc, "--quiet", "-o", paths[0], "-o", paths[1]])
    assert main(["quality", *paths]) == 0
    out, err = capsys.readouterr()
    table = str(mesh_image(disc).quality()).partition("\n")[2]
    assert err == ""
    assert out.startswith(f"{paths[0]}: ")
    assert f"\n{paths[1]}: " in out
    assert out.count(table) >= 1


def test_quality_counts_triangles_that_are_turned_over(tmp_path, capsys):
    path = tmp_path / "a.off"
    path.write_text("OFF\n5 4 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n5 2 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n")
    assert main(["quality", str(path)]) == 0
    assert "1 turned over" in capsys.readouterr().out


def test_quality_measures_solids(disc, tmp_path, capsys):
    made = [("surface.stl", [], "surface of a solid"), ("wedges.msh", [], "wedge"), ("tetra.inp", ["--cells", "tetrahedra"], "tetra")]
    for name, typed, what in made:
        path = str(tmp_path / name)
        assert main(["mesh", disc, "--quiet", "--height", "2", "--edge-length", "6", "-o", path, *typed]) == 0
        assert main(["quality", path]) == 0
        out, err = capsys.readouterr()
        assert err == ""
        assert out.startswith(f"{path}: ")
        assert what in out.splitlines()[0]
        assert "0 <= z <= 2" in out.splitlines()[0]
        least = next(line for line in out.splitlines() if line.startswith("scaled_jacobian")).split()[1]
        assert 0 < float(least) <= 1


def test_a_bad_mesh_does_not_stop_the_others(disc, tmp_path, capsys):
    solid, flat = str(tmp_path / "solid.msh"), str(tmp_path / "flat.stl")
    Path(solid).write_text("no mesh")
    main(["mesh", disc, "--quiet", "-o", flat])
    assert main(["quality", solid, str(tmp_path / "none.stl"), flat]) == 2
    out, err = capsys.readouterr()
    assert out.startswith(f"{flat}: ")
    assert [line.split(":")[0] for line in err.splitlines()] == ["img2tri"] * 2
    assert solid in err
    assert "none.stl" in err


# ---- progress ----


class _Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("patience", "quiet", "shown"), [(0, False, True), (0, True, False), (1e9, False, False)])
def test_a_bar_is_shown_in_a_terminal_when_work_is_long(patience, quiet, shown, disc, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(printing, "PATIENCE", patience)
    monkeypatch.setattr(sys, "stderr", _Terminal())
    monkeypatch.setenv("TERM", "xterm")
    assert main(["mesh", disc, "-o", str(tmp_path / "a.stl"), *["--quiet"] * quiet]) == 0
    text = sys.stderr.getvalue()
    assert ("%" in text) == shown
    assert shown or text == ""
    assert "%" not in capsys.readouterr().out.replace("1 %", "").replace("99 %", "")


def test_the_bar_can_show_any_name(tmp_path, monkeypatch):
    monkeypatch.setattr(printing, "PATIENCE", 0)
    monkeypatch.setattr(sys, "stderr", _Terminal())
    images = [_saved(specimens.disc(20, 8) * 255, tmp_path / name) for name in ("[red]é[.png", "b.png")]
    assert main(["mesh", *images, "-o", str(tmp_path / "{stem}.stl"), "--quiet"]) == 0


# ---- bad input ----

BAD_OPTIONS = {
    "no command": ([], "COMMAND"),
    "unknown command": (["mash"], "'mash'"),
    "unknown option": (["mesh", "DISC", "--xyz"], "--xyz: there is no such option; see img2tri mesh --help"),
    "misspelt option": (["mesh", "DISC", "--edge-lenght", "8"], "--edge-lenght: there is no such option; did you mean --edge-length?; see"),
    "Python's name": (["mesh", "DISC", "--min_angle=25"], "--min_angle: there is no such option; did you mean --min-angle?"),
    "misspelt option of a page": (["view-report", "DISC", "-o", "a.html", "--lables"], "mean --labels?; see img2tri view-report --help"),
    "misspelt command": (["meshes", "DISC"], "'meshes': there is no such command; did you mean 'mesh'?; see img2tri --help"),
    "colour of too few digits": (["mesh", "DISC", "--labels=#xyz"], "--labels: expected a colour as in #dc2828, found '#xyz'"),
    "no image": (["mesh"], "IMAGE"),
    "iterations": (["mesh", "DISC", "--iterations", "ten"], "--iterations: expected a whole number, found 'ten'"),
    "min angle": (["mesh", "DISC", "--min-angle", "thirty"], "--min-angle: expected a number, found 'thirty'"),
    "labels": (["mesh", "DISC", "--labels=1,x"], "--labels: expected a whole number, found 'x'"),
    "background": (["mesh", "DISC", "--background", "white"], "--background: expected a whole number, found 'white'"),
    "spacing": (["mesh", "DISC", "--spacing", "1,x"], "--spacing: expected a number, found 'x'"),
    "edge lengths": (["mesh", "DISC", "--edge-length", "1=4,5"], "--edge-length: expected the number of a region"),
    "name": (["mesh", "DISC", "--name", "bone"], "--name: expected the number of a region, =, and what it gets"),
    "colour": (["mesh", "DISC", "--colour-by", "taste"], "--colour-by"),
}
BAD_INPUT = {
    "missing file": (["none.png"], "none.png"),
    "folder": (["FOLDER"], "is a folder without images"),
    "not an image": (["TEXT"], "not an image"),
    "truncated": (["TRUNCATED"], "truncated"),
    "black": (["BLACK"], "none"),
    "one value with otsu": (["BLACK", "--threshold", "otsu"], "'otsu' expected at least two values"),
    "too many pixels": (["DISC", "--max-pixels", "10"], "--max-pixels 10 "),
    "page": (["DISC", "--page", "1"], "--page: expected 0 to 0"),
    "recipe": (["DISC", "--recipe", "magic"], "--recipe: expected one of 'conforming', 'structured', 'unstructured', found 'magic'"),
    "edge length": (["DISC", "--edge-length", "-8"], "--edge-length: expected a number above 0"),
    "edge length 0": (["DISC", "--edge-length", "0px"], "--edge-length: expected a number above 0"),
    "edge length nan": (["DISC", "--edge-length", "nan"], "--edge-length: expected a number"),
    "unit": (["DISC", "--edge-length", "8mm"], "--edge-length: expected a number with a unit, like 8, '8px' or '2%', found '8mm'"),
    "spacing": (["DISC", "--spacing", "0"], "--spacing: expected a number above 0, found 0.0"),
    "no spacing in the file": (["DISC", "--spacing", "file"], "--spacing: 'file' expected a resolution"),
    "threshold": (["DISC", "--threshold", "high"], "--threshold: expected a number, 'otsu' or 'alpha', found 'high'"),
    "labels and threshold": (["DISC", "--labels", "--threshold", "3"], "--threshold: expected to be left out"),
    "label not there": (["DISC", "--labels", "9"], "--labels: expected values of the image, found 9"),
    "label is background": (["DISC", "--labels", "0,255"], "give --background none"),
    "pattern": (["nothing*.png"], "expected files that match 'nothing*.png', found none"),
    "names": (["DISC", "--name", "7=bone"], "--name: expected labels of the image, found 7"),
    "deck of an STL": (["DISC", "--deck"], "--deck: expected with a mesh that ends in .inp, found none"),
    "layers of nothing": (["DISC", "-o", "a.msh", "--layers", "2"], "--layers: expected with --height"),
    "version": (["DISC", "-o", "a.msh", "--msh-version", "3"], "--msh-version: expected"),
    "order": (["DISC", "-o", "a.msh", "--order", "3"], "--order: expected 1 or 2, found 3"),
    "options": (["DISC", "--options", "TEXT"], "'text.png': expected a report or options as JSON"),
    "height": (["DISC", "--height", "0"], "--height: expected a number above 0, found 0"),
    "height of a region": (["DISC", "--height", "1=0"], "height of 1: expected a number above 0, found 0"),
    "heights for solvers": (["DISC", "-o", "a.msh", "--height", "1=2"], "--height: expected one for solvers, found one for each region"),
    "base of a flat mesh": (["DISC", "-o", "a.stl", "--base", "2"], "--base: expected with --height, which makes a solid, found none"),
    "base for solvers": (["DISC", "-o", "a.msh", "--height", "2", "--base", "2"], "--base: expected with a mesh that ends in .stl"),
    "data for an STL": (["DISC", "-o", "a.stl", "--data", "T=DISC"], "--data: expected with a mesh that ends in .ply, .vtp"),
    "suffix": (["DISC", "-o", "a.dwg"], "a.dwg: expected a name that ends in .3mf, .bdf"),
    "suffix of the figure": (["DISC", "--plot", "a.stl"], "a.stl: expected a name that ends in .pdf, .png or .svg"),
    "suffix of the report": (["DISC", "--report", "a.txt"], "a.txt: expected a name that ends in .json"),
    "no folder": (["DISC", "-o", "none/a.stl"], "none/a.stl: expected an existing folder"),
    "one name twice": (["DISC", "-o", "a.stl", "-o", "./a.stl"], "-o: expected a file of its own, found './a.stl'"),
    "figure over the image": (["DISC", "--plot", "DISC"], "--plot: expected a file of its own"),
    "one name for two images": (["DISC", "BLACK", "-o", "a.stl"], "-o: expected a name with {stem} for 2 images, found 'a.stl'"),
    "two images of one name": (["DISC", "DISC", "-o", "{stem}.stl"], "in use for"),
    "no parent of the folder": (["DISC", "--out-dir", "none/out"], "--out-dir: expected a folder, or the name of one to be made, found"),
    "a file as folder": (["DISC", "--out-dir", "TEXT"], "expected an existing folder, found none at"),
    "format": (["DISC", "--out-dir", "out", "--format", "dwg"], "--format: expected one of 3mf, bdf, dxf, geojson, glb"),
    "format without a folder": (["DISC", "--format", "stl"], "--format: expected with --out-dir or -o -, found neither"),
    "one name in the folder and beside": (["DISC", "--out-dir", "out", "-o", "out/disc.ply"], "'out/disc.ply', which is in use for"),
    "image in the folder": (["DISC", "a.ply", "--out-dir", ".", "--format", "ply"], "found './a.ply', which is in use for 'a.ply'"),
    "workers": (["DISC", "--workers", "0"], "--workers: expected a whole number of at least 1, found 0"),
    "stdout without a format": (["DISC", "-o", "-"], "--format: expected one with -o -, as in --format stl, found none"),
    "stdout with two formats": (["DISC", "-o", "-", "--format", "stl", "--format", "ply"], "--format: expected one with -o -"),
    "stdout twice": (["DISC", "-o", "-", "-o", "-", "--format", "stl"], "-o -: expected once, and with one image, found 2 times"),
    "stdout for two images": (["DISC", "TEXT", "-o", "-", "--format", "stl"], "-o -: expected once, and with one image, found 2 images"),
    "stdout for several files": (["DISC", "-o", "-", "--format", "xdmf"], "-o -: expected a format of one file, found xdmf"),
    "stdin twice": (["-", "-"], "-: expected once, as stdin is read once, found 2 times"),
}


def _written(arguments, disc, tmp_path):
    """Put files in place of their names."""
    data = Path(disc).read_bytes()
    (tmp_path / "text.png").write_text("text")
    (tmp_path / "truncated.png").write_bytes(data[: len(data) // 2])
    _saved(np.zeros((9, 9)), tmp_path / "black.png")
    (tmp_path / "empty").mkdir()
    places = {"DISC": disc, "TEXT": "text.png", "TRUNCATED": "truncated.png", "BLACK": "black.png", "FOLDER": "empty"}
    return [places.get(a, a) for a in arguments]


@pytest.mark.parametrize("case", BAD_OPTIONS)
def test_options_that_cannot_be_understood(case, disc, tmp_path, capsys):
    arguments, text = BAD_OPTIONS[case]
    with pytest.raises(SystemExit) as stopped:
        main(_written(arguments, disc, tmp_path))
    assert stopped.value.code == 2
    line = _complaint(capsys)
    assert text in line
    assert line.rstrip().endswith("--help")


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input_is_one_line_and_leaves_no_file(case, disc, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments, text = BAD_INPUT[case]
    typed = _written(arguments, disc, tmp_path)
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    extra = [] if "-o" in typed else ["-o", "{stem}_out.stl"]
    folders = [p for p in tmp_path.rglob("*") if p.is_dir()]
    assert main(["mesh", *typed, *extra, "--quiet"]) == 2
    assert text in _complaint(capsys)
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before
    assert [p for p in tmp_path.rglob("*") if p.is_dir()] == folders


def test_names_of_files_are_checked_before_any_work(arrived, disc):
    assert main(["mesh", disc, "-o", "none/a.stl"]) == 2
    assert main(["mesh", disc, "--report", "a.txt"]) == 2
    assert arrived == []


def test_a_full_disk_leaves_the_older_file(disc, tmp_path, capsys, monkeypatch):
    path = tmp_path / "a.stl"
    path.write_bytes(b"old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert main(["mesh", disc, "-o", str(path)]) == 2
    assert "No space left" in _complaint(capsys)
    assert path.read_bytes() == b"old"
    assert sorted(os.listdir(tmp_path)) == ["a.stl", "disc.png"]


@pytest.mark.parametrize(
    ("raised", "status", "said"),
    [(KeyboardInterrupt, 130, ""), (MemoryError, 2, "img2tri: expected more memory than there is\n")],
)
def test_what_else_ends_the_work(raised, status, said, disc, tmp_path, monkeypatch, capsys):
    def stop(*_, **__):
        raise raised

    monkeypatch.setattr(pipeline, "mesh_image", stop)
    assert main(["mesh", disc, "-o", str(tmp_path / "a.stl")]) == status
    assert capsys.readouterr() == ("", said)
    assert os.listdir(tmp_path) == ["disc.png"]


def test_a_mistake_of_ours_is_not_hidden(disc, monkeypatch):
    def wrong(*_, **__):
        raise TypeError("wrong")

    monkeypatch.setattr(pipeline, "mesh_image", wrong)
    with pytest.raises(TypeError):
        main(["mesh", disc])


# ---- as a process ----


def test_help_answers_at_once():
    began = time.perf_counter()
    done = subprocess.run([sys.executable, "-X", "importtime", "-m", "img2tri", "--help"], capture_output=True, text=True, check=True)
    assert time.perf_counter() - began < 5
    assert done.stdout.startswith("usage: img2tri")
    imported = {line.rpartition("|")[2].strip().partition(".")[0] for line in done.stderr.splitlines() if line.startswith("import time:")}
    assert "argparse" in imported
    assert not imported & {"numpy", "scipy", "cv2", "PIL", "shapely", "igl", "pythoncdt", "trimesh", "pyvista", "matplotlib", "rich"}


def test_a_mask_to_stl_imports_only_what_it_needs(disc, tmp_path):
    code = "import sys; from img2tri.cli import main; main(sys.argv[1:]); print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    command = [sys.executable, "-c", code, "mesh", disc, "-o", str(tmp_path / "a.stl"), "--quiet"]
    imported = set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    assert not imported & {"trimesh", "pyvista", "vtkmodules", "matplotlib", "rich", "networkx", "lxml", "cv2", "tifffile"}


def test_a_run_as_a_process(disc, tmp_path):
    done = _process("mesh", disc, "-o", "a.vtu", "--edge-length", "5", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(load(tmp_path / "a.vtu")[1]) == len(mesh_image(disc, edge_length=5).triangles)


def test_a_failure_as_a_process(tmp_path):
    done = _process("mesh", "none.png", "-o", "a.vtu", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "img2tri: image: there is no file 'none.png'\n"
    assert os.listdir(tmp_path) == []


def test_a_reader_that_leaves_early_is_no_failure(disc):
    command = [sys.executable, "-m", "img2tri", "mesh", disc]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        assert "Traceback" not in process.stderr.read()
    assert process.returncode == 0


def test_version(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["--version"])
    assert stopped.value.code == 0
    assert re.fullmatch(r"img2tri \d+\.\d+\.\d+\n", capsys.readouterr().out)


def test_view_report_writes_one_page_that_needs_nothing_else(tmp_path, capsys):
    image, page = tmp_path / "disc.png", tmp_path / "disc.html"
    Image.fromarray((specimens.disc() * 255).astype(np.uint8)).save(image)
    assert main(["view-report", str(image), "-o", str(page), "--edge-length", "4"]) == 0
    text = page.read_text(encoding="utf-8")
    assert "http://" not in text
    assert "https://" not in text
    assert "--edge-length 4" in text
    assert "saved" in capsys.readouterr().out


def test_view_report_hands_on_units_and_says_what_is_not_kept(tmp_path, capsys):
    image, page = tmp_path / "a.png", tmp_path / "a.html"
    Image.fromarray(np.kron(np.tri(8, dtype=np.uint8), np.full((9, 9), 255, np.uint8))).save(image)
    options = ["--units", "um", "--spacing", "0.5", "--recipe", "structured", "--threshold", "9", "--step", "7"]
    assert main(["view-report", str(image), "-o", str(page), *options]) == 0
    packed = re.search(r'id="mesh">(.*?)<', page.read_text(encoding="utf-8"))[1]
    assert b'"unit": "um"' in zlib.decompress(base64.b64decode(packed))
    said = capsys.readouterr().err
    assert main(["mesh", str(image), *options, "--report", str(tmp_path / "a.json")]) == 0
    warned = [line for line in capsys.readouterr().err.splitlines() if "warning" in line]
    assert warned
    assert said.splitlines() == warned


def test_view_report_says_in_one_line_what_is_wrong(tmp_path, capsys):
    assert main(["view-report", str(tmp_path / "missing.png"), "-o", str(tmp_path / "page.html")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not list(tmp_path.iterdir())


# ---- stdin and stdout ----


def _stdin(monkeypatch, path, terminal=False):
    stream = io.TextIOWrapper(io.BytesIO(Path(path).read_bytes()))
    stream.isatty = lambda: terminal
    monkeypatch.setattr(sys, "stdin", stream)


def _piped(data, *arguments, **given):
    return subprocess.run(
        [sys.executable, "-m", "img2tri", *arguments], input=data, capture_output=True, check=False, timeout=PATIENCE, **given
    )


@pytest.mark.parametrize(("suffix", "more"), [("stl", ["--height", "5"]), ("ply", []), ("vtu", []), ("geojson", ["--edge-length", "5"])])
def test_from_stdin_to_stdout_are_the_bytes_of_the_file(suffix, more, disc, tmp_path, monkeypatch, capsysbinary):
    _stdin(monkeypatch, disc)
    assert main(["mesh", "-", "-o", "-", "--format", suffix, *more, "-o", str(tmp_path / "{stem}.ply")]) == 0
    out, err = capsysbinary.readouterr()
    _stdin(monkeypatch, disc)
    main(["mesh", "-", "-o", str(tmp_path / f"a.{suffix}"), *more, "--quiet"])
    assert out == (tmp_path / f"a.{suffix}").read_bytes()
    assert err.startswith(b"-: ")
    assert b"min_angle" in err
    assert sorted(os.listdir(tmp_path)) == sorted(["disc.png", "stdin.ply", f"a.{suffix}"])


def test_the_figure_of_an_image_on_stdin_shows_it(disc, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr("img2tri.mesh.TriangleMesh.plot", lambda *given, **_: seen.append(given[1:]))
    _stdin(monkeypatch, disc)
    assert main(["mesh", "-", "--quiet", "--plot", str(tmp_path / "{stem}.png")]) == 0
    assert (seen[0][0] == specimens.disc(40, 15) * 255).all()
    assert seen[0][1] == str(tmp_path / "stdin.png")


def test_stdin_to_stdout_as_processes(disc, tmp_path):
    data = Path(disc).read_bytes()
    done = _piped(data, "mesh", "-", "-o", "-", "--format", "stl", "--quiet", env=os.environ | {"TMPDIR": str(tmp_path)})
    assert main(["mesh", disc, "-o", str(tmp_path / "a.stl"), "--quiet"]) == 0
    assert (done.returncode, done.stdout, done.stderr) == (0, (tmp_path / "a.stl").read_bytes(), b"")
    assert sorted(os.listdir(tmp_path)) == ["a.stl", "disc.png"]
    judged = _piped(done.stdout, "quality", "-", "--format", "stl")
    assert (judged.returncode, judged.stderr) == (0, b"")
    assert judged.stdout.startswith(b"-: ")


def test_stdin_beside_files_and_workers(disc, tmp_path):
    other = _saved(specimens.disc(40, 12) * 255, tmp_path / "other.png")
    data, out = Path(disc).read_bytes(), tmp_path / "out"
    done = _piped(data, "mesh", other, "-", disc, "--out-dir", str(out), "--format", "stl", "--workers", "2")
    assert (done.returncode, done.stderr) == (0, b"")
    assert [line.partition(b": ")[0].decode() for line in done.stdout.splitlines() if b" triangles, " in line] == [other, "-", disc]
    assert (out / "stdin.stl").read_bytes() == (out / "disc.stl").read_bytes() != (out / "other.stl").read_bytes()
    done = _piped(b"", "mesh", other, "-", disc, "--out-dir", str(out), "--workers", "2", "--quiet")
    assert (done.returncode, done.stderr) == (2, b"img2tri: -: image: '<stdin>' is empty\nimg2tri: 1 of 3 images failed: -\n")


def test_stdin_without_end_is_refused():
    if not os.path.exists("/dev/zero"):
        pytest.skip("no /dev/zero")
    with open("/dev/zero", "rb") as zeros:
        command = [sys.executable, "-m", "img2tri", "mesh", "-", "--max-pixels", "100000"]
        done = subprocess.run(command, stdin=zeros, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 2
    assert "expected at most 1848576 bytes, 8 for each of --max-pixels 100000, found more in '<stdin>'" in done.stderr


def test_max_pixels_holds_for_stdin(disc, monkeypatch, capsys):
    _stdin(monkeypatch, disc)
    assert main(["mesh", "-", "--max-pixels", "1599", "-o", "-", "--format", "ply"]) == 2
    assert "expected at most --max-pixels 1599 pixels, found 40 x 40 in" in _complaint(capsys)
    _stdin(monkeypatch, disc)
    assert main(["mesh", "-", "--max-pixels", "1600", "-o", "-", "--format", "off", "--quiet"]) == 0


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["mesh", "-"], "-: expected bytes on stdin, found a terminal; send a file there"),
        (["view-report", "-", "-o", "-"], "-: expected bytes on stdin, found a terminal"),
        (["quality", "-", "--format", "stl"], "-: expected bytes on stdin, found a terminal"),
    ],
)
def test_a_terminal_gives_no_image(typed, said, disc, monkeypatch, capsys):
    _stdin(monkeypatch, disc, terminal=True)
    assert main(typed) == 2
    assert said in _complaint(capsys)


def test_no_stdin_and_no_stdout(disc, monkeypatch, capsys):
    monkeypatch.setattr(sys, "stdin", None)
    assert main(["mesh", "-"]) == 2
    assert "-: expected bytes on stdin, found it closed" in _complaint(capsys)
    monkeypatch.setattr(sys, "stdout", None)
    assert main(["mesh", disc, "-o", "-", "--format", "stl"]) == 2
    assert "-o -: expected a file or a pipe on stdout, found it closed" in _complaint(capsys)


def test_without_stderr_stdout_stays_clean(disc, monkeypatch, capsysbinary):
    monkeypatch.setattr(sys, "stderr", None)
    assert main(["mesh", disc, "-o", "-", "--format", "stl"]) == 0
    data = capsysbinary.readouterr().out
    assert len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")


def test_a_terminal_is_not_sent_bytes(disc, monkeypatch, capsys):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert main(["mesh", disc, "-o", "-", "--format", "stl"]) == 2
    assert "-o -: expected a file or a pipe on stdout, found a terminal" in _complaint(capsys)
    assert main(["mesh", disc, "-o", "-", "--format", "obj", "--quiet"]) == 0
    assert "\nv " in capsys.readouterr().out


def test_a_mesh_that_fails_sends_nothing(disc, capsys):
    assert main(["mesh", disc, "--origin=1e8,0", "--edge-length", "4", "-o", "-", "--format", "stl"]) == 2
    assert _complaint(capsys).startswith("img2tri: -: holds coordinates as float32")


def test_a_reader_of_a_mesh_that_leaves_early_is_no_failure(disc):
    command = [sys.executable, "-m", "img2tri", "mesh", disc, "-o", "-", "--format", "stl", "--quiet"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 0


@pytest.mark.parametrize("typed", [["-o", "-", "--format", "stl"], []])
def test_a_full_disk_behind_stdout_is_one_line(typed, disc):
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full")
    with open("/dev/full", "wb") as full:
        command = [sys.executable, "-m", "img2tri", "mesh", disc, *typed]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == "img2tri: stdout: cannot be written: No space left on device"
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr


def test_no_folder_for_a_moment(disc, monkeypatch, capsys):
    def refuse(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("img2tri.cli.stdin_stdout.TemporaryDirectory", refuse)
    assert main(["mesh", disc, "-o", "-", "--format", "stl"]) == 2
    assert "-: cannot be held for a moment: Permission denied; TMPDIR" in _complaint(capsys)


def test_view_report_from_stdin_to_stdout(disc, tmp_path, monkeypatch, capsys):
    page = tmp_path / "page.html"
    _stdin(monkeypatch, disc)
    assert main(["view-report", "-", "-o", "-", "--edge-length", "5"]) == 0
    out, err = capsys.readouterr()
    _stdin(monkeypatch, disc)
    assert main(["view-report", "-", "-o", str(page), "--edge-length", "5"]) == 0
    assert out.replace("-o -", "") == page.read_text(encoding="utf-8").replace(f"-o {page}", "")
    assert "<title>stdin" in out
    assert err.startswith("-: ")


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["-"], "--format: expected with a mesh on stdin, and with nothing else, found none"),
        (["a.stl", "--format", "stl"], "--format: expected with a mesh on stdin, and with nothing else, found stl"),
        (["-", "-", "--format", "stl"], "-: expected once, as stdin is read once, found 2 times"),
        (["-", "--format", "dwg"], "-: expected a name that ends in .3mf, .bdf"),
        (["-", "--format", "ply"], "-: cannot be read as .ply"),
    ],
)
def test_quality_of_what_is_no_mesh_on_stdin(typed, said, disc, monkeypatch, capsys):
    _stdin(monkeypatch, disc)
    assert main(["quality", *typed]) == 2
    assert said in _complaint(capsys)


def test_confetti_is_told_of_with_the_option_that_helps(tmp_path, capsys):
    noise = np.random.default_rng(0).random((150, 150)) < 0.3
    Image.fromarray(noise.astype(np.uint8) * 255).save(tmp_path / "noise.png")
    stages = []
    mesh_image(noise, edge_length=8, progress=lambda stage, _: stages.append(stage))
    assert any(re.fullmatch(r"spacing \d,\d\d\d outlines; min_area would drop specks", stage) for stage in stages)
    assert main(["mesh", str(tmp_path / "noise.png"), "--edge-length", "8", "-o", str(tmp_path / "a.stl")]) == 0
    assert re.search(r"chosen .*; \d,\d\d\d outlines, of which --min-area 20px2 would drop specks", capsys.readouterr().out)
    assert main(["mesh", str(tmp_path / "noise.png"), "--edge-length", "8", "--min-area", "20px2", "-o", str(tmp_path / "a.stl")]) == 0
    assert "specks" not in capsys.readouterr().out
