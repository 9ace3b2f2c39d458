"""XDMF, as FEniCSx reads it: the cells in one file, the facets of all sets in another, each a single grid of one kind of cell.

Both files have the same points, in two coordinates where the mesh is flat, so the tags of facets find their edges in the mesh::

    text = XDMFFile.Encoding.ASCII
    with XDMFFile(MPI.COMM_WORLD, "femur.xdmf", "r", encoding=text) as file:
        mesh = file.read_mesh(name="Grid")
        regions = file.read_meshtags(mesh, name="Grid")
    mesh.topology.create_connectivity(1, 2)
    with XDMFFile(MPI.COMM_WORLD, "femur_facets.xdmf", "r", encoding=text) as file:
        facets = file.read_meshtags(mesh, name="Grid")

All numbers are in the XML itself, hence the encoding; so there is no HDF5 file that could get lost. The values are the labels of regions,
or, as measures in FEniCSx must not be negative, the next free number for labels below 1; and the tags of sets. XDMF has no place for
names of values; they are in an Information, where the reader of meshio finds them. The ends of solids are triangles while their walls
are not, so they have a file of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.views.formats.stl_ply_obj_off import rows
from img2tri.views.formats.vtp_vtu import xml_comments
from img2tri.views.objects.solver_cells import Z_MAX, Z_MIN, Cells

_TOPOLOGIES = {"triangle": "Triangle", "triangle6": "Triangle_6", "wedge": "Wedge", "wedge15": "Wedge_15"}
_FACET_TOPOLOGIES = {2: "Polyline", 3: "Edge_3", 4: "Quadrilateral", 8: "Quadrilateral_8"}
_END_TOPOLOGIES = {3: "Triangle", 6: "Triangle_6"}
FACETS_FILE, ENDS_FILE = "_facets", "_ends"

_GRID = """<?xml version="1.0" encoding="UTF-8"?>
{notes}<Xdmf Version="3.0"><Domain><Grid Name="Grid" GridType="Uniform">
<Geometry GeometryType="{space}">
{points}
</Geometry>
<Topology TopologyType="{kind}" NumberOfElements="{count}" NodesPerElement="{nodes}">
{cells}
</Topology>
<Attribute Name="{name}" AttributeType="Scalar" Center="Cell">
{values}
</Attribute>
{time}<Information Name="names" Value="{named}"><![CDATA[<main>{names}</main>]]></Information>
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
    points = made.points if made.solid else made.points[:, :2]
    inside = 3 if made.solid else 2
    head = (xml_comments(made.texts), '<Time Value="0"/>\n' if timed else "", points)
    ids = {name: made.ids[label] for label, name in made.names.items()}
    labels, which = np.unique(made.regions, return_inverse=True)
    numbers = np.array([made.ids[label] for label in labels.tolist()])[which]
    files = {"": _grid_file(*head, _TOPOLOGIES[made.kind], made.cells, "region", numbers, ids, inside)}
    for ending, types, ends in ((FACETS_FILE, _FACET_TOPOLOGIES, False), (ENDS_FILE, _END_TOPOLOGIES, True)):
        names = [name for name in made.sides if (name in (Z_MIN, Z_MAX) and made.solid) == ends]
        if names:
            facets = [made.facets(name) for name in names]
            tags = {name: made.tags[name] for name in names}
            values = np.repeat(list(tags.values()), list(map(len, facets)))
            files[ending] = _grid_file(*head, types[facets[0].shape[1]], np.concatenate(facets), "boundary", values, tags, inside - 1)
    return files


def _grid_file(
    notes: str, time: str, points: Floats, kind: str, cells: Ints, name: str, values: Ints, names: Mapping[str, int], dimension: int
) -> bytes:
    maps = "".join(f'<map key={quoteattr(key)} dim="{dimension}">{value}</map>' for key, value in names.items())
    return _GRID.format(
        notes=notes, time=time, space="XYZ"[: points.shape[1]], points=_item(points), kind=kind, count=len(cells), nodes=cells.shape[1],
        cells=_item(cells), name=name, values=_item(values[:, None]), named=len(names), names=maps.replace("]]>", escape("]]>")),
    ).encode()  # fmt: skip


def _item(array: NDArray[Any]) -> str:
    """Write an array as a DataItem; a column is a row of one dimension."""
    kind = "Float" if array.dtype.kind == "f" else "Int"
    shape = array.shape if array.shape[1] > 1 else array.shape[:1]
    body = "\n".join(rows(" ".join(["{!r}"] * array.shape[1]), array))
    return f'<DataItem DataType="{kind}" Precision="8" Dimensions="{" ".join(map(str, shape))}" Format="XML">\n{body}\n</DataItem>'
