"""A mesh in a notebook: vertices, triangles, regions -> a small SVG, and a piece of HTML with a line of numbers below it.

Small meshes are drawn triangle by triangle, in the colours of their regions; of larger ones only the regions, as a small picture in the
SVG, so that what is stored in the notebook stays small however large the mesh is, and however many regions it has.
"""

from __future__ import annotations

import base64

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Bools, Floats, Ints, runs, unique_edges
from img2tri.triangle_angles import triangle_angles
from img2tri.views.figures.image_png import png
from img2tri.views.figures.region_colours import Colours, as_hex, region_colours
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh
from img2tri.views.objects.region_borders import bordering

LARGEST = 3000  # triangles drawn one by one
_SIDE = 400  # px, the longer side of the drawing
_STEPS = 2  # places per px
_ROWS = 2 * _STEPS * _SIDE  # more than the grid has
_LINE = (0x5B, 0x6B, 0x7B, 255)


def svg(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    upward: bool = True,
    colours: Colours | None = None,
) -> str:
    """Draw a plane mesh, 400 px on its longer side.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64.
    regions
        (m,) int64; None is one region.
    upward
        Whether y points up; False draws it downwards, as in images.
    colours
        Label -> (red, green, blue) of the region, such as those of the image; the others get colours of their own.

    Returns
    -------
    str
        An SVG element. With more than 3000 triangles it shows the regions alone.

    Raises
    ------
    MeshError
        If the arrays are not a mesh.

    Examples
    --------
    >>> svg([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).count("<path")
    2
    """
    return _drawn(*_looked_at(vertices, triangles, regions), upward=upward, colours=colours)


def _looked_at(vertices: ArrayLike, triangles: ArrayLike, regions: ArrayLike | None) -> tuple[Floats, Ints, NDArray[np.generic]]:
    """Return vertices, triangles and labels that are a mesh, or raise what is wrong with them."""
    v, t = plane_mesh(vertices, triangles)
    return v, t, np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))


def _drawn(v: Floats, t: Ints, labels: NDArray[np.generic], *, upward: bool, colours: Colours | None) -> str:
    """Draw a mesh that was looked at, see `svg`."""
    places, (width, height) = _places(v, upward=upward)
    edges, sides = unique_edges(t)
    border = bordering(sides, labels)
    if len(t) <= LARGEST:
        line = f'<path d="{_lines(places[edges[border]])}" fill="none" stroke="#5b6b7b" stroke-width="1" stroke-linecap="round"/>'
        drawn = _triangles(places, t, labels, colours or {}) + line
    else:
        p, q, r = (v[t[:, i]] for i in range(3))
        twice = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
        turns = np.where((twice > 0) == upward, -1, 1)  # places have y down
        drawn = _regions(places, t, turns, labels, border[sides], (width, height), colours or {})
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 {width + 4} {height + 4}" width="{width + 4}" height="{height + 4}" '
        f'style="max-width:100%;height:auto" role="img" aria-label="{_numbers(v, t, labels)}">{drawn}</svg>'
    )


def html(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    upward: bool = True,
    colours: Colours | None = None,
) -> str:
    """Draw a plane mesh, as `svg` does, with its counts and worst angle below.

    Examples
    --------
    >>> html([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).rpartition(">1")[2]
    ' triangle · 3 vertices · 1 region · smallest angle 45.0°</div></div>'
    """
    v, t, labels = _looked_at(vertices, triangles, regions)
    drawing, numbers = _drawn(v, t, labels, upward=upward, colours=colours), _numbers(v, t, labels)
    style = "font:12px/1.6 system-ui,sans-serif;opacity:.75;font-variant-numeric:tabular-nums"
    return f'<div class="img2tri">{drawing}<div style="{style}">{numbers}</div></div>'


def _numbers(vertices: Floats, triangles: Ints, labels: NDArray[np.generic]) -> str:
    counts = {"triangle triangles": len(triangles), "vertex vertices": len(vertices), "region regions": len(np.unique(labels))}
    parts = [f"{count:,} {words.split()[count != 1]}" for words, count in counts.items()]
    return " · ".join([*parts, f"smallest angle {np.rad2deg(triangle_angles(vertices, triangles).min()):.1f}°"])


