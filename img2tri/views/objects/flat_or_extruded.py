"""What every view starts from: a plane mesh -> triangles in space, with a value of each kind for each of them.

`surface` checks the arrays once and lays the mesh flat at its height, or gives it a thickness. All objects and files are made of the
result, so they cannot differ in what they hold.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError, ParameterError, finite
from img2tri.views.objects.base_plate import Base, plate_label
from img2tri.views.objects.extruded_surface import Extrusion, extrude


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles in space, called faces as the libraries and formats of this room do.

    Attributes
    ----------
    points
        (p, 3) float64, world units.
    faces
        (k, 3) int64.
    regions
        (k,) int32, the width every format can hold; int64 where a label needs it.
    cell_data
        Name -> (k,) or (k, c) array, other values of each face.
    field_data
        Name -> text: "units" and whatever else is known about the whole. ASCII.
    closed
        True for the surface of a solid, False for a plane mesh.
    point_data
        Name -> (p,) or (p, c) array, values of each point.
    colours
        Label -> (red, green, blue) of regions whose colour is known.
    """

    points: Floats
    faces: Ints
    regions: NDArray[np.signedinteger[Any]]
    cell_data: dict[str, NDArray[Any]]
    field_data: dict[str, str]
    closed: bool
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    colours: dict[int, tuple[int, int, int]] = field(default_factory=dict)


def surface(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    height: float | Mapping[int, float] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    point_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    colours: Mapping[int, tuple[int, int, int]] | None = None,
    base: Base | None = None,
) -> Surface:
    """Check the arrays of a plane mesh and lay it at height `z`, or make the closed solid from `z` to ``z + height`` of it.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 in world units, and (m, 3) int64, counter-clockwise.
    regions
        (m,) int64. None is region 1 everywhere.
    z
        Height of the plane, or of the bottom of the solid.
    height
        Thickness in world units, above 0; or label -> that of the region, which makes one closed surface too. None leaves the mesh flat.
    cell_data
        Name -> (m,) or (m, c) numbers, such as the quality of each triangle. The faces of a solid take the region and values of the
        triangle they come from; walls, that of the triangle beside them.
    point_data
        Name -> (n,) or (n, c) numbers of each vertex.
    field_data
        Name -> text. What ASCII cannot hold is escaped, as VTK reads nothing else.

    colours
        Label -> (red, green, blue) of regions whose colour is known.
    base
        A plate below the solid, which then stands on it, one closed body; it has a label of its own, and no values.

    Raises
    ------
    MeshError
        If the arrays are not a mesh.
    ParameterError
        If `height` is not above 0, or `z` not finite.

    Examples
    --------
    >>> flat = surface([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], [7])
    >>> flat.points.shape, flat.regions.tolist(), flat.closed
    ((3, 3), [7], False)
    """
    v, t = plane_mesh(vertices, triangles)
    z = finite("z", z)
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    if labels.dtype.kind not in "iu" or labels.max() >= 2**63:
        raise MeshError(f"regions: expected whole numbers within 64 bits, found {labels.dtype} from {labels.min()} to {labels.max()}")
    narrow = labels.min() >= -(2**31) and labels.max() < 2**31
    values = {name: per_triangle(name, value, len(t), columns=True) for name, value in (cell_data or {}).items()}
    if "region" in values:
        raise ParameterError("cell_data: expected names other than 'region', which is the name of the regions, found 'region'")
    texts = {_ascii(name): _ascii(text) for name, text in (field_data or {}).items()}
    nodes = {name: _per_vertex(name, value, len(v)) for name, value in (point_data or {}).items()}
    if base is not None and height is None:
        raise ParameterError("base: expected a height too, found none; a flat mesh has no plate")
    if base is not None:
        above = np.broadcast_to(heights(height, labels), len(t)) if height is not None else np.zeros(0)
        v, beside = base.under(v, t)
        t, plate = np.concatenate([t, beside]), np.full(len(beside), plate_label(labels))
        labels, tall = np.concatenate([labels, plate]), np.concatenate([above + base.thickness, np.full(len(beside), base.thickness)])
        values = {name: _padded(value, len(t)) for name, value in values.items()}
        nodes = {name: _padded(value, len(v)) for name, value in nodes.items()}
        solid = extrude(v, t, tall, z=z)
    elif height is None:
        solid = Extrusion(np.column_stack([v, np.full(len(v), z)]), t, np.arange(len(t)), np.arange(len(v)))
    else:
        solid = extrude(v, t, heights(height, labels), z=z)
    cells = {name: value[solid.sources] for name, value in values.items()}
    return Surface(
        solid.points, solid.faces, labels[solid.sources].astype(np.int32 if narrow else np.int64), cells, texts, closed=height is not None,
        point_data={name: value[solid.origins] for name, value in nodes.items()}, colours=dict(colours or {}),
    )  # fmt: skip


