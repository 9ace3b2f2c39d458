"""Readers and writers as pyvista finds them, by entry points, in a process that does not import img2tri."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, entry_points, version
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from views.solver_meshes import KINDS, made

import img2tri
from img2tri.errors import FileError, MeshError
from img2tri.views.formats.solvers.bdf import bdf
from img2tri.views.formats.solvers.inp import inp
from img2tri.views.formats.solvers.msh import msh
from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid
from img2tri.views.formats.solvers.xdmf import xdmf
from img2tri.views.objects.solver_cells import flat_cells
from img2tri.views.plugin import readers_writers as plugins

PROJECT = Path(img2tri.__file__).parents[1] / "pyproject.toml"
READERS = {
    ".msh": (plugins.read_msh, msh), ".bdf": (plugins.read_bdf, bdf), ".inp": (plugins.read_inp, inp), ".xdmf": (plugins.read_xdmf, xdmf),
}  # fmt: skip
OVERRIDES = {".inp", ".xdmf"}
AVS = """# of another world
3 1 0 0 0
1 0 0 0
2 1 0 0
3 0 1 0
1 7 tri 1 2 3
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Run Python with img2tri as if it were installed: where it is not, with the metadata that pyproject.toml makes."""
    path = [str(PROJECT.parent)]
    try:
        version("img2tri")
    except PackageNotFoundError:
        if not PROJECT.exists():
            pytest.skip("img2tri is not installed, nor is there a pyproject.toml")
        groups = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["entry-points"]
        folder = tmp_path_factory.mktemp("site") / "img2tri-0.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: img2tri\nVersion: 0\n")
        lines = [line for group, points in groups.items() for line in (f"[{group}]", *(f"{k} = {v}" for k, v in points.items()))]
        (folder / "entry_points.txt").write_text("\n".join(lines) + "\n")
        path.insert(0, str(folder.parent))

    def run(code, cwd, *program):
        setup = f"import sys; sys.path[:0] = {path!r}; "
        done = subprocess.run(
            [sys.executable, "-W", "error", *(program or ("-c", setup + code))],
            cwd=cwd, capture_output=True, text=True, check=False, env=None,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def test_the_accessor_is_there_on_both_kinds_of_object_and_loads_nothing_before(installed, tmp_path):
    code = """
import numpy as np, pyvista as pv
image = pv.ImageData(dimensions=(40, 30, 1), spacing=(0.5, 0.5, 1), origin=(5, 6, 7))
image["labels"] = np.repeat([1, 2], 600)
assert "img2tri" not in sys.modules
assert "img2tri" in dir(image)
mesh = image.img2tri.mesh(edge_length="4px", labels=True)
assert isinstance(mesh, pv.PolyData) and set(mesh["region"].tolist()) == {1, 2}
assert np.allclose(mesh.bounds, (4.75, 24.75, 5.75, 20.75, 7, 7)), mesh.bounds
assert mesh.img2tri.smooth("cotangent").n_cells == mesh.n_cells
assert mesh.img2tri.quality().summary()["min_angle"]["min"] > 30
print("done")
"""
    assert installed(code, tmp_path).split() == ["done"]


def test_files_are_written_and_read_by_their_suffix(installed, tmp_path):
    (tmp_path / "a.msh").write_bytes(msh(made("triangle"))[""])
    (tmp_path / "avs.inp").write_text(AVS)
    (tmp_path / "untimed.xdmf").write_bytes(xdmf(made("triangle"))[""])
    code = """
import numpy as np, pyvista as pv
assert pv.read("avs.inp")["Material Id"].tolist() == [7]
assert pv.get_reader("avs.inp").read().n_cells == 1
grid = pv.read("a.msh")
assert np.array_equal(np.sort(pv.read("untimed.xdmf")["region"]), grid["region"])
assert set(grid.field_data.keys()) >= {"left", "hole_1", "bone", "region_-1__bone"}
for suffix in (".msh", ".inp", ".bdf", ".xdmf"):
    grid.save("b" + suffix)
    grid.extract_surface(algorithm=None).save("c" + suffix)
    for stem in "bc":
        back = pv.read(stem + suffix)
        assert back.n_cells == grid.n_cells and np.allclose(back.points, grid.points)
        assert np.array_equal(np.sort(back["region"]), np.sort(grid["region"]))
    assert set(back.field_data.keys()) >= {"left", "hole_1", "region_-1__bone"}, suffix
