"""Files for solvers by suffix: options where they belong, whole files or none, the same bytes each time."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np
import pytest
from views.solver_meshes import KINDS, TEXTS, made

from img2tri.errors import FileError, ParameterError
from img2tri.views.formats.save_load import load
from img2tri.views.formats.solvers.save_for_solvers import EXPORTS, export

OPTIONS = {"version": ("2.2", "4.1"), "deck": (True, False), "plane": ("strain", "stress"), "timed": (True, False)}


def bytes_of(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.mark.parametrize("suffix", EXPORTS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_format_takes_every_kind(tmp_path, kind, suffix):
    if suffix == ".mesh" and kind not in ("triangle", "tetra"):
        with pytest.raises(ParameterError, match=rf"cells: expected triangles or tetrahedra of first order for .mesh, found {kind}"):
            export(tmp_path / f"plate{suffix}", made(kind))
        return
    export(tmp_path / f"plate{suffix}", made(kind))
    names = {f"plate{suffix}"} | ({"plate_facets.xdmf"} if suffix == ".xdmf" else set())
    names |= {"plate_ends.xdmf"} if suffix == ".xdmf" and kind.startswith("wedge") else set()
    assert set(bytes_of(tmp_path)) == names


def test_a_mesh_without_sets_has_no_file_of_facets(tmp_path):
    mesh = made("triangle")
    export(tmp_path / "a.xdmf", type(mesh)(**{**vars(mesh), "sides": {}, "tags": {}, "part_of": {}, "between": {}}))
    assert list(bytes_of(tmp_path)) == ["a.xdmf"]


@pytest.mark.parametrize("suffix", EXPORTS)
@pytest.mark.parametrize("name", OPTIONS)
def test_an_option_changes_the_format_that_knows_it_and_is_refused_by_others(tmp_path, suffix, name):
    other, usual = OPTIONS[name]
    mesh, path = made("triangle"), tmp_path / f"a{suffix}"
    if name not in EXPORTS[suffix].options:
        with pytest.raises(ParameterError, match=rf"{name}: expected only with \.\w+, found {other!r} for .*a\{suffix}"):
            export(path, mesh, **{name: other})
        assert not bytes_of(tmp_path)
        return
    export(path, mesh)
    plain = bytes_of(tmp_path)
    export(path, mesh, **{name: usual})
    assert bytes_of(tmp_path) == plain
    export(path, mesh, **{name: other})
    assert bytes_of(tmp_path) != plain


def test_unknown_suffixes_and_places_are_refused(tmp_path):
    with pytest.raises(FileError, match=r"ends in \.bdf, \.inp, \.mesh, \.msh, \.vtkhdf, \.vtu or \.xdmf, found '\.stl'"):
        export(tmp_path / "a.stl", made("triangle"))
    with pytest.raises(FileError, match="expected an existing folder"):
        export(tmp_path / "none" / "a.msh", made("triangle"))


def test_an_older_file_stays_whole_if_the_disk_refuses(tmp_path, monkeypatch):
    export(tmp_path / "a.xdmf", made("triangle"))
    before = bytes_of(tmp_path)
    real, written = os.replace, []

    def replace(source, target):
        written.append(os.path.basename(target))
        if written[-1] == "a.xdmf":
            raise OSError(28, "No space left on device")
        real(source, target)

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(FileError, match=r"a\.xdmf: cannot be written: No space left"):
        export(tmp_path / "a.xdmf", made("triangle", names={4: "other"}))
    assert written == ["a_facets.xdmf", "a.xdmf"]  # the one that was asked for comes last
    after = bytes_of(tmp_path)
    assert set(after) == set(before)
    assert after["a.xdmf"] == before["a.xdmf"]


def test_the_same_mesh_gives_the_same_bytes_at_any_time_in_any_process(tmp_path):
    code = """
from views.solver_meshes import KINDS, made
from img2tri.views.formats.solvers.save_for_solvers import EXPORTS, export
for suffix in EXPORTS:
    for kind in KINDS:
        if suffix != ".mesh" or kind in ("triangle", "tetra"):
            export(f"{folder}/{kind}{suffix}", made(kind))
"""
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    path = [entry for entry in sys.path if entry]
    subprocess.run([sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}; folder = {str(there)!r}\n{code}"], check=True)
    time.sleep(1.1)
    exec(code, {"folder": str(here)})
    assert len(bytes_of(here)) == len(EXPORTS) * len(KINDS) - 4 + 6 + 2
    assert bytes_of(here) == bytes_of(there)


@pytest.mark.parametrize("suffix", EXPORTS)
def test_texts_are_in_every_file(tmp_path, suffix):
    export(tmp_path / f"a{suffix}", made("triangle"))
    data = bytes_of(tmp_path)[f"a{suffix}"]
    assert b"units" in data
    assert TEXTS["img2tri"][:8].encode() in data


@pytest.mark.parametrize("suffix", [".msh", ".bdf", ".vtu"])
def test_triangles_come_back_by_load(tmp_path, suffix):
    mesh = made("triangle")
    export(tmp_path / f"a{suffix}", mesh)
    vertices, triangles, regions = load(tmp_path / f"a{suffix}")
    assert vertices == pytest.approx(mesh.points[:, :2], rel=1e-9)
    order = np.argsort(mesh.regions, kind="stable") if suffix == ".msh" else slice(None)
    assert np.array_equal(triangles, mesh.cells[order])
    assert np.array_equal(regions, mesh.regions[order])


@pytest.mark.parametrize("suffix", [".msh", ".bdf"])
def test_load_says_what_it_cannot_read(tmp_path, suffix):
    export(tmp_path / f"a{suffix}", made("triangle6"))
    with pytest.raises(ValueError, match="expected triangles of three nodes, found triangle6"):
        load(tmp_path / f"a{suffix}")
    export(tmp_path / f"a{suffix}", made("triangle"))
    whole = (tmp_path / f"a{suffix}").read_bytes()
    (tmp_path / f"a{suffix}").write_bytes(whole[: len(whole) // 3])
    with pytest.raises((FileError, ValueError), match=rf"a\{suffix}: "):
        load(tmp_path / f"a{suffix}")
