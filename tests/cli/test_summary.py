"""A table of many images: a row each, true to the meshes; what is whole is skipped, what changed is made again."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import specimens
from PIL import Image

from img2tri import mesh_image
from img2tri.cli import main
from img2tri.cli.summary_table import COLUMNS


@pytest.fixture
def scans(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("scans").mkdir()
    for k, radius in enumerate((8, 10, 12)):
        Image.fromarray((specimens.disc(30, radius) * 255).astype(np.uint8)).save(f"scans/s{k}.png")
    Path("scans/t.png").write_bytes(b"not an image")
    return ["mesh", "scans", "--out-dir", "out", "--summary", "table.csv"]


def rows(path="table.csv"):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_row_for_each_image_and_one_line_on_screen(scans, capsys, workers):
    assert main([*scans, "--workers", workers, "--edge-length", "4"]) == 2
    table = rows()
    assert tuple(table[0]) == COLUMNS
    assert [row["image"] for row in table] == [os.path.join("scans", name) for name in ("s0.png", "s1.png", "s2.png", "t.png")]
    for row in table[:3]:
        mesh = mesh_image(row["image"], edge_length=4)
        assert (int(row["triangles"]), int(row["vertices"])) == (len(mesh.triangles), len(mesh.vertices))
        assert float(row["min_angle"]) == mesh.report.smallest_angle
        assert float(row["mean_q"]) == pytest.approx(mesh.quality().summary()["q"]["mean"])
        assert float(row["area"]) == pytest.approx(mesh.report.areas[1]["mesh"])
        assert float(row["distance"]) == mesh.report.hausdorff
        assert row["kept"] == "True"
        assert float(row["seconds"]) > 0
        assert (row["status"], row["files"]) == ("whole", os.path.join("out", Path(row["image"]).stem + ".ply"))
        assert float(row["threshold"]) == 127.5
    assert table[3]["status"] == "failed"
    assert "not an image" in table[3]["problem"]
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 3
    assert all("triangles" in line and "worst angle" in line for line in out.splitlines())
    assert err.splitlines()[-1] == f"img2tri: 1 of 4 images failed: {os.path.join('scans', 't.png')}"


def made_at():
    return {path.name: path.stat().st_mtime_ns for path in Path("out").iterdir()}


def test_what_is_whole_is_skipped_and_what_changed_is_made_again(scans, capsys):
    main(scans)
    first, bytes_of = made_at(), {path.name: path.read_bytes() for path in Path("out").iterdir()}
    capsys.readouterr()

    assert main([*scans, "--resume"]) == 2  # t.png still fails
    assert made_at() == first
    out, _ = capsys.readouterr()
    assert out.count("whole, as it was made before") == 3
    assert [row["status"] for row in rows()] == ["whole"] * 3 + ["failed"]

    Image.fromarray((specimens.disc(30, 9) * 255).astype(np.uint8)).save("scans/s0.png")  # other bytes
    Path("out/s1.ply").write_bytes(bytes_of["s1.ply"][:100])  # cut short
    Image.fromarray((specimens.disc(30, 5) * 255).astype(np.uint8)).save("scans/t.png")  # an image now
    assert main([*scans, "--resume"]) == 0
    second = made_at()
    assert second["s2.ply"] == first["s2.ply"]
    assert second["s0.ply"] != first["s0.ply"]
    assert Path("out/s0.ply").read_bytes() != bytes_of["s0.ply"]
    assert Path("out/s1.ply").read_bytes() == bytes_of["s1.ply"]
    assert sorted(row["image"] for row in rows()) == sorted(map(str, Path("scans").iterdir()))
    assert {row["status"] for row in rows()} == {"whole"}

    assert main([*scans, "--resume", "--edge-length", "3"]) == 0  # other options
    assert all(made_at()[name] != second[name] for name in second)
    third = made_at()
    assert main([*scans, "--edge-length", "3"]) == 0  # without --resume all is made
    assert all(made_at()[name] != third[name] for name in third)


def test_an_interrupted_run_goes_on_where_it_ended(scans, monkeypatch):
    from img2tri import pipeline

    Path("scans/t.png").unlink()
    wholly = pipeline.mesh_image

    def until(image, **given):
        if str(image).endswith("s2.png"):
            raise KeyboardInterrupt
        return wholly(image, **given)

    monkeypatch.setattr(pipeline, "mesh_image", until)
    assert main(scans) == 130
    assert [Path(row["image"]).name for row in rows()] == ["s0.png", "s1.png"]
    with open("table.csv", "a", encoding="utf-8") as file:
        file.write("scans/s2.png,whole,,12")  # a row cut short
    before = made_at()
    monkeypatch.setattr(pipeline, "mesh_image", wholly)
    assert main([*scans, "--resume"]) == 0
    assert {name: time for name, time in made_at().items() if name != "s2.ply"} == before
    assert [Path(row["image"]).name for row in rows()] == ["s0.png", "s1.png", "s2.png"]


def test_a_parquet_table(scans):
    parquet = pytest.importorskip("pyarrow.parquet")
    scans[-1] = "table.parquet"
    assert main(scans) == 2
    table = parquet.read_table("table.parquet").to_pylist()
    assert [row["status"] for row in table] == ["whole"] * 3 + ["failed"]
    assert table[0]["triangles"] == len(mesh_image("scans/s0.png").triangles)
    first = made_at()
    assert main([*scans, "--resume"]) == 2
    assert made_at() == first


@pytest.mark.usefixtures("scans")
def test_tables_that_cannot_be(capsys):
    for typed, text in (
        (["mesh", "scans/s0.png", "--resume"], "--resume: expected with --summary"),
        (["mesh", "scans/s0.png", "--summary", "table.txt"], "table.txt: expected a name that ends in .csv or .parquet"),
        (["mesh", "scans/s0.png", "--summary", "none/table.csv"], "expected an existing folder"),
    ):
        assert main(typed) == 2
        assert text in capsys.readouterr().err
