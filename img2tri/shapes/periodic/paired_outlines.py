"""Outlines on opposite sides of an image simplified alike, pair by pair of entries."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Ints
from img2tri.errors import MeshError, bounded
from img2tri.shapes.periodic.paired_mesh_vertices import Walls, divided_alike
from img2tri.shapes.periodic.side_chains import DIRECTIONS
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.simplify.tolerance import enforce_tolerance
from img2tri.shapes.trace.dual_edges import DualEdges
from img2tri.types import Outlines

FINER_MATCHES = 4  # rounds in which the finer of two divisions is taken; after these both, which surely ends
MOST_MATCHES = 1000  # rounds of matching; three are many
FILLINGS = 12  # how often a network is filled at most until both sides agree


@dataclass(frozen=True, eq=False)
class PeriodicPairs:
    """Which entries of chains on opposite sides belong together; whatever is done to outlines, these are done alike.

    Attributes
    ----------
    one, other
        (k,) int64, entries of ``Outlines.chains`` on the left or bottom side, and opposite to them; in order along the sides.
    axis
        (k,) int64, the coordinate in which they differ: 0 is x, 1 is y.
    walls
        For each direction: that coordinate, and where it puts the two sides.
    """

    one: Ints
    other: Ints
    axis: Ints
    walls: Walls

    def shared(self, lengths: Floats) -> Floats:
        """Give both of a pair the smaller of their lengths; `lengths` are those of all entries (n,)."""
        result = lengths.copy()
        result[self.one] = result[self.other] = np.minimum(lengths[self.one], lengths[self.other])
        return result

    def alike(self, outlines: Outlines) -> Outlines:
        """Put the points of dense outlines on opposite sides at the same places: half-way between where the two were.

        Where an outline reaches only one of the sides, and the other was cut for its sake, both are where the outline is.
        """
        points = outlines.points.copy()
        one, other = outlines.chains.indices[self.one], outlines.chains.indices[self.other]
        along = 1 - self.axis
        reached = self._reached(outlines)
        share = np.where(reached[one] == reached[other], 0.5, reached[one])
        places = share * outlines.points[one, along] + (1 - share) * outlines.points[other, along]
        points[one, along] = points[other, along] = places
        return replace(outlines, points=points)

    def _reached(self, outlines: Outlines) -> Bools:
        """Tell at which points (n,) a chain ends that does not lie on one of the sides."""
        chains = outlines.chains
        second = chains.indices[chains.starts[:-1] + 1]
        beside = np.zeros(len(second), bool)
        for axis, *walls in self.walls:
            for wall in walls:
                beside |= (outlines.points[chains.ends[0], axis] == wall) & (outlines.points[second, axis] == wall)
        inner = ~beside & ~chains.rings
        ends = np.concatenate([end[inner] for end in chains.ends])
        return np.bincount(ends, minlength=len(outlines.points)) > 0

    def enforce_tolerance(self, s: Simplification, *, tolerance: float, passed: Simplification | None = None) -> Simplification:
        """Enforce the tolerance, see `img2tri.shapes.simplify.tolerance.enforce_tolerance`, with both sides divided alike.

        When the two sides come out differently, the finer division of each stretch is taken for both, and the tolerance enforced again,
        until they agree. That ends, as divisions only get finer.
        """
        for attempt in bounded("opposite sides", MOST_MATCHES):
            s = passed = enforce_tolerance(self._matched(s, both=attempt >= FINER_MATCHES), tolerance=tolerance, passed=passed)
            if self._agree(s):
                break
        return s

    def greatest(self, values: Floats, chains: ChainIndex) -> Floats:
        """Return values (n,) of the points of dense outlines where both points of each pair have the greater of theirs."""
        result = values.copy()
        for axis in (0, 1, 0):  # a corner of the image has a partner either way
            one, other = (chains.indices[entries[self.axis == axis]] for entries in (self.one, self.other))
            result[one] = result[other] = np.maximum(result[one], result[other])
        return result

    def _agree(self, s: Simplification) -> bool:
        same = (s.kept[self.one] == s.kept[self.other]) & (self._along(s, self.one) == self._along(s, self.other))
        return bool(same.all())

    def _along(self, s: Simplification, entries: Ints) -> Floats:
        """How far vertices are offset along their side."""
        offset = s.offset[entries]
        return np.where(self.axis == 0, offset.imag, offset.real)

    def _matched(self, s: Simplification, both: bool) -> Simplification:
        """Divide pairs alike: as the one with more vertices between two that both keep, or with the vertices of both."""
        if not len(self.one):
            return s
        first, second = s.kept[self.one], s.kept[self.other]
        stretch = np.cumsum(first & second)
        finer = np.bincount(stretch, second) > np.bincount(stretch, first)
        from_other = ~first if both else finer[stretch] & ~(first & second)
        chosen = first | second if both else np.where(from_other, second, first)
        points = s.chains.indices
        snapped_one, snapped_other = s.snapped[points[self.one]], s.snapped[points[self.other]]
        snapped = snapped_one | snapped_other
        # A point that was snapped takes its partner with it.
        from_other = np.where(snapped, ~snapped_one, from_other)
        along = np.where(from_other, self._along(s, self.other), self._along(s, self.one))
        kept, offset, of_both = s.kept.copy(), s.offset.copy(), s.snapped.copy()
        way = np.where(self.axis == 0, 1j, 1)
        for entries in (self.one, self.other):
            kept[entries], offset[entries] = chosen, np.where(chosen | snapped, along, 0) * way
            of_both[points[entries]] |= snapped
        # A junction on the side is in the chains from inside too.
        sides = np.concatenate([self.one, self.other])
        of_point = np.zeros(len(of_both), np.complex128)
        of_point[points[sides]] = offset[sides]
        touched = np.flatnonzero(np.isin(points, points[sides]))
        offset[touched] = of_point[points[touched]]
        return replace(s, kept=kept, offset=offset, snapped=of_both)

    def divided_alike(self, outlines: Outlines, vertices: Floats) -> Outlines:
        """Divide two sides of coarse outlines alike, see `img2tri.shapes.periodic.paired_mesh_vertices.divided_alike`."""
        return divided_alike(outlines, vertices, self.walls)

    def check(self, outlines: Outlines, vertices: Floats) -> None:
        """Raise `MeshError` if a mesh has its vertices at other places on one side than on the other."""
        if self.divided_alike(outlines, vertices) is not outlines:
            raise MeshError(f"periodic: expected opposite sides divided alike after {FILLINGS} rounds, found that they differ")


def find_periodic_pairs(outlines: Outlines, dual_edges: DualEdges, periodic: str | None) -> PeriodicPairs:
    """Find the pairs on opposite sides of an image whose chains were cut alike there, see `cut_alike`; only what both sides have is paired.

    Parameters
    ----------
    outlines, dual_edges
        The dense outlines, and what they were made of.
    periodic
        "x": the left and the right side are to match; "y": the bottom and the top; "xy": both; None: there are no pairs.
    """
    pairs, axes, walls = [], [], []
    for axis in DIRECTIONS[periodic]:
        (low, low_keys), (high, high_keys) = _along_sides(dual_edges, axis)
        low, high = low[_found_in(low_keys, high_keys)], high[_found_in(high_keys, low_keys)]
        if not len(low):
            continue
        assert len(low) == len(high), "chains on both sides were cut at the same places"
        pairs.append((low, high))
        axes.append(np.full(len(low), axis))
        z = outlines.points[outlines.chains.indices, axis]
        one, other = (low, high) if z[low[0]] <= z[high[0]] else (high, low)
        walls.append((axis, float(z[one[0]]), float(z[other[0]])))
    nothing = [np.zeros(0, np.int64)]
    return PeriodicPairs(
        np.concatenate([pair[0] for pair in pairs] or nothing),
        np.concatenate([pair[1] for pair in pairs] or nothing),
        np.concatenate(axes or nothing),
        tuple(walls),
    )


def _found_in(keys: Ints, others: Ints) -> Bools:
    """Tell which rows (k, 2) are among others (l, 2)."""
    most = int(max(keys.max(initial=0), others.max(initial=0))) + 1
    return np.isin(keys[:, 0] * most + keys[:, 1], others[:, 0] * most + others[:, 1])


def _along_sides(dual_edges: DualEdges, axis: int) -> tuple[tuple[Ints, Ints], tuple[Ints, Ints]]:
    """Entries on the two sides, in order along them, and which chain and place each stands for, counted along the side."""
    crack_edges, n = dual_edges.crack_edges, len(dual_edges.crossed)
    h, w = crack_edges.shape
    # Row and column of all points, doubled: crossings lie half-way between the ends of their crack edges.
    ends = np.stack([np.divmod(crack_edges.tail[dual_edges.crossed], w + 1), np.divmod(crack_edges.head[dual_edges.crossed], w + 1)])
    places = np.concatenate([ends.sum(axis=0), 2 * np.stack(np.divmod(dual_edges.node_corner, w + 1))], axis=1)
    across, along = (places[1], places[0]) if axis == 0 else (places[0], places[1])
    crossing = dual_edges.chains.indices[dual_edges.chains.first + ~dual_edges.chains.rings]
    on_frame = crack_edges.on_frame[dual_edges.crossed[np.minimum(crossing, n - 1)]]
    begins = np.minimum(along[dual_edges.chains.ends[0]], along[dual_edges.chains.ends[1]])
    result = []
    for wall in (0, 2 * (w if axis == 0 else h)):
        # A chain on the frame keeps to one side, as the corners of the image are nodes.
        chosen: Bools = on_frame & (across[crossing] == wall)
        entries = np.flatnonzero(chosen[dual_edges.chains.chain])
        chain, place = begins[dual_edges.chains.chain[entries]], along[dual_edges.chains.indices[entries]]
        order = np.lexsort((place, chain))
        result.append((entries[order], np.stack([chain, place], axis=1)[order]))
    return result[0], result[1]
