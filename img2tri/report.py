"""The certificate: what a finished mesh keeps of what was promised, in numbers.

In: the finished mesh and its `Origin`. Out: a `Report`. Nothing is taken over from the making of the mesh: distances, areas,
topology and angles are measured on its triangles, and compared with the outlines and the pixels of the image.

Lengths in a report are world units, angles degrees, areas world units squared.
"""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from img2tri.records import Floats, Frame, Ints, Origin, Outlines
from img2tri.shapes.polygons import rings
from img2tri.triangles.quality import measure
from img2tri.triangles.topology import boundary_edges, curve_edges, unique_edges

STEP = 0.25  # px between the samples that distances are measured at
EXCEPTIONS = 20  # places listed at most


@dataclass(frozen=True)
class Report:
    """What a mesh keeps of what was promised.

    Attributes
    ----------
    recipe, settings, counted
        How the mesh was made: all options, what was chosen, what was counted on the way.
    n_vertices, n_triangles
        Counts.
    hausdorff, tolerance
        Two-sided distance between the outlines and the boundary and interface edges of the mesh, and what it may be.
    areas
        For each label the area of its triangles, of its pixels, and the relative error.
    topology
        For each label (components, holes) as found in the mesh and as expected from the image.
    neighbours_missing, neighbours_extra
        Pairs of labels that touch in the image but not in the mesh, and the other way round.
    wrong_pixels
        Number of pixel centres beside the outlines that lie in a wrong region, farther than the tolerance from its edge.
    inverted, degenerate, nonmanifold_edges, pinched_vertices, duplicate_vertices, unused_vertices
        Number of defects; 0 in a valid mesh.
    smallest_angle, smallest_angle_at
        The worst angle and where it is.
    narrow
        Number of triangles with an angle below `min_angle`, and places of the first of them.
    warnings
        One line for each promise that is not kept, with its place.
    """

    recipe: str
    settings: dict[str, Any]
    counted: dict[str, Any]
    n_vertices: int
    n_triangles: int
    hausdorff: float
    tolerance: float | None
    areas: dict[int, dict[str, float]]
    topology: dict[int, dict[str, tuple[int, int]]]
    neighbours_missing: list[tuple[int, int]]
    neighbours_extra: list[tuple[int, int]]
    wrong_pixels: int
    inverted: int
    degenerate: int
    nonmanifold_edges: int
    pinched_vertices: int
    duplicate_vertices: int
    unused_vertices: int
    smallest_angle: float
    smallest_angle_at: tuple[float, float]
    min_angle: float | None
    narrow: int
    narrow_at: list[tuple[float, float]]
    warnings: list[str]

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain data."""
        return dataclasses.asdict(self)

    def to_json(self, indent: int | None = 2) -> str:
        """Return the report as JSON."""
        return json.dumps(self.to_dict(), indent=indent, default=str)

    @property
    def kept(self) -> bool:
        """Whether every promise is kept."""
        return not self.warnings


def certify(vertices: Floats, triangles: Ints, regions: Ints, frame: Frame, origin: Origin) -> Report:
    """Judge a mesh by the image it was made from.

    Parameters
    ----------
    vertices, triangles, regions
        The mesh: (n, 2) float64 in world coordinates, (m, 3) int64, (m,) int64 labels of the image.
    frame, origin
        Where the image lies, and what the mesh is to be judged by.
    """
    plane = (vertices - frame.corner) / frame.pixel
    outlines = origin.outlines
    known = outlines.labels[1:]
    number = np.searchsorted(known, regions) + 1 if len(known) else np.zeros(len(regions), np.int64)
    curves = curve_edges(triangles, regions)
    to_mesh = _Nearest(plane, curves)
    segments = outlines.segments[0]
    there = to_mesh.distance(_samples(outlines.points, segments))
    places = _samples(plane, curves)
    back = _Nearest(outlines.points, segments).distance(places)
    wrong = _wrong_pixels(plane, triangles, number, to_mesh, origin)
    angle = measure(vertices, triangles, ["min_angle"])["min_angle"]
    area = _areas(plane, triangles, number, origin) | {}
    worst = int(np.argmin(angle))
    narrow = np.flatnonzero(angle < origin.min_angle - 1e-9) if origin.min_angle is not None else np.zeros(0, np.int64)
    middles = vertices[triangles].mean(axis=1)
    missing, extra = _neighbours(triangles, number, outlines)
    facts: dict[str, Any] = {
        "hausdorff": float(max(there.max(), back.max())) * frame.pixel,
        "tolerance": None if origin.tolerance is None else origin.tolerance * frame.pixel,
        "areas": {label: {k: v * (frame.pixel**2 if k != "error" else 1) for k, v in row.items()} for label, row in area.items()},
        "topology": _topology(triangles, number, outlines),
        "neighbours_missing": missing,
        "neighbours_extra": extra,
        "wrong_pixels": len(wrong),
        **_defects(vertices, triangles, regions),
        "smallest_angle": float(angle[worst]),
        "smallest_angle_at": _place(middles[worst]),
        "min_angle": origin.min_angle,
        "narrow": len(narrow),
        "narrow_at": [_place(p) for p in middles[narrow[:EXCEPTIONS]]],
    }
    farthest = places[np.argmax(back)] if back.max() >= there.max() else _samples(outlines.points, segments)[np.argmax(there)]
    warnings = _warnings(facts, frame.world(farthest), frame.world(wrong[:1]))
    return Report(origin.recipe, origin.settings, origin.counted, len(vertices), len(triangles), **facts, warnings=warnings)


def _warnings(facts: dict[str, Any], farthest: Floats, wrong: Floats) -> list[str]:
    """One line for each promise that is not kept."""
    lines = [f"{name}: {facts[name]}" for name in DEFECTS if facts[name]]
    lines += [f"label {v}: {t['found'][0]} components with {t['found'][1]} holes, expected {t['expected'][0]} with {t['expected'][1]}"
              for v, t in facts["topology"].items() if t["found"] != t["expected"]]
    lines += [f"labels {a} and {b} touch in the image, not in the mesh" for a, b in facts["neighbours_missing"]]
    lines += [f"labels {a} and {b} touch in the mesh, not in the image" for a, b in facts["neighbours_extra"]]
    if facts["tolerance"] is not None and facts["hausdorff"] > facts["tolerance"] * (1 + 1e-9):
        lines.append(f"outline and mesh are {facts['hausdorff']:.4g} apart at {_place(farthest)}, tolerance {facts['tolerance']:.4g}")
    if facts["wrong_pixels"]:
        lines.append(f"{facts['wrong_pixels']} pixel centres lie in a wrong region, the first at {_place(wrong[0])}")
    if facts["narrow"]:
        at = facts["smallest_angle_at"]
        lines.append(f"{facts['narrow']} triangles below {facts['min_angle']:g} degrees, the worst {facts['smallest_angle']:.4g} at {at}")
    return lines


def _place(xy: Floats) -> tuple[float, float]:
    return round(float(xy[0]), 6), round(float(xy[1]), 6)


class _Nearest:
    """Nearest points on a set of segments."""

    def __init__(self, points: Floats, segments: Ints) -> None:
        import shapely

        self.ends = points[segments]
        self.tree = shapely.STRtree(shapely.linestrings(self.ends))

    def distance(self, places: Floats) -> Floats:
        """Distance of places (k, 2) to the nearest segment."""
        return self.query(places)[1]

    def query(self, places: Floats) -> tuple[Ints, Floats]:
        """Return the index of the nearest segment, and its distance, for places (k, 2)."""
        import shapely

        if not len(places):
            return np.zeros(0, np.int64), np.zeros(0)
        (_, index), distance = self.tree.query_nearest(shapely.points(places), return_distance=True, all_matches=False)
        return index, distance


def _samples(points: Floats, segments: Ints) -> Floats:
    """Places on segments, ends included, at most `STEP` apart."""
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    count = np.maximum(np.ceil(np.hypot(*(b - a).T) / STEP).astype(np.int64), 1)
    which = np.repeat(np.arange(len(a)), count)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / count[which]
    return np.concatenate([a[which] + share[:, None] * (b - a)[which], b])


def _wrong_pixels(plane: Floats, triangles: Ints, number: Ints, to_mesh: _Nearest, origin: Origin) -> Floats:
    """Pixel centres in a wrong region, farther than the tolerance from the edge of the mesh."""
    import shapely

    distance = to_mesh.distance(origin.pixels)
    far = np.flatnonzero(distance > (origin.tolerance or 0.0) + 1e-9)
    found = np.zeros(len(far), np.int64)
    corners = plane[triangles]
    tree = shapely.STRtree(shapely.points(origin.pixels[far]))
    low, high = corners.min(axis=1), corners.max(axis=1)
    # Few triangles hold a pixel centre beside an outline: find them by their boxes, then by their three sides.
    box, pixel = tree.query(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
    inside = np.ones(len(box), bool)
    p = origin.pixels[far[pixel]]
    for k in range(3):
        a, b = corners[box, k], corners[box, (k + 1) % 3]
        inside &= (b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) >= (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0])
    found[pixel[inside]] = number[box[inside]]
    return origin.pixels[far[found != origin.pixel_regions[far]]]


def _areas(plane: Floats, triangles: Ints, number: Ints, origin: Origin) -> dict[int, dict[str, float]]:
    """Area of each label in the mesh and in the image, and the relative error."""
    z = plane[:, 0] + 1j * plane[:, 1]
    a, b, c = z[triangles].T
    found = np.bincount(number, ((b - a).conj() * (c - a)).imag / 2, len(origin.areas))
    labels = origin.outlines.labels.tolist()
    return {labels[i]: {"mesh": float(found[i]), "image": float(origin.areas[i]), "error": float(found[i] / origin.areas[i] - 1)}
            for i in range(1, len(labels))}


def _topology(triangles: Ints, number: Ints, outlines: Outlines) -> dict[int, dict[str, tuple[int, int]]]:
    """Components and holes of each label, in the mesh and in the image."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    r, size = rings(outlines), len(outlines.labels)
    outer = np.bincount(r.regions[r.areas > 0], minlength=size)
    inner = np.bincount(r.regions[r.areas <= 0], minlength=size)
    # Euler: components - holes = vertices - edges + triangles, region by region; an edge or vertex counts for each region it has.
    edges, inverse, _ = unique_edges(triangles)
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
    return {label: {"found": (int(components[i]), int(components[i] - euler[i])), "expected": (int(outer[i]), int(inner[i]))}
            for i, label in enumerate(outlines.labels.tolist()) if i}


