"""Structured grid: an image in, evenly spaced candidate points out; those on white pixels stay.

Sections II-B and III-B of the paper, functions `generate_mesh` and `adjust_mesh` of its listing. A square grid knows nothing of
the outline: points keep up to one step away from it, so that the mesh has steps where the shape is slanted. Better points come
from `arc_length_samples` and `poisson_disk`.

Coordinates are the paper's: (x, y) = (column, row), whole numbers at the *centres* of pixels, y down.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Bools, Floats
from img2tri.errors import ImageError, ParameterError, finite, integer

MOST_POINTS = 10_000_000


def structured_grid(shape: tuple[int, int], *, step: float | tuple[float, float] = 10) -> Floats:
    """Lay a square grid of points over an image.

    Parameters
    ----------
    shape
        (h, w), rows and columns of the image.
    step
        Distance between neighbouring points, in pixels, or (across, down); 10 is the paper's. Half of it makes four times as many points.

    Returns
    -------
    (n, 2) float64
        (x, y) = (column, row), row by row. The first point is (0, 0).

    Raises
    ------
    ParameterError
        When `shape` is not two whole numbers, or `step` is not above 0.

    Notes
    -----
    The paper's section II-B, ``x_i = i * dx, y_j = j * dy`` (printed there as ``y_i = i * dy``).

    Examples
    --------
    >>> structured_grid((10, 25), step=10)
    array([[ 0., 0.],
           [10., 0.],
           [20., 0.]])
    """
    if len(shape) != 2:
        raise ParameterError(f"shape: expected (rows, columns), found {shape!r}")
    height, width = (integer("shape", n) for n in shape)
    across, down = (finite("step", length, above=0) for length in (step if isinstance(step, tuple) else (step, step)))
    if width / across * (height / down) > MOST_POINTS:
        raise ParameterError(f"step: expected a grid of at most {MOST_POINTS:,} points, found {across:.3g} for {width} x {height} pixels")
    x, y = np.meshgrid(np.arange(0, width, across, dtype=np.float64), np.arange(0, height, down, dtype=np.float64))
    return np.stack([x.ravel(), y.ravel()], axis=1)


def mask_filter(points: ArrayLike, mask: ArrayLike) -> Floats:
    """Keep the points that lie on a white pixel.

    A point is looked up at row ``floor(y)``, column ``floor(x)``; one outside the image lies on no pixel and is dropped.

    Parameters
    ----------
    points
        (n, 2), (x, y) = (column, row).
    mask
        (h, w); anything but 0 is white.

    Returns
    -------
    (k, 2) float64
        In their old order.

    Raises
    ------
    ImageError
        When `mask` is not two-dimensional.
    ParameterError
        When `points` are not (n, 2) numbers.

    Examples
    --------
    >>> mask_filter([[0, 0], [1, 0], [2, 0]], [[True, False, True]])
    array([[0., 0.],
           [2., 0.]])
    """
    white = np.asarray(mask) != 0
    if white.ndim != 2:
        raise ImageError(f"mask: expected rows and columns, found an array of shape {white.shape}")
    p = np.asarray(points, np.float64)
    p = p.reshape(0, 2) if p.size == 0 else p
    if p.ndim != 2 or p.shape[1] != 2:
        raise ParameterError(f"points: expected shape (n, 2), found {p.shape}")
    return p[_looked_up(p, white)]


def _looked_up(points: Floats, white: Bools) -> Bools:
    """Whether each point lies inside the image and on a white pixel."""
    height, width = white.shape
    within = (points >= 0).all(axis=1) & (points[:, 0] < width) & (points[:, 1] < height)  # False for NaN too
    kept = np.zeros(len(points), np.bool_)
    column, row = points[within].astype(np.int64).T
    kept[within] = white[row, column]
    return kept
