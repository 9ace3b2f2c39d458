"""An image on the grid of a mesh -> its values on triangles or vertices: gray levels, a measured field, labels.

The mean over a triangle takes each pixel by the area it shares with the triangle, so that sums over the mesh are those over the pixels it
covers. Vertices take what lies there, between the centres of pixels in proportion. Labels have no mean: the pixel at the place is taken.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import ImageError, choice
from img2tri.types import Frame, Provenance


def sample(
    image: Any,
    vertices: Floats,
    triangles: Ints,
    frame: Frame,
    origin: Provenance | None,
    *,
    on: str = "triangles",
    method: str | None = None,
) -> NDArray[Any]:
    """Carry an image to a mesh.

    Parameters
    ----------
    image
        (h, w) or (h, w, k), bool, integers or floats, on the grid of the image the mesh was made from, the whole or the part that was
        cropped; or the path of such an image. NaN and masked pixels have no value.
    vertices, triangles, frame, origin
        The mesh: (n, 2) world coordinates, (m, 3), where its image lies, and how it was made.
    on
        "triangles" or "vertices".
    method
        "mean": of triangles the mean over their area, exact, at vertices linear between the centres of pixels. "nearest": the value of the
        pixel at the centroid, or at the vertex, as it is; for labels. None: "nearest" for bool, "mean" for numbers.

    Returns
    -------
    numpy.ndarray
        (m,) or (n,), with k columns if the image has; float64, NaN where there is no value; of the type of the image with "nearest".

    Raises
    ------
    ImageError
        If the image has another grid.

    Examples
    --------
    >>> from img2tri.types import Frame
    >>> square = np.array([[0, 0], [2, 0], [2, 2], [0, 2.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    >>> sample(np.array([[1, 1], [4, 4]]), *square, Frame((2, 2)), None)
    array([3.25, 1.75])
    """
    from img2tri.triangles.tools.pixel_means import pixel_means

    choice("on", on, ("triangles", "vertices"))
    values = _on_the_grid(image, frame, origin)
    how = choice("method", method or ("nearest" if values.dtype == bool else "mean"), ("mean", "nearest"))
    places = vertices if on == "vertices" or how == "mean" else vertices[triangles].mean(axis=1)
    row, column = frame.row_column(places)
    if how == "nearest":
        h, w = frame.shape
        return np.asarray(values[_pixel(row, h), _pixel(column, w)])
    layers = np.asarray(values, np.float64).reshape(*values.shape[:2], -1)
    if on == "triangles":
        means = [pixel_means(np.stack([column, row], axis=1), triangles, layers[..., k]) for k in range(layers.shape[2])]
    else:
        means = [_between(row, column, layers[..., k]) for k in range(layers.shape[2])]
    return means[0] if values.ndim == 2 else np.stack(means, axis=1)


def _on_the_grid(image: Any, frame: Frame, origin: Provenance | None) -> NDArray[Any]:
    """Return the values of the part of an image that was meshed."""
    if isinstance(image, (str, os.PathLike)):
        from img2tri.raster.reading import read

        page = int(origin.options.get("page", 0)) if origin else 0
        values: NDArray[Any] = read(image, page=page).values
    elif isinstance(image, np.ma.MaskedArray):
        values = np.where(np.ma.getmaskarray(image), np.nan, np.asarray(np.ma.getdata(image), np.float64))
    else:
        values = np.asarray(image)
    crop = origin.settings.get("crop") if origin else None
    if crop and values.shape[:2] == tuple(crop["of"]):
        values = values[slice(*crop["rows"]), slice(*crop["columns"])]
    if values.ndim not in (2, 3) or values.shape[:2] != frame.shape or values.dtype.kind not in "biuf":
        raise ImageError(f"image: expected numbers on the grid of the mesh, {frame.shape}, found {values.dtype} of shape {values.shape}")
    return values


def _pixel(along: Floats, count: int) -> Ints:
    return np.clip(np.floor(along).astype(np.int64), 0, count - 1)


def _between(row: Floats, column: Floats, values: Floats) -> Floats:
    """Interpolate between the centres of pixels; those without a value are left out."""
    h, w = values.shape
    r, c = np.clip(row - 0.5, 0, h - 1), np.clip(column - 0.5, 0, w - 1)
    top, left = np.floor(r).astype(np.int64), np.floor(c).astype(np.int64)
    total, weight = np.zeros(len(r)), np.zeros(len(r))
    for down in (0, 1):
        for right in (0, 1):
            found = values[np.minimum(top + down, h - 1), np.minimum(left + right, w - 1)]
            share = np.abs(1 - down - (r - top)) * np.abs(1 - right - (c - left)) * np.isfinite(found)
            total += share * np.where(np.isfinite(found), found, 0.0)
            weight += share
    return np.asarray(np.where(weight > 0, total / np.where(weight > 0, weight, 1.0), np.nan))
