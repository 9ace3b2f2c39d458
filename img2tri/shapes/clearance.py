"""Which pieces of outlines come too near to each other, or meet at too sharp an angle.

Pieces are chords, each standing for a run of dense points that bulges from it by so much. Two pieces are clear of each other if they
are farther apart than both bulges, and a gap.
"""

from __future__ import annotations

import numpy as np

from img2tri.records import Bools, Floats, Ints
from img2tri.shapes.drafts import Draft

GAP = 0.25  # px, the least distance kept between pieces, over their bulges
SHARP = np.radians(50.0)  # pieces that meet at less are too sharp


def sharp_pieces(d: Draft, first: Ints, last: Ints) -> Bools:
    """Tell which pieces meet another one at a sharp angle."""
    n, place = len(first), d.places
    point = d.outlines.indices[np.concatenate([first, last])]
    heading = np.angle(np.concatenate([place[last] - place[first], place[first] - place[last]]))
    order = np.lexsort((heading, point))
    point, heading = point[order], heading[order]
    begin = np.flatnonzero(np.diff(point, prepend=-1))
    after = np.arange(1, 2 * n + 1)
    after[np.append(begin[1:], 2 * n) - 1] = begin
    turn = np.mod(heading[after] - heading, 2 * np.pi)
    pair = np.flatnonzero((turn < SHARP) & (after != np.arange(2 * n)))
    sharp = np.zeros(n, bool)
    sharp[order[pair] % n] = sharp[order[after[pair]] % n] = True
    return sharp


def crowded_pieces(d: Draft, first: Ints, last: Ints, fresh: Bools) -> Bools:
    """Tell which pieces come too near to another one that is not their neighbour, at least one of the two being fresh."""
    import shapely

    place, at = d.places, d.outlines.indices
    a, b = place[first], place[last]
    bulge = d.bulge[first]
    chords = shapely.linestrings(np.stack([np.stack([a.real, a.imag], 1), np.stack([b.real, b.imag], 1)], axis=1))
    reach = GAP + bulge[fresh] + bulge.max()
    i, j = shapely.STRtree(chords).query(chords[fresh], predicate="dwithin", distance=reach)
    i = np.flatnonzero(fresh)[i]
    apart = (at[first[i]] != at[first[j]]) & (at[first[i]] != at[last[j]]) & (at[last[i]] != at[first[j]]) & (at[last[i]] != at[last[j]])
    i, j = i[apart], j[apart]
    distance = shapely.distance(chords[i], chords[j])
    near = distance < GAP + bulge[i] + bulge[j]
    # Along the same chain two pieces are only near if the way between them is long for that.
    way = _way_between(d, first, last, i, j)
    near &= way > np.maximum(4 * distance, 1.0)
    crowded = np.zeros(len(first), bool)
    crowded[i[near]] = crowded[j[near]] = True
    return crowded


def _way_between(d: Draft, first: Ints, last: Ints, i: Ints, j: Ints) -> Floats:
    """Length of the chain between two pieces, infinite if they lie on different chains."""
    z, starts, chain = d.dense[d.outlines.indices], d.outlines.starts, d.links.chain
    arc = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    early, late = np.minimum(first[i], first[j]), np.maximum(first[i], first[j])
    end = np.where(first[i] < first[j], last[i], last[j])
    way = arc[late] - arc[end]
    on = chain[early]
    around = arc[starts[on + 1] - 1] - arc[starts[on]] - (arc[np.maximum(last[i], last[j])] - arc[early])
    way = np.where(d.links.rings[on], np.minimum(way, around), way)
    return np.where(chain[early] == chain[late], way, np.inf)
