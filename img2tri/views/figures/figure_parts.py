"""The parts of a figure: a page with a place for the mesh and one for its quality, and what is drawn in either.

Places are in inches, so that nothing overlaps whatever the shape of the image. Lines get thinner as triangles get smaller, down to none
where they would only darken the picture.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints, unique_edges
from img2tri.errors import ParameterError
from img2tri.types import Frame
from img2tri.views.figures.region_colours import Colours, region_colours
from img2tri.views.objects.region_borders import bordering

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK = "#2b2b2b"
_QUIET, _FAINT, _RED, _PLAIN = "#6f6f6f", "#c8c8c8", "#e3120b", "#9aa7b4"
_COLOURS = "viridis"  # its lightness goes with the value, for all eyes and in gray

# In inches: the largest place for the mesh; the least that leaves room for histogram and title; what is around.
_WIDEST, _HIGHEST, _LEAST_HEIGHT, _LEAST_WIDTH, _LEAST_ALONE = 7.2, 6.4, 3.0, 1.6, 4.4
_LEFT, _BOTTOM, _TOP, _RIGHT, _GAP, _STRIP, _SIDE = 0.6, 0.5, 0.8, 0.3, 0.35, 0.14, 1.6

_LARGE = 20_000  # triangles from which on SVG and PDF hold pixels instead, as lines would take 10 MB and more
LEGEND = 12  # regions a legend can name
_ROOM = 2.5  # points an edge must be long to be drawn between coloured triangles
_PIXELS = 2048  # of the image along either side; the page has no more


@dataclass(frozen=True, eq=False)
class Page:
    """A figure and where in it to draw.

    Attributes
    ----------
    figure
        The whole.
    main
        The axes of the mesh, in world units.
    side
        (left, bottom) of what is beside it, in inches.
    height
        Inches there are above `side`.
    scale
        Points, 1/72 inch, per world unit.
    """

    figure: Figure
    main: Axes
    side: tuple[float, float]
    height: float
    scale: float


def make_page(vertices: Floats, frame: Frame | None, *, title: str, strip: bool, column: bool) -> Page:
    """Make a page, empty but for its title, for what `frame` holds, or for the vertices and a little around them.

    `strip` and `column` say what there must be room for beside it: a scale of colours, and a histogram or a legend.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    least, most = vertices.min(axis=0), vertices.max(axis=0)
    margin = 0.02 * (most - least).max()
    left, bottom, right, top = frame.bounds if frame else (*(least - margin), *(most + margin))
    scale = min(_WIDEST / (right - left), _HIGHEST / (top - bottom))
    width = max(scale * (right - left), _LEAST_WIDTH if column else _LEAST_ALONE)
    height = max(scale * (top - bottom), _LEAST_HEIGHT if strip or column else 0.5)
    beside = (2 * _GAP + _STRIP) * (strip or column) + _SIDE * column
    above = _TOP if strip or column else 0.5
    figure = _shown_figure()(figsize=(_LEFT + width + beside + _RIGHT, _BOTTOM + height + above))
    FigureCanvasAgg(figure)
    w, h = figure.get_size_inches()
    figure.suptitle(title, x=_LEFT / w, y=1 - 0.16 / h, ha="left", va="top", fontsize=10.5, color=_INK)
    main = _axes(figure, _LEFT, _BOTTOM, width, height)
    main.set(xlim=(left, right), ylim=(bottom, top) if frame is None or frame.upward else (top, bottom), aspect="equal", anchor="NW")
    main.locator_params(axis="x", nbins=int(np.clip(scale * (right - left), 2, 6)))
    main.locator_params(axis="y", nbins=int(np.clip(scale * (top - bottom), 2, 6)))
    return Page(figure, main, (_LEFT + width + _GAP, _BOTTOM), height, 72 * scale)


@cache
def _shown_figure() -> type[Figure]:
    """Return a figure that a notebook shows, whether pyplot was imported or not; matplotlib is loaded when the first is drawn."""
    from matplotlib.figure import Figure

    class ShownFigure(Figure):
        """A `Figure` with its picture for notebooks, which would write its name otherwise."""

        def _repr_png_(self) -> bytes:
            file = io.BytesIO()
            self.savefig(file, format="png", dpi=100)
            return file.getvalue()

    return ShownFigure


