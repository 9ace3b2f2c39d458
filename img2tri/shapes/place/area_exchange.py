"""Regions that lack area, as their chains have no room for it -> chains shifted for their sake, those of their neighbours too.

Each chain is shifted to sweep the area it should (`restore_swept_areas`). Short ones may be at their bounds before that; then a region
may get by another of its chains what it lacks, see `img2tri.shapes.region_pressures`.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints, cross
from img2tri.shapes.place.constrained_smoothing import AT_BOUND, BoundedChains, rounding_of_areas, swept_areas
from img2tri.shapes.region_pressures import region_pressures

SAME_AREA = 1e-12  # of the area of a region: what it may lack
EXCHANGES = 30  # a few do, but where chains come to their bounds one after the other
MOST_EXCHANGED = 0.1  # of a dual edge, in each round


def exchange_areas(s: BoundedChains, shift: Floats, wanted: Floats, left: Ints, right: Ints, areas: Floats) -> Floats:
    """Return shifts (n,) by which regions get the areas they lack.

    Parameters
    ----------
    s, shift
        The chains, and how far their points are shifted.
    wanted
        (c,) the area each chain should sweep, seen from the origin.
    left, right
        (c,) the region numbers beside each chain.
    areas
        (r,) the area of each region.
    """
    at, chain, size = s.chains.indices, s.chains.chain, len(areas)
    begin, end = s.chains.ring_ends
    enough = np.maximum(SAME_AREA * np.maximum(areas, 1), rounding_of_areas(s))
    for _ in range(EXCHANGES):
        moved = s.points + shift * s.axis
        missing = wanted - swept_areas(moved, s)
        lacking = (np.bincount(left, missing, size) - np.bincount(right, missing, size)).astype(np.float64)
        lacking[0] = 0
        if (np.abs(lacking) <= enough).all():
            break
        z = moved[at]
        ahead, behind = np.roll(z, -1), np.roll(z, 1)
        behind[begin], ahead[end] = z[end - 1], z[begin + 1]
        width = cross(s.axis[at], ahead - behind) / 2
        width[end] = 0
        way = np.sign(width)
        step = np.zeros(len(areas))
        for _ in range(2):
            by = (step[left] - step[right])[chain] * way
            room = np.where(by > 0, s.high[at] - shift[at], np.where(by < 0, shift[at] - s.low[at], (s.high - s.low)[at]))
            free = np.bincount(chain, np.abs(width) * (room > AT_BOUND), len(left)).astype(np.float64)
            step = region_pressures(left, right, free, lacking)
        by = np.clip((step[left] - step[right])[chain] * way, -MOST_EXCHANGED, MOST_EXCHANGED)
        by[s.axis[at] == 0] = 0
        by[end] = by[begin]
        shift = shift.copy()
        shift[at] = np.clip(shift[at] + by, s.low[at], s.high[at])
    return shift
