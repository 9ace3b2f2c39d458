"""What was decided while reading -> sentences for the report, so that nothing is taken for something else in silence."""

from __future__ import annotations

from img2tri.raster.labels.segmentation import Segmentation
from img2tri.types import Picture


def decisions(picture: Picture, found: Segmentation) -> list[str]:
    """Return one sentence for each thing that was decided about an image and might have been meant otherwise.

    Examples
    --------
    >>> import numpy as np
    >>> from img2tri.raster.labels.segmentation import segment
    >>> from img2tri.raster.reading import read
    >>> picture = read(np.array([[np.nan, 1, 2]]))
    >>> decisions(picture, segment(picture, labels=True))
    ['1 pixels are not there (no data, NaN or masked): they are not meshed, and no edge beside them is placed by their values']
    """
    notes = picture.notes
    told = []
    if picture.missing is not None and picture.missing.any():
        told.append(
            f"{picture.missing.sum():,} pixels are not there (no data, NaN or masked): they are not meshed, "
            "and no edge beside them is placed by their values"
        )
    if notes.get("pages", 1) > 1:
        told.append(f"page {notes['page']} of {notes['pages']} was taken, counted from 0")
    if "orientation" in notes:
        told.append(f"turned upright by its EXIF orientation, {notes['orientation']}")
    if notes.get("min_is_white"):
        told.append("the file stores white as the least value (MinIsWhite): labels are the values as stored, gray values are turned round")
    if "spacing" in notes:
        dx, dy = picture.frame.spacing
        unit = f" {notes['units']}" if "units" in notes else ", in a unit it does not name"
        told.append(f"pixels are {dx:g} x {dy:g}{unit}, as the {notes['spacing']} says")
    return [*told, *found.notes]
