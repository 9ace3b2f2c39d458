"""How well does a two-phase image conduct? Effective conductivity, contrast 10 : 1, against the value of the geometry that was drawn.

Two kinds of image, three of each: a wavy inclusion with three holes, and a polycrystal of 60 grains, every second of which conducts ten
times better. Left and right side of the square are held at 0 and 1, the others are insulated; the energy is the effective conductivity.

What the images show is given by formulas, so the answer is known: `EXACT` was computed on the curves themselves, without an image, with
quadratic elements, finer and finer up to the corners where grains meet (tests/test_conductivity.py computes it again). Pixels are labelled
by their centres: no pixel counts to both sides, so drawing adds no error but that of pixels.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import img2tri

SIZE, GRAINS, CONTRAST = 256, 60, 10.0
HOLES, HOLE_RADIUS, HOLES_AT = 3, 13.0, 40.0  # px; the last is the distance of the holes from the middle
EXACT = {"inclusion": (1.56089, 1.52091, 1.58267), "polycrystal": (3.77585, 3.75418, 2.95796)}  # by seed; certain to 1e-5


def radius(angle: NDArray[np.float64], seed: int) -> NDArray[np.float64]:
    """Distance of the rim of the inclusion from the middle of the image: a circle with waves of random height and place."""
    rng = np.random.default_rng(seed)
    waves = np.arange(2, 9)
    heights = 0.25 / waves * rng.uniform(0.3, 1, len(waves))
    return 75 * (1 + (heights * np.cos(waves * angle[..., None] + rng.uniform(0, 2 * np.pi, len(waves)))).sum(axis=-1))


def hole_centres() -> NDArray[np.float64]:
    """Places (3, 2) of the holes in the inclusion."""
    angle = 2 * np.pi * np.arange(HOLES) / HOLES + 0.3
    return SIZE / 2 + HOLES_AT * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def grain_centres(seed: int) -> NDArray[np.float64]:
    """Places (60, 2); a grain is all that is nearest to one of them."""
    return np.random.default_rng(seed).random((GRAINS, 2)) * SIZE


def inclusion(places: NDArray[np.float64], seed: int) -> NDArray[np.int64]:
    """Label of each place (k, 2): 2 in the inclusion, 1 around it and in its holes."""
    x, y = (places - SIZE / 2).T
    inside = np.hypot(x, y) < radius(np.arctan2(y, x), seed)
    for centre in hole_centres():
        inside &= np.hypot(*(places - centre).T) > HOLE_RADIUS
    return 1 + inside.astype(np.int64)


def polycrystal(places: NDArray[np.float64], seed: int) -> NDArray[np.int64]:
    """Label of each place (k, 2): the number of its grain, from 1."""
    from scipy.spatial import KDTree

    return KDTree(grain_centres(seed)).query(places)[1] + 1


def conductivity(labels: NDArray[np.int64]) -> NDArray[np.float64]:
    """1 for odd labels, 10 for even ones."""
    return np.where(labels % 2 == 0, CONTRAST, 1.0)


def effective(fem, local: NDArray[np.float64], order: int) -> float:
    """Effective conductivity from left to right of a `skfem.MeshTri` of the square, given that of each triangle."""
    from skfem import Basis, BilinearForm, ElementTriP0, ElementTriP1, ElementTriP2, asm, condense, solve
    from skfem.helpers import dot, grad

    @BilinearForm
    def flow(u, v, w):
        return w["local"] * dot(grad(u), grad(v))

    basis = Basis(fem, ElementTriP1() if order == 1 else ElementTriP2())
    system = asm(flow, basis, local=basis.with_element(ElementTriP0()).interpolate(local))
    u = np.zeros(basis.N)
    left, right = basis.get_dofs("left").flatten(), basis.get_dofs("right").flatten()
    u[right] = 1
    u = solve(*condense(system, x=u, D=np.concatenate([left, right])))
    return float(u @ system @ u)


def by_outlines(image: NDArray[np.int64], order: int, edge_length: float) -> float:
    """Mesh along the outlines of the regions."""
    mesh = img2tri.mesh_image(image, labels=True, background=None, edge_length=edge_length)
    return effective(mesh.to_skfem(), conductivity(mesh.regions), order)


def by_pixels(image: NDArray[np.int64], order: int) -> float:
    """Compute on the pixels as they are, each cut into two triangles."""
    from skfem import MeshTri

    fem = MeshTri.init_tensor(np.arange(SIZE + 1.0), np.arange(SIZE + 1.0))
    fem = fem.with_boundaries({"left": lambda x: x[0] == 0, "right": lambda x: x[0] == SIZE})
    column, row = np.floor(fem.p[:, fem.t].mean(axis=1)).astype(int)
    return effective(fem, conductivity(image[SIZE - 1 - row, column]), order)


def main(out: str | Path = "out") -> dict[str, float]:  # noqa: ARG001
    """Print the errors, in percent."""
    y, x = np.mgrid[SIZE:0:-1, :SIZE] + np.array([-0.5, 0.5])[:, None, None]
    centres = np.stack([x.ravel(), y.ravel()], axis=1)
    routes = {
        "outlines, 4 px, linear": lambda image: by_outlines(image, 1, 4),
        "outlines, 8 px, quadratic": lambda image: by_outlines(image, 2, 8),
        "outlines, 4 px, quadratic": lambda image: by_outlines(image, 2, 4),
        "pixels, linear": lambda image: by_pixels(image, 1),
    }
    found: dict[str, float] = {}
    print("error of the effective conductivity, %")
    for draw in (inclusion, polycrystal):
        exact = EXACT[draw.__name__]
        print(f"{draw.__name__:28}" + "".join(f"{value:10.4f}" for value in exact))
        images = [draw(centres, seed).reshape(SIZE, SIZE) for seed in range(len(exact))]
        for name, route in routes.items():
            errors = [100 * (route(image) / value - 1) for image, value in zip(images, exact, strict=True)]
            print(f"  {name:26}" + "".join(f"{error:+10.3f}" for error in errors))
            found[f"{draw.__name__}: {name}"] = max(map(abs, errors))
    assert found["inclusion: outlines, 4 px, quadratic"] <= 0.1
    assert found["polycrystal: outlines, 4 px, quadratic"] <= 0.3
    return found


if __name__ == "__main__":
    main()
