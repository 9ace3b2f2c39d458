"""VTP and VTU, the XML formats of VTK: a surface -> the bytes of a file; VTK writes them, to memory.

Memory leaves the file to the one place that also notices a full disk, which VTK does not report.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from img2tri.errors import FileError
from img2tri.views.objects.flat_or_extruded import Surface
from img2tri.views.objects.to_pyvista import poly_data, triangle_grid

if TYPE_CHECKING:
    import pyvista


def vtp(made: Surface) -> bytes:
    """Return the bytes of a VTP file, VTK's format for surfaces, with all arrays and texts."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    return _bytes_by(vtkXMLPolyDataWriter(), poly_data(made))


def vtu_of_surface(made: Surface) -> bytes:
    """Return the bytes of a VTU file, VTK's format for grids, of the triangles of a surface, with all arrays; the texts are comments."""
    whole = triangle_grid(made)
    whole.clear_field_data()
    return vtu_of_grid(whole, made.field_data)


def vtu_of_grid(grid: pyvista.UnstructuredGrid, texts: Mapping[str, str]) -> bytes:
    """Return the bytes of a VTU file; the texts become comments.

    meshio, through which solvers read VTU, ends the process at a text array.
    """
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    head, rest = _bytes_by(vtkXMLUnstructuredGridWriter(), grid).split(b"\n", 1)
    return head + b"\n" + xml_comments(texts).encode() + rest


def xml_comments(texts: Mapping[str, str]) -> str:
    r"""Write texts as comments in XML, one in a line.

    Two hyphens would end a comment; so written, they are the same text to a JSON reader.

    Examples
    --------
    >>> xml_comments({"img2tri": '"--8px"'})
    '<!-- img2tri: "-\\u002d8px" -->\n'
    """
    return "".join("<!-- {} -->\n".format(f"{name}: {text}".replace("--", "-\\u002d")) for name, text in texts.items())


def _bytes_by(writer: Any, dataset: pyvista.DataSet) -> bytes:
    writer.SetInputData(dataset)
    writer.SetWriteToOutputString(True)
    writer.SetDataModeToBinary()
    if not writer.Write():
        raise FileError("VTK could not write the mesh, and does not say why")
    return str(writer.GetOutputString()).encode()
