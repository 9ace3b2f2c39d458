"""What an image says of the places of its outlines, beside its labels -> where each point lies as far as is known, and how surely.

Gray values with one level, or without one, are for `iso_crossings`; with several levels each outline has that between its two sides. What
pixels of a drawing are mixed of is for `colour_crossings`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.shapes.place.colour_crossings import colour_crossings
from img2tri.shapes.place.iso_crossings import iso_crossings
from img2tri.shapes.trace.dual_edges import BOUND, DualEdges
from img2tri.types import ColourMix, Frame

OutlineLevel = float | tuple[float, ...] | None


def known_crossings(
    dual_edges: DualEdges, frame: Frame, gray: NDArray[Any] | ColourMix | None, level: OutlineLevel
) -> tuple[Floats, Floats]:
    """Return where each point lies on its dual edge as far as is known, and how far it may be shifted from there.

    Parameters
    ----------
    dual_edges, frame
        What has points, and where it lies.
    gray
        (h, w) gray values, or what pixels are mixed of; None: nothing is known.
    level
        The gray value of the outline; None is the middle between the two sides nearby. Several: labels count the levels below them, and
        the outline between two labels is at the middle of the first and the last level between them.
    """
    if gray is None:
        return np.zeros(len(dual_edges.middle)), np.full(len(dual_edges.middle), BOUND)
    if isinstance(gray, ColourMix):
        left, right = _labels_beside(dual_edges, gray.background)
        return colour_crossings(gray, left, right, dual_edges.middle, dual_edges.vector, frame)
    at = _between(level, *_labels_beside(dual_edges, 0)) if isinstance(level, tuple) else level
    return iso_crossings(gray, at, dual_edges.middle, dual_edges.vector, frame)


def _labels_beside(dual_edges: DualEdges, background: int) -> tuple[Ints, Ints]:
    """Return the labels (k,) on the left and right of each crossing; where nothing is meshed, the background."""
    edges = dual_edges.crack_edges
    left, right = edges.left[dual_edges.crossed], edges.right[dual_edges.crossed]
    return np.where(left == 0, background, edges.labels[left]), np.where(right == 0, background, edges.labels[right])


def _between(levels: tuple[float, ...], one: Ints, other: Ints) -> Floats:
    first, last = np.minimum(one, other), np.maximum(one, other) - 1
    most, known = len(levels) - 1, np.array(levels)
    return np.asarray((known[np.clip(first, 0, most)] + known[np.clip(last, 0, most)]) / 2)
