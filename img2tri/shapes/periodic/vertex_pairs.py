"""Vertices of meshes on opposite sides of an image: divided alike, and paired."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import ChainIndex, Floats, Ints
from img2tri.errors import MeshError
from img2tri.shapes.periodic.side_labels import DIRECTIONS
from img2tri.types import Outlines

ON_SIDE = 1e-9  # of the size of the image: what lies so near to a side lies on it

Walls = tuple[tuple[int, float, float], ...]  # for each direction: the coordinate of its two sides, and where it puts them


def divided_alike(outlines: Outlines, vertices: Floats, walls: Walls) -> Outlines:
    """Divide two sides of coarse outlines alike, after filling them, with `vertices` (n, 2), divided them differently.

    Return `outlines` itself if both sides have their vertices at the same places; else with those that only one has.
    """
    result = outlines
    for wall in walls:
        places = _missing_places(outlines.points, vertices, *wall)
        if len(places):
            result = _insert(result, places, *wall)
    return result


def _missing_places(points: Floats, vertices: Floats, axis: int, low: float, high: float) -> Floats:
    """Places along a side (k,) at which filling divided it: between two points that were given, those of the side that has more.

    Empty if both sides were divided alike.
    """
    given = np.sort(points[points[:, axis] == low, 1 - axis])
    new = []
    for wall in (low, high):
        places = vertices[np.abs(vertices[:, axis] - wall) < ON_SIDE * (high - low), 1 - axis]
        new.append(np.setdiff1d(places, given))
    if np.array_equal(new[0], new[1]):
        return np.zeros(0)
    at = [np.searchsorted(given, places) for places in new]
    count = [np.bincount(where, minlength=len(given) + 1) for where in at]
    finer = count[1] > count[0]
    return np.concatenate([new[0][~finer[at[0]]], new[1][finer[at[1]]]])


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


def vertex_pairs(vertices: Floats, bounds: tuple[float, float, float, float], periodic: str | None) -> dict[str, Ints]:
    """Pair the vertices on opposite sides.

    `bounds` are (left, bottom, right, top) of the image.

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
            pair.append(on[np.argsort(vertices[on, 1 - axis])])
        one, other = (vertices[on, 1 - axis] for on in pair)
        if not np.array_equal(one, other):
            raise MeshError(f"periodic: expected the same places on opposite sides, found {len(one)} and {len(other)} vertices that differ")
        result["xy"[axis]] = np.stack(pair, axis=1)
    return result
