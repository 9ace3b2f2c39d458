"""VTU and VTKHDF, the formats of VTK for meshes of cells, with the named parts as field data.

Cells and their values are those of the mesh, in its order, with the cell array ``region``. Under the name of each set of facets, the
field data hold the nodes of its facets, (k, 2 to 8) integers; under the name of each region, its label. So pyvista, ParaView and meshio
all find the names, and whoever only wants the cells is not disturbed by others between them. VTK writes some characters in names as they
are, though XML or HDF5 take them for something else; these become underscores.

VTK stamps each part of an HDF5 file with the time of writing, to no use; the stamps are set to 0, so that a mesh always gives the same
file.
"""

from __future__ import annotations

import re
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import FileError
from img2tri.views.formats.solvers.plain_text import distinct_names
from img2tri.views.formats.vtp_vtu import VTK_TYPES, vtu_file
from img2tri.views.objects.solver_cells import Cells

if TYPE_CHECKING:
    import pyvista

_CHUNK = 4096
# A message of the modification time in an object header of HDF5: type, size, flags, version, and the seconds.
_STAMP = re.compile(rb"(\x12\x00\x08\x00.\x00\x00\x00\x01\x00\x00\x00)(....)", re.DOTALL)


def to_grid(made: Cells, *, texts: bool = True) -> pyvista.UnstructuredGrid:
    """Make a `pyvista.UnstructuredGrid` of a mesh, its named parts as field data; `texts` too, unless they are not wanted.

    Examples
    --------
    >>> from img2tri.views.objects.solver_cells import flat_cells
    >>> grid = to_grid(flat_cells([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], [7], bounds=(0, 0, 9, 9)))
    >>> grid.field_data["left"].tolist(), grid.field_data["region_7"].tolist()
    ([[2, 0]], [7])
    """
    facets = {name: made.facets(name) for name in made.sides}
    grid = grid_of(made.points, made.cells, made.kind, made.regions, made.names, facets)
    for name, values in made.cell_data.items():
        grid.cell_data[name] = values
    for name, values in made.point_data.items():
        grid.point_data[name] = values
    for name, text in made.texts.items() if texts else ():
        grid.field_data[name] = [text]
    grid.set_active_scalars("region", preference="cell")
    return grid


def grid_of(
    points: Floats, cells: Ints, kind: str, regions: Ints, names: Mapping[int, str], facets: Mapping[str, Ints]
) -> pyvista.UnstructuredGrid:
    """Make a `pyvista.UnstructuredGrid` of cells, with their regions, the names of these, and the nodes of named facets."""
    import pyvista

    grid = pyvista.UnstructuredGrid({VTK_TYPES[kind]: cells}, points)
    grid.cell_data["region"] = as_regions(regions)
    called = distinct_names([*names.values(), *facets], array_name)
    for label, name in names.items():
        grid.field_data[called[name]] = np.array([label])
    for name, nodes in facets.items():
        grid.field_data[called[name]] = nodes
    return grid


def vtu(made: Cells) -> dict[str, bytes]:
    """Write a mesh as VTU; its texts become comments, as meshio, through which solvers read VTU, ends the process at a text array.

    Returns
    -------
    dict
        The bytes of the file, under "".
    """
    called = distinct_names([*made.names.values(), *made.sides], array_name)
    fields = {called[name]: np.array([label]) for label, name in made.names.items()}
    fields |= {called[name]: made.facets(name) for name in made.sides}
    cell_data = {**made.cell_data, "region": as_regions(made.regions)}
    whole = vtu_file(
        made.points, made.cells, made.kind, cell_data=cell_data, point_data=made.point_data, field_data=fields, texts=made.texts
    )
    return {"": whole}


def vtkhdf(made: Cells) -> dict[str, bytes]:
    """Write a mesh as VTKHDF, with its texts as field data.

    Returns
    -------
    dict
        The bytes of the file, under "".
    """
    from vtkmodules.vtkIOHDF import vtkHDFWriter

    begun = int(time.time())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.vtkhdf"
        writer: Any = vtkHDFWriter()
        writer.SetInputData(to_grid(made))
        writer.SetFileName(str(path))
        # Each array, and so each named set, takes whole chunks of so many rows; what is empty in them is compressed to almost nothing.
        writer.SetChunkSize(min(_CHUNK, max(len(made.points), made.cells.size)))
        writer.SetCompressionLevel(1)
        if not writer.Write():
            raise FileError("VTK could not write the mesh, and does not say why")
        data = path.read_bytes()
    times = range(begun - 1, int(time.time()) + 2)

    def without(stamp: re.Match[bytes]) -> bytes:
        return stamp[1] + (bytes(4) if int.from_bytes(stamp[2], "little") in times else stamp[2])

    return {"": _STAMP.sub(without, data)}


def as_regions(labels: Ints) -> NDArray[np.signedinteger[Any]]:
    """Return labels as int32, which every reader takes, or as int64 where one needs it."""
    narrow = labels.size == 0 or (labels.min() >= -(2**31) and labels.max() < 2**31)
    return labels.astype(np.int32 if narrow else np.int64)


def array_name(name: str) -> str:
    """Make a name one that VTK can write as that of an array."""
    return re.sub(r"[^\w .,()+-]", "_", name)