def _padded(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Give the plate and its corners no value: NaN, or 0 of whole numbers."""
    nothing = np.nan if values.dtype.kind == "f" else 0
    widths = [(0, count - len(values)), *[(0, 0)] * (values.ndim - 1)]
    return np.pad(values, widths, constant_values=nothing)


def heights(height: float | Mapping[int, float], labels: NDArray[Any]) -> ArrayLike:
    """Return the height of all triangles, or with one for each label that of each, or say which is missing or wrong.

    Examples
    --------
    >>> heights({1: 2.0, 7: 3}, np.array([7, 1, 1])).tolist()
    [3.0, 2.0, 2.0]
    """
    if not isinstance(height, Mapping):
        return finite("height", height, above=0)
    each, which = np.unique(labels, return_inverse=True)
    missing = [label for label in each.tolist() if label not in height]
    if missing:
        raise ParameterError(f"height: expected one for each region, found none for {', '.join(map(str, missing))}")
    return np.array([finite(f"height of {label}", height[label], above=0) for label in each.tolist()])[which]


def plane_mesh(vertices: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Ints]:
    """Return the arrays as (n, 2) float64 and (m, 3) int64, or say why they are not a mesh.

    Examples
    --------
    >>> plane_mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 3]])
    Traceback (most recent call last):
    ...
    img2tri.errors.MeshError: triangles: expected indices from 0 to 2, found 0 to 3
    """
    v, t = np.asarray(vertices, np.float64), np.asarray(triangles)
    if v.ndim != 2 or v.shape[1] != 2:
        raise MeshError(f"vertices: expected shape (n, 2), found {v.shape}")
    if not np.isfinite(v).all():
        raise MeshError("vertices: expected finite numbers, found NaN or infinity")
    if t.ndim != 2 or t.shape[1] != 3 or not len(t) or t.dtype.kind not in "iu":
        raise MeshError(f"triangles: expected at least one row of three indices, found shape {t.shape} of {t.dtype}")
    if t.min() < 0 or t.max() >= len(v):
        raise MeshError(f"triangles: expected indices from 0 to {len(v) - 1}, found {t.min()} to {t.max()}")
    return v, t.astype(np.int64, copy=False)


def coincident_points(points: NDArray[Any]) -> Ints:
    """Give each of the points (p, 3) a number, (p,) int64; points with the same coordinates get the same.

    Examples
    --------
    >>> coincident_points(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])).tolist()
    [1, 0, 1]
    """
    order = np.lexsort(points.T)
    number = np.zeros(len(points), np.int64)
    ordered = points[order]
    number[order[1:]] = np.cumsum(np.any(ordered[1:] != ordered[:-1], axis=1))
    return number


def per_triangle(name: str, values: ArrayLike, m: int, *, columns: bool = False) -> NDArray[Any]:
    """Return `values` as an array of one number per triangle, or with `columns` of several, or say what it is instead."""
    array = np.asarray(values)
    if array.shape[:1] != (m,) or array.ndim > 1 + columns or array.dtype.kind not in "biuf":
        raise MeshError(f"{name}: expected one number for each of {m} triangles, found shape {array.shape} of {array.dtype}")
    return array


def _per_vertex(name: str, values: ArrayLike, n: int) -> NDArray[Any]:
    array = np.asarray(values)
    if array.shape[:1] != (n,) or array.ndim > 2 or array.dtype.kind not in "biuf":
        raise MeshError(f"{name}: expected numbers for each of {n} vertices, found shape {array.shape} of {array.dtype}")
    return array


def _ascii(text: str) -> str:
    """Escape, as Python does, what is not printable ASCII, a tab or a new line."""
    return re.sub(r"[^\t\n -~]", lambda found: found[0].encode("unicode_escape").decode(), text)
