"""Vertices of meshes on opposite sides of an image: divided alike, and paired."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Ints
from img2tri.errors import MeshError
from img2tri.shapes.periodic.side_chains import DIRECTIONS
from img2tri.types import Outlines

ON_SIDE = 1e-9  # of the size of the image: what lies so near to a side lies on it

Walls = tuple[tuple[int, float, float], ...]  # for each direction: the coordinate of its two sides, and where it puts them


def divided_alike(outlines: Outlines, vertices: Floats, walls: Walls) -> Outlines:
    """Divide two sides of coarse outlines alike, after filling them, with `vertices` (n, 2), divided them differently.

    Return `outlines` itself if both sides have their vertices at the same places; else with those that only one has.
    """
    result = outlines
    for wall in walls:
        places = _missing_places(outlines, vertices, *wall)
        if len(places):
            result = _insert(result, places, *wall)
    return result


def _missing_places(outlines: Outlines, vertices: Floats, axis: int, low: float, high: float) -> Floats:
    """Places along a side (k,) at which filling divided it: between two points that were given, those of the side that has more.

    Empty if both sides were divided alike, as far as both are meshed.
    """
    points = outlines.points
    given = np.unique(points[(points[:, axis] == low) | (points[:, axis] == high), 1 - axis])
    segments = outlines.segments[0]
    new = []
    for wall, opposite in ((low, high), (high, low)):
        places = vertices[np.abs(vertices[:, axis] - wall) < ON_SIDE * (high - low), 1 - axis]
        across = points[segments, axis] == opposite
        new.append(np.setdiff1d(places[_covered(places, points[segments[across.all(axis=1)], 1 - axis])], given))
    if np.array_equal(new[0], new[1]):
        return np.zeros(0)
    at = [np.searchsorted(given, places) for places in new]
    count = [np.bincount(where, minlength=len(given) + 1) for where in at]
    finer = count[1] > count[0]
    return np.concatenate([new[0][~finer[at[0]]], new[1][finer[at[1]]]])


def _covered(places: Floats, stretches: Floats) -> Bools:
    """Tell which places (k,) lie in one of some stretches (s, 2) that do not overlap, their ends among them."""
    low, high = np.sort(stretches.min(axis=1)), np.sort(stretches.max(axis=1))
    before = np.searchsorted(low, places, "right")
    ended = np.searchsorted(high, places, "left")
    return np.asarray(before > ended)


def _insert(outlines: Outlines, places: Floats, axis: int, low: float, high: float) -> Outlines:
    """Put points at some places along two opposite sides into the chains there."""
    points, indices, starts = outlines.points, outlines.chains.indices, outlines.chains.starts
    for wall in (low, high):
        across, along = points[indices, axis] == wall, points[indices, 1 - axis]
        inner = np.ones(len(indices) - 1, bool)
        inner[starts[1:-1] - 1] = False
        entry = np.flatnonzero(inner & across[:-1] & across[1:])
        begins = np.minimum(along[entry], along[entry + 1])
        entry = entry[np.argsort(begins)]
        at = entry[np.searchsorted(np.sort(begins), places) - 1]
        # In the order of the chain, which may run either way.
        order = np.lexsort((np.where(along[at + 1] > along[at], places, -places), at))
        at, new = at[order] + 1, np.full((len(places), 2), wall)
        new[:, 1 - axis] = places[order]
        indices = np.insert(indices, at, len(points) + np.arange(len(places)))
        starts = starts + np.searchsorted(np.sort(at), starts)
        points = np.concatenate([points, new])
    return replace(outlines, points=points, chains=ChainIndex(indices, starts, outlines.chains.rings))


def vertex_pairs(
    vertices: Floats, bounds: tuple[float, float, float, float], periodic: str | None, boundary: Ints | None = None
) -> dict[str, Ints]:
    """Pair the vertices on opposite sides.

    `bounds` are (left, bottom, right, top) of the image; `boundary` (e, 2) the edges of the mesh that have a triangle on one side only:
    where they run along one side of the image and not along the opposite one, vertices have no partner. None: all have one.

    Returns
    -------
    dict
        "x": (k, 2) int64, a vertex on the left side and its partner on the right, from the bottom up; they have the same y, bit for bit.
        "y": (l, 2), bottom and top, from the left. Only the directions asked for.

    Raises
    ------
    MeshError
        If a vertex has no partner.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.5]])
    >>> vertex_pairs(square, (0, 0, 2, 2), "xy")["x"].tolist()
    [[0, 1], [3, 2]]
    """
    result = {}
    for axis in DIRECTIONS[periodic]:
        low, high = bounds[axis], bounds[axis + 2]
        pair = []
        for wall in (low, high):
            on = np.flatnonzero(np.abs(vertices[:, axis] - wall) < ON_SIDE * (high - low))
            on = on[np.argsort(vertices[on, 1 - axis])]
            if boundary is not None:
                opposite = np.abs(vertices[boundary, axis] - (low + high - wall)) < ON_SIDE * (high - low)
                on = on[_covered(vertices[on, 1 - axis], vertices[boundary[opposite.all(axis=1)], 1 - axis])]
            pair.append(on)
        one, other = (vertices[on, 1 - axis] for on in pair)
        if not np.array_equal(one, other):
            raise MeshError(f"periodic: expected the same places on opposite sides, found {len(one)} and {len(other)} vertices that differ")
        result["xy"[axis]] = np.stack(pair, axis=1)
    return result
