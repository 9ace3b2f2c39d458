"""Outlines in coarsening: the dense outlines, and which of their points are kept, moved where."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from img2tri.shapes.place.padded_chains import Points
from img2tri.shapes.trace.dual_edges import Links
from img2tri.types import Bools, Floats, Ints, Outlines

SAME = 1e-6  # px, places that differ by less are the same, up to rounding
RING = 8  # a ring keeps at least so many pieces, or all its crossings


@dataclass(frozen=True, eq=False)
class Draft:
    """Outlines in coarsening.

    Attributes
    ----------
    outlines, links
        The dense outlines, and what the places of their points may be.
    dense
        (n,) complex, the dense points.
    reset
        (n,) bool, the points that go back towards the middle of their links.
    kept
        (n,) bool, corners that must not.
    breaks
        (k,) bool, the entries of `outlines.indices` that are breaks.
    moved
        (k,) complex, how far a break lies from its dense point.
    measured, tested
        (k,) int64, the last entry of the piece that begins at an entry and whose bulge is known, that passed all tests.
    bulge
        (k,) float64, at the first entry of each measured piece the greatest distance between the run and its chord.
    """

    outlines: Outlines
    links: Links
    dense: Points
    reset: Bools
    kept: Bools
    breaks: Bools
    moved: Points
    measured: Ints
    tested: Ints
    bulge: Floats

    @property
    def pieces(self) -> tuple[Ints, Ints]:
        """First and last entry of each piece."""
        at = np.flatnonzero(self.breaks)
        # Both ends of every chain are breaks: from one to the next chain there is no piece.
        one = np.ones(max(len(at) - 1, 0), bool)
        one[np.searchsorted(at, self.outlines.starts[1:-1]) - 1] = False
        return at[:-1][one], at[1:][one]

    @property
    def places(self) -> Points:
        """(k,) where the entries lie, breaks where they were moved to."""
        return self.dense[self.outlines.indices] + self.moved

    @property
    def entries(self) -> Ints:
        """(p,) the first entry of each point of the coarse outlines, in the order these have: that of the dense points."""
        at = np.flatnonzero(self.breaks)
        return at[np.unique(self.outlines.indices[at], return_index=True)[1]]

    def coarse(self) -> Outlines:
        """Return the outlines made of the breaks only."""
        o, at, entries = self.outlines, np.flatnonzero(self.breaks), self.entries
        index = np.searchsorted(o.indices[entries], o.indices[at])
        place = self.places[entries]
        starts = np.searchsorted(at, o.starts)
        return Outlines(np.stack([place.real, place.imag], axis=1), index, starts, o.left, o.right, o.labels)


def draft(outlines: Outlines, links: Links, *, spacing: float | Floats, keep_corners: bool = False) -> Draft:
    """Set breaks along each chain, `spacing` px apart: one length, or one at each entry (k,).

    With `keep_corners` no corner of an outline is ever blunted.
    """
    dense = outlines.points[:, 0] + 1j * outlines.points[:, 1]
    k, starts = len(outlines.indices), outlines.starts
    z = dense[outlines.indices]
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[starts[:-1]] = 0
    # How many pieces fit before each entry: the integral of 1 / spacing along the chain.
    per_length = 1 / np.broadcast_to(np.asarray(spacing, np.float64), (k,))
    way = np.cumsum(step * (per_length + np.roll(per_length, 1)) / 2)
    begin, length = way[starts[:-1]], way[starts[1:] - 1] - way[starts[:-1]]
    size = np.diff(starts) - 1
    least = np.where(links.rings, np.minimum(RING, size), 1)
    count = np.clip(np.round(length).astype(np.int64), least, size)

    # Even places along the way; each is taken by the nearest dense point, moved there.
    which = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    wanted = begin[which] + length[which] * number / count[which]
    after = np.clip(np.searchsorted(way, wanted), starts[which] + 1, starts[which + 1] - 1)
    at = after - (wanted - way[after - 1] < way[after] - wanted)
    share = (wanted - way[after - 1]) / np.maximum(way[after] - way[after - 1], 1e-12)
    place = z[after - 1] + share * (z[after] - z[after - 1])
    breaks, moved = np.zeros(k, bool), np.zeros(k, np.complex128)
    inner = (number > 0) & (at > starts[which]) & (at < starts[which + 1] - 1)
    moved[at[inner]] = (place - z[at])[inner]
    breaks[at[inner]] = True
    breaks[starts[:-1]] = breaks[starts[1:] - 1] = True
    kept = links.corner if keep_corners else np.zeros(len(dense), bool)
    measured, bulge = np.full(k, -1), np.zeros(k)
    return Draft(outlines, links, dense, np.zeros(len(dense), bool), kept, breaks, moved, measured, np.full(k, -1), bulge)


def remembered(d: Draft, settled: Draft) -> Draft:
    """Take over what a settled draft of the same outlines knows of the pieces that both have: these need no other measure and test."""
    first, last = d.pieces
    same = settled.breaks & ~settled.reset[d.outlines.indices] & (np.abs(settled.moved - d.moved) < SAME)
    same = (settled.tested[first] == last) & same[first] & same[last]
    first, last = first[same], last[same]
    k = len(d.moved)
    measured, bulge = np.full(k, -1), np.zeros(k)
    measured[first] = last
    bulge[first] = settled.bulge[first]
    return replace(d, measured=measured, tested=measured.copy(), bulge=bulge)
