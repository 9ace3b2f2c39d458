"""Named sets in files of other programs are kept: read, found beside those we name, and written again."""

from __future__ import annotations

import subprocess
import sys
import warnings

import meshio
import numpy as np
import pytest
from views.plates import cells

import img2tri
from img2tri import Img2triWarning, MeshError, TriangleMesh
from img2tri.views.objects.sets.known_edges import sides_of

VERTICES, TRIANGLES = cells(np.ones((2, 3), bool))
REGIONS = np.where(VERTICES[TRIANGLES].mean(axis=1)[:, 0] < 1, 1, 2)
INLET, WALL = [[0, 4], [4, 8]], [[0, 1], [1, 2], [2, 3]]  # left, and bottom
CRACK = [[5, 6]]  # inside of a region
SETS = {"inlet": INLET, "wall": WALL, "crack": CRACK}
GROUPS = {"inlet": [11, 1], "wall": [12, 1], "crack": [13, 1], "soft": [1, 2], "hard": [2, 2]}

INP = """*HEADING
by hand
*NODE
{nodes}
*ELEMENT, TYPE=CPS3
{elements}
*ELEMENT, TYPE=T3D2, ELSET=lines
101, 1, 5
102, 5, 9
103, 6, 7
*ELSET, ELSET=soft, GENERATE
1, 2, 1
7, 8, 1
*ELSET, ELSET=hard
3, 4, 5, 6, 9, 10
11, 12
*ELSET, ELSET=inlet
101, 102
*ELSET, ELSET=crack
103
*NSET, NSET=wall, GENERATE
1, 4
*NSET, NSET=middle
6
*ELSET, ELSET=above
7, 9, 11
*SURFACE, NAME=roof, TYPE=ELEMENT
{roof}
"""


def keys(edges):
    return {tuple(sorted(edge)) for edge in np.asarray(edges).tolist()}


def check(mesh, sets=SETS, regions=("soft", "hard")):
    found = mesh.sets()
    assert {name: keys(found.edges[name]) for name in sets} == {name: keys(edges) for name, edges in sets.items()}
    assert {name: len(found.regions[name]) for name in regions} == {"soft": 4, "hard": 8}
    taken = [tuple(sorted(edge)) for name, edges in found.edges.items() if name not in found.part_of for edge in edges.tolist()]
    assert len(taken) == len(set(taken))  # no edge in two sets
    free = keys(TriangleMesh(VERTICES, TRIANGLES, np.ones(12, int)).sets().edges["outer"])
    assert free <= set(taken)  # and none of the boundary in no set


def by_meshio(path):
    lines = np.concatenate([INLET, WALL, CRACK])
    groups = [np.repeat([11, 12, 13], [2, 3, 1]), REGIONS]
    fields = {name: np.array(group) for name, group in GROUPS.items()}
    data = {"gmsh:physical": groups, "gmsh:geometrical": groups}
    meshio.Mesh(
        VERTICES, [("line", lines), ("triangle", TRIANGLES)], cell_data=data, field_data={n: np.array(v) for n, v in fields.items()}
    ).write(path, file_format="gmsh22", binary=False)


def test_groups_of_a_msh_are_kept_and_written_again(tmp_path):
    by_meshio(tmp_path / "a.msh")
    mesh = img2tri.load(tmp_path / "a.msh")
    check(mesh)
    assert mesh.edge_sets.keys() == SETS.keys()
    assert "left" not in mesh.sets().edges  # there is no image
    for suffix in (".msh", ".inp", ".xdmf", ".mesh", ".vtu", ".vtkhdf"):
        mesh.save(tmp_path / f"b{suffix}")
        check(img2tri.load(tmp_path / f"b{suffix}"))
    mesh.save(tmp_path / "c.msh", order=2)
    check(img2tri.load(tmp_path / "c.msh"))