grid.save("old.msh", version="2.2")
grid.save("deck.inp", deck=True, plane="strain")
print(*sorted(r.extension + "!" * r.override for r in pv.registered_readers()), *sorted(w.extension for w in pv.registered_writers()))
"""
    found = installed(code, tmp_path).split()
    assert {".bdf", ".msh", ".inp!", ".xdmf!"} <= set(found[:-5])
    assert set(found[-5:]) == {".bdf", ".inp", ".mesh", ".msh", ".xdmf"}
    assert b"2.2 0 8" in (tmp_path / "old.msh").read_bytes()
    assert b"TYPE=CPE3" in (tmp_path / "deck.inp").read_bytes()
    assert b"*NSET, NSET=region_minus1__bone" in (tmp_path / "b.inp").read_bytes()
    assert (tmp_path / "b_facets.xdmf").exists()


def test_pyvista_convert_knows_them(installed, tmp_path):
    (tmp_path / "a.msh").write_bytes(msh(made("wedge15"))[""])
    code = """
from pyvista.__main__ import main
sys.argv = ["pyvista", "convert", "a.msh", "b.bdf"]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
"""
    installed(code, tmp_path)
    assert (tmp_path / "b.bdf").read_bytes().count(b"CPENTA") == 68


def test_entry_points_lead_to_what_is_there():
    if not PROJECT.exists():
        pytest.skip("only where the sources are checked out")
    groups = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["entry-points"]
    assert groups["pyvista.accessors"] == {"img2tri": "img2tri.views.plugin.accessor"}  # pyvista wants a bare module
    for group in ("pyvista.readers", "pyvista.readers.override", "pyvista.writers"):
        for value in groups[group].values():
            module, _, name = value.partition(":")
            assert module == "img2tri.views.plugin.readers_writers"
            assert callable(getattr(plugins, name))


def test_only_what_pyvista_reads_wrongly_is_taken_over():
    from pyvista.core.utilities.reader import CLASS_READERS

    own = {point.name for point in entry_points(group="pyvista.readers") if point.value.startswith("img2tri.")}
    assert not (own | set(READERS) - OVERRIDES) & set(CLASS_READERS)
    assert set(CLASS_READERS) >= OVERRIDES
    built_in = {suffix for kind in (pv.PolyData, pv.UnstructuredGrid, pv.ImageData) for suffix in kind._WRITERS}
    assert not {".msh", ".inp", ".bdf", ".xdmf"} & built_in


def rows(grid, name):
    """The facets of a set in one order; a whole may be put together of its pieces."""
    return np.unique(np.asarray(grid.field_data[name]), axis=0)


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_read_is_what_was_written(tmp_path, kind, suffix):
    read, write = READERS[suffix]
    mesh = made(kind)
    for ending, data in write(mesh).items():
        (tmp_path / f"a{ending}{suffix}").write_bytes(data)
    grid, expected = read(str(tmp_path / f"a{suffix}")), to_grid(mesh, texts=False)
    assert grid.celltypes.tolist() == expected.celltypes.tolist()
    order = np.argsort(mesh.regions, kind="stable") if suffix == ".msh" else slice(None)  # which has the cells by region
    assert np.array_equal(grid.cell_connectivity.reshape(mesh.cells.shape), mesh.cells[order])
    assert np.allclose(grid.points, expected.points, rtol=1e-9)
    assert np.array_equal(grid.cell_data["region"], expected.cell_data["region"][order])
    assert set(grid.field_data.keys()) == set(expected.field_data.keys())
    if suffix != ".bdf":  # which has sets of nodes only
        assert all(np.array_equal(rows(grid, name), rows(expected, name)) for name in expected.field_data)


def test_xdmf_with_a_time_is_read_as_without_one(tmp_path):
    for folder, timed in (("with", True), ("without", False)):
        (tmp_path / folder).mkdir()
        for ending, data in xdmf(made("triangle"), timed=timed).items():
            (tmp_path / folder / f"a{ending}.xdmf").write_bytes(data)
    one, other = (plugins.read_xdmf(str(tmp_path / folder / "a.xdmf")) for folder in ("with", "without"))
    assert one.n_cells > 0
    assert set(one.field_data.keys()) == set(other.field_data.keys()) >= {"left", "bone"}
    assert np.array_equal(one["region"], other["region"])
    facets = plugins.read_xdmf(str(tmp_path / "without" / "a_facets.xdmf"))  # for itself it is what it is
    assert set(facets["boundary"].tolist()) == {1001, 1003, 1005, 1011, 1012, 1013}
    (tmp_path / "without" / "a_facets.xdmf").write_bytes(xdmf(flat_cells([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]))["_facets"])
    assert "left" not in plugins.read_xdmf(str(tmp_path / "without" / "a.xdmf")).field_data  # facets of another mesh


def test_inp_of_avs_is_still_read_as_pyvista_does(tmp_path):
    (tmp_path / "a.inp").write_text(AVS)
    grid = plugins.read_inp(str(tmp_path / "a.inp"))
    assert grid.n_cells == 1
    assert grid["Material Id"].tolist() == [7]


WING = """*Heading
 of another program
