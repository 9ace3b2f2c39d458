"""GLB, the format of viewers on the web: a surface -> the bytes of a file; trimesh writes it."""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.views.figures.colours import palette
from img2tri.views.objects.flat_or_extruded import Surface


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
