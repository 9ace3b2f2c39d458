"""The first layer of points in front of the outlines.

In: the segments and the wanted edge length at each. Out: one point per side of a segment, the apex of a nearly equilateral triangle
over it, thinned out where apexes crowd. This layer decides the worst angle of a mesh: a lattice that just ends near the outline
leaves angles of 26 to 30 degrees which no smoothing lifts; with the layer they are 40 and more.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from img2tri.triangles.generate.graded_lattice import pairs
from img2tri.triangles.generate.hexagonal_lattice import Complex
from img2tri.triangles.generate.pslg import Network
from img2tri.types import Bools, Floats, Ints

CROWDED = 0.68  # two points nearer than this times the wanted edge length are one too many
MIDDLE = 0.6  # the middle of a segment keeps others off by this part of what a point does: an apex may look at it from near


def apexes(network: Network, wanted: Floats) -> tuple[Complex, Floats]:
    """Put an apex over both sides of each segment, where there is a region; return places and wanted edge lengths.

    `wanted` are the lengths at the segments. Over a segment of length l the sides of the triangle get (l + wanted) / 2.
    """
    start, stop = network.ends
    length = network.lengths
    up = 1j * (stop - start) / length * 0.5 * np.sqrt(wanted * (wanted + 2 * length))
    on_left, on_right = network.left != 0, network.right != 0
    places = np.concatenate([(network.middles + up)[on_left], (network.middles - up)[on_right]])
    return places, np.concatenate([wanted[on_left], wanted[on_right]])


def keepers(network: Network, at_points: Floats, at_middles: Floats) -> tuple[Complex, Floats]:
    """Return places on the network, and the lengths by which others are kept off: the points, and the middles, which keep less."""
    return np.concatenate([network.points, network.middles]), np.concatenate([at_points, MIDDLE * at_middles])


def spread(points: Complex, wanted: Floats, fixed: int) -> Bools:
    """Choose which points may stay, so that none of those after the first `fixed` is crowded. Lower numbers win.

    A point is crowded if another one that stays lies nearer than `CROWDED` times the smaller of their wanted edge lengths.
    """
    first, second = _neighbours(points, wanted)
    near = np.abs(points[first] - points[second]) < CROWDED * np.minimum(wanted[first], wanted[second])
    near &= second >= fixed
    first, second = first[near], second[near]
    stays = np.ones(len(points), bool)
    open_ = np.ones(len(first), bool)
    # A point falls if it is near a lower one that surely stays: one not near any lower one itself. Then look again.
    while open_.any():
        safe = np.ones(len(points), bool)
        safe[second[open_]] = False
        falls = second[open_ & safe[first]]
        stays[falls] = False
        open_ &= stays[first] & stays[second]
    return stays


def _neighbours(points: Complex, wanted: Floats) -> tuple[Ints, Ints]:
    """All pairs of points that may be crowded, lower number first; some may come twice.

    Searching within the largest length would find far too many pairs where lengths are small. So lengths go in classes which
    overlap: those of two neighbours differ by less than the overlap.
    """
    found = [np.zeros((0, 2), np.int64)]
    top = float(wanted.max(initial=0.0))
    while top > 0.4 * wanted.min(initial=np.inf):
        members = np.flatnonzero((wanted <= top) & (wanted > 0.3 * top))
        tree = cKDTree(pairs(points[members]))
        found.append(np.sort(members[tree.query_pairs(CROWDED * top, output_type="ndarray")], axis=1))
        top /= 2
    first, second = np.concatenate(found).T
    return first, second
