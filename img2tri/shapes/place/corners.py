"""Where an outline has a corner, and where exactly it is.

From every crossing the outline is followed both ways, along the longest straight line that passes through the ranges of its
crossings. Where two long lines meet at an angle that no round outline of pixels could have, there is a corner, at the place
where the lines meet: as exact as the lines are long, and not where a smooth curve would pass, up to 0.7 px away.

How long is long? On a circle of radius R, pixels allow a straight line no longer than sqrt(8 R) px, and two such lines meet at
an angle of no more than 8 / length. A sharper turn is a corner. Sides along the rows and columns of the image are straight
without any doubt, so for them three pixels will do.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from img2tri.shapes.place.constrained_smoothing import Sliding
from img2tri.shapes.place.padded_chains import Points, Unrolled, cross
from img2tri.types import Bools, Floats, Ints

LENGTHS = (3, 4, 6, 8, 12, 16, 24, 32)  # crossings that a line is fitted to
ROUND = 11.0  # px: lines of this length may meet at one radian on a circle, with some margin
SHORTEST = 6.0  # px, the least length of a line that is not along rows or columns
ALIGNED = 2.9  # px, the least length of one that is
EXACT = 1e-6  # px, greatest distance of crossings from a line along rows or columns
SLOPPY = 0.09  # of the link: how far a line may miss the range of a crossing
BEYOND = 1.65  # of the room in its block: how far out a corner may lie, it is then put back into the block
APART = 1.5  # px
SAME = 4  # crossings within which only one corner is kept


def find_corners(s: Sliding, heads: Points, room: complex) -> tuple[Ints, Points]:
    """Find the corners of outlines.

    Parameters
    ----------
    s
        The crossings in their chains, where they lie as far as is known.
    heads
        (n,) the corner of pixels that follows each crossing.
    room
        How far a corner may lie from that, to the right plus i times up.

    Returns
    -------
    crossings : (k,) int64
        The crossing before each corner.
    places : (k,)
        Where the corners are.
    """
    chosen = np.diff(s.starts) > 2 * LENGTHS[0]
    if not chosen.any():
        return np.zeros(0, np.int64), np.zeros(0, np.complex128)
    line = Unrolled(s.indices, s.starts, s.rings, chosen, max(LENGTHS) + 1)
    z = line.points(s.points)
    usable = (line.own | line.ring) & (s.axis[line.source] != 0)
    at = _bends(z, np.flatnonzero(line.own[:-1] & usable[:-1] & usable[1:]))
    if not len(at):
        return np.zeros(0, np.int64), np.zeros(0, np.complex128)
    backs = [_longest_line(s, line, z, usable, at - skip, -1) for skip in (0, 1, 2)]
    aheads = [_longest_line(s, line, z, usable, at + 1 + skip, 1) for skip in (0, 1, 2)]
    # A corner may lie on a link; then the crossing there belongs to neither line.
    score, off = np.zeros(len(at)), np.zeros(len(at), np.complex128)
    for back in backs:
        for ahead in aheads:
            new, place = _meeting(back, ahead)
            away = place - heads[line.source[at]]
            near = (np.abs(away.real) <= BEYOND * room.real) & (np.abs(away.imag) <= BEYOND * room.imag)
            better = near & (new > score)
            score[better], off[better] = new[better], away[better]
    sharp = np.flatnonzero(score)
    places = heads[line.source[at]] + off
    best = sharp[_best_nearby(at[sharp], places[sharp], score[sharp])]
    best = best[~_again(s, line.source[at[best]], places[best])]
    off = np.clip(off.real, -room.real, room.real) + 1j * np.clip(off.imag, -room.imag, room.imag)
    return line.source[at[best]], (heads[line.source[at]] + off)[best]


def _meeting(back: _Lines, ahead: _Lines) -> tuple[Floats, Points]:
    """Where two lines meet, and how sure it is that they meet in a corner: 0 where there is none."""
    turn = np.abs(np.angle(-ahead.direction * back.direction.conj()))
    length = np.minimum(back.length, ahead.length)
    sharp = (length >= SHORTEST) & (turn * length >= ROUND)
    sharp |= (back.miss < EXACT) & (ahead.miss < EXACT) & (turn > 1.5) & (turn < 1.7) & (length >= ALIGNED)
    meet = cross(back.direction, ahead.direction)
    sharp &= np.abs(meet) > 1e-3
    place = back.point + back.direction * cross(ahead.point - back.point, ahead.direction) / np.where(sharp, meet, 1)
    return np.where(sharp, turn * length, 0), place


class _Lines:
    """Straight lines, one for each of `n` places: a point, a unit direction away from the place, a length, the greatest miss."""

    def __init__(self, n: int) -> None:
        self.point, self.direction = np.zeros(n, np.complex128), np.ones(n, np.complex128)
        self.length, self.miss = np.zeros(n), np.full(n, np.inf)


def _bends(z: Points, at: Ints) -> Ints:
    """Places after which the line may turn: sharply within two crossings, or by 45 degrees within six."""
    bent = np.zeros(len(at), bool)
    for reach, turn in ((2, 1.5), (6, 0.8)):
        inside = (at >= reach) & (at + 1 + reach < len(z))
        i = at[inside]
        bent[inside] |= np.abs(np.angle((z[i + 1 + reach] - z[i + 1]) * (z[i] - z[i - reach]).conj())) > turn
    return at[bent]


def _longest_line(s: Sliding, line: Unrolled, z: Points, usable: NDArray[np.bool_], at: Ints, step: int) -> _Lines:
    """Fit lines of growing length from some places on, forwards or backwards; keep the longest that passes through all ranges.

    A line of least squares may miss a range that another line passes: only two lengths in a row end the search.
    """
    best, going, missed = _Lines(len(at)), np.arange(len(at)), np.zeros(len(at), np.int64)
    for count in LENGTHS:
        window = np.clip(at[going, None] + step * np.arange(count), 0, len(z) - 1)
        p = z[window]
        middle = p.mean(axis=1)
        d = p - middle[:, None]
        # The direction of least squares: half the argument of the sum of squares of complex offsets.
        direction = np.exp(0.5j * np.angle((d * d).sum(axis=1)))
        direction *= np.where(((p[:, -1] - p[:, 0]) * direction.conj()).real < 0, -1, 1)
        across = cross(s.axis[line.source[window]], direction[:, None])
        slide = -cross(d, direction[:, None]) / np.where(across == 0, np.inf, across)
        source = line.source[window]
        hits = (slide > s.low[source] - SLOPPY) & (slide < s.high[source] + SLOPPY) & (across != 0) & usable[window]
        kept = hits.all(axis=1)
        fits = going[kept]
        best.point[fits], best.direction[fits] = middle[kept], direction[kept]
        best.length[fits] = np.abs(p[kept, -1] - p[kept, 0]) + 1
        best.miss[fits] = np.abs(cross(d, direction[:, None])).max(axis=1)[kept]
        missed[going] = np.where(kept, 0, missed[going] + 1)
        going = going[missed[going] < 2]
        if not len(going):
            break
    return best


def _again(s: Sliding, crossings: Ints, places: Points) -> Bools:
    """Tell which corners, at the end of a ring, are those at its beginning once more."""
    entry = np.zeros(len(s.points), np.int64)
    entry[s.indices[::-1]] = np.arange(len(s.indices))[::-1]
    at = entry[crossings]
    chain = np.searchsorted(s.starts, at, side="right") - 1
    order = np.lexsort((at, chain))
    first = order[np.searchsorted(chain[order], chain)]
    round_trip = at[first] + np.diff(s.starts)[chain] - 1 - at
    return np.asarray(s.rings[chain] & (round_trip <= SAME) & (first != np.arange(len(at))) & (np.abs(places - places[first]) <= APART))


def _best_nearby(at: Ints, corner: Points, score: Floats) -> Bools:
    """Tell which places have the best score among those within `SAME` crossings and with their corners `APART` or nearer; `at` ascends."""
    best = np.ones(len(at), bool)
    for k in range(1, SAME + 1):
        near = (at[k:] - at[:-k] <= SAME) & (np.abs(corner[k:] - corner[:-k]) <= APART)
        first_wins = score[:-k] >= score[k:]
        best[k:] &= ~(near & first_wins)
        best[:-k] &= ~(near & ~first_wins)
    return best
