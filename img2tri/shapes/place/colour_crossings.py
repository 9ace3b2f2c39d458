"""Pixels mixed of two flat colours -> where on its dual edge each crossing lies, and how surely.

Where an edge parts a region of colour A from one of colour B, a pixel on it is a mix, and how much of A is in it tells how much of it lies
on A's side: the place of the pixel's colour along the line from B (0) to A (1). Between two pixel centres this share is taken to change
evenly; the outline passes where it is one half. That is what `iso_crossings` does with gray values, for any number of colours.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.shapes.place.iso_crossings import HARD, SURE, pixels_at
from img2tri.shapes.trace.dual_edges import BOUND
from img2tri.types import ColourMix, Frame


def colour_crossings(mix: ColourMix, left: Ints, right: Ints, middle: Points, vector: Points, frame: Frame) -> tuple[Floats, Floats]:
    """Place crossings by what the pixels on their dual edges are mixed of.

    Parameters
    ----------
    mix
        The pixels and the flat colours.
    left, right
        (k,) labels on the left and right of each crossing.
    middle, vector
        (n,) middle and direction of the dual edges, from the pixel centre on the right to the one on the left, crossings first; 0 where a
        point stays.
    frame
        Where the image lies; dual edges are in its plane.

    Returns
    -------
    shift, slack
        (n,) float64, as of `iso_crossings`. Where a label has no colour, or a pixel got its label for another reason than its
        colour, nothing is known.
    """
    shift, slack = np.zeros(len(middle)), np.full(len(middle), BOUND)
    at = np.flatnonzero(vector)
    (a_known, a), (b_known, b) = (_colours(mix, labels[at]) for labels in (left, right))
    span = a - b
    length = (span * span).sum(vector=1)
    shares = []
    for side in (1, -1):
        pixels = pixels_at(middle[at] + side * vector[at] / 2, frame)
        along = ((mix.values[pixels].astype(np.float64) - b) * span).sum(vector=1) / np.where(length > 0, length, 1.0)
        there = True if mix.missing is None else ~mix.missing[pixels]
        shares.append(np.where(there, np.clip(along, 0, 1), 0.5))
    of_left, of_right = shares
    known = a_known & b_known & (length > 0) & (of_left >= 0.5) & (of_right <= 0.5) & (of_left > of_right)
    contrast = np.where(known, of_left - of_right, 1.0)
    shift[at] = np.where(known, np.clip((0.5 - of_right) / contrast - 0.5, -BOUND, BOUND), 0.0)
    slack[at] = np.where(known & (contrast < HARD), SURE, BOUND)
    return shift, slack


def _colours(mix: ColourMix, labels: Ints) -> tuple[Bools, Floats]:
    """Return whether labels have a colour, and which."""
    place = np.minimum(np.searchsorted(mix.labels, labels), len(mix.labels) - 1)
    return np.asarray(mix.labels[place] == labels), mix.colours[place]
