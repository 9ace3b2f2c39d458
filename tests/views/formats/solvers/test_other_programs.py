"""What programs for computing find in our files: they measure the plate, or compute on it. Each is a row of the README's table."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from children import PATIENCE
from views.plates import cells
from views.solver_meshes import AREAS, BOUNDS, HEIGHT, SIZE, TAGS, gmsh, made, plate, program, sizes

from img2tri import TriangleMesh
from img2tri.types import Frame
from img2tri.views.formats.solvers.bdf import bdf
from img2tri.views.formats.solvers.inp import inp
from img2tri.views.formats.solvers.medit import medit
from img2tri.views.formats.solvers.msh import msh
from img2tri.views.formats.solvers.save_for_solvers import export
from img2tri.views.objects.solver_cells import flat_cells

pytestmark = pytest.mark.tools
AREA = sum(AREAS.values()) * SIZE**2

GETDP = """
Group { Vol = Region[{5, 4}]; L = Region[1001]; H = Region[1011]; Omega = Region[{Vol, L, H}]; }
Constraint { { Name phi; Case { { Region L; Value 0.; } { Region H; Value 1.; } } } }
FunctionSpace { { Name S; Type Form0; BasisFunction { { Name s; NameOfCoef v; Function BF_Node; Support Vol; Entity NodesOf[Omega]; } }
  Constraint { { NameOfCoef v; EntityType NodesOf; NameOfConstraint phi; } } } }
Jacobian { { Name J; Case { { Region Omega; Jacobian Vol; } } } }
Integration { { Name I; Case { { Type Gauss; Case { { GeoElement Triangle; NumberOfPoints 3; } } } } } }
Formulation { { Name F; Type FemEquation; Quantity { { Name u; Type Local; NameOfSpace S; } }
  Equation { Galerkin { [Dof{d u}, {d u}]; In Vol; Jacobian J; Integration I; } } } }
Resolution { { Name R; System { { Name A; NameOfFormulation F; } } Operation { Generate[A]; Solve[A]; SaveSolution[A]; } } }
PostProcessing { { Name P; NameOfFormulation F; Quantity {
  { Name energy; Value { Integral { [{d u} * {d u}]; In Vol; Jacobian J; Integration I; } } }
  { Name area; Value { Integral { [1]; In Vol; Jacobian J; Integration I; } } } } } }
PostOperation { { Name O; NameOfPostProcessing P; Operation {
  Print[energy[Vol], OnGlobal, Format Table, File "energy.txt"]; Print[area[Vol], OnGlobal, Format Table, File "area.txt"]; } } }
