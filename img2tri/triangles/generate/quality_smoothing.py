"""Moving vertices so that triangles become as equilateral as they can.

The shape of a triangle (a, b, c), counter-clockwise, is told by two complex numbers, with w = exp(2 pi i / 3):

    X = a + w b + w^2 c        0 if and only if the triangle is equilateral: its *defect*
    Y = a + w^2 b + w c        its size and direction

They say all: the squares of the edges sum to |X|^2 + |Y|^2, the area is (|Y|^2 - |X|^2) / (4 sqrt 3), and the quality
4 sqrt(3) area / (sum of squares) = (|Y|^2 - |X|^2) / (|Y|^2 + |X|^2) is 1 for equilateral triangles, 0 for flat ones. To make its triangle
equilateral, corner a alone would have to move by -X, corner b by -w^2 X, corner c by -w X.

`relaxed` moves every vertex by the mean of what its triangles ask, weighted by quality^-power: Jacobi steps down the energy
sum of weight |X|^2, whose matrix is C diag(weight) C* with a row of C for each vertex and a column for each triangle. With power 2 that
is a quick smoother. Large powers hear only the worst triangle of each vertex: hill climbing for the smallest angle, but in a few
array operations for all vertices. Vertices on outlines take of their moves what goes along their *rails*.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from img2tri.triangles.generate.hexagonal_lattice import Complex, blocks
from img2tri.types import Bools, Floats, Ints

TURN = np.exp(2j * np.pi / 3)
DEFECT = np.array([1, TURN, TURN**2])
SAFE = 30.0  # degrees: no angle is made smaller than this
FLATTEST = 0.05  # qualities below this weigh as much as this, else one flat triangle stops its neighbours

Schedule = Sequence[tuple[int, float, int]]
"""Rows of (doublings, damping, steps): the power of the weights is 2 to the number of doublings."""
SMOOTH: Schedule = ((1, 1.0, 5),)
CLIMB: Schedule = ((5, 0.3, 4), (6, 0.2, 4), (7, 0.1, 7))
SLIDING = 0.8  # of its step is what a vertex on a rail takes
TARGET = 44.0  # degrees: angles above this are not worth a climb
WORST = 2.0  # degrees: a climb goes where angles are within this of the worst
CLIMBS = 2  # one after the other, as the worst place may then be another
RINGS = 3  # of triangles around the worst that may move in a climb


def shapes(vertices: Complex, triangles: Ints) -> tuple[Complex, Floats]:
    """Return defect X and quality of triangles; the quality is at most 1, and negative for clockwise triangles."""
    return _shapes(vertices, _columns(triangles))


def _columns(triangles: Ints) -> Ints:
    """First, second, third corners (3, m), each side by side in memory."""
    return np.ascontiguousarray(triangles.T)


def _shapes(vertices: Complex, corners: Ints) -> tuple[Complex, Floats]:
    a, b, c = (vertices[corner] for corner in corners)
    # X, Y = median +- side, where the side is turned by 90 degrees and made as long as the median should be.
    median, side = a - (b + c) / 2, (b - c) * (0.75**0.5 * 1j)
    cross = median.real * side.real + median.imag * side.imag
    squares = median.real**2 + median.imag**2 + side.real**2 + side.imag**2
    return median + side, -2 * cross / squares


def smallest_tangents(vertices: Complex, triangles: Ints) -> Floats:
    """Return the tangent of the smallest angle of each triangle, which grows with the angle; negative for clockwise triangles."""
    tangents = np.empty(len(triangles))
    for block in blocks(len(triangles)):
        a, b, c = vertices[_columns(triangles[block])]
        u, v, w = b - a, c - b, a - c
        uu, vv, ww = (side.real**2 + side.imag**2 for side in (u, v, w))
        shortest = np.minimum(np.minimum(uu, vv), ww)
        # The smallest angle lies opposite the shortest side: cot = (sum of the other squares - its square) / (4 area).
        tangents[block] = 2 * (u.real * v.imag - u.imag * v.real) / (uu + vv + ww - 2 * shortest)
    return tangents


def smallest_angles(vertices: Complex, triangles: Ints) -> Floats:
    """Return the smallest angle of each triangle in degrees; negative for clockwise ones."""
    angles: Floats = np.degrees(np.arctan(smallest_tangents(vertices, triangles)))
    return angles


def narrow(vertices: Complex, triangles: Ints, min_angle: float) -> Bools:
    """Tell which triangles have an angle of less than so many degrees, or are clockwise."""
    return np.asarray(smallest_tangents(vertices, triangles) < np.tan(np.radians(min_angle)))


@dataclass(frozen=True, eq=False)
class Rails:
    """Vertices that may slide along straight lines.

    Attributes
    ----------
    at
        (k,) int64, which.
    along
        (k,) complex, the unit directions of their lines.
    start
        (k,) complex, where they stand before they slide.
    room
        (k,) float64, how far from there they may go either way.
    """

    at: Ints
    along: Complex
    start: Complex
    room: Floats


def relaxed(vertices: Complex, triangles: Ints, free: Bools, schedule: Schedule, rails: Rails | None = None) -> Complex:
    """Move the free vertices (bool) by damped steps, others along their rails.

    The worst angle does not fall, nor does any one fall below 30 degrees.
    """
    moved = vertices.copy()
    n, m = len(vertices), len(triangles)
    corners = _columns(triangles)
    # One row per vertex, one column per triangle, with an entry for each of its corners.
    entries, ends = triangles.ravel().astype(np.int32), np.arange(0, 3 * m + 1, 3, dtype=np.int32)
    asked = csc_array((np.tile(-DEFECT.conj(), m), entries, ends), shape=(n, m))
    heard = csc_array((np.ones(3 * m), entries, ends), shape=(n, m))
    where = np.flatnonzero(free & (np.bincount(entries, minlength=n) > 0))
    weight, pull = np.empty(m), np.empty(m, np.complex128)
    for doublings, damping, steps in schedule:
        for _ in range(steps):
            for block in blocks(m):
                defect, quality = _shapes(moved, corners[:, block])
                loud = 1 / np.maximum(quality, FLATTEST)
                for _ in range(doublings):
                    loud *= loud
                weight[block] = loud
                np.multiply(loud, defect, out=pull[block])
            pulled, heavy = np.asarray(asked @ pull), np.asarray(heard @ weight)
            moved[where] += damping * pulled[where] / heavy[where]
            if rails is not None:
                step = SLIDING * damping * pulled[rails.at] / heavy[rails.at]
                way = ((moved[rails.at] + step - rails.start) * rails.along.conj()).real
                moved[rails.at] = rails.start + np.clip(way, -rails.room, rails.room) * rails.along
    return _guarded(vertices, moved, triangles)


def touched(triangles: Ints, marked: Bools) -> Bools:
    """Tell which triangles have a marked vertex."""
    a, b, c = (marked[corner] for corner in triangles.T)
    either: Bools = a | b | c
    return either


def climbed(vertices: Complex, triangles: Ints, free: Bools, target: float = TARGET) -> Complex:
    """Relax with large powers, but only around the worst angles, and as long as these are less than `target` degrees."""
    for _ in range(CLIMBS):
        angles = smallest_angles(vertices, triangles)
        near = angles < min(target, angles.min(initial=target) + WORST)
        if not near.any():
            break
        for _ in range(RINGS):
            zone = np.zeros(len(vertices), bool)
            zone[triangles[near]] = True
            near = touched(triangles, zone)
        vertices = relaxed(vertices, triangles[near], free & zone, CLIMB)
    return vertices


def _guarded(before: Complex, after: Complex, triangles: Ints) -> Complex:
    """Shorten the moves of vertices of triangles that became bad: whose angle fell below 30 degrees or below the worst before."""
    tangents = smallest_tangents(before, triangles)
    least = np.minimum(tangents, max(math.tan(math.radians(SAFE)), tangents.min(initial=np.inf))) - 1e-12
    moved, part = after.copy(), np.ones(len(before))
    worse = np.flatnonzero(smallest_tangents(after, triangles) < least)
    while len(worse):
        back = np.unique(triangles[worse])
        back = back[part[back] > 0]
        part[back] = np.where(part[back] > 0.2, part[back] / 2, 0)  # a half, a quarter, an eighth, none
        moved[back] = before[back] + part[back] * (after[back] - before[back])
        # Only triangles at these vertices have changed.
        changed = np.zeros(len(before), bool)
        changed[back] = True
        doubtful = np.flatnonzero(touched(triangles, changed))
        worse = doubtful[smallest_tangents(moved, triangles[doubtful]) < least[doubtful]]
    return moved
