"""Small plane meshes for the tests of views, made of unit cells cut in two, and the truths that hold of closed surfaces."""

from __future__ import annotations

import numpy as np


def cells(mask):
    """Two triangles for each True cell of a mask (rows upward), vertices shared, none unused."""
    w = mask.shape[1]
    r, c = np.nonzero(mask)
    a = r * (w + 1) + c
    corners = np.stack([a, a + 1, a + w + 2, a, a + w + 2, a + w + 1], axis=1).reshape(-1, 3)
    used, triangles = np.unique(corners, return_inverse=True)
    vertices = np.stack([used % (w + 1), used // (w + 1)], axis=1).astype(float)
    return vertices, triangles.reshape(-1, 3)


def ring():
    """A square plate, 4 by 4, with a square hole, 2 by 2: area 12, one hole."""
    mask = np.ones((4, 4), bool)
    mask[1:3, 1:3] = False
    return cells(mask)


def strip():
    """A strip of six cells, regions 3 (left) and 7 (right), at coordinates without an end in binary: area 6 / 9 * 1.1."""
    vertices, triangles = cells(np.ones((1, 6), bool))
    regions = np.where(vertices[triangles].mean(axis=1)[:, 0] < 3, 3, 7)
    return vertices / 3 * [1, 1.1] + [0.1, 0.7], triangles, regions


STRIP_AREA = 6 / 9 * 1.1


def directed_sides(faces):
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def is_closed(faces):
    """Each directed side exactly once, and the opposite one too: closed, manifold along its sides, wound alike."""
    sides = {tuple(side) for side in directed_sides(faces).tolist()}
    return len(sides) == 3 * len(faces) and all((b, a) in sides for a, b in sides)


def volume(points, faces):
    """By the divergence theorem; negative if wound inwards."""
    p, q, r = (points[faces[:, k]] for k in range(3))
    return float((p * np.cross(q, r)).sum() / 6)


def euler(faces):
    sides = {tuple(sorted(side)) for side in directed_sides(faces).tolist()}
    return len(np.unique(faces)) - len(sides) + len(faces)
