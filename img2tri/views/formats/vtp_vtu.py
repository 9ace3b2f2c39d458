"""VTP and VTU, the XML formats of VTK: arrays -> the bytes of a file.

VTU is written here: VTK compresses with more effort than is worth it, and takes several times as long. Each array is cut into blocks, which
zlib compresses and base64 makes text, see https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html. VTP is written by VTK,
to memory: that leaves the file to the one place that also notices a full disk, which VTK does not report.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import FileError
from img2tri.views.formats.xml_text import xml_quoted
from img2tri.views.objects.flat_or_extruded import Surface
from img2tri.views.objects.to_pyvista import to_pyvista

VTK_TYPES = {"triangle": 5, "triangle6": 22, "wedge": 13, "wedge15": 26, "tetra": 10, "tetra10": 24}
_KINDS = {"i1": "Int8", "i2": "Int16", "i4": "Int32", "i8": "Int64", "u1": "UInt8", "u2": "UInt16", "u4": "UInt32", "u8": "UInt64"}
_KINDS |= {"f4": "Float32", "f8": "Float64"}
_BLOCK = 1 << 17  # bytes
_EFFORT = 1  # of zlib: more makes the files of meshes 1 % smaller and takes twice as long

Arrays = Mapping[str, NDArray[Any]]


def vtp(made: Surface) -> bytes:
    """Return the bytes of a VTP file, VTK's format for surfaces, with all arrays and texts."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer: Any = vtkXMLPolyDataWriter()
    writer.SetInputData(to_pyvista(made))
    writer.SetWriteToOutputString(True)
    writer.SetDataModeToBinary()
    if not writer.Write():
        raise FileError("VTK could not write the mesh, and does not say why")
    return str(writer.GetOutputString()).encode()


def vtu_of_surface(made: Surface) -> bytes:
    """Return the bytes of a VTU file, VTK's format for grids, of the triangles of a surface, with all arrays; the texts are comments."""
    cell_data = {**made.cell_data, "region": made.regions}
    return vtu_file(made.points, made.faces, "triangle", cell_data=cell_data, point_data=made.point_data, texts=made.field_data)


def vtu_file(
    points: Floats,
    cells: Ints,
    kind: str,
    *,
    cell_data: Arrays,
    point_data: Arrays,
    texts: Mapping[str, str],
    field_data: Arrays | None = None,
) -> bytes:
    """Return the bytes of a VTU file of cells of one kind, whose active array is ``region``; the texts become comments.

    meshio, through which solvers read VTU, ends the process at a text array.
    """
    size = cells.shape[1]
    width: Any = np.int32 if max(cells.size, len(points)) < 2**31 else np.int64
    ends, types = np.arange(size, cells.size + 1, size, dtype=width), np.full(len(cells), VTK_TYPES[kind], np.uint8)
    parts = {
        "PointData": "".join(_array(name, values) for name, values in point_data.items()),
        'CellData Scalars="region"': "".join(_array(name, values) for name, values in cell_data.items()),
        "Points": _array("Points", points),
        "Cells": _array("connectivity", cells.ravel().astype(width)) + _array("offsets", ends) + _array("types", types),
    }
    body = "".join(f"<{tag}>\n{text}</{tag.split()[0]}>\n" for tag, text in parts.items())
    fields = "".join(_array(name, values, tuples=True) for name, values in (field_data or {}).items())
    return (
        f'<?xml version="1.0"?>\n{xml_comments(texts)}<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n<FieldData>\n{fields}</FieldData>\n'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n{body}</Piece>\n</UnstructuredGrid>\n</VTKFile>\n'
    ).encode()


def xml_comments(texts: Mapping[str, str]) -> str:
    r"""Write texts as comments in XML, one in a line.

    Two hyphens would end a comment; so written, they are the same text to a JSON reader.

    Examples
    --------
    >>> xml_comments({"img2tri": '"--8px"'})
    '<!-- img2tri: "-\\u002d8px" -->\n'
    """
    return "".join("<!-- {} -->\n".format(f"{name}: {text}".replace("--", "-\\u002d")) for name, text in texts.items())


def _array(name: str, values: NDArray[Any], *, tuples: bool = False) -> str:
    """Write an array: blocks, bytes of a block, bytes of the last one if it is shorter, compressed bytes of each; and then the blocks."""
    array = np.ascontiguousarray(values.view(np.uint8) if values.dtype == np.bool_ else values)
    array = array.astype(array.dtype.newbyteorder("<"), copy=False)
    data = array.tobytes()
    blocks = [zlib.compress(data[i : i + _BLOCK], _EFFORT) for i in range(0, len(data), _BLOCK)]
    head = np.array([len(blocks), _BLOCK, len(data) % _BLOCK, *map(len, blocks)], "<u8").tobytes()
    text = (base64.b64encode(head) + base64.b64encode(b"".join(blocks))).decode()
    columns = f' NumberOfComponents="{array.shape[1]}"' if array.ndim > 1 else ""
    count = f' NumberOfTuples="{len(array)}"' if tuples else ""
    return (
        f'<DataArray type="{_KINDS[array.dtype.str[1:]]}" Name={xml_quoted(name)}{columns}{count} format="binary">\n{text}\n</DataArray>\n'
    )
