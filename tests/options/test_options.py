"""Every option is written once: what users, editors, the command line and reports know of it comes from its entry."""

from __future__ import annotations

import inspect
import json

import numpy as np
import pytest
import specimens
from PIL import Image

from img2tri import mesh_image
from img2tri.cli import main
from img2tri.errors import FileError, Img2triError, ParameterError
from img2tri.options import OPTIONS
from img2tri.options.all_options import GROUPS, HEADINGS, MeshOptions, checked, load_options, of, takes_none

DISC = specimens.disc(40, 15).astype(bool)
GRAINS = np.repeat(np.repeat(np.array([[1, 2], [3, 1]]), 20, axis=0), 20, axis=1)


def same(one, other):
    return one.vertices.tobytes() == other.vertices.tobytes() and one.triangles.tobytes() == other.triangles.tobytes()


def test_a_name_is_in_one_group():
    names = [name for groups in HEADINGS.values() for group in groups for name in group.__annotations__]
    assert sorted(names) == sorted(set(names)) == sorted(MeshOptions.__annotations__) == sorted(OPTIONS)
    assert set(OPTIONS) == {name for group in GROUPS.values() for name in group}


def test_the_signature_that_help_shows_is_that_of_the_entries():
    parameters = inspect.signature(mesh_image).parameters
    assert [name for name in parameters if name in OPTIONS] == list(OPTIONS)
    assert set(parameters) == {"image", *OPTIONS, "progress"}
    assert all(parameters[name].default == option.default for name, option in OPTIONS.items())
    assert all(parameters[name].kind is inspect.Parameter.KEYWORD_ONLY for name in OPTIONS)


@pytest.mark.parametrize("name", OPTIONS)
def test_an_option_is_described(name):
    option = OPTIONS[name]
    assert option.words[0].isupper() or option.words[0] == '"' or option.words.startswith("True")
    assert option.words.endswith(".")
    assert bool(option.none) == (option.default is None), "what None means is said where it is the default"
    assert f"\n    {name} : " in inspect.getdoc(mesh_image).replace("\n", "\n    ")
    if isinstance(option.default, bool):
        return
    assert option.sign, "stands for the value in the help of the command line"


@pytest.mark.parametrize("name", OPTIONS)
def test_a_default_passes_its_own_check(name):
    option = OPTIONS[name]
    assert option.default is None or option.check(name, option.default) == option.default
    assert option.default is not None or takes_none(name)


# ---- what is refused ----


@pytest.mark.parametrize(("typo", "meant"), [("edge_lenght", "edge_length"), ("label", "labels"), ("minangle", "min_angle"),
                                             ("progres", "progress")])  # fmt: skip
def test_a_misspelt_option_is_answered_with_the_nearest(typo, meant):
    with pytest.raises(TypeError, match=f"unexpected keyword argument '{typo}'; did you mean '{meant}'") as raised:
        mesh_image(DISC, **{typo: 1})
    assert isinstance(raised.value, Img2triError)


def test_what_is_like_no_option_is_refused_without_a_guess():
    with pytest.raises(TypeError, match="'zzz'$"):
        mesh_image(DISC, zzz=1)


def test_progress_has_to_be_callable():
    with pytest.raises(ParameterError, match="progress: expected what can be called with a stage and a fraction, found 'bar'"):
        mesh_image(DISC, progress="bar")


def test_an_option_of_another_recipe_is_refused():
    with pytest.raises(ParameterError, match="step: not an option of recipe 'conforming'; leave it out, or choose structured"):
        mesh_image(DISC, step=5)


def test_options_are_refused_before_the_image_is_read():
    with pytest.raises(ParameterError, match="^tolerance: "):
        mesh_image("no such file.png", tolerance=-1)


# ---- a mesh can be made again from its report ----

