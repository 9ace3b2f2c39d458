"""Points spread evenly along a closed outline: a ring in, n points at equal arc length out.

Section II-C of the paper, function `distribute_boundary_points` of its listing, as one interpolation over the arc length. The
listing walks from segment to segment; it repeats the first point at the end, and, in every other case or so, loses the last one because
rounding made the walk fall short: a gap of two spacings is left. Here there are always n points, each once. Otherwise they are
the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats
from img2tri.errors import ParameterError, integer


def arc_length_samples(boundary: ArrayLike, n_points: int) -> Floats:
    """Spread points evenly along a closed boundary.

    Corners between the points are cut: the polygon through the points is inside the boundary where that is convex, the more so
    the fewer points there are.

    Parameters
    ----------
    boundary
        (k, 2) corners of the ring in order, k >= 2; whether the first is repeated at the end makes no difference.
    n_points
        How many points, at least 1.

    Returns
    -------
    (n_points, 2) float64
        Point i lies at arc length ``(i + 1) * perimeter / n_points`` from the first corner, so the last lies on that corner.

    Raises
    ------
    ParameterError
        When `boundary` is not (k, 2) finite numbers or has no length, or `n_points` is no whole number of at least 1.

    Notes
    -----
    The paper's section II-C: ``p = b_i + t (b_{i+1} - b_i)`` with ``t = (d - current length) / L_i``.

    Examples
    --------
    >>> arc_length_samples([[0, 0], [4, 0], [4, 4], [0, 4]], 8).tolist()
    [[2.0, 0.0], [4.0, 0.0], [4.0, 2.0], [4.0, 4.0], [2.0, 4.0], [0.0, 4.0], [0.0, 2.0], [0.0, 0.0]]
    """
    corners = np.asarray(boundary, np.float64)
    n = integer("n_points", n_points, least=1)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 2 or not np.isfinite(corners).all():
        raise ParameterError(f"boundary: expected at least two finite points (k, 2), found an array of shape {corners.shape}")
    ring = np.concatenate([corners, corners[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    if arc[-1] == 0:
        raise ParameterError(f"boundary: expected a ring with a length, found {len(corners)} points in one place")
    at = arc[-1] * np.arange(1, n + 1) / n
    return np.stack([np.interp(at, arc, ring[:, 0]), np.interp(at, arc, ring[:, 1])], axis=1)
