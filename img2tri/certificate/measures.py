"""What a certificate is made of: distances, areas, topology and defects of a mesh, measured on its triangles.

Everything is in the plane of the frame, in pixels; `report` turns it into world units and says what is wrong.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import unique_edges
from img2tri.errors import MeshError
from img2tri.shapes.polygons import rings
from img2tri.triangles.tools.topology import boundary_edges
from img2tri.types import Bools, Floats, Ints, Origin, Outlines

STEP = 0.5  # px between the samples that distances are measured at


class Curves:
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
        """Places on the segments, ends included, at most `STEP` apart."""
        a, b = self.ends[:, 0], self.ends[:, 1]
        pieces = np.maximum(np.ceil(np.hypot(*(b - a).T) / STEP).astype(np.int64), 1)
        count = pieces - 1
        which = np.repeat(np.arange(len(a)), count)
        share = (1 + np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / pieces[which]
        ends = np.zeros(len(self.points), bool)
        ends[self.segments] = True
        return np.concatenate([a[which] + share[:, None] * (b - a)[which], self.points[ends]])


def numbers(regions: Ints, labels: Ints) -> tuple[Ints, list[int]]:
    """Region number (m,) of each triangle, 0 where the image has no such label, and these labels."""
    at = np.minimum(np.searchsorted(labels[1:], regions) + 1, len(labels) - 1)
    known = labels[at] == regions
    return np.where(known, at, 0), np.unique(regions[~known]).tolist()


def hausdorff(one: Curves, other: Curves) -> tuple[float, Floats]:
    """Two-sided distance of the outlines and the curves of a mesh, and the place that is farthest."""
    there, back = one.samples(), other.samples()
    if not len(back):
        raise MeshError("report: expected a mesh with a boundary, found one folded upon itself, with two triangles at every edge")
    far = other.distance(there), one.distance(back)
    side = int(far[1].max() >= far[0].max())
    at = int(np.argmax(far[side]))
    return float(far[side][at]), (there, back)[side][at]


def wrong_pixels(plane: Floats, triangles: Ints, number: Ints, curves: Curves, origin: Origin) -> Floats:
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


def areas(plane: Floats, triangles: Ints, number: Ints, origin: Origin, pixel: float) -> dict[int, dict[str, float]]:
    """Area of each label in the mesh and in the image, in world units squared, and the relative error."""
    found = _moments(plane, triangles, number, len(origin.areas))[0] * pixel**2
    wanted = origin.areas * pixel**2
    return {
        label: {"mesh": float(found[i]), "image": float(wanted[i]), "error": float(found[i] / wanted[i] - 1)}
        for i, label in enumerate(origin.outlines.labels.tolist())
        if i
    }


def displaced(plane: Floats, triangles: Ints, number: Ints, origin: Origin) -> list[int]:
    """Labels that lie elsewhere than in the image, by more than outlines within the tolerance of each other explain.

    An outline moved by t moves the first moment of its region about a point by t times the sum of length x distance, at most.
    """
    o, size = origin.outlines, len(origin.areas)
    segments, left, right = o.segments
    a, b = (o.points[segments[:, k], 0] + 1j * o.points[segments[:, k], 1] for k in (0, 1))
    sweep = (a.conj() * b).imag / 2
    parts = (sweep, sweep * (a + b).real / 3, sweep * (a + b).imag / 3)
    area, mx, my = (np.bincount(left, part, size) - np.bincount(right, part, size) for part in parts)
    centre = (mx + 1j * my) / np.where(area, area, 1)
    found, fx, fy = _moments(plane, triangles, number, size)
    off = np.abs(fx + 1j * fy - found * centre)
    reach = np.zeros(size)
    for side in (left, right):
        reach += np.bincount(side, np.abs(b - a) * (np.abs((a + b) / 2 - centre[side]) + 1), size)
    limit = 2 * max(origin.tolerance or 0.0, 0.5) * reach
    return [int(label) for label in o.labels[1:][(off > limit)[1:]]]


def _moments(plane: Floats, triangles: Ints, number: Ints, size: int) -> tuple[Floats, Floats, Floats]:
    """Area of each region number in the mesh, and the integrals of x and y over it."""
    a, b, c = (plane[:, 0] + 1j * plane[:, 1])[triangles].T
    area, middle = ((b - a).conj() * (c - a)).imag / 2, (a + b + c) / 3
    parts = area, area * middle.real, area * middle.imag
    first, second, third = (np.asarray(np.bincount(number, part, size), np.float64) for part in parts)
    return first, second, third


def topology(triangles: Ints, number: Ints, outlines: Outlines) -> dict[int, dict[str, tuple[int, int]]]:
    """Components and holes of each label, in the mesh and in the image."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    r, size = rings(outlines), len(outlines.labels)
    outer = np.bincount(r.regions[r.areas > 0], minlength=size)
    inner = np.bincount(r.regions[r.areas <= 0], minlength=size)
    # Euler: components - holes = vertices - edges + triangles, region by region; an edge or vertex counts for each region it has.
    inverse = unique_edges(triangles)[1].ravel()
    owner = np.repeat(number, 3)
    n_vertices = np.bincount(np.unique(triangles.reshape(-1) * size + owner) % size, minlength=size)
    n_edges = np.bincount(np.unique(inverse * size + owner) % size, minlength=size)
    euler = n_vertices - n_edges + np.bincount(number, minlength=size)
    # Triangles of one region on both sides of an edge hang together.
    order = np.lexsort((owner, inverse))
    twin = np.flatnonzero((np.diff(inverse[order]) == 0) & (np.diff(owner[order]) == 0))
    one, other = order[twin] // 3, order[twin + 1] // 3
    graph = csr_array((np.ones(len(one), np.int8), (one, other)), shape=(len(triangles),) * 2)
    _, part = connected_components(graph, directed=False)
    first = np.unique(part, return_index=True)[1]
    components = np.bincount(number[first], minlength=size)
    return {
        label: {"found": (int(components[i]), int(components[i] - euler[i])), "expected": (int(outer[i]), int(inner[i]))}
        for i, label in enumerate(outlines.labels.tolist())
        if i
    }


