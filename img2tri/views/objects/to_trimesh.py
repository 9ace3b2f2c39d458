"""For trimesh users: a plane mesh, flat or with a thickness -> a `trimesh.Trimesh`.

trimesh accepts plane vertices, but its exporters do not; so vertices always have three coordinates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from img2tri.views.objects.flat_or_extruded import Surface

if TYPE_CHECKING:
    import trimesh


def to_trimesh(made: Surface) -> trimesh.Trimesh:
    """Make a `trimesh.Trimesh` of the triangles in space; nothing is merged, dropped or reordered.

    Of a solid it is the closed surface: watertight, with volume = area x height.

    Returns
    -------
    trimesh.Trimesh
        With ``face_attributes["region"]`` (int32) and the arrays of `cell_data`; its ``metadata`` holds `field_data` and "regions", the
        list of all of them. ``field_data["units"]`` is what trimesh takes as the unit.

    Examples
    --------
    >>> from img2tri.views.objects.flat_or_extruded import surface
    >>> solid = to_trimesh(surface([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], height=3, field_data={"units": "mm"}))
    >>> solid.is_watertight, float(round(solid.volume, 9)), solid.units
    (True, 6.0, 'mm')
    """
    import trimesh

    return trimesh.Trimesh(
        made.points,
        made.faces,
        face_attributes={"region": made.regions, **made.cell_data},
        vertex_attributes=dict(made.point_data),
        metadata={**made.field_data, "regions": np.unique(made.regions).tolist()},
        process=False,
    )
