"""An overview of a mesh that is too large to be drawn edge by edge: a picture of its regions, and one of its worst angles.

Both have one pixel for some triangles, and are made of parts; see `img2tri.tiles.parts.overview_cells`.
"""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.types import Frame
from img2tri.views.figures.region_colours import region_colours
from img2tri.views.formats.atomic_write import store, writable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURE_SUFFIXES = (".pdf", ".png", ".svg")
WORST, BEST = 25.0, 60.0  # degrees, the scale of colours


def draw_overview(labels: Ints, angles: Floats, frame: Frame, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw an overview.

    Parameters
    ----------
    labels
        (h, w) int64, the label with the largest area in each cell.
    angles
        (h, w) float64, the smallest angle in each cell, degrees; NaN where there is no triangle.
    frame
        Where the image lies.
    path
        Where to write the figure, .png, .svg or .pdf; None: nowhere.
    """
    from matplotlib.figure import Figure

    target = None if path is None else writable(path, PICTURE_SUFFIXES)
    x0, y0, x1, y1 = frame.bounds
    # The first row is at the top.
    place: dict[str, Any] = {"extent": (x0, x1, y0, y1) if frame.upward else (x0, x1, y1, y0), "interpolation": "nearest"}
    figure = Figure(figsize=(12, 6), layout="constrained")
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    left.imshow(_coloured(labels, np.isfinite(angles)), **place)
    left.set_title("regions")
    shown = right.imshow(angles, vmin=WORST, vmax=BEST, cmap="viridis", **place)
    right.set_title(f"smallest angle, {np.nanmin(angles):.1f} degrees at least")
    figure.colorbar(shown, ax=right, shrink=0.8)
    if target is not None:
        buffer = io.BytesIO()
        figure.savefig(buffer, format=target.suffix[1:].lower(), dpi=150)
        store(target, buffer.getvalue())
    return figure


def _coloured(labels: Ints, there: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return the colours (h, w, 3) of labels; white where there is no mesh."""
    seen, which = np.unique(labels[there], return_inverse=True)
    result = np.full((*labels.shape, 3), 255, np.uint8)
    result[there] = np.asarray(region_colours(seen.tolist()), np.uint8)[which]
    return result
