from __future__ import annotations

import json
import shlex
import threading

import numpy as np
import pytest
import specimens

import img2tri
from img2tri.app import downloads, knobs
from img2tri.app.app_page import own
from img2tri.app.image_facts import describe
from img2tri.app.session import OvertakenError, Session
from img2tri.cli.arguments import parse
from img2tri.errors import ImageError, MeshError, ParameterError
from img2tri.options import reproducing
from img2tri.options.all_options import OPTIONS
from img2tri.raster.reading import read

DISC = np.hypot(*np.mgrid[-30:30, -30:30] + 0.5) < 22
GRAY = np.clip(200 - 6 * np.hypot(*np.mgrid[-30:30, -30:30] + 0.5), 0, 255).astype(np.uint8)


def unpacked(data):
    """Head and arrays of what a session hands out."""
    size = int.from_bytes(data[:4], "little")
    head, at, arrays = json.loads(data[4 : 4 + size]), -(-(4 + size) // 8) * 8, {}
    for name, kind, length in head["arrays"]:
        arrays[name] = np.frombuffer(data, "<" + kind, length, at)
        at += -(-arrays[name].nbytes // 8) * 8
    assert at == len(data)
    return head, arrays


def test_a_wish_is_the_mesh_of_mesh_image():
    session = Session(GRAY, name="a.png")
    head, arrays = unpacked(session.wish({"threshold": "90", "edge_length": "5", "corners": ""}, number=1))
    mesh = img2tri.mesh_image(GRAY, threshold=90, edge_length=5)
    assert np.array_equal(session.mesh.vertices, mesh.vertices)
    assert np.array_equal(arrays["triangles"].reshape(-1, 3), mesh.triangles)
    rows, columns = mesh.frame.row_column(mesh.vertices)
    assert arrays["vertices"].reshape(-1, 2) == pytest.approx(np.stack([columns, rows], axis=1), abs=1e-4)
    assert session.options == {"threshold": 90.0, "edge_length": 5.0}
    assert head["python"] == "mesh = img2tri.mesh_image('a.png', edge_length=5, threshold=90)" or "threshold=90" in head["python"]
    assert head["preview"] is False


@pytest.mark.parametrize("name", sorted(set(OPTIONS) - {"max_pixels"}))
def test_every_option_has_a_knob(name):
    listed = {knob["name"] for knob in knobs.knobs()}
    assert name in listed or name in knobs._OWN
    if name in knobs._OWN - {"labels", "background", "names"}:
        assert f'data-knob="{name}"' in own("knobs.html")


@pytest.mark.parametrize(("name", "choices"), knobs.CHOICES.items())
def test_what_a_knob_offers_is_taken(name, choices):
    for choice in choices:
        assert knobs.values({name: choice})[name] is not None
    with pytest.raises(ParameterError, match=name):
        Session(DISC).wish({name: "9"}, number=1)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"edge_length": 8.0, "threshold": 90.0},
        {"edge_length": {1: 4.0, 2: "8px"}, "labels": [1, 2], "names": {1: "bone", 2: "my 'own'"}},
        {"labels": True, "background": None, "min_area": "20px2", "largest": True},
        {"keep_area": False, "origin": [-5.0, -5.0], "spacing": [0.5, 0.25], "crop": [0.0, 0.0, 10.0, 12.5]},
        {"threshold": -3.5, "invert": True, "connectivity": 8, "corners": "keep", "seed": 7, "units": "mm"},
        {"recipe": "unstructured", "n_boundary_points": 40, "min_distance": "3px", "smoothing": "uniform", "iterations": 3},
        {"labels": [-2, 5], "periodic": "xy", "interior": "poisson", "tolerance": "0.25px", "gradation": 0.3},
    ],
)
def test_the_command_and_the_python_say_the_same_options(given):
    typed = parse(shlex.split(reproducing.command("my file.png", given))[1:])
    assert typed.images == ["my file.png"]
    found = {name: knobs._checked(name, value) for name, value in vars(typed).items() if name in OPTIONS}
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in found.items()}
    wanted = {name: knobs._checked(name, value) for name, value in given.items()}
    if isinstance(plain.get("edge_length"), dict):
        plain["edge_length"] = {label: knobs._checked("edge_length", length) for label, length in plain["edge_length"].items()}
    assert plain == wanted
    said = {}
    exec(reproducing.python("my file.png", given).replace("img2tri.mesh_image", "said"), {"said": lambda image, **options: options}, said)
    assert said["mesh"] == wanted


def test_options_that_are_no_plain_data_are_named():
    field = np.full(DISC.shape, 5.0)
    session = Session(DISC, options={"edge_length": field})
    head, _ = unpacked(session.wish({}, number=1))
    assert "edge_length=..." in head["python"]
    assert session.options["edge_length"] is field
    assert "edge_length" not in unpacked(session.facts())[0]["base"]


def test_the_last_wish_wins():
    session, ended, started = Session(DISC), [], threading.Event()
    held = session._still_wanted

    def watched(number):
        if number == 1:
            started.set()
            threading.Event().wait(0.02)
        held(number)

    session._still_wanted = watched

    def first():
        try:
            session.wish({"edge_length": 2}, number=1)
        except OvertakenError:
            ended.append(1)

    thread = threading.Thread(target=first)
    thread.start()
    started.wait(10)
    session.wish({"edge_length": 6}, number=2)
    thread.join(20)
    assert ended == [1]
    assert session.options == {"edge_length": 6}
    with pytest.raises(OvertakenError):
        session.wish({}, number=1)