def _neighbours(triangles: Ints, number: Ints, outlines: Outlines) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Pairs of labels that should touch and do not, and the other way round."""
    size = len(outlines.labels)
    _, inverse, _ = unique_edges(triangles)
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


def _defects(vertices: Floats, triangles: Ints, regions: Ints) -> dict[str, int]:
    """Count what must not be in a valid mesh."""
    z = vertices[:, 0] + 1j * vertices[:, 1]
    a, b, c = z[triangles].T
    area = ((b - a).conj() * (c - a)).imag / 2
    flat = np.abs(area) <= 1e-12 * np.maximum(np.abs(b - a), np.abs(c - a)) ** 2
    _, inverse, counts = unique_edges(triangles)
    # A region touches itself in a vertex where more than two of its own border edges meet.
    ends = boundary_edges(triangles)
    pinched = int((np.bincount(ends.reshape(-1)) > 2).sum())
    owner = np.repeat(np.unique(regions, return_inverse=True)[1], 3)
    key, copies = np.unique(inverse * (owner.max() + 1) + owner, return_counts=True)
    edge, region = np.divmod(key[copies == 1], owner.max() + 1)
    corners = unique_edges(triangles)[0][edge].reshape(-1) * (owner.max() + 1) + np.repeat(region, 2)
    pinched = max(pinched, int((np.unique(corners, return_counts=True)[1] > 2).sum()))
    return {
        "inverted": int((area < 0).sum()),
        "degenerate": int(flat.sum()),
        "nonmanifold_edges": int((counts > 2).sum()),
        "pinched_vertices": pinched,
        "duplicate_vertices": len(z) - len(np.unique(z)),
        "unused_vertices": len(z) - len(np.unique(triangles)),
    }
