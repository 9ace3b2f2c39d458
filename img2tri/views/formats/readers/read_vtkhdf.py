"""VTKHDF read back by VTK: a path -> cells of one kind, with regions, names, sets and arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, parts_of_fields
from img2tri.views.formats.vtp_vtu import VTK_TYPES


def parse_vtkhdf(path: Path) -> Found:
    """Read a file.

    Raises
    ------
    MeshError
        If there are no cells of a kind that is read, or several kinds.
    """
    import pyvista

    grid = pyvista.read(path)
    blocks = dict(grid.cells_dict) if isinstance(grid, pyvista.UnstructuredGrid) else {}
    kinds = {number: kind for kind, number in VTK_TYPES.items()}
    if len(blocks) != 1 or not set(blocks) <= set(kinds):
        raise MeshError("expected cells that are all triangles, all wedges or all tetrahedra, found " + ("others" if blocks else "none"))
    ((number, cells),) = blocks.items()
    arrays = {name: np.asarray(grid.cell_data[name]) for name in grid.cell_data}
    regions = arrays.pop("region", np.zeros(len(cells), np.int64)).astype(np.int64)
    fields = {name: np.asarray(grid.field_data[name]) for name in grid.field_data}
    texts = {name: str(values[0]) for name, values in fields.items() if values.dtype.kind == "U" and values.size == 1}
    names, facets = parts_of_fields(fields, regions, texts)
    nodes = {name: np.asarray(grid.point_data[name]) for name in grid.point_data}
    points = np.asarray(grid.points, np.float64)
    return Found(points, np.asarray(cells, np.int64), kinds[int(number)], regions, names, facets, arrays, nodes, texts)
