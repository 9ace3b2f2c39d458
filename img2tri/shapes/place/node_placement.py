"""Nodes where the chains that meet there lead, by least squares; and chains bent to end at their nodes.

Chains are smoothed without regard to where their nodes are, see `smoothing_splines`. Each end of a chain then is a straight line, known
the better the wider its spline is. A node is put to the place in its block with the least weighted sum of squared distances from
the lines that meet there. Last, each chain is bent to its nodes, over the last few crossings::

        |  /                       |  /
        | /        x the node      | /
        |x   ---   the chain       |x.__
        |   -----                  |    ----

Tried and dropped: nodes placed first, by averaging along the chains, and chains smoothed through them: half as exact, as one
misplaced node denies wide splines to all of its chains.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Points, cross
from img2tri.shapes.place.constrained_smoothing import BoundedChains, ChainEnds

UNSURE = 1.0  # px, the scale that counts for ends that are not smoothed
RIDGE = 0.01  # of the weights: how much a node is held to where it was, for chains that lead the same way
FADE = 4  # crossings, after which the bend towards a node is an eighth of what it is there
SLANT = 0.3  # of the axis, at least across the chain: what runs along it is not bent


def meeting_places(s: BoundedChains, ends: ChainEnds, movable: Bools, bounds: Points) -> Points:
    """Move nodes to where the chains that meet there lead.

    Parameters
    ----------
    s, ends
        The chains, each node in the middle of its bounds, and where they lead.
    movable
        (n,) bool, the nodes that are to be moved.
    bounds
        (n,) how far a node may move, to the right plus i times up.

    Returns
    -------
    points : (n,) complex
        Those of the chains, movable nodes at their new places.
    """
    chains, n = s.chains, len(s.points)
    first, last = chains.ends
    node = np.concatenate([first, last])[np.tile(~chains.rings, 2)]
    known = np.minimum(ends.scale, np.diff(chains.starts)[:, None] / 3)  # a short chain tells no more than its length
    place, normal, scale = (part.T[:, ~chains.rings].ravel() for part in (ends.place, 1j * ends.direction, known))
    weight = np.maximum(scale, UNSURE) ** 2
    away = weight * ((place - s.points[node]) * normal.conj()).real

    # The normal equations of each node, two by two.
    total = np.bincount(node, weight, n)
    xx, xy, yy = (np.bincount(node, weight * part, n) for part in (normal.real**2, normal.real * normal.imag, normal.imag**2))
    x, y = (np.bincount(node, away * part, n) for part in (normal.real, normal.imag))
    xx, yy = xx + RIDGE * total, yy + RIDGE * total
    determinant = np.where(total > 0, xx * yy - xy * xy, 1.0)
    off_x, off_y = (yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant
    off = np.clip(off_x, -bounds.real, bounds.real) + 1j * np.clip(off_y, -bounds.imag, bounds.imag)
    return np.where(movable, s.points + off, s.points)


def bend_to_nodes(s: BoundedChains, shift: Floats, ends: ChainEnds, nodes: Bools) -> Floats:
    """Return the shifts (n,) of crossings bent so that chains end at the places of these `nodes` (n,), which are among their points."""
    result = shift.copy()
    indices, size = s.chains.indices, np.diff(s.chains.starts)
    for end, (entry, step) in enumerate(((s.chains.first, 1), (s.chains.last, -1))):
        node, direction = indices[entry], ends.direction[:, end]
        gap = cross(direction, s.points[node] - ends.place[:, end])
        bent = np.flatnonzero(nodes[node] & ~s.chains.rings & s.movable)
        for count in range(1, 2 * FADE + 1):
            bent = bent[size[bent] > 2 * count]  # each half of a chain is bent to its own end
            at = indices[entry[bent] + step * count]
            across = cross(direction[bent], s.axis[at])
            by = gap[bent] * 2.0 ** (-3 * (count / FADE) ** 2)
            result[at] += by * across / np.maximum(across**2, (SLANT * np.abs(s.axis[at])) ** 2)
    return np.clip(result, s.low, s.high)
