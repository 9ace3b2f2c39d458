"""A mesh in a notebook: vertices, triangles, regions -> a small SVG, and a piece of HTML with a line of numbers below it.

Small meshes are drawn triangle by triangle, in the colours of their regions; of larger ones only the regions, on a grid of half
a pixel, so that what is stored in the notebook stays small however large the mesh is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import unique_edges
from img2tri.types import Bools, Floats, Ints
from img2tri.views.figures.colours import palette
from img2tri.views.figures.corner_angles import corner_angles
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh
from img2tri.views.objects.region_borders import bordering

LARGEST = 3000  # triangles drawn one by one
_SIDE = 400  # px, the longer side of the drawing
_STEPS = 2  # places per px
_ROWS = 2 * _STEPS * _SIDE  # more than the grid has


def svg(vertices: ArrayLike, triangles: ArrayLike, regions: ArrayLike | None = None, *, upward: bool = True) -> str:
    """Draw a plane mesh, 400 px on its longer side.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64.
    regions
        (m,) int64; None is one region.
    upward
        Whether y points up; False draws it downwards, as in images.

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
    v, t = plane_mesh(vertices, triangles)
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    places, (width, height) = _places(v, upward=upward)
    edges, sides = unique_edges(t)
    border = bordering(sides, labels)
    drawn = _triangles(places, t, labels) if len(t) <= LARGEST else _regions(places, t, labels, border[sides])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 {width + 4} {height + 4}" width="{width + 4}" height="{height + 4}" '
        f'style="max-width:100%;height:auto" role="img" aria-label="{_numbers(v, t, labels)}">{drawn}'
        f'<path d="{_lines(places[edges[border]])}" fill="none" stroke="#5b6b7b" stroke-width="1" stroke-linecap="round"/></svg>'
    )


def html(vertices: ArrayLike, triangles: ArrayLike, regions: ArrayLike | None = None, *, upward: bool = True) -> str:
    """Draw a plane mesh, as `svg` does, with its counts and worst angle below.

    Examples
    --------
    >>> html([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).rpartition(">1")[2]
    ' triangle · 3 vertices · 1 region · smallest angle 45.0°</div></div>'
    """
    v, t = plane_mesh(vertices, triangles)
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    drawing, numbers = svg(v, t, labels, upward=upward), _numbers(v, t, labels)
    style = "font:12px/1.6 system-ui,sans-serif;opacity:.75;font-variant-numeric:tabular-nums"
    return f'<div class="img2tri">{drawing}<div style="{style}">{numbers}</div></div>'


def _numbers(vertices: Floats, triangles: Ints, labels: NDArray[np.generic]) -> str:
    counts = {"triangle triangles": len(triangles), "vertex vertices": len(vertices), "region regions": len(np.unique(labels))}
    parts = [f"{count:,} {words.split()[count != 1]}" for words, count in counts.items()]
    return " · ".join([*parts, f"smallest angle {np.rad2deg(corner_angles(vertices, triangles).min()):.1f}°"])


def _places(vertices: Floats, *, upward: bool) -> tuple[Ints, tuple[int, int]]:
    """Put the vertices on a grid of half a pixel, y down; return them (n, 2) and the size of the drawing in px."""
    least, extent = vertices.min(axis=0), np.ptp(vertices, axis=0)
    x, y = ((vertices - least) * (_SIDE / (extent.max() or 1.0))).T
    places = np.round(_STEPS * np.stack([x, y.max() - y if upward else y], axis=1)).astype(np.int64)
    width, height = (-(-places.max(axis=0) // _STEPS)).tolist()
    return places, (width, height)


def _triangles(places: Ints, triangles: Ints, labels: NDArray[np.generic]) -> str:
    """Draw all triangles of a region as one path, their sides in a lighter tone."""
    values, index = np.unique(labels, return_inverse=True)
    paths = []
    for i, colour in enumerate(_colours(len(values))):
        corners = places[triangles[index == i]]
        moves = "".join(f"M{_at(*a)}L{_at(*b)}L{_at(*c)}Z" for a, b, c in corners.tolist())
        paths.append(f'<path d="{moves}" fill="{colour}" stroke="#fff" stroke-opacity=".6" stroke-width=".5"/>')
    return "".join(paths)


def _regions(places: Ints, triangles: Ints, labels: NDArray[np.generic], borders: Bools) -> str:
    """Fill each region by the sides (m, 3) that border it, in any order: each as a triangle with the corner of the drawing.

    Where such triangles lie over each other an even number of times, nothing is filled, and what remains is the region: exactly, if edges
    are not blurred; the lines over them are.
    """
    values, index = np.unique(labels, return_inverse=True)
    ends = np.stack([triangles[borders], np.roll(triangles, -1, axis=1)[borders]], axis=1)
    sides = np.sort(_number(places[ends]), axis=1)
    region = np.broadcast_to(index[:, None], borders.shape)[borders]
    # Sides that the grid has made one with another cancel, two by two.
    rows, counts = np.unique(np.column_stack([region, sides]), axis=0, return_counts=True)
    rows = rows[(counts % 2 == 1) & (rows[:, 1] != rows[:, 2])]
    paths = []
    for colour, mine in zip(_colours(len(values)), np.split(rows, np.searchsorted(rows[:, 0], np.arange(1, len(values)))), strict=True):
        moves = "".join(f"M0 0L{_at(*divmod(a, _ROWS))}L{_at(*divmod(b, _ROWS))}Z" for _, a, b in mine.tolist())
        paths.append(f'<path d="{moves}" fill="{colour}" fill-rule="evenodd" shape-rendering="crispEdges"/>')
    return "".join(paths)


def _colours(count: int) -> list[str]:
    return [f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in palette(count).tolist()]


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
