"""A mesh in parts read back, whole: each vertex once, in an order that does not depend on the parts."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints, runs
from img2tri.errors import FileError


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