def _places(vertices: Floats, *, upward: bool) -> tuple[Ints, tuple[int, int]]:
    """Put the vertices on a grid of half a pixel, y down; return them (n, 2) and the size of the drawing in px."""
    least, extent = vertices.min(axis=0), np.ptp(vertices, axis=0)
    x, y = ((vertices - least) * (_SIDE / (extent.max() or 1.0))).T
    places = np.round(_STEPS * np.stack([x, y.max() - y if upward else y], axis=1)).astype(np.int64)
    width, height = (-(-places.max(axis=0) // _STEPS)).tolist()
    return places, (width, height)


def _triangles(places: Ints, triangles: Ints, labels: NDArray[np.generic], colours: Colours) -> str:
    """Draw all triangles of a region as one path, their sides in a lighter tone."""
    values, index = np.unique(labels, return_inverse=True)
    paths = []
    for i, colour in enumerate(as_hex(region_colours(values.tolist(), colours))):
        corners = places[triangles[index == i]]
        moves = "".join(f"M{_at(*a)}L{_at(*b)}L{_at(*c)}Z" for a, b, c in corners.tolist())
        paths.append(f'<path d="{moves}" fill="{colour}" stroke="#fff" stroke-opacity=".6" stroke-width=".5"/>')
    return "".join(paths)


def _regions(
    places: Ints, triangles: Ints, turns: Ints, labels: NDArray[np.generic], borders: Bools, size: tuple[int, int], colours: Colours
) -> str:
    """Draw the regions, filled and with lines between them, as a picture of two dots per px."""
    values, index = np.unique(labels, return_inverse=True)
    width, height = _STEPS * size[0], _STEPS * size[1]
    shown = region_map(places, triangles, turns, index, borders, width, height)
    edge = np.zeros(shown.shape, bool)
    for here, there in ((np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1])):
        edge[here] |= shown[here] != shown[there]
    drawn = np.array([(255, 255, 255), *region_colours(values.tolist(), colours)], np.uint8)[shown]
    picture = np.dstack([drawn, np.where(shown > 0, 255, 0).astype(np.uint8)])
    picture[edge] = _LINE
    data = base64.b64encode(png(picture)).decode()
    return f'<image width="{size[0]}" height="{size[1]}" preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'


def region_map(places: Ints, triangles: Ints, turns: Ints, index: Ints, borders: Bools, width: int, height: int) -> Ints:
    """Return for each dot (height, width) the number of its region from 1, 0 where there is none.

    Along a row of dots a region begins where it is crossed by one of its sides that goes up, and ends at one that goes down: what begins
    and ends is added up from left to right. Only sides that border a region are looked at. `turns` (m,) is 1 for triangles that turn from
    x to y, -1 for others: on the dots some have no area left.
    """
    start, end = places[triangles][borders], places[np.roll(triangles, -1, axis=1)][borders]
    region = np.broadcast_to(index[:, None] + 1, borders.shape)[borders]
    up = np.sign(end[:, 1] - start[:, 1]) * np.broadcast_to(turns[:, None], borders.shape)[borders]
    low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    # The middles of rows low, low + 1, ..., high - 1 are crossed.
    side, step = runs(high - low)
    row = low[side] + step
    share = (row + 0.5 - start[side, 1]) / (end[side, 1] - start[side, 1])
    column = np.ceil(start[side, 0] + share * (end[side, 0] - start[side, 0]) - 0.5).astype(np.int64)
    begun = np.zeros((height, width + 1), np.int64)
    np.add.at(begun, (row.clip(0, height - 1), column.clip(0, width)), -(up[side] * region[side]).astype(np.int64))
    found: Ints = begun.cumsum(axis=1)[:, :width].clip(0, None)
    return found


def _lines(ends: Ints) -> str:
    """Draw lines (k, 2, 2), each once, without those that end where they begin."""
    keys = np.sort(_number(ends), axis=1)
    keys = np.unique(keys[keys[:, 0] != keys[:, 1]], axis=0)
    return "".join(f"M{_at(*divmod(a, _ROWS))}L{_at(*divmod(b, _ROWS))}" for a, b in keys.tolist())


def _number(places: Ints) -> Ints:
    """Give each place (..., 2) a number of its own, (...)."""
    number: Ints = places[..., 0] * _ROWS + places[..., 1]
    return number


def _at(x: int, y: int) -> str:
    return f"{x / _STEPS:g} {y / _STEPS:g}"
