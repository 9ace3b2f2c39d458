"""Pixels mixed of two flat colours -> where on its dual edge each crossing lies, and how surely.

Where an edge parts a region of colour A from one of colour B, a pixel on it is a mix: its share of A is the place of its colour along the
line from B (0) to A (1). Of the pixels across the edge, the shares of A add up to the length that A covers, however soft the edge is, as
long as what softens it is even on both sides::

    share of A    1    0.9   0.4    0     0.9 + 0.4: A reaches 1.3 pixels into the two beside the edge
                  A     A  |  B     B     four pixels are asked, of which the outer two count as pure where another edge is near

For a straight edge drawn by area coverage, at any angle, that is right to 0.002 px in the mean, and 0.02 along the axes and diagonals; the
place where the share of two pixels passes one half, to 0.06 px.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.shapes.place.iso_crossings import HARD, SURE, pixels_at
from img2tri.shapes.trace.dual_edges import BOUND
from img2tri.types import ColourMix, Frame

STRANGE = 0.25  # of the distance of two colours: how far off the line between them a mix of them may be


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
    length = np.maximum((span * span).sum(axis=1), 1e-300)
    steps = vector[at]
    outer_left, of_left, of_right, outer_right = (
        _share(mix, pixels_at(_inside(middle[at] + step * steps, frame), frame), b, span, length) for step in (1.5, 0.5, -0.5, -1.5)
    )
    known = a_known & b_known & (of_left >= 0.5) & (of_right <= 0.5) & (of_left > of_right)
    # NaN, no mix of these two, and what does not go on as the edge does, belong to another edge.
    outer_left = np.where(outer_left >= of_left, outer_left, 1.0)
    outer_right = np.where(outer_right <= of_right, outer_right, 0.0)
    shift[at] = np.where(known, np.clip(2.0 - (outer_left + of_left + of_right + outer_right), -BOUND, BOUND), 0.0)
    slack[at] = np.where(known & (of_left - of_right < HARD), SURE, BOUND)
    return shift, slack


def _share(mix: ColourMix, pixels: tuple[Ints, Ints], b: Floats, span: Floats, length: Floats) -> Floats:
    """Return the share (k,) of the left colour in pixels; NaN in those that are not there, or no mix of the two colours."""
    off = mix.values[pixels].astype(np.float64) - b
    along = (off * span).sum(axis=1) / length
    beside = ((off - along[:, None] * span) ** 2).sum(axis=1)
    strange = beside > STRANGE**2 * length
    if mix.missing is not None:
        strange |= mix.missing[pixels]
    return np.where(strange, np.nan, np.clip(along, 0, 1))


def _inside(centres: Points, frame: Frame) -> Points:
    """Keep centres of pixels within the image: beyond its frame it goes on as it ends there."""
    width, height = frame.shape[1] * frame.spacing[0] / frame.pixel, frame.shape[0] * frame.spacing[1] / frame.pixel
    half_x, half_y = frame.spacing[0] / frame.pixel / 2, frame.spacing[1] / frame.pixel / 2
    return np.clip(centres.real, half_x, width - half_x) + 1j * np.clip(centres.imag, half_y, height - half_y)


def _colours(mix: ColourMix, labels: Ints) -> tuple[Bools, Floats]:
    """Return whether labels have a colour, and which."""
    place = np.minimum(np.searchsorted(mix.labels, labels), len(mix.labels) - 1)
    return np.asarray(mix.labels[place] == labels), mix.colours[place]
