"""A drawing of a few flat colours -> a label map, whatever lies between the colours: anti-aliased, blurred or JPEG edges.

A pixel on such an edge is a mix of two colours. Taken for a colour of its own, or for the listed colour that happens to be nearest, it
makes a thin false region. So the *cores* are found first, blocks of 2 x 2 pixels near one colour. Any other pixel is explained by two
colours with cores nearby, if it lies between them as colours do that are mixed::

    A . . . x . . . B      x is near the line from A to B: it gets the colour it is nearer to, never a third one
                  C

and if it does not, it is a thin detail, and gets the nearest colour of all. How much of each colour is in a mix also says where the edge
runs, see `types.ColourMix`.

How many colours there are cannot be told from an image; which they are can: they are found among the pixels of even blocks by k-means
(Lloyd 1982, doi 10.1109/TIT.1982.1056489), begun with those that are frequent and far from the ones before, without any chance.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints
from img2tri.errors import ParameterError

PURE_COLOUR = 0.25  # of the distance to the next colour: how far from its colour a pixel of a core may be
MIXED_COLOUR = 0.12  # of the distance of two colours: how far off the line between them a mix of them may be
CORES_NEARBY = 2  # pixels: where the two colours of a mix are looked for
EVEN_COLOUR, COLOURS_APART = 12 / 255, 28 / 255  # of the range: of a block of one colour at most, between two colours at least
BITS_PER_CHANNEL = 5  # per channel, of colours counted to find the frequent ones
LEAST_COLOUR = 2e-4  # of the even pixels: rarer colours are not found
K_MEANS_ROUNDS = 12
MOST_COUNTED = 1_000_000  # pixels looked at to find the colours


def find_colours(values: NDArray[Any], count: int, ground: Floats | None, missing: Bools | None) -> Floats:
    """Find the flat colours of an image.

    Parameters
    ----------
    values
        (h, w, c).
    count
        How many, besides the ground.
    ground
        (c,) the colour of the background: if the image has it, it is the first of those returned. None: there is none.
    missing
        (h, w) pixels that are not there.

    Returns
    -------
    ndarray
        (k, c) colours of the image; k is `count`, or one more with the ground.

    Raises
    ------
    ParameterError
        If the image has fewer flat colours.
    """
    scale = value_range(values)
    even = _even_blocks(values, EVEN_COLOUR * scale)
    there = np.ones(even.shape, bool) if missing is None else ~missing
    pixels = values[even & there if (even & there).mean() > 0.01 else there]
    pixels = pixels[:: max(1, len(pixels) // MOST_COUNTED)].astype(np.float64)
    centres, weights = _histogram(pixels / scale)
    chosen = []
    if ground is not None:
        at_ground = np.linalg.norm(centres - ground / scale, axis=1) < COLOURS_APART
        if weights[at_ground].sum() > LEAST_COLOUR:
            chosen.append(ground / scale)
    wanted = count + len(chosen)
    if not chosen:
        chosen.append(centres[np.argmax(weights)])
    while len(chosen) < wanted:
        far = np.linalg.norm(centres[:, None] - np.array(chosen), axis=2).min(axis=1)
        score = np.where((far > COLOURS_APART) & (weights > LEAST_COLOUR), weights * far**2, 0.0)
        if not score.max() > 0:
            break
        chosen.append(centres[np.argmax(score)])
    if len(chosen) < count:
        raise ParameterError(f"colors: expected {count} flat colours in the image, found {len(chosen)}; ask for fewer, or list them")
    return _frequent(pixels, _k_means(centres, weights, np.array(chosen)) * scale)


def nearest_colour(values: NDArray[Any], colours: Floats) -> tuple[Ints, Floats]:
    """Return the number of the nearest colour of each pixel (h, w), and its distance."""
    best, index = np.full(values.shape[:2], np.inf), np.zeros(values.shape[:2], np.int64)
    pixels = values.astype(np.float64)
    for i, colour in enumerate(colours):
        distance = ((pixels - colour) ** 2).sum(axis=2)
        closer = distance < best
        best[closer], index[closer] = distance[closer], i
    return index, np.sqrt(best)


def assigned(values: NDArray[Any], colours: Floats) -> tuple[Ints, Floats]:
    """Return the number of the colour of each pixel (h, w), mixes explained by colours nearby, and its distance from the nearest.

    Examples
    --------
    A row from black to white, whose middle is near to a red that is in the list but not there:

    >>> row = np.repeat([0, 0, 0, 140, 255, 255, 255], 3).reshape(1, 7, 3) * np.ones((3, 1, 1))
    >>> assigned(row, np.array([[0, 0, 0], [255, 255, 255], [160, 120, 120]]))[0][1]
    array([0, 0, 0, 1, 1, 1, 1])
    """
    index, distance = nearest_colour(values, colours)
    apart = np.linalg.norm(colours[:, None] - colours, axis=2)
    np.fill_diagonal(apart, np.inf)
    core = _blocks(index) & (distance <= PURE_COLOUR * apart.min(axis=1)[index])
    doubtful = np.flatnonzero(~core)
    if not len(doubtful) or len(colours) < 2:
        return index, distance

    # Which colours have cores nearby.
    h, w = index.shape
    row, column = np.divmod(doubtful, w)
    present = np.zeros((len(doubtful), len(colours)), bool)
    for r in range(-CORES_NEARBY, CORES_NEARBY + 1):
        for c in range(-CORES_NEARBY, CORES_NEARBY + 1):
            at = np.clip(row + r, 0, h - 1), np.clip(column + c, 0, w - 1)
            there = core[at]
            present[there, index[at][there]] = True

    # The two of them between which the pixel lies best.
    pixels = values[row, column].astype(np.float64)
    off, which = np.full(len(doubtful), np.inf), index[row, column]
    for i, j in zip(*np.nonzero(np.triu(present.T.astype(np.int64) @ present, 1)), strict=True):
        here = np.flatnonzero(present[:, i] & present[:, j])
        span = colours[j] - colours[i]
        along = np.clip((pixels[here] - colours[i]) @ span / (span @ span), 0, 1)
        beside = np.linalg.norm(pixels[here] - colours[i] - along[:, None] * span, axis=1)
        better = (beside < MIXED_COLOUR * apart[i, j]) & (beside < off[here])
        off[here[better]], which[here[better]] = beside[better], np.where(along[better] < 0.5, i, j)
    index[row, column] = which
    return index, distance


def value_range(values: NDArray[Any]) -> float:
    """Return what is white: the greatest number of uint8 and uint16, else the greatest value there is."""
    if values.dtype in (np.uint8, np.uint16):
        return float(np.iinfo(values.dtype).max)
    return max(float(np.abs(values).max()), 1e-300)


def _even_blocks(values: NDArray[Any], most: float) -> Bools:
    """Tell which pixels are in a block of 2 x 2 whose channels differ by `most` at most."""
    corners = [values[r : values.shape[0] - 1 + r, c : values.shape[1] - 1 + c] for r in (0, 1) for c in (0, 1)]
    high, low = np.maximum.reduce(corners), np.minimum.reduce(corners)
    return _grown((high - low <= most).all(axis=2))


def _blocks(index: Ints) -> Bools:
    """Tell which pixels are in a block of 2 x 2 of one number."""
    right, down = index[:, 1:] == index[:, :-1], index[1:] == index[:-1]
    return _grown(right[1:] & right[:-1] & down[:, 1:] & down[:, :-1])


def _grown(block: Bools) -> Bools:
    h, w = block.shape
    pixels = np.zeros((h + 1, w + 1), bool)
    for r in (0, 1):
        for c in (0, 1):
            pixels[r : h + r, c : w + c] |= block
    return pixels


def _histogram(pixels: Floats) -> tuple[Floats, Floats]:
    """Return the mean (n, c) and the share (n,) of the colours in each bin that has any."""
    steps = np.clip(pixels * (1 << BITS_PER_CHANNEL), 0, (1 << BITS_PER_CHANNEL) - 1).astype(np.int64)
    numbers = steps @ (1 << (BITS_PER_CHANNEL * np.arange(pixels.shape[1])))
    _, number, count = np.unique(numbers, return_inverse=True, return_counts=True)
    means = np.stack([np.bincount(number, channel) for channel in pixels.T], axis=1) / count[:, None]
    return means, count / len(pixels)


def _k_means(points: Floats, weights: Floats, centres: Floats) -> Floats:
    for _ in range(K_MEANS_ROUNDS):
        group = np.linalg.norm(points[:, None] - centres, axis=2).argmin(axis=1)
        total = np.bincount(group, weights, len(centres))
        means = np.stack([np.bincount(group, weights * channel, len(centres)) for channel in points.T], axis=1)
        centres = np.where(total[:, None] > 0, means / np.maximum(total, 1e-300)[:, None], centres)
    return centres


def _frequent(pixels: Floats, colours: Floats) -> Floats:
    """Return the most frequent exact colour near each."""
    seen, count = np.unique(pixels, axis=0, return_counts=True)
    group = np.linalg.norm(seen[:, None] - colours, axis=2).argmin(axis=1)
    order = np.lexsort((-count, group))
    first = order[np.diff(group[order], prepend=-1) > 0]
    found = colours.copy()
    found[group[first]] = seen[first]
    return found
