"""For pyvista users: a plane mesh, flat or with a thickness -> `pyvista.PolyData`.

Nothing here draws: VTK without its GL libraries ends the process.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from img2tri.views.objects.flat_or_extruded import Surface

if TYPE_CHECKING:
    import pyvista


def to_pyvista(made: Surface) -> pyvista.PolyData:
    """Make a `pyvista.PolyData` of the triangles in space.

    Of a solid it is the closed surface: without open edges, with volume = area x height.

    Returns
    -------
    pyvista.PolyData
        With float64 points, the cell array "region" (int32, active) and those of `cell_data`, and `field_data` as texts.

    Examples
    --------
    >>> from img2tri.views.objects.flat_or_extruded import surface
    >>> flat = to_pyvista(surface([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], [7]))
    >>> flat.n_cells, flat.area, flat["region"].tolist()
    (1, 2.0, [7])
    """
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
