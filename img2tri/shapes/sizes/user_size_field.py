"""What a user says of edge lengths -> a size field over the image, whose growth is limited.

One length for all needs no field. A length for each region, an array on the image grid, or a function of places becomes a grid over
the image, in which no length grows faster than the gradation per unit of distance (gradient limiting; Persson, "Mesh size functions
for implicit geometries and PDE-based gradient limiting", 2006, DOI 10.1007/s00366-006-0014-1): from each step of a geometric scale of
lengths, a distance transform says how far it reaches. What is given for each pixel gets cells as small as these, a function
cells as small as its lengths need.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats
from img2tri.errors import ParameterError
from img2tri.types import Frame

MOST_FIELD_CELLS = 2**20  # of the grid at most
FIRST_CELLS = 2**12  # cells, in which a function is asked first, to see how short its lengths are
SMALL_ENOUGH = 1.2  # cells should be as small as the shortest length; those larger by this factor are small enough
LENGTH_STEP = 1.1  # between the lengths whose reach is looked at

EdgeLength = float | str | Mapping[int, float | str] | Callable[[Floats], Floats] | NDArray[Any]


@dataclass(frozen=True, eq=False)
class SizeField:
    """Edge lengths over the image, in px.

    Attributes
    ----------
    grid
        (ny, nx) float64, at the centres of cells.
    cell
        Side of a cell, in px; cell (0, 0) lies at the origin of the plane.
    asked
        From points (k, 2) of the plane to the lengths (k,) a function of the user gives there, in px; None where there is none.
    """

    grid: Floats
    cell: float
    asked: Callable[[Floats], Floats] | None = None

    def __call__(self, points: Floats) -> Floats:
        """Return the lengths (k,) wanted at points (k, 2) of the plane."""
        from scipy.ndimage import map_coordinates

        at = points.T[::-1] / self.cell - 0.5
        result: Floats = map_coordinates(self.grid, at, order=1, mode="nearest")
        return result

    def on_outlines(self, points: Floats) -> Floats:
        """Return the lengths (k,) wanted at points (k, 2) of outlines, where a function may have a valley that lies between the cells."""
        found = self(points)
        return found if self.asked is None else np.minimum(found, self.asked(points))


def size_field(
    wanted: EdgeLength, frame: Frame, labels: NDArray[Any], *, gradation: float, name: str = "edge_length"
) -> tuple[float, SizeField | None]:
    """Return the greatest length in px, and the field of lengths, or None where it is the same everywhere.

    Parameters
    ----------
    wanted
        A length; lengths by label, the others taking the greatest of them; an array (h, w) of lengths in world units, one for each
        pixel; or a function of world places (k, 2) that returns lengths (k,) in world units.
    frame, labels
        Where the image lies, and its label map (h, w).
    gradation
        Greatest growth of lengths per unit of distance.

    Examples
    --------
    >>> labels = np.repeat([[1, 2]], 20, axis=0).repeat(20, axis=1)
    >>> longest, field = size_field({1: 2, 2: 8}, Frame((20, 40)), labels, gradation=0.2)
    >>> round(longest), field(np.array([[1.0, 10.0], [30.0, 10.0]])).round()
    (6, array([2., 4.]))
    """
    if isinstance(wanted, (str, float, int, np.number)):
        return frame.length(name, wanted) / frame.pixel, None
    if not isinstance(wanted, (Mapping, np.ndarray)) and (not callable(wanted) or isinstance(wanted, type)):
        raise ParameterError(f"{name}: expected a length, lengths by label, an array or a function, found {type(wanted).__name__}")
    if callable(wanted):
        lengths, cell, asked = *_in_cells(name, wanted, frame), partial(_asked, name, wanted, frame)
    else:
        pixels = _by_label(name, wanted, frame, labels) if isinstance(wanted, Mapping) else np.asarray(wanted)
        if pixels.shape != frame.shape:
            raise ParameterError(f"{name}: expected an array of the shape of the image {frame.shape}, found {pixels.shape}")
        if pixels.dtype.kind not in "iuf":
            raise ParameterError(f"{name}: expected an array of numbers, found {pixels.dtype}")
        lengths, cell, asked = *_shortest(_checked(name, np.asarray(pixels, np.float64)) / frame.pixel, frame), None
    grid = _limited(lengths, gradation * cell)
    return float(grid.max()), SizeField(grid, cell, asked)


def _cells(frame: Frame, least: float) -> tuple[int, int, float]:
    """How many rows and columns of cells at least so wide there are, and how wide they are, in px."""
    width, height = frame.shape[1] * frame.spacing[0] / frame.pixel, frame.shape[0] * frame.spacing[1] / frame.pixel
    cell = max(least, math.sqrt(width * height / MOST_FIELD_CELLS))
    return max(1, round(height / cell)), max(1, round(width / cell)), cell


def _in_cells(name: str, wanted: Callable[[Floats], Floats], frame: Frame) -> tuple[Floats, float]:
    """Ask a function for the lengths in cells, and again in smaller ones as long as these are large for its shortest length."""
    least = max(1.0, math.sqrt(math.prod(frame.shape) * math.prod(frame.spacing) / FIRST_CELLS) / frame.pixel)
    while True:
        ny, nx, cell = _cells(frame, least)
        y, x = (np.mgrid[:ny, :nx] + 0.5) * cell
        lengths = _asked(name, wanted, frame, np.stack([x.ravel(), y.ravel()], axis=1))
        least = max(1.0, float(lengths.min()))
        if cell <= SMALL_ENOUGH * _cells(frame, least)[2]:
            return lengths.reshape(ny, nx), cell


def _asked(name: str, wanted: Callable[[Floats], Floats], frame: Frame, points: Floats) -> Floats:
    """Ask a function for the lengths (k,) in px at points (k, 2) of the plane."""
    lengths = np.asarray(wanted(frame.world(points)), np.float64)
    if lengths.shape != (len(points),):
        raise ParameterError(f"{name}: expected the function to return ({len(points)},) lengths, found shape {lengths.shape}")
    return _checked(name, lengths) / frame.pixel


def _shortest(pixels: Floats, frame: Frame) -> tuple[Floats, float]:
    """Turn lengths in pixels to lengths in cells: the shortest of the pixels in it, or that of the pixel it lies in."""
    ny, nx, cell = _cells(frame, 1.0)
    lengths = pixels[::-1] if frame.upward else pixels
    for axis, count in enumerate((ny, nx)):
        per_cell = cell * frame.pixel / frame.spacing[1 - axis]
        if per_cell > 1:
            lengths = np.minimum.reduceat(lengths, (np.arange(count) * per_cell).astype(np.int64), axis=axis)
        else:
            lengths = np.take(lengths, ((np.arange(count) + 0.5) * per_cell).astype(np.int64), axis=axis)
    return lengths, cell


def _checked(name: str, lengths: Floats) -> Floats:
    if not (np.isfinite(lengths).all() and (lengths > 0).all()):
        raise ParameterError(f"{name}: expected lengths above 0 everywhere, found {lengths.min():g} to {lengths.max():g}")
    return lengths


def _by_label(name: str, wanted: Mapping[int, float | str], frame: Frame, labels: NDArray[Any]) -> Floats:
    """Length at each pixel, by its label; other labels take the greatest."""
    lengths = {label: frame.length(f"{name}[{label}]", value) for label, value in wanted.items()}
    if not lengths:
        raise ParameterError(f"{name}: expected lengths by label, found none")
    result = np.full(labels.shape, max(lengths.values()))
    for label, length in lengths.items():
        mine = labels == label
        if not mine.any():
            raise ParameterError(f"{name}: expected labels of the image, found {label!r}, which it does not have")
        result[mine] = length
    return result


def _limited(grid: Floats, growth: float) -> Floats:
    """Limit the growth from cell to cell."""
    import cv2

    straight, slanting = (grid[1:] - grid[:-1], grid[:, 1:] - grid[:, :-1]), (grid[1:, 1:] - grid[:-1, :-1], grid[1:, :-1] - grid[:-1, 1:])
    steepest = max(np.abs(step).max(initial=0) / length for steps, length in ((straight, 1), (slanting, 2**0.5)) for step in steps)
    if steepest <= growth * (1 + 1e-6):
        return grid  # from no cell to one beside it, so from none to any
    low, high = float(grid.min()), float(grid.max())
    result = grid
    for level in low * LENGTH_STEP ** np.arange(np.ceil(np.log(high / low) / np.log(LENGTH_STEP)) if high > low else 0):
        far = (grid > level * LENGTH_STEP**0.5).astype(np.uint8)
        if far.any():
            # The last bit depends on how many threads shared the work: distances are roots of whole numbers.
            distance = np.sqrt(np.rint(np.square(cv2.distanceTransform(far, cv2.DIST_L2, cv2.DIST_MASK_PRECISE), dtype=np.float64)))
            result = np.minimum(result, level * LENGTH_STEP**0.5 + growth * distance)
    return np.minimum(result, grid)
