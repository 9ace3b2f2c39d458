"""Stress at five curves from images: how tight a curve may be, and what of the error is the outline's.

Plates of 240 x 320 pixels are pulled at both ends: an ellipse whose tips have a radius of 15, two holes of radius 40 that leave 12 between
them, a V notch with a root of 10, a slot with tips of 6; and a ring of radius 40 and 80 bears a pressure inside. The shapes lie anywhere
between pixels. Quadratic elements, edges of 4 px at the curve, the greatest principal stress averaged at vertices.

`EXACT` is what `reference` leads to as its edges get shorter, within 0.3 %: elements with curved sides, their nodes on the exact curve;
the ring is Lame's. Each mesh is computed once more with the vertices of its outline put on the exact curve: what is wrong then is due to
the size of its edges; the rest is due to the outline. By default no edge turns by more than 18 degrees on a curve (`segments_per_turn`):
at tips of 6 px edges of 4 would turn by 38.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

import img2tri

WIDTH, HEIGHT, POISSON = 240, 320, 0.3
LENGTH, FAR = 4.0, 24.0  # px, edge lengths at the curves and far from them
EXACT = {"ellipse, R 15": 6.868, "two holes, R 40": 7.296, "V notch, R 10": 11.94, "slot, R 6": 6.61, "ring, R 40": 5 / 3}
RADIUS = {name: float(name.split()[-1]) for name in EXACT}
PEAKS = {"ellipse": [-60, 60], "two holes": [-6, 6], "V notch": [10], "slot": [-36, 36], "ring": [0]}  # px to the right of the middle


def arc(x: float, radius: float, start: float = 0, stop: float = 360) -> NDArray[np.float64]:
    """Points on a circle around (x, 0), some 0.05 px apart; angles in degrees."""
    angle = np.radians(np.linspace(start, stop, 4000))
    return np.stack([x + radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def shape(name: str, middle: NDArray[np.float64]) -> shapely.Polygon:
    """Return the exact shape, with what is cut out of the plate around the given place."""
    kind = name.split(",")[0]
    if kind == "ring":
        return shapely.Polygon(arc(0, 80) + middle, [arc(0, 40) + middle])
    notch = np.array([[-300, 10 / np.cos(np.pi / 6) + 300 * np.tan(np.pi / 6)]])  # the flank is a tangent of the root
    cut = {
        "ellipse": [arc(0, 1) * [60, 30]],
        "two holes": [arc(-46, 40), arc(46, 40)],
        "V notch": [np.concatenate([notch * [1, -1], arc(0, 10, -60, 60), notch])],
        "slot": [np.concatenate([arc(30, 6, -90, 90), arc(-30, 6, 90, 270)])],
    }[kind]
    return shapely.box(0, 0, WIDTH, HEIGHT) - shapely.union_all([shapely.Polygon(points + middle) for points in cut])


def middles(name: str, count: int) -> NDArray[np.float64]:
    """Places (count, 2) of the shapes, each within a pixel."""
    about = np.array([70 if name.startswith("V") else WIDTH / 2, HEIGHT / 2])
    return about + np.random.default_rng(0).uniform(-0.5, 0.5, (count, 2))


def draw(exact: shapely.Polygon, *, gray: bool) -> NDArray[Any]:
    """Draw a shape: what is inside at the centres of pixels, or how much of each pixel, from 0 to 255."""
    shapely.prepare(exact)
    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    y = HEIGHT - y
    mask = shapely.contains_xy(exact, x, y)
    if not gray:
        return mask
    rim = maximum_filter(mask, 3) != minimum_filter(mask, 3)
    parts = (np.arange(16) + 0.5) / 16 - 0.5
    share = mask.astype(np.float64)
    share[rim] = shapely.contains_xy(exact, *np.broadcast_arrays(x[rim, None, None] + parts, y[rim, None, None] + parts[:, None])).mean(
        (1, 2)
    )
    return np.round(255 * share).astype(np.uint8)


def distance(name: str, places: NDArray[np.float64], middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance (k,) from where the stress is greatest: from the tips of the shape, from all of the inside of the ring."""
    kind = name.split(",")[0]
    if kind == "ring":
        return np.abs(np.hypot(*(places - middle).T) - 40)
    return np.min([np.hypot(*(places - middle - [x, 0]).T) for x in PEAKS[kind]], axis=0)


