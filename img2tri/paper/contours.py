"""Contours of the white zone: a mask in, one closed ring of pixel centres for each component out.

Section III-C of the paper: ``cv2.findContours(..., RETR_EXTERNAL, CHAIN_APPROX_SIMPLE)``. It is quick, and has three properties that the
paper's recipe inherits: the ring runs through the *centres* of the outermost pixels, so that a shape loses half a pixel all
around; holes, and islands within holes, are passed over; parts one pixel wide are run along twice, out and back. For outlines between
the pixels, with holes, use the stages of the default recipe.

Coordinates are the paper's: (x, y) = (column, row), whole numbers at the *centres* of pixels, y down.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from shapely import MultiPolygon, Polygon, get_parts, get_type_id, make_valid

from img2tri.arrays import Floats
from img2tri.errors import ImageError, ParameterError

POLYGON = 3  # what shapely.get_type_id says of one


def external_contours(mask: ArrayLike) -> list[Floats]:
    """Trace the outer contour of every white component; pixels that touch at a corner belong together.

    Parameters
    ----------
    mask
        (h, w); anything but 0 is white.

    Returns
    -------
    list of (k, 2) float64
        The corners of each contour, (x, y) = (column, row); the first is not repeated at the end. Contours of one or two points
        (single pixels, straight lines) enclose nothing and are left out. Empty when nothing is white.

    Raises
    ------
    ImageError
        When `mask` is not two-dimensional.

    Examples
    --------
    A square of 3 x 3 pixels makes a contour of side 2:

    >>> mask = np.pad(np.ones((3, 3), bool), 1)
    >>> external_contours(mask)[0].tolist()
    [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]]
    """
    import cv2

    white = np.asarray(mask) != 0
    if white.ndim != 2:
        raise ImageError(f"mask: expected rows and columns, found an array of shape {white.shape}")
    contours, _ = cv2.findContours(white.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [contour.reshape(-1, 2).astype(np.float64) for contour in contours if len(contour) >= 3]


def contour_polygon(contour: ArrayLike) -> Polygon | MultiPolygon:
    """Turn a contour into what it encloses, counted by even and odd crossings.

    Where the contour touches itself the polygon is split; where it runs out and back along a line, nothing is enclosed. So the
    result is valid, and has the area and the inside of the paper's ``Polygon(contour)``.

    Parameters
    ----------
    contour
        (k, 2), k >= 3, without or with its first point repeated at the end.

    Returns
    -------
    shapely.Polygon or shapely.MultiPolygon
        Valid; an empty polygon when the contour encloses nothing.

    Raises
    ------
    ParameterError
        When `contour` is not at least three finite points.

    Examples
    --------
    >>> contour_polygon([[0, 0], [4, 0], [4, 3]]).area
    6.0
    """
    points = np.asarray(contour, np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise ParameterError(f"contour: expected at least three finite points (k, 2), found an array of shape {points.shape}")
    polygon = Polygon(points)
    if polygon.is_valid:
        return polygon
    parts = get_parts(get_parts(make_valid(polygon)))
    parts = parts[get_type_id(parts) == POLYGON]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts.tolist()) if len(parts) else Polygon()
