"""A floor to compare with: how exact the outline of a disc can be, known from the pixels of a mask, or from 8-bit gray values.

    pytest -m benchmark -s tests/benchmarks/test_outline_floor.py

The pixels of a mask say of each pixel centre whether it lies inside. All curves r(angle) = sum of waves around the centre that say the
same are as likely as each other; as what pixels say is linear in the heights of the waves, these curves fill a polytope, and the best
estimate is its centroid (the mean of the posterior for a flat prior; found by Gibbs sampling, Geman and Geman, 1984, DOI
10.1109/TPAMI.1984.4767596). The distance of that from the true circle is the floor. It depends on what one knows beforehand: that the
curve is a circle (one wave around), or that it has no waves shorter than some length. Who knows less can only do worse. Gray values say
how much of a pixel is covered, to within half of 1/255: there the floor is that of a linear least-squares fit (Cramer and Rao).
"""

from __future__ import annotations

import numpy as np
import pytest
import specimens

from img2tri import mesh_image

pytestmark = pytest.mark.benchmark

PLACES = {10: 12, 20: 8, 40: 6, 80: 4, 150: 2, 400: 1}  # discs of each radius
WAVES = {"a circle": np.inf, "waves of 96 px": 96.0, "waves of 48 px": 48.0, "waves of 24 px": 24.0}
SWEEPS, SETTLING = 400, 100  # of the sampler


def waves(angles, most):
    """Columns 1, cos, sin, cos 2, sin 2 ... of angles."""
    k = np.arange(1, most + 1)
    return np.concatenate([np.ones((len(angles), 1)), np.cos(np.outer(angles, k)), np.sin(np.outer(angles, k))], axis=1)


def centroid(rows, limits, rng):
    """Mean of all x with rows @ x <= limits, from x = 0, by Gibbs sampling."""
    x, slack, total = np.zeros(rows.shape[1]), limits.copy(), np.zeros(rows.shape[1])
    columns = np.ascontiguousarray(rows.T)
    for sweep in range(SWEEPS):
        for j in rng.permutation(len(x)):
            column = columns[j]
            up, down = column > 1e-12, column < -1e-12
            step = rng.uniform((slack[down] / column[down]).max(), (slack[up] / column[up]).min())
            x[j] += step
            slack = slack - step * column
        total += x * (sweep >= SETTLING)
    return total / (SWEEPS - SETTLING)


def floor_of_mask(radius, length, rng):
    """Distance of the centroid of all consistent curves from the circle, root mean square."""
    most = max(1, int(2 * np.pi * radius / length))
    centre = rng.uniform(-0.5, 0.5, 2)
    reach = np.arange(-radius - 3, radius + 4)
    x, y = (grid.ravel() for grid in np.meshgrid(reach - centre[0], reach - centre[1]))
    distance = np.hypot(x, y)
    near = np.abs(distance - radius) < 1.5
    beyond = distance[near] - radius
    sign = np.where(beyond > 0, 1.0, -1.0)  # the curve passes below what is outside, above what is inside
    found = centroid(sign[:, None] * waves(np.arctan2(y, x)[near], most), sign * beyond, rng)
    return np.sqrt(found[0] ** 2 + (found[1:] ** 2).sum() / 2)


def floor_of_gray(radius, length):
    """The same for a fit to coverages rounded to 1/255: as many unknowns, one value for each pixel that the circle passes."""
    return np.sqrt((2 * max(1, int(2 * np.pi * radius / length)) + 1) / (8 * radius)) / 255 / np.sqrt(12)


def ours(kind, radius, rng):
    """Distance of the dense outline from the circle, root mean square."""
    n = 2 * radius + 14
    y, x = n / 2 + rng.uniform(-0.5, 0.5, 2)
    image = (specimens.disc if kind == "mask" else specimens.gray_disc)(n, radius, (y, x))
    dense = mesh_image(image, edge_length=radius / 2, threshold=None if kind == "mask" else 127.5).origin.outlines
    return np.sqrt(np.mean((np.hypot(*(dense.points - (x, n - y)).T) - radius) ** 2))


def root_mean_square(values):
    return float(np.sqrt(np.mean(np.square(list(values)))))


def test_floor():
    print(f"\n| radius | mask: ours | {' | '.join(WAVES)} | gray: ours | a circle | waves of 48 px |\n|{'---|' * 9}")
    for radius, count in PLACES.items():
        rng = np.random.default_rng(radius)
        row = [root_mean_square(ours("mask", radius, rng) for _ in range(4 * count))]
        row += [root_mean_square(floor_of_mask(radius, length, rng) for _ in range(count)) for length in WAVES.values()]
        row += [root_mean_square(ours("gray", radius, rng) for _ in range(count)), *(floor_of_gray(radius, w) for w in (np.inf, 48.0))]
        print(f"| {radius:6} | " + " | ".join(f"{value:.4f}" for value in row) + " |", flush=True)
        assert row[1] < row[0]
