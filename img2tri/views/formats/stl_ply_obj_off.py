"""The plain formats: a surface -> the bytes of an STL, PLY, OBJ or OFF file.

Written here in a few lines rather than by trimesh, which rounds PLY coordinates to float32, puts no groups in an OBJ, and takes a second to
import; and rather than by VTK, which drops the cell data. The bytes depend on the mesh alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.views.objects.flat_or_extruded import Surface

_STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl(made: Surface) -> bytes:
    """Binary STL: corners and normals as float32; no regions, no unit."""
    corners = made.points.astype("<f4")[made.faces]
    faces = np.zeros(len(corners), _STL_FACE)
    faces["corners"] = corners
    # Normals of the triangles as stored, so that a reader who computes them finds the same.
    normals = np.cross(*(corners[:, i].astype(np.float64) - corners[:, 0] for i in (1, 2)))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    faces["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return b"binary STL by img2tri".ljust(80) + len(faces).to_bytes(4, "little") + faces.tobytes()


def ply(made: Surface) -> bytes:
    """Binary PLY: float64 coordinates; for each face an int `region` and all cell data, whole numbers as int; texts as comments."""
    cells = {"region": made.regions, **{"_".join(name.split()): values for name, values in made.cell_data.items()}}
    kinds = {name: "i4" if _fits_int32(values) else "f8" for name, values in cells.items()}
    # A row per face: 3, its corners, its values, without gaps.
    fields = [("count", "u1"), ("corners", "<i4", 3), *((f"of {name}", "<" + kind) for name, kind in kinds.items())]
    faces = np.zeros(len(made.faces), np.dtype(fields))
    faces["count"], faces["corners"] = 3, made.faces
    for name, values in cells.items():
        faces[f"of {name}"] = values
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {note}" for note in _one_line_notes(made)),
        f"element vertex {len(made.points)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        *(f"property {'int' if kind == 'i4' else 'double'} {name}" for name, kind in kinds.items()),
        "end_header\n",
    ]
    return "\n".join(header).encode() + made.points.astype("<f8").tobytes() + faces.tobytes()


def obj(made: Surface) -> bytes:
    """Wavefront OBJ: all digits of the coordinates; the faces of each region in a group such as `region_3`; texts as comments."""
    lines: list[str] = [f"# {note}" for note in _one_line_notes(made)]
    lines += rows("v {!r} {!r} {!r}", made.points)
    for region in np.unique(made.regions):
        lines.append(f"g region_{region}")
        lines += rows("f {} {} {}", made.faces[made.regions == region] + 1)
    return ("\n".join(lines) + "\n").encode()


def off(made: Surface) -> bytes:
    """OFF: all digits of the coordinates; no regions."""
    lines = ["OFF", f"{len(made.points)} {len(made.faces)} 0", *rows("{!r} {!r} {!r}", made.points), *rows("3 {} {} {}", made.faces)]
    return ("\n".join(lines) + "\n").encode()


def rows(template: str, array: NDArray[Any]) -> list[str]:
    """Fill `template` with each row of `array`; ``{!r}`` writes the fewest digits that give the same float64 again.

    Examples
    --------
    >>> rows("v {!r} {!r}", np.array([[0.1, 1 / 3]]))
    ['v 0.1 0.3333333333333333']
    """
    return list(map(template.format, *array.T.tolist()))


def _one_line_notes(made: Surface) -> list[str]:
    return [f"{name}: {text}".replace("\n", "\\n").replace("\r", "\\r") for name, text in made.field_data.items()]


def _fits_int32(values: NDArray[Any]) -> bool:
    return values.dtype.kind in "biu" and bool(values.min() >= -(2**31) and values.max() < 2**31)