def mesh_shape(name: str, image: NDArray[Any], middle: NDArray[np.float64], length: float = LENGTH) -> img2tri.TriangleMesh:
    """Mesh an image of it: edges of the given length where the stress is greatest, growing away from there."""
    reach = 0 if name.startswith("ring") else RADIUS[name]

    def lengths(places: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(length + 0.25 * (distance(name, places, middle) - reach), length, FAR)

    return img2tri.mesh_image(image, edge_length=lengths, gradation=0.25)


def on_curve(fem: Any, exact: shapely.Polygon) -> Any:
    """Put all nodes of the outline of a finite-element mesh of scikit-fem on the exact curve."""
    from skfem import Basis, ElementTriP1, ElementTriP2

    element = ElementTriP2() if fem.doflocs.shape[1] > fem.nvertices else ElementTriP1()
    at = Basis(fem, element).get_dofs(fem.boundary_facets()).flatten()
    nodes = fem.doflocs.copy()
    to = shapely.shortest_line(shapely.points(nodes[:, at].T), exact.boundary)
    nodes[:, at] = shapely.get_coordinates(to)[1::2].T
    return type(fem)(nodes, fem.t)


def stress(name: str, fem: Any, middle: NDArray[np.float64]) -> float:
    """Return the greatest principal stress at the curve, averaged at vertices, over that at the ends, or over the pressure."""
    from scipy.sparse.linalg import splu
    from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    element = ElementVector(ElementTriP2())
    basis = Basis(fem, element, intorder=4)

    def law(strain):  # for a Young's modulus of 1, plane stress
        return strain / (1 + POISSON) + eye(POISSON / (1 - POISSON**2) * trace(strain), 2)

    system = BilinearForm(lambda u, v, _: ddot(law(sym_grad(u)), sym_grad(v))).assemble(basis)
    corners = fem.p[:, : fem.nvertices].T
    ring = name.startswith("ring")

    def loaded(x):
        return np.hypot(x[0] - middle[0], x[1] - middle[1]) < 60 if ring else np.minimum(x[1], HEIGHT - x[1]) < 1e-6

    facets = FacetBasis(fem, element, facets=fem.facets_satisfying(loaded, boundaries_only=True))
    load = LinearForm(lambda v, w: -dot(w.n, v) if ring else w.n[1] * v[1]).assemble(facets)
    # Two places, one held in both directions: no rigid motion is left, and no force there.
    places = middle + np.array([[-80, 0], [80, 0]]) if ring else np.array([[0, 0], [WIDTH, 0]])
    one, other = (np.argmin(np.hypot(*(corners - place).T)) for place in places)
    free = np.setdiff1d(np.arange(basis.N), [*basis.nodal_dofs[:, one], basis.nodal_dofs[1, other]])
    u = np.zeros(basis.N)
    options = {"SymmetricMode": True}
    u[free] = splu(system[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).solve(load[free])

    at_corners = law(sym_grad(Basis(fem, element, quadrature=(np.array([[0.0, 1, 0], [0, 0, 1]]), np.full(3, 1 / 6))).interpolate(u)))
    vertex = fem.t[:3].T.ravel()
    s = np.reshape([np.bincount(vertex, part.ravel()) / np.bincount(vertex) for part in at_corners.reshape(4, -1, 3)], (2, 2, -1))
    greater = (s[0, 0] + s[1, 1]) / 2 + np.hypot((s[0, 0] - s[1, 1]) / 2, s[0, 1])
    return float(greater[distance(name, corners, middle) < 15].max())


def reference(name: str, length: float = 0.5) -> float:
    """Compute what `EXACT` has: curved elements, their nodes on the exact curve."""
    (middle,) = middles(name, 1)
    exact = shape(name, middle)
    return stress(name, on_curve(mesh_shape(name, draw(exact, gray=True), middle, length).to_skfem(order=2), exact), middle)


def errors(name: str, kind: str, count: int) -> NDArray[np.float64]:
    """Errors (count, 2) in percent: of meshes as they are, and with their vertices on the exact curve."""
    found = []
    for middle in middles(name, count):
        exact = shape(name, middle)
        fem = mesh_shape(name, draw(exact, gray=kind == "gray"), middle).to_skfem()
        found.append([stress(name, one, middle) for one in (fem, on_curve(fem, exact))])
    return 100 * (np.array(found) / EXACT[name] - 1)


def main(out: str | Path = "out", count: int = 6) -> dict[str, float]:
    """Print the errors: the worst of some places, and the mean of what the exact curve gives with the same edges; draw a mesh."""
    print(f"{'error of the greatest stress, %':34}{'mask':>7}{'exact curve':>13}{'gray':>7}{'exact curve':>13}")
    found: dict[str, float] = {}
    for name in EXACT:
        print(f"{name:34}", end="")
        for kind in ("mask", "gray"):
            ours, exact = errors(name, kind, count).T
            worst = ours[np.abs(ours).argmax()]
            print(f"{worst:7.1f}{exact.mean():13.1f}", end="")
            found |= {f"{name}, {kind}": float(worst), f"{name}, {kind}, exact curve": float(exact.mean())}
        print()
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    middle = next(iter(middles("slot, R 6", 1)))
    image = draw(shape("slot, R 6", middle), gray=False)
    mesh_shape("slot, R 6", image, middle).plot(image, folder / "slot.png")
    return found


if __name__ == "__main__":
    main()
