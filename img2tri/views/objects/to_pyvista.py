"""For pyvista users: a plane mesh -> `pyvista.PolyData`, flat or closed.

Nothing here draws: VTK without its GL libraries ends the process.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from img2tri.views.objects.base_plate import Base
from img2tri.views.objects.flat_or_extruded import Surface, surface

if TYPE_CHECKING:
    import pyvista


def to_pyvista(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | Mapping[int, float] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    point_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    base: Base | None = None,
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
    return poly_data(
        surface(
            vertices, triangles, regions, z=z, height=height, cell_data=cell_data, point_data=point_data, field_data=field_data, base=base
        )
    )


def poly_data(made: Surface) -> pyvista.PolyData:
    """Make a PolyData of a surface."""
    import pyvista

    faces: Any = made.faces
    whole: pyvista.PolyData = pyvista.PolyData.from_regular_faces(made.points, faces)
    for name, values in {**made.cell_data, "region": made.regions}.items():
        whole.cell_data[name] = values
    for name, values in made.point_data.items():
        whole.point_data[name] = values
    for name, text in made.field_data.items():
        whole.field_data[name] = [text]
    whole.set_active_scalars("region", preference="cell")
    return whole
