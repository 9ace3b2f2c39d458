"""Which triangles hang together: neighbours -> the number of the face each triangle belongs to, or what is known of some of each face."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints


def connected_faces(neighbours: NDArray[np.int32]) -> Ints:
    """Return the number of the face that each triangle belongs to: those joined by a chain of neighbours.

    Parameters
    ----------
    neighbours
        (m, 3) int32, the triangles beyond the three sides of each; negative where there is none, or none that counts. Whoever has a
        neighbour is its neighbour too.

    Returns
    -------
    face : (m,) int64
        From 0 on; faces are numbered by no order that means anything.

    Examples
    --------
    >>> connected_faces(np.array([[-1, 1, -1], [0, -1, -1], [-1, -1, -1]], np.int32)).tolist()
    [0, 0, 1]
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    joined = neighbours >= 0
    ends = np.zeros(len(neighbours) + 1, np.int32)
    a, b, c = joined.view(np.int8).T
    np.cumsum(a + b + c, out=ends[1:])
    beyond = neighbours[joined]
    graph = csr_array((np.ones(len(beyond)), beyond, ends), shape=(len(neighbours),) * 2)
    # Its links all go both ways: strongly connected is connected, and found without a transposed copy.
    return connected_components(graph, connection="strong")[1].astype(np.int64)


def spread(neighbours: NDArray[np.int32], values: Ints, known: Bools) -> None:
    """Give each triangle the value of a known one that it hangs together with: flood fill, all fronts at a time.

    Parameters
    ----------
    neighbours
        As for `connected_faces`.
    values, known
        (m,) int64 and bool, what is known of which triangles; both are filled in. Triangles that hang together with none stay.

    Examples
    --------
    >>> values, known = np.array([7, 0, 0]), np.array([True, False, False])
    >>> spread(np.array([[-1, 1, -1], [0, -1, -1], [-1, -1, -1]], np.int32), values, known)
    >>> values.tolist(), known.tolist()
    ([7, 7, 0], [True, True, False])
    """
    front: NDArray[np.integer[Any]] = known.nonzero()[0]
    place = np.zeros(len(values), np.int64)
    while len(front):
        beyond, here = neighbours.take(front, axis=0).ravel(), front.repeat(3)
        at = ((beyond >= 0) & ~known[beyond]).nonzero()[0]
        front = beyond[at]
        values[front], known[front] = values[here[at]], True
        # Whoever is reached from two sides goes on once.
        place[front] = order = np.arange(len(front))
        front = front[place[front] == order]
