"""Every mask of 3 x 4 pixels, every map of 2 x 3 with four labels: valid, no angle below 30 degrees, the topology of the pixels.

So many images are meshed at once: as the *cells* of a few large ones, with one pixel of background between them. In a sheet
background is all around each cell; in a strip each touches the frame above and below. By itself each fills its image.
"""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import shapely
from scipy import sparse

from img2tri import mesh_image


def all_maps(shape, count):
    """Every label map (n, h, w) of a shape with the labels 0 to count - 1, but for the empty one."""
    codes = np.arange(1, count ** (shape[0] * shape[1]))[:, None]
    return (codes // count ** np.arange(shape[0] * shape[1]) % count).reshape(-1, *shape)


MASKS, LABELS = all_maps((3, 4), 2), all_maps((2, 3), 4)


def sheet(cells, columns=64):
    """Cells side by side and in rows, background between and around them."""
    n, h, w = cells.shape
    rows = -(-n // columns)
    padded = np.zeros((rows * columns, h + 1, w + 1), int)
    padded[:n, :h, :w] = cells
    laid = padded.reshape(rows, columns, h + 1, w + 1).transpose(0, 2, 1, 3).reshape(rows * (h + 1), columns * (w + 1))
    return np.pad(laid, ((1, 0), (1, 0)))


def strip(cells):
    """Cells side by side in an image as high as they are."""
    n, h, w = cells.shape
    return np.pad(cells, ((0, 0), (0, 0), (1, 0))).transpose(1, 0, 2).reshape(h, n * (w + 1))


def meetings(triangles, keys):
    """Edges between triangles of different keys (k, 2), and the keys that meet there (k, 2), the lower first."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    order = np.lexsort(edges.T)
    edges, keys = edges[order], np.tile(keys, 3)[order]
    pairs = np.sort(np.stack([keys[:-1], keys[1:]], axis=1), axis=1)
    meet = (edges[1:] == edges[:-1]).all(axis=1) & (pairs[:, 0] != pairs[:, 1])
    return edges[1:][meet], pairs[meet]


def pixel_meetings(cells, keys):
    """Pairs of keys (k, 2) of pixels with a side in common."""
    found = []
    for a, b in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[:, :, 1:], np.s_[:, :, :-1])):
        meet = (cells[a] != cells[b]) & (cells[a] > 0) & (cells[b] > 0)
        found.append(np.sort(np.stack([keys[a][meet], keys[b][meet]], axis=1), axis=1))
    return np.unique(np.concatenate(found), axis=0)


def cell_of_triangles(vertices, triangles, image, shape, columns):
    """The cell of each triangle: that in which the middle lies of all that hangs together with it."""
    n, m = len(vertices), len(triangles)
    graph = sparse.coo_array((np.ones(3 * m), (np.repeat(np.arange(m), 3), m + triangles.ravel())), shape=(n + m, n + m))
    part = sparse.csgraph.connected_components(graph, directed=False)[1][:m]
    area, middle = oracles.areas(vertices, triangles), vertices[triangles].mean(axis=1)
    total = np.maximum(np.bincount(part, area), 1e-300)
    x, y = (np.bincount(part, area * middle[:, k]) / total for k in (0, 1))
    column = np.floor((x - 0.5) / (shape[1] + 1)).astype(int)
    row = np.maximum(np.floor((image.shape[0] - y - 0.5) / (shape[0] + 1)).astype(int), 0)
    return (row * columns + column)[part]


def farthest(segments, others):
    """The greatest distance of the ends of some segments (k, 2, 2) from others."""
    z = np.unique(segments.reshape(-1, 2) @ [1, 1j])
    points, tree = np.stack([z.real, z.imag], axis=1), shapely.STRtree(shapely.linestrings(others))
    return tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)[1].max()


def check(cells, image, columns, connectivity=4):
    """Mesh an image of cells, and look at each of them."""
    count = int(cells.max()) + 1
    mesh = mesh_image(image, labels=True, edge_length=8, connectivity=connectivity)
    v, t, r = mesh.vertices, mesh.triangles, mesh.regions
    oracles.check_valid(v, t)
    assert oracles.angles(v, t).min() >= 30 - 1e-6
    keys = cell_of_triangles(v, t, image, cells.shape[1:], columns) * count + r
    found = np.zeros((len(cells) * count, 2), int)
    components, holes = oracles.topologies(t, keys)
    found[: len(components)] = np.stack([components, holes], axis=1)
    expected = np.zeros_like(found)
    for i, labels in enumerate(cells):
        for label, topology in oracles.joined_topology(labels, connectivity=connectivity).items():
            expected[i * count + label] = topology
    wrong = np.flatnonzero((found != expected).any(axis=1))
    assert not len(wrong), [(cells[k // count].tolist(), k % count, found[k], expected[k]) for k in wrong[:3]]

    edges, pairs = meetings(t, keys)
    assert np.array_equal(np.unique(pairs, axis=0), pixel_meetings(cells, cells + count * np.arange(len(cells))[:, None, None]))
    # Half the diagonal of a pixel for the outline, and the tolerance.
    curves, sides = v[np.concatenate([oracles.boundary(t), edges])], oracles.pixel_sides(image)
    assert max(farthest(curves, sides), farthest(sides, curves)) <= 2**-0.5 + 0.5 + 1e-9
    return mesh


def check_sheet(cells, **options):
    check(cells, sheet(cells), 64, **options)


def check_strip(cells):
    mesh = check(cells, strip(cells), len(cells))
    oracles.check_frame(mesh.vertices, mesh.triangles, strip(cells) > 0)


def check_alone(labels, background=0):
    mesh = mesh_image(labels, labels=True, background=background, edge_length=8)
    oracles.check_valid(mesh.vertices, mesh.triangles)
    assert oracles.angles(mesh.vertices, mesh.triangles).min() >= 30 - 1e-6
    oracles.check_faithful(mesh.vertices, mesh.triangles, mesh.regions, labels, background=background)
    assert mesh.report.kept


def some(cells, count, seed=0):
    """Cells drawn at random."""
    return cells[np.random.default_rng(seed).choice(len(cells), count, replace=False)]


def test_all_maps_are_there():
    assert MASKS.shape == (4095, 3, 4)
    assert LABELS.shape == (4095, 2, 3)
    for cells in (MASKS, LABELS):
        assert len(np.unique(cells.reshape(len(cells), -1), axis=0)) == len(cells)


def test_every_mask():
    check_sheet(MASKS)


def test_every_label_map():
    check_sheet(LABELS)


@pytest.mark.parametrize("cells", [MASKS, LABELS], ids=["masks", "labels"])
def test_some_of_them_between_two_sides_of_the_frame(cells):
    check_strip(some(cells, 150))
    check_strip(some(cells, 150, seed=1).transpose(0, 2, 1))


@pytest.mark.parametrize("cells", [MASKS, LABELS], ids=["masks", "labels"])
def test_some_of_them_filling_their_image(cells):
    for labels in some(cells, 30):
        check_alone(labels)


def test_some_of_them_with_diagonal_pixels_joined():
    check_sheet(some(MASKS, 192), connectivity=8)
    check_sheet(some(LABELS, 192), connectivity=8)


@pytest.mark.slow
@pytest.mark.parametrize("cells", [MASKS, LABELS], ids=["masks", "labels"])
def test_all_of_them_between_two_sides_of_the_frame(cells):
    check_strip(cells)
    check_strip(cells.transpose(0, 2, 1))


@pytest.mark.slow
@pytest.mark.parametrize("cells", [MASKS, LABELS], ids=["masks", "labels"])
def test_all_of_them_with_diagonal_pixels_joined(cells):
    check_sheet(cells, connectivity=8)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(16))
@pytest.mark.parametrize("cells", [MASKS, LABELS], ids=["masks", "labels"])
def test_all_of_them_filling_their_image(cells, part):
    for labels in cells[part::16]:
        check_alone(labels)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(16))
def test_every_label_map_without_background(part):
    for labels in LABELS[part::16]:
        check_alone(labels, background=None)