"""


def run(folder, *words, **environment):
    done = subprocess.run(
        words, cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE, env={**os.environ, **environment}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def energy(vertices, triangles, low, high):
    """Twice the energy of what is 0 at some vertices and 1 at others, harmonic between, in linear triangles."""
    n = len(vertices)
    stiffness = np.zeros((n, n))
    for t in triangles:
        x, y = vertices[t].T
        b, c = np.roll(y, -1) - np.roll(y, 1), np.roll(x, 1) - np.roll(x, -1)
        stiffness[np.ix_(t, t)] += (np.outer(b, b) + np.outer(c, c)) / (2 * (x * b).sum())
    u = np.zeros(n)
    u[high] = 1
    free = np.setdiff1d(np.arange(n), np.concatenate([low, high]))
    u[free] = np.linalg.solve(stiffness[np.ix_(free, free)], -stiffness[free] @ u)
    return u @ stiffness @ u


def test_getdp_computes_on_regions_and_edges_that_share_no_number(tmp_path):
    """With "left" and a region both 1, its energy once was 80 times too large, and all seemed well."""
    getdp, mesh = program("getdp"), made("triangle", z=0.0)
    (tmp_path / "a.msh").write_bytes(msh(mesh, version="2.2")[""])
    (tmp_path / "a.pro").write_text(GETDP)
    run(tmp_path, getdp, "a.pro", "-msh", "a.msh", "-solve", "R", "-pos", "O", "-v", "2")
    found = {name: float((tmp_path / f"{name}.txt").read_text().split()[1]) for name in ("energy", "area")}
    vertices, triangles, _ = plate()
    ends = [np.unique(mesh.facets(name)) for name in ("left", "hole_1")]
    assert found == pytest.approx({"area": AREA, "energy": energy(vertices, triangles, *ends)}, rel=1e-9)


@pytest.mark.parametrize("kind", ["wedge", "tetra"])
def test_openfoam_finds_a_sound_mesh_with_its_patches_and_zones(tmp_path, kind):
    """It takes nodes to be numbered in the order of the file, and names zones by numbers whatever their dimension."""
    program("gmshToFoam")
    home = Path("/usr/share/openfoam")
    environment = {"WM_PROJECT_DIR": str(home)} if home.exists() else {}
    for name in ("controlDict", "fvSchemes", "fvSolution"):
        (tmp_path / "system").mkdir(exist_ok=True)
        (tmp_path / "system" / name).write_text(
            "FoamFile { version 2.0; format ascii; class dictionary; object " + name + "; }\n"
            "application none; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; "
            "writeInterval 1;\nddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {} interpolationSchemes {} snGradSchemes {}\n"
        )
    (tmp_path / "a.msh").write_bytes(msh(made(kind), version="2.2")[""])
    run(tmp_path, "gmshToFoam", "a.msh", **environment)
    said = run(tmp_path, "checkMesh", **environment)
    assert "Mesh OK." in said
    assert float(re.search(r"Total volume = ([\d.]+\d)", said)[1]) == pytest.approx(AREA * HEIGHT, rel=1e-6)
    words = {file: (tmp_path / "constant" / "polyMesh" / file).read_text() for file in ("boundary", "cellZones")}
    assert re.findall(r"^(region_-1|bone)$", words["cellZones"], re.MULTILINE) == ["region_-1", "bone"]
    assert set(re.findall(r"^\s+(\w+)\n\s+\{", words["boundary"], re.MULTILINE)) >= {"left", "bottom", "outer", "hole_1", "z_min", "z_max"}


@pytest.mark.parametrize("kind", ["triangle", "tetra"])
def test_freefem_finds_every_label_with_its_size(tmp_path, kind):
    freefem, mesh = program("FreeFem++"), made(kind, z=0.0)
    (tmp_path / "a.mesh").write_bytes(medit(mesh)[""])
    regions, sets = sizes(mesh.solid)
    read, inside, border = ("mesh3 T = readmesh3", "int3d", "int2d") if mesh.solid else ("mesh T = readmesh", "int2d", "int1d")
    numbers = {"region_-1": 5, "bone": 4} | {name: TAGS[name] for name in sets if name != "outer"}
    lines = [f'cout << "{name} = " << {inside if name in regions else border}(T, {n})(1.) << endl;' for name, n in numbers.items()]
    (tmp_path / "a.edp").write_text(f'{read}("a.mesh");\n' + "\n".join(lines))
    said = run(tmp_path, freefem, "-nw", "a.edp")
    found = {name: float(value) for name, value in re.findall(r"^(\S+) = (\S+)$", said, re.MULTILINE)}
    assert found == pytest.approx({name: ({**regions, **sets})[name] for name in numbers}, rel=1e-5)


def test_calculix_stretches_a_periodic_cell_of_one_material_evenly(tmp_path):
    """Its sides are tied: uniform stress, whatever the mesh, which is that of a free strip."""
    ccx = program("ccx")
    vertices, triangles = cells(np.ones((4, 5), bool))
    mesh = flat_cells(vertices, triangles, bounds=(0, 0, 5, 4), periodic="xy")
    deck = inp(mesh, deck=True)[""].decode().partition("*NODE PRINT")[0]
    (tmp_path / "job.inp").write_text(f"{deck}*EL PRINT, ELSET=region_1\nS\n*END STEP\n")
    said = run(tmp_path, ccx, "job")
    assert "ERROR" not in said
    rows = np.array([line.split()[2:] for line in (tmp_path / "job.dat").read_text().splitlines() if len(line.split()) == 8], float)
    # Modulus 1000, strain 0.001; free to draw in.
    assert len(rows) >= len(triangles)
    assert rows == pytest.approx(np.tile([0, 1, 0, 0, 0, 0], (len(rows), 1)), abs=1e-4)


def test_pynastran_reads_numbers_of_nine_digits(tmp_path, monkeypatch):
    monkeypatch.setattr(np, "in1d", np.isin, raising=False)  # which numpy has given up, and pyNastran not
    reader = pytest.importorskip("pyNastran.bdf.bdf", reason="pyNastran is not installed")
    vertices, triangles, regions = plate()
    mesh = flat_cells(vertices, triangles, np.where(regions == 4, 123_456_789, 7))
    (tmp_path / "a.bdf").write_bytes(bdf(mesh)[""])
    model = reader.read_bdf(str(tmp_path / "a.bdf"), xref=False, validate=False, debug=None)
    assert np.array_equal([model.elements[i + 1].pid for i in range(len(mesh.cells))], mesh.regions)


# ---- found by Python libraries ----


def parts_of(mesh):
    """Sizes of regions and sets, without the pieces of sets."""
    regions, sets = sizes(mesh.solid)
    return regions, {name: size for name, size in sets.items() if name in mesh.wholes}


@pytest.mark.parametrize("version", ["4.1", "2.2"])
@pytest.mark.parametrize("kind", ["triangle", "triangle6", "tetra", "tetra10"])
def test_nutils_integrates_over_every_part(tmp_path, kind, version):
    nutils = pytest.importorskip("nutils.mesh", reason="nutils is not installed")
    from nutils import function

    mesh = made(kind, z=0.0)
    (tmp_path / "a.msh").write_bytes(msh(mesh, version=version)[""])
    topology, place = nutils.gmsh(tmp_path / "a.msh")
    regions, sets = parts_of(mesh)
    size = {name: topology.get_groups(name).integrate(function.J(place), degree=2) for name in regions}
    size |= {
        name: (topology.interfaces if "__" in name else topology.boundary)[name].integrate(function.J(place), degree=2) for name in sets
    }
    assert {name: float(value) for name, value in size.items()} == pytest.approx({**regions, **sets})


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # it leaves the file open
@pytest.mark.parametrize("kind", ["triangle", "tetra"])
def test_ngsolve_integrates_over_every_part(tmp_path, kind):
    try:
        import ngsolve
        from netgen.read_gmsh import ReadGmsh
    except (ImportError, OSError) as problem:
        pytest.skip(f"ngsolve is not installed, or lacks a library: {problem}")
    mesh = made(kind, z=0.0)
    (tmp_path / "a.msh").write_bytes(msh(mesh, version="2.2")[""])
    found = ngsolve.Mesh(ReadGmsh(str(tmp_path / "a")))
    regions, sets = parts_of(mesh)
    size = {name: ngsolve.Integrate(1, found, definedon=found.Materials(name)) for name in regions}
    size |= {name: ngsolve.Integrate(1, found, ngsolve.BND, definedon=found.Boundaries(name)) for name in sets}
    assert size == pytest.approx({**regions, **sets})


def test_scikit_fem_computes_on_regions_and_edges():
    pytest.importorskip("skfem", reason="scikit-fem is not installed")
    from skfem import Basis, ElementTriP1, ElementTriP2, condense, solve
    from skfem.models.poisson import laplace

    vertices, triangles, regions = plate()
    frame = Frame((5, 6), (SIZE, SIZE), BOUNDS[:2])
    whole = TriangleMesh(vertices, triangles, regions, frame, {4: "bone"})
    expected = energy(vertices, triangles, *(np.unique(whole.sets().edges[name]) for name in ("left", "hole_1")))
    found = {}
    for order, element in ((1, ElementTriP1()), (2, ElementTriP2())):
        basis = Basis(whole.to_skfem(order=order), element)
        matrix = laplace.assemble(basis)
        u = basis.zeros()
        u[basis.get_dofs("hole_1").all()] = 1
        u = solve(*condense(matrix, x=u, D=basis.get_dofs({"left", "hole_1"})))
        found[order] = u @ matrix @ u
    assert found[1] == pytest.approx(expected, rel=1e-9)
    assert 0.8 * expected < found[2] < expected  # a richer space has less energy


# ---- found by programs ----

PARAVIEW = """
import json, sys
from paraview import servermanager
from paraview.simple import *

