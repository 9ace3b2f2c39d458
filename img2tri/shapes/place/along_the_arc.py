"""What spreads along the arc of padded chains: the distance from marked places, and values that fade to both sides."""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, runs
from img2tri.shapes.place.padded_chains import PaddedChains, gaussian


class ArcLengths:
    """Ways along the arc from the own places of chains to others of the same chain."""

    def __init__(self, line: PaddedChains, steps: Floats) -> None:
        """Take the way (k - 1,) from each place on the line to the next."""
        self._line, self._own = line, np.flatnonzero(line.own)
        self._chain, self._ring, own_steps = line.chain[self._own], line.ring[self._own], steps[self._own]
        first = np.flatnonzero(np.diff(self._chain, prepend=-1))
        self._length = np.add.reduceat(own_steps, first)
        along = np.cumsum(own_steps) - own_steps
        self._along = along - along[first][self._chain]
        self._left = self._length[self._chain] - self._along

    def farther_than(self, marks: Bools, distance: float) -> Bools:
        """Tell which places (k,) lie farther than `distance` px along the arc from all marked places (k,) of their chain."""
        line, own, along, length = self._line, self._own, self._along, self._length
        at = np.flatnonzero(marks[own])
        if not len(at):
            return np.ones(len(marks), bool)
        # Chains are laid out one after the other, out of each other's reach. In a ring there are marks before its start and after its end.
        arc = along + (np.cumsum(length + 3 * distance) - length)[self._chain]
        ring = at[self._ring[at]]
        before, after = ring[self._left[ring] <= distance], ring[along[ring] <= distance]
        there = [arc[at], arc[before] - length[self._chain[before]], arc[after] + length[self._chain[after]]]
        marked = np.concatenate([[-np.inf], *there, [np.inf]])
        marked.sort()
        next_one = np.searchsorted(marked, arc)
        far = np.zeros(len(marks), bool)
        far[own] = np.minimum(arc - marked[next_one - 1], marked[next_one] - arc) > distance
        return np.asarray(far[line.original])


def fade_out(line: PaddedChains, values: Floats, width: float) -> Floats:
    """Let each value (k,) other than 0 fade to both sides, over about `width` places; those near each other do not add up."""
    fading, at, result = gaussian(width), np.flatnonzero(values), np.zeros(len(values))
    if not len(at):
        return result
    fading /= fading.max()
    # Only what is within reach of a value counts: such places are cut out, run by run. Runs begin and end with zeros, as many as a value
    # reaches, so they keep out of each other's way.
    reach = len(fading) // 2
    gap = np.flatnonzero(np.diff(at) > 2 * reach)
    first = np.maximum(at[np.append(0, gap + 1)] - reach, 0)
    run, place = runs(np.minimum(at[np.append(gap, -1)] + reach + 1, len(values)) - first)
    near = first[run] + place
    beyond = np.zeros(reach)

    def spread(among: Floats) -> Floats:
        return np.convolve(np.concatenate([beyond, among[near], beyond]), fading, "valid")

    result[near] = spread((values != 0).astype(np.float64))
    result[near] = spread(values / np.maximum(result[line.original], 1))
    return np.asarray(result[line.original])
