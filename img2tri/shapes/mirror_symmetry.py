"""Mirror symmetry: the outlines of a symmetric image -> those of one half of it, that end exactly on the axis.

The outlines are placed on the whole image first, so that they are as smooth across the axis as elsewhere. Then the label map is cut at the
axis, its chains are traced again, and each of their points takes the place it has in the whole. The axis becomes part of the frame::

        o---x---|---x---o      an even number of pixels: the outline passes the axis | half-way between two crossings x
        o-----x-|-x-----o      an odd number: a crossing on the axis becomes the node in which the chain of the half ends;
                ^              half-way between it and the point before lies the last crossing of the half
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, as_rows, cross
from img2tri.errors import ImageError, ParameterError
from img2tri.shapes.trace.crack_edges import NODE, CrackEdges, find_crack_edges
from img2tri.shapes.trace.dual_edges import DualEdges, lay_out
from img2tri.types import Frame, Outlines

AXES = {"x": (1, "left and right"), "y": (0, "top and bottom")}  # by the direction that is turned round


def check_symmetric(
    symmetric: str | None, values: NDArray[Any], labels: NDArray[Any], *, periodic: str | None = None, smoothing: str | None = None
) -> None:
    """Check that an image (h, w) or (h, w, k) and its labels (h, w) are equal to their mirror images, and that no option stands against it.

    Raises
    ------
    ParameterError
        If opposite sides are to be alike, too, or smoothing would move vertices off the axis.
    ImageError
        If the image differs from its mirror image; it says where it first does.

    Examples
    --------
    >>> check_symmetric("x", np.array([[1, 2, 1], [2, 2, 1]]), np.ones((2, 3)))
    Traceback (most recent call last):
    ...
    img2tri.errors.ImageError: symmetric: expected an image whose left and right are mirror images, found 2 and 1 in row 1, ...
    """
    if not symmetric:
        return
    for name, value in (("periodic", periodic), ("smoothing", None if smoothing == "none" else smoothing)):
        if value is not None:
            raise ParameterError(f"{name}: expected None with symmetric={symmetric!r}, found {value!r}; leave one of them out")
    for direction in symmetric:
        axis, sides = AXES[direction]
        for array in (values, labels):
            mirrored = np.flip(array, axis)
            differ = (array != mirrored) & ~((array != array) & (mirrored != mirrored))  # nan is as good as nan
            at = np.argwhere(differ.reshape(*labels.shape, -1).any(axis=2))
            if len(at):
                (row, column), last = at[0].tolist(), labels.shape[axis] - 1
                one, other = array[row, column], mirrored[row, column]
                where = f"row {row}, columns {column}" if axis == 1 else f"column {column}, rows {row}"
                raise ImageError(
                    f"symmetric: expected an image whose {sides} are mirror images, found {one} and {other} in {where} and "
                    f"{last - (column if axis == 1 else row)} ({len(at)} such pixels); mirror one half of it, or leave symmetric= out"
                )


def half_outlines(
    symmetric: str,
    outlines: Outlines,
    dual_edges: DualEdges,
    labels: NDArray[Any],
    frame: Frame,
    *,
    background: int | None,
    connectivity: int,
) -> tuple[Outlines, DualEdges, tuple[float, float]]:
    """Return the outlines and dual edges of the half, or for "xy" the quarter, at the origin of the plane; and where the axes are.

    Parameters
    ----------
    symmetric
        "x", "y" or "xy".
    outlines, dual_edges
        Of the whole image.
    labels, frame
        The label map (h, w), and where it lies.
    background, connectivity
        As the outlines were traced with.

    Returns
    -------
    outlines, dual_edges
        In the plane, without their part beyond the axes.
    axes : (float, float)
        x and y of the axes in the plane.
    """
    (h, w), whole = labels.shape, dual_edges.crack_edges
    rows, columns = (-(-h // 2) if "y" in symmetric else h), (-(-w // 2) if "x" in symmetric else w)
    row_0 = h - rows if frame.upward else 0
    part = labels[row_0 : row_0 + rows, :columns]
    crack_edges = find_crack_edges(part, background=background, upward=frame.upward, connectivity=connectivity)
    ends = np.stack([crack_edges.tail, crack_edges.head])
    known = _find(whole, _in_whole(ends, columns, row_0, w), (h + 1) * (w + 1))
    r, c = np.divmod(ends, columns + 1)
    axis_row = 0 if frame.upward else rows
    known[("x" in symmetric) & (c == columns).all(axis=0) | ("y" in symmetric) & (r == axis_row).all(axis=0)] = -1
    cut = (known >= 0) & (whole.successor[known] == NODE)
    half = lay_out(replace(crack_edges, successor=np.where(cut, NODE, crack_edges.successor)), replace(frame, shape=(rows, columns)))

    # Where each point of the half is in the whole; -1 if it is not.
    crossing = np.empty(len(whole.tail), np.int64)
    crossing[dual_edges.crossed] = np.arange(len(dual_edges.crossed))
    corner = _in_whole(half.node_corner, columns, row_0, w)
    nodes = np.append(dual_edges.node_corner, -1)
    at = np.searchsorted(dual_edges.node_corner, corner)
    edges = known[half.crossed]
    source = np.concatenate([np.where(edges >= 0, crossing[edges], -1), np.where(nodes[at] == corner, len(dual_edges.crossed) + at, -1)])
    places = np.where((source >= 0)[:, None], outlines.points[source], as_rows(half.middle))
    middle, axes = as_rows(half.middle).copy(), tuple(frame.plane(h / 2, w / 2).tolist())
    for i, odd in ((0, w % 2), (1, h % 2)):
        if "xy"[i] in symmetric:
            _end_on_axis(places, middle, half, source >= 0, i, axes[i], bool(odd))
    near = half.middle[: len(half.crossed)]
    tail, head = (_clipped(z, axes, symmetric) for z in (2 * near - half.corner_after, half.corner_after))
    return (
        half.outlines(as_complex(places)),
        replace(
            half,
            middle=as_complex(middle),
            vector=np.where(source >= 0, dual_edges.vector[source], 0),
            bounds=np.where(source >= 0, dual_edges.bounds[source], 0) * (half.bounds != 0),
            swept_areas=np.asarray(np.bincount(_chain_of(half), cross(tail, head) / 2, len(half.chains.rings)), np.float64),
        ),
        axes,
    )


def _in_whole(corners: Ints, columns: int, row_0: int, w: int) -> Ints:
    """Numbers in the whole of corners of pixels in the part."""
    r, c = np.divmod(corners, columns + 1)
    return np.asarray((r + row_0) * (w + 1) + c)


def _find(whole: CrackEdges, ends: Ints, size: int) -> Ints:
    """Numbers of the crack edges between two corners (2, n); -1 where there is none."""
    keys, wanted = whole.tail * size + whole.head, ends[0] * size + ends[1]
    order = np.argsort(keys)
    at = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
    return np.where(keys[at] == wanted, at, -1)


def _chain_of(dual_edges: DualEdges) -> Ints:
    """Chain of each crossing."""
    chain = np.empty(len(dual_edges.middle), np.int64)
    chain[dual_edges.chains.indices] = dual_edges.chains.chain
    return chain[: len(dual_edges.crossed)]


def _clipped(z: Points, axes: tuple[float, float], symmetric: str) -> Points:
    """Corners of pixels, those beyond an axis put on it."""
    x, y = (np.minimum(part, axis) if name in symmetric else part for part, axis, name in zip((z.real, z.imag), axes, "xy", strict=True))
    return np.asarray(x + 1j * y)


def _end_on_axis(places: Floats, middle: Floats, half: DualEdges, known: Bools, i: int, axis: float, odd: bool) -> None:
    """Let the chains of the half end on an axis: set coordinate i of places and middles (n, 2) there.

    `known` are the points that the whole has too; `odd` says that the axis runs through the middles of pixels, half a pixel before the
    frame of the half.
    """
    k, chains, step = len(half.crossed), half.chains, half.pixel.imag if i else half.pixel.real
    crossing = np.arange(len(places)) < k
    beyond = middle[:, i] > axis + step / 4 if odd else middle[:, i] > axis - step / 4
    on_axis = odd & crossing & (np.abs(middle[:, i] - axis) < step / 4)
    # The nodes in which an interface ends, the crossing beside each, and the point before that.
    ends = np.concatenate([chains.first[~chains.rings], chains.last[~chains.rings]])
    inwards = np.repeat([1, -1], len(ends) // 2)
    node, beside = chains.indices[ends], chains.indices[ends + inwards]
    meets = beyond[node] & half.slides[beside]
    node, beside, before = node[meets], beside[meets], chains.indices[(ends + 2 * inwards)[meets]]
    free = odd | ~known[node]
    places[node[free], 1 - i] = places[beside[free], 1 - i]
    places[beyond, i] = middle[beyond, i] = axis
    # What lay on the axis gives way to the node there.
    middle[on_axis, i] = axis - step / 4
    places[on_axis & ~half.slides, i] = axis - step / 4
    if odd:
        places[beside] = (places[before] + places[node]) / 2
