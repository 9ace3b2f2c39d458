"""VTP and VTU read back: XML whose arrays are numbers in text, base64 or raw bytes, compressed or not -> triangles and their regions.

VTK itself ends the process where a damaged file announces more blocks than there is memory for. So files, which may come from anywhere, are
read here, where each size is compared with the bytes there are. The layout is that of
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import base64
import re
import zlib
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, parts_of_fields
from img2tri.views.formats.vtp_vtu import VTK_TYPES
from img2tri.views.objects.solver_cells import CELL_SIDES

_KINDS = {f"{sign}Int{8 * size}": f"{letter}{size}" for sign, letter in (("", "i"), ("U", "u")) for size in (1, 2, 4, 8)}
_KINDS |= {"Float32": "f4", "Float64": "f8"}
_TRIANGLE = 5
_PASSED_OVER = [1, 2, 3, 4]  # vertices and lines, which meshes carry to mark their boundary


def by_xml(data: bytes, _suffix: str) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None]:
    """Read points (p, 3), triangles (k, 3) and the cell array `region`, or None, of all pieces of a VTP or VTU.

    Raises
    ------
    MeshError
        If there are cells other than triangles, vertices and lines.
    ValueError, KeyError, AttributeError, ElementTree.ParseError, zlib.error
        If the file is damaged, or compressed by something else than zlib.
    """
    root, coding = _opened(data)
    points, triangles, regions, count = [], [], [], 0
    for piece in root.iter("Piece"):
        points.append(coding.array(piece.find("Points/DataArray")).reshape(-1, 3))
        corners, rows = _piece_triangles(piece, coding)
        triangles.append(corners + count)
        count += len(points[-1])
        array = piece.find("CellData/DataArray[@Name='region']")
        regions.append(None if array is None else coding.array(array)[rows])
    labels = [part for part in regions if part is not None]
    return np.concatenate(points), np.concatenate(triangles), np.concatenate(labels) if len(labels) == len(regions) else None


def parse_vtp_vtu(data: bytes) -> Found:
    """Read a VTP or VTU with all it holds: cells of one kind, or triangles among vertices and lines.

    Raises
    ------
    MeshError, ValueError, KeyError, AttributeError, ElementTree.ParseError, zlib.error
        As `by_xml`.
    """
    root, coding = _opened(data)
    pieces = list(root.iter("Piece"))
    grid = pieces[0].find("Cells") if len(pieces) == 1 else None
    number = 0 if grid is None else int(coding.array(grid.find("DataArray[@Name='types']")).max(initial=0))
    kind = {number: kind for kind, number in VTK_TYPES.items()}.get(number, "triangle")
    if grid is None or kind == "triangle":
        points, cells, regions = by_xml(data, "")
        rows = _piece_triangles(pieces[0], coding)[1] if len(pieces) == 1 else np.arange(0)
    else:
        points = coding.array(pieces[0].find("Points/DataArray")).reshape(-1, 3)
        cells, rows = _one_kind(grid, coding, number, kind), np.arange(0)
        rows = np.arange(len(cells))
        array = pieces[0].find("CellData/DataArray[@Name='region']")
        regions = None if array is None else coding.array(array)
    labels = np.ones(len(cells), np.int64) if regions is None else np.asarray(regions).astype(np.int64)
    kept = len(pieces) == 1
    cell_data = _arrays(pieces[0], "CellData", coding) if kept else {}
    point_data = _arrays(pieces[0], "PointData", coding) if kept else {}
    fields = {name: values for block in root.iter("FieldData") for name, values in _arrays(block, ".", coding).items()}
    texts = dict(re.findall(r"<!-- (\w+): (.*) -->", data.partition(b"<VTKFile")[0].decode()))
    texts |= {name: _text(values) for name, values in fields.items() if name in ("img2tri", "units")}
    names, facets = parts_of_fields(fields, labels, texts)
    cell_data = {name: values[rows] for name, values in cell_data.items() if name != "region"}
    place = np.asarray(points, np.float64)
    return Found(place, np.asarray(cells, np.int64), kind, labels, names, facets, cell_data, point_data, texts)


def _opened(data: bytes) -> tuple[ElementTree.Element, _Coding]:
    """Return the XML of a file without what is appended to it, and how its arrays are written."""
    text, mark, rest = data.partition(b"<AppendedData")
    root = ElementTree.fromstring(text + b"</VTKFile>" if mark else text)
    return root, _Coding(
        order={"LittleEndian": "<", "BigEndian": ">"}[root.attrib["byte_order"]],
        header={"UInt32": "u4", "UInt64": "u8"}[root.get("header_type", "UInt32")],
        compressed={"": False, "vtkZLibDataCompressor": True}[root.get("compressor", "")],
        appended=rest.partition(b"_")[2],
        raw=b'"raw"' in rest.partition(b">")[0],
    )


def _arrays(parent: ElementTree.Element, where: str, coding: _Coding) -> dict[str, NDArray[Any]]:
    """Return the arrays of numbers in a part of a file, by name."""
    found = {}
    for element in parent.iterfind(f"{where}/DataArray") if where != "." else parent.iterfind("DataArray"):
        values, columns = coding.array(element), int(element.get("NumberOfComponents", 1))
        found[element.attrib["Name"]] = values.reshape(-1, columns) if columns > 1 else values
    for element in parent.iterfind("Array[@type='String']") if where == "." else ():
        found[element.attrib["Name"]] = coding.array(element)
    return found


def _text(values: NDArray[Any]) -> str:
    """Return the text of an array of characters, which ends with a zero."""
    return bytes(values.astype(np.uint8)).split(b"\0")[0].decode()


def _one_kind(grid: ElementTree.Element, coding: _Coding, number: int, kind: str) -> NDArray[Any]:
    arrays = {array.get("Name"): coding.array(array) for array in grid.iterfind("DataArray")}
    if np.any(arrays["types"] != number):
        raise MeshError("expected cells that are all triangles, all wedges or all tetrahedra, found several kinds")
    width = len({node for side in CELL_SIDES[kind] for node in side})
    nodes, ends = arrays["connectivity"].astype(np.int64), arrays["offsets"].astype(np.int64)
    if not np.array_equal(ends, width * np.arange(1, len(ends) + 1)) or len(nodes) != width * len(ends):
        raise ValueError("its cells do not fit together")
    return nodes.reshape(-1, width)


def _piece_triangles(piece: ElementTree.Element, coding: _Coding) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the corners (k, 3) of the triangles of a piece, and the rows (k,) they have in its cell arrays."""
    grid = piece.find("Cells")
    cells = {array.get("Name"): coding.array(array) for array in piece.iterfind(f"{'Polys' if grid is None else 'Cells'}/DataArray")}
    ends = cells["offsets"].astype(np.int64)
    sizes = np.diff(ends, prepend=0)
    if grid is None:
        # The cells of a PolyData are numbered through its vertices, lines, polygons and strips, in this order.
        before = sum(int(piece.get(f"NumberOf{kind}", 0)) for kind in ("Verts", "Lines"))
        wanted, others = sizes == 3, bool(np.any(sizes != 3) or int(piece.get("NumberOfStrips", 0)))
    else:
        before, kinds = 0, cells["types"]
        wanted, others = kinds == _TRIANGLE, not np.isin(kinds, [_TRIANGLE, *_PASSED_OVER]).all()
    if others:
        raise MeshError("expected triangles only, found cells of another kind; triangulate it first")
    if np.any(sizes < 0) or np.any(sizes[wanted] != 3) or (len(ends) and ends[-1] > len(cells["connectivity"])):
        raise ValueError("its cells do not fit together")
    corners = cells["connectivity"].astype(np.int64)[ends[wanted][:, None] + np.arange(-3, 0)]
    return corners, before + np.flatnonzero(wanted)


