"""A mesh as the viewer reads it: arrays, and where they lie on the image -> the bytes drawing.js unpacks.

A text of JSON with its length before it, and after it arrays, each beginning at a multiple of 8 bytes: what a browser takes for typed
arrays as it is. Coordinates are pixels of the image, the smaller side being 1, y down as on a screen, in float32; numbers have the
shortest type that holds them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints, unique_edges
from img2tri.types import Frame
from img2tri.views.figures.region_colours import Colours, as_hex, region_colours
from img2tri.views.objects.body_per_region import unique_names
from img2tri.views.objects.region_borders import bordering
from img2tri.views.page.histogram_svg import BARS, bins, shade
from img2tri.views.page.html_tables import Place

LARGEST_ANGLE = 60.0
_WORST = 200  # triangles one can go to one after the other


def pack(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> bytes:
    r"""Put a head, plain data, and arrays one after the other.

    Examples
    --------
    >>> pack({"a": 1}, {"b": np.array([7, 8], np.uint8)})[4:]
    b'{"a": 1, "arrays": [["b", "u1", 2]]}\x07\x08\x00\x00\x00\x00\x00\x00'
    """
    listed = [[name, array.dtype.str[1:], array.size] for name, array in arrays.items()]
    text = json.dumps({**head, "arrays": listed}).encode()
    little = [array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes() for array in arrays.values()]
    parts = [len(text).to_bytes(4, "little") + text, *little]
    return b"".join(part + bytes(-len(part) % 8) for part in parts)


def packed_mesh(
    vertices: Floats,
    triangles: Ints,
    regions: NDArray[Any],
    *,
    q: Floats,
    min_angle: Floats,
    frame: Frame,
    names: Mapping[int, str],
    colours: Colours | None = None,
    unit: str = "",
    places: Sequence[Place] = (),
    **head: Any,
) -> bytes:
    """Pack a mesh, with what its triangles are coloured by and the places to be looked at; `head` is handed over with it."""
    present, index = np.unique(regions, return_inverse=True)
    called = unique_names(present.tolist(), names)
    edges, sides = unique_edges(triangles)
    xy = page_coordinates(vertices, frame)
    view = {
        **placed(frame, unit),
        "box": [*xy.min(axis=0).tolist(), *xy.max(axis=0).tolist()],
        "edge": float(np.median(np.linalg.norm(xy[edges[:, 0]] - xy[edges[:, 1]], axis=1))),
        "ramp": _ramp(),
        "regions": [
            {"label": label, "name": called[label], "colour": colour}
            for label, colour in zip(present.tolist(), as_hex(region_colours(present.tolist(), colours)), strict=True)
        ],
        "places": placed_marks(places, frame),
        "worst": _worst(min_angle),
    }
    arrays = {
        "vertices": xy.astype("<f4"),
        "triangles": _short(triangles),
        "borders": _short(edges[bordering(sides, regions)]),
        "regions": _short(index),
        "quality": bins(q, 1.0),
        "angle": bins(min_angle, LARGEST_ANGLE),
    }
    return pack({**head, "view": view}, arrays)


def placed(frame: Frame, unit: str) -> dict[str, Any]:
    """Say how large the image is on the page, and how to get back to the world."""
    return {
        "size": [frame.shape[1] * frame.spacing[0] / frame.pixel, frame.shape[0] * frame.spacing[1] / frame.pixel],
        "corner": list(frame.corner),
        "pixel": frame.pixel,
        "upward": frame.upward,
        "unit": unit,
    }


def placed_marks(places: Sequence[Place], frame: Frame) -> list[dict[str, Any]]:
    """Say where on the page the places to be looked at are, and of which warning."""
    spots = page_coordinates(np.array([place.at for place in places]).reshape(-1, 2), frame).tolist()
    return [{"x": x, "y": y, "number": place.number, "first": place.first} for place, (x, y) in zip(places, spots, strict=True)]


def page_coordinates(points: Floats, frame: Frame) -> Floats:
    """Turn world coordinates into pixels of the image, the smaller side being 1, y down as on a screen."""
    rows, columns = frame.row_column(points)
    return np.stack([columns * (frame.spacing[0] / frame.pixel), rows * (frame.spacing[1] / frame.pixel)], axis=-1)


@cache
def _ramp() -> list[str]:
    """Return the colours of the bars of the histograms."""
    return [f"#{shade((i + 0.5) / BARS)}" for i in range(BARS)]


def _worst(min_angle: Floats) -> list[int]:
    """Return the triangles with the smallest angles, the worst first."""
    count = min(_WORST, len(min_angle))
    some = np.argpartition(min_angle, count - 1)[:count]
    found: list[int] = some[np.lexsort([some, min_angle[some]])].tolist()
    return found


def _short(numbers: NDArray[Any]) -> NDArray[Any]:
    return numbers.astype(np.min_scalar_type(int(numbers.max(initial=0))))
