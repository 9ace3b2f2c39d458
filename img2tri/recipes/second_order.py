"""Straight triangles -> quadratic ones (T6), with curved sides along the outlines: three corners, and a node on each side.

Sides along curved outlines bend with them: their vertices are put on the outline, and the nodes of their sides where the outline passes
the normal of the chord. Vertices that were moved off the outline, so that straight sides keep its area, have to come back for that: else a
side through the outline's middle would enclose too much.

Curved sides that follow every bump of an outline are worse than straight ones: a computation takes each kink for a notch. The outline is
smooth enough for them (see `img2tri.shapes.place`). A second smoothing costs accuracy at small holes and gains nothing elsewhere.

Whether an element is turned over somewhere is decided by the Bezier coefficients of its Jacobian, whose least is a lower bound
(A. Johnen, J.-F. Remacle and C. Geuzaine, Geometrical validity of curvilinear finite elements, J. Comput. Phys. 233, 2013,
https://doi.org/10.1016/j.jcp.2012.08.051).

Measured on a disc of radius 150 px (Poisson's equation, error of the energy in %, mask / gray image, at edge lengths of 40, 20 and 10 px):
0.023 / 0.004 at all three, which is the error of the outline itself; with straight sides that keep the area 0.038, 0.023, 0.016 from the
mask. The greatest stress at a hole of radius 60 px, edge length 4 px, averaged at vertices: within 0.8 % / 0.7 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, cross, unique_edges
from img2tri.errors import bounded
from img2tri.types import Frame, Outlines, Provenance

SEARCH = 1.0  # px over the tolerance: how far from a side its outline is looked for
LEAST_JACOBIAN = 0.1  # of that of the straight triangle: what a curved one has at least
HALVINGS = 4  # how often a node is pulled back half-way before it is put back altogether


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """A mesh of quadratic triangles.

    Attributes
    ----------
    nodes
        (n + e, 2) float64, world units: the n vertices, then one node for each of the e edges, edges ordered by their lower and then their
        higher vertex. Vertices lie on the outlines, which is not where the straight mesh has them if it keeps areas.
    triangles
        (m, 6) int64, counter-clockwise: corners, then the nodes between 0 and 1, 1 and 2, 2 and 0, as VTK and Gmsh have them.
    regions
        (m,) int64, labels.
    """

    nodes: Floats
    triangles: Ints
    regions: Ints

    def __repr__(self) -> str:
        (x0, y0), (x1, y1) = self.nodes.min(axis=0), self.nodes.max(axis=0)
        regions = len(np.unique(self.regions))
        counts = f"{len(self.triangles)} quadratic triangles, {len(self.nodes)} nodes, {regions} region{'s' * (regions != 1)}"
        return f"SecondOrder: {counts}, {x0:g} <= x <= {x1:g}, {y0:g} <= y <= {y1:g}"


def second_order(vertices: Floats, triangles: Ints, regions: Ints, frame: Frame, origin: Provenance | None = None) -> SecondOrder:
    """Give a mesh nodes in the middle of its edges, and curved sides along its outlines.

    Guarantees: the Jacobian of every element is positive everywhere, at least `LEAST_JACOBIAN` times that of the straight triangle.
    Where a curved side would spoil that, it is pulled back towards its chord. Sides inside of regions and on the frame of the image are
    straight, with their node in the middle.

    Parameters
    ----------
    vertices, triangles, regions
        (n, 2) float64 in world units; (m, 3) int64, counter-clockwise; (m,) int64, labels.
    frame
        Where the image lies.
    origin
        How the mesh was made: sides follow its outlines, unless they are farther away than its tolerance and `SEARCH`. Without an origin,
        or if its recipe promises no tolerance, all sides are straight.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> made = second_order(square, np.array([[0, 1, 2], [0, 2, 3]]), np.array([1, 1]), Frame((2, 2)))
    >>> made.triangles.tolist(), made.nodes[6].tolist()
    ([[0, 1, 2, 4, 7, 5], [0, 2, 3, 5, 8, 6]], [0.0, 1.0])
    """
    edges, edge_of = unique_edges(triangles)
    elements = np.concatenate([triangles, len(vertices) + edge_of], axis=1)
    middles = (vertices[edges[:, 0]] + vertices[edges[:, 1]]) / 2
    straight = np.concatenate([vertices, middles])
    if origin is None or origin.tolerance is None:
        return SecondOrder(straight, elements, regions)
    flat = (vertices - frame.corner) / frame.pixel
    z = flat[:, 0] + 1j * flat[:, 1]
    sides = _curved_sides(vertices, triangles, regions, frame, origin.outlines, edges, edge_of.ravel())
    curved = _bent(z, edges, elements, sides, _DenseOutlines(origin.outlines, origin.tolerance + SEARCH))
    nodes = frame.world(np.stack([curved.real, curved.imag], axis=1))
    # What did not move is where it was to the last bit.
    kept = curved == np.concatenate([z, (z[edges[:, 0]] + z[edges[:, 1]]) / 2])
    return SecondOrder(np.where(kept[:, None], straight, nodes), elements, regions)


@dataclass(frozen=True, eq=False)
class _Sides:
    """The edges of a mesh that may be curved: their rows, their ends and the region numbers beside them, the lower one on the left."""

    edge: Ints
    start: Ints
    stop: Ints
    left: Ints
    right: Ints

    def through(self, n: int, still: Bools) -> tuple[Ints, Ints, Ints]:
        """Vertices that a single outline passes, none of those that stay still; and the side that arrives and the one that departs."""
        arrives, departs = np.full(n, -1), np.full(n, -1)
        arrives[self.stop], departs[self.start] = np.arange(len(self.edge)), np.arange(len(self.edge))
        once = (np.bincount(self.stop, minlength=n) == 1) & (np.bincount(self.start, minlength=n) == 1) & ~still
        at = np.flatnonzero(once)
        one, other = arrives[at], departs[at]
        same = (self.left[one] == self.left[other]) & (self.right[one] == self.right[other])
        return at[same], one[same], other[same]


def _curved_sides(
    vertices: Floats, triangles: Ints, regions: Ints, frame: Frame, outlines: Outlines, edges: Ints, edge_of: Ints
) -> tuple[_Sides, Bools]:
    """Find the edges along outlines, and the vertices (n,) on the frame, which stay where they are."""
    known = outlines.labels[1:]
    at = np.minimum(np.searchsorted(known, regions), len(known) - 1)
    number = np.repeat(np.where(known[at] == regions, at + 1, -1), 3)
    forwards = (triangles < np.roll(triangles, -1, axis=1)).ravel()
    left, right = np.zeros(len(edges), np.int64), np.zeros(len(edges), np.int64)
    left[edge_of[forwards]], right[edge_of[~forwards]] = number[forwards], number[~forwards]

    x0, y0, x1, y1 = frame.bounds
    near = 1e-9 * frame.diagonal
    walls = np.abs(vertices[:, [0, 1, 0, 1]] - [x0, y0, x1, y1]) < near
    on_frame = (walls[edges[:, 0]] & walls[edges[:, 1]]).any(axis=1)
    edge = np.flatnonzero((left != right) & ~on_frame)
    turned = (left > right)[edge]
    start, stop = edges[edge].T
    start, stop = np.where(turned, stop, start), np.where(turned, start, stop)
    low, high = np.minimum(left, right)[edge], np.maximum(left, right)[edge]
    return _Sides(edge, start, stop, low, high), np.asarray(walls.any(axis=1))


def _bent(z: Points, edges: Ints, elements: Ints, found: tuple[_Sides, Bools], curves: _DenseOutlines) -> Points:
    """Place all nodes: vertices and sides on the curves, as far as the Jacobian stays positive."""
    sides, still = found
    n = len(z)
    straight = np.concatenate([z, (z[edges[:, 0]] + z[edges[:, 1]]) / 2])
    at, one, other = sides.through(n, still)
    shift = np.zeros(n, np.complex128)
    heading = z[sides.stop[other]] - z[sides.start[one]]
    shift[at] = curves.offsets(z[at], heading, sides.left[one], sides.right[one])
    least = LEAST_JACOBIAN * np.maximum(_least_jacobian(straight, elements), 0)
    share = np.ones(len(straight))
    # After some halvings each round puts back at least one node for good.
    for halvings in bounded("curved sides", HALVINGS + len(straight) + 1):
        moved = z + share[:n] * shift
        nodes = np.concatenate([moved, (moved[edges[:, 0]] + moved[edges[:, 1]]) / 2])
        node = n + sides.edge
        chord = moved[sides.stop] - moved[sides.start]
        nodes[node] += share[node] * curves.offsets(nodes[node], chord, sides.left, sides.right)
        spoiled = elements[_least_jacobian(nodes, elements) < least]
        if not share[spoiled].any():
            break
        share[np.unique(spoiled)] *= 0.5 if halvings < HALVINGS else 0.0
    return nodes


def _least_jacobian(nodes: Points, elements: Ints) -> Floats:
    """Lower bound (m,) of the Jacobian determinant of quadratic triangles; exact for straight ones.

    The determinant is quadratic too. It nowhere falls below the least of its six Bezier coefficients.
    """
    p0, p1, p2, m01, m12, m20 = nodes[elements].T
    # Control points of the sides; the derivatives along 0-1 and 0-2 are linear, with these values in the corners.
    c01, c12, c20 = 2 * m01 - (p0 + p1) / 2, 2 * m12 - (p1 + p2) / 2, 2 * m20 - (p2 + p0) / 2
    u = 2 * np.stack([c01 - p0, p1 - c01, c12 - c20])
    v = 2 * np.stack([c20 - p0, c12 - c01, p2 - c20])
    corners = cross(u, v)
    between = (cross(u, np.roll(v, -1, axis=0)) + cross(np.roll(u, -1, axis=0), v)) / 2
    return np.asarray(np.minimum(corners.min(axis=0), between.min(axis=0)))


class _DenseOutlines:
    """Smoothed outlines, and how far off them places are."""

    def __init__(self, outlines: Outlines, reach: float) -> None:
        from scipy.spatial import cKDTree

        self._z = as_complex(outlines.points)[outlines.chains.indices]
        self._chain = outlines.chains.chain
        self._inner = np.append(self._chain[1:] == self._chain[:-1], False)
        self._left, self._right, self._reach = outlines.left, outlines.right, reach
        step = np.abs(np.diff(self._z))[self._inner[:-1]].max(initial=0.0)
        self._radius = reach + step
        self._tree = cKDTree(np.stack([self._z.real, self._z.imag], axis=1))

    def offsets(self, places: Points, headings: Points, left: Ints, right: Ints) -> Points:
        """How far (k,) it is from places, at a right angle to a heading, to the nearest outline that parts two regions and heads that way.

        0 where none is within reach.
        """
        result = np.zeros(len(places), np.complex128)
        if not len(places):
            return result
        lists = self._tree.query_ball_point(np.stack([places.real, places.imag], axis=1), self._radius)
        of = np.repeat(np.arange(len(places)), [len(found) for found in lists])
        entry = np.concatenate([np.asarray(found, np.int64) for found in lists])
        # Each point found stands for the segment after it and the one before.
        of, entry = np.concatenate([of, of]), np.concatenate([entry, entry - 1])
        chain = self._chain[entry]
        fits = (entry >= 0) & self._inner[entry] & (self._left[chain] == left[of]) & (self._right[chain] == right[of])
        of, entry = of[fits], entry[fits]
        ahead = (headings / np.maximum(np.abs(headings), 1e-12))[of]
        a, b = ((self._z[entry + k] - places[of]) * ahead.conj() for k in (0, 1))
        passes = (a.real <= 0) & (b.real > 0)
        of, a, b, ahead = of[passes], a[passes], b[passes], ahead[passes]
        height = a.imag - a.real * (b.imag - a.imag) / (b.real - a.real)
        order = np.lexsort((np.abs(height), of))
        nearest = order[np.flatnonzero(np.diff(of[order], prepend=-1))]
        nearest = nearest[np.abs(height[nearest]) < self._reach]
        result[of[nearest]] = 1j * (height * ahead)[nearest]
        return result
