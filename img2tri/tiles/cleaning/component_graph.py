"""The components of blocks -> those of the whole image, without looking at a pixel twice.

Each block gives its components as a graph, see `img2tri.raster.labels.connected_components`, and which of them its outermost pixels belong
to. Components of neighbours that meet with the same label along a border, or across the corner of a checkerboard, are one (union-find over
borders, as A. Rosenfeld and J. L. Pfaltz join rows, Sequential operations in digital picture processing, 1966,
https://doi.org/10.1145/321356.321357).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints
from img2tri.raster.labels.connected_components import Components, connected, find_components, joined
from img2tri.raster.labels.specks_and_holes import summed

Block = tuple[int, int]


@dataclass(frozen=True, eq=False)
class BlockGraph:
    """The components of a block.

    Attributes
    ----------
    labels, region
        (k,) int64 the label of each, and whether it is that of a region, no background.
    area, first
        (k,) int64, number of pixels, and the first of them, counted row by row in the whole image.
    at_frame
        (k,) bool, whether it reaches the frame of the image.
    touching, sides, corners
        As of `Components`, within the block; each pair once.
    top, bottom, left, right
        The components of its outermost pixels.
    """

    labels: Ints
    region: Bools
    area: Ints
    first: Ints
    at_frame: Bools
    touching: Ints
    sides: Ints
    corners: Ints
    top: Ints
    bottom: Ints
    left: Ints
    right: Ints


def block_graph(
    labels: NDArray[Any], background: int | None, connectivity: int, rows: slice, columns: slice, shape: tuple[int, int]
) -> tuple[BlockGraph, Components]:
    """Find the components of a block at some rows and columns of an image of some shape, as a graph and with their runs."""
    parts = find_components(labels, background=background, connectivity=connectivity)
    h, w = labels.shape
    first = np.zeros(len(parts.area), np.int64)
    first[parts.component[::-1]] = parts.start[::-1]
    row, column = np.divmod(first, w)

    def of_pixels(pixels: Ints) -> Ints:
        return parts.component[np.searchsorted(parts.start, pixels, "right") - 1]

    across, down = np.arange(w), np.arange(h) * w
    edges = [of_pixels(pixels) for pixels in (across, across + (h - 1) * w, down, down + w - 1)]
    at_frame = np.zeros(len(parts.area), bool)
    for edge, there in zip(edges, (rows.start == 0, rows.stop == shape[0], columns.start == 0, columns.stop == shape[1]), strict=True):
        at_frame[edge] |= there
    one, other, sides = summed(parts.touching[:, 0], parts.touching[:, 1], parts.sides)
    return BlockGraph(
        parts.values[parts.number], parts.number != 0, parts.area, (rows.start + row) * shape[1] + columns.start + column, at_frame,
        np.stack([one, other], axis=1), sides, parts.corners, *edges,
    ), parts  # fmt: skip


def whole_graph(
    blocks: Mapping[Block, BlockGraph], background: int | None, connectivity: int
) -> tuple[Components, Bools, dict[Block, Ints]]:
    """Join the components of all blocks.

    Returns
    -------
    parts : Components
        Numbered as in memory, by their first pixels; with one run each, of which only the first pixel is right.
    at_frame : (k,) bool
        Whether a component reaches the frame of the image.
    of_block : dict
        For each block the number of each of its components in the whole.
    """
    cells, graphs = list(blocks), list(blocks.values())
    begin = dict(zip(cells, np.cumsum([0, *(len(graph.area) for graph in graphs)])[:-1].tolist(), strict=True))
    labels, region, area, first, at_frame = (
        np.concatenate([getattr(graph, name) for graph in graphs]) for name in ("labels", "region", "area", "first", "at_frame")
    )
    seen = np.unique(labels[region])
    values = np.append(0 if background is None else background, seen)
    number = np.where(region, np.searchsorted(seen, labels) + 1, 0)

    one, other = _along_borders(blocks, begin)
    quads = np.concatenate([np.zeros((0, 4), np.int64), *_across_borders(blocks, begin)])
    a, b, c, d = number[quads].T
    quads = quads[(a != b) & (c != d) & (a != c) & (b != d)]
    same = number[one] == number[other]
    pairs = np.concatenate([np.stack([one, other], axis=1)[same], joined(quads, number, connectivity)])
    group = connected(len(area), pairs)

    # Numbers by first pixels.
    count = int(group.max()) + 1
    start = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(start, group, first)
    order = np.argsort(start)
    rank = np.empty(count, np.int64)
    rank[order] = np.arange(count)
    group = rank[group]
    of_group = np.zeros(count, np.int64)
    of_group[group] = number
    total = np.bincount(group, area, count).astype(np.int64)
    touching = [np.stack([one, other], axis=1)[~same], *(graph.touching + begin[cell] for cell, graph in blocks.items())]
    corners = [quads, *(graph.corners + begin[cell] for cell, graph in blocks.items())]
    sides = np.concatenate([np.ones(int((~same).sum()), np.int64), *(graph.sides for graph in graphs)])
    reaches = np.zeros(count, bool)
    reaches[group[at_frame]] = True
    parts = Components(
        values,
        of_group,
        total,
        start[order],
        total,
        np.arange(count),
        group[np.concatenate(touching)],
        sides,
        group[np.concatenate(corners)],
    )
    return parts, reaches, {cell: group[begin[cell] : begin[cell] + len(blocks[cell].area)] for cell in cells}


def _along_borders(blocks: Mapping[Block, BlockGraph], begin: Mapping[Block, int]) -> tuple[Ints, Ints]:
    """Components on both sides of each side of pixels on borders."""
    one, other = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for (i, j), graph in blocks.items():
        for beyond, here, there in (((i, j + 1), "right", "left"), ((i + 1, j), "bottom", "top")):
            if beyond in blocks:
                one.append(getattr(graph, here) + begin[i, j])
                other.append(getattr(blocks[beyond], there) + begin[beyond])
    return np.concatenate(one), np.concatenate(other)


def _across_borders(blocks: Mapping[Block, BlockGraph], begin: Mapping[Block, int]) -> Iterator[Ints]:
    """Components a, b, c, d around each corner of pixels on borders."""
    for (i, j), graph in blocks.items():
        right, below, last = (i, j + 1), (i + 1, j), (i + 1, j + 1)
        if right in blocks:
            a, b = graph.right + begin[i, j], blocks[right].left + begin[right]
            yield np.stack([a[:-1], b[:-1], a[1:], b[1:]], axis=1)
        if below in blocks:
            a, c = graph.bottom + begin[i, j], blocks[below].top + begin[below]
            yield np.stack([a[:-1], a[1:], c[:-1], c[1:]], axis=1)
        if last in blocks:
            corner = [graph.right[-1] + begin[i, j], blocks[right].left[-1] + begin[right]]
            yield np.array([[*corner, blocks[below].right[0] + begin[below], blocks[last].left[0] + begin[last]]])
