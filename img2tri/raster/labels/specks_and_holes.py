"""Label map -> label map without specks: small components are dropped, small holes filled, or only the largest pieces kept.

A component below the limit takes the label of a neighbour and so becomes a part of it. In a mask that drops specks of the
foreground and fills holes; in a label map a speck goes where it shares the most sides. The smallest go first, so that a cluster
of specks may grow to a region worth keeping, and all that do not touch each other go at once, in rounds. No round looks at pixels:
components and the sides they share are a small graph, which shrinks as components merge.

Every change removes sides between pixels of different labels and adds none, so the work ends, and outlines that stay are where
they were: gray values still tell where they run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints
from img2tri.errors import ParameterError, finite, shown
from img2tri.raster.labels.connected_components import Components, connected, find_components, joined
from img2tri.raster.labels.rgb_to_labels import LabelMap
from img2tri.types import Frame

LISTED = 100  # components listed in the report at most
AREA_ROUNDING = 1e-9  # limits come from lengths in world units


class Removed(TypedDict):
    """What was cleaned away, as plain data for the report.

    ``specks`` and ``holes`` are the numbers of components of regions and of the background, ``pixels`` how many pixels they had
    in all. ``listed`` has a record of each of the largest: ``label``, ``area`` in pixels, ``row`` and ``column`` of its first
    pixel, and the label it ``became``.
    """

    specks: int
    holes: int
    pixels: int
    listed: list[dict[str, int]]


def clean(
    labels: LabelMap,
    *,
    min_area: float | None = None,
    fill_holes: float | None = None,
    largest: bool = False,
    connectivity: int = 4,
) -> tuple[LabelMap, Removed]:
    """Remove the components of a label map that are too small to be meant.

    Parameters
    ----------
    labels
        The label map; a mask is one of two labels.
    min_area
        In pixels: components of fewer pixels, of regions and of the background, become part of a neighbour. Those at the
        frame of the image do too. None: all are kept.
    fill_holes
        In pixels: holes of fewer pixels, components of the background that do not reach the frame, become part of a neighbour; infinity
        fills all. None: only those that `min_area` fills.
    largest
        Keep only the largest component of each region, of several equally large ones the first. The others become
        background, or part of a neighbour if there is no background. Holes are not filled.
    connectivity
        As for the outlines. 4: the foreground of a mask hangs together through the sides of pixels, its background
        through their corners too; 8: the other way round. For label maps see `connected_components`.

    Returns
    -------
    cleaned
        `labels` itself if nothing was removed.
    removed
        What was removed.

    Raises
    ------
    ParameterError
        If `min_area` is not a number of at least 0, or `connectivity` neither 4 nor 8.

    Notes
    -----
    Of the neighbours through sides those that stay go first, then the label with the longest interface, then the lowest
    label. A component that fills the whole image has no neighbour, and stays.

    Examples
    --------
    >>> import numpy as np
    >>> spots = LabelMap(np.array([[1, 1, 1, 0, 2], [1, 3, 1, 0, 0], [1, 1, 1, 0, 0]]), 0)
    >>> cleaned, removed = clean(spots, min_area=2)
    >>> cleaned.values
    array([[1, 1, 1, 0, 0], [1, 1, 1, 0, 0], [1, 1, 1, 0, 0]])
    >>> removed["specks"], removed["listed"][1]
    (2, {'label': 3, 'area': 1, 'row': 1, 'column': 1, 'became': 1})
    """
    if connectivity not in (4, 8):
        raise ParameterError(f"connectivity: expected 4 or 8, found {shown(connectivity)}")
    values, removed = labels.values, Removed(specks=0, holes=0, pixels=0, listed=[])
    steps = cleaning_steps(min_area=min_area, fill_holes=fill_holes, largest=largest, background=labels.background)
    changed = True
    while changed:
        # A removal may part another component where it was joined through a corner; hardly any image needs a second turn.
        changed = False
        for what, least in steps:
            parts = find_components(values, background=labels.background, connectivity=connectivity)
            number = numbers_after(parts, what, least, labels.background, connectivity, partial(_at_frame, parts, values.shape))
            if (number != parts.number).any():
                changed = True
                removed = added(removed, parts, number, values.shape[1])
                values = _written(values, parts, number)
    return (LabelMap(values, labels.background) if removed["pixels"] else labels), removed


def area_in_pixels(name: str, area: bool | float | str | None, frame: Frame) -> float | None:
    """Return an area given by a user in pixels, infinity for True."""
    if isinstance(area, bool) or area is None:
        return math.inf if area else None
    return frame.area(name, area) / math.prod(frame.spacing)


def cleaning_steps(*, min_area: float | None, fill_holes: float | None, largest: bool, background: int | None) -> list[tuple[str, float]]:
    """Return what is removed one after the other, "holes", "specks" or "largest", and below which area; arguments as for `clean`."""
    limit = 0.0 if min_area is None else finite("min_area", min_area, least=0) * (1 - AREA_ROUNDING)
    holes = 0.0 if fill_holes is None or background is None else fill_holes * (1 - AREA_ROUNDING)
    return [("holes", holes)] * (holes > 1) + [("specks", limit)] * (limit > 1) + [("largest", 0.0)] * bool(largest)


def numbers_after(
    parts: Components, what: str, least: float, background: int | None, connectivity: int, at_frame: Callable[[], Bools]
) -> Ints:
    """Return the label each component has after the removal of holes, or of all, with an area below `least`, or of all but the largest.

    Labels are indices into `parts.values`; `at_frame` tells which components reach the frame of the image.
    """
    if what == "largest":
        keep = _largest(parts)
    elif what == "holes":
        keep = (parts.number != 0) | (parts.area >= least) | at_frame()
    else:
        keep = parts.area >= least
    if keep.all():
        return parts.number
    if what == "largest" and background is not None:
        return np.where(keep, parts.number, 0)
    return _absorbed(parts, keep, least, connectivity)


def _at_frame(parts: Components, shape: tuple[int, ...]) -> Bools:
    """Tell which components reach the frame of the image."""
    h, w = shape
    row, column = np.divmod(parts.start, w)
    at_frame = np.zeros(len(parts.area), bool)
    at_frame[parts.component[(row == 0) | (row == h - 1) | (column == 0) | (column + parts.length == w)]] = True
    return at_frame


def _largest(parts: Components) -> Bools:
    """Tell which components are the largest of their label, or background."""
    order = np.lexsort((-parts.area, parts.number))
    keep: Bools = parts.number == 0
    keep[order[np.diff(parts.number[order], prepend=-1) > 0]] = True
    return keep


def _absorbed(parts: Components, keep: Bools, least: float, connectivity: int) -> Ints:
    """Let components that are not kept become part of their neighbours; groups with an area of `least` are kept too.

    Returns
    -------
    ndarray
        (k,) int64, the label of each component, as an index into ``parts.values``.
    """
    number, area, corners, sides = parts.number, parts.area, parts.corners, parts.sides
    one, other = parts.touching.T
    group = np.arange(len(area))
    while True:
        # Kept ones never change, so what lies among them alone no longer matters.
        near = ~(keep[one] & keep[other])
        one, other, sides = summed(one[near], other[near], sides[near])
        corners = corners[~keep[corners].all(axis=1)]
        if not len(one):
            return number[group]
        number = _adopted(number, keep, _first(area, keep, one, other), one, other, sides)
        pairs = np.stack([one, other], axis=1)[number[one] == number[other]]
        into = connected(len(area), np.concatenate([pairs, joined(corners, number, connectivity)]))
        count = int(into.max()) + 1
        area = np.bincount(into, area, count).astype(np.int64)  # whole numbers of pixels
        keep = (np.bincount(into, keep, count) > 0) | (area >= least)
        number = _of_groups(number, into, count)
        one, other, corners, group = into[one], into[other], into[corners], into[group]


def summed(one: Ints, other: Ints, sides: Ints) -> tuple[Ints, Ints, Ints]:
    """Bring pairs of different groups into order, each once, with the number of sides they share in all."""
    lower, higher = np.minimum(one, other), np.maximum(one, other)
    apart = lower != higher
    count = int(higher.max(initial=0)) + 1
    pair, which = np.unique((lower * count + higher)[apart], return_inverse=True)
    return *np.divmod(pair, count), np.bincount(which, sides[apart], len(pair)).astype(np.int64)


def _first(area: Ints, keep: Bools, one: Ints, other: Ints) -> Bools:
    """Pick those whose turn it is: not kept, and the smallest of such neighbours, so that no two of them touch.

    Ties are broken by numbers without any order, since along a row of equals with an order only the first would have its turn.
    """
    lot = np.arange(len(area), dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    lot = (lot ^ (lot >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    rivals = ~keep[one] & ~keep[other]
    x, y = one[rivals], other[rivals]
    x_is_first = (area[x] < area[y]) | ((area[x] == area[y]) & (lot[x] < lot[y]))
    first = ~keep
    first[np.where(x_is_first, y, x)] = False
    return first


def _adopted(number: Ints, keep: Bools, acting: Bools, one: Ints, other: Ints, sides: Ints) -> Ints:
    """Give those acting the label of a neighbour: of one that is kept if possible, with the longest interface, the lowest."""
    here, there, sides = np.append(one, other), np.append(other, one), np.append(sides, sides)
    beside_kept = np.zeros(len(number), bool)
    beside_kept[here[keep[there]]] = True
    asked = acting[here] & (keep[there] | ~beside_kept[here])
    labels = int(number.max()) + 1
    pair, which = np.unique(here[asked] * labels + number[there[asked]], return_inverse=True)
    who, label = np.divmod(pair, labels)
    order = np.lexsort((label, -np.bincount(which, sides[asked]), who))
    best = order[np.diff(who[order], prepend=-1) > 0]
    adopted = number.copy()
    adopted[who[best]] = label[best]
    return adopted


def _of_groups(number: Ints, into: Ints, count: int) -> Ints:
    found = np.zeros(count, np.int64)
    found[into] = number
    return found


def _written(values: NDArray[Any], parts: Components, number: Ints) -> NDArray[Any]:
    """Return a copy of a label map with the new labels in it."""
    run = np.flatnonzero((number != parts.number)[parts.component])
    length, became = parts.length[run], parts.values[number][parts.component[run]]
    # A background that did not occur may not fit the type.
    fits = bool((became.astype(values.dtype) == became).all())
    written = np.array(values, values.dtype if fits else np.int64, order="C")
    pixel = np.arange(length.sum()) + np.repeat(parts.start[run] - np.cumsum(length) + length, length)
    written.reshape(-1)[pixel] = np.repeat(became, length)
    return written


def added(removed: Removed, parts: Components, number: Ints, width: int) -> Removed:
    """Add the components that change their label to what was removed before."""
    gone = np.flatnonzero(number != parts.number)
    holes = int((parts.number[gone] == 0).sum())
    shown = gone[np.argsort(-parts.area[gone], kind="stable")[:LISTED]]
    first = np.zeros(len(parts.area), np.int64)
    first[parts.component[::-1]] = parts.start[::-1]
    columns = (parts.values[parts.number[shown]], parts.area[shown], *np.divmod(first[shown], width), parts.values[number[shown]])
    names = ("label", "area", "row", "column", "became")
    listed = [dict(zip(names, row, strict=True)) for row in np.stack(columns, axis=1).tolist()]
    return Removed(
        specks=removed["specks"] + len(gone) - holes,
        holes=removed["holes"] + holes,
        pixels=removed["pixels"] + int(parts.area[gone].sum()),
        listed=sorted(removed["listed"] + listed, key=lambda row: -row["area"])[:LISTED],
    )
