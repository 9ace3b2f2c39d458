"""Where a dense outline turns sharply without a corner: a vertex there spares a row of short chords around the turn.

A corner that a few gray pixels blur is found by no straight segments that meet, so it is rounded, a pixel or two wide. Vertices spaced
evenly pass it by; the chord that cuts it off is split until it is within the tolerance, and all edges around follow in length. A vertex
at the tip is within the tolerance of both sides at once::

        before  o----___                 behind  z[i - 4] ... z[i - 1]
                        ***o  i          ahead   z[i + 1] ... z[i + 4]
                           *
                           |  after      a turn: both straight, with a sharp angle between them; its tip is the
                           o             entry farthest from the chord over both

In the literature such a tip is a dominant point (Teh and Chin, "On the detection of dominant points on digital curves", IEEE
Transactions on Pattern Analysis and Machine Intelligence 11, 1989); here one size of support does, as blur has one size.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, as_complex, cross
from img2tri.shapes.place.padded_chains import PaddedChains
from img2tri.types import Outlines

TURN_SIDE = 4  # entries to either side of a turn
SHARP_ANGLE = 1.2  # radians between its sides, at least
STRAIGHT_SIDE = 0.985  # chord over arc of each side, at least
TURNS_APART = 8  # entries; turns that are nearer to each other, or to the end of a chain, are waves rather than corners


def sharp_turns(outlines: Outlines) -> Bools:
    """Tell which entries (k,) of the chains of dense outlines are tips of sharp turns.

    Examples
    --------
    >>> import numpy as np
    >>> from img2tri.arrays import ChainIndex
    >>> side = np.linspace(0, 10, 11)
    >>> points = np.concatenate([np.stack([side, 0 * side], axis=1), np.stack([10.4 + 0 * side, 0.4 + side], axis=1)])
    >>> chain = ChainIndex(np.arange(22), np.array([0, 22]), np.array([False]))
    >>> sharp_turns(Outlines(points, chain, np.array([1]), np.array([0]), np.array([0, 1]))).nonzero()[0].tolist()
    [11]
    """
    chains = outlines.chains
    found = np.zeros(len(chains.indices), bool)
    chosen = np.diff(chains.starts) > 2 * TURNS_APART
    if not chosen.any():
        return found
    line = PaddedChains(chains, chosen, TURN_SIDE + 1)
    z, real = line.points(as_complex(outlines.points)), line.own | line.ring
    # Each place with what is before and after it; the line has padding enough at both ends.
    at = np.arange(TURN_SIDE, len(z) - TURN_SIDE)
    behind, ahead, over = z[at - 1] - z[at - TURN_SIDE], z[at + TURN_SIDE] - z[at + 1], z[at + TURN_SIDE] - z[at - TURN_SIDE]
    arc = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])
    turns = np.abs(np.angle(ahead * behind.conj())) > SHARP_ANGLE
    turns &= np.abs(behind) > STRAIGHT_SIDE * (arc[at - 1] - arc[at - TURN_SIDE])
    turns &= np.abs(ahead) > STRAIGHT_SIDE * (arc[at + TURN_SIDE] - arc[at + 1])
    turns &= real[at - TURN_SIDE] & real[at + TURN_SIDE]
    height = np.zeros(len(z))
    height[at] = np.where(turns, np.abs(cross(z[at] - z[at - TURN_SIDE], over)) / np.maximum(np.abs(over), 1e-9), 0)
    # The last entry of a ring is its first again, which is a vertex in any case.
    own = chosen[chains.chain]
    own[chains.ring_ends[1]] = False
    found[own] = _tips(height)[line.own]
    return found & ~_crowded(found, np.concatenate([chains.first, chains.last]))


def _tips(height: Floats) -> Bools:
    """Tell which heights (k,) above 0 are greatest among those nearby; of equal ones the last is."""
    tip = height > 0
    for k in range(1, TURN_SIDE + 1):
        tip[k:] &= height[k:] >= height[:-k]
        tip[:-k] &= height[:-k] > height[k:]
    return tip


def _crowded(found: Bools, ends: Ints) -> Bools:
    """Tell which entries (k,) have another one of those found, or an end of a chain, near them."""
    marked = found.copy()
    marked[ends] = True
    at = marked.nonzero()[0]
    near = np.diff(at) < TURNS_APART
    crowded = np.zeros(len(found), bool)
    crowded[at[:-1][near]] = crowded[at[1:][near]] = True
    return crowded
