"""Parts of a mesh -> files: a folder of zarr arrays, VTU files with a .pvtu over them, or one VTKHDF file with partitions.

Each part can be read alone. It has the numbers of its vertices in the whole mesh, so that those on seams, which several parts have, are
told to be one; in VTK's formats these are the global node ids.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints, runs
from img2tri.errors import FileError
from img2tri.views.formats.xml_text import xml_quoted

FORMATS = (".zarr", ".pvtu", ".vtkhdf")


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a mesh, readable alone.

    Attributes
    ----------
    name
        Of the part: rows and columns of its tile.
    vertices, triangles, regions
        As of a mesh, in world units.
    numbers
        (n,) int64, the numbers of its vertices in the whole mesh.
    blocks
        (b, 2) int64, for each block of the part the number of its first triangle in the whole mesh, and how many follow.
    """

    name: str
    vertices: Floats
    triangles: Ints
    regions: Ints
    numbers: Ints
    blocks: Ints


def save_parts(out: Path, parts: Iterable[Part], report: dict[str, Any]) -> None:
    """Write parts one after the other, beside the place, and put the whole there at the end; an older mesh is replaced then."""
    suffix = out.suffix.lower()
    beside = out.with_name(f".{out.stem}.unfinished{suffix}")
    folder = out.with_suffix("") if suffix == ".pvtu" else None
    _remove(beside)
    try:
        if suffix == ".zarr":
            _zarr(beside, parts, report)
        elif suffix == ".vtkhdf":
            _vtkhdf(beside, parts, report)
        else:
            assert folder is not None
            _pvtu(beside, folder, parts, report)
            _remove(folder)
            os.replace(_folder_beside(folder), folder)
        if out.is_dir():
            shutil.rmtree(out)
        os.replace(beside, out)
    except OSError as problem:
        raise FileError(f"{out}: cannot be written: {problem.strerror or problem}; what is done stays, run it again then") from problem


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _zarr(path: Path, parts: Iterable[Part], report: dict[str, Any]) -> None:
    import zarr

    root = zarr.open_group(path, mode="w")
    names = []
    for part in parts:
        group = root.create_group(f"parts/{part.name}")
        for name in ("vertices", "triangles", "regions", "numbers", "blocks"):
            array = getattr(part, name)
            group.create_array(name, data=array) if array.size else group.create_array(name, shape=array.shape, dtype=array.dtype)
        names.append(part.name)
    root.attrs.update({"img2tri": json.loads(json.dumps(report, default=str)), "parts": names})


def _folder_beside(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.unfinished")


def _pvtu(path: Path, folder: Path, parts: Iterable[Part], report: dict[str, Any]) -> None:
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    from img2tri.views.formats.solvers.vtu_vtkhdf import grid_of

    beside = _folder_beside(folder)
    _remove(beside)
    beside.mkdir()
    sources = []
    for part in parts:
        if not len(part.triangles):
            continue
        flat = np.concatenate([part.vertices, np.zeros((len(part.vertices), 1))], axis=1)
        grid = grid_of(flat, part.triangles, "triangle", part.regions, {}, {})
        numbers: Any = numpy_support.numpy_to_vtk(part.numbers, deep=True)  # type: ignore[no-untyped-call]
        numbers.SetName("number")
        grid.GetPointData().SetGlobalIds(numbers)
        writer: Any = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetFileName(str(beside / f"{part.name}.vtu"))
        writer.SetDataModeToAppended()
        writer.EncodeAppendedDataOff()
        if not writer.Write():
            raise OSError(0, f"VTK could not write {part.name}.vtu")
        sources.append(f"    <Piece Source={xml_quoted(f'{folder.name}/{part.name}.vtu')}/>")
    (beside / "report.json").write_text(json.dumps(report, indent=2, default=str), encoding="utf-8")
    head = (
        '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt32">\n'
        '  <PUnstructuredGrid GhostLevel="0">\n'
        '    <PPointData GlobalIds="number">\n      <PDataArray type="Int64" IdType="1" Name="number"/>\n    </PPointData>\n'
        '    <PCellData Scalars="region">\n      <PDataArray type="Int32" Name="region"/>\n    </PCellData>\n'
        '    <PPoints>\n      <PDataArray type="Float64" Name="Points" NumberOfComponents="3"/>\n    </PPoints>\n'
    )
    path.write_text(head + "\n".join(sources) + "\n  </PUnstructuredGrid>\n</VTKFile>\n", encoding="utf-8")


def _vtkhdf(path: Path, parts: Iterable[Part], report: dict[str, Any]) -> None:
    import h5py

    with h5py.File(path, "w", track_order=False) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        made: dict[str, Any] = {}

        def append(name: str, values: Any) -> None:
            if name not in made:
                shape = (1024, *values.shape[1:])
                made[name] = root.create_dataset(
                    name,
                    shape=(0, *values.shape[1:]),
                    maxshape=(None, *values.shape[1:]),
                    chunks=(16 * shape[0], *shape[1:]),
                    dtype=values.dtype,
                )
            data = made[name]
            data.resize(len(data) + len(values), axis=0)
            data[len(data) - len(values) :] = values

        for part in parts:
            if not len(part.triangles):
                continue
            m = len(part.triangles)
            append("NumberOfPoints", np.array([len(part.vertices)]))
            append("NumberOfCells", np.array([m]))
            append("NumberOfConnectivityIds", np.array([3 * m]))
            append("Points", np.concatenate([part.vertices, np.zeros((len(part.vertices), 1))], axis=1))
            append("Connectivity", part.triangles.ravel())
            append("Offsets", np.arange(0, 3 * m + 1, 3))
            append("Types", np.full(m, 5, np.uint8))
            append("CellData/region", part.regions)
            append("PointData/number", part.numbers)
        root.attrs["img2tri"] = json.dumps(report, default=str)


def load_tiles(path: str | os.PathLike[str]) -> tuple[Floats, Ints, Ints]:
    """Read a mesh in parts from ``.zarr`` whole, each vertex once, in an order that does not depend on the parts.

    Parameters
    ----------
    path
        A mesh that `mesh_tiles` has written.

    Returns
    -------
    vertices, triangles, regions
        (n, 2) float64 in world units, (m, 3) int64, (m,) int64.

    Raises
    ------
    FileError
        If it is none.
    """
    import zarr

    try:
        root: Any = zarr.open_group(path, mode="r")
        groups = [root[f"parts/{name}"] for name in root.attrs["parts"]]
        facts: Any = root.attrs["img2tri"]
        vertices, triangles = np.zeros((facts["n_vertices"], 2)), np.zeros((facts["n_triangles"], 3), np.int64)
        regions = np.zeros(len(triangles), np.int64)
        for group in groups:
            number = group["numbers"][:]
            vertices[number] = group["vertices"][:]
            which, place = runs(group["blocks"][:, 1])
            at = group["blocks"][:, 0][which] + place
            triangles[at], regions[at] = number[group["triangles"][:]], group["regions"][:]
    except (KeyError, OSError, ValueError) as problem:
        raise FileError(f"{path}: expected a mesh made by mesh_tiles, found {problem}") from problem
    return vertices, triangles, regions
