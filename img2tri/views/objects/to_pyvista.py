"""For pyvista users: a plane mesh -> `pyvista.PolyData` or `UnstructuredGrid`, and the bytes of VTP and VTU files.

Nothing here draws: VTK without its GL libraries ends the process.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from numpy.typing import ArrayLike

from img2tri.views.objects.surface import Surface, surface

if TYPE_CHECKING:
    import pyvista

D = TypeVar("D", bound="pyvista.DataSet")


def to_pyvista(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> pyvista.PolyData:
    """Make a `pyvista.PolyData` of a plane mesh.

    Parameters and errors are those of `img2tri.views.objects.surface.surface`. With `height`, the object is the closed surface of the
    solid:
    without open edges, with volume = area x height.

    Returns
    -------
    pyvista.PolyData
        With float64 points, the cell array "region" (int32, active) and those of `cell_data`, and `field_data` as texts.

    Examples
    --------
    >>> flat = to_pyvista([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]], [7])
    >>> flat.n_cells, flat.area, flat["region"].tolist()
    (1, 2.0, [7])
    """
    return poly_data(surface(vertices, triangles, regions, z=z, height=height, cell_data=cell_data, field_data=field_data))


def to_grid(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> pyvista.UnstructuredGrid:
    """Make a `pyvista.UnstructuredGrid` of triangles, as solvers like it; otherwise as `to_pyvista`.

    Examples
    --------
    >>> to_grid([[0, 0], [2, 0], [0, 2]], [[0, 1, 2]]).celltypes.tolist()
    [5]
    """
    return grid(surface(vertices, triangles, regions, z=z, height=height, cell_data=cell_data, field_data=field_data))


def poly_data(made: Surface) -> pyvista.PolyData:
    """Make a PolyData of a surface."""
    import pyvista

    faces: Any = made.faces
    whole: pyvista.PolyData = pyvista.PolyData.from_regular_faces(made.points, faces)
    return _with_data(whole, made)


def grid(made: Surface) -> pyvista.UnstructuredGrid:
    """Make an UnstructuredGrid of a surface."""
    import pyvista

    return _with_data(pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: made.faces}, made.points), made)


def vtp(made: Surface) -> bytes:
    """Return the bytes of a VTP file, VTK's format for surfaces, with all arrays and texts."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    return _xml(vtkXMLPolyDataWriter(), poly_data(made))


def vtu(made: Surface) -> bytes:
    """Return the bytes of a VTU file, VTK's format for grids, with all arrays; the texts are comments.

    meshio, through which solvers read VTU, ends the process at a text array.
    """
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    whole = grid(made)
    whole.clear_field_data()
    xml = _xml(vtkXMLUnstructuredGridWriter(), whole)
    # Two hyphens would end the comment; so written, they are the same text to a JSON reader.
    notes = ["<!-- {} -->\n".format(f"{name}: {text}".replace("--", "-\\u002d")) for name, text in made.field_data.items()]
    head, rest = xml.split(b"\n", 1)
    return head + b"\n" + "".join(notes).encode() + rest


def _with_data(dataset: D, made: Surface) -> D:
    for name, values in {**made.cell_data, "region": made.regions}.items():
        dataset.cell_data[name] = values
    for name, text in made.field_data.items():
        dataset.field_data[name] = [text]
    dataset.set_active_scalars("region", preference="cell")
    return dataset


def _xml(writer: Any, dataset: pyvista.DataSet) -> bytes:
    # Writing to memory leaves the file to the one place that also notices a full disk, which VTK does not report.
    writer.SetInputData(dataset)
    writer.SetWriteToOutputString(True)
    writer.SetDataModeToBinary()
    writer.Write()
    return str(writer.GetOutputString()).encode()
