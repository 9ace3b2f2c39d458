"""A femur under load: moduli from the gray image, plane stress, displacement and von Mises stress.

The dense shell of the bone is brighter than its inside: Young's modulus grows with the gray value. The lower end is held, and the head
carries a load that points down. scikit-fem computes; img2tri made the mesh, and named nothing by hand.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import img2tri

DATA = Path(__file__).parent.parent / "data"
SPACING = 0.5  # mm per pixel
LOAD, THICKNESS = 800.0, 25.0  # N, mm
SHELL, INSIDE = 17_000.0, 500.0  # MPa


def moduli(mesh: img2tri.TriangleMesh, gray: np.ndarray) -> np.ndarray:
    """Young's modulus (m,) of each triangle, by the gray value at its centroid."""
    row, column = mesh.frame.row_column(mesh.vertices[mesh.triangles].mean(axis=1))
    value = gray[np.clip(row.astype(int), 0, gray.shape[0] - 1), np.clip(column.astype(int), 0, gray.shape[1] - 1)] / 255
    return INSIDE + (SHELL - INSIDE) * np.clip((value - 0.3) / 0.6, 0, 1)


def solve(mesh: img2tri.TriangleMesh, young: np.ndarray, poisson: float = 0.3) -> tuple[np.ndarray, np.ndarray, float]:
    """Displacement (n, 2), von Mises stress (m,), and the work of the load."""
    from skfem import Basis, BilinearForm, ElementTriP1, ElementVector, asm, condense
    from skfem import solve as solve_system
    from skfem.helpers import ddot, sym_grad, trace

    fem = mesh.to_skfem()
    basis = Basis(fem, ElementVector(ElementTriP1()))
    # Plane stress.
    mu, lam = young / (2 * (1 + poisson)), young * poisson / (1 - poisson**2)
    points = basis.W.shape[-1] if basis.W.ndim > 1 else len(basis.W)
    field = {"mu": np.repeat(mu[:, None], points, axis=1), "lam": np.repeat(lam[:, None], points, axis=1)}

    @BilinearForm
    def stiffness(u, v, w):
        e, d = sym_grad(u), sym_grad(v)
        return 2 * w["mu"] * ddot(e, d) + w["lam"] * trace(e) * trace(d)

    system = asm(stiffness, basis, **field)
    y = mesh.vertices[:, 1]
    head = np.flatnonzero(y > y.max() - 0.02 * np.ptp(y))
    held = np.flatnonzero(y < y.min() + 0.03 * np.ptp(y))
    load = np.zeros(basis.N)
    load[basis.nodal_dofs[1, head]] = -LOAD / THICKNESS / len(head)
    u = solve_system(*condense(system, load, D=basis.nodal_dofs[:, held].ravel()))
    moved = np.stack([u[basis.nodal_dofs[0]], u[basis.nodal_dofs[1]]], axis=1)

    # Constant strain in each triangle, from the gradients of its corners' displacements.
    p, d = mesh.vertices[mesh.triangles], moved[mesh.triangles]
    edges, steps = p[:, 1:] - p[:, :1], d[:, 1:] - d[:, :1]
    gradient = np.linalg.solve(edges, steps)
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    stress = 2 * mu[:, None, None] * strain + (lam * strain.trace(axis1=1, axis2=2))[:, None, None] * np.eye(2)
    sx, sy, t = stress[:, 0, 0], stress[:, 1, 1], stress[:, 0, 1]
    return moved, np.sqrt(sx**2 - sx * sy + sy**2 + 3 * t**2), float(load @ u)


def draw(mesh: img2tri.TriangleMesh, moved: np.ndarray, mises: np.ndarray, path: Path) -> None:
    """Von Mises stress on the bent bone, its bending drawn larger, over the outline it had."""
    figure = Figure(figsize=(5, 9), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    scale = 0.06 * np.ptp(mesh.vertices[:, 1]) / np.abs(moved).max()
    x, y = (mesh.vertices + scale * moved).T
    shown = axes.tripcolor(x, y, mesh.triangles, facecolors=mises, cmap="viridis", vmax=np.quantile(mises, 0.99))
    for ring in mesh.outlines()[1].exterior, *mesh.outlines()[1].interiors:
        axes.plot(*ring.xy, color="0.4", linewidth=0.8)
    figure.colorbar(shown, label="von Mises stress, MPa", shrink=0.6)
    axes.set_title(f"femur under {LOAD:g} N, displacement x {scale:.0f}")
    axes.set_xlabel("mm")
    figure.savefig(path, dpi=120)


def main(out: str | Path = "out") -> dict[str, float]:
    """Mesh, solve, draw."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    gray = np.asarray(Image.open(DATA / "femur_gray.png"))
    mesh = img2tri.mesh_image(DATA / "femur_gray.png", spacing=SPACING, edge_length=4.0, boundary_edge_length=2.0)
    young = moduli(mesh, gray)
    moved, mises, work = solve(mesh, young)
    _, _, stiffer = solve(mesh, 2 * young)
    draw(mesh, moved, mises, folder / "femur_under_load.png")
    print(f"{mesh}\nlargest displacement {np.hypot(*moved.T).max():.3f} mm, von Mises stress {np.quantile(mises, 0.99):.1f} MPa (99 %)")
    return {
        "kept": float(mesh.report.kept),
        "work": work,
        "work_if_twice_as_stiff": stiffer,
        "head_goes_down": float(-moved[np.argmax(mesh.vertices[:, 1]), 1]),
        "stress": float(np.quantile(mises, 0.99)),
    }


if __name__ == "__main__":
    main()
