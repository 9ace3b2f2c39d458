"""Outlines -> shapely polygons: one coverage, neighbours sharing their vertices.

Around each region its chains are followed with the region on their left. A ring that turns left encloses a component, one
that turns right a hole of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, runs
from img2tri.shapes.trace.chains import follow
from img2tri.types import Outlines

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon


@dataclass(frozen=True, eq=False)
class RegionRings:
    """The rings around all regions, each along the chains of its region.

    Attributes
    ----------
    points
        (k, 2) float64, the points of all rings, each ring closed by its first point.
    starts
        (r + 1,) int64: ring i is ``points[starts[i]:starts[i + 1]]``.
    regions
        (r,) int64, the number of the region on the left of each ring.
    areas
        (r,) float64, signed: positive around a component, negative around a hole.
    """

    points: Floats
    starts: Ints
    regions: Ints
    areas: Floats


def region_rings(outlines: Outlines) -> RegionRings:
    """Join chains into the rings around the regions."""
    o, n = outlines, len(outlines.left)
    size = np.diff(o.chains.starts)
    # Each chain is walked twice: forwards by the region on its left (0..n-1), backwards by the one on its right (n..2n-1).
    region = np.concatenate([o.left, o.right])
    first, last = o.chains.ends
    begin, end = np.concatenate([first, last]), np.concatenate([last, first])
    meshed = np.flatnonzero(region != 0)
    # At a node a region has one chain that comes in and one that goes out.
    _, key = np.unique(np.concatenate([region, region]), return_inverse=True)
    arrives, departs = end * (key.max(initial=0) + 1) + key[: 2 * n], begin * (key.max(initial=0) + 1) + key[: 2 * n]
    order = meshed[np.argsort(departs[meshed], kind="stable")]
    successor = np.searchsorted(meshed, order[np.searchsorted(departs[order], arrives[meshed])])
    around = follow(successor.astype(np.int64))

    walked = meshed[around.order]
    chain, back = walked % n if n else walked, walked >= n
    # All points of a chain but the one the next chain begins with; the ring's own first point is put back at the end.
    count = size[chain] - 1
    which, step = runs(count)
    entry = np.where(back[which], o.chains.last[chain][which] - step, o.chains.first[chain][which] + step)
    ends = np.concatenate([[0], np.cumsum(count)])[around.starts]
    points = np.insert(o.points[o.chains.indices[entry]], ends[1:], o.points[o.chains.indices[entry[ends[:-1]]]], axis=0)
    starts = ends + np.arange(len(ends))
    x, y = (points - points.mean(axis=0, keepdims=True)).T if len(points) else (np.zeros(0), np.zeros(0))
    sweep = np.zeros(len(points))
    sweep[:-1] = (x[:-1] * y[1:] - x[1:] * y[:-1]) / 2
    sweep[starts[1:] - 1] = 0
    areas = np.add.reduceat(sweep, starts[:-1]) if len(starts) > 1 else np.zeros(0)
    return RegionRings(points, starts, region[walked[around.starts[:-1]]], areas)


def component_polygons(outlines: Outlines) -> tuple[Ints, NDArray[Any]]:
    """Return the components of all regions as shapely polygons.

    Returns
    -------
    regions : (p,) int64
        The label of each polygon.
    polygons : (p,) array of shapely.Polygon
        Together a valid coverage: neighbours share the vertices of their interface.
    """
    import shapely

    r = region_rings(outlines)
    index = runs(np.diff(r.starts))[0]
    lines = shapely.linearrings(r.points, indices=index)
    outer, inner = np.flatnonzero(r.areas > 0), np.flatnonzero(r.areas <= 0)
    shells = shapely.polygons(lines[outer])
    # A hole belongs to the smallest component of its region around it.
    hole, shell = shapely.STRtree(shells).query(shapely.points(r.points[r.starts[inner]]), predicate="intersects")
    same = r.regions[inner[hole]] == r.regions[outer[shell]]
    hole, shell = hole[same], shell[same]
    order = np.lexsort((r.areas[outer[shell]], hole))
    hole, shell = hole[order], shell[order]
    closest = np.flatnonzero(np.diff(hole, prepend=-1))
    parts = np.concatenate([np.arange(len(outer)), shell[closest]])
    members = np.concatenate([outer, inner[hole[closest]]])
    order = np.argsort(parts, kind="stable")
    return outlines.labels[r.regions[outer]], shapely.polygons(lines[members[order]], indices=parts[order])


def enclosed_areas(outlines: Outlines) -> Floats:
    """Return the area (r,) each region number has within its outlines; entry 0 is 0."""
    r = region_rings(outlines)
    return np.asarray(np.bincount(r.regions, r.areas, len(outlines.labels)), np.float64)


def region_polygons(outlines: Outlines) -> dict[int, Polygon | MultiPolygon]:
    """Return one polygon, or multi-polygon, for each region, by ascending label."""
    import shapely

    regions, parts = component_polygons(outlines)
    result: dict[int, Polygon | MultiPolygon] = {}
    for value in np.unique(regions).tolist():
        mine = parts[regions == value]
        result[value] = mine[0] if len(mine) == 1 else shapely.multipolygons(mine)
    return result
