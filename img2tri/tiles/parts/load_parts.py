"""A mesh in parts read back, whole: each vertex once, in an order that does not depend on the parts."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints, runs
from img2tri.errors import FileError
from img2tri.types import Frame

DAMAGED = (KeyError, OSError, ValueError, IndexError, TypeError)  # what a store that is none, or not whole, makes its reader raise


def in_parts(path: str | os.PathLike[str]) -> bool:
    """Tell whether there is a mesh in parts, or something that only such a mesh would be."""
    suffix = Path(path).suffix.lower()
    return suffix in (".zarr", ".pvtu") or (suffix == ".vtkhdf" and _vtkhdf_note(path) is not None)


def load_tiles(path: str | os.PathLike[str]) -> tuple[Floats, Ints, Ints]:
    """Read a mesh in parts from ``.zarr``, ``.pvtu`` or ``.vtkhdf`` whole, each vertex once.

    Parameters
    ----------
    path
        A mesh that `mesh_tiles` has written.

    Returns
    -------
    vertices, triangles, regions
        (n, 2) float64 in world units, (m, 3) int64, (m,) int64. From ``.zarr`` triangles are in an order that does not depend on the
        parts, from the others part by part.

    Raises
    ------
    FileError
        If it is none.
    """
    return load_with_frame(path)[:3]


def load_with_frame(path: str | os.PathLike[str]) -> tuple[Floats, Ints, Ints, Frame]:
    """Read a mesh in parts as `load_tiles` does, and where its image lies."""
    try:
        mesh, report = _from_zarr(path) if Path(path).suffix.lower() == ".zarr" else _from_vtk(path)
        place = report["frame"]
        frame = Frame(tuple(place["shape"]), tuple(place["spacing"]), tuple(place["corner"]), place["upward"])
    except DAMAGED as problem:
        raise FileError(f"{path}: expected a mesh made by mesh_tiles, found {problem}") from problem
    return *mesh, frame


def _from_zarr(path: str | os.PathLike[str]) -> tuple[tuple[Floats, Ints, Ints], dict[str, Any]]:
    import zarr

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
    return (vertices, triangles, regions), facts


def _from_vtk(path: str | os.PathLike[str]) -> tuple[tuple[Floats, Ints, Ints], dict[str, Any]]:
    import pyvista

    if not Path(path).exists():
        raise OSError("no such file")
    note = _vtkhdf_note(path) if Path(path).suffix.lower() == ".vtkhdf" else Path(path).with_suffix("").joinpath("report.json").read_text()
    facts: dict[str, Any] = json.loads(note or "")
    grid: Any = pyvista.read(os.fspath(path))
    number = np.asarray(grid.point_data["number"], np.int64)
    vertices = np.zeros((facts["n_vertices"], 2))
    vertices[number] = grid.points[:, :2]
    triangles = number[np.asarray(grid.cells_dict[pyvista.CellType.TRIANGLE], np.int64)]
    return (vertices, triangles, np.asarray(grid.cell_data["region"], np.int64)), facts


def _vtkhdf_note(path: str | os.PathLike[str]) -> str | None:
    """Return the report in a .vtkhdf file; None if there is none, or no such file."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file["VTKHDF"].attrs.get("img2tri")
    except DAMAGED:
        return None
    return None if found is None else str(found)
