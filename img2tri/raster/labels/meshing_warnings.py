"""A label map -> what will come of it that is hardly meant, told before the work.

That is far more triangles than asked, regions in pieces, and labels that are no more than edges. Each is found by a look at the pixels and
their neighbours, which costs little beside the mesh. Numbers of triangles are predictions: along outlines some 1.5 for each side of a pixel
between a region and the background, and some 3 between two regions; they were right to a factor of 3 on noise, pages of text, coasts,
grains and phases.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from img2tri.errors import ConfettiWarning, ConnectivityWarning, Img2triWarning, SizeWarning
from img2tri.raster.labels.connected_components import find_components
from img2tri.raster.labels.rgb_to_labels import distinct
from img2tri.raster.labels.segmentation import Segmentation

USUALLY_ASKED = 2000  # triangles: what the default edge length aims at
FAR_MORE, MANY_TRIANGLES = 10, 100_000  # times what was asked, and in all: less is not worth a word
ONE_SIDED, TWO_SIDED = 1.5, 3.0  # triangles for each side of a pixel
PIECES = 20  # fewer pieces that touch at corners are nothing to warn of
MANY_REGIONS = 20  # fewer regions that are only edges may be meant


def meshing_warnings(found: Segmentation, *, connectivity: int, asked: float | None) -> Iterator[Img2triWarning]:
    """Yield a warning for each thing that is hardly meant.

    Parameters
    ----------
    found
        What is to be meshed.
    connectivity
        As for the outlines.
    asked
        How many triangles the wanted edge length takes to fill the image; None: the usual number.

    Examples
    --------
    >>> diagonal = np.eye(30, dtype=bool)
    >>> [str(w)[:60] for w in meshing_warnings(Segmentation(diagonal, 0), connectivity=4, asked=None)]
    ['label 1 is 30 pieces that touch at corners of pixels only; c']
    """
    yield from _far_more(found, USUALLY_ASKED if asked is None else asked)
    yield from _in_pieces(found, connectivity)
    if found.labels.dtype != bool:
        yield from _only_edges(found)


def predicted_triangles(found: Segmentation, asked: float) -> float:
    """Return about how many triangles a label map takes."""
    flat, sides, background = found.labels.reshape(-1), 0.0, found.background
    for at, step in zip(found.changes, (1, found.labels.shape[1]), strict=True):
        one, other = flat[at], flat[at + step]
        single = 0 if background is None else np.count_nonzero((one == background) | (other == background))
        sides += ONE_SIDED * single + TWO_SIDED * (len(at) - single)
    return asked + sides


def _far_more(found: Segmentation, asked: float) -> Iterator[Img2triWarning]:
    count = predicted_triangles(found, asked)
    if count > max(FAR_MORE * asked, MANY_TRIANGLES):
        yield SizeWarning(
            f"some {_rounded(count):,} triangles are to be expected, where {_rounded(asked):,} would fill the image, as outlines have so "
            "much detail; min_area='20px2' drops specks, a larger tolerance= lets detail go, colors= takes few colours, crop= a part"
        )


def _in_pieces(found: Segmentation, connectivity: int) -> Iterator[Img2triWarning]:
    labels, background, at, w = found.labels, found.background, found.changes[0], found.labels.shape[1]
    # a b    at, and the pixel right of it; a checkerboard has d = a and c = b
    # c d
    at, flat = at[at < labels.size - w], labels.reshape(-1)
    if np.count_nonzero((flat[at] == flat[at + w + 1]) & (flat[at + 1] == flat[at + w])) < PIECES:
        return
    counts = []
    for way in (connectivity, 12 - connectivity):
        parts = find_components(labels, background=background, connectivity=way)
        counts.append((np.bincount(parts.number, minlength=len(parts.values)), parts.values))
    (here, values), (there, _) = counts
    worst = int(np.argmax(np.where(np.arange(len(here)) > 0, here - there, 0)))
    if here[worst] - there[worst] >= PIECES and 2 * there[worst] < here[worst]:
        yield ConnectivityWarning(
            f"label {values[worst]} is {here[worst]:,} pieces that touch at corners of pixels only; "
            f"connectivity={12 - connectivity} joins them to {there[worst]:,}"
        )


def _only_edges(found: Segmentation) -> Iterator[Img2triWarning]:
    labels, (right, below) = found.labels, found.changes
    inside = np.zeros(labels.shape, bool)
    inside[1:-1, 1:-1] = True
    for at, step in ((right, 1), (below, labels.shape[1])):
        inside.reshape(-1)[at] = inside.reshape(-1)[at + step] = False
    every = distinct(labels)
    solid = distinct(labels[inside]) if inside.any() else every[:0]
    if len(every) >= MANY_REGIONS and 2 <= len(solid) < len(every) / 2:
        yield ConfettiWarning(
            f"{len(every) - len(solid):,} of {len(every):,} labels have no pixel off an edge, as colours between two others have in "
            f"drawings with soft edges and in JPEG; colors={len(solid) - 1} gives each pixel one of so many colours, and lets the mix "
            "place the edges"
        )


def _rounded(count: float) -> int:
    """Round to two digits."""
    digits = len(str(int(count))) - 2
    return round(int(count), -digits) if digits > 0 else int(count)