*Node, nset=all
 7, 0, 0, 2
 8, 1., 0, 2
 9, 0, 1.e0, 2
*Element, type=S3R, elset=Wing
 3, 7, 8, 9
*Nset, nset=Tip
 9,
*Surface, name=Rim
 3, S2
*Surface, name=Face
 Wing, SPOS
"""


def test_inp_of_others_is_read_where_there_is_no_meshio(tmp_path, monkeypatch):
    monkeypatch.setattr(plugins, "find_spec", lambda name: None)
    (tmp_path / "a.inp").write_bytes(WING.replace("\n", "\r\n").encode())
    grid = plugins.read_inp(str(tmp_path / "a.inp"))
    assert grid.points.tolist() == [[0, 0, 2], [1, 0, 2], [0, 1, 2]]
    assert grid["region"].tolist() == [1]
    assert {name: grid.field_data[name].tolist() for name in grid.field_data} == {"Wing": [1], "Tip": [2], "Rim": [[1, 2]]}
    for old, new, found in (("S3R", "S4R", "found others"), ("9,\n", "6,\n", "not there"), ("*Element", "*Old", "found none")):
        (tmp_path / "a.inp").write_text(WING.replace(old, new))
        with pytest.raises(FileError, match=found):
            plugins.read_inp(str(tmp_path / "a.inp"))


def test_names_that_did_not_fit_come_back_from_inp(tmp_path):
    names = {-3: "Kn\u00f6chel, \u2113inks", 2: "bone" * 30}
    square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]
    mesh = flat_cells(*square, [-3, 2], names=names)
    for deck in (False, True):
        (tmp_path / "a.inp").write_bytes(inp(mesh, deck=deck)[""])
        grid, expected = plugins.read_inp(str(tmp_path / "a.inp")), to_grid(mesh)
        assert grid["region"].tolist() == [-3, 2]
        assert set(grid.field_data.keys()) - {"HELD", "DRAWN"} == set(expected.field_data.keys())


QUADS = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 1 2 3 3 1 2
2 3 2 7 7 1 2 3 4
$EndElements
"""


def test_files_of_others_are_left_to_meshio_where_it_is(tmp_path):
    (tmp_path / "a.msh").write_text(QUADS)
    grid = plugins.read_msh(str(tmp_path / "a.msh"))
    assert grid.celltypes.tolist() == [3, 9]
    assert grid["gmsh:physical"].tolist() == [3, 7]


def test_files_of_others_are_read_here_where_there_is_no_meshio(tmp_path, monkeypatch):
    monkeypatch.setattr(plugins, "find_spec", lambda name: None)
    (tmp_path / "a.msh").write_text(QUADS)
    with pytest.raises(FileError, match=r"a\.msh: expected cells that are all triangles, .*; with meshio installed"):
        plugins.read_msh(str(tmp_path / "a.msh"))
    (tmp_path / "a.msh").write_text(QUADS.replace("2 3 2 7 7 1 2 3 4", "2 2 2 7 7 1 2 3"))
    assert plugins.read_msh(str(tmp_path / "a.msh"))["region"].tolist() == [7]
    (tmp_path / "a.bdf").write_text("nothing\n")
    with pytest.raises(FileError, match=r"a\.bdf: expected cells .* found none; with meshio"):
        plugins.read_bdf(str(tmp_path / "a.bdf"))


def test_a_damaged_file_is_named(tmp_path):
    data = msh(made("triangle"))[""]
    (tmp_path / "a.msh").write_bytes(data[: data.index(b"$Elements")])
    with pytest.raises(FileError, match=r"a\.msh: it is damaged, or of another kind$"):
        plugins.read_msh(str(tmp_path / "a.msh"))


def test_what_lies_elsewhere_is_fetched_by_pyvista_first():
    from pyvista.core.utilities.reader_registry import LocalFileRequiredError

    for suffix, (read, _) in READERS.items():
        with pytest.raises(LocalFileRequiredError):
            read(f"https://example.org/a{suffix}")


def test_what_cannot_be_written_is_refused_and_leaves_no_file(tmp_path):
    for write in (plugins.write_msh, plugins.write_inp, plugins.write_bdf, plugins.write_xdmf):
        with pytest.raises(MeshError, match="expected triangles in a plane"):
            write(pv.Sphere(), str(tmp_path / f"a.{write.__name__[6:]}"))
    assert not list(tmp_path.iterdir())
