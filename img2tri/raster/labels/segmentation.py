"""Picture -> segmentation: the label map to be meshed, and the gray values that place its outlines, if they say more than the labels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Ints, neighbour_changes
from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.absorbed_labels import absorb_labels, thin_separators
from img2tri.raster.labels.colour_quantization import label_by_colours
from img2tri.raster.labels.colours_to_gray import alpha_is_the_picture, to_gray
from img2tri.raster.labels.label_map_detection import flat_values
from img2tri.raster.labels.otsu_threshold import Level, binarize, two_valued
from img2tri.raster.labels.rgb_to_labels import LabelMap, label_map
from img2tri.raster.labels.specks_and_holes import Removed, clean
from img2tri.raster.labels.transparency import alpha_channel, half_opaque, says_what_is_there, transparent, without_hidden
from img2tri.raster.metadata.nodata import either
from img2tri.types import ColourMix, Picture

LISTED_VALUES = 10  # values in a message
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
        (h, w) gray values, or the colours of which pixels are mixes; None where they say no more than the labels: masks, images of
        two values, label maps.
    level
        The gray value of the outlines; one for each step from label to label, if there are several; None is the middle between the
        two sides, wherever that is.
    notes
        What was decided, in sentences for the report.
    counted
        How many pixels are "missing", and how many were "absorbed".
    """

    labels: NDArray[Any]
    background: int | None
    threshold: Level | None = None
    gray: NDArray[Any] | ColourMix | None = None
    level: float | tuple[float, ...] | None = None
    notes: tuple[str, ...] = ()
    counted: dict[str, int] = field(default_factory=dict)

    @cached_property
    def changes(self) -> tuple[Ints, Ints]:
        """Where labels change, see `neighbour_changes`: one look at all pixels, for all that follows their boundaries."""
        return neighbour_changes(self.labels)


