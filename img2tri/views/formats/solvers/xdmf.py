"""XDMF, as FEniCSx reads it: the cells in one file, the facets of all sets in another, each a single grid of one kind of cell.

Both files have the same points, in two coordinates where the mesh lies at z = 0, so the tags of facets find their edges in the mesh::

    text = XDMFFile.Encoding.ASCII
    with XDMFFile(MPI.COMM_WORLD, "femur.xdmf", "r", encoding=text) as file:
        mesh = file.read_mesh(name="Grid")
        regions = file.read_meshtags(mesh, name="Grid")
    mesh.topology.create_connectivity(1, 2)
    with XDMFFile(MPI.COMM_WORLD, "femur_facets.xdmf", "r", encoding=text) as file:
        facets = file.read_meshtags(mesh, name="Grid")

All numbers are in the XML itself, hence the encoding; so there is no HDF5 file that could get lost. The values are the labels of regions,
or, as measures in FEniCSx must not be negative, the next free number for labels below 1; and the tags of sets, see
`img2tri.views.objects.sets.numbers_in_files`. Where a set has pieces, a second Attribute, ``piece``, has their tags. XDMF has no place for
names of values; they are in an Information, where the reader of meshio finds them. The ends of wedges are triangles while their walls are
not, so they have a file of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.views.formats.number_rows import real_rows, whole_rows
from img2tri.views.formats.solvers.plain_text import label_table
from img2tri.views.formats.vtp_vtu import xml_comments
from img2tri.views.formats.xml_text import xml_escaped, xml_quoted
from img2tri.views.objects.sets.numbers_in_files import Z_MAX, Z_MIN
from img2tri.views.objects.solver_cells import Cells

TOPOLOGIES = {
    "triangle": "Triangle",
    "triangle6": "Triangle_6",
    "wedge": "Wedge",
    "wedge15": "Wedge_15",
    "tetra": "Tetrahedron",
    "tetra10": "Tetrahedron_10",
}
_LINES = {2: "Polyline", 3: "Edge_3"}
_FACES = {4: "Quadrilateral", 8: "Quadrilateral_8", 3: "Triangle", 6: "Triangle_6"}
FACETS_FILE, ENDS_FILE = "_facets", "_ends"

_GRID = """<?xml version="1.0" encoding="UTF-8"?>
{notes}<Xdmf Version="3.0"><Domain><Grid Name="Grid" GridType="Uniform">
<Geometry GeometryType="{space}">
{points}
</Geometry>
<Topology TopologyType="{kind}" NumberOfElements="{count}" NodesPerElement="{nodes}">
{cells}
</Topology>
{attributes}{time}<Information Name="names" Value="{named}"><![CDATA[<main>{names}</main>]]></Information>
</Grid></Domain></Xdmf>
"""


def xdmf(made: Cells, *, timed: bool = False) -> dict[str, bytes]:
    """Write a mesh as XDMF.

    Parameters
    ----------
    made
        The mesh; its texts become comments.
    timed
        True: with a time, 0, without which pyvista cannot read XDMF, and with which meshio cannot. Both readings go by the letter of
        the format; FEniCSx and ParaView read either.

    Returns
    -------
    dict
        The bytes of the files: of the cells with their regions under "", of the facets with the tags of their sets under "_facets", and,
        for solids, of the bottom and top under "_ends". Without any set there is no such file.
    """
    points = made.points if made.solid or made.points[:, 2].any() else made.points[:, :2]
    inside = 3 if made.solid else 2
    head = (xml_comments(made.texts | label_table(made)), '<Time Value="0"/>\n' if timed else "", points)
    own = made.ids
    ids = {name: own[label] for label, name in made.names.items()}
    labels, which = np.unique(made.regions, return_inverse=True)
    numbers = np.array([own[label] for label in labels.tolist()])[which]
    values = [_attribute("region", numbers), *(_attribute(name, v) for name, v in made.cell_data.items())]
    values += [_attribute(name, v, "Node") for name, v in made.point_data.items()]
    files = {"": _grid_file(*head, TOPOLOGIES[made.kind], made.cells, values, ids, inside)}
    apart = made.kind.startswith("wedge")
    for ending, ends in ((FACETS_FILE, False), (ENDS_FILE, True)):
        names = [name for name in made.wholes if (name in (Z_MIN, Z_MAX) and apart) == ends]
        if names:
            facets = np.concatenate([made.facets(name) for name in names])
            tags = np.repeat([made.tags[name] for name in names], [len(made.sides[name]) for name in names])
            values = [_attribute("boundary", tags)]
            parts = {name: whole for name, whole in made.part_of.items() if whole in names}
            if parts:
                values.append(_attribute("piece", _pieces(made, names, tags)))
            topology = (_FACES if made.solid else _LINES)[facets.shape[1]]
            called = {name: made.tags[name] for name in (*names, *parts)}
            files[ending] = _grid_file(*head, topology, facets, values, called, inside - 1)
    return files


def _pieces(made: Cells, names: list[str], tags: Ints) -> Ints:
    """Return the tag of the piece of each facet, or that of its set if it is all one piece."""
    place = {(*row,): i for i, row in enumerate(np.concatenate([made.sides[name] for name in names]).tolist())}
    found = tags.copy()
    for name, whole in made.part_of.items():
        if whole in names:
            found[[place[*row] for row in made.sides[name].tolist()]] = made.tags[name]
    return found


def _grid_file(
    notes: str, time: str, points: Floats, kind: str, cells: Ints, attributes: list[str], names: Mapping[str, int], dimension: int
) -> bytes:
    maps = "".join(f'<map key={xml_quoted(key)} dim="{dimension}">{value}</map>' for key, value in names.items())
    return _GRID.format(
        notes=notes, time=time, space="XYZ"[: points.shape[1]], points=_item(points), kind=kind, count=len(cells), nodes=cells.shape[1],
        cells=_item(cells), attributes="".join(attributes), named=len(names), names=maps.replace("]]>", xml_escaped("]]>")),
    ).encode()  # fmt: skip


def _attribute(name: str, values: NDArray[Any], center: str = "Cell") -> str:
    """Write values of cells or nodes: one each, or as a vector, a tensor, or a matrix of as many as there are."""
    array = values.reshape(len(values), -1)
    kind = {1: "Scalar", 3: "Vector", 9: "Tensor"}.get(array.shape[1], "Matrix")
    return f'<Attribute Name={xml_quoted(name)} AttributeType="{kind}" Center="{center}">\n{_item(array)}\n</Attribute>\n'


def _item(array: NDArray[Any]) -> str:
    """Write an array as a DataItem; a column is a row of one dimension."""
    kind = "Float" if array.dtype.kind == "f" else "Int"
    shape = array.shape if array.shape[1] > 1 else array.shape[:1]
    body = real_rows(array) if kind == "Float" else whole_rows(array.astype(np.int64))
    return f'<DataItem DataType="{kind}" Precision="8" Dimensions="{" ".join(map(str, shape))}" Format="XML">\n{body}</DataItem>'
