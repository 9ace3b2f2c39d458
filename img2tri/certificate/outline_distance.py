"""How far the curves of a mesh are from the outlines of its image: two-sided Hausdorff distance, and pixels on the wrong side.

In: segments, the boundary and interface edges of a mesh or the outlines of an image, in the plane of the frame, in pixels. Out: distances
and places. Distances are measured at samples `SAMPLE_STEP` apart, to the segments themselves, found by an R-tree.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, runs
from img2tri.errors import MeshError
from img2tri.types import Provenance

SAMPLE_STEP = 0.5  # px between the samples that distances are measured at


class SegmentSet:
    """A set of segments, to measure distances to."""

    def __init__(self, points: Floats, segments: Ints) -> None:
        import shapely

        self.points, self.segments = points, segments
        self.ends = points[segments]
        self.tree = shapely.STRtree(shapely.linestrings(self.ends))

    def distance(self, places: Floats) -> Floats:
        """Distance of places (k, 2) to the nearest segment."""
        import shapely

        result: Floats = self.tree.query_nearest(shapely.points(places), return_distance=True, all_matches=False)[1]
        return result

    def within(self, places: Floats, distance: float) -> Bools:
        """Tell which places (k, 2) lie within a distance of the nearest segment."""
        import shapely

        result = np.zeros(len(places), bool)
        result[self.tree.query(shapely.points(places), predicate="dwithin", distance=distance)[0]] = True
        return result

    def samples(self) -> Floats:
        """Places on the segments, ends included, at most `SAMPLE_STEP` apart."""
        a, b = self.ends[:, 0], self.ends[:, 1]
        pieces = np.maximum(np.ceil(np.hypot(*(b - a).T) / SAMPLE_STEP).astype(np.int64), 1)
        which, place = runs(pieces - 1)
        share = (1 + place) / pieces[which]
        ends = np.zeros(len(self.points), bool)
        ends[self.segments] = True
        return np.concatenate([a[which] + share[:, None] * (b - a)[which], self.points[ends]])


def hausdorff(one: SegmentSet, other: SegmentSet) -> tuple[float, Floats]:
    """Two-sided distance of the outlines and the curves of a mesh, and the place that is farthest."""
    there, back = one.samples(), other.samples()
    if not len(back):
        raise MeshError("report: expected a mesh with a boundary, found one folded upon itself, with two triangles at every edge")
    far = other.distance(there), one.distance(back)
    side = int(far[1].max() >= far[0].max())
    at = int(np.argmax(far[side]))
    return float(far[side][at]), (there, back)[side][at]


def wrong_pixels(plane: Floats, triangles: Ints, number: Ints, curves: SegmentSet, origin: Provenance) -> Floats:
    """Pixel centres in a wrong region, farther than the tolerance from the edge of the mesh."""
    import shapely
    from scipy.spatial import cKDTree

    far = np.flatnonzero(~curves.within(origin.pixels, (origin.tolerance or 0.0) + 1e-9))
    if not len(far):
        return np.zeros((0, 2))
    found = np.zeros(len(far), np.int64)
    corners = plane[triangles]
    # Few triangles hold a pixel centre beside an outline: find them by their size, by their boxes, then by their three sides.
    middle = corners.mean(axis=1)
    reach = np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=2).max(axis=1))
    nearest = cKDTree(origin.pixels[far]).query(middle, distance_upper_bound=float(reach.max()) * (1 + 1e-9) + 1e-9)[0]
    near = np.flatnonzero(nearest <= reach * (1 + 1e-9))
    low, high = corners[near].min(axis=1), corners[near].max(axis=1)
    tree = shapely.STRtree(shapely.points(origin.pixels[far]))
    box, pixel = tree.query(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
    inside, box = np.ones(len(box), bool), near[box]
    p = origin.pixels[far[pixel]]
    for k in range(3):
        a, b = corners[box, k], corners[box, (k + 1) % 3]
        inside &= (b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) >= (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0])
    found[pixel[inside]] = number[box[inside]]
    return np.asarray(origin.pixels[far[found != origin.pixel_regions[far]]])
