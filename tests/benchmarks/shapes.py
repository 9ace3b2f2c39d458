"""Shapes drawn at any resolution, for time and accuracy runs."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.spatial import cKDTree


def disc(n, r=0.4):
    y, x = np.mgrid[:n, :n] + 0.5
    return (x - n / 2) ** 2 + (y - n / 2) ** 2 < (r * n) ** 2


def blob(n, seed=0, k=9, amp=0.25, holes=3):
    """A wavy closed shape with round holes."""
    rng = np.random.default_rng(seed)
    th = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    r = np.ones_like(th)
    for m in range(2, k):
        r += amp / m * np.cos(m * th + rng.uniform(0, 6.28)) * rng.uniform(0.3, 1)
    r *= 0.38 * n / r.max()
    S = 16
    pts = np.stack([n / 2 + r * np.cos(th), n / 2 + r * np.sin(th)], 1)
    img = np.zeros((n, n), np.uint8)
    cv2.fillPoly(img, [np.round((pts - 0.5) * S).astype(np.int32)], 1, shift=4)
    for i in range(holes):
        a = 2 * np.pi * i / max(1, holes) + 0.3
        c = (n / 2 + 0.16 * n * np.cos(a) - 0.5, n / 2 + 0.16 * n * np.sin(a) - 0.5)
        cv2.circle(img, tuple(round(v * S) for v in c), int(0.05 * n * S), 0, -1, shift=4)
    return img.astype(bool)


def grains(n, k, seed=0):
    """A polycrystal: the Voronoi cells of k places, labels 1 to k."""
    places = np.random.default_rng(seed).random((k, 2)) * n
    y, x = np.mgrid[:n, :n] + 0.5
    return (cKDTree(places).query(np.stack([x.ravel(), y.ravel()], axis=1))[1].reshape(n, n) + 1).astype(np.int32)


def filled(polygons, n):
    """A mask of polygons (k, 2) in a square of side 1, drawn with 1/16 of a pixel; of two that overlap, the overlap is a hole."""
    mask = np.zeros((n, n), np.uint8)
    cv2.fillPoly(mask, [np.round((p * n - 0.5) * 16).astype(np.int32) for p in polygons], 1, shift=4)
    return mask.astype(bool)


def turned(points, turn, about=0.5 + 0.5j):
    z = (points[:, 0] + 1j * points[:, 1] - about) * np.exp(1j * turn) + about
    return np.stack([z.real, z.imag], axis=1)


def letter(character, n, turn=0.0):
    """A letter in bold, serifs and all."""
    mask = np.zeros((2 * n, 2 * n), np.uint8)
    scale = n / 18
    (width, height), _ = cv2.getTextSize(character, cv2.FONT_HERSHEY_TRIPLEX, scale, int(1.6 * scale))
    cv2.putText(mask, character, (n - width // 2, n + height // 2), cv2.FONT_HERSHEY_TRIPLEX, scale, 255, int(1.6 * scale), cv2.LINE_AA)
    matrix = cv2.getRotationMatrix2D((n, n), np.degrees(turn), 0.75)
    grown = cv2.warpAffine(mask, matrix, (2 * n, 2 * n), flags=cv2.INTER_AREA)
    return cv2.resize(grown, (n, n), interpolation=cv2.INTER_AREA) > 127


def gear(teeth, n, turn=0.0, hole=0.2):
    """A wheel with straight teeth and a hole."""
    angle = np.arange(4 * teeth) * np.pi / (2 * teeth) + turn
    radius = np.where(np.arange(4 * teeth) % 4 < 2, 0.45, 0.37)
    rim = 0.5 + np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    turns = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    return filled([rim, 0.5 + hole * np.stack([np.cos(turns), np.sin(turns)], axis=1)], n)


def leaf(lobes, n, turn=0.0, depth=0.35):
    """A lobed leaf with a sharp tip and a thin stalk."""
    t = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    radius = 0.33 * (1 - depth * np.abs(np.sin(lobes * t / 2)) ** 0.7) * (1 + 0.35 * np.exp(-8 * (1 - np.cos(t))))
    edge = np.stack([0.45 + radius * np.cos(t), 0.5 + 0.85 * radius * np.sin(t)], axis=1)
    stalk = np.array([[0.3, 0.486], [0.3, 0.514], [0.02, 0.505], [0.02, 0.495]])
    both = [filled([turned(part, turn)], n) for part in (edge, stalk)]
    return both[0] | both[1]


def bone(n, turn=0.0, waist=0.07, knob=0.12):
    """A long bone: a shaft with two knobs at each end."""
    y, x = np.mgrid[:n, :n] + 0.5
    p = turned(np.stack([x.ravel(), y.ravel()], axis=1) / n, turn)
    u, v = (p - 0.5).T
    inside = np.abs(v) < waist + 0.12 * u**2
    inside &= np.abs(u) < 0.36
    for side, up in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        inside |= (u - side * 0.36) ** 2 + (v - up * (0.08 + 0.01 * side)) ** 2 < (knob - 0.01 * up * side) ** 2
    return inside.reshape(n, n)


def silhouettes():
    """Thirty masks like those of shape databases: letters, gears, leaves, bones, some 300 to 500 pixels wide; by name."""
    turns = np.random.default_rng(5).uniform(0, 2 * np.pi, 30)
    shapes = {f"letter {c}": letter(c, 420, 0.2 * np.sin(turn)) for c, turn in zip("ABEGKRSW", turns, strict=False)}
    shapes |= {
        f"gear {teeth}": gear(teeth, 300 + 4 * teeth, turn) for teeth, turn in zip((7, 9, 12, 16, 20, 26, 32), turns[8:], strict=False)
    }
    shapes |= {f"leaf {lobes}": leaf(lobes, 440, turn) for lobes, turn in zip((2, 3, 5, 7, 9, 11, 14, 18), turns[15:], strict=False)}
    shapes |= {f"bone {k}": bone(420, turn, 0.03 + 0.01 * k, 0.1 + 0.005 * k) for k, turn in enumerate(turns[23:])}
    return shapes
