"""The planar straight-line graph (PSLG) of the outlines, and its segments divided to the wanted edge length.

In: points, segments that meet in their end points only, the region on either side of each. Out: the same with segments divided, so that
none is much longer than the size function asks. The term is that of F. P. Preparata and M. I. Shamos, Computational Geometry, 1985.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from img2tri.arrays import Floats, Ints, Points, runs
from img2tri.triangles.generate.interior_sizes import SizeFunction
from img2tri.triangles.generate.quality_smoothing import SlideLines

ROUND_UP = 0.4  # a segment of n + this many wanted lengths or more is divided into n + 1 parts


@dataclass(frozen=True, eq=False)
class Pslg:
    """Points joined by segments, with the regions on both sides.

    Attributes
    ----------
    points
        (n,) complex.
    segments
        (s, 2) int64.
    left, right
        (s,) int64, codes of the regions: small numbers, 0 for what is not meshed.
    origin
        (s,) int64, which of the segments given by the caller each is, or is a part of; -1 for none.
    """

    points: Points
    segments: Ints
    left: Ints
    right: Ints
    origin: Ints

    @cached_property
    def ends(self) -> tuple[Points, Points]:
        """First and last point of each segment."""
        return self.points[self.segments[:, 0]], self.points[self.segments[:, 1]]

    @cached_property
    def middles(self) -> Points:
        """Middle of each segment."""
        start, stop = self.ends
        return (start + stop) / 2

    @cached_property
    def lengths(self) -> Floats:
        """Length of each segment."""
        start, stop = self.ends
        return np.abs(stop - start)

    def divided(self, sizes: SizeFunction) -> tuple[Pslg, Floats, Floats]:
        """Divide segments that are too long for the wanted length, with parts that grow as it does. The points stay the first ones.

        Also return the wanted length at the points, and at the middles of the segments.

        From either end to the middle the wanted length is taken as linear, from a to b. Then a stretch of length l holds
        l log(b / a) / (b - a) wanted lengths, and parts of equal share grow in geometric progression.
        """
        at_points, at_middles = np.split(sizes.at(np.concatenate([self.points, self.middles])), [len(self.points)])
        first, last = at_points[self.segments].T
        half = self.lengths / 2
        first_share, last_share = half / _log_mean(first, at_middles), half / _log_mean(last, at_middles)
        shares = first_share + last_share
        parts = np.maximum(1, np.ceil(shares - ROUND_UP)).astype(np.int64)
        if not len(parts) or parts.max() == 1:
            return self, at_points, at_middles
        of, part = runs(parts)
        new = (part > 0).nonzero()[0]
        share = (part / parts[of] * shares[of])[new]
        # Measured from the nearer end, in shares of the half on this side.
        head = share < first_share[of[new]]
        end = np.where(head, first[of[new]], last[of[new]])
        within = np.where(head, share / first_share[of[new]], (shares[of[new]] - share) / last_share[of[new]])
        way = _geometric(within, at_middles[of[new]] / end) / 2
        start, stop = self.ends
        points = start[of[new]] + (stop - start)[of[new]] * np.where(head, way, 1 - way)
        segments = self.segments[of]
        segments[new, 0] = segments[new - 1, 1] = len(self.points) + np.arange(len(new))
        divided = Pslg(np.concatenate([self.points, points]), segments, self.left[of], self.right[of], self.origin[of])
        at_middles = at_middles[of]
        changed = (parts[of] > 1).nonzero()[0]
        at_new, at_middles[changed] = np.split(sizes.at(np.concatenate([points, divided.middles[changed]])), [len(points)])
        return divided, np.concatenate([at_points, at_new]), at_middles

    def slide_lines(self, limits: Floats, *, within: float = 0.0) -> SlideLines:
        """Let the first points slide parallel to the line between their neighbours, within limits; but not where segments were divided.

        With `within` they do so there too, and the points in between by this share of the shorter part beside them: see `on_segments`.
        """
        start, stop = self.segments.T
        before, after = np.zeros((2, len(self.points)), np.complex128)
        before[stop], after[start] = self.points[start], self.points[stop]
        own = self.origin >= 0
        divided = own & (np.bincount(self.origin[own])[self.origin] > 1)
        stays = np.zeros(len(self.points), bool)
        stays[self.segments[divided]] = True
        n, shorter = len(limits), np.minimum(np.abs(self.points - before), np.abs(after - self.points))
        room = within * shorter * stays
        room[:n] = np.where(stays[:n] & (within == 0), 0.0, limits)
        at = (room > 0).nonzero()[0]
        along = after[at] - before[at]
        return SlideLines(at, along / np.abs(along), self.points[at], room[at])

    def on_segments(self, n: int, points: Points) -> Points:
        """Put the points after the first n that divide a segment back on the line between its ends, where they are nearest to it.

        `points` are places for the points, those that the segments end with among the first n.
        """
        own = (self.origin >= 0).nonzero()[0]
        start, stop = self.segments[own].T
        head, tail = own[start < n], own[stop < n]
        ends = np.zeros((2, int(self.origin.max(initial=-1)) + 1), np.int64)
        ends[0, self.origin[head]], ends[1, self.origin[tail]] = self.segments[head, 0], self.segments[tail, 1]
        between = own[start >= n]
        at, (a, b) = self.segments[between, 0], points[ends[:, self.origin[between]]]
        points = points.copy()
        points[at] = a + np.clip(((points[at] - a) / (b - a)).real, 0, 1) * (b - a)
        return points

    def joined(self, points: Points, segments: Ints, right: Ints) -> Pslg:
        """Add points, and segments between these, with nothing meshed on their left."""
        none = np.zeros(len(segments), np.int64)
        return Pslg(
            points=np.concatenate([self.points, points]),
            segments=np.concatenate([self.segments, segments + len(self.points)]),
            left=np.concatenate([self.left, none]),
            right=np.concatenate([self.right, right]),
            origin=np.concatenate([self.origin, none - 1]),
        )


def _log_mean(a: Floats, b: Floats) -> Floats:
    """Logarithmic mean (b - a) / log(b / a), which is a where b is."""
    x = np.log(b / a)
    small = np.abs(x) < 1e-5
    mean: Floats = a * np.where(small, 1 + x / 2, np.expm1(x) / np.where(small, 1, x))
    return mean


def _geometric(share: Floats, ratio: Floats) -> Floats:
    """Part of the way after a share of steps that grow by `ratio` from the first to the last."""
    x = np.log(ratio)
    small = np.abs(x) < 1e-5
    way: Floats = np.where(small, share, np.expm1(share * x) / np.where(small, 1, np.expm1(x)))
    return way
