"""Stress concentration from an image: a plate with a hole, pulled at both ends. Why the outline matters.

The plate is 400 x 800 pixels, the hole has a radius of 60, its centre lies anywhere between pixels. The greatest principal stress is
`EXACT` times that at the ends, as computed on the exact circle (curved quadratic elements, refined until the fifth digit stands).
Formulas of handbooks are 1 % off for a plate of this size.

Stress sees the curvature of the outline: a bump of a tenth of a pixel is a notch to it. So refining a mesh on a rough outline makes the
answer worse, and only a smooth outline, though drawn by the same pixels, lets it converge. On a smooth outline the error follows the
angle by which the hole turns from one end of an edge to the other, which `segments_per_turn` bounds.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import img2tri

WIDTH, HEIGHT, POISSON = 400, 800, 0.3
EXACT = {60: 3.3820, 20: 3.0375}  # by radius of the hole
FAR = 24.0  # px, edge length away from the hole
ROUTES = {"binary": "mask, smooth outline", "gray": "gray image, smooth outline", "pixels": "mask, sides of its pixels"}


def centres(count: int) -> NDArray[np.float64]:
    """Places (count, 2) of the hole, within a pixel around the middle of the plate."""
    return np.array([WIDTH / 2, HEIGHT / 2]) + np.random.default_rng(0).uniform(-0.5, 0.5, (count, 2))


def plate(centre: NDArray[np.float64], radius: float, *, gray: bool) -> NDArray[np.generic]:
    """Draw the plate: what is plate at the centres of pixels, or how much of each pixel, from 0 to 255."""

    def distance(y: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.hypot(x - centre[0], HEIGHT - y - centre[1])

    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    mask = distance(y, x) > radius
    if not gray:
        return mask
    share = mask.astype(np.float64)
    rim = np.abs(distance(y, x) - radius) < 1
    parts = (np.arange(16) + 0.5) / 16 - 0.5
    share[rim] = (distance(y[rim, None, None] + parts[:, None], x[rim, None, None] + parts) > radius).mean(axis=(1, 2))
    return np.round(255 * share).astype(np.uint8)


def mesh_plate(image: NDArray[np.generic], centre: NDArray[np.float64], radius: float, length: float, outline: str) -> img2tri.TriangleMesh:
    """Mesh the plate: edges of the given length at the hole, growing away from it."""

    def lengths(places: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(length + 0.25 * (np.hypot(*(places - centre).T) - radius), length, FAR)

    return img2tri.mesh_image(image, edge_length=lengths, gradation=0.25, outline=outline)


def stress(mesh: img2tri.TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal stress over that at the ends, by quadratic elements: the greatest in each triangle (m,), means at vertices (n,)."""
    from scipy.sparse.linalg import splu
    from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm
    from skfem.helpers import ddot, eye, sym_grad, trace

    fem = mesh.to_skfem()
    element = ElementVector(ElementTriP2())
    basis = Basis(fem, element, intorder=2)

    def law(strain):  # for a Young's modulus of 1
        return strain / (1 + POISSON) + eye(POISSON / (1 - POISSON**2) * trace(strain), 2)

    system = BilinearForm(lambda u, v, _: ddot(law(sym_grad(u)), sym_grad(v))).assemble(basis)
    low, high = mesh.vertices[:, 1].min(), mesh.vertices[:, 1].max()
    load = np.zeros(basis.N)
    for end, pull in ((low, -1.0), (high, 1.0)):
        facets = fem.facets_satisfying(lambda x, end=end: np.abs(x[1] - end) < 1e-6, boundaries_only=True)
        load += LinearForm(lambda v, _, pull=pull: pull * v[1]).assemble(FacetBasis(fem, element, facets=facets))
    # Two lower corners, one in both directions: no rigid motion is left, and no force there.
    one, other = (np.argmin(np.hypot(*(mesh.vertices - corner).T)) for corner in ([0, low], [WIDTH, low]))
    fixed = [*basis.nodal_dofs[:, one], basis.nodal_dofs[1, other]]
    free = np.setdiff1d(np.arange(basis.N), fixed)
    u = np.zeros(basis.N)
    solver = splu(system[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    u[free] = solver.solve(load[free])

    corners = Basis(fem, element, quadrature=(np.array([[0.0, 1, 0], [0, 0, 1]]), np.full(3, 1 / 6)))
    at_corners = law(sym_grad(corners.interpolate(u)))
    vertex = fem.t.T.ravel()  # scikit-fem sorts the corners of each triangle
    means = [np.bincount(vertex, part.ravel()) / np.bincount(vertex) for part in at_corners.reshape(4, -1, 3)]
    return principal(at_corners).max(axis=1), principal(np.reshape(means, (2, 2, -1)))


def principal(s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Greater principal value of symmetric tensors (2, 2, ...)."""
    return (s[0, 0] + s[1, 1]) / 2 + np.hypot((s[0, 0] - s[1, 1]) / 2, s[0, 1])


def errors(kind: str, radius: float, length: float, count: int) -> NDArray[np.float64]:
    """Errors (count, 2) of the greatest stress at the hole in percent: of all values at corners, and of their means at vertices."""
    found = []
    for centre in centres(count):
        image = plate(centre, radius, gray=kind == "gray")
        mesh = mesh_plate(image, centre, radius, length, "pixel" if kind == "pixels" else "smooth")
        raw, mean = stress(mesh)
        near = np.hypot(*(mesh.vertices - centre).T) < 2 * radius
        found.append([raw[near[mesh.triangles].any(axis=1)].max(), mean[near].max()])
    return 100 * (np.array(found) / EXACT[int(radius)] - 1)


def draw(path: Path) -> None:
    """Show the stress beside the hole on the sides of pixels and on the smooth outline."""
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    (centre,) = centres(1)
    for axes, outline in zip(figure.subplots(1, 2), ("pixel", "smooth"), strict=True):
        mesh = mesh_plate(plate(centre, 60, gray=False), centre, 60, 2.0, outline)
        shown = axes.tripcolor(*mesh.vertices.T, mesh.triangles, stress(mesh)[1], shading="gouraud", vmin=0, vmax=4, cmap="magma")
        axes.set(aspect="equal", xlim=centre[0] + [42, 82], ylim=centre[1] + [-20, 20], title=f'outline="{outline}"')
    figure.colorbar(shown, ax=figure.axes, label="principal stress / stress at the ends", extend="max")
    figure.savefig(path, dpi=120)


def main(out: str | Path = "out", count: int = 8) -> dict[str, float]:
    """Print the errors over some places of the hole, and draw the stress."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    found: dict[str, float] = {}
    print(f"{'worst error of the greatest stress, %':56}{'turn of an edge':>16}{'as it is':>9}{'averaged':>10}")
    for radius, length, kinds in ((60, 2, ROUTES), (60, 4, ROUTES), (20, 2, ("binary", "gray")), (20, 4, ("binary", "gray"))):
        for kind in kinds:
            raw, mean = errors(kind, radius, length, 1 if kind == "pixels" else count).T
            turn = np.degrees(length / radius)
            what = f"R {radius}, edges of {length}: {ROUTES[kind]}"
            print(f"{what:56}{turn:12.1f} deg{np.abs(raw).max():9.2f}{np.abs(mean).max():10.2f}")
            found[f"{kind}_{radius}_{length}_raw"] = float(np.abs(raw).max())
            found[f"{kind}_{radius}_{length}"] = float(np.abs(mean).max())
    # The paper's recipe takes the outermost contours only: it fills the hole.
    filled = img2tri.mesh_image(plate(centres(1)[0], 60, gray=False), recipe="unstructured", threshold=0.5, edge_length=12)
    found["paper"] = float(100 * (np.quantile(stress(filled)[1], 0.99) / EXACT[60] - 1))
    print(f"{'the paper: no hole':56}{'':25}{abs(found['paper']):10.2f}")
    draw(folder / "stress_at_a_hole.png")
    return found


if __name__ == "__main__":
    main()
