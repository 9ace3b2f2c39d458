"""What pyvista finds by entry points: readers and writers of the formats it lacks, for `pyvista.read`, ``.save`` and ``pyvista convert``.

Readers: .msh and .bdf. They return an UnstructuredGrid with the cell array ``region`` and with the named sets as field data, as
`img2tri.views.formats.solvers.vtu_vtkhdf` has them. pyvista reads these files through meshio where that is installed; so what was not
written by img2tri is still left to meshio then, and read here only where there is none.

Two readers more stand before pyvista's own, in the group of entry points it has for that: of .inp, which it takes for AVS UCD, so that
a file of Abaqus comes out empty; and of .xdmf, which it reads only with a time in it. All other files of these suffixes are left to it, and
so is, by pyvista, a call with arguments for its reader, such as ``progress_bar``.

Writers: .msh, .inp, .bdf and .xdmf, of a PolyData of triangles in a plane, or an UnstructuredGrid of triangles or wedges, see
`img2tri.views.plugin.dataset_to_cells`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from img2tri.errors import FileError, MeshError
from img2tri.views.formats.readers import read_inp as reading_inp
from img2tri.views.formats.readers import read_msh_bdf as reading
from img2tri.views.formats.readers.file_contents import Found
from img2tri.views.formats.readers.read_xdmf import is_plain_xdmf, parse_xdmf
from img2tri.views.formats.solvers.plain_text import MARK
from img2tri.views.formats.solvers.save_for_solvers import export
from img2tri.views.formats.solvers.vtu_vtkhdf import grid_of
from img2tri.views.objects.solver_cells import Cells
from img2tri.views.plugin.dataset_to_cells import from_dataset

if TYPE_CHECKING:
    import pyvista


def read_msh(path: str) -> pyvista.DataObject:
    """Read MSH, the format of Gmsh, as a `pyvista.UnstructuredGrid`.

    Raises
    ------
    FileError
        If it cannot be read, neither here nor by meshio.
    """
    return _read_found(path, reading.parse_msh)


def read_bdf(path: str) -> pyvista.DataObject:
    """Read the bulk data of Nastran as a `pyvista.UnstructuredGrid`.

    Raises
    ------
    FileError
        If it cannot be read, neither here nor by meshio.
    """
    return _read_found(path, reading.parse_bdf)


def read_inp(path: str) -> pyvista.DataObject:
    """Read INP, of Abaqus as a `pyvista.UnstructuredGrid`, of AVS as pyvista does.

    Raises
    ------
    FileError
        If it is of Abaqus and cannot be read, neither here nor by meshio.
    """
    import pyvista

    if reading_inp.is_abaqus(_local(path).read_bytes()):
        return _read_found(path, reading_inp.parse_inp)
    reader: Any = pyvista.AVSucdReader(path)
    grid: pyvista.DataObject = reader.read()
    return grid


def read_xdmf(path: str) -> Any:
    """Read XDMF as pyvista does, and without a time too; from files of img2tri also the names of regions and the named sets."""
    import pyvista

    file = _local(path)
    if is_plain_xdmf(file.read_bytes()):
        with suppress(MeshError):  # it holds other cells: facets by themselves
            return _grid_of(parse_xdmf(file))
    grid = _read_xdmf_grid(file)
    return pyvista.wrap(grid)


def write_msh(dataset: pyvista.DataObject, path: str, *, version: str = "4.1") -> None:
    """Write MSH, the format of Gmsh; `version` is "4.1" or "2.2"."""
    export(path, from_dataset(dataset), version=version)


def write_inp(dataset: pyvista.DataObject, path: str, *, deck: bool = False, plane: str = "stress") -> None:
    """Write the format of Abaqus and CalculiX, options as `img2tri.views.formats.solvers.inp.inp`; arrays of the user are an error."""
    export(path, _without_quality(from_dataset(dataset)), deck=deck, plane=plane)


def write_bdf(dataset: pyvista.DataObject, path: str) -> None:
    """Write the bulk data of Nastran; arrays of the user have no place in it, and are an error."""
    export(path, _without_quality(from_dataset(dataset)))


def write_xdmf(dataset: pyvista.DataObject, path: str) -> None:
    """Write XDMF, with a time, so that pyvista reads it back; the named facets go to a second file, ``_facets`` behind its stem."""
    export(path, from_dataset(dataset), timed=True)


def write_mesh(dataset: pyvista.DataObject, path: str) -> None:
    """Write the format of Medit and FreeFem; arrays of the user have no place in it, and are an error."""
    export(path, _without_quality(from_dataset(dataset)))


def _without_quality(made: Cells) -> Cells:
    """Leave out q, which img2tri gives each triangle, for formats that have no place for values."""
    return replace(made, cell_data={name: values for name, values in made.cell_data.items() if name != "q"})


def _local(path: str) -> Path:
    """Return where a file is; let pyvista fetch it first if it is not on this machine."""
    if "://" in path:
        from pyvista.core.utilities.reader_registry import LocalFileRequiredError

        raise LocalFileRequiredError
    return Path(path)


def _read_found(path: str, reader: Callable[[bytes], Found]) -> pyvista.DataObject:
    import pyvista

    data = _local(path).read_bytes()
    by_meshio = find_spec("meshio") is not None
    if by_meshio and MARK.encode() not in data[:1000]:
        return pyvista.read_meshio(path)
    try:
        found = reader(data)
    except Exception as problem:
        # Whatever a damaged file makes the reader stumble over, it is the file that cannot be read.
        reason = str(problem) if isinstance(problem, (MeshError, ValueError)) else "it is damaged, or of another kind"
        raise FileError(f"{path}: {reason}" + ("" if by_meshio else "; with meshio installed, pyvista reads more kinds")) from problem
    return _grid_of(found)


def _grid_of(found: Found) -> pyvista.UnstructuredGrid:
    grid = grid_of(found.points, found.cells, found.kind, found.regions, found.names, found.facets)
    for name, values in found.cell_data.items():
        grid.cell_data[name] = values
    for name, values in found.point_data.items():
        grid.point_data[name] = values
    return grid


def _read_xdmf_grid(path: Path) -> Any:
    """Read what VTK reads of a file; pyvista's reader wants a time."""
    import pyvista
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

    reader: Any
    if b"<Time" in path.read_bytes():
        reader = pyvista.XdmfReader(str(path))
        return reader.read()
    reader = vtkXdmfReader()
    reader.SetFileName(str(path))
    reader.Update()
    return pyvista.wrap(reader.GetOutputDataObject(0))
