"""Picture -> segmentation: the label map to be meshed, and the gray values that place its outlines, if they say more than the labels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools
from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.colours_to_gray import alpha_is_the_picture, to_gray
from img2tri.raster.labels.label_map_check import flat_values
from img2tri.raster.labels.label_maps import LabelMap, label_map
from img2tri.raster.labels.otsu_threshold import Level, binarize, two_valued
from img2tri.raster.labels.specks_and_holes import Removed, clean
from img2tri.raster.labels.transparency import alpha_channel, filled, half_opaque, says_what_is_there, transparent
from img2tri.raster.metadata.nodata import either
from img2tri.types import Picture

LISTED = 10  # values in a message
TRANSPARENT = "transparent pixels are not meshed; they are no colour, so that black, 0, is a region where the image has it"
SILHOUETTE = (
    "the silhouette was meshed, all that is opaque, as some pixels are transparent; labels=True makes each colour a region, "
    "threshold='otsu' or a number parts what is opaque by its gray values"
)


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
    notes
        What was decided, in sentences for the report.
    """

    labels: NDArray[Any]
    background: int | None
    threshold: Level | None = None
    gray: NDArray[Any] | None = None
    level: float | None = None
    notes: tuple[str, ...] = ()


def segment(
    picture: Picture,
    *,
    threshold: float | str | None = None,
    labels: bool | Iterable[int] | None = None,
    background: int | None = 0,
    invert: bool = False,
) -> Segmentation:
    """Find the foreground, label 1, or the regions of a label map. Pixels that are not there, or transparent, are in none.

    Parameters
    ----------
    picture
        From `read`.
    threshold, invert
        As for `binarize`; of the foreground only. "alpha" is the silhouette: what is opaque is foreground; None is that too where
        some pixels are fully transparent.
    labels, background
        As for `label_map`; None or False parts foreground from background.

    Raises
    ------
    ImageError
        If there is no threshold, and the image looks like a label map; if no pixel is there.
    ImageError, ParameterError
        As `binarize` and `label_map` do.

    Examples
    --------
    >>> from img2tri.raster.reading import read
    >>> found = segment(read(np.array([[10, 90, 200]], np.uint8)), threshold=100)
    >>> found.labels, found.level
    (array([[False, False,  True]]), 100.5)
    """
    alpha = alpha_channel(picture)
    gone = either(picture.missing, transparent(alpha))
    if gone is not None and gone.all():
        raise ImageError("image: expected pixels that are there, found only transparent ones, NaN and no data")
    if labels is not None and labels is not False:
        for name, value in (("threshold", threshold), ("invert", invert or None)):
            if value is not None:
                raise ParameterError(f"{name}: expected to be left out with labels, whose values are regions as they are, found {value!r}")
        clear = says_what_is_there(alpha)
        numbers = label_map(_opaque(picture, gone), labels=labels, background=background, missing=gone, transparent=clear)
        return Segmentation(numbers.values, numbers.background, notes=(TRANSPARENT,) * clear)
    if threshold == "alpha" or (threshold is None and says_what_is_there(alpha)):
        return _silhouette(alpha, picture.missing, invert=invert)
    if threshold is None:
        _check_thresholdable(filled(picture.values, gone))
    return _foreground(picture, gone, threshold=threshold, invert=invert)


def _foreground(picture: Picture, gone: Bools | None, *, threshold: float | str | None, invert: bool) -> Segmentation:
    """Part an image by its gray values; those of pixels that are not there neither choose the level nor place an edge."""
    gray = to_gray(_opaque(picture, gone), palette=picture.notes.get("palette"), min_is_white="min_is_white" in picture.notes)
    if gone is None:
        mask, chosen = binarize(gray, threshold=threshold, invert=invert)
        flat = two_valued(gray)
    else:
        seen = gray[~gone][None]
        seen_mask, chosen = binarize(seen, threshold=threshold, invert=invert)
        flat, mask = two_valued(seen), np.zeros(gray.shape, bool)
        mask[~gone] = seen_mask[0]
        gray = np.where(gone, np.nan, gray)
    if flat or chosen.how not in ("given", "otsu"):
        return Segmentation(mask, 0, chosen)
    if chosen.how == "otsu":
        return Segmentation(mask, 0, chosen, gray)
    # Strictly greater is foreground: of whole numbers the level lies between two.
    whole = np.issubdtype(picture.values.dtype, np.integer)
    return Segmentation(mask, 0, chosen, gray, float(np.floor(chosen.value)) + 0.5 if whole else chosen.value)


def _silhouette(alpha: NDArray[Any] | None, missing: Bools | None, *, invert: bool) -> Segmentation:
    """Take what is opaque as foreground."""
    if alpha is None:
        raise ParameterError("threshold: 'alpha' expected an image with an alpha channel, found none; give a number or 'otsu'")
    chosen = Level(half_opaque(alpha), "alpha")
    mask = (alpha >= chosen.value) != invert
    if missing is not None:
        mask &= ~missing
    gray = alpha if missing is None else np.where(missing, np.nan, alpha)
    notes = (SILHOUETTE,) * (not invert)
    return Segmentation(mask, 0, chosen, notes=notes) if two_valued(alpha) else Segmentation(mask, 0, chosen, gray, chosen.value, notes)


def _opaque(picture: Picture, gone: Bools | None) -> NDArray[Any]:
    """Return the values of a picture without the alpha that said which pixels are there, nor the values of those that are not."""
    values = picture.values
    if says_what_is_there(alpha_channel(picture)) and values.ndim == 3 and not alpha_is_the_picture(values):
        values = values[..., :3]
    return filled(values, gone)


def _check_thresholdable(values: NDArray[Any]) -> None:
    """Refuse to choose a threshold for what looks like a label map."""
    found = flat_values(values)
    if found is not None:
        listed = ", ".join(map(str, found[:LISTED].tolist())) + (", ..." if len(found) > LISTED else "")
        raise ImageError(
            f"image: expected a mask or gray values, found what looks like a label map, {len(found)} flat values that meet without "
            f"a transition ({listed}); labels=True makes each value a region of its own, "
            "threshold= a number or 'otsu' takes them as gray values"
        )


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
