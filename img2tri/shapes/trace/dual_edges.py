"""Chains of crack edges, laid out in the plane: between which bounds the points of an outline may lie.

Across each crack edge inside the image runs its *dual edge*, from the pixel centre on the right to the one on the left. The outline
has one *crossing* on each, as in marching squares, free to slide along it as in constrained surface nets (Gibson, "Constrained
elastic surface nets", 1998, DOI 10.1007/BFb0056277)::

        o   |   o        o  pixel centres
         - -x- -         x  crossing: on the dual edge from centre to centre, across the crack edge |
        o   |   o

Wherever it is put strictly between the centres, the outline keeps every pixel centre on its own side, runs through one block of
four centres after the other, never meets itself, and so has the topology of the label map. A node is free within its block.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Ints, Points, as_complex, as_rows, cross
from img2tri.shapes.trace.chains import trace_chains
from img2tri.shapes.trace.crack_edges import CrackEdges
from img2tri.types import Frame, Outlines

BOUND = 0.49  # of the dual edge from its middle, to either side: no crossing comes nearer to a pixel centre
MOST_SHIFT = 0.25  # of the dual edge: how far a fair middle is from the middle
LEAST_WIDTH = 0.1  # px: where a shift sweeps less than this, there is nothing to give back by it
FAIR_ROUNDS = 16  # of sharing shifts among the corners beside them; a few settle
BLUNT = np.cos(np.radians(81.0))  # the cosine of the least angle that outlines through fair middles may have
BLUNT_ROUNDS, SMALLER = 40, 0.9  # of making shifts smaller where angles are less than that, and by how much each time


@dataclass(frozen=True, eq=False)
class DualEdges:
    """Between which bounds the points of an outline may lie: crossings on their dual edges, nodes in their blocks.

    Points are numbered crossings first, in the order of the chains, then nodes. Lengths are in px.

    Attributes
    ----------
    crack_edges
        What was laid out.
    crossed
        (k,) int64, the crack edge of each crossing.
    chains
        The points of each chain in order, as in `Outlines`.
    middle
        (n,) the middle of each crack edge, and the corner of pixels at each node.
    vector
        (n,) the dual edge of each crossing, from the pixel centre on the right to the one on the left; 0 for points without, see `slides`.
    corner_after
        (k,) the corner of pixels at which the crack edge of each crossing ends.
    node_corner
        (n - k,) int64, the number of the corner of pixels each node is at.
    bounds
        (n,) how far a node may move from the middle, to the right plus i times up; 0 for crossings and on the frame.
    pixel
        Width plus i times height of a pixel.
    swept_areas
        (c,) the area the crack edges of each chain sweep as seen from the origin.
    """

    crack_edges: CrackEdges
    crossed: Ints
    chains: ChainIndex
    middle: Points
    vector: Points
    corner_after: Points
    node_corner: Ints
    bounds: Points
    pixel: complex
    swept_areas: Floats

    @property
    def slides(self) -> Bools:
        """(n,) bool, the crossings that may slide along a dual edge; nodes, and crossings on the frame, have none."""
        return np.asarray(self.vector != 0)

    @cached_property
    def beside_touching(self) -> tuple[Ints, Ints]:
        """The crossings (t,) before and after each corner of pixels at which two outlines pass, once for each of the two."""
        at, k, tails = self.chains.indices, len(self.crossed), np.sort(self.crack_edges.tail)
        if not (tails[1:] == tails[:-1]).any():
            return np.zeros(0, np.int64), np.zeros(0, np.int64)
        passes = np.searchsorted(tails, self.crack_edges.head[self.crossed][:, None] + [0, 1])
        twice = np.append(np.diff(passes, axis=1)[:, 0] == 2, np.zeros(len(self.middle) - k, bool))
        # Of the points of one crack edge the last one is beside the corner.
        edge = np.append(self.crossed, np.full(len(self.middle) - k, -1))[at]
        here = (twice[at[:-1]] & (at[1:] < k) & (np.diff(self.chains.chain) == 0) & (np.diff(edge) != 0)).nonzero()[0]
        return at[here], at[here + 1]

    @cached_property
    def fair_middle(self) -> Points:
        """(n,) the middles, shifted where pixels of one region touch in a corner, so that each keeps its share of that corner.

        Through the middles, the two outlines that pass there cut an eighth of a pixel off each of two pixels, and the region they part
        is the larger for it. The crossings around are shifted to give that back::

            a | b           a | b
            --x       ->    --+-x        b keeps a quarter of the block between the four centres,
            b x a           b | a        and the outline around the other b likewise
                              x
        """
        at, z, (one, other) = self.chains.indices, self.middle, self.beside_touching
        if not len(one):
            return z
        corner = self.corner_after[one]
        cut = cross(corner - z[one], z[other] - corner) / 2
        # Each outline gets back what it cuts off at a corner, by the same shift of the crossings before and after it; a
        # crossing between two such corners takes the mean of both.
        moved = np.unique(np.concatenate([one, other]))
        first, second = np.searchsorted(moved, one), np.searchsorted(moved, other)
        pair = np.concatenate([first, second])
        corners = np.bincount(pair, minlength=len(moved))
        shift, (begin, end) = np.zeros(len(z)), self.chains.ring_ends
        entry = np.zeros(len(z), np.int64)
        entry[at] = np.arange(len(at))
        entry[at[end]] = begin
        behind, ahead = at[entry[moved] - 1], at[entry[moved] + 1]
        goes_round = np.isin(entry[moved], begin)
        behind[goes_round] = at[end[np.searchsorted(begin, entry[moved[goes_round]])] - 1]
        for _ in range(FAIR_ROUNDS):
            # A shift t sweeps t * vector x (ahead - behind) / 2, with the neighbours half-way on theirs.
            there, back = (z[i] + shift[i] / 2 * self.vector[i] for i in (ahead, behind))
            width = cross(self.vector[moved], (there - back) / 2) / corners
            swept = width[first] + width[second]
            step = np.divide(cut, swept, out=np.zeros(len(one)), where=np.abs(swept) > LEAST_WIDTH)
            shift[moved] = (np.bincount(pair, np.tile(step, 2), len(moved)) / corners).clip(-MOST_SHIFT, MOST_SHIFT)
        return np.asarray(z + shift * self.vector)

    @cached_property
    def blunt_middle(self) -> Points:
        """(n,) the fair middles, nearer to the middles where outlines through them would turn much more sharply than by right angles."""
        z = self.fair_middle
        if z is self.middle:
            return z
        heads = self.chains.heads
        ends = self.chains.indices[np.stack([heads, heads + 1])]
        near = np.zeros(len(z), bool)
        near[ends[:, (z[ends] != self.middle[ends]).any(axis=0)]] = True
        ends = ends[:, near[ends].any(axis=0)]
        point, other = np.concatenate([ends, ends[::-1]], axis=1)
        order = np.argsort(point, kind="stable")
        point, other = point[order], other[order]
        for _ in range(BLUNT_ROUNDS):
            heading = z[other] - z[point]
            sharp = np.zeros(len(z), bool)
            for step in (1, 2, 3):  # at most four segments meet
                one = (point[step:] == point[:-step]).nonzero()[0]
                a, b = heading[one], heading[one + step]
                narrow = one[(a * b.conj()).real > BLUNT * np.abs(a) * np.abs(b)]
                sharp[point[narrow]] = sharp[other[narrow]] = sharp[other[narrow + step]] = True
            if not sharp.any():
                break
            z = np.where(sharp, self.middle + SMALLER * (z - self.middle), z)
        return z

    @cached_property
    def _meeting(self) -> Ints:
        """(n,) how many chains end at each point."""
        ends = np.concatenate([end[~self.chains.rings] for end in self.chains.ends])
        return np.asarray(np.bincount(ends, minlength=len(self.middle)))

    @property
    def is_corner(self) -> Bools:
        """(n,) bool, the nodes at which just two chains end: corners, no junctions."""
        return np.asarray(self._meeting == 2)

    @cached_property
    def is_junction(self) -> Bools:
        """(n,) bool, the nodes inside the image at which more than two chains end."""
        return np.asarray((self._meeting > 2) & (self.bounds != 0))

    @property
    def regions(self) -> tuple[Ints, Ints]:
        """(c,) the region numbers on the left and right of each chain."""
        crossing = self.chains.indices[self.chains.first + ~self.chains.rings]
        edge = self.crossed[np.minimum(crossing, len(self.crossed) - 1)]
        return self.crack_edges.left[edge], self.crack_edges.right[edge]

    def outlines(self, points: Points) -> Outlines:
        """Return the outlines through given places of the points."""
        return Outlines(as_rows(points), self.chains, *self.regions, self.crack_edges.labels)


def lay_out(crack_edges: CrackEdges, frame: Frame) -> DualEdges:
    """Trace the chains of crack edges and lay them out in the plane of the frame."""
    h, w = crack_edges.shape
    traced = trace_chains(crack_edges)

    def corner(numbers: Ints) -> Points:
        return as_complex(frame.plane(*np.divmod(numbers, w + 1)))

    tail, head = crack_edges.tail[traced.order], crack_edges.head[traced.order]
    is_open = (~traced.closed).nonzero()[0]
    first, last = traced.starts[is_open], traced.starts[is_open + 1] - 1
    nodes = np.unique(np.concatenate([tail[first], head[last]]))
    n = len(tail)

    # Each chain is its crossings, between its two nodes or closed by its first crossing:
    #     node 10 11 12 node   20 21 22 23 20
    starts = np.concatenate([[0], np.cumsum(np.diff(traced.starts) + np.where(traced.closed, 1, 2))])
    indices = np.empty(starts[-1], np.int64)
    offset = starts[:-1] + ~traced.closed - traced.starts[:-1]
    indices[np.arange(n) + offset[traced.sequence]] = np.arange(n)
    indices[starts[is_open]] = n + np.searchsorted(nodes, tail[first])
    indices[starts[is_open + 1] - 1] = n + np.searchsorted(nodes, head[last])
    indices[starts[1:][traced.closed] - 1] = traced.starts[:-1][traced.closed]

    a, b = corner(tail), corner(head)
    width, height = np.abs(np.diff(frame.plane([0, 1], [0, 1]), axis=0)[0])
    vector = _across(b - a, complex(width, height))
    vector[crack_edges.on_frame[traced.order]] = 0
    r, c = np.divmod(nodes, w + 1)
    inside = (r > 0) & (r < h) & (c > 0) & (c < w)
    return DualEdges(
        crack_edges,
        traced.order,
        ChainIndex(indices, starts, traced.closed),
        middle=np.concatenate([(a + b) / 2, corner(nodes)]),
        vector=np.concatenate([vector, np.zeros(len(nodes))]),
        corner_after=b,
        node_corner=nodes,
        bounds=np.concatenate([np.zeros(n), np.where(inside, BOUND * (width + 1j * height), 0)]),
        pixel=complex(width, height),
        swept_areas=np.asarray(np.bincount(traced.sequence, cross(a, b) / 2, len(traced.closed)), np.float64),
    )


def _across(along: Points, pixel: complex) -> Points:
    """Return the dual edges of crack edges: a quarter turn to the left; across a vertical one lies the width of a pixel."""
    return np.asarray(1j * (np.sign(along.real) * pixel.imag + 1j * np.sign(along.imag) * pixel.real))


def pixels_beside(dual_edges: DualEdges) -> tuple[Floats, Ints]:
    """Return the centres (k, 2) of the pixels on both sides of each crack edge inside the image, and their region numbers (k,)."""
    inner = (~dual_edges.crack_edges.on_frame[dual_edges.crossed]).nonzero()[0]  # also where no crossing may slide
    middle, edge = dual_edges.middle[inner], dual_edges.crossed[inner]
    half = _across(dual_edges.corner_after[inner] - middle, dual_edges.pixel) / 2
    regions = np.concatenate([dual_edges.crack_edges.left[edge], dual_edges.crack_edges.right[edge]])
    return as_rows(np.concatenate([middle + half, middle - half])), regions


def pixel_areas(dual_edges: DualEdges) -> Floats:
    """Return the area (r,) of the pixels of each region number; entry 0 means nothing."""
    left, right = dual_edges.regions
    size = len(dual_edges.crack_edges.labels)
    return np.asarray(np.bincount(left, dual_edges.swept_areas, size) - np.bincount(right, dual_edges.swept_areas, size))
