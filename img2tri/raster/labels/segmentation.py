"""Picture -> segmentation: the label map to be meshed, and the gray values that place its outlines, if they say more than the labels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ParameterError
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.label_maps import LabelMap, label_map
from img2tri.raster.labels.otsu_threshold import Level, binarize, two_valued
from img2tri.raster.labels.specks_and_holes import Removed, clean
from img2tri.types import Picture


@dataclass(frozen=True, eq=False)
class Segmentation:
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


def segment(
    picture: Picture,
    *,
    threshold: float | str | None = None,
    labels: bool | Iterable[int] | None = None,
    background: int | None = 0,
    invert: bool = False,
) -> Segmentation:
    """Find the foreground, label 1, or the regions of a label map.

    Parameters
    ----------
    picture
        From `read`.
    threshold, invert
        As for `binarize`; of the foreground only.
    labels, background
        As for `label_map`; None or False parts foreground from background.

    Raises
    ------
    ImageError, ParameterError
        As `binarize` and `label_map` do.

    Examples
    --------
    >>> from img2tri.raster.reading import read
    >>> found = segment(read(np.array([[10, 90, 200]], np.uint8)), threshold=100)
    >>> found.labels, found.level
    (array([[False, False,  True]]), 100.5)
    """
    if labels is not None and labels is not False:
        for name, value in (("threshold", threshold), ("invert", invert or None)):
            if value is not None:
                raise ParameterError(f"{name}: expected to be left out with labels, whose values are regions as they are, found {value!r}")
        numbers = label_map(picture.values, labels=labels, background=background)
        return Segmentation(numbers.values, numbers.background)
    gray = to_gray(picture.values, palette=picture.notes.get("palette"))
    mask, chosen = binarize(gray, threshold=threshold, invert=invert)
    if chosen.how == "given" and not two_valued(gray):
        # Strictly greater is foreground: of whole numbers the level lies between two.
        whole = np.issubdtype(gray.dtype, np.integer)
        return Segmentation(mask, 0, chosen, gray, float(np.floor(chosen.value)) + 0.5 if whole else chosen.value)
    return Segmentation(mask, 0, chosen, gray if chosen.how == "otsu" and not two_valued(gray) else None)


def without_specks(found: Segmentation, *, min_area: float | None, largest: bool, connectivity: int) -> tuple[Segmentation, Removed]:
    """Remove specks and small holes, or all but the largest components, as `clean` does; `min_area` in pixels.

    Examples
    --------
    >>> found, removed = without_specks(Segmentation(np.eye(3, dtype=bool), 0), min_area=2, largest=False, connectivity=4)
    >>> found.labels.any(), removed["specks"]
    (np.False_, 3)
    """
    labels, removed = clean(LabelMap(found.labels, found.background), min_area=min_area, largest=largest, connectivity=connectivity)
    return replace(found, labels=labels.values, background=labels.background), removed
