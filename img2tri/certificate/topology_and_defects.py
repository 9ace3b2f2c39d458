"""Whether a mesh is valid and hangs together as its image does: components, holes and neighbours of regions, and defects.

In: triangles with the region number of each. Out: counts, found and expected. Components are counted on the graph of triangles, holes by
Euler's formula, vertices - edges + triangles = components - holes.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, cross
from img2tri.certificate.edge_sides import EdgeSides
from img2tri.shapes.polygons import region_rings
from img2tri.triangles.connected_faces import connected_faces
from img2tri.types import Outlines

GOLDEN_RATIO = (1 + 5**0.5) / 2


def topology(triangles: Ints, number: Ints, sides: EdgeSides, outlines: Outlines) -> dict[int, dict[str, tuple[int, int]]]:
    """Components and holes of each label, in the mesh and in the image."""
    r, size = region_rings(outlines), len(outlines.labels)
    outer = np.bincount(r.regions[r.areas > 0], minlength=size)
    inner = np.bincount(r.regions[r.areas <= 0], minlength=size)
    # Euler: components - holes = vertices - edges + triangles, region by region; an edge or vertex counts for each region it has.
    n_vertices = _different(triangles.ravel(), np.repeat(number, 3), size)
    n_edges = _different(sides.sides, np.repeat(number, 3), size)
    euler = n_vertices - n_edges + np.bincount(number, minlength=size)
    # Triangles of one region on both sides of an edge hang together.
    first, last = sides.first // 3, sides.last // 3
    joined = (sides.counts == 2) & (number[first] == number[last])
    beyond = np.full(3 * len(triangles), -1, np.int32)
    beyond[sides.first[joined]], beyond[sides.last[joined]] = last[joined], first[joined]
    face = connected_faces(beyond.reshape(-1, 3))
    region_of_face = np.zeros(int(face.max(initial=-1)) + 1, np.int64)
    region_of_face[face] = number
    components = np.bincount(region_of_face, minlength=size)
    return {
        label: {"found": (int(components[i]), int(components[i] - euler[i])), "expected": (int(outer[i]), int(inner[i]))}
        for i, label in enumerate(outlines.labels.tolist())
        if i
    }


def _different(items: Ints, owner: Ints, size: int) -> Ints:
    """How many different items each of so many owners has, given pairs of items and owners."""
    one = np.full(int(items.max(initial=-1)) + 1, -1)
    one[items] = owner
    others = np.flatnonzero(one[items] != owner)
    pairs = np.unique(items[others] * size + owner[others])
    return np.bincount(one[one >= 0], minlength=size) + np.bincount(pairs % size, minlength=size)


def neighbours(number: Ints, sides: EdgeSides, outlines: Outlines) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Pairs of labels that should touch and do not, and the other way round."""
    size = len(outlines.labels)
    found = _pairs(*sides.span(number), size)
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


def defects(vertices: Floats, triangles: Ints, regions: Ints, sides: EdgeSides) -> dict[str, int]:
    """Count what must not be in a valid mesh."""
    z = as_complex(vertices)
    a, b, c = z[triangles].T
    area = cross(b - a, c - a) / 2
    flat = np.abs(area) <= 1e-12 * np.maximum(np.abs(b - a), np.abs(c - a)) ** 2
    used = np.zeros(len(z), bool)
    used[triangles] = True
    return {
        "inverted": int((area < 0).sum()),
        "degenerate": int(flat.sum()),
        "nonmanifold_edges": int((sides.counts > 2).sum()),
        "pinched_vertices": _pinched(regions, sides),
        "duplicate_vertices": _repeated(z),
        "unused_vertices": len(z) - int(np.count_nonzero(used)),
    }


def _pinched(regions: Ints, sides: EdgeSides) -> int:
    """Count vertices in which the mesh, or a region, touches itself: where more than two of its own border edges meet."""
    border = sides.edges[sides.counts == 1]
    pinched = int((np.bincount(border.ravel()) > 2).sum())
    # An edge inside of a region has two of its triangles; only at the others is there something to count.
    inside: Bools = (sides.counts == 2) & (regions[sides.first // 3] == regions[sides.last // 3])
    side = np.flatnonzero(~inside[sides.sides])
    owner = np.unique(regions[side // 3], return_inverse=True)[1]
    size = int(owner.max(initial=0)) + 1
    key, copies = np.unique(sides.sides[side] * size + owner, return_counts=True)
    edge, region = np.divmod(key[copies == 1], size)
    corners = sides.edges[edge].ravel() * size + np.repeat(region, 2)
    return max(pinched, int((np.unique(corners, return_counts=True)[1] > 2).sum()))


def _repeated(z: Points) -> int:
    """Count vertices that lie where another one does."""
    # Places that are the same have the same sum; few others have.
    total = z.real + GOLDEN_RATIO * z.imag
    order = np.sort(total)
    if (order[1:] != order[:-1]).all():
        return 0
    return len(z) - len(np.unique(z))
