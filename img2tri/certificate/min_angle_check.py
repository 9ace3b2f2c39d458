"""The smallest angles of a mesh, measured exactly where they may matter: elsewhere a tangent tells that they do not."""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex
from img2tri.triangles.min_angle_tangents import min_angle_tangents
from img2tri.triangles.tools.quality_summary import measure

ROUNDED = 1e-6  # relative: tangents that differ by less may be those of equal angles


def angles_below(vertices: Floats, triangles: Ints, below: float) -> tuple[Ints, Floats]:
    """Return the triangles (k,) that may have the smallest angle of all, or one below so many degrees; and their smallest angles (k,).

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 3.0]])
    >>> which, angles = angles_below(square, np.array([[0, 1, 2], [0, 2, 3]]), 30)
    >>> which.tolist(), angles.round(2).tolist()
    ([1], [26.57])
    """
    tangents = np.abs(min_angle_tangents(as_complex(vertices), triangles))  # an angle knows no orientation
    limit = max(float(tangents.min()), np.tan(np.radians(below)))
    which = np.flatnonzero(tangents <= limit * (1 + ROUNDED) + ROUNDED**2)
    return which, measure(vertices, triangles[which], ["min_angle"])["min_angle"]
