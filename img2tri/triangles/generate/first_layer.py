"""The first layer of points in front of the outlines, as in the advancing-front method.

In: the segments and the wanted edge length at each. Out: one point per side of a segment, the apex of a nearly equilateral triangle
over it, thinned out where apexes crowd. This layer decides the worst angle of a mesh: a lattice that just ends near the outline
leaves angles of 26 to 30 degrees which no smoothing lifts; with the layer they are 40 and more. It is the first front of S. H. Lo,
A new mesh generation scheme for arbitrary planar domains, Int. J. Numer. Methods Eng. 21, 1985, https://doi.org/10.1002/nme.1620210805;
a second one gains nothing.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, independent
from img2tri.cell_lists import cells, pairs_beside
from img2tri.triangles.generate.pslg import Pslg

CROWDED = 0.68  # two points nearer than this times the wanted edge length are one too many
SPAN = 0.3  # lengths of a class, over its longest; classes begin at halves, so that they overlap: anything below a half serves


def apexes(pslg: Pslg, wanted: Floats) -> tuple[Points, Floats]:
    """Put an apex over both sides of each segment, where there is a region; return places and wanted edge lengths.

    `wanted` are the lengths at the segments. Over a segment of length l the sides of the triangle get (l + wanted) / 2.
    """
    start, stop = pslg.ends
    length = pslg.lengths
    up = 1j * (stop - start) / length * 0.5 * np.sqrt(wanted * (wanted + 2 * length))
    on_left, on_right = pslg.left != 0, pslg.right != 0
    places = np.concatenate([(pslg.middles + up)[on_left], (pslg.middles - up)[on_right]])
    return places, np.concatenate([wanted[on_left], wanted[on_right]])


def uncrowded(points: Points, wanted: Floats, fixed: int) -> Bools:
    """Choose which points (n,) may stay, so that none of those after the first `fixed` is crowded. Lower numbers win.

    A point is crowded if another one that stays lies nearer than `CROWDED` times the smaller of their wanted edge lengths.
    """
    lower, higher = _neighbours(points, wanted)
    near = np.abs(points[lower] - points[higher]) < CROWDED * np.minimum(wanted[lower], wanted[higher])
    near &= higher >= fixed
    return independent(lower[near], higher[near], len(points))


def _neighbours(points: Points, wanted: Floats) -> tuple[Ints, Ints]:
    """All pairs of points that may be crowded, lower number first; some may come twice.

    Searching within the largest length would find far too many pairs where lengths are small. So lengths go in classes which
    overlap: the wanted lengths of two neighbours differ by less than the overlap.
    """
    found = [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    top, least = float(wanted.max(initial=0.0)), float(wanted.min(initial=np.inf))
    halvings = max(0, int(np.ceil(np.log2(top / (0.4 * least))))) if top > 0 else 0
    for longest in top / 2.0 ** np.arange(halvings):
        members = ((wanted <= longest) & (wanted > SPAN * longest)).nonzero()[0]
        if len(members):
            cell, above = cells(points[members], CROWDED * longest)
            order = np.argsort(cell)
            found.append(pairs_beside(members[order], cell[order], above))
    i, j = (np.concatenate(part) for part in zip(*found, strict=True))
    return np.minimum(i, j), np.maximum(i, j)
