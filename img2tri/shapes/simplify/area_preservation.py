"""Area-preserving simplification: coarse outlines that enclose what the dense ones enclose.

A chord on a curve cuts off what is between it and its arc: a disc drawn with edges of length h loses h^2 / 6 R^2 of its area, and a
computation on it that much of its exactness. Offsetting the vertices outwards gives it back at no cost.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, cross
from img2tri.shapes.region_pressures import region_pressures
from img2tri.shapes.simplify.closer_spacing import spaced_closer
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.simplify.vertex_offsets import NormalOffsets, areas_beside
from img2tri.shapes.trace.dual_edges import pixel_areas

LACKING_AREA = 0.003  # of the area of a region: what it may lack before it gets more vertices
EXCHANGE_ROUNDS = 3  # of leaving out vertices that cannot move the way they should
LEFT_OVER = 2e-5  # relative, of a region: above it all its vertices are offset, not only those that slid
LEAST_ROOM = 1e-3  # px, vertices that can move no farther are left out
SMALL_REGION = 16  # pixels: the area of smaller regions is not looked after


def preserve_areas(s: Simplification, *, tolerance: float, above: float = 0.0) -> Simplification:
    """Offset vertices along the normal so that the chords enclose what the outlines enclose, region by region.

    Each vertex takes up half of the chord-arc areas beside it; what then is missing of a region, since some vertices cannot move, is
    shared evenly by the others, see `region_pressures`. No vertex ends farther from the outline than the tolerance. Where that leaves a
    region with too much or too little, it gets more vertices, see `closer_spacing`.

    With `above`, the relative error that is borne, only that is shared what is missing.
    """
    free = NormalOffsets(s, snapped=True)
    area, width = (part[free.at] for part in areas_beside(s))
    taken = s if above else replace(s, offset=free.shifted(s.offset, area / width, tolerance))
    result = _exchanged(taken, free, width, tolerance)
    areas = pixel_areas(s.dual_edges)
    areas[0] = np.inf
    off = (np.abs(_gained_areas(result)) > (above or LACKING_AREA) * areas) & (areas > (SMALL_REGION if above else 0))
    return spaced_closer(result, off, tolerance=tolerance) if off.any() else result


def share_areas(s: Simplification, among: Bools, *, tolerance: float) -> Simplification:
    """Offset vertices among some entries (k,) so that regions have their areas again; the others stay, as they lie well for their arcs."""
    free = NormalOffsets(s, snapped=False)
    _, width = areas_beside(s)
    return _exchanged(s, free, (width * among)[free.at], tolerance)


def of_regions_off(s: Simplification) -> Bools:
    """Tell which entries (k,) are on the outline of a region that has too much or too little."""
    off = area_errors(s) > LEFT_OVER
    return np.asarray((off[s.outlines.left] | off[s.outlines.right])[s.chains.chain])


def _exchanged(s: Simplification, free: NormalOffsets, width: Floats, tolerance: float) -> Simplification:
    """Offset the free vertices (b,) that have a width so that all regions get the areas they lack, see `region_pressures`.

    Vertices that cannot move the way they should are left out of account, as far as these change.
    """
    chain, right_way = s.chains.chain[free.at], free.right(s.offset).conj()
    left, right, lacking = s.outlines.left[chain], s.outlines.right[chain], -_gained_areas(s)
    back, forth = (
        ((free.shifted(s.offset, np.full(len(chain), way), tolerance) - s.offset)[free.at] * right_way).real for way in (-1.0, 1.0)
    )
    step, known = np.zeros(len(chain)), np.zeros(0, bool)
    for _ in range(EXCHANGE_ROUNDS):
        able = np.where(step > 0, forth, np.where(step < 0, -back, forth - back)) > LEAST_ROOM
        if np.array_equal(able, known):
            break
        known = able
        pressure = region_pressures(left, right, width * able / 2, lacking)
        step = pressure[left] - pressure[right]
    return replace(s, offset=free.shifted(s.offset, np.clip(step, back, forth) * (width > 0), tolerance))


def area_errors(s: Simplification) -> Floats:
    """Relative difference (r,) between what chords and outlines enclose, by region number; 0 for regions of up to `SMALL_REGION` pixels."""
    found, areas = _gained_areas(s), pixel_areas(s.dual_edges)
    areas[0] = 0
    return np.asarray(np.divide(np.abs(found), areas, out=np.zeros(len(found)), where=areas > SMALL_REGION))


def _gained_areas(s: Simplification) -> Floats:
    """Area (r,) that chords enclose more than outlines do, by region number."""
    first, last = s.chords
    chain = s.chains.chain
    arcs = np.concatenate([[0], np.cumsum(cross(s.dense[:-1], s.dense[1:]) / 2)])
    difference = cross(s.places[first], s.places[last]) / 2 - (arcs[last] - arcs[first])
    size = len(s.outlines.labels)
    gained = np.bincount(s.outlines.left[chain[first]], difference, size) - np.bincount(s.outlines.right[chain[first]], difference, size)
    return np.asarray(gained, np.float64)
