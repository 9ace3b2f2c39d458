"""Figures: a plane mesh, its image and its quality -> a `matplotlib` Figure, and if wanted a PNG, SVG or PDF file.

Drawn by matplotlib's Agg renderer, which needs neither a display nor GL, on a Figure of its own: pyplot, with its global state, is not
touched. On the left the mesh, alone or over its image; on the right, on one scale with the colours, how many triangles have which quality.
"""

from __future__ import annotations

import io
import os
import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats, Ints
from img2tri.errors import choice
from img2tri.triangle_angles import triangle_angles
from img2tri.types import Frame
from img2tri.views.figures import figure_parts as parts
from img2tri.views.figures.region_colours import Colours
from img2tri.views.formats.atomic_write import known_suffix, store, writable
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".pdf", ".png", ".svg")

_SAVING = threading.Lock()


def draw(
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    regions: ArrayLike | None = None,
    values: ArrayLike | None = None,
    label: str = "q",
    colour_by: str | None = None,
    frame: Frame | None = None,
    image: ArrayLike | None = None,
    histogram: bool = True,
    title: str | None = None,
    names: Mapping[int, str] | None = None,
    colours: Colours | None = None,
    unit: str = "",
    ax: Axes | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw a plane mesh, over its image if there is one, with a histogram of its quality beside it.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 in world units, and (m, 3) int64.
    regions
        (m,) int64; None is one region. Needed to colour by region; interfaces are drawn stronger where triangles are coloured.
    values
        (m,) float64 in 0..1, a quality of each triangle. None computes q = 2 r / R, which is 1 for an equilateral triangle.
    label
        What `values` are called.
    colour_by
        None draws thin red edges, as the figures of the paper do; "quality" fills each triangle by its value, on the fixed scale 0..1;
        "region" fills it in the colour of its region.
    frame
        Where the image lies, and what part of the world is shown. None takes that of an image with pixels of size 1, or shows the mesh.
    image
        (h, w), (h, w, 3) or (h, w, 4), drawn below the mesh: gray from its least to its greatest value, or in its own colours.
    histogram
        Whether to draw the histogram: of `values` when they colour the mesh, else of the smallest angle of each triangle.
    title
        None states counts and worst angle.
    names, unit
        Label -> name of the region, for the legend; of the world, such as "mm", for the axes. With more than 12 regions the largest are
        named where they lie.
    colours
        Label -> (red, green, blue) of the region, such as those of the image; the others get colours of their own.
    ax
        Axes of a figure of yours to draw in, without histogram; the figure is returned. None makes one.
    path
        Where to save the figure: .png, .svg or .pdf. The same input gives the same bytes.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    MeshError
        If the arrays are not a mesh, or `values` or `regions` do not go with it.
    ParameterError
        If `colour_by` is none of the above, or `image` is no image.
    FileError
        If `path` cannot be written.

    Examples
    --------
    >>> figure = draw([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], colour_by="quality")
    >>> figure.get_suptitle()
    '4 vertices · 2 triangles · smallest angle 45.0°'
    """
    target = None if path is None else writable(path, SUFFIXES)
    v, t = plane_mesh(vertices, triangles)
    if colour_by is not None:
        choice("colour_by", colour_by, ["quality", "region"])
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    angles = triangle_angles(v, t)
    # r / R = 4 sin(A/2) sin(B/2) sin(C/2) in every triangle.
    quality = 8 * np.sin(angles / 2).prod(axis=1) if values is None else per_triangle("values", values, len(t))
    quality = np.nan_to_num(quality.astype(np.float64)).clip(0, 1)
    picture = None if image is None else parts.as_picture(image)
    if frame is None and picture is not None:
        frame = Frame((picture.shape[0], picture.shape[1]))

    filled = colour_by == "quality"
    named = colour_by == "region" and len(np.unique(labels)) <= parts.LEGEND
    words = _title(v, t, angles) if title is None else title
    if ax is not None:
        page, histogram = parts.page_in(ax, v, frame, title=title), False
    else:
        page = parts.make_page(v, frame, title=words, strip=filled, column=histogram or named)
    parts.draw_unit(page, unit)
    if picture is not None and frame is not None:
        parts.draw_image(page, picture, frame, faint=colour_by is not None)
    parts.draw_mesh(page, v, t, labels=labels, quality=quality, colour_by=colour_by, colours=colours or {})
    called = {label: (names or {}).get(label, str(label)) for label in np.unique(labels).tolist()}
    foot = parts.draw_legend(page, called, colours or {}, inside=ax is not None) if named else 0.0
    if colour_by == "region" and not named:
        parts.draw_names(page, v, t, labels, called)
    if filled and ax is None:
        parts.draw_colours(page, label)
    if histogram:
        parts.draw_histogram(page, quality if filled else np.rad2deg(angles.min(axis=1)), coloured=filled, foot=foot)
    if target is not None:
        store(target, _rendered(page.figure, known_suffix(target, SUFFIXES)))
    return page.figure


def _title(vertices: Floats, triangles: Ints, angles: Floats) -> str:
    p, q, r = (vertices[triangles[:, i]] for i in range(3))
    turned = int(np.sum((q - p)[:, 0] * (r - p)[:, 1] < (q - p)[:, 1] * (r - p)[:, 0]))
    words = [f"{len(vertices):,} vertices", f"{len(triangles):,} triangles", f"smallest angle {np.rad2deg(angles.min()):.1f}°"]
    return " · ".join(words + [f"{turned:,} turned over"] * (turned > 0))


def _rendered(figure: Figure, suffix: str) -> bytes:
    """Return the bytes of the figure as a file: no date in it, and no names drawn at random."""
    import matplotlib as mpl

    dates: dict[str, dict[str, str | None]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    file = io.BytesIO()
    # The salt of SVG names is a global setting of matplotlib: set for as long as the saving takes, by one thread at a time.
    with _SAVING, mpl.rc_context({"svg.hashsalt": "img2tri"}):
        figure.savefig(file, format=suffix[1:], dpi=200, metadata=dates.get(suffix))
    return file.getvalue()
