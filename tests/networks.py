"""Planar networks of outlines to be filled: rings within rings, grains that meet in junctions, thin parts."""

from __future__ import annotations

from itertools import pairwise

import numpy as np


def ring(n, radius, centre=(0.0, 0.0)):
    turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.asarray(centre) + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def network(*rings):
    """RegionRings given as (points, region inside, region outside), all counter-clockwise."""
    points, segments, left, right = [], [], [], []
    for p, inside, outside in rings:
        i = np.arange(len(p))
        segments.append(np.stack([i, (i + 1) % len(p)], axis=1) + sum(map(len, points)))
        points.append(p)
        left.append(np.full(len(p), inside))
        right.append(np.full(len(p), outside))
    return tuple(map(np.concatenate, (points, segments, left, right)))


def area_of_ring(n, radius):
    return n / 2 * radius**2 * np.sin(2 * np.pi / n)


def wave(n, scale, lobes=5, depth=0.15):
    """A wavy outline with segments of even length, about scale * 2 pi / n."""
    fine = np.linspace(0, 2 * np.pi, 20_000)
    z = scale * (1 + depth * np.cos(lobes * fine)) * np.exp(1j * fine)
    way = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    even = np.linspace(0, way[-1], n, endpoint=False)
    return np.stack([np.interp(even, way, z.real), np.interp(even, way, z.imag)], axis=1)


def graded(scale=40.0):
    """A drop: segments from 0.4 at its tip to 4."""
    t = np.concatenate([[0], np.cumsum(np.minimum(4, 0.4 * 1.25 ** np.arange(200)))])
    t = t[t < 2.3 * scale]
    half = t * np.exp(-0.35j * (1 - t / t[-1]))
    outline = np.concatenate([half, half[-2:0:-1].conj()])
    return np.stack([outline.real, outline.imag], axis=1)


def grains():
    """A square of four grains that meet in two junctions, segments about 4 long, two short ones between the junctions."""
    corners = {0: (0, 0), 1: (60, 0), 2: (60, 60), 3: (0, 60), 4: (27, 0), 5: (60, 28), 6: (33, 60), 7: (0, 31), 8: (28, 29), 9: (31, 31)}
    lines = [(0, 4, 1, 0), (4, 1, 2, 0), (1, 5, 2, 0), (5, 2, 3, 0), (2, 6, 3, 0), (6, 3, 4, 0), (3, 7, 4, 0), (7, 0, 1, 0)]
    lines += [(4, 8, 1, 2), (7, 8, 4, 1), (8, 9, 4, 2), (9, 5, 3, 2), (9, 6, 4, 3)]
    points = [np.array(p, float) for p in corners.values()]
    segments, left, right = [], [], []
    for a, b, inside, outside in lines:
        n = max(1, round(np.linalg.norm(points[b] - points[a]) / 4))
        at = [a, *range(len(points), len(points) + n - 1), b]
        points += [points[a] + (points[b] - points[a]) * k / n for k in range(1, n)]
        segments += list(pairwise(at))
        left += [inside] * n
        right += [outside] * n
    return np.array(points), np.array(segments), np.array(left), np.array(right)


RING = network((wave(160, 100), 1, 0), (ring(40, 25), 0, 1))
NETWORKS = {
    "disc": (network((ring(79, 50), 1, 0)), 4.0),
    "ring": (RING, 4.0),
    "nested": (network((wave(160, 100), 5, 0), (wave(110, 70), -2, 5), (ring(70, 40), 0, -2), (ring(30, 18), 7, 0)), 4.0),
    "side by side": (network((wave(80, 50), 1, 0), (wave(80, 50) + np.array([150.0, 0]), 1, 0)), 4.0),
    "grains": (grains(), 4.0),
    "drop": (network((graded(), 1, 0)), 4.0),
    "strip": (network((np.array([[0.0, 0], [40, 0], [40, 1.5], [0, 1.5]]), 1, 0)), 4.0),
    "square": (network((np.array([[0.0, 0], [30, 0], [30, 30], [0, 30]]), 1, 0)), 2.0),
    "one triangle": (network((np.array([[0.0, 0], [1, 0], [0.4, 0.8]]), 1, 0)), 4.0),
    "speck": (network((wave(100, 60), 1, 0), (ring(8, 0.6, (11, 7)), 2, 1)), 4.0),
}
