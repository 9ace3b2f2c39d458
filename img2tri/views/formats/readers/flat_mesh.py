"""A file with a plane mesh -> its arrays, where its image lies, and the names its user gave; from any format."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.types import Frame
from img2tri.views.formats.readers.file_contents import Found
from img2tri.views.formats.readers.read_any import read_file

PLANE_KINDS = ("triangle", "triangle6")
PLANE_ROUNDING = 1e-6  # of the size of the mesh: how flat the float32 of some formats are


class NotFlatError(MeshError):
    """A file holds a mesh in space, `found`."""

    found: Found


class FlatMesh(NamedTuple):
    """Vertices (n, 2), triangles (m, 3), regions (m,), the frame, names of regions, and the nodes of each set, vertices or -1.

    `listed` are the names of the sets img2tri knew besides those it finds; None in files of other programs.
    """

    vertices: Floats
    triangles: Ints
    regions: Ints
    frame: Frame
    names: dict[int, str]
    facets: dict[str, Ints]
    listed: list[str] | None


def flat_mesh(path: str | os.PathLike[str]) -> FlatMesh:
    """Read a plane mesh of triangles."""
    found = read_file(path)
    if found.kind not in PLANE_KINDS:
        raise _not_flat(found, f"{os.fspath(path)}: expected triangles, found cells of a solid ({found.kind})")
    z = found.points[found.cells[:, :3], 2]
    if np.ptp(z) > PLANE_ROUNDING * np.ptp(found.points, axis=0).max():
        raise _not_flat(found, f"{os.fspath(path)}: expected a plane mesh, found z from {z.min():g} to {z.max():g}")
    points, triangles, vertex = found.points[:, :2], found.cells[:, :3], np.arange(len(found.points))
    if found.kind == "triangle6":
        corners, renumbered = np.unique(triangles, return_inverse=True)
        points, triangles = points[corners], renumbered.reshape(-1, 3)
        vertex = np.full(len(vertex), -1)
        vertex[corners] = np.arange(len(corners))
    if _area(points, triangles) < 0:  # drawn with y down
        triangles = triangles[:, ::-1]
    about = _about(found)
    facets = {name: vertex[rows[:, :2]] for name, rows in found.facets.items() if len(rows)}
    return FlatMesh(
        np.ascontiguousarray(points), np.ascontiguousarray(triangles), found.regions, _frame(about, float(z.flat[0])),
        _names(found, about), facets, list(map(str, about.get("edge_sets", []))) if about else None,
    )  # fmt: skip


def _not_flat(found: Found, message: str) -> NotFlatError:
    error = NotFlatError(f"{message}; img2tri quality measures solids")
    error.found = found
    return error


def _area(points: Floats, triangles: Ints) -> float:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum())


def _about(found: Found) -> Mapping[str, Any]:
    """Return what img2tri wrote about the mesh; nothing if another program wrote the file."""
    try:
        about = json.loads(found.texts.get("img2tri", "{}"))
    except ValueError:
        about = {}
    return about if isinstance(about, dict) else {}


def _frame(about: Mapping[str, Any], z: float) -> Frame:
    """Return where the image lies; a file that does not say gets the frame of no image."""
    try:
        said = about["frame"]
        shape, spacing, corner = (int(n) for n in said["shape"]), (float(n) for n in said["spacing"]), (float(n) for n in said["corner"])
        return Frame(tuple(shape), tuple(spacing), tuple(corner), bool(said["upward"]), z)  # type: ignore[arg-type]
    except (KeyError, TypeError, ValueError):
        return Frame((1, 1), z=z)


def _names(found: Found, about: Mapping[str, Any]) -> dict[int, str]:
    """Return the names a user gave, without those that stand for labels."""
    given = about.get("names")
    if isinstance(given, dict):
        try:
            return {int(label): str(name) for label, name in given.items()}
        except ValueError:
            pass
    return {label: name for label, name in found.names.items() if name != f"region_{label}"}
