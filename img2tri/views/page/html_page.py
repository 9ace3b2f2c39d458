"""A page about a mesh: the mesh, its image and its certificate -> one HTML file that needs nothing but itself.

The page holds the image as a PNG, the mesh as raw arrays in base64, the certificate as JSON, and the script that draws them; it is read
without a network, by any browser, years later. What it says in words and tables is in `img2tri.views.page.html_tables` and
`img2tri.views.page.histogram_svg`; how it looks and draws, in page.html and page.js beside this file.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri import __version__
from img2tri.arrays import unique_edges
from img2tri.errors import MeshError
from img2tri.types import Floats, Frame, Ints
from img2tri.views.figures.colours import palette
from img2tri.views.objects.body_per_region import unique_names
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh
from img2tri.views.objects.region_borders import bordering
from img2tri.views.page import html_tables as tables
from img2tri.views.page.histogram_svg import RAMP, chart
from img2tri.views.page.image_png import png

_PIXELS = 4096  # of the image along either side; more are thinned out, as browsers refuse much larger ones
_LARGEST_ANGLE = 60.0


def page(
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    q: ArrayLike,
    min_angle: ArrayLike,
    frame: Frame,
    report: str,
    regions: ArrayLike | None = None,
    image: ArrayLike | None = None,
    names: Mapping[int, str] | None = None,
    title: str = "mesh",
    command: str = "",
    unit: str = "",
) -> str:
    """Make a page about a mesh.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 in world units, and (m, 3) int64.
    q, min_angle
        (m,) float64: 2 r / R, in 0..1, and the smallest angle in degrees of each triangle.
    frame
        Where the image lies.
    report
        The certificate as JSON, see `img2tri.certificate.report.Report.to_json`, or "{}" where there is none. It is kept in the page word
        for word.
    regions
        (m,) int64; None is region 1 everywhere.
    image
        (h, w), (h, w, 3) or (h, w, 4), drawn below the mesh; None draws the mesh alone.
    names
        Label -> name of the region.
    title
        What the page is about, such as the name of the image's file.
    command
        The command line that makes the mesh again.
    unit
        Of the world, such as "mm".

    Returns
    -------
    str
        HTML. The same input gives the same text.

    Raises
    ------
    MeshError
        If the arrays are not a mesh, the values do not go with it, or `report` is no certificate.
    ParameterError
        If `image` is no image.

    Examples
    --------
    >>> text = page([[0, 0], [4, 0], [0, 4]], [[0, 1, 2]], q=[0.83], min_angle=[45.0], frame=Frame((4, 4)), report='{"n_triangles": 1}')
    >>> text[:15], "://" in text
    ('<!doctype html>', False)
    """
    v, t = plane_mesh(vertices, triangles)
    labels = np.ones(len(t), np.int64) if regions is None else per_triangle("regions", regions, len(t))
    quality = per_triangle("q", q, len(t)).astype(np.float64)
    angle = per_triangle("min_angle", min_angle, len(t)).astype(np.float64)
    facts = _facts(report)
    present, index = np.unique(labels, return_inverse=True)
    called = unique_names(present.tolist(), names or {})
    colours = [f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in palette(len(present)).tolist()]
    edges, sides = unique_edges(t)
    places = tables.places(facts)
    xy, spots = _page_coordinates(v, frame), _page_coordinates(np.array([place.at for place in places]).reshape(-1, 2), frame)
    view = {
        **_placed(xy, edges, frame, unit),
        "image": image is not None,
        "ramp": RAMP,
        "regions": [{"name": called[label], "colour": colour} for label, colour in zip(present.tolist(), colours, strict=True)],
        "places": [
            {"x": x, "y": y, "number": place.number, "first": place.first} for place, (x, y) in zip(places, spots.tolist(), strict=True)
        ],
    }
    arrays = {
        "vertices": xy.astype("<f4"),
        "triangles": t.astype("<u4"),
        "borders": edges[bordering(sides, labels)].astype("<u4"),
        "quality": _bytes(quality),
        "angle": _bytes(angle / _LARGEST_ANGLE),
        "regions": index.astype("<u4"),
    }
    counted = np.bincount(index, minlength=len(present)).tolist()
    parts = {
        "version": __version__,
        "title": tables.text(title),
        "verdict": tables.verdict(facts),
        "tiles": tables.tiles(facts, len(v), len(t), len(present), quality, angle),
        "warnings": tables.warnings(facts, places),
        "certificate": tables.certificate(facts, places),
        "charts": chart("Quality", "q = 2 r / R; 1 is equilateral", quality, 1.0, "")
        + chart("Smallest angle", "of each triangle; 60° is equilateral", angle, _LARGEST_ANGLE, "°"),
        "regions": tables.regions(facts, [*zip(present.tolist(), called.values(), colours, counted, strict=True)]),
        "command": tables.text(command),
        "settings": tables.settings(facts),
        "report": _inert(report),
        "view": _inert(json.dumps(view)),
        "arrays": "\n".join(_embedded(name, array.tobytes()) for name, array in arrays.items())
        + ("" if image is None else "\n" + _embedded("picture", png(_thinned(np.asarray(image))))),
        "script": _resource("page.js"),
    }
    # In one pass, so that nothing that is filled in is taken for a place to fill.
    return re.sub(r"@(\w+)@", lambda found: parts[found[1]], _resource("page.html"))


def _facts(report: str) -> dict[str, Any]:
    try:
        facts = json.loads(report)
    except ValueError as problem:
        raise MeshError(f"report: expected JSON, found {report[:40]!r}: {problem}") from None
    if not isinstance(facts, dict):
        raise MeshError(f"report: expected an object of JSON, found {type(facts).__name__}")
    return facts


def _page_coordinates(points: Floats, frame: Frame) -> Floats:
    """Turn world coordinates into pixels of the image, the smaller side being 1, y down as on a screen."""
    rows, columns = frame.row_column(points)
    return np.stack([columns * (frame.spacing[0] / frame.pixel), rows * (frame.spacing[1] / frame.pixel)], axis=-1)


def _placed(xy: Floats, edges: Ints, frame: Frame, unit: str) -> dict[str, Any]:
    """Where the image and the mesh lie on the page, and how to get back to the world."""
    return {
        "size": [frame.shape[1] * frame.spacing[0] / frame.pixel, frame.shape[0] * frame.spacing[1] / frame.pixel],
        "box": [*xy.min(axis=0).tolist(), *xy.max(axis=0).tolist()],
        "edge": float(np.median(np.linalg.norm(xy[edges[:, 0]] - xy[edges[:, 1]], axis=1))),
        "corner": list(frame.corner),
        "pixel": frame.pixel,
        "upward": frame.upward,
        "unit": unit,
    }


def _bytes(values: Floats) -> NDArray[np.uint8]:
    return np.round(255 * np.nan_to_num(values).clip(0, 1)).astype(np.uint8)


def _thinned(image: NDArray[Any]) -> NDArray[Any]:
    step = max(1, -(-max(image.shape, default=1) // _PIXELS))
    return image[::step, ::step] if image.ndim > 1 else image


def _embedded(name: str, data: bytes) -> str:
    return f'<script type="application/octet-stream" id="{name}">{base64.b64encode(data).decode()}</script>'


def _inert(text: str) -> str:
    """Write JSON so that nothing in it can end the script element it stands in."""
    return text.replace("<", "\\u003c")


def _resource(name: str) -> str:
    return files("img2tri.views.page").joinpath(name).read_text(encoding="utf-8")