def segment(
    picture: Picture,
    *,
    threshold: float | str | Sequence[float] | None = None,
    labels: bool | Iterable[int] | None = None,
    background: int | None = 0,
    colors: int | Sequence[Any] | None = None,
    absorb: int | Iterable[int] | None = None,
    invert: bool = False,
) -> Segmentation:
    """Find the foreground, label 1, or the regions of a label map. Pixels that are not there, or transparent, are in none.

    Parameters
    ----------
    picture
        From `read`.
    threshold, invert
        As for `binarize`; of the foreground only. Rising levels: the values between two are a region. "alpha" is the silhouette:
        what is opaque is foreground; None is that too where some pixels are fully transparent.
    labels, background
        As for `label_map`; `labels` None or False parts foreground from background.

    colors
        As for `label_by_colours`; None: no flat colours are looked for.
    absorb
        Labels whose pixels are given to their nearest neighbours first, see `absorb_labels`; the image is a label map then.

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
    clear = says_what_is_there(alpha)
    if colors is not None:
        _left_out("colors", labels=labels or None, absorb=absorb, threshold=threshold, invert=invert or None)
        found = _by_colours(picture, gone, colors, None if clear and background == 0 else background, clear=clear)
    elif labels or absorb is not None:
        _left_out("labels", threshold=threshold, invert=invert or None)
        found = _by_labels(picture, gone, labels or True, background, absorb, clear=clear)
    elif isinstance(threshold, Sequence) and not isinstance(threshold, str):
        _left_out("several thresholds", invert=invert or None)
        found = _by_levels(picture, gone, threshold, background)
    elif threshold == "alpha" or (threshold is None and clear):
        found = _silhouette(alpha, picture.missing, invert=invert)
    else:
        if threshold is None:
            check_thresholdable(without_hidden(picture.values, gone))
        found = _foreground(picture, gone, threshold=threshold, invert=invert)
    lines = thin_separators(found.labels) if labels and absorb is None else []
    if lines:
        hint = f"label {lines[0]} is thin lines between others; absorb={lines[0]} would give them to their neighbours"
        found = replace(found, notes=(*found.notes, hint))
    missing = 0 if picture.missing is None else int(np.count_nonzero(picture.missing))
    return replace(found, counted={"missing": missing} | found.counted)


def _by_labels(
    picture: Picture,
    gone: Bools | None,
    labels: bool | Iterable[int],
    background: int | None,
    absorb: int | Iterable[int] | None,
    *,
    clear: bool,
) -> Segmentation:
    """Make each label a region, after some gave their pixels to their neighbours."""
    values, notes, counted = _opaque(picture, gone), (TRANSPARENT,) * clear, {}
    if absorb is not None:
        given = [absorb] if isinstance(absorb, int) else [*absorb]
        values = label_map(values, background=None).values
        values, counted["absorbed"] = absorb_labels(values, given, spacing=picture.frame.spacing, missing=gone)
        notes = (*notes, f"{counted['absorbed']:,} pixels of {', '.join(map(str, given))} were given to their nearest neighbours")
    numbers = label_map(values, labels=labels, background=background, missing=gone, transparent=clear)
    return Segmentation(numbers.values, numbers.background, notes=notes, counted=counted)


def _left_out(given: str, **others: Any) -> None:
    for name, value in others.items():
        if value is not None:
            raise ParameterError(f"{name}: expected to be left out with {given}, whose values are regions as they are, found {value!r}")


def _by_colours(
    picture: Picture, gone: Bools | None, colors: int | Sequence[float], background: int | None, *, clear: bool
) -> Segmentation:
    """Make each of a few colours a region; edges run where mixes of two of them say."""
    palette, values = picture.notes.get("palette"), picture.values
    values = without_hidden(values if palette is None else palette[values], gone)
    numbers, mix = label_by_colours(values, colors, background=background, missing=gone)
    listed = _listed(mix.labels, colours=mix.values.shape[2] == 3 and mix.values.dtype == np.uint8)
    notes = (f"each pixel was given one of {len(mix.labels)} colours: {listed}", *(TRANSPARENT,) * clear)
    return Segmentation(numbers.values, numbers.background, gray=None if _is_hard(mix, numbers.values) else mix, notes=notes)


def _is_hard(mix: ColourMix, labels: NDArray[Any]) -> bool:
    """Tell whether every pixel that is there is exactly of its colour: then the labels say all."""
    place = np.minimum(np.searchsorted(mix.labels, labels), len(mix.labels) - 1)
    exact = (mix.colours[place] == mix.values).all(axis=2)
    return bool((exact if mix.missing is None else exact | mix.missing).all())


def _by_levels(picture: Picture, gone: Bools | None, levels: Sequence[float], background: int | None) -> Segmentation:
    """Make the gray values between two levels a region: label 0 up to the first, 1 up to the second, and so on."""
    gray = _gray(picture, gone)
    numbers = label_map(np.searchsorted(levels, gray).astype(np.int32), background=background, missing=gone)
    at = tuple(math.floor(level) + 0.5 if gray.dtype.kind in "iu" else level for level in levels)
    return Segmentation(numbers.values, numbers.background, Level(tuple(levels), "given"), with_gaps(gray, gone), at)


def _gray(picture: Picture, gone: Bools | None) -> NDArray[Any]:
    return to_gray(_opaque(picture, gone), palette=picture.notes.get("palette"), min_is_white="min_is_white" in picture.notes)


def with_gaps(gray: NDArray[Any], gone: Bools | None) -> NDArray[Any]:
    """Return gray values with NaN where no pixel is."""
    return gray if gone is None else np.where(gone, np.nan, gray)


def _foreground(picture: Picture, gone: Bools | None, *, threshold: float | str | None, invert: bool) -> Segmentation:
    """Part an image by its gray values; those of pixels that are not there neither choose the level nor place an edge."""
    gray = _gray(picture, gone)
    seen = gray if gone is None else gray[~gone][None]
    white, chosen = binarize(seen, threshold=threshold, invert=invert)
    mask = white
    if gone is not None:
        mask = np.zeros(gray.shape, bool)
        mask[~gone] = white[0]
    if two_valued(seen) or chosen.how not in ("given", "otsu"):
        return Segmentation(mask, 0, chosen)
    if chosen.how == "otsu":
        return Segmentation(mask, 0, chosen, with_gaps(gray, gone))
    # Strictly greater is foreground: of whole numbers the level lies between two.
    at = math.floor(chosen.value) + 0.5 if gray.dtype.kind in "iu" else chosen.value
    return Segmentation(mask, 0, chosen, with_gaps(gray, gone), at)


def _silhouette(alpha: NDArray[Any] | None, missing: Bools | None, *, invert: bool) -> Segmentation:
    """Take what is opaque as foreground."""
    if alpha is None:
        raise ParameterError("threshold: 'alpha' expected an image with an alpha channel, found none; give a number or 'otsu'")
    chosen = Level(half_opaque(alpha), "alpha")
    mask = (alpha >= chosen.value) != invert
    if missing is not None:
        mask &= ~missing
    gray = with_gaps(alpha, missing)
    notes = (SILHOUETTE,) * (not invert)
    return Segmentation(mask, 0, chosen, notes=notes) if two_valued(alpha) else Segmentation(mask, 0, chosen, gray, chosen.value, notes)


def _opaque(picture: Picture, gone: Bools | None) -> NDArray[Any]:
    """Return the values of a picture without the alpha that said which pixels are there, nor the values of those that are not."""
    values = picture.values
    if says_what_is_there(alpha_channel(picture)) and values.ndim == 3 and not alpha_is_the_picture(values):
        values = values[..., :3]
    return without_hidden(values, gone)


def _listed(values: NDArray[Any], *, colours: bool) -> str:
    """List values in a message, colours as #rrggbb."""
    first = [f"#{value:06x}" if colours else f"{value}" for value in values[:LISTED_VALUES].tolist()]
    return ", ".join([*first, *["..."] * (len(values) > LISTED_VALUES)])


def check_thresholdable(values: NDArray[Any]) -> None:
    """Refuse to choose a threshold for what looks like a label map."""
    found = flat_values(values)
    if found is not None:
        listed = _listed(found, colours=values.ndim == 3 and values.dtype == np.uint8 and found.max() > np.iinfo(np.uint8).max)
        raise ImageError(
            f"image: expected a mask or gray values, found what looks like a label map, {len(found)} flat values that meet without "
            f"a transition ({listed}); labels=True makes each value a region of its own, "
            "threshold= a number or 'otsu' takes them as gray values"
        )


def without_specks(
    found: Segmentation, *, min_area: float | None, fill_holes: float | None = None, largest: bool, connectivity: int
) -> tuple[Segmentation, Removed]:
    """Remove specks and small holes, or all but the largest components, as `clean` does; areas in pixels.

    Examples
    --------
    >>> found, removed = without_specks(Segmentation(np.eye(3, dtype=bool), 0), min_area=2, largest=False, connectivity=4)
    >>> found.labels.any(), removed["specks"]
    (np.False_, 3)
    """
    labels, removed = clean(
        LabelMap(found.labels, found.background), min_area=min_area, fill_holes=fill_holes, largest=largest, connectivity=connectivity
    )
    return replace(found, labels=labels.values, background=labels.background), removed
