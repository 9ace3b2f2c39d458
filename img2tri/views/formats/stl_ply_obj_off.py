"""The plain formats: a surface -> the bytes of an STL, PLY, OBJ or OFF file.

Written here in a few lines rather than by trimesh, which rounds PLY coordinates to float32, puts no groups in an OBJ, and takes a second to
import; and rather than by VTK, which drops the cell data. The bytes depend on the mesh alone.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ParameterError
from img2tri.views.formats.number_rows import EXACT, exact_doubles, real_rows, whole_rows
from img2tri.views.objects.flat_or_extruded import Surface
from img2tri.views.objects.sets.numbers_in_files import file_numbers

_STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl(made: Surface) -> bytes:
    """Binary STL: corners and normals as float32; no regions, no unit."""
    corners = made.points.astype("<f4")[made.faces]
    faces = np.zeros(len(corners), _STL_FACE)
    faces["corners"] = corners
    # Normals of the triangles as stored, so that a reader who computes them finds the same.
    if made.closed:
        normals = np.cross(*(corners[:, i].astype(np.float64) - corners[:, 0] for i in (1, 2)))
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        faces["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    else:
        (ux, uy), (vx, vy) = ((corners[:, i, :2].astype(np.float64) - corners[:, 0, :2]).T for i in (1, 2))
        faces["normal"][:, 2] = np.sign(ux * vy - uy * vx)
    return b"binary STL by img2tri".ljust(80) + len(faces).to_bytes(4, "little") + faces.tobytes()


def ply(made: Surface) -> bytes:
    """Binary PLY: float64 coordinates; for each face an int `region` and all cell data, whole numbers as int; texts as comments.

    Labels that neither int nor double holds are numbered anew, with a comment ``labels`` of these by their numbers.

    Values of points are properties of theirs; arrays of several columns become a property each, such as ``flow_1``.
    """
    regions, notes = made.regions, _one_line_notes(made)
    if np.abs(regions.astype(np.float64)).max() > EXACT:
        # No number of the format holds these labels.
        labels, which = np.unique(regions, return_inverse=True)
        numbers = file_numbers(labels.tolist())
        regions = np.array([numbers[label] for label in labels.tolist()])[which]
        notes.append(f"labels: {json.dumps({number: label for label, number in numbers.items()})}")
    faces = _columns({"region": regions, **made.cell_data}, "vertex_indices")
    points = _columns(made.point_data, "x", "y", "z")
    # A row per face: 3, its corners, its values, without gaps; and per point its coordinates and values.
    face_rows = _table({"count": np.full(len(made.faces), 3, "u1"), "corners": made.faces.astype("<i4")}, faces)
    point_rows = _table({"place": made.points.astype("<f8")}, points)
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {note}" for note in notes),
        f"element vertex {len(made.points)}",
        *(f"property double {axis}" for axis in "xyz"),
        *_properties(points),
        f"element face {len(faces['region'])}",
        "property list uchar int vertex_indices",
        *_properties(faces),
        "end_header\n",
    ]
    return "\n".join(header).encode() + point_rows.tobytes() + face_rows.tobytes()


def _columns(arrays: Mapping[str, NDArray[Any]], *taken: str) -> dict[str, NDArray[Any]]:
    """Return the properties of arrays: as int where that holds all values, else as double; no name twice, nor one that is `taken`."""
    found: dict[str, NDArray[Any]] = {}
    for name, values in arrays.items():
        plain = "_".join(name.split())
        parts = {plain: values} if values.ndim == 1 else {f"{plain}_{i}": column for i, column in enumerate(values.T, 1)}
        for each, column in parts.items():
            if each in found or each in taken:
                raise ParameterError(
                    f"data: expected names that differ in .ply too, found {name!r}, whose property {each} is there already"
                )
            found[each] = column.astype("<i4") if _fits_int32(column) else exact_doubles(name, column)
    return found


def _properties(columns: Mapping[str, NDArray[Any]]) -> list[str]:
    return [f"property {'int' if values.dtype.kind == 'i' else 'double'} {name}" for name, values in columns.items()]


def _table(first: Mapping[str, NDArray[Any]], others: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    columns = {**first, **{f"of {name}": values for name, values in others.items()}}
    table = np.zeros(len(next(iter(columns.values()))), np.dtype([(name, a.dtype, a.shape[1:]) for name, a in columns.items()]))
    for name, values in columns.items():
        table[name] = values
    return table


def obj(made: Surface) -> bytes:
    """Wavefront OBJ: all digits of the coordinates; the faces of each region in a group such as `region_3`; texts as comments."""
    parts = [*(f"# {note}\n" for note in _one_line_notes(made)), real_rows(made.points, before="v ")]
    for region in np.unique(made.regions):
        parts += [f"g region_{region}\n", whole_rows(made.faces[made.regions == region] + 1, before="f ")]
    return "".join(parts).encode()


def off(made: Surface) -> bytes:
    """OFF: all digits of the coordinates; no regions."""
    head = f"OFF\n{len(made.points)} {len(made.faces)} 0\n"
    return (head + real_rows(made.points) + whole_rows(made.faces, before="3 ")).encode()


def _one_line_notes(made: Surface) -> list[str]:
    return [f"{name}: {text}".replace("\n", "\\n").replace("\r", "\\r") for name, text in made.field_data.items()]


def _fits_int32(values: NDArray[Any]) -> bool:
    return values.dtype.kind in "biu" and bool(values.min() >= -(2**31) and values.max() < 2**31)
