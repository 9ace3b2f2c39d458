"""For trimesh users: a plane mesh -> a `trimesh.Trimesh`, flat or closed, and the bytes of a GLB file.

trimesh accepts plane vertices, but its exporters do not; so vertices always have three coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from img2tri.views.figures.colours import palette
from img2tri.views.objects.surface import Surface, surface

if TYPE_CHECKING:
    import trimesh


def to_trimesh(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> trimesh.Trimesh:
    """Make a `trimesh.Trimesh` of a plane mesh; nothing is merged, dropped or reordered.

    Parameters and errors are those of `img2tri.views.objects.surface.surface`. With `height`, the object is the closed surface of the
    solid:
    watertight, with volume = area x height.

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

    made = surface(vertices, triangles, regions, z=z, height=height, cell_data=cell_data, field_data=field_data)
    return trimesh.Trimesh(
        made.points,
        made.faces,
        face_attributes={"region": made.regions, **made.cell_data},
        metadata={**made.field_data, "regions": np.unique(made.regions).tolist()},
        process=False,
    )


def glb(made: Surface) -> bytes:
    """Return the bytes of a GLB file: a mesh in its colour for each region, such as `region_3`; texts as extras of the scene.

    glTF holds coordinates as float32 and knows no unit but the metre; they are written as they are.
    """
    import trimesh

    visual: Any = trimesh.visual
    labels = np.unique(made.regions)
    scene: Any = trimesh.Scene(metadata={**made.field_data, "regions": labels.tolist()})
    for label, colour in zip(labels.tolist(), palette(len(labels)).tolist(), strict=True):
        material = visual.material.PBRMaterial(
            name=f"region_{label}", baseColorFactor=[*colour, 255], metallicFactor=0.0, roughnessFactor=0.8, doubleSided=not made.closed
        )
        part = trimesh.Trimesh(made.points, made.faces[made.regions == label], metadata={"region": label}, process=False)
        part.remove_unreferenced_vertices()
        part.visual = visual.TextureVisuals(material=material)
        scene.add_geometry(part, node_name=f"region_{label}", geom_name=f"region_{label}")
    return bytes(scene.export(file_type="glb"))
