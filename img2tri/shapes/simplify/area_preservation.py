"""Area-preserving simplification: coarse outlines that enclose what the dense ones enclose.

A chord on a curve cuts off what is between it and its arc: a disc drawn with edges of length h loses h^2 / 6 R^2 of its area, and a
computation on it that much of its exactness. Offsetting the vertices outwards gives it back at no cost.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, cross
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.simplify.vertex_offsets import NormalOffsets, areas_beside, chord_arc_areas
from img2tri.shapes.trace.dual_edges import pixel_areas

LACKING_AREA = 0.003  # of the smaller region beside a chain: what it may lack before it gets more vertices
GREAT = 0.8  # of the greatest chord-arc area of a chain: the chords that get them
SMALL_REGION = 16  # pixels: the area of smaller regions is not looked after


def preserve_areas(s: Simplification, *, tolerance: float, whole: bool = False, above: float = 0.0) -> Simplification:
    """Offset vertices along the normal so that the chords enclose what the outlines enclose, chain by chain.

    Each vertex takes up half of the chord-arc areas beside it; what then is missing of a chain, since some vertices cannot move, is
    shared evenly by the others. No vertex ends farther from the outline than the tolerance. Where that leaves a small region with too
    much or too little, vertices are added, to be offset the next time.

    With `above` only the chains beside regions whose relative error is greater are looked after. `whole` chains are shifted, all their
    vertices by the same, and no vertices are added: what lies well for its arcs stays so.
    """
    first, last = s.chords
    chain, size = s.chains.chain, len(s.chains.rings)
    free = NormalOffsets(s, snapped=not whole)
    on, (area, width) = chain[free.at], (part[free.at] for part in areas_beside(s))
    cut = chord_arc_areas(s)
    lost = np.bincount(chain[first], cut, size).astype(np.float64)

    # Offsetting a vertex by d more sweeps d * width / 2.
    step = np.zeros(len(on)) if whole else area / width
    share = np.bincount(on, width / 2, size).astype(np.float64)
    missing = lost - np.bincount(on, step * width / 2, size)
    step += np.divide(missing, share, out=np.zeros_like(share), where=share > 0)[on]
    chosen = np.ones(size, bool)
    if above:
        off = area_errors(s) > above
        chosen = off[s.outlines.left] | off[s.outlines.right]
        step[~chosen[on]] = 0
    offset = free.shifted(s.offset, step, tolerance)
    taken = ((offset - s.offset)[free.at] * free.right(s.offset).conj()).real
    lacking = np.abs(lost - np.bincount(on, taken * width / 2, size))
    kept = s.kept.copy()
    if not whole:
        kept[_middles(s, first, last, np.abs(cut), chosen & (lacking > LACKING_AREA * _smaller_side(s)))] = True
    return replace(s, kept=kept, offset=offset)


def area_errors(s: Simplification) -> Floats:
    """Relative difference (r,) between what chords and outlines enclose, by region number; 0 for regions of up to `SMALL_REGION` pixels."""
    first, last = s.chords
    chain = s.chains.chain
    arcs = np.concatenate([[0], np.cumsum(cross(s.dense[:-1], s.dense[1:]) / 2)])
    difference = cross(s.places[first], s.places[last]) / 2 - (arcs[last] - arcs[first])
    size = len(s.outlines.labels)
    found = np.bincount(s.outlines.left[chain[first]], difference, size) - np.bincount(s.outlines.right[chain[first]], difference, size)
    areas = pixel_areas(s.dual_edges)
    areas[0] = 0
    return np.asarray(np.divide(np.abs(found), areas, out=np.zeros(size), where=areas > SMALL_REGION))


def _smaller_side(s: Simplification) -> Floats:
    """Area (c,) of the smaller of the two regions beside each chain."""
    areas = pixel_areas(s.dual_edges)
    areas[0] = np.inf
    return np.asarray(np.minimum(areas[s.outlines.left], areas[s.outlines.right]))


def _middles(s: Simplification, first: Ints, last: Ints, cut: Floats, chosen: Bools) -> Ints:
    """Middle entries of the chords that cut off most, in each of the chosen chains that have one to split."""
    chain = s.chains.chain[first]
    able = np.flatnonzero(chosen[chain] & (last - first > 1))
    greatest = np.zeros(len(chosen))
    np.maximum.at(greatest, chain[able], cut[able])
    able = able[cut[able] >= GREAT * greatest[chain[able]]]
    return (first[able] + last[able]) // 2
