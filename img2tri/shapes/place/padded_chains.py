"""Chains padded and laid out on one line, so that smoothing along all of them is one convolution, or one banded system.

Each chain is continued beyond its ends by some places. A ring goes round once more (periodic extension). An open chain is turned by
half a turn about its end node (odd extension), which keeps the node where it is and the direction there steady::

    ring      d e [a b c d e] a b          open      . . [A b c D] . .      turned about A and about D
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Points, runs


class PaddedChains:
    """The entries of some chains, continued at both ends, one chain after the other.

    Attributes
    ----------
    source
        (k,) the point each place on the line stands for.
    own
        (k,) bool, the place belongs to the chain itself, not to its padding; each crossing has one such place.
    original
        (k,) the own place each place repeats.
    sign
        (k,) -1 where the chain is turned, else 1.
    chain
        (k,) which of the chosen chains it is.
    ring
        (k,) bool, the chain is a ring.
    node
        (k,) bool, the own places at the ends of open chains.
    """

    def __init__(self, chains: ChainIndex, chosen: Bools, padding: int) -> None:
        """Lay out the chosen (c,) bool of the chains, with so many places of padding at both ends."""
        indices, chosen_ones = chains.indices, np.flatnonzero(chosen)
        first, ring = chains.first[chosen_ones], chains.rings[chosen_ones]
        steps = np.diff(chains.starts)[chosen_ones] - 1  # from the first point to the last; a ring's last is its first again
        length = steps + np.where(ring, 0, 1) + 2 * padding
        which, place = runs(length)
        place -= padding
        begin = np.arange(len(which)) - place
        self._before, self._after = -place, place - (length - 2 * padding - 1)[which]
        self.own = self.within(0)
        turns, rest, out = np.zeros_like(place), place.copy(), np.flatnonzero(~self.own)
        turns[out], rest[out] = np.divmod(place[out], (np.where(ring, 1, 2) * steps)[which[out]])
        turned = rest > steps[which]
        along = np.where(turned, 2 * steps[which] - rest, rest)
        self.source, self.original = indices[first[which] + along], begin + along
        self.chain, self.ring = which, ring[which]
        self.node = ~self.ring & ((place == 0) | (place == steps[which]))
        # A turn about the last node Z and one about the first node A move a point by 2 (Z - A).
        self.sign = np.where(turned, -1.0, 1.0)
        self._beyond = out[~self.ring[out]]
        of, twice = which[self._beyond], 2.0 * turns[self._beyond]
        self._first, self._last = indices[first[of]], indices[first[of] + steps[of]]
        self._from_first, self._from_last = -twice, twice + 2.0 * turned[self._beyond]

    def within(self, reach: int) -> Bools:
        """Tell which places (k,) are own ones, or at most so many places from those of their chain."""
        return np.asarray((self._before <= reach) & (self._after <= reach))

    def points(self, z: Points) -> Points:
        """Lay points out on the line, (n,) to (k,)."""
        line: Points = self.sign * z[self.source]
        line[self._beyond] += self._from_first * z[self._first] + self._from_last * z[self._last]
        return line


def convolve(line: Points, kernel: Floats) -> Points:
    """Convolve complex values with a real kernel of odd length; the result is as long as `line`."""
    result: Points = np.convolve(line.real, kernel, "same") + 1j * np.convolve(line.imag, kernel, "same")
    return result


def gaussian(scale: float) -> Floats:
    """Return a Gaussian of standard deviation `scale` as a kernel; its sum is 1."""
    reach = int(np.ceil(3 * scale))
    g = np.exp(-0.5 * (np.arange(-reach, reach + 1) / scale) ** 2)
    return np.asarray(g / g.sum())
