"""Shapes drawn at any resolution, for time and accuracy runs."""

from __future__ import annotations

import cv2
import numpy as np


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
