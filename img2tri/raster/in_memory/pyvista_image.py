"""A planar ``pyvista.ImageData`` -> `Picture`, lying where the object lies.

The object is recognised by what it has, so pyvista, which loads VTK, is never imported here. It counts its values from the
lower-left, x first, so rows go upward in y: as the rows of an image whose y grows with the row (`Frame.upward` is False).
Point data sit in the middle of pixels, cell data are pixels::

    points  +---+---+        the image reaches half a spacing      cells  +---+---+   the image is as
            | . | . |   ->   further than the points                      | a | b |   large as the grid
            +---+---+                                                     +---+---+
"""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.errors import ImageError
from img2tri.raster.in_memory.array_checks import Pixels, pixels
from img2tri.types import Frame, Picture


def is_image_data(image: Any) -> bool:
    """Tell whether `image` is a ``pyvista.ImageData``, without importing pyvista."""
    return all(hasattr(type(image), name) for name in ("dimensions", "extent", "origin", "spacing", "point_data", "cell_data"))


def from_image_data(image: Any) -> Picture:
    """Read a planar ``pyvista.ImageData``: its active scalars, or its first ones.

    Parameters
    ----------
    image
        One point thick in z. One value per point or cell, or 3 or 4 for colours.

    Returns
    -------
    Picture
        With the spacing and place of the object, its z included.

    Raises
    ------
    ImageError
        If it is not planar, is turned in space, has no extent or no usable scalars.
    """
    counts = tuple(int(n) for n in image.dimensions)
    if counts[2] != 1:
        raise ImageError(f"image: expected a planar ImageData, of dimensions (nx, ny, 1), found {counts}; take a slice in z first")
    turn = np.asarray(getattr(image, "direction_matrix", np.eye(3)))
    if not np.allclose(turn, np.eye(3)):
        raise ImageError("image: expected an ImageData along the axes, found one whose direction_matrix turns it; resample it first")
    spacing = np.asarray(image.spacing, float)[:2]
    if not (np.isfinite(spacing).all() and (spacing > 0).all()):
        raise ImageError(f"image: expected an ImageData with a spacing above 0, found {tuple(map(float, image.spacing))}")
    # Indices of an extent need not begin at 0; the origin is where they would.
    first = np.asarray(image.origin, float) + np.asarray(image.extent[::2]) * np.asarray(image.spacing, float)
    name, scalars, on_points = _scalars(image)
    shape = (counts[1], counts[0]) if on_points else (counts[1] - 1, counts[0] - 1)
    corner = first[:2] - (spacing / 2 if on_points else 0)
    values = pixels(scalars.reshape(shape + scalars.shape[1:]))
    frame = Frame(shape, (float(spacing[0]), float(spacing[1])), (float(corner[0]), float(corner[1])), upward=False, z=float(first[2]))
    return Picture(values, frame, f"ImageData {name!r}", {"format": "ImageData", "spacing": "ImageData"})


def _scalars(image: Any) -> tuple[str, Pixels, bool]:
    """Return the name and the values of the active scalars, or of the first, and whether they belong to points."""
    association, name = image.active_scalars_info
    on_points = str(getattr(association, "name", association)).upper() == "POINT"
    if name is None:
        on_points = len(image.point_data.keys()) > 0
        names = (image.point_data if on_points else image.cell_data).keys()
        if not names:
            raise ImageError("image: expected an ImageData with point or cell data, found none")
        name = names[0]
    return str(name), np.asarray((image.point_data if on_points else image.cell_data)[name]), on_points
