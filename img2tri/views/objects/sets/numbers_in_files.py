"""The numbers of regions and named sets in files: labels and names -> whole numbers from 1 on, within 32 bits, no number twice.

A region keeps its label as its number if it is one. Many programs go by numbers alone, whatever their dimension, so the tags of sets begin
above: 1001 left, 1002 right, 1003 bottom, 1004 top, 1005 outer, whichever sets there are; 1006 and 1007 the bottom and top of a solid; from
1011 on the holes, then the interfaces by their labels, then the pieces. Where labels of regions are as large, 10,000 or the next power of
ten is added instead of 1000.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

FRAME = ("left", "right", "bottom", "top")
OUTER = "outer"
Z_MIN, Z_MAX = "z_min", "z_max"  # of solids
_OTHERS = 11  # the first of the other sets
LARGEST_LABEL = 2_000_000_000  # most programs keep numbers in 32 bits; the rest is for labels that are larger, and for sets


def file_numbers(labels: Iterable[int]) -> dict[int, int]:
    """Return for each label a number of at least 1 within 32 bits, as formats want it.

    Labels that are such numbers stay; the others get the next free ones, in ascending order.

    Examples
    --------
    >>> file_numbers([-3, 2, 720575940610453042])
    {-3: 3, 2: 2, 720575940610453042: 4}
    """
    labels = list(labels)
    kept = [label for label in labels if 1 <= label <= LARGEST_LABEL]
    others = sorted(set(labels).difference(kept))
    number = {label: label for label in kept} | {label: max(0, 0, *kept) + i for i, label in enumerate(others, 1)}
    return {label: number[label] for label in labels}


def set_tags(names: Iterable[str], taken: Iterable[int]) -> dict[str, int]:
    """Return the number of each set in files: none of those `taken` by regions.

    Examples
    --------
    >>> set_tags(["left", "outer", "hole_1"], [1, 2]), set_tags(["left"], [1001])
    ({'left': 1001, 'outer': 1005, 'hole_1': 1011}, {'left': 10001})
    """
    names, used = list(names), np.array(sorted(taken))
    fixed = (*FRAME, OUTER, Z_MIN, Z_MAX)
    others = [name for name in names if name not in fixed]
    numbers = {name: i for i, name in enumerate(fixed, 1)} | {name: i for i, name in enumerate(others, _OTHERS)}
    base = next(b for b in (10**k for k in range(3, 10)) if not np.any((used > b) & (used < b + _OTHERS + len(others))))
    return {name: base + numbers[name] for name in names}
