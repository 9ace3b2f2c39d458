"""How far the curves of a mesh are from the outlines of its image: two-sided Hausdorff distance, and pixels on the wrong side.

In: segments, the boundary and interface edges of a mesh or the outlines of an image, in the plane of the frame, in pixels. Out: distances
and places. Distances are measured at samples `SAMPLE_STEP` apart, to the segments themselves.

The nearest segment is looked for among those with a sample nearby. A segment at distance d has a sample within
sqrt(d^2 + half the step^2): if all samples were looked at that are not farther than that from the nearest segment found, no other one is
nearer. Cells beside the place say it nearly always; for the rest a search tree is asked, for more and more samples.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Floats, Ints, Points, as_complex, as_rows, blocks, cross, runs
from img2tri.cell_lists import cells, pairs_across
from img2tri.errors import MeshError
from img2tri.shapes.simplify.clearance import to_segment
from img2tri.types import Provenance

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

SAMPLE_STEP = 0.5  # px between the samples that distances are measured at
NEARBY = 0.75  # px, the width of cells in which segments are looked for at first
FIRST_ASKED = 3  # samples looked at around a place at first
JUST_WITHIN = 1e-6  # px, what is nearer to the tolerance than this is at it
PLACES_AT_ONCE = 1 << 12  # whose distances are measured at a time
MOST_SQUARES = 4000  # to a side of the grid in which triangles near pixels are looked for


class SegmentSet:
    """A set of segments, to measure distances to.

    Attributes
    ----------
    places
        (s, 2) places on the segments, ends included, at most `SAMPLE_STEP` apart.
    """

    def __init__(self, points: Floats, segments: Ints) -> None:
        self._a, self._b = as_complex(points)[segments].T
        pieces = np.maximum(np.ceil(np.abs(self._b - self._a) / SAMPLE_STEP).astype(np.int64), 1)
        which, place = runs(pieces + 1)
        samples = self._a[which] + place / pieces[which] * (self._b - self._a)[which]
        self._owner, self._samples = which, samples
        # Ends once, and as they were given.
        inner = (place > 0) & (place < pieces[which])
        ends = np.zeros(len(points), bool)
        ends[segments] = True
        self.places = np.concatenate([as_rows(samples[inner]), points[ends]])

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(as_rows(self._samples))

    def distance(self, places: Floats) -> Floats:
        """Distance of places (k, 2) to the nearest segment."""
        z = as_complex(places)
        result = self._distance_nearby(z)
        open_ = np.flatnonzero(result**2 + (SAMPLE_STEP / 2) ** 2 > NEARBY**2)
        asked = FIRST_ASKED
        while len(open_):
            asked = min(asked, len(self._samples))
            reach, found = map(np.asarray, self._tree.query(places[open_], k=np.arange(1, asked + 1)))
            owner = self._owner[found]
            nearest = to_segment(z[open_, None], self._a[owner], self._b[owner]).min(axis=1)
            result[open_] = nearest
            if asked == len(self._samples):
                break
            open_ = open_[reach[:, -1] ** 2 < nearest**2 + (SAMPLE_STEP / 2) ** 2 + 1e-9]
            asked *= 4
        return result

    def _distance_nearby(self, z: Points) -> Floats:
        """Distance of places (k,) to the nearest segment with a sample in their cell or one beside it; infinite if there is none."""
        cell, above = cells(np.concatenate([z, self._samples]), NEARBY)
        at, cell = np.split(cell, [len(z)])
        # Of the samples of a segment one in each cell is enough.
        some = np.flatnonzero((np.diff(cell, prepend=-1) != 0) | (np.diff(self._owner, prepend=-1) != 0))
        some = some[np.argsort(cell[some])]
        owner, cell = self._owner[some], cell[some]
        result = np.full(len(z), np.inf)
        # Cell by cell, a few at a time: what lies near is in the cache, and the pairs of all would take many times the memory of the mesh.
        order = np.argsort(at)
        for block in blocks(len(z), PLACES_AT_ONCE):
            place, other = pairs_across(order[block], at[order[block]], owner, cell, above)
            # Those of one place stand side by side, in each of three rows of cells; a segment often comes again in the next cell.
            new = np.diff(place, prepend=-1) != 0
            fresh = np.flatnonzero(new | (np.diff(other, prepend=-1) != 0))
            place, other, first = place[fresh], other[fresh], np.flatnonzero(new[fresh])
            if len(place):
                found = to_segment(z[place], self._a[other], self._b[other])
                np.minimum.at(result, place[first], np.minimum.reduceat(found, first))
        return result


def hausdorff(one: SegmentSet, other: SegmentSet) -> tuple[float, Floats]:
    """Two-sided distance of the outlines and the curves of a mesh, and the place that is farthest."""
    there, back = one.places, other.places
    if not len(back):
        raise MeshError("report: expected a mesh with a boundary, found one folded upon itself, with two triangles at every edge")
    far = other.distance(there), one.distance(back)
    side = int(far[1].max() >= far[0].max())
    at = int(np.argmax(far[side]))
    return float(far[side][at]), (there, back)[side][at]


def wrong_pixels(plane: Floats, triangles: Ints, number: Ints, curves: SegmentSet, origin: Provenance) -> Floats:
    """Pixel centres in a wrong region, as far as the tolerance or farther from the edge of the mesh.

    Dense outlines have all centres on their right side, so within the tolerance of these no edge passes one by as much.
    """
    far = np.flatnonzero(curves.distance(origin.pixels) > (origin.tolerance or 0.0) - JUST_WITHIN)
    if not len(far):
        return np.zeros((0, 2))
    found = np.zeros(len(far), np.int64)
    z, p = as_complex(plane), as_complex(origin.pixels[far])
    # Few triangles hold a pixel centre beside an outline: find them by their size, then by their three sides.
    near = _near(z, triangles, p)
    triangle, pixel = _around(z[triangles[near]], p)
    triangle = near[triangle]
    for k in range(3):
        a, b = z[triangles[triangle, k]], z[triangles[triangle, (k + 1) % 3]]
        inside = cross(b - a, p[pixel] - a) >= 0
        triangle, pixel = triangle[inside], pixel[inside]
    found[pixel] = number[triangle]
    return np.asarray(origin.pixels[far[found != origin.pixel_regions[far]]])


def _around(corners: Points, places: Points) -> tuple[Ints, Ints]:
    """Pair triangles, given by corners (t, 3), with those of the places (k,) that are no farther from their middle than a corner is."""
    middle = corners.mean(axis=1)
    reach = np.abs(corners - middle[:, None]).max(axis=1) * (1 + 1e-9)
    size, found = np.ceil(np.log2(reach)), [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    for each in np.unique(size).tolist():
        own = np.flatnonzero(size == each)
        cell, above = cells(np.concatenate([middle[own], places]), float(reach[own].max()))
        at, cell = np.split(cell, [len(own)])
        order = np.argsort(cell)
        cell = cell[order]
        for some in blocks(len(own), PLACES_AT_ONCE):
            triangle, place = pairs_across(own[some], at[some], order, cell, above)
            close = np.abs(places[place] - middle[triangle]) <= reach[triangle]
            found.append((triangle[close], place[close]))
    triangle, place = (np.concatenate(part) for part in zip(*found, strict=True))
    return triangle, place


def _near(z: Points, triangles: Ints, places: Points) -> Ints:
    """Triangles that may hold one of some places: those large or near one, by squares of a grid as wide as most triangles."""
    corner, size = np.empty(len(triangles), np.complex128), np.empty(len(triangles))
    for block in blocks(len(triangles)):
        a, b, c = z[np.ascontiguousarray(triangles[block].T)]
        corner[block], size[block] = a, np.maximum(np.abs(b - a), np.abs(c - a))  # no place is farther from the first corner
    both = np.concatenate([z, places])  # a mesh may lie to one side of the places
    low = complex(both.real.min(), both.imag.min())
    extent = float(max(np.ptp(both.real), np.ptp(both.imag)))
    width = max(2 * float(size.mean()), extent / MOST_SQUARES)
    columns = int(extent / width) + 5

    def square(at: Points) -> Ints:
        return ((at.imag - low.imag) / width + 1).astype(np.int64) * columns + ((at.real - low.real) / width + 1).astype(np.int64)

    marked, hit = np.zeros(columns * columns, bool), np.unique(square(places))
    for up in (-columns, 0, columns):
        for right in (-1, 0, 1):
            marked[hit + up + right] = True
    near = size > width
    for block in blocks(len(triangles)):
        near[block] |= marked[square(corner[block])]
    return np.flatnonzero(near)
