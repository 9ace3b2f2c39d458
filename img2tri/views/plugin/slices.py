"""Slices that stand: planes normal to x or y -> planes normal to z, where meshes are made, and back.

A plane normal to x has y to the right and z up, one normal to y has x to the right and z up. The latter is seen from behind its axis, so
triangles are turned over when it is put up again: in all planes they turn counter-clockwise as seen from the end of the axis, and the
surface of a solid has its normals outside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.arrays import Floats
from img2tri.errors import ImageError

if TYPE_CHECKING:
    import pyvista

IN_PLANE = {2: (0, 1), 1: (0, 2), 0: (1, 2)}  # axis of the normal -> the axes to the right and up
VIEWS = {2: "view_xy", 1: "view_xz", 0: "view_yz"}


def normal_of(points: Floats) -> int:
    """Return the axis along which points have no extent; z where there is none, or several.

    Examples
    --------
    >>> normal_of(np.array([[0, 5, 0], [1, 5, 0], [0, 5, 1.0]])), normal_of(np.array([[0, 0, 0], [1, 1, 1.0]]))
    (1, 2)
    """
    flat = [axis for axis in IN_PLANE if len(points) and np.ptp(points[:, axis]) == 0]
    return flat[0] if flat else 2


def laid_down(image: pyvista.ImageData, scalars: str | None = None) -> tuple[pyvista.ImageData, int]:
    """Return an image normal to z with the same values, and the axis of its normal; what is no slice along the axes stays as it is.

    Parameters
    ----------
    image
        The image.
    scalars
        The array that is to be meshed; None: the active one.

    Raises
    ------
    ImageError
        If there is no such array.
    """
    import pyvista

    known = [*image.point_data.keys(), *image.cell_data.keys()]
    if scalars is not None and scalars not in known:
        raise ImageError(f"scalars: expected one of {', '.join(map(repr, known)) or 'none, as there are none'}, found {scalars!r}")
    counts = image.dimensions
    axis = next((axis for axis in IN_PLANE if counts[axis] == 1), 2)
    flat: Any = image.copy(deep=False)
    if axis != 2 and np.allclose(image.direction_matrix, np.eye(3)):
        u, v = IN_PLANE[axis]
        first = np.array(image.origin) + np.array(image.extent[::2]) * image.spacing
        flat = pyvista.ImageData(
            dimensions=(counts[u], counts[v], 1), spacing=tuple(np.array(image.spacing)[[u, v, axis]]), origin=tuple(first[[u, v, axis]])
        )
        # Values are stored with x changing first, then y, then z: leaving one of them out keeps their order.
        for name in image.point_data:
            flat.point_data[name] = image.point_data[name]
        for name in image.cell_data:
            flat.cell_data[name] = image.cell_data[name]
        if scalars is None and image.active_scalars_name is not None:
            flat.set_active_scalars(image.active_scalars_name)
    else:
        axis = 2
    if scalars is not None:
        flat.set_active_scalars(scalars)
    return flat, axis


def put_up(dataset: pyvista.PolyData, axis: int) -> pyvista.PolyData:
    """Return triangles made in a plane normal to z in the plane normal to `axis`, facing along it."""
    return dataset if axis == 2 else _with_points(dataset, axis, _standing(np.asarray(dataset.points), axis))


def put_down(dataset: pyvista.PolyData, axis: int) -> pyvista.PolyData:
    """Undo `put_up`: the normal becomes z."""
    return dataset if axis == 2 else _with_points(dataset, axis, np.asarray(dataset.points)[:, [*IN_PLANE[axis], axis]])


def _standing(points: Floats, axis: int) -> Floats:
    turned = np.empty_like(points)
    turned[:, [*IN_PLANE[axis], axis]] = points
    return turned


def _with_points(dataset: Any, axis: int, points: Floats) -> pyvista.PolyData:
    moved: pyvista.PolyData = dataset.copy()
    moved.points = points
    if axis == 1:
        moved.regular_faces = np.asarray(moved.regular_faces)[:, ::-1].copy()
    return moved