def test_sets_of_an_inp_are_kept(tmp_path):
    nodes = "\n".join(f"{i}, {x}, {y}" for i, (x, y) in enumerate(VERTICES.tolist(), 1))
    elements = "\n".join(f"{i}, {a}, {b}, {c}" for i, (a, b, c) in enumerate((TRIANGLES + 1).tolist(), 1))
    top = [(i, k) for i, t in enumerate(TRIANGLES) for k in range(3) if (VERTICES[t[[k, (k + 1) % 3]], 1] == 2).all()]
    text = INP.format(nodes=nodes, elements=elements, roof="\n".join(f"{i + 1}, S{k + 1}" for i, k in top)).replace(
        "*ELSET, ELSET=above\n7, 9, 11\n", ""
    )
    (tmp_path / "a.inp").write_text(text)
    with pytest.warns(Img2triWarning, match="sets: expected edges of triangles, found others in middle, for which"):
        mesh = img2tri.load(tmp_path / "a.inp")
    check(mesh, SETS | {"roof": [[8, 9], [9, 10], [10, 11]]})


def test_overlapping_sets_are_pieces_or_the_first_has_the_edge():
    sets = {"all": [*INLET, *WALL], "wall": WALL, "corner": [[0, 4], [5, 6]]}
    mesh = TriangleMesh(VERTICES, TRIANGLES, REGIONS, edge_sets={name: np.array(edges) for name, edges in sets.items()})
    found = mesh.sets()
    assert found.part_of["wall"] == "all"
    assert "corner" not in found.part_of
    assert keys(found.edges["all"]) == keys(sets["all"])
    assert keys(found.edges["corner"]) == {(5, 6)}


def test_edges_of_no_triangle_are_an_error():
    with pytest.raises(MeshError, match="inlet: expected edges of triangles, found 1 others"):
        sides_of(TRIANGLES, np.full(36, -1), REGIONS, np.array([[0, 11]]), "inlet")


def test_our_own_files_have_no_other_sets_than_before(tmp_path):
    mesh = img2tri.mesh_image(np.hypot(*np.mgrid[-9:9, -9:9]) < 7, edge_length=3, names={1: 'a "b"'})
    for suffix in (".msh", ".inp", ".bdf", ".xdmf", ".mesh", ".vtu", ".vtkhdf"):
        mesh.save(tmp_path / f"a{suffix}")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert img2tri.load(tmp_path / f"a{suffix}").edge_sets == {}


@pytest.mark.tools
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("suffix", [".msh", ".inp"])
def test_groups_that_gmsh_writes_are_kept(tmp_path, version, suffix):
    """A rectangle of 3 by 2 in two halves, meshed by Gmsh."""
    pytest.importorskip("gmsh", reason="gmsh is not installed")
    code = f"""
import gmsh
gmsh.initialize(interruptible=False); gmsh.option.setNumber("General.Terminal", 0)
g = gmsh.model.occ
g.fragment([(2, g.addRectangle(0, 0, 0, 1, 2))], [(2, g.addRectangle(1, 0, 0, 2, 2))]); g.synchronize()
lines = {{}}
for _, tag in gmsh.model.getEntities(1):
    x, y, _ = gmsh.model.occ.getCenterOfMass(1, tag)
    lines.setdefault("inlet" if x == 0 else "wall" if y == 0 else "", []).append(tag)
for name in ("inlet", "wall"):
    gmsh.model.addPhysicalGroup(1, lines[name], name=name)
for _, tag in gmsh.model.getEntities(2):
    gmsh.model.addPhysicalGroup(2, [tag], name="soft" if gmsh.model.occ.getCenterOfMass(2, tag)[0] < 1 else "hard")
gmsh.model.mesh.generate(2)
gmsh.option.setNumber("Mesh.MshFileVersion", {version}); gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 0)
gmsh.write("a{suffix}"); gmsh.finalize()
"""
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    mesh = img2tri.load(tmp_path / f"a{suffix}")
    found = mesh.sets()
    length = {name: np.linalg.norm(np.diff(mesh.vertices[rows], axis=1), axis=2).sum() for name, rows in found.edges.items()}
    area = {name: TriangleMesh(mesh.vertices, mesh.triangles[rows], mesh.regions[rows]).area for name, rows in found.regions.items()}
    assert area == pytest.approx({"soft": 2, "hard": 4})
    assert {name: length[name] for name in ("inlet", "wall", "outer")} == pytest.approx({"inlet": 2, "wall": 3, "outer": 5})
