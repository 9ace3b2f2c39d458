"""XDMF read back: the text of a file whose numbers are in it -> cells of one kind, with regions, names and arrays.

What img2tri writes is read completely, the facets of the sets from the files beside it. Files with numbers in HDF5 are for others to read.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Ints
from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, labels_of
from img2tri.views.formats.solvers import xdmf

_KINDS = {topology: kind for kind, topology in xdmf.TOPOLOGIES.items()}


def is_plain_xdmf(data: bytes) -> bool:
    """Tell a file of one grid, with its numbers in it, as img2tri writes it."""
    return b'<Information Name="names"' in data and b'Format="HDF"' not in data


def parse_xdmf(path: Path) -> Found:
    """Read a file, and the files of facets beside it.

    Raises
    ------
    MeshError
        If there are no cells of a kind that is read.
    ValueError, KeyError, AttributeError, ElementTree.ParseError
        If the file is damaged, or has its numbers elsewhere.
    """
    grid, names = _grid(path)
    topology = _element(grid, "Topology")
    kind = _KINDS.get(topology.attrib["TopologyType"], "")
    if not kind:
        raise MeshError(f"expected cells that are all triangles, all wedges or all tetrahedra, found {topology.attrib['TopologyType']}")
    points = _numbers(_element(grid, "Geometry"))
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    cells = _numbers(topology).astype(np.int64)
    if cells.min(initial=0) < 0 or cells.max(initial=-1) >= len(points):
        raise ValueError("it has cells with nodes that are not there")
    arrays = {a.attrib["Name"]: (a.get("Center"), _numbers(a)) for a in grid.iterfind("Attribute")}
    numbers = arrays.pop("region", ("Cell", np.zeros(len(cells))))[1].astype(np.int64)
    texts = dict(re.findall(r"<!-- (\w+): (.*) -->", path.read_text(encoding="utf-8").partition("<Xdmf")[0]))
    labels, called = labels_of(numbers, {number: name for name, number in names.items()}, texts)
    facets: dict[str, Ints] = {}
    for ending in (xdmf.FACETS_FILE, xdmf.ENDS_FILE):
        beside = path.with_stem(path.stem + ending)
        if beside.exists():
            facets |= _facets(beside, len(points))
    of = {center: {name: values for name, (at, values) in arrays.items() if at == center} for center in ("Cell", "Node")}
    return Found(points, cells, kind, labels, called, facets, cell_data=of["Cell"], point_data=of["Node"], texts=texts)


def _facets(path: Path, points: int) -> dict[str, Ints]:
    """Return the nodes of the facets of each set and piece, if they are of a mesh of so many points."""
    grid, names = _grid(path)
    if len(_numbers(_element(grid, "Geometry"))) != points:
        return {}
    nodes = _numbers(_element(grid, "Topology")).astype(np.int64)
    tags = [_numbers(array) for array in grid.iterfind("Attribute")]
    found = {}
    for name, number in names.items():
        mine = next((tag == number for tag in tags if (tag == number).any()), np.zeros(len(nodes), bool))
        found[name] = nodes[mine]
    return {name: rows for name, rows in found.items() if len(rows)}


def _grid(path: Path) -> tuple[ElementTree.Element, dict[str, int]]:
    """Return the only grid of a file, and the numbers by their names, as img2tri and meshio write them."""
    from xml.sax.saxutils import unescape

    text = path.read_text(encoding="utf-8")
    maps = re.findall(r'<map key=("[^"]*"|\'[^\']*\') dim="\d">(\d+)</map>', text)
    names = {unescape(key[1:-1], {"&quot;": '"'}): int(number) for key, number in maps}
    return _element(ElementTree.fromstring(text), "Domain/Grid"), names


def _element(parent: ElementTree.Element, path: str) -> ElementTree.Element:
    found = parent.find(path)
    if found is None:
        raise ValueError(f"it has no {path}")
    return found


def _numbers(parent: ElementTree.Element) -> NDArray[Any]:
    """Return the numbers of a DataItem, in its shape."""
    item = _element(parent, "DataItem")
    if item.get("Format") != "XML":
        raise ValueError("expected its numbers in the file itself, found them elsewhere")
    kind = np.float64 if item.get("DataType") == "Float" else np.int64
    return np.array((item.text or "").split(), kind).reshape([int(size) for size in item.attrib["Dimensions"].split()])