def page_in(ax: Axes, vertices: Floats, frame: Frame | None, *, title: str | None) -> Page:
    """Make a page of axes that are there, without a place beside them."""
    figure = ax.get_figure(root=True)
    if figure is None:
        raise ParameterError("ax: expected axes of a figure, found some that were removed from theirs")
    least, most = vertices.min(axis=0), vertices.max(axis=0)
    left, bottom, right, top = frame.bounds if frame else (*least, *most)
    ax.set(xlim=(left, right), ylim=(bottom, top) if frame is None or frame.upward else (top, bottom), aspect="equal")
    if title is not None:
        ax.set_title(title)
    box = ax.get_position()
    w, h = figure.get_size_inches()
    return Page(figure, ax, (0.0, 0.0), h * box.height, 72 * min(w * box.width / (right - left), h * box.height / (top - bottom)))


def draw_unit(page: Page, unit: str) -> None:
    """Write the unit of the world beside the axes."""
    if unit:
        page.main.set_xlabel(unit, fontsize=8, color=_QUIET, loc="right", labelpad=1)


def as_picture(image: ArrayLike) -> NDArray[Any]:
    """Return an image as an array of numbers, (h, w) or (h, w, 3 or 4), or say that it is none."""
    picture = np.asarray(image)
    colours = picture.ndim == 3 and picture.shape[2] in (3, 4)
    if not (picture.ndim == 2 or colours) or not picture.size or picture.dtype.kind not in "biuf":
        raise ParameterError(f"image: expected shape (h, w), (h, w, 3) or (h, w, 4), found {picture.shape} of {picture.dtype}")
    return picture


