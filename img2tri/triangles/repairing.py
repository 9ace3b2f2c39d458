"""Adding and removing points where a vertex has too many or too few triangles.

No smoothing makes good triangles around an inner vertex with 4 of them (angles around 90 degrees) or 8 (around 45). Taking the
first away and splitting the second in two leaves, after triangulating anew, vertices with 5, 6 and 7.
"""

from __future__ import annotations

import numpy as np

from img2tri.records import Bools, Floats, Ints
from img2tri.triangles.lattice import Complex


def excess(vertices: Complex, triangles: Ints) -> Floats:
    """Return how many triangles too many each vertex has, for its angle, so that 60 degrees would be left for each.

    0 is ideal, for a vertex on an outline too: there the triangles fill less than a full turn.
    """
    a, b, c = vertices[triangles].T
    first, second = np.angle((c - a) / (b - a)), np.angle((a - b) / (c - b))
    angles = np.stack([first, second, np.pi - first - second], axis=1)
    count = len(vertices)
    return np.bincount(triangles.ravel(), 1 - angles.ravel() * (3 / np.pi), minlength=count)


def repaired(vertices: Complex, triangles: Ints, free: Bools) -> tuple[Complex, Bools]:
    """Return which vertices should go, as places of the points to add and a mask of the vertices that stay."""
    surplus = excess(vertices, triangles)
    crowded, sparse = free & (surplus > 1.5), free & (surplus < -1.5)
    stays = ~free
    stays[triangles] = True
    chosen, rings = _rings(vertices, triangles, np.flatnonzero(crowded | sparse))
    added = [np.zeros(0, complex)]
    for valence in np.unique([len(r) for r in rings]) if len(rings) else []:
        who = np.array([v for v, r in zip(chosen, rings) if len(r)==valence])
        ring = np.array([r for r in rings if len(r)==valence])
        if valence <= 4:
            stays[who] = False
            continue
        add, split = _split(vertices, surplus, who, ring)
        stays[split] = False
        added.append(add)
    return np.concatenate(added), stays


def _rings(vertices, triangles, who):
    want = np.zeros(len(vertices), bool)
    want[who] = True
    t, k = np.nonzero(want[triangles])
    centre, neighbour = triangles[t, k], triangles[t, (k + 1) % 3]
    order = np.lexsort((np.angle(vertices[neighbour] - vertices[centre]), centre))
    centre, neighbour = centre[order], neighbour[order]
    # claims
    claim = np.full(len(vertices), len(vertices))
    np.minimum.at(claim, neighbour, centre)
    np.minimum.at(claim, centre, centre)
    starts = np.flatnonzero(np.diff(centre, prepend=-1))
    good = np.minimum.reduceat((claim[neighbour] == centre) & (claim[centre] == centre), starts) if len(starts) else []
    parts = np.split(neighbour, starts[1:]) if len(starts) else []
    return [centre[s] for s, g in zip(starts, good) if g], [p for p, g in zip(parts, good) if g]


def _split(vertices, surplus, who, ring):
    n = ring.shape[1]
    k = np.arange(n)
    best = np.full(len(who), np.inf); at = np.zeros(len(who), int); gap = np.zeros(len(who), int)
    for d in range(3, n // 2 + 1):
        cost = surplus[ring] + surplus[np.roll(ring, -d, axis=1)]
        i = cost.argmin(axis=1)
        c = cost[np.arange(len(who)), i]
        better = c < best - 1e-9
        best[better], at[better], gap[better] = c[better], i[better], d
    ok = best <= LIMIT
    who, ring, at, gap = who[ok], ring[ok], at[ok], gap[ok]
    turned = np.take_along_axis(ring, (at[:, None] + k) % n, axis=1)
    z = vertices[turned]
    one = k <= gap[:, None]
    two = (k >= gap[:, None]) | (k == 0)
    a = (z * one).sum(1) / one.sum(1)
    b = (z * two).sum(1) / two.sum(1)
    c = vertices[who]
    return np.concatenate([(a + c) / 2, (b + c) / 2]), who
LIMIT = -0.5
