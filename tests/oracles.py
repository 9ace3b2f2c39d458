"""Truth re-derived: what must hold of a mesh, computed by other means than those that made it.

Lengths are pixels, y up; `labels` is the label map a mesh was made from, `background` the value that is not meshed.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy import ndimage, sparse


def areas(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


def angles(vertices, triangles):
    """All angles (m, 3) in degrees, by the law of cosines."""
    p = vertices[triangles]
    side = np.stack([np.linalg.norm(p[:, (k + 1) % 3] - p[:, (k + 2) % 3], axis=1) for k in range(3)], axis=1)
    a, b, c = side[:, [0, 1, 2]], side[:, [1, 2, 0]], side[:, [2, 0, 1]]
    return np.degrees(np.arccos(np.clip((b**2 + c**2 - a**2) / (2 * b * c), -1, 1)))


def edge_counts(triangles):
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.unique(edges, axis=0, return_counts=True)


def boundary(triangles):
    edges, count = edge_counts(triangles)
    return edges[count == 1]


def interfaces(triangles, regions):
    """Edges between different regions."""
    return np.array([e for e, r in _regions_of_edges(triangles, regions) if len(r) == 2 and len(set(r)) == 2], int).reshape(-1, 2)


def _regions_of_edges(triangles, regions):
    found = {}
    for t, r in zip(triangles.tolist(), np.asarray(regions).tolist(), strict=True):
        for k in range(3):
            found.setdefault(tuple(sorted((t[k], t[(k + 1) % 3]))), []).append(r)
    return found.items()


def pixel_topology(mask, connectivity=4):
    """Components and holes of a mask, pixels joined through sides (or corners too)."""
    cross, full = ndimage.generate_binary_structure(2, 1), np.ones((3, 3))
    own, other = (cross, full) if connectivity == 4 else (full, cross)
    padded = np.pad(mask, 1)
    return ndimage.label(padded, own)[1], ndimage.label(~padded, other)[1] - 1


def mesh_topology(triangles):
    """Components (through edges) and holes."""
    edges, _ = edge_counts(triangles)
    used, renumbered = np.unique(edges, return_inverse=True)
    renumbered = renumbered.reshape(-1, 2)
    graph = sparse.coo_array((np.ones(len(edges)), renumbered.T), shape=(len(used),) * 2)
    components = sparse.csgraph.connected_components(graph, directed=False)[0]
    return components, components - (len(used) - len(edges) + len(triangles))


def pixel_neighbours(labels, background=0):
    """Pairs of meshed labels that share a pixel side."""
    upright, flat = (labels[1:], labels[:-1]), (labels[:, 1:], labels[:, :-1])
    pairs = np.concatenate([np.stack([a.ravel(), b.ravel()]) for a, b in (upright, flat)], axis=1)
    pairs = np.sort(pairs, axis=0)
    keep = pairs[0] != pairs[1]
    if background is not None:
        keep &= (pairs != background).all(axis=0)
    return set(map(tuple, pairs[:, keep].T.tolist()))


def mesh_neighbours(triangles, regions):
    return {tuple(sorted(set(r))) for _, r in _regions_of_edges(triangles, regions) if len(set(r)) == 2}


def pixel_sides(labels, background=0):
    """Sides between pixels of different regions as segments (k, 2, 2), y up."""
    h = labels.shape[0]
    outside = np.iinfo(np.int64).max if background is None else background
    p = np.pad(labels.astype(np.int64), 1, constant_values=outside)
    r, c = np.nonzero(p[1:, 1:-1] != p[:-1, 1:-1])
    flat = np.stack([np.stack([c, h - r], 1), np.stack([c + 1, h - r], 1)], 1)
    r, c = np.nonzero(p[1:-1, 1:] != p[1:-1, :-1])
    upright = np.stack([np.stack([c, h - r], 1), np.stack([c, h - r - 1], 1)], 1)
    return np.concatenate([flat, upright]).astype(float)


def two_sided_distance(one, other, step=0.2):
    """Hausdorff distance between two sets of segments (k, 2, 2), sampled every `step`."""

    def samples(s):
        n = np.maximum(1, np.ceil(np.linalg.norm(s[:, 1] - s[:, 0], axis=1) / step)).astype(int)
        return np.concatenate([a + np.linspace(0, 1, k + 1)[:, None] * (b - a) for (a, b), k in zip(s, n, strict=True)])

    def farthest(s, t):
        _, d = shapely.STRtree(shapely.linestrings(t)).query_nearest(shapely.points(samples(s)), return_distance=True, all_matches=False)
        return d.max()

    return max(farthest(one, other), farthest(other, one))


def check_valid(vertices, triangles):
    """Counter-clockwise, positive areas, manifold, nothing unused or double, no hanging node, no overlap."""
    a = areas(vertices, triangles)
    assert (a > 0).all()
    _, count = edge_counts(triangles)
    assert count.max() <= 2
    assert len(np.unique(triangles)) == len(vertices)
    assert len(np.unique(np.round(vertices, 9), axis=0)) == len(vertices)
    edges = boundary(triangles)
    assert np.unique(edges, return_counts=True)[1].max() == 2, "the mesh touches itself in a vertex"
    lines = vertices[edges]
    on, which = shapely.STRtree(shapely.points(vertices)).query(shapely.linestrings(lines), predicate="dwithin", distance=1e-9)
    assert ((which == edges[on, 0]) | (which == edges[on, 1])).all(), "hanging node"
    enclosed = shapely.build_area(shapely.multilinestrings(lines)).area
    assert abs(a.sum() - enclosed) <= 1e-9 * enclosed, "triangles overlap or are missing"


def check_faithful(vertices, triangles, regions, labels, *, background=0, tolerance=0.5):
    """Topology, neighbours, distance and frame are those of the label map (binary, or labels joined by the documented rule)."""
    values = [v for v in np.unique(labels).tolist() if v != background]
    assert sorted(set(regions.tolist())) == values
    for v in values:
        mine, pixels = triangles[regions == v], labels == v
        got = mesh_topology(mine)
        strict, loose = pixel_topology(pixels, 4), pixel_topology(pixels, 8)
        if len(values) == 1:
            assert got == strict
        assert all(min(s, t) <= g <= max(s, t) for g, s, t in zip(got, strict, loose, strict=True)), (v, got, strict, loose)
        ends = np.unique(boundary(mine), return_counts=True)[1]
        assert ends.max() == 2, "a region touches itself in a vertex"
    assert mesh_neighbours(triangles, regions) == pixel_neighbours(labels, background)
    curves = vertices[np.concatenate([boundary(triangles), interfaces(triangles, regions)])]
    assert two_sided_distance(curves, pixel_sides(labels, background)) <= 2**-0.5 + tolerance + 1e-9
    h, w = labels.shape
    assert vertices.min() >= 0
    assert (vertices.max(axis=0) <= [w, h]).all()
    check_frame(vertices, triangles, np.ones((h, w), bool) if background is None else labels != background)


def check_frame(vertices, triangles, meshed):
    """Along each side of the image the mesh covers the runs of meshed pixels, to half a pixel at their ends."""
    h, w = meshed.shape
    ends = vertices[boundary(triangles)]
    for axis, at, side in ((0, 0, meshed[:, 0]), (0, w, meshed[:, -1]), (1, h, meshed[0]), (1, 0, meshed[-1])):
        on = (np.abs(ends[:, :, axis] - at) < 1e-9).all(axis=1)
        covered = np.abs(np.diff(ends[on][:, :, 1 - axis], axis=1)).sum()
        runs = int((np.diff(side.astype(int)) != 0).sum())
        assert abs(covered - side.sum()) <= 0.5 * runs + 1e-9


def joined_topology(labels, *, background=0, connectivity=4):
    """Components and holes of each label, by the rule for checkerboards: with 4 the lower label is joined, with 8 the higher.

    The label map is drawn twice as large, with the sides and corners of pixels in between. A side belongs to a label if
    both pixels beside it do; a corner, if all four pixels around it do, or the two on the diagonal that is joined::

        a - b        a . b
        - + -   or   . a .      a - b: the side between a and b
        c - d        c . a
    """
    values = [v for v in np.unique(labels).tolist() if v != background]
    number = np.zeros(labels.shape, int)
    for i, v in enumerate(values, start=1):
        number[labels == v] = i
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    falling, rising = (a == d) & (b != a) & (c != a), (b == c) & (a != b) & (d != b)
    pick = np.minimum if connectivity == 4 else np.maximum
    large = np.full([2 * k + 1 for k in labels.shape], -1)
    large[1::2, 1::2] = number
    large[1::2, 2:-1:2] = np.where(number[:, 1:] == number[:, :-1], number[:, 1:], -1)
    large[2:-1:2, 1::2] = np.where(number[1:] == number[:-1], number[1:], -1)
    equal = (a == b) & (c == d) & (a == c)
    large[2:-1:2, 2:-1:2] = np.select([equal, falling & rising, falling, rising], [a, pick(a, b), a, b], -1)
    return {v: (ndimage.label(large == i, np.ones((3, 3)))[1], ndimage.label(large != i)[1] - 1) for i, v in enumerate(values, start=1)}


def polygon_topology(polygons):
    """Components and holes of polygons by label."""
    parts = {label: shapely.get_parts(p) for label, p in polygons.items()}
    return {label: (len(p), int(shapely.get_num_interior_rings(p).sum())) for label, p in parts.items()}


def check_coverage(polygons, labels, centres, *, background=0, connectivity=4):
    """Polygons by label are valid, share their interfaces, and have the topology of the label map.

    With pixel centres (h, w, 2), each of them lies in the polygon of its label only.
    """
    assert list(polygons) == [v for v in np.unique(labels).tolist() if v != background]
    assert all(p.is_valid for p in polygons.values())
    assert shapely.coverage_is_valid(list(polygons.values()))
    assert polygon_topology(polygons) == joined_topology(labels, background=background, connectivity=connectivity)
    if centres is not None:
        for label, p in polygons.items():
            assert np.array_equal(shapely.contains_xy(p, centres[..., 0], centres[..., 1]), labels == label)


def topologies(triangles, keys):
    """Components (through edges) and holes of the triangles of each key 0, 1, ..., as two arrays (k,)."""
    size = int(keys.max()) + 1
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner, triangle = np.tile(keys, 3), np.tile(np.arange(len(triangles)), 3)
    own_edges, edge = np.unique(np.column_stack([edges, owner]), axis=0, return_inverse=True)
    own_vertices = np.unique(np.column_stack([triangles.ravel(), np.repeat(keys, 3)]), axis=0)
    # Triangles and edges of one key as the two sides of a graph.
    graph = sparse.coo_array((np.ones(len(edge)), (triangle, len(triangles) + edge.ravel())), shape=(len(triangles) + len(own_edges),) * 2)
    _, part = sparse.csgraph.connected_components(graph, directed=False)
    components = np.bincount(keys[np.unique(part[: len(triangles)], return_index=True)[1]], minlength=size)
    vertices, edges, faces = (np.bincount(owner, minlength=size) for owner in (own_vertices[:, 1], own_edges[:, 2], keys))
    euler = vertices - edges + faces
    return components, components - euler
