"""The guard of all moves: no triangle may turn over, and the worst angle may not fall.

In: the vertices before and after a move. Out: the vertices after it, those of spoiled triangles put back to where they were. To put a
vertex back can spoil its other triangles in turn, so they are looked at again; as every round puts back at least one vertex that had
moved, it ends, in the worst case with all of them where they were.
"""

from __future__ import annotations

import numpy as np

from img2tri.types import Floats, Ints

SLACK = 1e-12
"""Part of the sine that counts as rounding: else a mesh merely shifted would be taken for spoiled."""


def sines(vertices: Floats, triangles: Ints) -> Floats:
    """Return the sine of the smallest angle (m,) of each triangle, negative where it is turned over, 0 where it is flat.

    Cheaper than the angle and as good to compare by, the smallest angle being at most 60 degrees.

    Examples
    --------
    >>> sines(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2], [0, 2, 1]])).round(3)
    array([ 0.707, -0.707])
    """
    x, y = vertices[:, 0][triangles], vertices[:, 1][triangles]
    u, v = x[:, [1, 2, 0]] - x, y[:, [1, 2, 0]] - y
    squares = u * u + v * v
    doubled = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    # Twice the area over the product of the two longest edges.
    a, b, c = squares.T
    largest = np.maximum(np.maximum(a * b, b * c), c * a)
    result: Floats = np.divide(doubled, np.sqrt(largest), out=np.zeros(len(doubled)), where=largest > 0)
    return result


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
    floor = sines(before, triangles)
    floor = np.minimum(floor, floor[floor > 0].min(initial=1.0))
    floor -= SLACK * np.abs(floor)
    result = after.copy()
    moved = (before != after).any(axis=1)
    look_at = np.flatnonzero(moved[triangles].any(axis=1))
    while len(look_at):
        fell = look_at[sines(result, triangles[look_at]) < floor[look_at]]
        back = np.zeros(len(moved), bool)
        back[triangles[fell]] = True
        back &= moved
        result[back] = before[back]
        moved &= ~back
        look_at = np.flatnonzero(back[triangles].any(axis=1))
    return result
