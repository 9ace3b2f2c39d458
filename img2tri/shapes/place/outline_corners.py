"""Where an outline has a corner, and where exactly it is.

From every crossing the outline is followed both ways along the longest straight line that passes through the bounds of its crossings: a
digital straight segment (Klette and Rosenfeld, "Digital straightness: a review", Discrete Applied Mathematics 139, 2004), fitted by least
squares. Where two long segments meet at an angle that no round outline of pixels could have, there is a corner, at the place where
their lines meet: as exact as the segments are long, and not where a smooth curve would pass, up to 0.7 px away.

How long is long? On a circle of radius R, pixels allow a straight segment no longer than sqrt(8 R) px, and two such segments meet at
an angle of no more than 8 / length. A sharper turn is a corner. Sides along the rows and columns of the image are straight
without any doubt, so for them three pixels will do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, cross
from img2tri.shapes.place.constrained_smoothing import BoundedChains
from img2tri.shapes.place.padded_chains import PaddedChains

LENGTHS = (3, 4, 6, 8, 12, 16, 24, 32)  # crossings that a segment is fitted to
ROUNDEST = 11.0  # px: segments of this length may meet at one radian on a circle, with some margin
SHORTEST_SIDE = 6.0  # px, the least length of a segment that is not along rows or columns
SHORTEST_ALIGNED = 2.9  # px, the least length of one that is
ON_LINE = 1e-6  # px, greatest distance of crossings from a segment along rows or columns
SKIPPED = (0, 1, 2)  # crossings between a segment and the corner it leads to, as these may belong to neither of two
SLOPPY = 0.09  # of the dual edge: how far a segment may miss the bounds of a crossing
OUT_OF_BLOCK = 1.65  # of the bounds of its block: how far out a corner may lie, which is then put back into the block
SAME_CORNER = 1.5  # px, corners nearer to each other are one
SAME_CROSSINGS = 4  # crossings within which they are looked for


def find_corners(s: BoundedChains, corners_after: Points, bounds: complex) -> tuple[Ints, Points]:
    """Find the corners of outlines.

    Parameters
    ----------
    s
        The crossings in their chains, where they lie as far as is known.
    corners_after
        (k,) the corner of pixels that follows each crossing.
    bounds
        How far a corner of the outline may lie from that, to the right plus i times up.

    Returns
    -------
    crossings : (m,) int64
        The crossing before each corner.
    places : (k,)
        Where the corners are.
    """
    found = [(np.zeros(0, np.int64), np.zeros(0, np.complex128))]
    for _, points, part in s.batches():
        crossings, places = _corners(part, corners_after[np.minimum(points, len(corners_after) - 1)], bounds)  # nodes have none
        found.append((points[crossings], places))
    crossings, places = (np.concatenate(part) for part in zip(*found, strict=True))
    return crossings, places


def _corners(s: BoundedChains, corners_after: Points, bounds: complex) -> tuple[Ints, Points]:
    """Find the corners of the outlines of a batch."""
    chosen = np.diff(s.chains.starts) > 2 * LENGTHS[0]
    if not chosen.any():
        return np.zeros(0, np.int64), np.zeros(0, np.complex128)
    line = PaddedChains(s.chains, chosen, max(LENGTHS) + 1)
    z = line.points(s.points)
    usable = (line.own | line.ring) & s.slides[line.source]
    at = _turns(z, np.flatnonzero(line.own[:-1] & usable[:-1] & usable[1:]))
    if not len(at):
        return np.zeros(0, np.int64), np.zeros(0, np.complex128)
    backs, aheads = _segments_around(s, line, z, usable, at)
    # A corner may lie on a dual edge; then the crossing there belongs to neither segment.
    score, off = np.zeros(len(at)), np.zeros(len(at), np.complex128)
    for back in backs:
        for ahead in aheads:
            new, place = _meeting(back, ahead)
            away = place - corners_after[line.source[at]]
            near = (np.abs(away.real) <= OUT_OF_BLOCK * bounds.real) & (np.abs(away.imag) <= OUT_OF_BLOCK * bounds.imag)
            better = near & (new > score)
            score[better], off[better] = new[better], away[better]
    sharp = np.flatnonzero(score)
    places = corners_after[line.source[at]] + off
    best = sharp[_best_nearby(at[sharp], places[sharp], score[sharp])]
    best = best[~_repeated(s, line.source[at[best]], places[best])]
    off = np.clip(off.real, -bounds.real, bounds.real) + 1j * np.clip(off.imag, -bounds.imag, bounds.imag)
    return line.source[at[best]], (corners_after[line.source[at]] + off)[best]


def _meeting(back: _Segments, ahead: _Segments) -> tuple[Floats, Points]:
    """Where the lines of two segments meet, and how sure it is that there is a corner: 0 where there is none."""
    turn = np.abs(np.angle(-ahead.direction * back.direction.conj()))
    length = np.minimum(back.length, ahead.length)
    sharp = (length >= SHORTEST_SIDE) & (turn * length >= ROUNDEST)
    sharp |= (back.miss < ON_LINE) & (ahead.miss < ON_LINE) & (turn > 1.5) & (turn < 1.7) & (length >= SHORTEST_ALIGNED)
    meet = cross(back.direction, ahead.direction)
    sharp &= np.abs(meet) > 1e-3
    place = back.point + back.direction * cross(ahead.point - back.point, ahead.direction) / np.where(sharp, meet, 1)
    return np.where(sharp, turn * length, 0), place


@dataclass(frozen=True, eq=False)
class _Segments:
    """Straight segments, one for each of n places: a point, a unit direction away from the place, a length, the greatest miss."""

    point: Points
    direction: Points
    length: Floats
    miss: Floats

    def at(self, chosen: Ints) -> _Segments:
        return _Segments(self.point[chosen], self.direction[chosen], self.length[chosen], self.miss[chosen])


def _turns(z: Points, at: Ints) -> Ints:
    """Places after which the outline may turn: sharply within two crossings, or by 45 degrees within six."""
    bent = np.zeros(len(at), bool)
    for reach, turn in ((2, 1.5), (6, 0.8)):
        inside = (at >= reach) & (at + 1 + reach < len(z))
        i = at[inside]
        bent[inside] |= np.abs(np.angle((z[i + 1 + reach] - z[i + 1]) * (z[i] - z[i - reach]).conj())) > turn
    return at[bent]


def _segments_around(s: BoundedChains, line: PaddedChains, z: Points, usable: Bools, at: Ints) -> tuple[list[_Segments], list[_Segments]]:
    """Fit segments that end in the places `at`, or one or two entries before; and segments that begin in the next entry, or after it.

    Neighbouring places ask for the same segments: each is fitted once, and all at once.
    """
    wanted = np.zeros((2, len(z)), bool)  # by their last entry backwards, by their first entry forwards
    for skip in SKIPPED:
        wanted[0, at - skip] = wanted[1, at + 1 + skip] = True
    forwards, entry = np.nonzero(wanted)
    found = _longest_segments(s, line, z, usable, entry, 2 * forwards - 1)
    number = np.cumsum(wanted).reshape(wanted.shape) - 1
    return [found.at(number[0, at - skip]) for skip in SKIPPED], [found.at(number[1, at + 1 + skip]) for skip in SKIPPED]


def _longest_segments(s: BoundedChains, line: PaddedChains, z: Points, usable: Bools, at: Ints, step: Ints) -> _Segments:
    """Fit segments of growing length from some places on, forwards or backwards; keep the longest that passes through all bounds.

    A line of least squares may miss bounds that another line passes: only two lengths in a row end the search.
    """
    n, source = len(at), line.source
    point, along, length, miss = np.zeros(n, np.complex128), np.ones(n, np.complex128), np.zeros(n), np.full(n, np.inf)
    axis, low, high = s.axis[source], s.low[source] - SLOPPY, s.high[source] + SLOPPY
    going, missed = np.arange(n), np.zeros(n, np.int64)
    for count in LENGTHS:
        window = np.clip(at[going, None] + step[going, None] * np.arange(count), 0, len(z) - 1)
        p = z[window]
        middle = p.mean(axis=1)
        d = p - middle[:, None]
        # The direction of least squares: half the argument of the sum of squares of complex offsets.
        direction = np.exp(0.5j * np.angle((d * d).sum(axis=1)))
        direction *= np.where(((p[:, -1] - p[:, 0]) * direction.conj()).real < 0, -1, 1)
        across = cross(axis[window], direction[:, None])
        beside = cross(d, direction[:, None])
        slide = -beside / np.where(across == 0, np.inf, across)
        hits = (slide > low[window]) & (slide < high[window]) & (across != 0) & usable[window]
        kept = hits.all(axis=1)
        fits = going[kept]
        point[fits], along[fits] = middle[kept], direction[kept]
        length[fits] = np.abs(p[kept, -1] - p[kept, 0]) + 1
        miss[fits] = np.abs(beside[kept]).max(axis=1)
        missed[going] = np.where(kept, 0, missed[going] + 1)
        going = going[missed[going] < 2]
        if not len(going):
            break
    return _Segments(point, along, length, miss)


def _repeated(s: BoundedChains, crossings: Ints, places: Points) -> Bools:
    """Tell which corners, at the end of a ring, are those at its beginning once more."""
    entry = np.zeros(len(s.points), np.int64)
    entry[s.chains.indices[::-1]] = np.arange(len(s.chains.indices))[::-1]
    at = entry[crossings]
    chain = np.searchsorted(s.chains.starts, at, side="right") - 1
    order = np.lexsort((at, chain))
    first = order[np.searchsorted(chain[order], chain)]
    round_trip = at[first] + np.diff(s.chains.starts)[chain] - 1 - at
    return np.asarray(
        s.chains.rings[chain]
        & (round_trip <= SAME_CROSSINGS)
        & (first != np.arange(len(at)))
        & (np.abs(places - places[first]) <= SAME_CORNER)
    )


def _best_nearby(at: Ints, corner: Points, score: Floats) -> Bools:
    """Tell which places `at`, in ascending order, have the best score of those that find the same corner."""
    best = np.ones(len(at), bool)
    for k in range(1, SAME_CROSSINGS + 1):
        near = (at[k:] - at[:-k] <= SAME_CROSSINGS) & (np.abs(corner[k:] - corner[:-k]) <= SAME_CORNER)
        first_wins = score[:-k] >= score[k:]
        best[k:] &= ~(near & first_wins)
        best[:-k] &= ~(near & ~first_wins)
    return best
