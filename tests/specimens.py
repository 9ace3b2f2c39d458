"""Tiny label maps, each with one difficulty, that everything is run through."""

from __future__ import annotations

import numpy as np


def drawn(*rows: str) -> np.ndarray:
    """A label map from rows of digits; a dot is 0."""
    return np.array([[0 if c == "." else int(c) for c in row] for row in rows])


def spiral(turns: int = 4) -> np.ndarray:
    """A line of one pixel winding inwards, one pixel of gap."""
    n = 4 * turns + 1
    m = np.zeros((n, n), int)
    r, c, dr, dc = 0, 0, 0, 1
    m[0, 0] = 1
    length, leg = n - 1, 0
    while length > 0:
        for _ in range(length):
            r, c = r + dr, c + dc
            m[r, c] = 1
        dr, dc = dc, -dr
        leg += 1
        if leg >= 3 and leg % 2 == 1:
            length -= 2
    return m


def rings(n: int = 17) -> np.ndarray:
    """Ring in ring in ring, one pixel each."""
    y, x = np.mgrid[:n, :n]
    return ((np.maximum(abs(x - n // 2), abs(y - n // 2)) % 2) == 0).astype(int)


def disc(n: int = 40, radius: float = 15.0, centre: tuple[float, float] | None = None) -> np.ndarray:
    """A disc, a pixel being inside if its centre is."""
    cy, cx = centre or (n / 2, n / 2)
    y, x = np.mgrid[:n, :n] + 0.5
    return (np.hypot(x - cx, y - cy) < radius).astype(int)


def polycrystal(n: int = 64, k: int = 12, seed: int = 0) -> np.ndarray:
    """Nearest of k seeds, labels 1 to k."""
    rng = np.random.default_rng(seed)
    seeds = rng.random((k, 2)) * n
    y, x = np.mgrid[:n, :n] + 0.5
    return np.argmin([np.hypot(y - r, x - c) for r, c in seeds], axis=0) + 1


def checkerboard(n: int = 8) -> np.ndarray:
    """Pixels of 0 and 1 in turn."""
    return np.indices((n, n)).sum(0) % 2


MASKS = {
    "full": np.ones((5, 7), int),
    "one pixel": drawn("...", ".1.", "..."),
    "one pixel, the image": drawn("1"),
    "one row": drawn(".11.1"),
    "one column": drawn(".", "1", "1", "."),
    "pixel in the corner": drawn("1..", "...", "..."),
    "hole of a pixel": drawn("111", "1.1", "111"),
    "touching corners": drawn("1.", ".1"),
    "touching corners inside": drawn("....", ".1..", "..1.", "...."),
    "hole touching the outside by a corner": drawn("....", ".11.", ".1.1", ".111"),
    "diagonal": np.eye(9, dtype=int),
    "checkerboard": np.indices((8, 9)).sum(0) % 2,
    "comb": np.array([[1] * 11] + [[1, 0] * 5 + [1]] * 6),
    "gaps of a pixel": np.pad(np.kron(np.ones((2, 2), int), np.pad(np.ones((4, 4), int), ((0, 1), (0, 1)))), 1),
    "line": np.pad(np.ones((1, 12), int), 2),
    "thin cross": drawn("...1...", "...1...", "...1...", "1111111", "...1...", "...1...", "...1..."),
    "spiral": spiral(),
    "rings": rings(),
    "disc": disc(),
    "disc cut by the frame": disc(40, 15.0, (3.3, 20.2)),
    "ring": disc(50, 22) - disc(50, 12),
    "dent with an island": drawn("111111.....1111111", "1111111.1.11111111", "11111111.111111111"),
    "small ring": drawn(".11.", "1.11", ".111"),
}

LABELS = {
    "two halves": np.repeat([[1, 2]], 4, 0).repeat(3, 1),
    "three meet": drawn("1122", "1122", "3333", "3333"),
    "four meet": drawn("1122", "1122", "3344", "3344"),
    "checkerboard of two": drawn("1212", "2121", "1212"),
    "checkerboard of three": drawn("1221", "3113", "3113", "1221"),
    "diagonal of three": drawn("12", "31"),
    "diagonal with a gap": drawn("1.", ".2"),
    "island in island": drawn("1111111", "1222221", "1233321", "1234321", "1233321", "1222221", "1111111"),
    "islands of a pixel": drawn("12.", "212", "12."),
    "gap between": drawn("11.22", "11.22", "11.22"),
    "negative and huge": np.array([[-5, -5, 7], [2**40, -5, 7], [2**40, 2**40, 7]]),
    "polycrystal": polycrystal(),
    "stripes": np.arange(12).reshape(1, -1).repeat(6, 0) % 5,
}

ALL = MASKS | LABELS


def turned(m: np.ndarray) -> list[np.ndarray]:
    """The eight rotations and mirror images."""
    return [np.ascontiguousarray(np.rot90(x, k)) for x in (m, m.T) for k in range(4)]


def unturned(points: np.ndarray, shape: tuple[int, int], turn: int) -> np.ndarray:
    """Points (n, 2) found in ``turned(m)[turn]``, carried back to m of shape (h, w); x right, y up."""
    size = complex(shape[1], shape[0])
    mirrored = complex(size.imag, size.real) if turn >= 4 else size
    seen = complex(mirrored.imag, mirrored.real) if turn % 2 else mirrored
    z = (points[:, 0] + 1j * points[:, 1] - seen / 2) * (-1j) ** (turn % 4)
    if turn >= 4:
        z = -1j * z.conj()
    z = z + size / 2
    return np.stack([z.real, z.imag], axis=1)


def ellipse(n: int, axes: tuple[float, float], angle: float = 0.0, centre: tuple[float, float] | None = None) -> np.ndarray:
    """An ellipse with these half axes, the first turned by `angle` degrees from x to y up; a disc if they are equal."""
    u, v = _turned_grid(n, angle, centre)
    return ((u / axes[0]) ** 2 + (v / axes[1]) ** 2 < 1).astype(int)


def rectangle(n: int, sides: tuple[float, float], angle: float = 0.0, centre: tuple[float, float] | None = None) -> np.ndarray:
    """A rectangle with these sides, the first turned by `angle` degrees from x to y up."""
    u, v = _turned_grid(n, angle, centre)
    return ((abs(u) < sides[0] / 2) & (abs(v) < sides[1] / 2)).astype(int)


def _turned_grid(n: int, angle: float, centre: tuple[float, float] | None) -> tuple[np.ndarray, np.ndarray]:
    cy, cx = centre or (n / 2, n / 2)
    y, x = np.mgrid[:n, :n] + 0.5
    z = ((x - cx) - 1j * (y - cy)) * np.exp(-1j * np.radians(angle))
    return z.real, z.imag


def gray_disc(n: int, radius: float, centre: tuple[float, float] | None = None, low: int = 0, high: int = 255) -> np.ndarray:
    """A disc whose edge is drawn by area coverage, from 16 x 16 samples to a pixel."""
    cy, cx = centre or (n / 2, n / 2)
    y, x = np.mgrid[:n, :n] + 0.5
    distance = np.hypot(x - cx, y - cy)
    share = (distance < radius).astype(float)
    r, c = np.nonzero(abs(distance - radius) < 1)
    step = (np.arange(16) + 0.5) / 16
    inside = np.hypot(c[:, None, None] + step - cx, (r[:, None] + step)[:, :, None] - cy) < radius
    share[r, c] = inside.mean(axis=(1, 2))
    return np.round(low + (high - low) * share).astype(np.uint8)
