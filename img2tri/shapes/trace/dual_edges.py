"""Chains of cracks, laid out in the plane: what the places of an outline's points may be.

On each crack the outline has one *crossing*, free to slide on the link between the two pixel centres beside it. Wherever it
is put strictly between them, the outline keeps every pixel centre on its own side, runs through one block of four centres
after the other, never meets itself, and so has the topology of the label map. Nodes are free within their block.

Points of the plane are complex numbers here, x + iy, in units of a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from img2tri.shapes.place.padded_chains import Points, cross
from img2tri.shapes.trace.chains import trace
from img2tri.shapes.trace.crack_edges import NODE, Cracks
from img2tri.types import Bools, Floats, Frame, Ints, Outlines

REACH = 0.49  # of the link from its middle, to either side: no crossing comes nearer to a pixel centre


@dataclass(frozen=True, eq=False)
class Links:
    """What the places of an outline's points may be.

    Points are numbered crossings first, in the order of the chains, then nodes.

    Attributes
    ----------
    cracks
        What was laid out.
    crack
        (k,) int64, the crack of each crossing.
    indices, starts
        The points of each chain in order, as in `Outlines`.
    rings
        (c,) bool, chains without nodes.
    middle
        (n,) the middle of each crack, and the corner of pixels at each node.
    axis
        (n,) the link from the pixel centre on the right to the one on the left; 0 for nodes and on the frame.
    head
        (k,) the corner of pixels at which the crack of each crossing ends.
    node
        (n - k,) int64, the corner of pixels each node is at.
    room
        (n,) how far a node may move from the middle, to the right plus i times up; 0 for crossings and on the frame.
    pixel
        Width plus i times height of a pixel.
    swept
        (c,) the area the cracks of each chain sweep as seen from the origin.
    """

    cracks: Cracks
    crack: Ints
    indices: Ints
    starts: Ints
    rings: Bools
    middle: Points
    axis: Points
    head: Points
    node: Ints
    room: Points
    pixel: complex
    swept: Floats

    @cached_property
    def chain(self) -> Ints:
        """(k,) the chain of each entry of `indices`."""
        return np.repeat(np.arange(len(self.rings)), np.diff(self.starts))

    @property
    def corner(self) -> Bools:
        """(n,) bool, the nodes at which just two chains end: corners, no junctions."""
        ends = np.concatenate([end[~self.rings] for end in self.ends])
        return np.asarray(np.bincount(ends, minlength=len(self.middle)) == 2)

    @property
    def ends(self) -> tuple[Ints, Ints]:
        """First and last point of each chain; the same for a ring."""
        return self.indices[self.starts[:-1]], self.indices[self.starts[1:] - 1]

    @property
    def sides(self) -> tuple[Ints, Ints]:
        """(c,) the region numbers on the left and right of each chain."""
        first = self.crack[np.minimum(self.indices[self.starts[:-1] + ~self.rings], len(self.crack) - 1)]
        return self.cracks.left[first], self.cracks.right[first]

    def outlines(self, points: Points) -> Outlines:
        """Return the outlines through given places of the points."""
        return Outlines(np.stack([points.real, points.imag], axis=1), self.indices, self.starts, *self.sides, self.cracks.labels)


def lay_out(cracks: Cracks, frame: Frame) -> Links:
    """Trace the chains of cracks and lay them out in the plane of the frame."""
    h, w = cracks.shape
    chains = trace(cracks)

    def corner(numbers: Ints) -> Points:
        xy = frame.plane(*np.divmod(numbers, w + 1))
        return np.asarray(xy[:, 0] + 1j * xy[:, 1])

    tail, head = cracks.tail[chains.order], cracks.head[chains.order]
    is_open = np.flatnonzero(~chains.rings)
    first, last = chains.starts[is_open], chains.starts[is_open + 1] - 1
    nodes = np.unique(np.concatenate([tail[first], head[last]]))
    n = len(tail)

    # Each chain is its crossings, between its two nodes or closed by its first crossing:
    #     node 10 11 12 node   20 21 22 23 20
    starts = np.concatenate([[0], np.cumsum(np.diff(chains.starts) + np.where(chains.rings, 1, 2))])
    indices = np.empty(starts[-1], np.int64)
    offset = starts[:-1] + ~chains.rings - chains.starts[:-1]
    indices[np.arange(n) + offset[chains.chain]] = np.arange(n)
    indices[starts[is_open]] = n + np.searchsorted(nodes, tail[first])
    indices[starts[is_open + 1] - 1] = n + np.searchsorted(nodes, head[last])
    indices[starts[1:][chains.rings] - 1] = chains.starts[:-1][chains.rings]

    a, b = corner(tail), corner(head)
    # A quarter turn to the left, as long as the link: across a vertical crack lies the width of a pixel.
    width, height = np.abs(np.diff(frame.plane([0, 1], [0, 1]), axis=0)[0])
    axis = 1j * (np.sign((b - a).real) * height + 1j * np.sign((b - a).imag) * width)
    axis[cracks.on_frame[chains.order]] = 0
    r, c = np.divmod(nodes, w + 1)
    inside = (r > 0) & (r < h) & (c > 0) & (c < w)
    return Links(
        cracks,
        chains.order,
        indices,
        starts,
        chains.rings,
        middle=np.concatenate([(a + b) / 2, corner(nodes)]),
        axis=np.concatenate([axis, np.zeros(len(nodes))]),
        head=b,
        node=nodes,
        room=np.concatenate([np.zeros(n), np.where(inside, REACH * (width + 1j * height), 0)]),
        pixel=complex(width, height),
        swept=np.asarray(np.bincount(chains.chain, cross(a, b) / 2, len(chains.rings)), np.float64),
    )


def cut(links: Links, crossings: Ints, frame: Frame) -> Links:
    """Cut chains after some crossings: the corners of pixels there become nodes."""
    successor = links.cracks.successor.copy()
    successor[links.crack[crossings]] = NODE
    return lay_out(replace(links.cracks, successor=successor), frame)


def pixels_beside(links: Links) -> tuple[Floats, Ints]:
    """Return the centres (k, 2) of the pixels on both sides of each crack inside the image, and their region numbers (k,)."""
    inner = np.flatnonzero(links.axis)
    sides = np.concatenate([links.middle[inner] + links.axis[inner] / 2, links.middle[inner] - links.axis[inner] / 2])
    regions = np.concatenate([links.cracks.left[links.crack[inner]], links.cracks.right[links.crack[inner]]])
    return np.stack([sides.real, sides.imag], axis=1), regions


def pixel_areas(links: Links) -> Floats:
    """Return the area (r,) of the pixels of each region number; entry 0 means nothing."""
    left, right = links.sides
    size = len(links.cracks.labels)
    return np.asarray(np.bincount(left, links.swept, size) - np.bincount(right, links.swept, size))
