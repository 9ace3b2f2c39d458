"""Label map -> crack edges, and how they follow each other.

A *crack edge* is the side shared by two pixels of different regions, or the side of a region's pixel on the frame of the image
(inter-pixel boundary; Kovalevsky, "Finite topology as applied to image analysis", 1989, DOI 10.1016/0734-189X(89)90165-5). Outlines
are made of crack edges end to end. Crack edges meet at corners of pixels, where four pixels lie::

        a | b          two crack edges: the outline passes
       ---+---         three, or four with neither diagonal equal: a junction of regions, a *node*
        c | d          four with an equal diagonal: a checkerboard; one diagonal is joined, outlines pass twice

Nodes are also where an outline reaches the frame, and the four corners of the image: the frame stays straight.

Scanning compares the image with itself shifted by one pixel, eight bytes at a time. All that follows costs as much as
the outlines are long, whatever the size of the image.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints, neighbour_changes

NODE = -1  # the successor of a crack edge that ends at a node


@dataclass(frozen=True, eq=False)
class CrackEdges:
    """All crack edges of a label map, each directed so that the region of the lower number is on its left.

    The corners of pixels are numbered row by row: corner (r, c) of an image w pixels wide is ``r * (w + 1) + c``.

    Attributes
    ----------
    shape
        (h, w) of the label map.
    tail, head
        (n,) int64, the corners of pixels a crack edge runs from and to.
    left, right
        (n,) int64, region numbers on either side, seen with y up or down as asked; 0 is what is not meshed.
    successor
        (n,) int64, the crack edge that follows, or `NODE` where it ends in a node.
    on_frame
        (n,) bool, it lies on the frame of the image.
    labels
        (k,) the image's own label of each region number; entry 0 only keeps the place.
    """

    shape: tuple[int, int]
    tail: Ints
    head: Ints
    left: Ints
    right: Ints
    successor: Ints
    on_frame: Bools
    labels: Ints


def find_crack_edges(
    labels: NDArray[Any],
    *,
    background: int | None = 0,
    upward: bool = True,
    connectivity: int = 4,
    changes: tuple[Ints, Ints] | None = None,
) -> CrackEdges:
    """Find the crack edges between the regions of a label map, and how they follow each other.

    Parameters
    ----------
    labels
        (h, w) bool or integer; each value is a region.
    background
        The value that is not meshed; None: all are.
    upward
        True: left and right are meant with y growing from the last row to the first.
    connectivity
        A checkerboard of two regions joins one of them: with 4 the lower label, the background being the lowest, so that
        a region hangs together through sides of pixels; with 8 the higher one, so that diagonal pixels hang together.
    changes
        The `neighbour_changes` of the labels, where they are known already.

    Examples
    --------
    A single pixel amid others has four crack edges in a ring; alone in its image, its four corners are nodes:

    >>> sorted(find_crack_edges(np.pad([[True]], 1)).successor.tolist())
    [0, 1, 2, 3]
    >>> find_crack_edges(np.array([[True]])).successor
    array([-1, -1, -1, -1])
    """
    h, w = labels.shape
    flat = np.ascontiguousarray(labels).reshape(-1)
    across, down = neighbour_changes(labels) if changes is None else changes
    west_north = np.concatenate([across, down])
    east_south = np.concatenate([across + 1, down + w])
    rim, rim_tail, rim_head, rim_facing = _frame_edges(h, w)

    seen, which = np.unique(np.concatenate([flat[west_north], flat[east_south], flat[rim]]), return_inverse=True)
    number = _region_numbers(seen, background)
    first, second, edge = np.split(number[which], [len(west_north), 2 * len(west_north)])

    # Between neighbours in a row the crack edge goes down, between neighbours in a column to the right; with y up the pixel
    # on its left is then the second of the row, the first of the column.
    r, c = np.divmod(across, w)
    vertical = r * (w + 1) + c + 1
    r, c = np.divmod(down, w)
    horizontal = (r + 1) * (w + 1) + c
    tail = np.concatenate([vertical, horizontal, rim_tail])
    head = np.concatenate([vertical + w + 1, horizontal + 1, rim_head])
    falls = np.arange(len(first)) < len(across)
    nothing = np.zeros_like(edge)
    left = np.concatenate([np.where(falls, second, first), np.where(rim_facing, edge, nothing)])
    right = np.concatenate([np.where(falls, first, second), np.where(rim_facing, nothing, edge)])
    if not upward:
        left, right = right, left
    on_frame = np.arange(len(tail)) >= len(first)

    keep = left != right
    tail, head, left, right, on_frame = tail[keep], head[keep], left[keep], right[keep], on_frame[keep]
    swap = left > right
    tail, head = np.where(swap, head, tail), np.where(swap, tail, head)
    left, right = np.where(swap, right, left), np.where(swap, left, right)

    def pixels(index: Ints) -> Ints:
        return number[np.searchsorted(seen, flat[index])]

    successor = _successors(tail, head, on_frame, (h, w), pixels, connectivity)
    values = np.concatenate([[0], seen[number > 0].astype(np.int64)])
    return CrackEdges((h, w), tail, head, left, right, successor, on_frame, values)


def cut_chains(crack_edges: CrackEdges, after: Ints) -> CrackEdges:
    """Cut chains after some crack edges: the corners of pixels there become nodes."""
    successor = crack_edges.successor.copy()
    successor[after] = NODE
    return replace(crack_edges, successor=successor)


def _region_numbers(seen: NDArray[Any], background: int | None) -> Ints:
    """Give the labels that occur the numbers 1, 2, ... in their order, the background 0."""
    meshed = np.ones(len(seen), bool) if background is None else seen.astype(np.int64) != background
    return np.where(meshed, np.cumsum(meshed), 0)


def _frame_edges(h: int, w: int) -> tuple[Ints, Ints, Ints, Bools]:
    """Pixels along the frame, the corners their edges on it run between, and whether the pixel is on the left (y up)."""
    row, column = np.arange(h), np.arange(w)
    sides = (  #  pixels                 tail                     step   the pixel is on the left
        (column, column, 1, False),  # top
        ((h - 1) * w + column, h * (w + 1) + column, 1, True),  # bottom
        (row * w, row * (w + 1), w + 1, True),  # left
        (row * w + w - 1, row * (w + 1) + w, w + 1, False),  # right
    )
    pixel = np.concatenate([side[0] for side in sides])
    tail = np.concatenate([side[1] for side in sides])
    head = np.concatenate([side[1] + side[2] for side in sides])
    facing = np.concatenate([np.full(len(side[0]), side[3]) for side in sides])
    return pixel, tail, head, facing


def _successors(tail: Ints, head: Ints, on_frame: Bools, shape: tuple[int, int], pixels: Any, connectivity: int) -> Ints:
    """Give each crack edge its successor, corner by corner."""
    n, (h, w) = len(tail), shape
    successor = np.full(n, NODE)
    ends = np.concatenate([tail, head])
    order = np.argsort(ends, kind="stable")
    ends = ends[order]
    first = np.diff(ends, prepend=-1).nonzero()[0]
    count = np.diff(first, append=2 * n)

    # Two crack edges: one comes in, one goes out, since both part the same two regions.
    at = first[count == 2]
    goes, comes = order[at], order[at + 1] - n  # tails stand before heads in `order`
    image_corner = np.isin(ends[at], [0, w, h * (w + 1), h * (w + 1) + w])
    passes = (goes < n) & (comes >= 0) & ~image_corner
    goes, comes = goes[passes], comes[passes]
    same = on_frame[goes] == on_frame[comes]
    successor[comes[same]] = goes[same]

    # Four crack edges: one diagonal is joined if the two pixels on it are of the same region.
    at = first[count == 4]
    corner = ends[at]
    r, c = np.divmod(corner, w + 1)
    a, b = pixels((r - 1) * w + c - 1), pixels((r - 1) * w + c)
    lower_left, d = pixels(r * w + c - 1), pixels(r * w + c)
    lower, higher = np.minimum(a, b), np.maximum(a, b)
    wanted = lower if connectivity == 4 else higher
    falling = (a == d) & ((b != lower_left) | (a == wanted))
    rising = (b == lower_left) & ~falling
    group = order[at[:, None] + np.arange(4)]
    edge = group % n
    # Which way a crack edge leaves the corner: 0 up, 1 left, 2 right, 3 down.
    away = tail[edge] + head[edge] - 2 * corner[:, None]
    way = np.searchsorted([-w, 0, 2], away, side="left")
    by_way = np.take_along_axis(edge, np.argsort(way, axis=1), axis=1)
    incoming = head[by_way] == corner[:, None]
    # Joining the diagonal a-d, the outlines pass around b (up, right) and around the lower left pixel (left, down).
    for joined, pairs in ((falling, ((0, 2), (1, 3))), (rising, ((0, 1), (2, 3)))):
        for one, other in pairs:
            x, y, enters = by_way[joined, one], by_way[joined, other], incoming[joined, one]
            successor[np.where(enters, x, y)] = np.where(enters, y, x)
    return successor
