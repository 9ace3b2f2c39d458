"""Where a dense outline turns sharply without a corner: a vertex there spares a row of short chords around the turn.

A corner that gray pixels blur is found by no straight segments that meet, so it is rounded, some pixels wide. Vertices spaced evenly pass
it by; the chord that cuts it off is split until it is within the tolerance, and all edges around follow in length. A vertex at the tip,
offset a little to where the sides meet, is within the tolerance of both sides at once::

        before  o----___      x          behind  z[i - far] ... z[i - near]
                        ***o             ahead   z[i + near] ... z[i + far]
                           *  i
                           o             a turn: both straight, with a sharp angle between them, and where they meet, x, is near;
                           |  after      its tip is the entry nearest to that
                           o

In the literature such a tip is a dominant point (Teh and Chin, "On the detection of dominant points on digital curves", IEEE
Transactions on Pattern Analysis and Machine Intelligence 11, 1989); here sides of one length do, beside tips of two widths, as blur has
few. Sides of wide tips have to be straighter, for no circle to have any.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, cross
from img2tri.shapes.place.padded_chains import PaddedChains
from img2tri.types import Outlines

TURN_SIDE = 4  # entries of each side of a turn
TIP = (0, 3)  # entries between a tip and its sides
STRAIGHT_SIDE = (0.985, 0.996)  # by these, chord over arc of each side, at least
SHARP_ANGLE = 1.2  # radians between its sides, at least
TIP_OFFSET = (
    0.2  # of the tolerance: how far vertices go towards where the sides meet; farther, those of rough outlines are in each other's way
)
MOST_BLUNT = 2.5  # px from the tip to where its sides meet, at most
TURNS_APART = 8  # entries; turns that are nearer to each other, or to the end of a chain, are waves rather than corners


def sharp_turns(outlines: Outlines, *, tolerance: float) -> tuple[Bools, Points]:
    """Tell which entries (k,) of the chains of dense outlines are tips of sharp turns.

    Returned with it is the way from them to where their sides meet, by `TIP_OFFSET` of the tolerance at most; 0 elsewhere.

    Examples
    --------
    >>> import numpy as np
    >>> from img2tri.arrays import ChainIndex
    >>> side = np.linspace(0, 10, 11)
    >>> points = np.concatenate([np.stack([side, 0 * side], axis=1), np.stack([10.4 + 0 * side, 0.4 + side], axis=1)])
    >>> chain = ChainIndex(np.arange(22), np.array([0, 22]), np.array([False]))
    >>> tips, ways = sharp_turns(Outlines(points, chain, np.array([1]), np.array([0]), np.array([0, 1])), tolerance=3.0)
    >>> tips.nonzero()[0], ways[tips].round(3)
    (array([11]), array([0.-0.4j]))
    """
    chains = outlines.chains
    found, ways = np.zeros(len(chains.indices), bool), np.zeros(len(chains.indices), np.complex128)
    chosen = np.diff(chains.starts) > 2 * TURNS_APART
    if not chosen.any():
        return found, ways
    line = PaddedChains(chains, chosen, max(TIP) + TURN_SIDE + 1)
    z, real = line.points(as_complex(outlines.points)), line.own | line.ring
    # The last entry of a ring is its first again, which is a vertex in any case.
    own = chosen[chains.chain]
    own[chains.ring_ends[1]] = False
    for tip, straight in zip(TIP, STRAIGHT_SIDE, strict=True):
        nearness, meet = np.zeros(len(z)), np.zeros(len(z), np.complex128)
        at, way = _turns(z, real, tip, straight)
        nearness[at], meet[at] = MOST_BLUNT - np.abs(way), way
        new = np.zeros(len(found), bool)
        new[own] = _nearest(nearness)[line.own]
        if found.any():
            new &= np.convolve(found, np.ones(2 * TURNS_APART - 1), "same") < 0.5
        ways[own] = np.where(new[own], meet[line.own], ways[own])
        found |= new
    found &= ~_crowded(found, np.concatenate([chains.first, chains.last]))
    length = np.abs(ways)
    return found, np.where(found, ways * (np.minimum(length, TIP_OFFSET * tolerance) / np.maximum(length, 1e-12)), 0)


def _turns(z: Points, real: Bools, tip: int, straight: float) -> tuple[Ints, Points]:
    """Return which places turn sharply between two straight sides, so many entries from them, and the ways to where the sides meet.

    Of all places there are the points (k,), and whether they are on the outline.
    """
    near, far = tip + 1, tip + TURN_SIDE
    size = len(z)
    behind, ahead = z[far - near : size - far - near] - z[: size - 2 * far], z[2 * far :] - z[far + near : size - far + near]
    at = ((ahead * behind.conj()).real < np.cos(SHARP_ANGLE) * np.abs(ahead) * np.abs(behind)).nonzero()[0]
    behind, ahead, at = behind[at], ahead[at], at + far
    arc = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])
    turns = (np.abs(behind) > straight * (arc[at - near] - arc[at - far])) & real[at - far]
    turns &= (np.abs(ahead) > straight * (arc[at + far] - arc[at + near])) & real[at + far]
    across = cross(behind, ahead)
    turns &= across != 0
    at, behind, ahead, across = at[turns], behind[turns], ahead[turns], across[turns]
    way = z[at - near] - z[at] + behind * cross(z[at + near] - z[at - near], ahead) / across
    close = np.abs(way) < MOST_BLUNT
    return at[close], way[close]


def _nearest(nearness: Floats) -> Bools:
    """Tell which values (k,) above 0 are greatest among those nearby; of equal ones the last is."""
    tip = nearness > 0
    for k in range(1, TURN_SIDE + 1):
        tip[k:] &= nearness[k:] >= nearness[:-k]
        tip[:-k] &= nearness[:-k] > nearness[k:]
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
