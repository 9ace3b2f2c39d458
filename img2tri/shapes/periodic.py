r"""Opposite sides of an image divided alike, so that copies of its mesh, set side by side, fit together.

The labels along two opposite sides have to be the same. Then the chains on these sides are the same too, crossing by crossing: each has
its *twin* on the other side::

      3---o---o---3        an entry of a chain on the left and its twin on the right
      |           |        lie at the same height, to the last bit
      o           o
      2           2        numbers: junctions with outlines that reach the frame

What is done to one side is done to the other, wherever something is done to outlines: they are spaced alike, and when settling or filling
divides them differently, the finer division of each stretch is taken for both, and it is settled or filled again, until both sides
agree. That ends, as divisions only get finer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ImageError, MeshError, ParameterError, shown
from img2tri.shapes.simplify.simplification import Draft
from img2tri.shapes.simplify.tolerance import settle
from img2tri.shapes.trace.dual_edges import Links
from img2tri.types import Bools, Floats, Ints, Outlines

DIRECTIONS = {None: (), "x": (0,), "y": (1,), "xy": (0, 1)}  # which coordinate tells a side from the one opposite to it
SIDES = {"x": (1, "column"), "y": (0, "row")}
PICKS = 4  # rounds of settling in which the finer of two divisions is taken; after these both, which surely ends
FILLINGS = 12  # how often a network is filled at most until both sides agree
NEAR = 1e-9  # of the size of the image: what lies so near to a side lies on it


def check_periodic(periodic: str | None, labels: NDArray[Any], *, recipe: str = "conforming", smoothing: str | None = None) -> None:
    """Check that the labels (h, w) along opposite sides are the same, and that nothing else stands against the option.

    Raises
    ------
    ParameterError
        If `periodic` is none of None, "x", "y", "xy"; if the recipe is one of the paper's, or smoothing moves the boundary.
    ImageError
        If the labels differ; it says where they first do.

    Examples
    --------
    >>> check_periodic("x", np.array([[1, 2, 1], [2, 2, 1]]))
    Traceback (most recent call last):
    ...
    img2tri.errors.ImageError: periodic: expected the same labels in the first and the last column, found 2 and 1 in row 1 (1 such); ...
    """
    if not (periodic is None or isinstance(periodic, str)) or periodic not in DIRECTIONS:
        raise ParameterError(f"periodic: expected 'x', 'y', 'xy' or None, found {shown(periodic)}")
    if periodic and (recipe != "conforming" or smoothing == "cotangent"):
        found = f"recipe {recipe!r}" if recipe != "conforming" else f"smoothing {smoothing!r}"
        raise ParameterError(f"periodic: expected None with {found}, which does not keep opposite sides alike, found {periodic!r}")
    for name in periodic or "":
        axis, line = SIDES[name]
        first, last = np.take(labels, [0, -1], axis=axis) if axis == 0 else np.take(labels, [0, -1], axis=axis).T
        differ = np.flatnonzero(first != last)
        if len(differ):
            other, at = SIDES["y" if name == "x" else "x"][1], differ[0]
            widths = "((0, 0), (0, 1))" if name == "x" else "((0, 1), (0, 0))"
            raise ImageError(
                f"periodic: expected the same labels in the first and the last {line}, found {first[at]} and {last[at]} in {other} {at} "
                f"({len(differ)} such); where an image repeats, add its first {line} once more: np.pad(image, {widths}, mode='wrap')"
            )


@dataclass(frozen=True, eq=False)
class Twins:
    """Which entries of chains on opposite sides belong together.

    Attributes
    ----------
    one, other
        (k,) int64, entries of ``Outlines.indices`` on the left or bottom side, and opposite to them; in order along the sides.
    axis
        (k,) int64, the coordinate in which they differ: 0 is x, 1 is y.
    walls
        For each direction: that coordinate, and where it puts the two sides.
    """

    one: Ints
    other: Ints
    axis: Ints
    walls: tuple[tuple[int, float, float], ...]

    def shared(self, lengths: Floats) -> Floats:
        """Give twins the smaller of their lengths; `lengths` are those of all entries (n,)."""
        result = lengths.copy()
        result[self.one] = result[self.other] = np.minimum(lengths[self.one], lengths[self.other])
        return result

    def alike(self, outlines: Outlines) -> Outlines:
        """Put the points of dense outlines on opposite sides at the same places: half-way between where the two were."""
        points = outlines.points.copy()
        one, other = outlines.indices[self.one], outlines.indices[self.other]
        along = 1 - self.axis
        points[one, along] = points[other, along] = (outlines.points[one, along] + outlines.points[other, along]) / 2
        return replace(outlines, points=points)

    def settle(self, d: Draft, *, tolerance: float) -> Draft:
        """Settle outlines, see `img2tri.shapes.simplify.tolerance.settle`, with twins divided alike."""
        rounds = 0
        while True:
            d = settle(self._matched(d, both=rounds >= PICKS), tolerance=tolerance)
            if self._agree(d):
                return d
            rounds += 1

    def _agree(self, d: Draft) -> bool:
        same = (d.breaks[self.one] == d.breaks[self.other]) & (self._along(d, self.one) == self._along(d, self.other))
        return bool(same.all())

    def _along(self, d: Draft, entries: Ints) -> Floats:
        """How far breaks were moved along their side."""
        moved = d.moved[entries]
        return np.where(self.axis == 0, moved.imag, moved.real)

    def _matched(self, d: Draft, both: bool) -> Draft:
        """Divide twins alike: as the one that has more breaks between two they share, or with the breaks of both."""
        if not len(self.one):
            return d
        first, second = d.breaks[self.one], d.breaks[self.other]
        stretch = np.cumsum(first & second)
        finer = np.bincount(stretch, second) > np.bincount(stretch, first)
        from_other = ~first if both else finer[stretch] & ~(first & second)
        chosen = first | second if both else np.where(from_other, second, first)
        points = d.outlines.indices
        reset_one, reset_other = d.reset[points[self.one]], d.reset[points[self.other]]
        reset = reset_one | reset_other
        # A point that went back towards the middle takes its twin with it.
        from_other = np.where(reset, ~reset_one, from_other)
        along = np.where(from_other, self._along(d, self.other), self._along(d, self.one))
        breaks, moved, back = d.breaks.copy(), d.moved.copy(), d.reset.copy()
        measured, tested = d.measured.copy(), d.tested.copy()
        way = np.where(self.axis == 0, 1j, 1)
        for entries in (self.one, self.other):
            breaks[entries], moved[entries] = chosen, np.where(chosen | reset, along, 0) * way
            back[points[entries]] |= reset
            measured[entries] = tested[entries] = -1
        # A junction on the side is in the chains from inside too.
        sides = np.concatenate([self.one, self.other])
        of_point = np.zeros(len(back), np.complex128)
        of_point[points[sides]] = moved[sides]
        touched = np.flatnonzero(np.isin(points, points[sides]) & (of_point[points] != moved))
        if len(touched):
            moved[touched] = of_point[points[touched]]
            measured[:] = tested[:] = -1
        return replace(d, breaks=breaks, moved=moved, reset=back, measured=measured, tested=tested)

    def divided(self, chains: Outlines, vertices: Floats) -> Outlines:
        """Divide two sides of coarse outlines alike, after filling them, with `vertices` (n, 2), divided them differently.

        Return `chains` itself if both sides have their vertices at the same places; else with those that only one has.
        """
        result = chains
        for wall in self.walls:
            places = self._missing(chains.points, vertices, *wall)
            if len(places):
                result = _divided(result, places, *wall)
        return result

    def check(self, chains: Outlines, vertices: Floats) -> None:
        """Raise `MeshError` if a mesh has its vertices at other places on one side than on the other."""
        if self.divided(chains, vertices) is not chains:
            raise MeshError(f"periodic: expected opposite sides divided alike after {FILLINGS} rounds, found that they differ")

    @staticmethod
    def _missing(points: Floats, vertices: Floats, axis: int, low: float, high: float) -> Floats:
        """Places along a side (k,) at which filling divided it: between two points that were given, those of the side that has more.

        None if both sides were divided alike.
        """
        given = np.sort(points[points[:, axis] == low, 1 - axis])
        new = []
        for wall in (low, high):
            places = vertices[np.abs(vertices[:, axis] - wall) < NEAR * (high - low), 1 - axis]
            new.append(np.setdiff1d(places, given))
        if np.array_equal(new[0], new[1]):
            return np.zeros(0)
        at = [np.searchsorted(given, places) for places in new]
        count = [np.bincount(where, minlength=len(given) + 1) for where in at]
        finer = count[1] > count[0]
        return np.concatenate([new[0][~finer[at[0]]], new[1][finer[at[1]]]])


def find_twins(outlines: Outlines, links: Links, periodic: str | None) -> Twins:
    """Find the twins on opposite sides of an image whose labels there are the same, see `check_periodic`.

    Parameters
    ----------
    outlines, links
        The dense outlines, and what they were made of.
    periodic
        "x": the left and the right side are to match; "y": the bottom and the top; "xy": both; None: there are no twins.
    """
    pairs, axes, walls = [], [], []
    for axis in DIRECTIONS[periodic]:
        (low, low_keys), (high, high_keys) = _along_sides(links, axis)
        if not len(low):
            continue
        assert np.array_equal(low_keys, high_keys), "chains on sides with the same labels are the same"
        pairs.append((low, high))
        axes.append(np.full(len(low), axis))
        z = outlines.points[outlines.indices, axis]
        one, other = (low, high) if z[low[0]] <= z[high[0]] else (high, low)
        walls.append((axis, float(z[one[0]]), float(z[other[0]])))
    nothing = [np.zeros(0, np.int64)]
    return Twins(
        np.concatenate([pair[0] for pair in pairs] or nothing),
        np.concatenate([pair[1] for pair in pairs] or nothing),
        np.concatenate(axes or nothing),
        tuple(walls),
    )


def _along_sides(links: Links, axis: int) -> tuple[tuple[Ints, Ints], tuple[Ints, Ints]]:
    """Entries on the two sides, in order along them, and which chain and place each stands for, counted along the side."""
    cracks, n = links.cracks, len(links.crack)
    h, w = cracks.shape
    # Row and column of all points, doubled: crossings lie half-way between the ends of their cracks.
    ends = np.stack([np.divmod(cracks.tail[links.crack], w + 1), np.divmod(cracks.head[links.crack], w + 1)])
    places = np.concatenate([ends.sum(axis=0), 2 * np.stack(np.divmod(links.node, w + 1))], axis=1)
    across, along = (places[1], places[0]) if axis == 0 else (places[0], places[1])
    crossing = links.indices[links.starts[:-1] + ~links.rings]
    on_frame = cracks.on_frame[links.crack[np.minimum(crossing, n - 1)]]
    begins = np.minimum(along[links.ends[0]], along[links.ends[1]])
    result = []
    for wall in (0, 2 * (w if axis == 0 else h)):
        # A chain on the frame keeps to one side, as the corners of the image are nodes.
        chosen: Bools = on_frame & (across[crossing] == wall)
        entries = np.flatnonzero(chosen[links.chain])
        chain, place = begins[links.chain[entries]], along[links.indices[entries]]
        order = np.lexsort((place, chain))
        result.append((entries[order], np.stack([chain, place], axis=1)[order]))
    return result[0], result[1]


def _divided(chains: Outlines, places: Floats, axis: int, low: float, high: float) -> Outlines:
    """Put points at some places along two opposite sides into the chains there."""
    points, indices, starts = chains.points, chains.indices, chains.starts
    for wall in (low, high):
        across, along = points[indices, axis] == wall, points[indices, 1 - axis]
        inner = np.ones(len(indices) - 1, bool)
        inner[starts[1:-1] - 1] = False
        entry = np.flatnonzero(inner & across[:-1] & across[1:])
        begins = np.minimum(along[entry], along[entry + 1])
        entry = entry[np.argsort(begins)]
        at = entry[np.searchsorted(np.sort(begins), places) - 1]
        # In the order of the chain, which may run either way.
        order = np.lexsort((np.where(along[at + 1] > along[at], places, -places), at))
        at, new = at[order] + 1, np.full((len(places), 2), wall)
        new[:, 1 - axis] = places[order]
        indices = np.insert(indices, at, len(points) + np.arange(len(places)))
        starts = starts + np.searchsorted(np.sort(at), starts)
        points = np.concatenate([points, new])
    return replace(chains, points=points, indices=indices, starts=starts)


def periodic_pairs(vertices: Floats, bounds: tuple[float, float, float, float], periodic: str | None) -> dict[str, Ints]:
    """Pair the vertices on opposite sides.

    `bounds` are (left, bottom, right, top) of the image.

    Returns
    -------
    dict
        "x": (k, 2) int64, a vertex on the left side and its twin on the right, from the bottom up; they have the same y, bit for bit.
        "y": (l, 2), bottom and top, from the left. Only the directions asked for.

    Raises
    ------
    MeshError
        If a vertex has no twin.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.5]])
    >>> periodic_pairs(square, (0, 0, 2, 2), "xy")["x"].tolist()
    [[0, 1], [3, 2]]
    """
    result = {}
    for axis in DIRECTIONS[periodic]:
        low, high = bounds[axis], bounds[axis + 2]
        pair = []
        for wall in (low, high):
            on = np.flatnonzero(np.abs(vertices[:, axis] - wall) < NEAR * (high - low))
            pair.append(on[np.argsort(vertices[on, 1 - axis])])
        one, other = (vertices[on, 1 - axis] for on in pair)
        if not np.array_equal(one, other):
            raise MeshError(f"periodic: expected the same places on opposite sides, found {len(one)} and {len(other)} vertices that differ")
        result["xy"[axis]] = np.stack(pair, axis=1)
    return result
