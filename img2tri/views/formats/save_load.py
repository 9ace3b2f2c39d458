"""A mesh as a file and back: the suffix names the format, and one table names who writes and reads it.

What each format holds::

    suffix   coordinates   regions                        other values, texts
    .stl     float32       -                              -
    .ply     float64       face property `region`         face properties, comments
    .obj     float64       groups `region_3`              -, comments
    .off     float64       -                              -
    .3mf     float64       objects with name and colour   -, metadata
    .glb     float32       meshes `region_3` in colours   -, extras
    .vtp     float64       cell array `region`            cell arrays, field data
    .vtu     float64       cell array `region`            cell arrays, comments

The formats of solvers, which hold names and sets of edges besides, are in `img2tri.views.formats.solvers.save_for_solvers`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import FileError, MeshError, ParameterError
from img2tri.views.formats import threemf
from img2tri.views.formats.array_names import check_array_names
from img2tri.views.formats.atomic_write import known_suffix, store, writable
from img2tri.views.formats.glb import glb
from img2tri.views.formats.readers.read_msh_bdf import READERS, by_text
from img2tri.views.formats.readers.read_stl_ply_obj_off_glb import by_trimesh
from img2tri.views.formats.readers.read_vtp_vtu import by_xml
from img2tri.views.formats.stl_ply_obj_off import obj, off, ply, stl
from img2tri.views.formats.vtp_vtu import vtp, vtu_of_surface
from img2tri.views.objects.base_plate import Base
from img2tri.views.objects.body_per_region import Body, bodies
from img2tri.views.objects.flat_or_extruded import Surface, coincident_points, plane_mesh, surface


class Format(NamedTuple):
    """Who writes a format, who reads it back, and what else there is to know about it.

    Attributes
    ----------
    write
        A surface -> the bytes of a file.
    read
        The other way round; None where no plane mesh is to be expected.
    single
        Whether its coordinates are float32.
    arrays
        Whether it holds other values of faces and points.
    bodies
        Who writes solids instead, where each region is to be closed by itself.
    apart
        Whether flat meshes are written so too.
    """

    write: Callable[[Surface], bytes] | None
    read: Callable[[bytes, str], tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None]] | None
    single: bool = False
    arrays: bool = False
    bodies: Callable[[Sequence[Body]], bytes] | None = None
    apart: bool = False


SURFACE_FORMATS = {
    ".stl": Format(stl, by_trimesh, single=True),
    ".ply": Format(ply, by_trimesh, arrays=True),
    ".obj": Format(obj, by_trimesh),
    ".off": Format(off, by_trimesh),
    ".3mf": Format(threemf.flat_3mf, None, bodies=threemf.bodies_3mf),
    ".glb": Format(None, by_trimesh, single=True, bodies=glb, apart=True),
    ".vtp": Format(vtp, by_xml, arrays=True),
    ".vtu": Format(vtu_of_surface, by_xml, arrays=True),
}


def save(
    path: str | os.PathLike[str],
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | Mapping[int, float] | None = None,
    names: Mapping[int, str] | None = None,
    colours: Mapping[int, tuple[int, int, int]] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    point_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    base: Base | None = None,
) -> None:
    """Write a plane mesh, or with `height` the closed surface of the solid, in the format the suffix of `path` names.

    The same input gives the same bytes. An older file is replaced in one step, or left as it is if anything goes wrong.

    Parameters
    ----------
    path
        Where to write: .stl, .ply, .obj, .off, .3mf, .glb, .vtp or .vtu. See the table above for what each can hold.
    names, colours
        Label -> name, and (red, green, blue), of the region, for formats that hold these.
    vertices, triangles, regions, z, height, cell_data, point_data, field_data, base
        As in `img2tri.views.objects.flat_or_extruded.surface`.

    Raises
    ------
    FileError
        If the suffix is not known, the folder is missing or not writable, the disk is full, or the format holds float32 and the mesh
        would not survive the rounding: a triangle collapses or turns over, or two vertices become one.
    MeshError, ParameterError
        As `img2tri.views.objects.flat_or_extruded.surface`.

    Examples
    --------
    >>> save("plate.dwg", [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    Traceback (most recent call last):
    ...
    img2tri.errors.FileError: plate.dwg: expected a name that ends in .3mf, .glb, .obj, .off, .ply, .stl, .vtp or .vtu, found '.dwg'
    """
    target = writable(path, SURFACE_FORMATS)
    form = SURFACE_FORMATS[known_suffix(path, SURFACE_FORMATS)]
    others = [*(name for name in cell_data or {} if name != "q"), *(point_data or {})]
    if others and not form.arrays:
        homes = ", ".join(suffix for suffix, form in SURFACE_FORMATS.items() if form.arrays)
        raise ParameterError(
            f"data: expected no arrays for {target.suffix}, which has no place for them, found {', '.join(others)}; use {homes}"
        )
    check_array_names(others, target.suffix.lower())
    if form.bodies and (height is not None or form.apart):
        parts = bodies(
            vertices, triangles, regions, height=height, z=z, names=names, colours=colours, cell_data=cell_data, field_data=field_data,
            base=base,
        )  # fmt: skip
        if form.single:
            for part in parts:
                _check_rounding(path, part.surface)
        store(target, form.bodies(parts))
        return
    made = surface(
        vertices, triangles, regions, z=z, height=height, cell_data=cell_data, point_data=point_data, field_data=field_data,
        colours=colours, base=base,
    )  # fmt: skip
    if form.single:
        _check_rounding(path, made)
    if form.write:
        store(target, form.write(made))


def load(path: str | os.PathLike[str]) -> tuple[Floats, Ints, Ints]:
    """Read a plane mesh from a file.

    Parameters
    ----------
    path
        A file that ends in .stl, .ply, .obj, .off, .glb, .vtp, .vtu, .msh or .bdf, whose triangles lie in one plane of constant z.

    Returns
    -------
    vertices
        (n, 2) float64; z is dropped.
    triangles
        (m, 3) int64. If most of the area is clockwise, all are turned over; a few turned the other way stay so, to be counted.
    regions
        (m,) int64, from where `save` puts them; 1 if there are none.

    Raises
    ------
    FileError
        If the suffix is not known, or the file is missing, damaged or of another kind.
    MeshError
        If it holds no triangles, other cells, or triangles in space, such as a solid.
    """
    readers = {suffix: form.read for suffix, form in SURFACE_FORMATS.items() if form.read} | dict.fromkeys(READERS, by_text)
    suffix = known_suffix(path, readers)
    try:
        data = Path(path).read_bytes()
    except OSError as problem:
        raise FileError(f"{path}: cannot be read: {problem.strerror or problem}") from problem
    try:
        return _plane(*readers[suffix](data, suffix))
    except MeshError as problem:
        raise MeshError(f"{path}: {problem}") from None
    except Exception as problem:
        # Whatever a damaged file makes a reader stumble over, it is the file that cannot be read.
        raise FileError(f"{path}: cannot be read as {suffix}: {str(problem) or type(problem).__name__}") from problem


def _plane(points: NDArray[Any], faces: NDArray[Any], regions: NDArray[Any] | None) -> tuple[Floats, Ints, Ints]:
    """Drop z if it is the same everywhere, within float32; turn a clockwise mesh over; refuse what is no plane mesh."""
    if not len(faces):
        raise MeshError("expected triangles, found none")
    vertices, triangles = plane_mesh(points[:, :2], faces)
    low, high = points[:, 2].min(), points[:, 2].max()
    if not high - low <= 1e-6 * np.ptp(vertices, axis=0).max():
        raise MeshError(
            f"expected a plane mesh, found z from {low:g} to {high:g}; if it was saved with a height, it is the surface of a solid: "
            "save it without"
        )
    labels = np.ones(len(faces)) if regions is None else regions
    if not np.all(labels == np.round(labels)):
        raise MeshError("region: expected whole numbers, found others")
    p, q, r = (vertices[triangles[:, i]] for i in range(3))
    twice = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
    return vertices, triangles[:, ::-1].copy() if twice.sum() < 0 else triangles, labels.astype(np.int64)


def _check_rounding(path: str | os.PathLike[str], made: Surface) -> None:
    """Refuse a surface whose faces or points would not survive the rounding to float32."""
    if not made.closed and _far_from_rounding(made):
        return
    with np.errstate(over="ignore", invalid="ignore"):
        rounded = made.points.astype(np.float32).astype(np.float64)
        exact, after = _normals(made.points, made.faces), _normals(rounded, made.faces)
        lost = np.sum(~((exact * after).sum(axis=1) > 0) & np.any(exact != 0, axis=1))
    merged = coincident_points(made.points).max() - coincident_points(rounded).max()
    if lost or merged:
        raise FileError(
            f"{path}: holds coordinates as float32, of 7 digits; with coordinates up to {np.abs(made.points).max():g}, {lost} of "
            f"{len(made.faces)} triangles would collapse and {merged} vertices fall together. Move the mesh nearer to 0 or scale it, "
            "or save it as .ply, .vtp or .vtu, which hold float64"
        )


def _far_from_rounding(made: Surface) -> bool:
    """Tell whether all triangles of a flat mesh are far taller than what rounding moves, and no two points are rounded to one."""
    # Half the distance of two float32 at the largest coordinate; triangles of more than four times the diagonal of that cannot turn over.
    moved = float(np.abs(made.points).max()) * 2.0**-24
    plane = made.points[:, :2]
    if moved > 2.0**100:
        return False
    rounded = np.ascontiguousarray(plane.astype(np.float32) + np.float32(0)).view(np.uint64).ravel()
    rounded.sort()
    corners = np.ascontiguousarray(made.faces.T)
    (ux, vx), (uy, vy) = ((part[corners[1:]] - part[corners[0]]) for part in np.ascontiguousarray(plane.T))
    wx, wy = vx - ux, vy - uy
    longest = np.maximum(np.maximum(ux * ux + uy * uy, vx * vx + vy * vy), wx * wx + wy * wy)
    tall = np.abs(ux * vy - uy * vx) > 6 * moved * np.sqrt(longest)
    return bool(tall.all() and (rounded[1:] != rounded[:-1]).all())


def _normals(points: Floats, faces: Ints) -> Floats:
    """Return twice the area of each face times its normal."""
    p, q, r = (points[faces[:, i]] for i in range(3))
    return np.cross(q - p, r - p)