def neighbours(triangles: Ints, number: Ints, outlines: Outlines) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Pairs of labels that should touch and do not, and the other way round."""
    size = len(outlines.labels)
    inverse = unique_edges(triangles)[1].ravel()
    owner = np.repeat(number, 3)
    order = np.argsort(inverse, kind="stable")
    same = np.flatnonzero(np.diff(inverse[order]) == 0)
    found = _pairs(owner[order[same]], owner[order[same + 1]], size)
    expected = _pairs(outlines.left, outlines.right, size)
    labels = outlines.labels.tolist()

    def named(pairs: Ints) -> list[tuple[int, int]]:
        return [(labels[p // size], labels[p % size]) for p in pairs.tolist()]

    return named(np.setdiff1d(expected, found)), named(np.setdiff1d(found, expected))


def _pairs(a: Ints, b: Ints, size: int) -> Ints:
    """Different pairs of two different regions, each as one number."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    return np.unique((low * size + high)[(low != high) & (low > 0)])


DEFECTS = ("inverted", "degenerate", "nonmanifold_edges", "pinched_vertices", "duplicate_vertices", "unused_vertices")


def defects(vertices: Floats, triangles: Ints, regions: Ints) -> dict[str, int]:
    """Count what must not be in a valid mesh."""
    z = vertices[:, 0] + 1j * vertices[:, 1]
    a, b, c = z[triangles].T
    area = ((b - a).conj() * (c - a)).imag / 2
    flat = np.abs(area) <= 1e-12 * np.maximum(np.abs(b - a), np.abs(c - a)) ** 2
    edges, sides = unique_edges(triangles)
    inverse, counts = sides.ravel(), np.bincount(sides.ravel())
    # A region touches itself in a vertex where more than two of its own border edges meet.
    ends = boundary_edges(triangles)
    pinched = int((np.bincount(ends.reshape(-1)) > 2).sum())
    owner = np.repeat(np.unique(regions, return_inverse=True)[1], 3)
    key, copies = np.unique(inverse * (owner.max() + 1) + owner, return_counts=True)
    edge, region = np.divmod(key[copies == 1], owner.max() + 1)
    corners = edges[edge].reshape(-1) * (owner.max() + 1) + np.repeat(region, 2)
    pinched = max(pinched, int((np.unique(corners, return_counts=True)[1] > 2).sum()))
    return {
        "inverted": int((area < 0).sum()),
        "degenerate": int(flat.sum()),
        "nonmanifold_edges": int((counts > 2).sum()),
        "pinched_vertices": pinched,
        "duplicate_vertices": len(z) - len(np.unique(z)),
        "unused_vertices": len(z) - len(np.unique(triangles)),
    }
