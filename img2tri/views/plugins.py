"""What pyvista finds by entry points: readers and writers of the formats it lacks, for `pyvista.read`, ``.save`` and ``pyvista convert``.

Readers: .msh and .bdf. They return an UnstructuredGrid with the cell array ``region`` and with the named sets as field data, as
`img2tri.views.formats.vtk` has them. pyvista reads these files through meshio where that is installed; so what was not written by
img2tri is still left to meshio then, and read here only where there is none.

Writers: .msh, .inp, .bdf and .xdmf, of a PolyData of triangles in a plane, or an UnstructuredGrid of triangles or wedges, see
`img2tri.views.datasets`. pyvista reads .inp as another format of that suffix, AVS UCD, and .xdmf itself.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from img2tri.errors import FileError, MeshError
from img2tri.views.datasets import from_dataset
from img2tri.views.export import export
from img2tri.views.formats import reading
from img2tri.views.formats.text import MARK
from img2tri.views.formats.vtk import grid_of

if TYPE_CHECKING:
    import pyvista


def read_msh(path: str) -> pyvista.DataObject:
    """Read MSH, the format of Gmsh, as a `pyvista.UnstructuredGrid`.

    Raises
    ------
    FileError
        If it cannot be read, neither here nor by meshio.
    """
    return _read(path, reading.read_msh)


def read_bdf(path: str) -> pyvista.DataObject:
    """Read the bulk data of Nastran as a `pyvista.UnstructuredGrid`.

    Raises
    ------
    FileError
        If it cannot be read, neither here nor by meshio.
    """
    return _read(path, reading.read_bdf)


def write_msh(dataset: pyvista.DataObject, path: str, *, version: str = "4.1") -> None:
    """Write MSH, the format of Gmsh; `version` is "4.1" or "2.2"."""
    export(path, from_dataset(dataset), version=version)


def write_inp(dataset: pyvista.DataObject, path: str, *, deck: bool = False, plane: str = "stress") -> None:
    """Write the format of Abaqus and CalculiX; options as in `img2tri.views.formats.inp.inp`."""
    export(path, from_dataset(dataset), deck=deck, plane=plane)


def write_bdf(dataset: pyvista.DataObject, path: str) -> None:
    """Write the bulk data of Nastran."""
    export(path, from_dataset(dataset))


def write_xdmf(dataset: pyvista.DataObject, path: str) -> None:
    """Write XDMF, with a time, so that pyvista reads it back; the named facets go to a second file, ``_facets`` behind its stem."""
    export(path, from_dataset(dataset), timed=True)


def _read(path: str, reader: Callable[[bytes], reading.Found]) -> pyvista.DataObject:
    import pyvista

    if "://" in path:
        from pyvista.core.utilities.reader_registry import LocalFileRequiredError

        raise LocalFileRequiredError
    data = Path(path).read_bytes()
    by_meshio = find_spec("meshio") is not None
    if by_meshio and MARK.encode() not in data[:1000]:
        return pyvista.read_meshio(path)
    try:
        found = reader(data)
    except Exception as problem:
        # Whatever a damaged file makes the reader stumble over, it is the file that cannot be read.
        reason = str(problem) if isinstance(problem, (MeshError, ValueError)) else "it is damaged, or of another kind"
        raise FileError(f"{path}: {reason}" + ("" if by_meshio else "; with meshio installed, pyvista reads more kinds")) from problem
    return grid_of(found.points, found.cells, found.kind, found.regions, found.names, found.facets)