@dataclass(frozen=True)
class _Coding:
    """How the arrays of one file are written.

    Attributes
    ----------
    order, header
        Order of bytes and width of the sizes before each array, as numpy names them.
    compressed
        In blocks of zlib.
    appended, raw
        All that follows the underscore of AppendedData, and whether it is raw bytes rather than base64.
    """

    order: str
    header: str
    compressed: bool
    appended: bytes
    raw: bool

    def array(self, element: ElementTree.Element | None) -> NDArray[Any]:
        """Return the numbers of a DataArray."""
        if element is None:
            raise ValueError("an array is missing")
        kind = np.dtype(self.order + ("u1" if element.attrib["type"] == "String" else _KINDS[element.attrib["type"]]))
        words = (element.text or "").split()
        match element.get("format"):
            case "ascii":
                return np.array(words, kind)
            case "binary":
                return np.frombuffer(self._payload(_Stream("".join(words).encode(), raw=False)), kind)
            case _:
                return np.frombuffer(self._payload(_Stream(self.appended[int(element.attrib["offset"]) :], raw=self.raw)), kind)

    def _payload(self, stream: _Stream) -> bytes:
        size = np.dtype(self.header).itemsize
        if not self.compressed:
            # [bytes][data], in base64 coded as one or, with the padding of its own, apart.
            (count,) = self._sizes(stream.take(0, size))
            if stream.padded(size):
                return stream.take(stream.after(size), count)
            return stream.take(0, size + count)[size:]
        # [blocks][bytes of a block][bytes of the last, 0: as the others][compressed bytes of each], and then the blocks
        blocks, length, last = self._sizes(stream.take(0, 3 * size))
        head = (3 + blocks) * size
        packed = self._sizes(stream.take(0, head))[3:]
        data, at, out = stream.take(stream.after(head), sum(packed)), 0, []
        for i, count in enumerate(packed):
            most = last if last and i == blocks - 1 else length
            out.append(zlib.decompressobj().decompress(data[at : at + count], most))
            if len(out[-1]) < most:
                raise ValueError("it is cut short")
            at += count
        return b"".join(out)

    def _sizes(self, data: bytes) -> list[int]:
        return [int(value) for value in np.frombuffer(data, self.order + self.header)]


@dataclass(frozen=True)
class _Stream:
    """Bytes, or base64 in which each part begins with a group of four characters of its own."""

    data: bytes
    raw: bool

    def after(self, count: int) -> int:
        """Return where the part after one of `count` bytes begins."""
        return count if self.raw else -(-count // 3) * 4

    def padded(self, count: int) -> bool:
        """Tell whether a part ends after its first `count` bytes."""
        return self.raw or self.data[self.after(count) - 1 : self.after(count)] == b"="

    def take(self, at: int, count: int) -> bytes:
        """Return `count` bytes of the part that begins at `at`; fail if they are not there."""
        if at + self.after(count) > len(self.data):
            raise ValueError("it is cut short")
        piece = self.data[at : at + self.after(count)]
        return piece if self.raw else base64.b64decode(piece)[:count]
