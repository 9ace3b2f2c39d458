"""A simplification of outlines: which of their dense points are kept as vertices, and how far each of these is offset.

Its value says all there is to say; what is measured on its chords is known to the loop that needs it alone, see `tolerance`. Each pair
of neighbouring kept vertices is joined by a *chord*, which stands for an *arc* of dense points::

      o . . o . . . o        o  kept vertices, offset from the outline or not
     .               .       .  the dense points of an arc, as fine as the pixels
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Ints, Points, as_complex, as_rows, runs
from img2tri.shapes.trace.dual_edges import DualEdges
from img2tri.types import Outlines

SAME_PLACE = 1e-6  # px, places that differ by less are the same, up to rounding
LEAST_ANGLE = 50.0  # degrees, at which chords may meet
RING = 8  # a ring keeps at least so many vertices, or all its crossings


@dataclass(frozen=True, eq=False)
class Simplification:
    """Kept vertices of dense outlines, and their offsets; entries are those of the chains of the dense outlines.

    Attributes
    ----------
    outlines, dual_edges
        The dense outlines, and between which bounds their points may lie.
    dense
        (k,) complex, the dense point of each entry.
    pinned
        (n,) bool, the points that must not be snapped: corners to be kept.
    kept
        (k,) bool, the entries that are kept as vertices; both ends of each chain are.
    offset
        (k,) complex, how far each vertex lies from its dense point.
    snapped
        (n,) bool, the points that went back towards the middle of their crack edges, and junctions moved within their block.
    least_angle
        In degrees: chords that meet at less are too sharp.
    """

    outlines: Outlines
    dual_edges: DualEdges
    dense: Points
    pinned: Bools
    kept: Bools
    offset: Points
    snapped: Bools
    least_angle: float

    @property
    def chains(self) -> ChainIndex:
        """The chains of the dense outlines."""
        return self.outlines.chains

    @cached_property
    def places(self) -> Points:
        """(k,) where the entries lie, vertices where they were offset to."""
        return self.dense + self.offset

    @cached_property
    def chords(self) -> tuple[Ints, Ints]:
        """First and last entry of each chord."""
        at = self.kept.nonzero()[0]
        # Both ends of every chain are vertices: from one to the next chain there is no chord.
        joined = np.ones(max(len(at) - 1, 0), bool)
        joined[np.searchsorted(at, self.chains.starts[1:-1]) - 1] = False
        return at[:-1][joined], at[1:][joined]

    @cached_property
    def entries(self) -> Ints:
        """(p,) the first entry of each point of the coarse outlines, in the order these have: that of the dense points."""
        at = self.kept.nonzero()[0][::-1]
        first = np.full(len(self.snapped), -1)
        first[self.chains.indices[at]] = at
        return first[first >= 0]

    @cached_property
    def snapped_entries(self) -> Bools:
        """(k,) bool, the entries of snapped points."""
        return self.snapped[self.chains.indices]

    def coarse(self) -> Outlines:
        """Return the outlines made of the kept vertices only."""
        o, at, entries = self.outlines, self.kept.nonzero()[0], self.entries
        index = np.searchsorted(o.chains.indices[entries], o.chains.indices[at])
        chains = ChainIndex(index, np.searchsorted(at, o.chains.starts), o.chains.rings)
        return Outlines(as_rows(self.places[entries]), chains, o.left, o.right, o.labels)


def space_evenly(
    outlines: Outlines,
    dual_edges: DualEdges,
    *,
    spacing: float | Floats,
    keep_corners: bool = False,
    posts: Bools | None = None,
    tips: Points | None = None,
    least_angle: float = LEAST_ANGLE,
) -> Simplification:
    """Keep vertices along each chain, `spacing` px apart: one length, or one at each entry (k,).

    With `keep_corners` no corner of an outline is ever blunted. Entries (k,) that are `posts` are vertices, from which spacing begins anew,
    and lie so far off as `tips` (k,) says.
    """
    chains, starts = outlines.chains, outlines.chains.starts
    z = as_complex(outlines.points)[chains.indices]
    k, n = len(z), len(outlines.points)
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[starts[:-1]] = 0
    # How many chords fit before each entry: the integral of 1 / spacing along the chain.
    per_length = 1 / np.broadcast_to(np.asarray(spacing, np.float64), (k,))
    way = np.cumsum(step * (per_length + np.roll(per_length, 1)) / 2)
    first, last, rings = chains.first, chains.last, chains.rings
    if posts is not None and posts.any():
        added = posts.nonzero()[0]
        first, last = np.sort(np.concatenate([first, added])), np.sort(np.concatenate([last, added]))
        begins, ends = np.zeros((2, k), bool)
        begins[chains.first] = ends[chains.last] = True
        rings = rings[chains.chain[first]] & begins[first] & ends[last]
    begin, length = way[first], way[last] - way[first]
    size = last - first
    least = np.where(rings, np.minimum(RING, size), 1)
    count = np.clip(np.round(length).astype(np.int64), least, size)

    # Even places along the way; each is taken by the nearest dense point, offset to it.
    which, number = runs(count)
    wanted = begin[which] + length[which] * number / count[which]
    after = np.clip(np.searchsorted(way, wanted), first[which] + 1, last[which])
    at = after - (wanted - way[after - 1] < way[after] - wanted)
    share = (wanted - way[after - 1]) / np.maximum(way[after] - way[after - 1], 1e-12)
    place = z[after - 1] + share * (z[after] - z[after - 1])
    kept, offset = np.zeros(k, bool), np.zeros(k, np.complex128) if tips is None else tips.copy()
    inner = (number > 0) & (at > first[which]) & (at < last[which])
    offset[at[inner]] = (place - z[at])[inner]
    kept[at[inner]] = True
    kept[first] = kept[last] = True
    pinned = dual_edges.is_corner if keep_corners else np.zeros(n, bool)
    return Simplification(outlines, dual_edges, z, pinned, kept, offset, np.zeros(n, bool), least_angle)
