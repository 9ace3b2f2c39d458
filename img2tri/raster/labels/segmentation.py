"""Picture -> zones: the label map to be meshed, and the gray values that place its outlines, if they say more than the labels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ParameterError
from img2tri.raster.labels.cleaning import Removed, clean
from img2tri.raster.labels.gray import to_gray
from img2tri.raster.labels.label_maps import LabelMap, label_map
from img2tri.raster.labels.thresholds import Level, binarize
from img2tri.types import Picture


@dataclass(frozen=True, eq=False)
class Zones:
    """What of a picture is to be meshed.

    Attributes
    ----------
    labels
        (h, w) bool or integer, a label for each pixel.
    background
        The label that is not meshed; None: all are.
    threshold
        The level that parted the image, and how it was found; None for label maps.
    gray
        (h, w) gray values; None where they say no more than the labels: masks, images of two values, label maps.
    level
        The gray value of the outline; None is the middle between the two sides, wherever that is.
    """

    labels: NDArray[Any]
    background: int | None
    threshold: Level | None = None
    gray: NDArray[Any] | None = None
    level: float | None = None


def find_zones(
    picture: Picture,
    *,
    threshold: float | str | None = None,
    labels: bool | Iterable[int] | None = None,
    background: int | None = 0,
    invert: bool = False,
) -> Zones:
    """Find one white zone, label 1, or the regions of a label map.

    Parameters
    ----------
    picture
        From `read`.
    threshold, invert
        As for `binarize`; of one white zone only.
    labels, background
        As for `label_map`; None or False looks for one white zone.

    Raises
    ------
    ImageError, ParameterError
        As `binarize` and `label_map` do.

    Examples
    --------
    >>> from img2tri.raster.io.reading import read
    >>> zones = find_zones(read(np.array([[10, 90, 200]], np.uint8)), threshold=100)
    >>> zones.labels, zones.level
    (array([[False, False,  True]]), 100.5)
    """
    if labels is not None and labels is not False:
        for name, value in (("threshold", threshold), ("invert", invert or None)):
            if value is not None:
                raise ParameterError(f"{name}: expected to be left out with labels, whose values are regions as they are, found {value!r}")
        numbers = label_map(picture.values, labels=labels, background=background)
        return Zones(numbers.values, numbers.background)
    gray = to_gray(picture.values, palette=picture.notes.get("palette"))
    mask, chosen = binarize(gray, threshold=threshold, invert=invert)
    if chosen.how == "given" and not _two_valued(gray):
        # Strictly greater is foreground: of whole numbers the level lies between two.
        whole = np.issubdtype(gray.dtype, np.integer)
        return Zones(mask, 0, chosen, gray, float(np.floor(chosen.value)) + 0.5 if whole else chosen.value)
    return Zones(mask, 0, chosen, gray if chosen.how == "otsu" and not _two_valued(gray) else None)


def cleaned(zones: Zones, *, min_area: float | None, largest: bool, connectivity: int) -> tuple[Zones, Removed]:
    """Remove specks and small holes, or all but the largest components, as `clean` does; `min_area` in pixels.

    Examples
    --------
    >>> zones, removed = cleaned(Zones(np.eye(3, dtype=bool), 0), min_area=2, largest=False, connectivity=4)
    >>> zones.labels.any(), removed["specks"]
    (np.False_, 3)
    """
    labels, removed = clean(LabelMap(zones.labels, zones.background), min_area=min_area, largest=largest, connectivity=connectivity)
    return replace(zones, labels=labels.values, background=labels.background), removed


def _two_valued(gray: NDArray[Any]) -> bool:
    """Whether an image has at most two different values."""
    low, high = gray.min(), gray.max()
    return bool(((gray == low) | (gray == high)).all())
