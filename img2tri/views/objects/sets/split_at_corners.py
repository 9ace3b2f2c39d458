"""The pieces of a set of boundary edges: several inlets on the left side, the bore and the rim of a ring -> a number for each edge.

A side of the frame falls into its connected pieces: ``left_1`` and ``right_1`` lie lowest, ``bottom_1`` and ``top_1`` furthest left.

The outer boundary falls into connected pieces too, and these are cut at their corners, where the boundary turns by more than 40 degrees, so
that a square has four. They are numbered along the boundary with the mesh on the left, counter-clockwise around a part; each part begins
with the piece whose first vertex is lowest, then furthest left, and the largest part comes first. A boundary of more than 99 pieces, such
as one along pixels, is not cut at its corners.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints

_CORNER = 40.0  # degrees the boundary turns by in a corner; chords of a curve turn by less
_MOST = 99


def connected_pieces(start: Ints, end: Ints, along: Floats) -> Ints:
    """Give a number to each of the connected pieces of edges that lie on one straight line.

    Parameters
    ----------
    start, end
        (k,) int64, the vertices at the ends of each edge, all directed alike.
    along
        (n,) float64, the coordinate of each vertex along the line.

    Returns
    -------
    Ints
        (k,) int64, from 0, by ascending coordinate.

    Examples
    --------
    >>> connected_pieces(np.array([3, 0, 4]), np.array([2, 1, 5]), np.array([0, 1, 5, 6, 1, 2.0])).tolist()
    [1, 0, 0]
    """
    order = np.argsort(along[start] + along[end], kind="stable")
    low, high = (f(along[start], along[end])[order] for f in (np.minimum, np.maximum))
    number = np.empty(len(start), np.int64)
    number[order] = np.cumsum(np.concatenate([[False], low[1:] > high[:-1]]))
    return number


def outer_pieces(vertices: Floats, start: Ints, end: Ints, following: Ints, chosen: Bools, ring: Ints, area: Floats) -> Ints:
    """Give a number to each of the pieces of the outer boundary.

    Parameters
    ----------
    vertices
        (n, 2) float64.
    start, end
        (b,) int64, the vertices at the ends of each edge of the boundary, the mesh on its left.
    following
        (b,) int64, the edge that comes next.
    chosen
        (b,) bool, the edges to be numbered.
    ring, area
        The ring (b,) of each edge, and what each ring (r,) encloses.

    Returns
    -------
    Ints
        (b,) int64, from 0 on where `chosen`; 0 elsewhere, and everywhere if there are too many.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> i = np.arange(4)
    >>> outer_pieces(square, i, (i + 1) % 4, (i + 1) % 4, i < 9, i * 0, np.array([1.0])).tolist()
    [0, 1, 2, 3]
    """
    numbers = np.zeros(len(start), np.int64)
    if not chosen.any():
        return numbers
    before = np.empty_like(following)
    before[following] = np.arange(len(following))
    corner = _turns(vertices[end] - vertices[start], vertices[end[following]] - vertices[start[following]])
    for cut in (corner, np.zeros_like(corner)):
        joined = chosen & chosen[following] & ~cut
        head = chosen & ~joined[before]
        # A ring that is one piece begins where it is lowest.
        whole = chosen & (np.bincount(ring[head], minlength=len(area)) == 0)[ring]
        first = np.flatnonzero(head | whole)
        x, y = vertices[start[first]].T
        first = first[np.lexsort((x, y, ring[first]))]
        origins = first[np.unique(ring[first], return_index=True)[1]]
        order = np.flatnonzero(chosen)
        order = order[np.lexsort((_steps(origins, before)[order], ring[order], -area[ring[order]]))]
        head[origins] = True
        numbers[order] = np.cumsum(head[order]) - 1
        if numbers.max() < _MOST:
            return numbers
    return np.zeros_like(numbers)


def _turns(one: Floats, other: Floats) -> Bools:
    """Tell where the direction turns by more than a corner does."""
    across, forward = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0], (one * other).sum(axis=1)
    return np.asarray(np.abs(np.degrees(np.arctan2(across, forward))) > _CORNER)


def _steps(origins: Ints, before: Ints) -> Ints:
    """Count the steps from the origin of its ring to each edge: each looks one, two, four... edges back, until the origin is found."""
    steps, back = np.ones(len(before), np.int64), before.copy()
    steps[origins], back[origins] = 0, origins
    for _ in range(len(before).bit_length()):
        steps += steps[back]
        back = back[back]
    return steps
