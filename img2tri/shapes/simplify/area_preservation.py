"""Coarse outlines that enclose what the dense ones enclose.

A chord on a curve cuts a lens off: a disc drawn with edges of length h loses h^2 / 6 R^2 of its area, and a computation on it
that much of its exactness. Moving the breaks outwards gives it back at no cost.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.shapes.place.padded_chains import cross
from img2tri.shapes.simplify.simplification import Draft
from img2tri.shapes.simplify.vertex_offsets import Sideways, cut_off, lenses
from img2tri.shapes.trace.dual_edges import pixel_areas
from img2tri.types import Bools, Floats, Ints

AREA = 0.003  # of the smaller region beside a chain: what it may lack before it gets more breaks
GREAT = 0.8  # of the greatest lens of a chain: those that get the breaks
SMALL = 16  # pixels: the area of smaller regions is not looked after


def keep_areas(d: Draft, *, tolerance: float, whole: bool = False) -> Draft:
    """Move breaks sideways so that the chords enclose what the outlines enclose, chain by chain.

    A chord on a curve cuts a lens off. Each break takes up half of the lenses beside it; what then is missing of a chain, since
    some breaks cannot move, is shared evenly by the others. No break ends farther from the outline than the tolerance. Where
    that leaves a small region with too much or too little, breaks are added, to be moved the next time.

    `whole` chains are shifted, all their breaks by the same, and no breaks are added: what lies well for its lenses stays so.
    """
    first, last = d.pieces
    chain, size = d.links.chain, len(d.links.rings)
    free = Sideways(d)
    on, (area, width) = chain[free.at], (part[free.at] for part in lenses(d))
    lens = cut_off(d)
    lost = np.bincount(chain[first], lens, size).astype(np.float64)

    # Moving a break sideways by s sweeps s * width / 2.
    step = np.zeros(len(on)) if whole else area / width
    share = np.bincount(on, width / 2, size).astype(np.float64)
    missing = lost - np.bincount(on, step * width / 2, size)
    step += np.divide(missing, share, out=np.zeros_like(share), where=share > 0)[on]
    moved = free.moved(d.moved, step, tolerance)
    taken = ((moved - d.moved)[free.at] * free.right(d.moved).conj()).real
    lacking = np.abs(lost - np.bincount(on, taken * width / 2, size))
    breaks = d.breaks.copy()
    if not whole:
        breaks[_middles(d, first, last, np.abs(lens), lacking > AREA * _smaller_side(d))] = True
    return replace(d, breaks=breaks, moved=moved, measured=np.full(len(moved), -1), tested=np.full(len(moved), -1))


def area_error(d: Draft) -> float:
    """Greatest relative difference between what chords and outlines enclose, over the regions of more than `SMALL` pixels."""
    first, last = d.pieces
    z, chain = d.outlines.points[:, 0] + 1j * d.outlines.points[:, 1], d.links.chain
    dense = z[d.outlines.indices]
    runs = np.concatenate([[0], np.cumsum(cross(dense[:-1], dense[1:]) / 2)])
    difference = cross(d.places[first], d.places[last]) / 2 - (runs[last] - runs[first])
    size = len(d.outlines.labels)
    found = np.bincount(d.outlines.left[chain[first]], difference, size) - np.bincount(d.outlines.right[chain[first]], difference, size)
    areas = pixel_areas(d.links)
    big = np.flatnonzero(areas > SMALL)
    big = big[big > 0]
    return float(np.max(np.abs(found[big]) / areas[big], initial=0.0))


def _smaller_side(d: Draft) -> Floats:
    """Area (c,) of the smaller of the two regions beside each chain."""
    areas = pixel_areas(d.links)
    areas[0] = np.inf
    return np.asarray(np.minimum(areas[d.outlines.left], areas[d.outlines.right]))


def _middles(d: Draft, first: Ints, last: Ints, lens: Floats, chosen: Bools) -> Ints:
    """Middle entries of the pieces with the greatest lenses, in each of the chosen chains that have one to split."""
    chain = d.links.chain[first]
    able = np.flatnonzero(chosen[chain] & (last - first > 1))
    greatest = np.zeros(len(chosen))
    np.maximum.at(greatest, chain[able], lens[able])
    able = able[lens[able] >= GREAT * greatest[chain[able]]]
    return (first[able] + last[able]) // 2
