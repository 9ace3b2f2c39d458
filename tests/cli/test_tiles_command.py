"""``img2tri tiles``: a mesh in parts, words about it, and errors with status 2."""

from __future__ import annotations

import numpy as np

from img2tri.cli import main


def test_a_mesh_in_parts_is_saved_and_told_about(tmp_path, capsys):
    np.save(tmp_path / "disc.npy", np.hypot(*np.mgrid[-40:40, -40:40] + 0.5) < 30)
    assert main(["tiles", str(tmp_path / "disc.npy"), "-o", str(tmp_path / "disc.pvtu"), "--edge-length", "6"]) == 0
    assert (tmp_path / "disc.pvtu").exists()
    assert "all of them fit" in capsys.readouterr().out


def test_what_is_wrong_is_one_line_and_status_2(tmp_path, capsys):
    assert main(["tiles", str(tmp_path / "none.npy"), "-o", str(tmp_path / "mesh.zarr")]) == 2
    assert "no such file" in capsys.readouterr().err
    np.save(tmp_path / "disc.npy", np.ones((9, 9), bool))
    both = ["--workers", "2", "--scheduler", "tcp://127.0.0.1:1"]
    assert main(["tiles", str(tmp_path / "disc.npy"), "-o", str(tmp_path / "mesh.zarr"), *both]) == 2
    assert "--scheduler" in capsys.readouterr().err
