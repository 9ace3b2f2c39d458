"""Regions that lack area, as their chains have no room for it -> chains shifted for their sake, those of their neighbours too.

Each chain is shifted to sweep the area it should (`restore_swept_areas`). Short ones may be at their bounds before that; then a region
may get by another of its chains what it lacks, see `img2tri.shapes.region_pressures`.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.shapes.place.constrained_smoothing import AT_BOUND, BoundedChains, rounding_of_areas, swept_areas, swept_widths
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
    size, enough = len(areas), np.maximum(SAME_AREA * np.maximum(areas, 1), rounding_of_areas(s))
    for _ in range(EXCHANGES):
        missing = wanted - swept_areas(s.points + shift * s.axis, s)
        lacking = (np.bincount(left, missing, size) - np.bincount(right, missing, size)).astype(np.float64)
        lacking[0] = 0
        if (np.abs(lacking) <= enough).all():
            break
        step = np.zeros(len(areas))
        for _ in range(2):
            by = step[left] - step[right]
            free = np.concatenate([_free_width(part, shift[at], by[chains]) for chains, at, part in s.batches()])
            step = region_pressures(left, right, free, lacking)
        by, before, shift = step[left] - step[right], shift, shift.copy()
        for chains, at, part in s.batches():
            shift[at] = _shifted(part, before[at], by[chains])
    return shift


def _free_width(s: BoundedChains, shift: Floats, by: Floats) -> Floats:
    """Return the width (c,) of the points of each chain that may go on when it is shifted by so much (c,); to both sides where by 0."""
    width = swept_widths(s.points + shift * s.axis, s)
    way = by[s.chains.chain] * np.sign(width)
    room = np.where(way > 0, s.high - shift, np.where(way < 0, shift - s.low, s.high - s.low))
    return np.asarray(np.bincount(s.chains.chain, np.abs(width) * (room > AT_BOUND), len(by)), np.float64)


def _shifted(s: BoundedChains, shift: Floats, by: Floats) -> Floats:
    """Shift each chain by so much (c,), as far as the bounds of its points go."""
    width = swept_widths(s.points + shift * s.axis, s)
    step = np.clip(by[s.chains.chain] * np.sign(width), -MOST_EXCHANGED, MOST_EXCHANGED)
    step[s.axis == 0] = 0
    begin, end = s.chains.ring_ends
    step[end] = step[begin]
    return np.clip(shift + step, s.low, s.high)
