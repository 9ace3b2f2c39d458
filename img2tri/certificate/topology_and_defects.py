"""Whether a mesh is valid and hangs together as its image does: components, holes and neighbours of regions, and defects.

In: triangles with the region number of each. Out: counts, found and expected. Components are counted on the graph of triangles, holes by
Euler's formula, vertices - edges + triangles = components - holes.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex, cross, unique_edges
from img2tri.shapes.polygons import region_rings
from img2tri.triangles.tools.topology import boundary_edges
from img2tri.types import Outlines


def topology(triangles: Ints, number: Ints, outlines: Outlines) -> dict[int, dict[str, tuple[int, int]]]:
    """Components and holes of each label, in the mesh and in the image."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    r, size = region_rings(outlines), len(outlines.labels)
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
    z = as_complex(vertices)
    a, b, c = z[triangles].T
    area = cross(b - a, c - a) / 2
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
