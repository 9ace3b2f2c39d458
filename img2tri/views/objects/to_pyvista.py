"""For pyvista users: a plane mesh -> `pyvista.PolyData`, or an `UnstructuredGrid` of triangles or wedges.

Nothing here draws: VTK without its GL libraries ends the process.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from img2tri.errors import ParameterError, integer
from img2tri.views.objects.flat_or_extruded import Surface, surface
from img2tri.views.objects.wedges import checked_order, quadratic, stacked, wedges

if TYPE_CHECKING:
    import pyvista

D = TypeVar("D", bound="pyvista.DataSet")


def to_pyvista(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> pyvista.PolyData:
    """Make a `pyvista.PolyData` of a plane mesh.

    Parameters and errors are those of `img2tri.views.objects.flat_or_extruded.surface`. With `height`, the object is the closed surface
    of the solid: without open edges, with volume = area x height.

    Returns
    -------
    pyvista.PolyData
        With float64 points, the cell array "region" (int32, active) and those of `cell_data`, and `field_data` as texts.

    Examples
    --------
    >>> flat = to_pyvista([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], [7])
    >>> flat.n_cells, flat.area, flat["region"].tolist()
    (1, 2.0, [7])
    """
    return poly_data(surface(vertices, triangles, regions, z=z, height=height, cell_data=cell_data, field_data=field_data))


def to_elements(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    height: float | None = None,
    layers: int = 1,
    order: int = 1,
    z: float = 0.0,
    middles: ArrayLike | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> pyvista.UnstructuredGrid:
    """Make a `pyvista.UnstructuredGrid` for solvers: triangles, or with `height` wedges, linear or quadratic.

    Parameters and errors are those of `img2tri.views.objects.wedges.wedges` and `img2tri.views.objects.flat_or_extruded.surface`; without
    `height` the mesh stays flat, at `z`, and `layers` has to be 1.

    Returns
    -------
    pyvista.UnstructuredGrid
        Of TRIANGLE or QUADRATIC_TRIANGLE, WEDGE or QUADRATIC_WEDGE cells with float64 points; with the cell array "region" (int32, active)
        and those of `cell_data`, each wedge with the values of its triangle, and `field_data` as texts.

    Examples
    --------
    >>> solid = to_elements([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], height=3, layers=2, order=2)
    >>> solid.n_cells, solid.celltypes.tolist(), round(solid.volume, 9)
    (2, [26, 26], 6.0)
    """
    import pyvista

    flat = surface(vertices, triangles, regions, z=z, cell_data=cell_data, field_data=field_data)
    v = flat.points[:, :2]
    kind: Any
    if height is not None:
        points, cells, _ = wedges(v, flat.faces, height=height, layers=layers, order=order, z=z, middles=middles)
        kind = pyvista.CellType.WEDGE if order == 1 else pyvista.CellType.QUADRATIC_WEDGE
    elif integer("layers", layers, least=1) > 1:
        raise ParameterError(f"layers: expected 1 for a flat mesh, found {layers}; give a height too")
    elif checked_order(order, middles) == 1:
        points, cells, kind = flat.points, flat.faces, pyvista.CellType.TRIANGLE
    else:
        nodes, cells = quadratic(v, flat.faces, middles=middles)
        points, kind = stacked(nodes, np.array([z])), pyvista.CellType.QUADRATIC_TRIANGLE
    return _with_data(pyvista.UnstructuredGrid({kind: cells}, points), flat, layers)


def poly_data(made: Surface) -> pyvista.PolyData:
    """Make a PolyData of a surface."""
    import pyvista

    faces: Any = made.faces
    whole: pyvista.PolyData = pyvista.PolyData.from_regular_faces(made.points, faces)
    return _with_data(whole, made)


def triangle_grid(made: Surface) -> pyvista.UnstructuredGrid:
    """Make an UnstructuredGrid of the triangles of a surface."""
    import pyvista

    return _with_data(pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: made.faces}, made.points), made)


def _with_data(dataset: D, made: Surface, layers: int = 1) -> D:
    """Give each face, or each wedge of each layer, the values of its triangle."""
    for name, values in {**made.cell_data, "region": made.regions}.items():
        dataset.cell_data[name] = np.tile(values, layers)
    for name, text in made.field_data.items():
        dataset.field_data[name] = [text]
    dataset.set_active_scalars("region", preference="cell")
    return dataset