def draw_image(page: Page, picture: NDArray[Any], frame: Frame, *, faint: bool) -> None:
    """Draw an image where it lies: gray from its least to its greatest value, or in its own colours; `faint` behind coloured triangles."""
    step = -(-max(picture.shape[:2]) // _PIXELS)
    shown = picture[::step, ::step]
    if shown.ndim == 3:
        white = np.iinfo(shown.dtype).max if shown.dtype.kind in "iu" else 1
        shown = np.nan_to_num(shown / white).clip(0, 1)
        limits: tuple[float, float] = (0, 1)
    else:
        finite = shown[np.isfinite(shown)] if shown.dtype.kind == "f" else shown
        limits = (0, 1) if shown.dtype == bool or not finite.size else (float(finite.min()), float(finite.max()))
    # Each pixel kept stands for step x step, also where the last ones reach beyond the image.
    corners = frame.xy([0, step * shown.shape[0]], [0, step * shown.shape[1]])
    extent = (*corners[:, 0], *corners[::-1, 1])
    view = page.main.get_xlim(), page.main.get_ylim()
    least, most = limits
    alpha = 0.3 if faint else 1
    page.main.imshow(shown, cmap="gray", vmin=least, vmax=most, extent=extent, origin="upper", interpolation="nearest", alpha=alpha)
    page.main.set(xlim=view[0], ylim=view[1])


def draw_mesh(
    page: Page, vertices: Floats, triangles: Ints, *, labels: NDArray[Any], quality: Floats, colour_by: str | None, colours: Colours
) -> None:
    """Draw the triangles filled, with their edges where there is room, and their borders; or, by None, red edges alone."""
    from matplotlib.collections import LineCollection, PolyCollection

    edges, sides = unique_edges(triangles)
    borders = bordering(sides, labels)
    lines: Any = vertices[edges]
    corners: Any = vertices[triangles]
    # Each edge as wide as its own length allows, so that a graded mesh stays light where it is fine.
    lengths = page.scale * np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    large = len(triangles) > _LARGE
    if colour_by is None:
        drawn: list[Any] = [LineCollection(lines, colors=_RED, linewidths=np.clip(0.07 * lengths, 0.12, 0.7), rasterized=large)]
    else:
        if colour_by == "quality":
            colour: dict[str, Any] = {"array": quality, "cmap": _COLOURS, "clim": (0, 1)}
        else:
            present, index = np.unique(labels, return_inverse=True)
            colour = {"facecolors": np.array(region_colours(present.tolist(), colours))[index] / 255}
        # Edges in the colour of the face close the hair lines that smoothing would leave between faces.
        drawn = [PolyCollection(corners, edgecolors="face", linewidths=0.3, rasterized=large, **colour)]
        shown = ~borders & (lengths > _ROOM)
        widths = np.clip(0.04 * lengths[shown], 0.1, 0.5)
        drawn.append(LineCollection(lines[shown], colors=_INK, alpha=0.5, linewidths=widths, rasterized=large))
        width = np.clip(0.08 * lengths.mean(), 0.4, 0.9)
        drawn.append(LineCollection(lines[borders], colors=_INK, linewidths=width, capstyle="round", rasterized=large))
    for collection in drawn:
        page.main.add_collection(collection, autolim=False)


def draw_colours(page: Page, label: str) -> None:
    """Draw the scale of the colours, 0..1, at the left of the side."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    strip = _axes(page.figure, *page.side, _STRIP, page.height)
    bar = page.figure.colorbar(ScalarMappable(Normalize(0, 1), _COLOURS), cax=strip)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, colors=_QUIET, length=0)
    bar.ax.set_title(label, fontsize=9, color=_QUIET, loc="left", pad=5)


def draw_histogram(page: Page, values: Floats, *, coloured: bool, foot: float) -> None:
    """Draw how many of the values are how large: qualities 0..1 beside the scale of their colours, or angles in degrees.

    `foot` is how many inches are taken below.
    """
    import matplotlib as mpl

    left, bottom = page.side
    axes = _axes(page.figure, left + _STRIP + _GAP, bottom + foot, _SIDE, page.height - foot)
    most = 1 if coloured else 60
    counts, limits = np.histogram(values, bins=60, range=(0, most))
    middles = (limits[1:] + limits[:-1]) / 2
    colours = mpl.colormaps[_COLOURS](middles) if coloured else _PLAIN
    axes.barh(middles, 100 * counts / len(values), height=most / 60, color=colours, linewidth=0)
    axes.axhline(float(values.min()), color=_RED, linewidth=0.8)
    axes.set(ylim=(0, most), xlim=(0, None))
    axes.locator_params(axis="x", nbins=3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel("% of triangles", fontsize=8, color=_QUIET)
    if coloured:
        axes.tick_params(labelleft=False)
    else:
        axes.set_ylabel("smallest angle, degrees", fontsize=8, color=_QUIET)
    mean, worst = (f"{value:.3f}" if coloured else f"{value:.1f}°" for value in (values.mean(), values.min()))
    axes.set_title(f"mean {mean}\nworst {worst}", loc="left", fontsize=8, color=_QUIET, pad=5)


def draw_names(page: Page, vertices: Floats, triangles: Ints, labels: NDArray[Any], names: Mapping[int, str]) -> None:
    """Write the names of the largest regions where these lie: in their triangle that is nearest to their middle."""
    from matplotlib.patheffects import withStroke

    corners = vertices[triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas, middles = abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2, corners.mean(axis=1)
    present, index = np.unique(labels, return_inverse=True)
    totals = np.bincount(index, areas)
    centres = np.stack([np.bincount(index, areas * middles[:, k]) for k in (0, 1)], axis=1) / np.maximum(totals, 1e-300)[:, None]
    away = np.hypot(*(middles - centres[index]).T)
    nearest = np.lexsort([away, index])[np.searchsorted(np.sort(index), np.arange(len(present)))]
    for i in np.argsort(-totals, kind="stable")[:LEGEND]:
        x, y = middles[nearest[i]]
        outline = [withStroke(linewidth=2, foreground="white")]
        page.main.text(x, y, names[int(present[i])], ha="center", va="center", fontsize=7.5, color=_INK, path_effects=outline, clip_on=True)


def draw_legend(page: Page, names: Mapping[int, str], colours: Colours, *, inside: bool = False) -> float:
    """Name the colours of the regions at the foot of the side, or `inside` the axes; return the inches this takes."""
    from matplotlib.patches import Patch

    shown = np.array(region_colours(list(names), colours)) / 255
    patches = [Patch(color=colour, label=name) for name, colour in zip(names.values(), shown, strict=True)]
    style: dict[str, Any] = {"handles": patches, "fontsize": 8, "labelcolor": _QUIET, "handlelength": 1, "handleheight": 1}
    if inside:
        page.main.legend(**style)
        return 0.0
    columns = max(1, min(3, 27 // (4 + max(map(len, names.values())))))  # as many as fit beside each other
    left, bottom = page.side
    w, h = page.figure.get_size_inches()
    legend = page.figure.legend(
        **style,
        ncols=columns,
        loc="lower left",
        bbox_to_anchor=((left + _STRIP + _GAP) / w, bottom / h),
        frameon=False,
        handletextpad=0.4,
        columnspacing=1,
        borderpad=0,
        borderaxespad=0,
        title="region",
        title_fontsize=8,
        alignment="left",
    )
    legend.get_title().set_color(_QUIET)
    return 0.65 + 0.2 * -(-len(names) // columns)


def _axes(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    w, h = figure.get_size_inches()
    made = figure.add_axes((left / w, bottom / h, width / w, height / h))
    made.tick_params(labelsize=8, colors=_QUIET, length=3, width=0.6)
    for spine in made.spines.values():
        spine.set(color=_FAINT, linewidth=0.6)
    return made
