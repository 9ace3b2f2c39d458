"""STL, PLY, OBJ, OFF and GLB read back by trimesh: the bytes of a file -> triangles in space, with their regions where the format has them.

Whether the triangles are a plane mesh is for `img2tri.views.formats.save_load.load` to say.
"""

from __future__ import annotations

import io
import json
import re
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from img2tri.views.objects.flat_or_extruded import coincident_points

if TYPE_CHECKING:
    import trimesh


def by_trimesh(data: bytes, suffix: str) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None]:
    """Read points (p, 3), faces (k, 3) and regions (k,), or None, of STL, PLY, OBJ, OFF or GLB.

    In a PLY the regions are the face property `region`; in an OBJ or GLB, the numbers in the names of the parts, such as `region_3`.
    Points with the same coordinates become one where the format repeats them: STL for each face, OBJ and GLB for each part.
    """
    import trimesh

    scene = trimesh.load_scene(io.BytesIO(data), file_type=suffix[1:], process=False, split_groups=True)
    points, faces, regions, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], [], 0
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        part = scene.geometry[str(name)]
        if isinstance(part, trimesh.Trimesh):
            points.append(trimesh.transform_points(part.vertices, matrix))
            faces.append(np.asarray(part.faces) + count)
            named = scene.metadata.get("regions")
            label = named.get(str(name)) if isinstance(named, dict) else None
            regions.append(_face_regions(f"region_{label}" if isinstance(label, int) else str(name), part))
            count += len(points[-1])
    corners, joined = np.concatenate(points), np.concatenate(faces)
    if suffix == ".stl" or len(regions) > 1:
        place = coincident_points(corners)
        corners, joined = corners[np.unique(place, return_index=True)[1]], place[joined]
    labels = [_by_table(part, data) for part in regions if part is not None]
    return corners, joined, np.concatenate(labels) if labels and len(labels) == len(regions) else None


def _by_table(numbers: NDArray[Any], data: bytes) -> NDArray[Any]:
    """Return the labels of regions that a PLY has numbered anew, as its comment ``labels`` tells."""
    table = re.search(rb"^comment labels: (\{.*\})$", data.partition(b"end_header")[0], re.MULTILINE)
    if not data.startswith(b"ply") or table is None:
        return numbers
    known = {int(number): int(label) for number, label in json.loads(table[1]).items()}
    return np.array([known.get(number, number) for number in numbers.astype(np.int64).tolist()], np.int64)


def _face_regions(name: str, part: trimesh.Trimesh) -> NDArray[Any] | None:
    """Return the region of each face of a part, or None if it says nothing of regions."""
    faces = part.metadata.get("_ply_raw", {}).get("face", {}).get("data")
    names = faces.dtype.names if isinstance(faces, np.ndarray) else faces
    if names and "region" in names and len(faces["region"]) == len(part.faces):
        return np.asarray(faces["region"])
    number = re.fullmatch(r"region_(-?\d+)", name)
    return np.full(len(part.faces), int(number[1])) if number else None
