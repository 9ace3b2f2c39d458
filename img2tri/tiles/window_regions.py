"""The regions in a window of an image, as they are in the whole: read from its source, or cut out of the label map in memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.segmentation import Segmentation, with_gaps
from img2tri.tiles.block_plan import Plan
from img2tri.tiles.pixel_source import PixelSource
from img2tri.types import ColourMix

WindowRegions = Callable[[slice, slice], Segmentation]
"""Function of rows and columns that returns the regions there."""


def cut_out(zones: Segmentation, rows: slice, columns: slice) -> Segmentation:
    """Cut a window out of the regions of a whole image.

    Examples
    --------
    >>> cut_out(Segmentation(np.eye(3, dtype=bool), 0), slice(1, 3), slice(2, 3)).labels.tolist()
    [[False], [True]]
    """
    gray = zones.gray
    if isinstance(gray, ColourMix):
        gray = replace(gray, values=gray.values[rows, columns], missing=None if gray.missing is None else gray.missing[rows, columns])
    elif gray is not None:
        gray = gray[rows, columns]
    return Segmentation(zones.labels[rows, columns], zones.background, zones.threshold, gray, zones.level)


def read_regions(source: PixelSource, plan: Plan, rows: slice, columns: slice) -> Segmentation:
    """Read a window, and find the regions in it by what was decided for the whole image."""
    zones = segmentation(*source.read(rows, columns), plan)
    return zones if plan.cleaned is None else replace(zones, labels=plan.cleaned.over(zones.labels, rows, columns))


def segmentation(values: NDArray[Any], missing: Bools | None, plan: Plan) -> Segmentation:
    """Find the regions of pixels, those being in none that are not there."""
    o = plan.options
    if o["labels"]:
        numbers, background = rgb_to_labels(values, hues=plan.hues), o["background"]
        meshed = np.ones((1, 1), bool) if o["labels"] is True else np.isin(numbers, o["labels"])
        meshed = meshed if missing is None else meshed & ~missing
        if not meshed.all():
            dtype = np.result_type(numbers.dtype, np.min_scalar_type(background))
            numbers = np.where(meshed, numbers, np.asarray(background, dtype))
        return Segmentation(numbers, background)
    gray = values if values.ndim == 2 else to_gray(values)
    mask = gray if plan.level is None else gray > plan.level
    mask = ~mask if o["invert"] else mask
    if missing is not None:
        mask = mask & ~missing
    if plan.gaps:
        gray = with_gaps(gray, np.zeros(gray.shape, bool) if missing is None else missing)
    return Segmentation(mask, 0, None, gray if plan.gray else None, plan.place)


def rgb_to_labels(values: NDArray[Any], *, hues: bool) -> NDArray[Any]:
    """Return the labels of pixels; `hues`: as numbers 0xRRGGBB, as the image has other colours than gray ones."""
    if values.ndim == 3 and hues:
        red, green, blue = (values[..., channel].astype(np.int64) for channel in range(3))
        bits = 8 * values.dtype.itemsize
        return np.asarray(red << 2 * bits | green << bits | blue)
    one = values if values.ndim == 2 else values[..., 0]
    return one.astype(np.int64) if one.dtype.kind == "f" or one.dtype == np.uint64 else one.view(np.uint8) if one.dtype == bool else one