for name in sys.argv[1:]:
    reader = VTKHDFReader(FileName=[name]) if name.endswith(".vtkhdf") else OpenDataFile(name)
    reader.UpdatePipeline()
    data = servermanager.Fetch(reader)
    size = {}
    for label in (-1, 4):
        part = IntegrateVariables(Threshold(reader, Scalars=["CELLS", "region"], LowerThreshold=label, UpperThreshold=label))
        part.UpdatePipeline()
        values = servermanager.Fetch(part).GetCellData()
        size[label] = [values.GetArray(n).GetTuple1(0) for n in ("Area", "Volume") if values.GetArray(n)][0]
    fields = data.GetFieldData()
    rows = {fields.GetArrayName(i): fields.GetAbstractArray(i).GetNumberOfTuples() for i in range(fields.GetNumberOfArrays())}
    print(json.dumps([data.GetNumberOfCells(), size, rows]))
"""


def test_paraview_finds_regions_and_sets(tmp_path):
    pvbatch = program("pvbatch")
    meshes = {f"{kind}{suffix}": made(kind) for kind in ("triangle", "triangle6", "tetra", "tetra10") for suffix in (".vtu", ".vtkhdf")}
    for name, mesh in meshes.items():
        export(tmp_path / name, mesh)
    (tmp_path / "look.py").write_text(PARAVIEW)
    said = run(tmp_path, pvbatch, "look.py", *meshes)
    found = [json.loads(line) for line in said.splitlines() if line.startswith("[")]
    for mesh, (count, size, fields) in zip(meshes.values(), found, strict=True):
        regions, _ = sizes(mesh.solid)
        assert count == len(mesh.cells)
        assert size == pytest.approx({"-1": regions["region_-1"], "4": regions["bone"]})
        assert {name: fields[name] for name in mesh.sides} == {name: len(rows) for name, rows in mesh.sides.items()}


@pytest.mark.parametrize("kind", ["triangle", "triangle6", "tetra", "wedge"])
@pytest.mark.parametrize("suffix", [".med", ".unv", ".key", ".su2", ".cgns"])
def test_gmsh_makes_other_formats_of_ours_with_names(tmp_path, kind, suffix):
    """As ``gmsh a.msh -save -o a.med`` does."""
    gmsh_ = gmsh()
    mesh = made(kind)
    (tmp_path / "a.msh").write_bytes(msh(mesh)[""])
    code = (
        "import gmsh; gmsh.initialize(interruptible=False); gmsh.option.setNumber('General.Terminal', 0); "
        f"gmsh.open('a.msh'); gmsh.write('a{suffix}'); gmsh.finalize()"
    )
    run(tmp_path, sys.executable, "-c", code)
    data = (tmp_path / f"a{suffix}").read_bytes()
    names = [*mesh.names.values(), *mesh.wholes]
    assert [name for name in names if name.encode() not in data] == []
    if suffix in (".unv", ".med"):
        gmsh_.initialize(interruptible=False)
        gmsh_.option.setNumber("General.Terminal", 0)
        gmsh_.open(str(tmp_path / f"a{suffix}"))
        again = {gmsh_.model.getPhysicalName(*group).strip() for group in gmsh_.model.getPhysicalGroups()}
        gmsh_.finalize()
        assert set(names) <= again
