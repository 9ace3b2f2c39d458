"""A page about a mesh: the mesh, its image and its certificate -> one HTML file that needs nothing but itself.

The page holds the image as a PNG, the mesh as arrays, deflated and in base64, the certificate as JSON, and the scripts that draw them;
it is read without a network, by any browser, years later. What it says in words and tables is in `img2tri.views.page.html_tables` and
`img2tri.views.page.histogram_svg`; how it looks and draws, in page.html and what is beside it.
"""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri import __version__
from img2tri.arrays import Floats, Ints
from img2tri.types import Frame
from img2tri.views.figures.image_png import png
from img2tri.views.figures.region_colours import Colours, as_hex, region_colours
from img2tri.views.objects.body_per_region import unique_names
from img2tri.views.objects.flat_or_extruded import per_triangle, plane_mesh
from img2tri.views.page import html_tables as tables
from img2tri.views.page.histogram_svg import chart
from img2tri.views.page.packing import LARGEST_ANGLE, packed_mesh

SCRIPTS = ("drawing.js", "camera.js", "viewer.js", "page.js")
POLICY = "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
BLANK = {
    "version": __version__, "title": "", "knobs": "", "python": "", "foot": "", "command": "", "verdict": "", "tiles": "", "warnings": "",
    "certificate": "", "charts": "", "regions": "", "settings": "",
}  # fmt: skip
_PIXELS = 4096  # of the image along either side; more are thinned out, as browsers refuse much larger ones


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
    colours: Colours | None = None,
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
    colours
        Label -> (red, green, blue) of the region, such as those of the image; the others get colours of their own.
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
    facts = tables.from_json(report)
    places = tables.places(facts)
    called = dict(names or {})
    packed = packed_mesh(v, t, labels, q=quality, min_angle=angle, frame=frame, names=called, colours=colours, unit=unit, places=places)
    picture = "" if image is None else base64.b64encode(png(thinned(np.asarray(image), _PIXELS))).decode()
    fill = {
        **BLANK,
        **pieces(v, t, labels, q=quality, min_angle=angle, names=called, colours=colours, facts=facts),
        "title": tables.text(title),
        "command": tables.text(command),
        "foot": "this page needs nothing but itself",
    }
    data = {
        "report": ("application/json", _inert(report)),
        "mesh": ("application/octet-stream", base64.b64encode(zlib.compress(packed, 6)).decode()),
        "picture": ("application/octet-stream", picture),
    }
    parts = {
        "version": __version__,
        "title": fill["title"],
        "policy": f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        "kind": "img2tri",
        "style": resource("page.css"),
        "body": filled(resource("body.html"), fill),
        "data": "\n".join(f'<script type="{kind}" id="{name}">{text}</script>' for name, (kind, text) in data.items() if text),
        "nonce": "",
        "script": "".join(map(resource, (*SCRIPTS, "standalone.js"))),
    }
    return filled(resource("page.html"), parts)


def pieces(
    vertices: Floats,
    triangles: Ints,
    regions: NDArray[Any],
    *,
    q: Floats,
    min_angle: Floats,
    names: Mapping[int, str],
    colours: Colours | None = None,
    facts: dict[str, Any],
) -> dict[str, str]:
    """Say in HTML what there is to say about a mesh: the name of its place on the page -> a piece."""
    present, counted = np.unique(regions, return_counts=True)
    called = unique_names(present.tolist(), names)
    places = tables.places(facts)
    shown = as_hex(region_colours(present.tolist(), colours))
    rows = [*zip(present.tolist(), called.values(), shown, counted.tolist(), strict=True)]
    return {
        "verdict": tables.verdict(facts),
        "tiles": tables.tiles(facts, len(vertices), len(triangles), len(present), q, min_angle),
        "warnings": tables.warnings(facts, places),
        "certificate": tables.certificate(facts, places),
        "charts": chart("quality", "Quality", "q = 2 r / R; 1 is equilateral", q, 1.0, "")
        + chart("angle", "Smallest angle", "of each triangle; 60° is equilateral", min_angle, LARGEST_ANGLE, "°"),
        "regions": tables.regions(facts, rows),
        "settings": tables.settings(facts),
    }


def filled(text: str, parts: Mapping[str, str]) -> str:
    """Fill in the places ``@name@`` of a text, in one pass, so that nothing that is filled in is taken for a place to fill."""
    return re.sub(r"@(\w+)@", lambda found: parts[found[1]], text)


def thinned(image: NDArray[Any], most: int) -> NDArray[Any]:
    """Leave out rows and columns of an image, alike in both directions, until either side has at most so many pixels."""
    step = max(1, -(-max(image.shape[:2], default=1) // most))
    return image[::step, ::step] if image.ndim > 1 else image


def _inert(text: str) -> str:
    """Write JSON so that nothing in it can end the script element it stands in."""
    return text.replace("<", "\\u003c")


@cache
def resource(name: str) -> str:
    """Return a text that lies beside this file."""
    return files("img2tri.views.page").joinpath(name).read_text(encoding="utf-8")
