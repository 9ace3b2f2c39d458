"""The smallest angle of each triangle, by its tangent: cheap, and told apart without an arc tangent where angles are only compared.

In: vertices (n,) complex and triangles (m, 3). Out: one number per triangle, which grows with the smallest angle and is negative where a
triangle is clockwise. All angles exactly, for statistics, are measured in `img2tri.triangles.tools.triangle_metrics`.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, blocks


def min_angle_tangents(vertices: Points, triangles: Ints) -> Floats:
    """Return the tangent (m,) of the smallest angle of each triangle; negative for clockwise triangles, 0 for flat ones.

    The smallest angle lies opposite the shortest side: its cotangent is (sum of the other squares - its square) / (4 area).

    Examples
    --------
    >>> min_angle_tangents(np.array([0, 1, 1j]), np.array([[0, 1, 2], [0, 2, 1]]))
    array([ 1., -1.])
    """
    tangents = np.empty(len(triangles))
    for block in blocks(len(triangles), 1 << 14):  # six numbers a triangle
        a, b, c = vertices[np.ascontiguousarray(triangles[block].T)]
        u, v, w = b - a, c - b, a - c
        uu, vv, ww = (side.real**2 + side.imag**2 for side in (u, v, w))
        shortest = np.minimum(np.minimum(uu, vv), ww)
        doubled = 2 * (u.real * v.imag - u.imag * v.real)
        spread = uu + vv + ww - 2 * shortest
        # Only where all three vertices coincide is there nothing to divide by.
        tangents[block] = doubled / np.where(spread > 0, spread, 1.0)
    return tangents


def smallest_angles(vertices: Points, triangles: Ints) -> Floats:
    """Return the smallest angle (m,) of each triangle in degrees; negative for clockwise ones."""
    angles: Floats = np.degrees(np.arctan(min_angle_tangents(vertices, triangles)))
    return angles


def narrower(vertices: Points, triangles: Ints, degrees: float) -> Bools:
    """Tell which triangles (m,) have an angle of less than so many degrees, or are clockwise."""
    return np.asarray(min_angle_tangents(vertices, triangles) < np.tan(np.radians(degrees)))
