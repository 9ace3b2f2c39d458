"""How long the pieces of outlines should be, at each dense point.

The least of: the length wanted, what the thickness of a region there allows, what the curvature there asks for; and where pieces had to
be split in a first coarsening, what came out of it. Then the growth along the chains is limited, so that a short piece does
not stand beside a long one: triangles are only as good as the outlines are even.
"""

from __future__ import annotations

import numpy as np

from img2tri.shapes.place.padded_chains import Points
from img2tri.shapes.simplify.simplification import Draft
from img2tri.shapes.trace.dual_edges import Links
from img2tri.types import Floats, Ints

EVERY = 3  # thickness is measured at each third dense point
OPPOSITE = 1.73  # two sides face each other if the ball between them touches them at least 120 degrees apart
LOOSE = 1.25  # pieces that had to be split may come out so much longer when they are spaced evenly


def limit_growth(size: Floats, z: Points, links: Links, gradation: float) -> Floats:
    """Limit the growth of lengths (k,) along the chains to `gradation` per unit of arc.

    Where chains meet, all take the least length there.
    """
    arc, starts = arcs(z, links), links.starts
    chain, ends = links.chain, np.concatenate([starts[:-1], starts[1:] - 1])
    apart = (size.max(initial=0.0) + gradation * arc.max(initial=0.0) + 1) * chain  # keeps chains from seeing each other
    for _ in range(3):
        ahead = np.minimum.accumulate(size - gradation * arc - apart) + gradation * arc + apart
        back = np.minimum.accumulate((size + gradation * arc + apart)[::-1])[::-1] - gradation * arc - apart
        size = np.minimum(ahead, back)
        least = np.full(len(links.middle), np.inf)
        np.minimum.at(least, links.indices[ends], size[ends])
        size[ends] = least[links.indices[ends]]
    return size


def arcs(z: Points, links: Links) -> Floats:
    """Length of arc (k,) from the start of each chain; `z` are the places of its entries."""
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[links.starts[:-1]] = 0
    arc = np.cumsum(step)
    return np.asarray(arc - arc[links.starts[:-1]][links.chain])


def by_thickness(z: Points, links: Links, longest: float, elements: float) -> Floats:
    """Lengths (k,) that put `elements` of them across the regions, where these are thinner than that many of the longest.

    A ball that touches the outline from inside of a region is shrunk until it is empty: its diameter is the thickness.
    """
    size: Floats = np.full(len(z), longest)
    sides = links.sides
    at = np.flatnonzero(np.arange(len(z)) % EVERY == 0)
    at = at[(at > 0) & (at < len(z) - 1)]
    at = at[(links.chain[at - 1] == links.chain[at]) & (links.chain[at + 1] == links.chain[at])]
    heading = z[at + 1] - z[at - 1]
    for region, turn in ((sides[0], 1j), (sides[1], -1j)):
        inside = region[links.chain[at]] != 0
        i, inwards = at[inside], (turn * heading / np.maximum(np.abs(heading), 1e-12))[inside]
        thickness = _thickness(z, i, inwards, elements * longest)
        size[i] = np.minimum(size[i], thickness / elements)
    return size


def _thickness(z: Points, at: Ints, inwards: Points, greatest: float) -> Floats:
    """Diameter of the greatest empty ball that touches the outline at each entry and faces it, at most `greatest`."""
    from scipy.spatial import cKDTree

    tree = cKDTree(np.stack([z.real, z.imag], axis=1))
    radius, facing, going = np.full(len(at), greatest / 2), np.zeros(len(at), bool), np.arange(len(at))
    for _ in range(4):
        centre = z[at[going]] + radius[going] * inwards[going]
        found = tree.query(np.stack([centre.real, centre.imag], axis=1), distance_upper_bound=greatest)
        distance, nearest = np.asarray(found[0]), np.asarray(found[1])
        hit = distance < 0.98 * radius[going]
        going, nearest = going[hit], nearest[hit]
        if not len(going):
            break
        chord = z[nearest] - z[at[going]]
        depth = np.maximum((chord * inwards[going].conj()).real, 1e-9)
        radius[going] = np.minimum(np.abs(chord) ** 2 / (2 * depth), 0.999 * radius[going])
        facing[going] = np.abs(chord) > OPPOSITE * radius[going]
    return np.where(facing, 2 * radius, greatest)


def by_curvature(z: Points, links: Links, longest: float, segments_per_turn: float) -> Floats:
    """Lengths (k,) that make so many segments of a full turn."""
    reach = 4
    i = np.arange(len(z))
    behind, ahead = np.maximum(i - reach, links.starts[:-1][links.chain]), np.minimum(i + reach, links.starts[1:][links.chain] - 1)
    one, other = z - z[behind], z[ahead] - z
    both = (np.abs(one) > 0) & (np.abs(other) > 0)
    turn = np.where(both, np.abs(np.angle(other * one.conj())), 0)
    way = (np.abs(one) + np.abs(other)) / 2
    return np.asarray(np.minimum(longest, 2 * np.pi / segments_per_turn * way / np.maximum(turn, 1e-9)))


def by_pieces(d: Draft, wanted: Floats) -> Floats:
    """Lengths (k,) of the pieces of a coarsening that had to be split, with a little room; elsewhere those wanted."""
    first, last = d.pieces
    length = LOOSE * np.abs(d.places[last] - d.places[first])
    size = wanted.copy()
    which = np.repeat(np.arange(len(first)), last - first + 1)
    entry = first[which] + np.arange(len(which)) - np.repeat(np.cumsum(last - first + 1) - (last - first + 1), last - first + 1)
    np.minimum.at(size, entry, length[which])
    return size
