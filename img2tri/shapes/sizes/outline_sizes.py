"""How long the chords of outlines should be, at each dense point.

The least of: the length wanted, what the thickness of a region there allows, what the curvature there asks for; and where chords had to
be split in a first simplification, what came out of it. Then growth along the chains is limited, so that a short chord does not stand
beside a long one (gradient limiting; Persson, "Mesh size functions for implicit geometries and PDE-based gradient limiting", 2006, DOI
10.1007/s00366-006-0014-1): triangles are only as good as the outlines are even.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import ChainIndex, Floats, Ints, Points, as_rows, runs
from img2tri.shapes.place.padded_chains import PaddedChains
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.trace.dual_edges import DualEdges

PASSES = 3  # of limiting growth along the chains, between which nodes take the least of theirs
SHRINKINGS, EMPTY = 4, 0.98  # of balls; those with nothing nearer to their centre than this share of their radius are empty
BESIDE = 4  # entries to either side between which curvature is measured
EVERY = 3  # thickness is measured at each third dense point
OPPOSITE = 1.73  # two sides face each other if the ball between them touches them at least 120 degrees apart
ROOM_TO_EVEN = 1.25  # chords that had to be split may come out so much longer when they are spaced evenly


def limit_growth(size: Floats, z: Points, chains: ChainIndex, gradation: float) -> Floats:
    """Limit the growth of lengths (k,) along the chains to `gradation` per unit of arc.

    Where chains meet, all take the least length there.
    """
    arc, chain = arc_lengths(z, chains), chains.chain
    ends = np.concatenate([chains.first, chains.last])
    points, count = chains.indices[ends], int(chains.indices.max(initial=-1)) + 1
    apart = (size.max(initial=0.0) + gradation * arc.max(initial=0.0) + 1) * chain  # keeps chains from seeing each other
    for _ in range(PASSES):
        ahead = np.minimum.accumulate(size - gradation * arc - apart) + gradation * arc + apart
        back = np.minimum.accumulate((size + gradation * arc + apart)[::-1])[::-1] - gradation * arc - apart
        size = np.minimum(ahead, back)
        least = np.full(count, np.inf)
        np.minimum.at(least, points, size[ends])
        if (least[points] == size[ends]).all():
            break
        size[ends] = least[points]
    return size


def arc_lengths(z: Points, chains: ChainIndex) -> Floats:
    """Length of arc (k,) from the start of each chain; `z` are the places of its entries."""
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[chains.first] = 0
    arc = np.cumsum(step)
    return np.asarray(arc - arc[chains.first][chains.chain])


def by_thickness(z: Points, dual_edges: DualEdges, longest: float, elements: float) -> Floats:
    """Lengths (k,) that put `elements` of them across the regions, where these are thinner than that many of the longest.

    A ball that touches the outline from inside of a region is shrunk until it is empty: its diameter is the thickness (shrinking
    balls; Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field", 2012, DOI
    10.1007/s00371-011-0594-7).
    """
    size: Floats = np.full(len(z), longest)
    regions = dual_edges.regions
    at = (np.arange(len(z)) % EVERY == 0).nonzero()[0]
    at = at[(at > 0) & (at < len(z) - 1)]
    chain = dual_edges.chains.chain
    at = at[(chain[at - 1] == chain[at]) & (chain[at + 1] == chain[at])]
    heading = z[at + 1] - z[at - 1]
    for region, turn in ((regions[0], 1j), (regions[1], -1j)):
        inside = region[chain[at]] != 0
        i, inwards = at[inside], (turn * heading / np.maximum(np.abs(heading), 1e-12))[inside]
        thickness = _thickness(z, i, inwards, elements * longest)
        size[i] = np.minimum(size[i], thickness / elements)
    return size


def _thickness(z: Points, at: Ints, inwards: Points, greatest: float) -> Floats:
    """Diameter of the greatest empty ball that touches the outline at each entry and faces it, at most `greatest`."""
    from scipy.spatial import cKDTree

    tree = cKDTree(as_rows(z))
    radius, facing, going = np.full(len(at), greatest / 2), np.zeros(len(at), bool), np.arange(len(at))
    for _ in range(SHRINKINGS):
        centre = z[at[going]] + radius[going] * inwards[going]
        found = tree.query(as_rows(centre), distance_upper_bound=greatest)
        distance, nearest = np.asarray(found[0]), np.asarray(found[1])
        hit = distance < EMPTY * radius[going]
        going, nearest = going[hit], nearest[hit]
        if not len(going):
            break
        chord = z[nearest] - z[at[going]]
        depth = np.maximum((chord * inwards[going].conj()).real, 1e-9)
        radius[going] = np.minimum(np.abs(chord) ** 2 / (2 * depth), 0.999 * radius[going])
        facing[going] = np.abs(chord) > OPPOSITE * radius[going]
    return np.where(facing, 2 * radius, greatest)


def by_curvature(z: Points, chains: ChainIndex, longest: Floats | float, segments_per_turn: float, *, lasting: int = 1) -> Floats:
    """Lengths (k,) that make so many segments of a full turn, at most the longest (k,).

    Only as much curvature counts as lasts for `lasting` entries, an odd number: an outline that turns within fewer has a corner there,
    which short chords do not make rounder. So curvature, to the left and to the right, is opened by an interval (Serra, "Image analysis
    and mathematical morphology", 1982).
    """
    size = np.broadcast_to(longest, z.shape).astype(np.float64)
    chosen = np.diff(chains.starts) > max(lasting, 2)
    if not chosen.any():
        return size
    line = PaddedChains(chains, chosen, BESIDE + lasting)
    points = np.zeros(chains.indices.max() + 1, np.complex128)
    points[chains.indices] = z
    curvature = _curvature(line.points(points))
    curvature[~(line.own | line.ring)] = 0
    steepest = np.maximum(_opened(np.maximum(curvature, 0), lasting), _opened(np.maximum(-curvature, 0), lasting))
    # The last entry of a ring is its first again.
    start, end = chains.ring_ends
    own = chosen[chains.chain]
    own[end] = False
    allowed = np.full(len(z), np.inf)
    allowed[own] = 2 * np.pi / segments_per_turn / np.maximum(steepest[line.own], 1e-9)
    allowed[end] = allowed[start]
    return np.asarray(np.minimum(size, allowed))


def _curvature(line: Points) -> Floats:
    """Curvature (k,) at places on a line, positive where it turns left: the turn between chords to either side, over their length."""
    result = np.zeros(len(line))
    chord = line[BESIDE:] - line[:-BESIDE]
    behind, ahead = chord[:-BESIDE], chord[BESIDE:]
    result[BESIDE:-BESIDE] = np.angle(ahead * behind.conj()) / np.maximum((np.abs(behind) + np.abs(ahead)) / 2, 1e-9)
    return result


def _opened(values: Floats, width: int) -> Floats:
    """Lower each of the values (k,), above 0, to the greatest bound that as many in a row as the odd `width` reach."""
    return _sliding(np.maximum, _sliding(np.minimum, values, width), width)


def _sliding(extreme: np.ufunc, values: Floats, width: int) -> Floats:
    """Take the least, or the greatest, of each value (k,) and those beside it in a window of odd width; beyond the ends they are 0."""
    beyond = np.zeros(width // 2)
    found, reach = np.concatenate([beyond, values, beyond]), 1
    while reach < width:  # each entry has the extreme of `reach` values from there on
        further = min(reach, width - reach)
        found, reach = extreme(found[:-further], found[further:]), reach + further
    return np.asarray(found)


def by_chords(s: Simplification, wanted: Floats) -> Floats:
    """Lengths (k,) of the chords of a simplification that had to be split, with a little room; elsewhere those wanted."""
    first, last = s.chords
    length = ROOM_TO_EVEN * np.abs(s.places[last] - s.places[first])
    size = wanted.copy()
    which, place = runs(last - first + 1)
    np.minimum.at(size, first[which] + place, length[which])
    return size
