"""Quality-weighted smoothing: vertices move so that triangles become as equilateral as they can.

In: vertices, triangles, which vertices may move. Out: vertices. The shape of a triangle (a, b, c), counter-clockwise, is told by two
complex numbers, with w = exp(2 pi i / 3):

    X = a + w b + w^2 c        0 if and only if the triangle is equilateral: its *defect*
    Y = a + w^2 b + w c        its size and direction

They say all: the squares of the edges sum to |X|^2 + |Y|^2, the area is (|Y|^2 - |X|^2) / (4 sqrt 3), and the quality
4 sqrt(3) area / (sum of squares) = (|Y|^2 - |X|^2) / (|Y|^2 + |X|^2) is 1 for equilateral triangles, 0 for flat ones. To make its triangle
equilateral, corner a alone would have to move by -X, corner b by -w^2 X, corner c by -w X.

`smooth` moves every vertex by the mean of what its triangles ask, weighted by quality^-power: Jacobi steps down the energy
sum of weight |X|^2, whose matrix is C diag(weight) C* with a row of C for each vertex and a column for each triangle. With power 2 that
is a quick smoother. With large powers only the worst triangle of each vertex counts: `raise_worst_angles` does by these what hill
climbing for the smallest angle does (L. Freitag and C. Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing, Int. J.
Numer. Methods Eng. 40, 1997, https://doi.org/10.1002/(SICI)1097-0207(19971115)40:21<3979::AID-NME251>3.0.CO;2-9), in a few array
operations for all vertices.

Triangles that ask for a better shape of their own are the idea of GETMe smoothing (D. Vartziotis, T. Athanasiadis, I. Goudas and J. Wipper,
Mesh smoothing using the geometric element transformation method, Comput. Methods Appl. Mech. Eng. 197, 2008); the weights make it a
descent. Laplacian, centroidal (CVT) and optimal-Delaunay (ODT) smoothing were tried in its place: worst angles of 41, 40 and 37 degrees
where this reaches 41 to 44.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, blocks
from img2tri.errors import bounded
from img2tri.triangles.generate.vertex_sums import VertexSums
from img2tri.triangles.min_angle_tangents import min_angle_tangents

TURN = np.exp(2j * np.pi / 3)
DEFECT = np.array([1, TURN, TURN**2])
SAFE = 30.0  # degrees: no angle is made smaller than this
FLATTEST = 0.05  # qualities below this weigh as much as this: a flat triangle would weigh infinitely much

Schedule = Sequence[tuple[int, float, int]]
"""Rows of (doublings, damping, steps): the power of the weights is 2 to the number of doublings."""
SMOOTH: Schedule = ((1, 1.0, 5),)
WORST_FIRST: Schedule = ((5, 0.3, 4), (6, 0.2, 4), (7, 0.1, 7))
TARGET = 44.0  # degrees: angles above this are not worth optimising
NEAR_WORST = 4.0  # degrees: angles within this of the worst are optimised with it; 2 to 8 serve
WORST_PASSES = 2  # one after the other, as the worst place may then be another
WORST_RINGS = 3  # rings of triangles around the worst that may change
POOR = 36.0  # degrees: for angles below this vertices on outlines slide once more
SLIDING: Schedule = ((4, 0.5, 4), *WORST_FIRST)  # outlines have farther to go
POOR_RINGS = 2  # rings of triangles around these that may change


@dataclass(frozen=True, eq=False)
class SlideLines:
    """Vertices on outlines that may slide along straight lines.

    Attributes
    ----------
    at
        (k,) int64, which.
    along
        (k,) complex, the unit directions of their lines.
    start
        (k,) complex, where they stand before they slide.
    limits
        (k,) float64, how far from there they may go either way.
    """

    at: Ints
    along: Points
    start: Points
    limits: Floats

    def among(self, chosen: Bools) -> SlideLines:
        """Return those of chosen vertices (n,) alone."""
        which = chosen[self.at]
        return SlideLines(self.at[which], self.along[which], self.start[which], self.limits[which])


def defects_and_qualities(vertices: Points, triangles: Ints) -> tuple[Points, Floats]:
    """Return defect X and quality of triangles; the quality is at most 1, and negative for clockwise triangles."""
    return _defects_and_qualities(vertices, _columns(triangles))


def _columns(triangles: Ints) -> Ints:
    """First, second, third corners (3, m), each side by side in memory."""
    return np.ascontiguousarray(triangles.T)


def _defects_and_qualities(vertices: Points, corners: Ints) -> tuple[Points, Floats]:
    a, b, c = (vertices[corner] for corner in corners)
    # X, Y = median +- side, where the side is turned by 90 degrees and made as long as the median should be.
    median, side = a - (b + c) / 2, (b - c) * (0.75**0.5 * 1j)
    cross = median.real * side.real + median.imag * side.imag
    squares = median.real**2 + median.imag**2 + side.real**2 + side.imag**2
    return median + side, -2 * cross / squares


def smooth(vertices: Points, triangles: Ints, free: Bools, schedule: Schedule = SMOOTH, lines: SlideLines | None = None) -> Points:
    """Move the free vertices (bool) by damped steps, others along their lines.

    The worst angle does not fall, nor does any one fall below 30 degrees.
    """
    return _Smoother(triangles, free).smoothed(vertices, None, schedule, lines)[0]


def raise_worst_angles(vertices: Points, triangles: Ints, free: Bools, target: float = TARGET) -> Points:
    """Smooth with large powers, but only around the worst angles, and as long as these are less than `target` degrees."""
    return _raised(vertices, min_angle_tangents(vertices, triangles), triangles, free, target)[0]


def smooth_and_raise(vertices: Points, triangles: Ints, free: Bools, tangents: Floats | None = None) -> Points:
    """Smooth, raise the worst angle, and smooth once more. The smallest tangents (m,) may be known.

    Only the worst angle is worth large powers: what else they spoil is mended by the last smoothing, in which that angle stays.
    """
    smoother = _Smoother(triangles, free)
    return smoother.smoothed(*_raised(*smoother.smoothed(vertices, tangents), triangles, free))[0]


def raise_sliding(
    vertices: Points, triangles: Ints, free: Bools, lines: SlideLines, settle: Callable[[Points], Points], target: float = POOR
) -> Points:
    """Raise the worst angles by smoothing with large powers in which vertices on outlines slide too, around all angles below `target`.

    What the vertices then are, those on outlines where they may be, is told by `settle`. Where the worst angle fell by that, or more
    triangles have an angle below the target, the vertices go back that moved and hang together there through triangles.
    """
    tangents = min_angle_tangents(vertices, triangles)
    least = math.tan(math.radians(target))
    poor = tangents < least
    if not poor.any():
        return vertices
    patch, inner = patch_around(poor, triangles, len(vertices), POOR_RINGS)
    smoother = _Smoother(triangles[patch], free & inner)
    moved = settle(smoother.smoothed(vertices, tangents[patch], SLIDING, lines.among(inner))[0])
    moved, found = _raised(moved, min_angle_tangents(moved, triangles), triangles, free, target)
    moved, _ = smoother.smoothed(moved, found[patch], safe=target)
    # What is settled may reach farther than the patch.
    changed = touching(triangles, moved != vertices)
    before, near = tangents[changed], triangles[changed]
    after, part = min_angle_tangents(moved, near), _parts(near, moved != vertices)
    more = np.bincount(part, (after < least).astype(np.float64) - (before < least), len(near)) > 0
    fell = _least_in(part, after) < _least_in(part, before) - 1e-12
    back = np.zeros(len(vertices), bool)
    back[near[(more | fell)[part]]] = True
    return np.where(back, vertices, moved)


def _least_in(part: Ints, values: Floats) -> Floats:
    """Return the least of the values (m,) in each part, these numbered from 0 to m at most."""
    least = np.full(len(values), np.inf)
    np.minimum.at(least, part, values)
    return least


def _parts(triangles: Ints, joining: Bools) -> Ints:
    """Return the part each triangle (m,) is of, those that hang together through joining vertices: the first triangle of the part."""
    part = np.arange(len(triangles))
    for _ in bounded("parts of a mesh", len(triangles) + 1):
        lowest = np.full(len(joining), len(triangles))
        np.minimum.at(lowest, triangles, part[:, None])
        lowest[~joining] = len(triangles)
        found = np.minimum(part, lowest[triangles].min(axis=1))
        lower = found.copy()
        np.minimum.at(lower, part, found)  # the first triangle learns what any of its part has found, and tells the others
        lower = lower[lower]
        if np.array_equal(lower, part):
            break
        part = lower
    return part


class _Smoother:
    """What smoothing has to know of triangles and of the vertices that may move."""

    def __init__(self, triangles: Ints, free: Bools) -> None:
        n = len(free)
        self._triangles, self._corners = triangles, _columns(triangles)
        self._moves, self._weights = VertexSums(triangles, n, -DEFECT.conj()), VertexSums(triangles, n, np.ones(3))
        used = np.zeros(n, bool)
        used[triangles] = True
        self._where = (free & used).nonzero()[0]

    def smoothed(
        self,
        vertices: Points,
        tangents: Floats | None = None,
        schedule: Schedule = SMOOTH,
        lines: SlideLines | None = None,
        safe: float = SAFE,
    ) -> tuple[Points, Floats]:
        """Return the vertices moved by damped steps, and their smallest tangents (m,); those of before may be known.

        No angle falls below the worst of before, nor below `safe` degrees.
        """
        m, where = len(self._triangles), self._where
        moved, weights, weighted = vertices.copy(), np.empty(m), np.empty(m, np.complex128)
        for doublings, damping, steps in schedule:
            for _ in range(steps):
                for block in blocks(m):
                    defect, quality = _defects_and_qualities(moved, self._corners[:, block])
                    weight = 1 / np.maximum(quality, FLATTEST)
                    for _ in range(doublings):
                        weight *= weight
                    weights[block] = weight
                    np.multiply(weight, defect, out=weighted[block])
                moves, total = self._moves.of(weighted), self._weights.of(weights)
                moved[where] += damping * moves[where] / total[where]
                if lines is not None:
                    step = damping * moves[lines.at] / total[lines.at]
                    way = ((moved[lines.at] + step - lines.start) * lines.along.conj()).real
                    moved[lines.at] = lines.start + np.minimum(np.maximum(way, -lines.limits), lines.limits) * lines.along
        known = min_angle_tangents(vertices, self._triangles) if tangents is None else tangents
        return _shortened(vertices, moved, self._triangles, known, safe)


def _raised(vertices: Points, tangents: Floats, triangles: Ints, free: Bools, target: float = TARGET) -> tuple[Points, Floats]:
    """Raise the worst angles, see `raise_worst_angles`; take and return the smallest tangents (m,) too."""
    for _ in range(WORST_PASSES):
        angles = np.degrees(np.arctan(tangents))
        worst = angles < min(target, angles.min(initial=target) + NEAR_WORST)
        if not worst.any():
            break
        patch, inner = patch_around(worst, triangles, len(vertices), WORST_RINGS)
        vertices, changed = _Smoother(triangles[patch], free & inner).smoothed(vertices, tangents[patch], WORST_FIRST)
        tangents = tangents.copy()
        tangents[patch] = changed
    return vertices, tangents


def patch_around(chosen: Bools, triangles: Ints, n: int, rings: int) -> tuple[Bools, Bools]:
    """Add triangles that share a vertex with those chosen, and so on; also tell the vertices (n,) that have all of theirs in the patch."""
    inner = np.zeros(n, bool)
    for _ in range(rings):
        inner[triangles[chosen]] = True
        wider = touching(triangles, inner)
        if np.array_equal(wider, chosen):
            break
        chosen = wider
    return chosen, inner


def touching(triangles: Ints, marked: Bools) -> Bools:
    """Tell which triangles have a marked vertex."""
    a, b, c = (marked[corner] for corner in triangles.T)
    either: Bools = a | b | c
    return either


def _shortened(before: Points, after: Points, triangles: Ints, tangents: Floats, safe: float) -> tuple[Points, Floats]:
    """Shorten the moves of vertices of triangles that became bad: whose angle fell below `safe` degrees or below the worst before.

    The smallest tangents (m,) are those before; those after are returned with the vertices.
    """
    least = np.minimum(tangents, max(math.tan(math.radians(safe)), tangents.min(initial=np.inf))) - 1e-12
    moved, part, found = after.copy(), np.ones(len(before)), min_angle_tangents(after, triangles)
    worse = (found < least).nonzero()[0]
    # Each round shortens a move, and each move is shortened four times at most.
    for _ in bounded("smoothing", 4 * len(before) + 2):
        if not len(worse):
            break
        changed = np.zeros(len(before), bool)
        changed[triangles[worse]] = True
        back = (changed & (part > 0)).nonzero()[0]
        part[back] = np.where(part[back] > 0.2, part[back] / 2, 0)  # a half, a quarter, an eighth, none
        moved[back] = before[back] + part[back] * (after[back] - before[back])
        # Only triangles at these vertices have changed.
        doubtful = touching(triangles, changed).nonzero()[0]
        found[doubtful] = min_angle_tangents(moved, triangles[doubtful])
        worse = doubtful[found[doubtful] < least[doubtful]]
    return moved, found
