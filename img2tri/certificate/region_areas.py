"""How large the regions of a mesh are, and whether they lie where they do in the image: areas and first moments, region by region.

In: a mesh in the plane of the frame, in pixels, with the region number of each triangle, and the areas and outlines of the image. Out:
areas with their errors, and the labels that lie elsewhere.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex, blocks
from img2tri.certificate.outline_distance import SegmentSet
from img2tri.types import Provenance

AREA_TOLERANCE = 0.01  # relative: what the area of a region may be off
SMALL_AREA = 16.0  # px: the area of regions up to this size is not promised

Moments = tuple[Floats, Floats, Floats]
"""Area of each region number (r,), and the integrals of x and y over it."""


def region_numbers(regions: Ints, labels: Ints) -> tuple[Ints, list[int]]:
    """Region number (m,) of each triangle, 0 where the image has no such label, and these labels."""
    # Most triangles are of the region of the one before.
    first = np.flatnonzero(np.append(True, regions[1:] != regions[:-1])[: len(regions)])
    some = regions[first]
    at = np.minimum(np.searchsorted(labels[1:], some) + 1, len(labels) - 1)
    known = labels[at] == some
    return np.where(known, at, 0).repeat(np.diff(first, append=len(regions))), np.unique(some[~known]).tolist()


def moments(plane: Floats, triangles: Ints, number: Ints, size: int) -> Moments:
    """Area of each region number in the mesh, and the integrals of x and y over it."""
    z, parts = as_complex(plane), np.empty((3, len(triangles)))
    for block in blocks(len(triangles)):
        a, b, c = z[np.ascontiguousarray(triangles[block].T)]
        area, middle = ((b - a).conj() * (c - a)).imag / 2, (a + b + c) / 3
        parts[0, block] = area
        np.multiply(area, middle.real, out=parts[1, block])
        np.multiply(area, middle.imag, out=parts[2, block])
    first, second, third = (np.asarray(np.bincount(number, part, size), np.float64) for part in parts)
    return first, second, third


def region_areas(found: Moments, origin: Provenance, pixel: float) -> dict[int, dict[str, float]]:
    """Area of each label in the mesh and in the image, in world units squared, and the relative error."""
    areas = found[0] * pixel**2
    wanted = origin.areas * pixel**2
    return {
        label: {"mesh": float(areas[i]), "image": float(wanted[i]), "error": float(areas[i] / wanted[i] - 1)}
        for i, label in enumerate(origin.outlines.labels.tolist())
        if i
    }


def regions_off(found: Moments, curves: SegmentSet, origin: Provenance) -> dict[int, Floats]:
    """Places (2,), by label, of regions of more than `SMALL_AREA` pixels whose area is off by more than `AREA_TOLERANCE`.

    The place is the point of the region's outline that is farthest from the curves of the mesh.
    """
    off = (origin.areas > SMALL_AREA) & (np.abs(found[0] - origin.areas) > AREA_TOLERANCE * origin.areas)
    off[0] = False
    segments, left, right = origin.outlines.segments
    places = {}
    for i in np.flatnonzero(off).tolist():
        points = origin.outlines.points[segments[(left == i) | (right == i), 0]]
        places[int(origin.outlines.labels[i])] = points[np.argmax(curves.distance(points))]
    return places


def displaced(found: Moments, origin: Provenance) -> list[int]:
    """Labels that lie elsewhere than in the image, by more than outlines within the tolerance of each other explain.

    An outline moved by t moves the first moment of its region about a point by t times the sum of length x distance, at most.
    """
    o, size = origin.outlines, len(origin.areas)
    segments, left, right = o.segments
    a, b = as_complex(o.points)[segments].T
    sweep = (a.conj() * b).imag / 2
    parts = (sweep, sweep * (a + b).real / 3, sweep * (a + b).imag / 3)
    area, mx, my = (np.bincount(left, part, size) - np.bincount(right, part, size) for part in parts)
    centre = (mx + 1j * my) / np.where(area, area, 1)
    there, fx, fy = found
    off = np.abs(fx + 1j * fy - there * centre)
    reach = np.zeros(size)
    for side in (left, right):
        reach += np.bincount(side, np.abs(b - a) * (np.abs((a + b) / 2 - centre[side]) + 1), size)
    limit = 2 * max(origin.tolerance or 0.0, 0.5) * reach
    return [int(label) for label in o.labels[1:][(off > limit)[1:]]]
