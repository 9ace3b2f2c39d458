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

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, cross
from img2tri.shapes.place.constrained_smoothing import BoundedChains, ChainEnds

UNSURE = 1.0  # px, the scale that counts for ends that are not smoothed
AMID = 16.0  # px^2, the weight of the mean of the crossings beside a node: as much as an end of scale 4 has
RIDGE = 0.01  # of all weights: added to that, for chains that lead the same way
FADE = 4  # crossings, after which the bend towards a node is an eighth of what it is there
LEAST_WEDGE = np.radians(58.0)  # the least angle at which chains may meet
MOST_TURN = 0.235  # of the axis: how far crossings are shifted for that
TURN_ENOUGH = np.radians(0.5)  # what is less is not looked after
TURNINGS, PUSHINGS, MIDDLINGS = 4, 4, 30  # how often chains that meet at less are turned, then their node moved, then all of it moved back
LEAST_LENGTH, LEAST_SINE = 0.1, 0.1  # px, and of half a wedge's angle: so that no step is too long
MOST_MIDDLING = 0.3  # of the way to the middle, each time
SLANT = 0.3  # of the axis, at least across the chain: what runs along it is not bent


def meeting_places(s: BoundedChains, ends: ChainEnds, movable: Bools, bounds: Points) -> Points:
    """Move nodes to where the chains that meet there lead.

    Parameters
    ----------
    s, ends
        The chains, smoothed, each node in the middle of its bounds, and where they lead.
    movable
        (n,) bool, the nodes that are to be moved.
    bounds
        (n,) how far a node may move, to the right plus i times up.

    Returns
    -------
    points : (n,) complex
        Those of the chains, movable nodes at their new places.
    """
    chains, first, last = s.chains, *s.chains.ends
    ending = np.tile(~chains.rings, 2)
    nodes, node = np.unique(np.concatenate([first, last])[ending], return_inverse=True)
    n, points, bounds = len(nodes), s.points[nodes], bounds[nodes]
    known = np.minimum(ends.scale, np.diff(chains.starts)[:, None] / 3)  # a short chain tells no more than its length
    place, normal, scale = (part.T[:, ~chains.rings].ravel() for part in (ends.place, 1j * ends.direction, known))
    weight = np.maximum(scale, UNSURE) ** 2
    away = weight * ((place - points[node]) * normal.conj()).real

    def sums(values: Floats) -> Floats:
        return np.asarray(np.bincount(node, values, n), np.float64)

    # Where short chains say little, a node lies amid the crossings beside it.
    beside = s.points[np.concatenate([chains.indices[chains.first + 1], chains.indices[chains.last - 1]])[ending]] - points[node]
    amid = (sums(beside.real) + 1j * sums(beside.imag)) / np.bincount(node, minlength=n)

    # The normal equations of each node, two by two.
    xx, xy, yy = (sums(weight * part) for part in (normal.real**2, normal.real * normal.imag, normal.imag**2))
    x, y = (sums(away * part) for part in (normal.real, normal.imag))
    held = AMID + RIDGE * sums(weight)
    xx, yy, x, y = xx + held, yy + held, x + held * amid.real, y + held * amid.imag
    determinant = xx * yy - xy * xy
    off_x, off_y = (yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant
    off = np.clip(off_x, -bounds.real, bounds.real) + 1j * np.clip(off_y, -bounds.imag, bounds.imag)
    result = s.points.copy()
    result[nodes] = np.where(movable[nodes], points + off, points)
    return result


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


def open_wedges(s: BoundedChains, shift: Floats, middle: Points, junctions: Bools, bounds: Points) -> tuple[BoundedChains, Floats]:
    """Open what is sharp where chains meet at some `junctions` (n,): return the chains with nodes that moved, and shifts (n,).

    The crossings beside a node are turned away from each other, as far as their bounds go; then the node goes on into the wedge, within
    its `bounds` (n,). Where that does not suffice they all go back towards their `middle` (n,), where angles are right ones. Crossings
    beside junctions are then bounded to where they are.
    """
    points, chains, begun = s.points.copy(), s.chains, shift
    node = np.concatenate([chains.indices[chains.first], chains.indices[chains.last]])
    beside = np.concatenate([chains.indices[chains.first + 1], chains.indices[chains.last - 1]])
    at = np.flatnonzero(junctions[node] & np.tile(~chains.rings, 2))
    at = at[np.argsort(node[at], kind="stable")]
    node, beside = node[at], beside[at]
    axis = s.axis[beside]
    for attempt in range(TURNINGS + PUSHINGS + MIDDLINGS):
        heading = points[beside] + shift[beside] * axis - points[node]
        turn, push = _lacking_angles(node, heading)
        if not (np.abs(turn) > TURN_ENOUGH).any():
            break
        if attempt < TURNINGS:
            ahead = heading * np.exp(1j * turn)
            across = cross(axis, ahead)
            steep = np.abs(across) > SLANT * np.abs(axis) * np.abs(ahead)
            by = np.bincount(beside, np.divide(-cross(heading, ahead), across, out=np.zeros(len(node)), where=steep), len(shift))
            shift = np.clip(shift + by, begun - MOST_TURN, begun + MOST_TURN)
        elif attempt < TURNINGS + PUSHINGS:
            points += np.bincount(node, push.real, len(points)) + 1j * np.bincount(node, push.imag, len(points))
            off = points - middle
            within = np.clip(off.real, -bounds.real, bounds.real) + 1j * np.clip(off.imag, -bounds.imag, bounds.imag)
            points = np.where(junctions, middle + within, points)
        else:
            # As far as the sharpest angle at the node asks for.
            back = np.zeros(len(points))
            np.maximum.at(back, node, np.minimum(np.abs(turn), MOST_MIDDLING))
            np.maximum.at(back, beside, back[node])
            points += np.where(junctions, back, 0) * (middle - points)
            slides = np.flatnonzero((s.axis != 0) & (back > 0))
            shift = shift.copy()
            shift[slides] += back[slides] * (((middle - points)[slides] / s.axis[slides]).real - shift[slides])
        shift = np.clip(shift, s.low, s.high)
    held = np.isin(np.arange(len(shift)), beside)
    return replace(s, points=points, low=np.where(held, shift, s.low), high=np.where(held, shift, s.high)), shift


def _lacking_angles(node: Ints, heading: Points) -> tuple[Floats, Points]:
    """Return by how much, counter-clockwise, each of the ends (k,) of chains would have to turn for the angles at its node.

    And how far the node would have to go instead, into the wedge between two ends, at one of these.
    """
    turn, push, length = np.zeros(len(node)), np.zeros(len(node), np.complex128), np.maximum(np.abs(heading), LEAST_LENGTH)
    for step in (1, 2, 3):  # at most four chains meet
        one = np.flatnonzero(node[step:] == node[:-step])
        other = one + step
        angle = np.angle(heading[other] * heading[one].conj())
        lacking = np.maximum(LEAST_WEDGE - np.abs(angle), 0) / 2 * np.where(angle < 0, -1, 1)
        np.subtract.at(turn, one, lacking)
        np.add.at(turn, other, lacking)
        along = heading[one] / length[one] + heading[other] / length[other]
        opens = np.maximum(np.sin(np.abs(angle) / 2), LEAST_SINE) * (1 / length[one] + 1 / length[other])
        np.add.at(push, one, 2 * np.abs(lacking) / opens * along / np.maximum(np.abs(along), 1e-12))
    return turn, push
