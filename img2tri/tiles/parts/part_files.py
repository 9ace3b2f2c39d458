"""Parts of a mesh -> files, each written by the worker that has it: a folder of zarr arrays, VTU files with a .pvtu over them, or VTKHDF.

Each part can be read alone. It has the numbers of its vertices in the whole mesh, so that those on seams, which several parts have, are
told to be one; in VTK's formats these are the global node ids. All is written beside the place of the mesh, and put there at the end.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol
from uuid import uuid4

import numpy as np

from img2tri.tiles.parts.tile_part import Part, PartPlan
from img2tri.tiles.parts.vtkhdf_file import VtkhdfFile
from img2tri.views.formats.xml_text import xml_quoted

FORMATS = (".zarr", ".pvtu", ".vtkhdf")
PART_ARRAYS = ("vertices", "triangles", "regions", "numbers", "blocks")


class PartFiles(Protocol):
    """A mesh in parts that is being written."""

    def begin(self, parts: Sequence[PartPlan]) -> None:
        """Make room for all parts."""

    def write(self, part: Part, planned: PartPlan, facts: dict[str, Any]) -> None:
        """Write one, called by any process; a part that is there already stays."""

    def finish(self, parts: Sequence[PartPlan], report: dict[str, Any]) -> None:
        """Write what is known of the whole, and put the mesh in its place; an older one is replaced then."""


def part_files(out: Path, scratch: Path) -> PartFiles:
    """Return how a mesh is written to a place, by its suffix; `scratch` is a folder for parts that are not whole yet."""
    kinds: dict[str, Callable[[Path, Path], PartFiles]] = {".zarr": ZarrParts, ".pvtu": PvtuParts, ".vtkhdf": VtkhdfParts}
    return kinds[out.suffix.lower()](out, scratch)


@dataclass(frozen=True)
class ZarrParts:
    """A zarr group with a group of arrays for each part, and its report as its attributes."""

    out: Path
    scratch: Path

    def begin(self, parts: Sequence[PartPlan]) -> None:  # noqa: ARG002
        """Make an empty group."""
        import zarr

        removed(self._beside)
        zarr.open_group(self._beside, mode="w").create_group("parts")

    def write(self, part: Part, planned: PartPlan, facts: dict[str, Any]) -> None:  # noqa: ARG002
        """Write the arrays of one part."""
        import zarr

        made = self.scratch / f"{part.name}-{uuid4().hex}"
        group = zarr.open_group(made, mode="w")
        for name in PART_ARRAYS:
            array = getattr(part, name)
            group.create_array(name, data=array) if array.size else group.create_array(name, shape=array.shape, dtype=array.dtype)
        group.attrs.update(in_json(facts))
        _put(made, self._beside / "parts" / part.name)

    def finish(self, parts: Sequence[PartPlan], report: dict[str, Any]) -> None:
        """Name all parts in the group, and put it in its place."""
        import zarr

        zarr.open_group(self._beside, mode="r+").attrs.update({"img2tri": in_json(report), "parts": [part.name for part in parts]})
        _replace(self._beside, self.out)

    @property
    def _beside(self) -> Path:
        return unfinished(self.out)


@dataclass(frozen=True)
class PvtuParts:
    """A .pvtu that names the parts in a folder beside it: for each a .vtu, and its report."""

    out: Path
    scratch: Path

    def begin(self, parts: Sequence[PartPlan]) -> None:  # noqa: ARG002
        """Make an empty folder."""
        removed(self._beside)
        self._beside.mkdir()

    def write(self, part: Part, planned: PartPlan, facts: dict[str, Any]) -> None:  # noqa: ARG002
        """Write one part as .vtu, if it has triangles."""
        from vtkmodules.util import numpy_support
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

        from img2tri.views.formats.solvers.vtu_vtkhdf import grid_of

        if not len(part.triangles):
            return
        flat = np.concatenate([part.vertices, np.zeros((len(part.vertices), 1))], axis=1)
        grid = grid_of(flat, part.triangles, "triangle", part.regions, {}, {})
        numbers: Any = numpy_support.numpy_to_vtk(part.numbers, deep=True)  # type: ignore[no-untyped-call]
        numbers.SetName("number")
        grid.GetPointData().SetGlobalIds(numbers)
        made = self.scratch / f"{part.name}-{uuid4().hex}"
        writer: Any = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetFileName(str(made))
        writer.SetDataModeToAppended()
        writer.EncodeAppendedDataOff()
        if not writer.Write():
            raise OSError(0, f"VTK could not write {part.name}.vtu")
        _put(made, self._beside / f"{part.name}.vtu")
        made.write_text(json.dumps(in_json(facts), indent=2), encoding="utf-8")
        _put(made, self._beside / f"{part.name}.json")

    def finish(self, parts: Sequence[PartPlan], report: dict[str, Any]) -> None:
        """Write the report and the .pvtu, and put all in its place."""
        folder = self.out.with_suffix("")
        (self._beside / "report.json").write_text(json.dumps(report, indent=2, default=str), encoding="utf-8")
        sources = [f"    <Piece Source={xml_quoted(f'{folder.name}/{part.name}.vtu')}/>" for part in parts if part.n_triangles]
        head = (
            '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt32">\n'
            '  <PUnstructuredGrid GhostLevel="0">\n'
            '    <PPointData GlobalIds="number">\n      <PDataArray type="Int64" IdType="1" Name="number"/>\n    </PPointData>\n'
            '    <PCellData Scalars="region">\n      <PDataArray type="Int32" Name="region"/>\n    </PCellData>\n'
            '    <PPoints>\n      <PDataArray type="Float64" Name="Points" NumberOfComponents="3"/>\n    </PPoints>\n'
        )
        whole = unfinished(self.out)
        whole.write_text(head + "\n".join(sources) + "\n  </PUnstructuredGrid>\n</VTKFile>\n", encoding="utf-8")
        _replace(self._beside, folder)
        _replace(whole, self.out)

    @property
    def _beside(self) -> Path:
        return unfinished(self.out.with_suffix(""))


@dataclass(frozen=True)
class VtkhdfParts:
    """One .vtkhdf file with a partition for each part."""

    out: Path
    scratch: Path

    def begin(self, parts: Sequence[PartPlan]) -> None:
        """Make a file with room for all parts."""
        removed(unfinished(self.out))
        self._file.begin([(part.n_vertices, part.n_triangles) for part in parts if part.n_triangles])

    def write(self, part: Part, planned: PartPlan, facts: dict[str, Any]) -> None:  # noqa: ARG002
        """Write one part into its place, if it has triangles."""
        if len(part.triangles):
            self._file.write(part, planned.place)

    def finish(self, parts: Sequence[PartPlan], report: dict[str, Any]) -> None:  # noqa: ARG002
        """Write the report, and put the file in its place."""
        self._file.note("img2tri", json.dumps(report, default=str))
        _replace(unfinished(self.out), self.out)

    @property
    def _file(self) -> VtkhdfFile:
        return VtkhdfFile(unfinished(self.out))


def unfinished(path: Path) -> Path:
    """Return where a mesh is written until it is whole."""
    return path.with_name(f".{path.stem}.unfinished{path.suffix}")


def removed(path: Path) -> None:
    """Remove a file or folder if it is there."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def in_json(report: dict[str, Any]) -> Any:
    """Return plain data as JSON has it."""
    return json.loads(json.dumps(report, default=str))


def _put(made: Path, place: Path) -> None:
    """Put a part that is whole where it belongs; one that is there, written by a worker thought lost, has the same bytes."""
    if place.exists():
        removed(made)
    else:
        os.replace(made, place)


def _replace(made: Path, place: Path) -> None:
    if place.is_dir():
        shutil.rmtree(place)
    os.replace(made, place)