def test_a_preview_is_what_is_seen_and_is_not_kept():
    session = Session(np.ones((80, 120), bool))
    session.wish({"edge_length": "8"}, number=1)
    kept = session.mesh
    head, arrays = unpacked(session.wish({"edge_length": "4"}, number=2, window=(-50.0, 20.0, 40.0, 500.0)))
    assert head["preview"] is True
    assert session.mesh is kept
    xy = arrays["vertices"].reshape(-1, 2)
    assert [*xy.min(axis=0), *xy.max(axis=0)] == pytest.approx([0, 0, 40, 60], abs=1e-4)  # y down, where it lies on the whole image
    with pytest.raises(ParameterError, match="crop: expected a part of the image"):
        session.wish({}, number=3, window=(200.0, 0.0, 300.0, 10.0))


def test_errors_are_those_of_the_library():
    session = Session(DISC)
    for given, words in [
        ({"min_angle": "40"}, "min_angle: expected"),
        ({"edge_lenght": "4"}, "did you mean 'edge_length'"),
        ({"seed": "x"}, "seed: expected a whole"),
    ]:
        with pytest.raises(ParameterError, match=words):
            session.wish(given, number=1)
    with pytest.raises(ImageError):
        session.load(np.zeros((2, 2, 7)), "bad")
    assert session.name == "image"  # the one before stays
    with pytest.raises(MeshError, match="expected one that was made"):
        session.certificate()
    with pytest.raises(ParameterError, match="max_pixels"):
        session.wish({"max_pixels": "9"}, number=2)


def test_the_certificate_is_that_of_the_mesh():
    session = Session(DISC, name="disc.png")
    session.wish({"names": {"1": "<bone>"}}, number=1)
    said = session.certificate()
    assert "every promise kept" in said["pieces"]["verdict"]
    assert "&lt;bone&gt;" in said["pieces"]["regions"]
    assert {place["first"] for place in said["places"]} == {False}


def test_a_wish_ends_the_certificate_of_the_mesh_before():
    session = Session(DISC)
    session.wish({}, number=1)
    session._newest = 2  # a wish has come
    assert session.certificate()["pieces"]["verdict"]  # asked for after it: of the mesh there is
    session.wish({"edge_length": "5"}, number=3)
    held = session._still_wanted

    def overtaken(number):
        session._newest = 4
        held(number)

    session._still_wanted = overtaken
    with pytest.raises(OvertakenError):
        session.certificate()
    session._still_wanted = held
    assert session.certificate()["pieces"]["verdict"]
    assert session.mesh.report.to_json() == img2tri.mesh_image(DISC, edge_length=5.0).report.to_json()


@pytest.mark.parametrize("kind", downloads.ALL_KINDS)
def test_every_format_is_downloaded(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    session = Session(DISC, name="some/disc.png")
    session.wish({"edge_length": "8"}, number=1)
    name, data = session.download(kind)
    assert name == "disc" + kind.removeprefix("figure") + (".zip" if kind == ".xdmf" else "")
    assert len(data) > 80
    if kind in downloads.WITH_HEIGHT:
        assert session.download(kind, height=3.0)[1] != data
    else:
        with pytest.raises(ParameterError, match="height"):
            session.download(kind, height=3.0)
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_format_is_refused():
    session = Session(DISC)
    session.wish({}, number=1)
    with pytest.raises(ParameterError, match="format: expected one of"):
        session.download("../../etc/passwd")


def test_what_the_library_notes_is_handed_on():
    noise = (np.random.default_rng(0).random((60, 60)) > 0.5) * np.uint8(255)
    session = Session(noise)
    head, _ = unpacked(session.wish({}, number=1))  # pieces that touch at corners: a warning, which would be an error in these tests
    assert head["notes"] == session.mesh.origin.notes
    assert any("connectivity=8" in note for note in head["notes"])


def test_an_image_is_described():
    facts = describe(read(GRAY), "a", "mm").head
    assert (facts["kind"], facts["pixels"], facts["least"], facts["most"]) == ("gray", [60, 60], int(GRAY.min()), int(GRAY.max()))
    assert facts["otsu"] == img2tri.mesh_image(GRAY).origin.settings["threshold"]
    assert sum(facts["counts"]) == GRAY.size
    assert describe(read(DISC), "a", "").head["kind"] == "mask"
    assert describe(read(specimens.polycrystal(60, 12)), "a", "").head["kind"] == "labels"
    colours = np.stack([specimens.polycrystal(60, 12) * 20, np.full((60, 60), 9), np.zeros((60, 60), int)], axis=2).astype(np.uint8)
    assert describe(read(colours), "a", "").head["kind"] == "labels"
    assert len(describe(read(colours), "a", "").head["labels"]) == 12
    assert describe(read(GRAY.astype(float) / 7), "a", "").head["labels"] is None


@pytest.mark.parametrize("level", [60, 90.5, 199])
def test_codes_tell_which_pixels_are_above_a_threshold(level):
    found = describe(read(GRAY), "a", "")
    values = found.head["least"] + found.codes["gray"] * found.head["level_step"]
    assert np.array_equal(values > level, GRAY > level)


def test_codes_of_labels_and_large_images():
    labels = specimens.polycrystal(60, 12)
    found = describe(read(labels), "a", "")
    assert np.array_equal(np.array(found.head["labels"])[found.codes["labels"], 0], labels)
    large = describe(read(np.kron(GRAY, np.ones((1, 100), np.uint8))), "a", "")
    assert large.head["step"] == 3
    assert large.codes["gray"].shape == (20, 2000)
    assert sum(large.head["counts"]) == pytest.approx(60 * 6000, rel=0.01)
