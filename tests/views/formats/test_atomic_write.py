from __future__ import annotations

import errno
import os
import stat
import sys

import pytest
from views.plates import ring

from img2tri.errors import FileError, MeshError
from img2tri.views.formats import atomic_write as storing
from img2tri.views.formats import save_load as files
from img2tri.views.formats.atomic_write import store, writable
from img2tri.views.formats.save_load import SURFACE_FORMATS, Format, save

OLD = b"the old file, whole"


@pytest.fixture
def old(tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(OLD)
    return path


def assert_untouched(old):
    assert old.read_bytes() == OLD
    assert list(old.parent.iterdir()) == [old]


def test_an_older_file_is_replaced_and_nothing_else_is_left(old):
    save(old, *ring())
    assert old.read_bytes()[:6] == b"binary"
    assert list(old.parent.iterdir()) == [old]


def test_a_writer_that_fails_leaves_the_old_file(old, monkeypatch):
    def fail(_made):
        raise RuntimeError("half-way")

    monkeypatch.setitem(files.SURFACE_FORMATS, ".stl", Format(fail, None))
    with pytest.raises(RuntimeError, match="half-way"):
        save(old, *ring())
    assert_untouched(old)


def test_a_mesh_that_is_none_leaves_the_old_file(old):
    with pytest.raises(MeshError):
        save(old, [[0, 0]], [[0, 1, 2]])
    assert_untouched(old)


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_system_that_refuses_leaves_the_old_file(old, monkeypatch, step):
    def fail(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(storing.os, step, fail)
    with pytest.raises(FileError, match=r"a\.stl: cannot be written: No space left on device"):
        save(old, *ring())
    assert_untouched(old)


def test_an_interrupt_leaves_the_old_file(old, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(storing.os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        save(old, *ring())
    assert_untouched(old)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit on the size of files")
def test_a_full_disk_leaves_the_old_file(old):
    import resource

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(FileError, match="File too large"):
            save(old, *ring())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert_untouched(old)


def test_an_unknown_suffix_lists_the_known_ones(tmp_path):
    known = r"expected a name that ends in \.3mf, \.glb, \.obj, \.off, \.ply, \.stl, \.vtp or \.vtu"
    for name, found in (("a.dwg", "'.dwg'"), ("stl", "'no suffix'")):
        with pytest.raises(FileError, match=f"{known}, found {found}"):
            save(tmp_path / name, *ring())


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(FileError, match=r"none/a\.stl: expected an existing folder, found none at .*none; make it first"):
        save(tmp_path / "none" / "a.stl", *ring())


@pytest.mark.parametrize("lacking", ["O_TMPFILE", "/proc/self/fd", "support of the folder"])
def test_without_files_that_have_no_name_it_works_alike(old, monkeypatch, lacking):
    old.chmod(0o640)
    if lacking == "O_TMPFILE":
        monkeypatch.delattr(storing.os, "O_TMPFILE", raising=False)
    elif lacking == "/proc/self/fd":
        monkeypatch.setattr(storing.os.path, "isdir", lambda path: path != lacking and os.stat(path) and True)
    else:

        def refuse(*_):
            raise OSError(errno.EOPNOTSUPP, "Operation not supported")

        monkeypatch.setattr(storing.os, "open", refuse)
    store(old, b"new")
    assert old.read_bytes() == b"new"
    assert stat.S_IMODE(old.stat().st_mode) == 0o640
    assert list(old.parent.iterdir()) == [old]


def test_a_file_in_place_of_the_folder_is_named(tmp_path):
    (tmp_path / "plain").write_text("")
    with pytest.raises(FileError, match=r"plain/a\.stl: expected an existing folder"):
        save(tmp_path / "plain" / "a.stl", *ring())


def test_a_folder_one_may_not_write_to_is_named(tmp_path, monkeypatch):
    # root may write anywhere, so the answer of the system is played.
    monkeypatch.setattr(storing.os, "access", lambda path, _mode: path != tmp_path)
    with pytest.raises(FileError, match=r"a\.stl: expected a folder one may write to, found .*, where this is not allowed"):
        save(tmp_path / "a.stl", *ring())


def test_a_read_only_file_is_not_replaced(old, monkeypatch):
    monkeypatch.setattr(storing.os, "access", lambda path, _mode: path != old)
    with pytest.raises(FileError, match="expected a file one may write to, found one that is read-only"):
        save(old, *ring())
    assert_untouched(old)


def test_a_folder_or_device_of_that_name_is_not_replaced(tmp_path):
    (tmp_path / "a.stl").mkdir()
    with pytest.raises(FileError, match="expected a file or a new name, found a folder"):
        save(tmp_path / "a.stl", *ring())
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "b.stl")
        with pytest.raises(FileError, match="found a device"):
            save(tmp_path / "b.stl", *ring())


def test_a_link_is_followed(tmp_path):
    (tmp_path / "real").mkdir()
    link = tmp_path / "a.stl"
    link.symlink_to(tmp_path / "real" / "b.stl")
    save(link, *ring())
    assert link.is_symlink()
    assert (tmp_path / "real" / "b.stl").read_bytes()[:6] == b"binary"


def test_permissions_are_those_of_the_older_file_or_of_any_new_one(old):
    old.chmod(0o640)
    save(old, *ring())
    assert stat.S_IMODE(old.stat().st_mode) == 0o640
    save(old.with_name("b.stl"), *ring())
    old.with_name("c.stl").touch()
    assert old.with_name("b.stl").stat().st_mode == old.with_name("c.stl").stat().st_mode


def test_names_with_spaces_and_letters_of_any_kind(tmp_path):
    path = tmp_path / "fémur gauche · 左.stl"
    save(path, *ring())
    assert path.stat().st_size == 84 + 50 * 24


def test_store_writes_what_it_is_given(tmp_path):
    store(writable(tmp_path / "a.json", [".json"]), b"{}")
    assert (tmp_path / "a.json").read_bytes() == b"{}"
    assert ".json" not in SURFACE_FORMATS
