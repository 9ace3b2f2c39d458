"""The guard of all moves: no triangle may turn over, and the worst angle may not fall.

In: the vertices before and after a move. Out: the vertices after it, those of spoiled triangles put back to where they were. To put a
vertex back can spoil its other triangles in turn, so they are looked at again; as every round puts back at least one vertex that had
moved, it ends, in the worst case with all of them where they were.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex
from img2tri.errors import bounded
from img2tri.triangles.min_angle_tangents import min_angle_tangents

TANGENT_ROUNDING = 1e-12
"""Part of the tangent that counts as rounding: else a mesh merely shifted would be taken for spoiled."""


def put_back(before: Floats, after: Floats, triangles: Ints) -> Floats:
    """Put the vertices of triangles that a move spoiled back to where they were.

    Guarantees, up to rounding: no counter-clockwise triangle is turned over, and none has an angle below the smallest the mesh had
    before. A triangle may get worse within that, as most moves for the better make some. Triangles that were turned over before
    are as bad as they were at most.

    Parameters
    ----------
    before, after : (n, 2) float64
        Vertices before and after the move.
    triangles : (m, 3) int64

    Returns
    -------
    vertices : (n, 2) float64
        Each vertex either as in `after` or as in `before`.

    Examples
    --------
    >>> before = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    >>> after = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, -1.0]])
    >>> put_back(before, after, np.array([[0, 1, 2]]))[2].tolist()
    [0.0, 1.0]
    """
    floor = min_angle_tangents(as_complex(before), triangles)
    floor = np.minimum(floor, floor[floor > 0].min(initial=2.0))
    floor -= TANGENT_ROUNDING * np.abs(floor)
    result = after.copy()
    moved = (before != after).any(axis=1)
    look_at = np.flatnonzero(moved[triangles].any(axis=1))
    for _ in bounded("inversion guard", len(before) + 1):
        if not len(look_at):
            break
        fell = look_at[min_angle_tangents(as_complex(result), triangles[look_at]) < floor[look_at]]
        back = np.zeros(len(moved), bool)
        back[triangles[fell]] = True
        back &= moved
        result[back] = before[back]
        moved &= ~back
        look_at = np.flatnonzero(back[triangles].any(axis=1))
    return result
