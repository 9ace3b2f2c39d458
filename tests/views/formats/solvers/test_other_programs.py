"""What programs for computing find in our files: GetDP, OpenFOAM, FreeFem, CalculiX and pyNastran measure the plate, or compute on it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from children import PATIENCE
from views.plates import cells
from views.solver_meshes import AREAS, HEIGHT, SIZE, TAGS, made, plate, program, sizes

from img2tri.views.formats.solvers.bdf import bdf
from img2tri.views.formats.solvers.inp import inp
from img2tri.views.formats.solvers.medit import medit
from img2tri.views.formats.solvers.msh import msh
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
