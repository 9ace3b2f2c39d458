"""The regions in a window of an image, as they are in the whole: read from its source, or cut out of the label map in memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.raster.labels.segmentation import Segmentation
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
    return segmentation(source.read(rows, columns), plan)


def segmentation(values: NDArray[Any], plan: Plan) -> Segmentation:
    """Find the regions of pixels."""
    o = plan.options
    if o["labels"]:
        numbers = values.astype(np.int64) if values.dtype == np.uint64 else values
        if o["labels"] is not True:
            numbers = np.where(np.isin(numbers, o["labels"]), numbers, numbers.dtype.type(o["background"] or 0))
        return Segmentation(numbers, o["background"])
    mask = values if plan.level is None else values > plan.level
    return Segmentation(~mask if o["invert"] else mask, 0, None, values if plan.gray else None, plan.place)
