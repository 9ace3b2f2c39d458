"""Cells in space -> a table of their quality: the walls of a solid, wedges, tetrahedra; measured by Verdict, through VTK."""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints

CORNERS = {"triangle": 3, "triangle6": 3, "wedge": 6, "wedge15": 6, "tetra": 4, "tetra10": 4}
LINEAR = {3: "triangle", 6: "wedge", 4: "tetra"}
NUMBERS_OF_VTK = {"triangle": 5, "wedge": 13, "tetra": 10}
MEASURES: dict[str, tuple[Any, ...]] = {
    "triangle": ("scaled_jacobian", "min_angle", "max_angle", "radius_ratio", "area"),
    "wedge": ("scaled_jacobian", "shape", "volume"),
    "tetra": ("scaled_jacobian", "min_angle", "radius_ratio", "volume"),
}


def solid_table(points: Floats, cells: Ints, kind: str) -> list[str]:
    """Return a table of the quality of cells in space.

    Parameters
    ----------
    points
        (p, 3) float64.
    cells, kind
        (m, k), and what they are, as in `img2tri.views.objects.solver_cells.Cells`; of quadratic cells the corners are measured.

    Returns
    -------
    list of str
        The number of cells, how many are turned over, and for each measure of Verdict the least, the mean and the greatest. The least
        angle of a tetrahedron is that between two of its sides.

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> solid_table(points, np.array([[0, 1, 2, 3]]), "tetra")[0]
    '1 tetra'
    """
    import pyvista

    corners = cells[:, : CORNERS[kind]]
    linear = LINEAR[corners.shape[1]]
    rows = np.concatenate([np.full((len(corners), 1), corners.shape[1]), corners], axis=1)
    grid = pyvista.UnstructuredGrid(rows.ravel(), np.full(len(corners), NUMBERS_OF_VTK[linear], np.uint8), points)
    measured = grid.cell_quality(list(MEASURES[linear]))
    turned = int((np.asarray(measured.cell_data["scaled_jacobian"]) < 0).sum()) if linear != "triangle" else 0
    lines = [f"{len(cells):,} {kind}" + (f", {turned} turned over" if turned else "")]
    lines.append(" " * 16 + "".join(f"{key:>12}" for key in ("min", "mean", "max")))
    for name in MEASURES[linear]:
        values = np.asarray(measured.cell_data[name], np.float64)
        lines.append(f"{name:<16}" + "".join(f"{figure:12.4g}" for figure in (values.min(), values.mean(), values.max())))
    return lines
