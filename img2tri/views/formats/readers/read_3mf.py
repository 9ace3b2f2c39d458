"""3MF read back: the bytes of a file -> triangles in space, the surface of a solid or a plane mesh, with regions and their names.

Of files of img2tri the regions are the objects, or in a plane mesh the colours of its triangles; of others each object is one, numbered in
order. Components and transformations, which are for arranging parts on a plate, are not followed.
"""

from __future__ import annotations

import io
import zipfile
from xml.etree import ElementTree

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.views.formats.readers.file_contents import Found

_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def parse_3mf(data: bytes) -> Found:
    """Read all objects of a 3MF.

    Raises
    ------
    ValueError, KeyError, IndexError
        If it is damaged, or no 3MF.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        root = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    notes = {str(note.get("name")).removeprefix("img2tri:"): note.text or "" for note in root.iter(f"{_CORE}metadata")}
    listed = [int(label) for label in notes.pop("regions", "").split()]
    objects = [found for found in root.iter(f"{_CORE}object") if found.find(f"{_CORE}mesh") is not None]
    places, faces, regions, names, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)], {}, 0
    for number, one in enumerate(objects):
        points, corners, colours = _mesh_of(one)
        if len(listed) == len(objects) and one.get("type") != "surface":
            labels = np.full(len(corners), listed[number])
        elif listed and len(objects) == 1:
            labels = np.array(listed)[colours]
        else:
            labels = np.full(len(corners), number + 1)
        if one.get("type") != "surface":
            names[int(labels[0]) if len(labels) else 0] = one.get("name") or f"region_{number + 1}"
        places.append(points)
        faces.append(corners + count)
        regions.append(labels)
        count += len(points)
    return Found(np.concatenate(places), np.concatenate(faces), "triangle", np.concatenate(regions), names, {}, texts=notes)


def _mesh_of(one: ElementTree.Element) -> tuple[Floats, Ints, Ints]:
    """Return the points, the triangles and the number of the colour of each, 0 without one."""
    points = [[float(vertex.get(axis, "")) for axis in "xyz"] for vertex in one.iter(f"{_CORE}vertex")]
    rows = [[int(face.get(name, "")) for name in ("v1", "v2", "v3")] + [int(face.get("p1", 0))] for face in one.iter(f"{_CORE}triangle")]
    table = np.array(rows, np.int64).reshape(-1, 4)
    if len(table) and not 0 <= table[:, :3].min() <= table[:, :3].max() < len(points):
        raise ValueError("it has triangles with vertices that are not there")
    return np.array(points, np.float64).reshape(-1, 3), table[:, :3], table[:, 3]
