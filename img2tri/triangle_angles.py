"""The angle at each corner of each triangle, for measures and figures alike: vertices, triangles -> radians, however a triangle is wound.

By arctan2 of cross and dot product, which is exact to rounding even for needles.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints


def triangle_angles(vertices: Floats, triangles: Ints) -> Floats:
    """Return the angles (m, 3) in radians at the corners of triangles (m, 3) over vertices (n, 2).

    Examples
    --------
    >>> np.rad2deg(triangle_angles(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])).round(9)).round(3).tolist()
    [[90.0, 45.0, 45.0]]
    """
    corners = vertices[triangles]
    to_next = np.roll(corners, -1, axis=1) - corners
    to_last = np.roll(corners, 1, axis=1) - corners
    cross = to_next[..., 0] * to_last[..., 1] - to_next[..., 1] * to_last[..., 0]
    angles: Floats = np.arctan2(np.abs(cross), (to_next * to_last).sum(axis=2))
    return angles
