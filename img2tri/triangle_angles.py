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
    (x0, x1, x2), (y0, y1, y2) = (part[triangles.T] for part in vertices.T)
    angles = np.empty((len(triangles), 3))
    for corner, (x, y, next_x, next_y, last_x, last_y) in enumerate(
        ((x0, y0, x1, y1, x2, y2), (x1, y1, x2, y2, x0, y0), (x2, y2, x0, y0, x1, y1))
    ):
        to_next, to_last = (next_x - x, next_y - y), (last_x - x, last_y - y)
        cross, dot = to_next[0] * to_last[1] - to_next[1] * to_last[0], to_next[0] * to_last[0] + to_next[1] * to_last[1]
        angles[:, corner] = np.arctan2(np.abs(cross), dot)
    return angles
