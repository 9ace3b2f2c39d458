"""Posts: places of outlines near borders of blocks that are vertices in all windows that see them.

Along an outline vertices are spaced evenly from its beginning on, and where it begins or is cut off by the window decides where each
lies. So the same outline has other vertices in the window of each block. With posts on both sides of a border, between which spacing begins
anew, it has the same ones there::

              border
       |        |        |
    ---P--o--o--o--o--o--P---      P  posts, D from the border      o  vertices, the same in both windows
       |        |        |

Which crossing of these lines is a post follows from places near it alone, never from where an outline begins (as chunks of a file are told
from what is in them, by A. Muthitacharoen and others, A low-bandwidth network file system, 2001, https://doi.org/10.1145/502034.502052).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex
from img2tri.types import Outlines

APART = 0.5  # of the distance of two lines: posts on one outline are not nearer to each other
LEAST_RING = 4.0  # times as long as posts are apart: rings that are shorter have none
COMPARED = 6  # crossings either way with which one is compared
AT_FRAME = 1.0  # px: what is nearer to the frame of a window ends there
ODD = 0.1 + 0.1j  # px: no crossing lies half-way between two roundings


def find_posts(outlines: Outlines, shift: complex, lines: tuple[Sequence[float], Sequence[float]], distance: float) -> Bools:
    """Tell which entries (k,) of the chains of dense outlines are posts.

    Parameters
    ----------
    outlines, shift
        In the plane of a window, px, and what has to be added for that of the image.
    lines
        x of upright lines, and y of level ones, in the plane of the window.
    distance
        Of these lines from each other, px.
    """
    chains, z = outlines.chains, as_complex(outlines.points)[outlines.chains.indices]
    crossing = np.unique(
        np.concatenate([_crossing(z, chains.heads, value, part) for part in (0, 1) for value in lines[part]], dtype=np.int64)
    )
    ends = np.zeros(len(z), bool)
    ends[chains.first] = ends[chains.last] = True
    crossing = crossing[~ends[crossing]]
    step = np.abs(np.diff(z, prepend=z[:1]))
    step[chains.first] = 0
    way = np.cumsum(step)
    length, apart = way[chains.last] - way[chains.first], APART * distance
    chain = chains.chain[crossing]
    # What both windows see from end to end needs none; ends on the frame of a window are none.
    low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
    to_frame = np.minimum(np.minimum(z.real - low.real, high.real - z.real), np.minimum(z.imag - low.imag, high.imag - z.imag))
    on_frame = to_frame < AT_FRAME
    far = (way[crossing] - way[chains.first[chain]] > apart) | on_frame[chains.first[chain]]
    far &= (way[chains.last[chain]] - way[crossing] > apart) | on_frame[chains.last[chain]]
    crossing = crossing[np.where(chains.rings[chain], length[chain] > LEAST_RING * apart, far)]
    least = _least_around(_key(z[crossing] + shift), way[crossing], chains.chain[crossing], apart)
    result = np.zeros(len(z), bool)
    result[crossing[least]] = True
    return result


def _crossing(z: Points, heads: Ints, value: float, part: int) -> Ints:
    """Entries next to where outlines cross a line."""
    off = (z.imag if part else z.real) - value
    at = heads[(off[heads] < 0) != (off[heads + 1] < 0)]
    return np.asarray(at + (np.abs(off[at + 1]) < np.abs(off[at])), np.int64)


def _key(places: Points) -> Floats:
    """Numbers without order that follow from the places of pixels."""
    near = places + ODD
    return np.asarray((np.rint(near.real) * 0.7548776662466927 + np.rint(near.imag) * 0.5698402909980532) % 1.0)


def _least_around(key: Floats, way: Floats, chain: Ints, apart: float) -> Bools:
    """Tell which entries, in order along chains, have the least key of those less than so far apart."""
    least = np.ones(len(key), bool)
    for k in range(1, COMPARED + 1):
        near = (chain[k:] == chain[:-k]) & (way[k:] - way[:-k] < apart)
        least[k:] &= ~near | (key[k:] < key[:-k])
        least[:-k] &= ~near | (key[:-k] <= key[k:])
    return least
