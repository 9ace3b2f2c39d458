"""For trimesh users: a plane mesh -> a `trimesh.Trimesh`, flat or closed.

trimesh accepts plane vertices, but its exporters do not; so vertices always have three coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from img2tri.views.objects.base_plate import Base
from img2tri.views.objects.flat_or_extruded import surface

if TYPE_CHECKING:
    import trimesh


def to_trimesh(
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
) -> trimesh.Trimesh:
    """Make a `trimesh.Trimesh` of a plane mesh; nothing is merged, dropped or reordered.

    Parameters and errors are those of `img2tri.views.objects.flat_or_extruded.surface`. With `height`, the object is the closed surface
    of the solid: watertight, with volume = area x height.

    Returns
    -------
    trimesh.Trimesh
        With ``face_attributes["region"]`` (int32) and the arrays of `cell_data`; its ``metadata`` holds `field_data` and "regions", the
        list of all of them. ``field_data["units"]`` is what trimesh takes as the unit.

    Examples
    --------
    >>> solid = to_trimesh([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], height=3, field_data={"units": "mm"})
    >>> solid.is_watertight, float(round(solid.volume, 9)), solid.units
    (True, 6.0, 'mm')
    """
    import trimesh

    made = surface(
        vertices, triangles, regions, z=z, height=height, cell_data=cell_data, point_data=point_data, field_data=field_data, base=base
    )
    return trimesh.Trimesh(
        made.points,
        made.faces,
        face_attributes={"region": made.regions, **made.cell_data},
        vertex_attributes=dict(made.point_data),
        metadata={**made.field_data, "regions": np.unique(made.regions).tolist()},
        process=False,
    )