AGAIN = {
    "defaults": (DISC, {}),
    "lengths by label, names": (GRAINS, {"labels": True, "edge_length": {1: 4, 2: "8px"}, "names": {1: "bone", 3: "ring"}}),
    "labels from an iterator": (GRAINS, {"labels": iter([3, 1]), "background": None}),
    "numpy numbers": (GRAINS, {"labels": np.array([1, 2]), "edge_length": np.float32(3.3), "seed": np.int64(3)}),
    "where it lies": (DISC, {"origin": (5, -3), "spacing": (0.5, 0.7), "crop": (6, -2, 20, 20), "units": "cm"}),
    "gray": ((specimens.disc(40, 15) * 200).astype(float), {"threshold": 90, "min_area": "20px2", "largest": True}),
    "poisson": (DISC, {"interior": "poisson", "seed": 4, "smoothing": "cotangent"}),
    "grid": (DISC * 255, {"recipe": "structured", "step": "7px"}),
    "scattered": (DISC * 255, {"recipe": "unstructured", "n_boundary_points": 20, "iterations": 3}),
}


@pytest.mark.parametrize("name", AGAIN)
def test_the_options_of_a_report_make_the_same_mesh(name, tmp_path):
    image, options = AGAIN[name]
    mesh = mesh_image(image, **options)
    kept = mesh.report.options
    assert set(kept) == set(OPTIONS)
    again = mesh_image(image, **kept)
    assert same(again, mesh)
    assert again.report.to_json() == mesh.report.to_json()

    (tmp_path / "report.json").write_text(mesh.report.to_json())
    told = load_options(tmp_path / "report.json")
    assert told == json.loads(json.dumps(kept), object_hook=lambda d: {int(k) if k.isdigit() else k: v for k, v in d.items()})
    assert same(mesh_image(image, **told), mesh)


def test_the_page_is_among_the_options(tmp_path):
    first, second = (Image.fromarray((specimens.disc(30, r) * 255).astype(np.uint8)) for r in (6, 11))
    path = tmp_path / "pages.tif"
    first.save(path, save_all=True, append_images=[second])
    mesh = mesh_image(path, page=1)
    assert mesh.report.options["page"] == 1
    assert same(mesh_image(path, **mesh.report.options), mesh)


FIELDS = {"array": np.full(DISC.shape, 3.0), "function": lambda places: np.full(len(places), 3.0)}


@pytest.mark.parametrize("kind", FIELDS)
def test_of_a_field_there_is_the_hash(kind):
    report = mesh_image(DISC, edge_length=FIELDS[kind]).report
    kept = report.options["edge_length"]
    assert kept["field"].startswith(kind)
    assert len(kept["sha256"]) == 64
    other = mesh_image(DISC, edge_length=lambda places: 3 + 0.1 * abs(places[:, 0])).report.options["edge_length"]
    assert other["sha256"] != kept["sha256"]
    with pytest.raises(ParameterError, match="edge_length: expected lengths, found the hash of a field"):
        mesh_image(DISC, **report.options)
    assert mesh_image(DISC, **report.options | {"edge_length": FIELDS[kind]}).report.options == report.options


def test_the_command_line_makes_a_mesh_again_and_what_is_typed_wins(tmp_path):
    image, report = tmp_path / "grains.png", tmp_path / "report.json"
    Image.fromarray(GRAINS.astype(np.uint8)).save(image)
    options = ["--labels", "1,2", "--edge-length", "1=3,2=5px", "--name", "1=bone"]
    assert main(["mesh", str(image), *options, "-o", str(tmp_path / "one.ply"), "--report", str(report), "--quiet"]) == 0
    assert main(["mesh", str(image), "--options", str(report), "-o", str(tmp_path / "two.ply"), "--quiet"]) == 0
    assert (tmp_path / "one.ply").read_bytes() == (tmp_path / "two.ply").read_bytes()
    typed = ["--edge-length", "9", "--report", str(tmp_path / "other.json")]
    assert main(["mesh", str(image), "--options", str(report), *typed, "--quiet"]) == 0
    other = json.loads((tmp_path / "other.json").read_text())["options"]
    before = json.loads(report.read_text())["options"]
    assert other == before | {"edge_length": 9}


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"a": 1}', '{"options": 3}', "no json"])
def test_a_file_without_options_is_refused(text, tmp_path):
    path = tmp_path / "report.json"
    path.write_text(text)
    with pytest.raises(FileError, match="expected a report or options as JSON"):
        load_options(path)
    with pytest.raises(FileError):
        load_options(tmp_path / "nothing.json")


def test_a_stage_gets_its_group():
    from img2tri.options.mesh_options import SizeOptions

    group = of(SizeOptions, checked({"gradation": 0.5}))
    assert set(group) == set(SizeOptions.__annotations__)
    assert group["gradation"] == 0.5
