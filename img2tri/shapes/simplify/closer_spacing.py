"""Regions that lack area though their vertices are offset as far as they may be -> their curves with more vertices, as even as before.

A chord of length h on a curve of radius R cuts off an area of h^3 / 12 R; vertices offset by h^2 / 12 R give that back. So where vertices
are at their limit, and areas are still lacking, the number of chords grows by the root of what offsets would have to be over what they may
be. Put evenly, few vertices do: an octagon becomes a nonagon. Middles of some chords would be more, with small triangles beside them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, runs
from img2tri.shapes.simplify.simplification import SAME_PLACE, Simplification, space_evenly
from img2tri.shapes.simplify.vertex_offsets import MOST_OFFSET, NormalOffsets, areas_beside, chord_arc_areas

GREAT = 0.8  # of the greatest need beside a region: the runs that get one more chord in any case


def spaced_closer(s: Simplification, off: Bools, *, tolerance: float) -> Simplification:
    """Space vertices closer, and offset them, for the sake of regions (r,) whose areas are off.

    That is done by *runs* of chords, between two vertices that cannot be offset: nodes, corners, snapped ones; and the first of a ring.
    """
    free = np.zeros(len(s.kept), bool)
    free[NormalOffsets(s).at] = True
    hinges = s.kept & ~free
    hinges[s.chains.first] = True
    first, last = s.chords
    run = np.cumsum(hinges[first]) - 1
    factor = _closer(s, run, free, off, tolerance)
    # All entries but the last of each chain belong to the chord that begins at or before them.
    chord, place = runs(last - first)
    at, arc = first[chord] + place, np.concatenate([[0], np.cumsum(np.abs(np.diff(s.dense)))])
    spacing = np.full(len(s.kept), np.inf)
    spacing[at] = np.maximum((arc[last] - arc[first]) / factor[run], SAME_PLACE)[chord]
    spacing[s.chains.last] = spacing[s.chains.last - 1]
    even = space_evenly(s.outlines, s.dual_edges, spacing=spacing, posts=hinges)
    # Of a few pixels, even places may have the same ones: then chords are halved instead.
    more = np.bincount(run[chord], even.kept[at]) > np.bincount(run)
    halved = (factor > 1) & ~more
    anew = np.zeros(len(s.kept), bool)
    anew[at] = ((factor > 1) & more)[run][chord] & ~hinges[at]
    kept = np.where(anew, even.kept, s.kept)
    kept[((first + last) // 2)[halved[run]]] = True
    s = replace(s, kept=kept, offset=np.where(anew, even.offset, s.offset))
    offsets = NormalOffsets(s)
    area, width = (part[offsets.at] for part in areas_beside(s))
    return replace(s, offset=offsets.shifted(s.offset, np.where(anew[offsets.at], area / width, 0), tolerance))


def _closer(s: Simplification, run: Ints, free: Bools, off: Bools, tolerance: float) -> Floats:
    """Return how many times as many chords each run (q,) gets for regions (r,) that are off.

    Given are the run (c,) of each chord, and which entries (k,) can be offset.
    """
    first, last = s.chords
    count, fixed = np.bincount(run), np.bincount(run, ~free[first])
    length = np.bincount(run, np.abs(s.places[last] - s.places[first]))
    cut = np.abs(np.bincount(run, chord_arc_areas(replace(s, offset=np.zeros_like(s.offset)))))
    # Of n chords that cut off an area A, f of which begin at a fixed vertex, m cut off A (n / m)^2, and the m - f vertices between them can
    # give back so much of their share of the length; the two are equal for this m.
    wanted = fixed / 2 + np.sqrt(fixed**2 / 4 + count**2 * cut / (length * MOST_OFFSET * tolerance))
    left, right = s.outlines.left[s.chains.chain[first]], s.outlines.right[s.chains.chain[first]]
    near = np.bincount(run, off[left] | off[right]) > 0
    # Where that does not do, one more where it helps most.
    helps, greatest = ((wanted - fixed) / count * (np.bincount(run, last - first) > count))[run], np.zeros(len(off))
    for side in (left, right):
        np.maximum.at(greatest, side, helps)
    most = np.any([off[side] & (helps > 0) & (helps >= GREAT * greatest[side]) for side in (left, right)], axis=0)
    return np.asarray(np.maximum(np.where(near, np.ceil(wanted), 0), count + (np.bincount(run, most) > 0)) / count)
