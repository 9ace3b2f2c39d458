"""Whether a mesh is valid and hangs together as its image does: components, holes and neighbours of regions, and defects.

In: triangles with the region number of each. Out: counts, found and expected. Components are counted on the graph of triangles, holes by
Euler's formula, vertices - edges + triangles = components - holes.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, blocks, cross
from img2tri.certificate.edge_sides import EdgeSides
from img2tri.shapes.polygons import region_rings
from img2tri.triangles.connected_faces import connected_faces
from img2tri.types import Outlines

GOLDEN_RATIO = (1 + 5**0.5) / 2


def topology(triangles: Ints, number: Ints, sides: EdgeSides, curves: Bools, outlines: Outlines) -> dict[int, dict[str, tuple[int, int]]]:
    """Components and holes of each label, in the mesh and in the image; `curves` (e,) are the edges not inside of a region."""
    r, size = region_rings(outlines), len(outlines.labels)
    outer = np.bincount(r.regions[r.areas > 0], minlength=size)
    inner = np.bincount(r.regions[r.areas <= 0], minlength=size)
    # Euler: components - holes = vertices - edges + triangles, region by region; an edge or vertex counts for each region it has.
    n_triangles, border = np.bincount(number, minlength=size), sides.among(curves)
    owner = number[border.sides // 3]
    n_edges = (3 * n_triangles - np.bincount(owner, minlength=size)) // 2  # inside, each has two sides
    n_edges += np.bincount(np.unique(border.edge * size + owner) % size, minlength=size)
    euler = _vertices(triangles, number, size) - n_edges + n_triangles
    # Triangles on both sides of an edge inside of a region hang together.
    first, last = (side[~curves] for side in sides.at_both_ends())
    beyond = np.full(3 * len(triangles), -1, np.int32)
    beyond[first], beyond[last] = last // 3, first // 3
    face = connected_faces(beyond.reshape(-1, 3))
    region_of_face = np.zeros(int(face.max(initial=-1)) + 1, np.int64)
    region_of_face[face] = number
    components = np.bincount(region_of_face, minlength=size)
    return {
        label: {"found": (int(components[i]), int(components[i] - euler[i])), "expected": (int(outer[i]), int(inner[i]))}
        for i, label in enumerate(outlines.labels.tolist())
        if i
    }


def _vertices(triangles: Ints, number: Ints, size: int) -> Ints:
    """Return how many vertices each region number has; those of several regions count for each."""
    one = np.full(int(triangles.max(initial=-1)) + 1, -1)
    for corner in triangles.T:
        one[corner] = number
    pairs = [np.zeros(0, np.int64)]
    for corner in triangles.T:
        others = (one[corner] != number).nonzero()[0]
        pairs.append(corner[others] * size + number[others])
    return np.bincount(one[one >= 0], minlength=size) + np.bincount(np.unique(np.concatenate(pairs)) % size, minlength=size)


def neighbours(number: Ints, border: EdgeSides, outlines: Outlines) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Pairs of labels that should touch and do not, and the other way round; `border` has all edges between regions."""
    size = len(outlines.labels)
    owner = number[border.sides // 3]
    low, high = (extreme.reduceat(owner, border.starts[:-1]) if len(owner) else owner for extreme in (np.minimum, np.maximum))
    found = _pairs(low, high, size)
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


def defects(vertices: Floats, triangles: Ints, regions: Ints, border: EdgeSides) -> dict[str, int]:
    """Count what must not be in a valid mesh; `border` has all edges but those inside of a region."""
    z, inverted, flat = as_complex(vertices), 0, 0
    for block in blocks(len(triangles)):
        a, b, c = z[np.ascontiguousarray(triangles[block].T)]
        one, other = b - a, c - a
        area = cross(one, other) / 2
        flat += int((np.abs(area) <= 1e-12 * np.maximum(np.abs(one), np.abs(other)) ** 2).sum())
        inverted += int((area < 0).sum())
    used = np.zeros(len(z), bool)
    used[triangles] = True
    return {
        "inverted": inverted,
        "degenerate": flat,
        "nonmanifold_edges": int((border.counts > 2).sum()),
        "pinched_vertices": _pinched(regions, border),
        "duplicate_vertices": _repeated(z),
        "unused_vertices": len(z) - int(np.count_nonzero(used)),
    }


def _pinched(regions: Ints, border: EdgeSides) -> int:
    """Count vertices in which the mesh, or a region, touches itself: where more than two of its own border edges meet."""
    edges = border.edges
    pinched = int((np.bincount(edges[border.counts == 1].ravel()) > 2).sum())
    owner = np.unique(regions[border.sides // 3], return_inverse=True)[1]
    size = int(owner.max(initial=0)) + 1
    key, copies = np.unique(border.edge * size + owner, return_counts=True)
    edge, region = np.divmod(key[copies == 1], size)
    corners = edges[edge].ravel() * size + np.repeat(region, 2)
    return max(pinched, int((np.unique(corners, return_counts=True)[1] > 2).sum()))


def _repeated(z: Points) -> int:
    """Count vertices that lie where another one does."""
    # Places that are the same have the same sum; few others have. Rows of a lattice are sorted already, which a stable sort is glad of.
    order = np.sort(z.real + GOLDEN_RATIO * z.imag, kind="stable")
    if (order[1:] != order[:-1]).all():
        return 0
    return len(z) - len(np.unique(z))
