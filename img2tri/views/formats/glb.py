"""GLB, the format of viewers on the web: bodies, flat or closed, each in its colour -> the bytes of a file; trimesh writes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from img2tri.views.objects.body_per_region import Body


def glb(made: Sequence[Body]) -> bytes:
    """Return the bytes of a GLB file: a mesh in its colour for each region, by its name; texts as extras of the scene.

    The extras hold the label of each region by its name. glTF has coordinates as float32 and knows no unit but the metre; they are written
    as they are.
    """
    import trimesh

    visual: Any = trimesh.visual
    scene: Any = trimesh.Scene(metadata={**made[0].surface.field_data, "regions": {body.name: body.label for body in made}})
    for body in made:
        closed = body.surface.closed
        material = visual.material.PBRMaterial(
            name=body.name, baseColorFactor=[*body.colour, 255], metallicFactor=0.0, roughnessFactor=0.8, doubleSided=not closed
        )
        part = trimesh.Trimesh(body.surface.points, body.surface.faces, metadata={"region": body.label}, process=False)
        part.visual = visual.TextureVisuals(material=material)
        scene.add_geometry(part, node_name=body.name, geom_name=body.name)
    return bytes(scene.export(file_type="glb"))
