"""Outlines as drawings: one polygon per region, and if wanted the edges of the mesh -> an SVG, DXF or GeoJSON file.

Written here in a few lines rather than by trimesh, which joins the regions and forgets their names. What each format holds::

    suffix     coordinates                      regions                          edges of the mesh
    .svg       from the upper-left corner,      a filled path each, holes cut    one path, `mesh`
               y down, as images have it        out, with name and label
    .dxf       as they are                      closed polylines on a layer      lines on the layer `mesh`
                                                of the name, holes too
    .geojson   as they are                      a feature each, with `label`     a feature `mesh` of lines
                                                and `name`

DXF is that of release 12, ASCII, the oldest that is read everywhere: by CAD programs and laser cutters. Neighbouring regions have the same
interface, each on its own layer; a cutter has to be told to cut one of them.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats, unique_edges
from img2tri.errors import MeshError
from img2tri.views.figures.region_colours import as_hex, region_colours
from img2tri.views.formats.atomic_write import known_suffix, store, writable
from img2tri.views.formats.solvers.plain_text import ascii_letters
from img2tri.views.formats.xml_text import xml_escaped, xml_quoted
from img2tri.views.objects.body_per_region import unique_names
from img2tri.views.objects.flat_or_extruded import plane_mesh

_DXF_COLOURS = (5, 1, 3, 6, 4, 30)  # DXF numbers its colours: blue, red, green, magenta, cyan, orange
_DXF_UNITS = {"in": 1, "ft": 2, "mm": 4, "cm": 5, "m": 6, "km": 7, "nm": 12, "um": 13}  # 0 is none
_SVG_UNITS = {"mm", "cm", "in"}


class Shape(Protocol):
    """A polygon or multi-polygon of shapely, or of any library that speaks as it does."""

    @property
    def __geo_interface__(self) -> Any:
        """The shape as GeoJSON has it: type and coordinates."""


@dataclass(frozen=True, eq=False)
class _Region:
    """A region to be drawn: label, name, and the rings of each part, the outer one first, each (k, 2) with its first point again."""

    label: int
    name: str
    parts: list[list[Floats]]


@dataclass(frozen=True, eq=False)
class _Drawing:
    regions: list[_Region]
    lines: Floats  # (e, 2, 2)
    bounds: tuple[float, float, float, float]
    upward: bool
    texts: dict[str, str]
    colours: list[tuple[int, int, int]]


def save_outlines(
    path: str | os.PathLike[str],
    outlines: Mapping[int, Shape],
    *,
    names: Mapping[int, str] | None = None,
    colours: Mapping[int, tuple[int, int, int]] | None = None,
    mesh: tuple[ArrayLike, ArrayLike] | None = None,
    bounds: tuple[float, float, float, float] | None = None,
    upward: bool = True,
    field_data: Mapping[str, str] | None = None,
) -> None:
    """Write outlines as a drawing, in the format the suffix of `path` names.

    The same input gives the same bytes. An older file is replaced in one step, or left as it is if anything goes wrong.

    Parameters
    ----------
    path
        Where to write: .svg, .dxf or .geojson.
    outlines
        Label -> polygon or multi-polygon, such as ``mesh.outlines()``.
    names
        Label -> name. Regions without one are called "region_3" and so on. Layers of a DXF keep letters, digits, "-" and "_".
    colours
        Label -> (red, green, blue) an SVG fills the region with; regions without one get one of `img2tri.views.figures.region_colours`.
    mesh
        Vertices (n, 2) and triangles (m, 3), whose edges are to be drawn too; None draws none.
    bounds
        (left, bottom, right, top) of what an SVG shows, such as the frame of the image; None is what the outlines need.
    upward
        False where y points down, as it does in images: then an SVG is not turned over.
    field_data
        Name -> text, to be kept in the file. "units", such as "mm", gives an SVG its true size.

    Raises
    ------
    FileError
        If the suffix is not known, or `path` cannot be written.
    MeshError
        If an outline is no polygon, or `mesh` is no mesh.

    Examples
    --------
    >>> save_outlines("plate.pdf", {})
    Traceback (most recent call last):
    ...
    img2tri.errors.FileError: plate.pdf: expected a name that ends in .dxf, .geojson or .svg, found '.pdf'
    """
    target = writable(path, DRAWING_FORMATS)
    unique = unique_names(list(outlines), names or {})
    regions = [_Region(label, unique[label], _parts(label, outlines[label])) for label in sorted(outlines)]
    lines = np.zeros((0, 2, 2)) if mesh is None else _mesh_edges(*mesh)
    shown = region_colours([region.label for region in regions], colours)
    drawing = _Drawing(regions, lines, bounds or _bounds(regions, lines), upward, dict(field_data or {}), shown)
    store(target, DRAWING_FORMATS[known_suffix(path, DRAWING_FORMATS)](drawing).encode())


def _parts(label: int, shape: Shape) -> list[list[Floats]]:
    """Take a polygon or multi-polygon apart into rings; outer rings run counter-clockwise, holes clockwise, as GeoJSON wants them."""
    geometry = getattr(shape, "__geo_interface__", {"type": type(shape).__name__})
    if geometry["type"] not in ("Polygon", "MultiPolygon"):
        raise MeshError(f"outlines: expected a polygon or multi-polygon for region {label}, found {geometry['type']}")
    polygons = [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]
    return [[_wound(np.asarray(ring, np.float64)[:, :2], outer=i == 0) for i, ring in enumerate(rings)] for rings in polygons if rings]


def _wound(ring: Floats, *, outer: bool) -> Floats:
    x, y = (ring - ring[0]).T
    return ring if (np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) > 0) == outer else ring[::-1]


def _mesh_edges(vertices: ArrayLike, triangles: ArrayLike) -> Floats:
    v, t = plane_mesh(vertices, triangles)
    return v[unique_edges(t)[0]]


def _bounds(regions: list[_Region], lines: Floats) -> tuple[float, float, float, float]:
    places = np.concatenate([np.zeros((0, 2)), lines.reshape(-1, 2), *(rings[0] for region in regions for rings in region.parts)])
    if not len(places):
        raise MeshError("outlines: expected at least one, found none")
    (left, bottom), (right, top) = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    return left, bottom, right, top


# ---- SVG ----

_SVG = """<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}{unit}" height="{height}{unit}">
<metadata>{notes}</metadata>
<g id="outlines" fill-rule="evenodd" stroke="#2b2b2b" stroke-width="{thin}" stroke-linejoin="round">
{paths}
</g>{mesh}
</svg>
"""


def _svg_text(drawing: _Drawing) -> str:
    left, bottom, right, top = drawing.bounds
    # Nine digits of the larger side: finer than anything that can be drawn, and without the noise of subtracting.
    digits = 8 - int(np.floor(np.log10(max(right - left, top - bottom))))

    def number(value: float) -> str:
        return format(round(value, digits) + 0.0, ".10g")

    def moves(line: Floats) -> str:
        x = line[:, 0] - left
        y = top - line[:, 1] if drawing.upward else line[:, 1] - bottom
        return "M" + "L".join(f"{number(a)} {number(b)}" for a, b in zip(x.tolist(), y.tolist(), strict=True))

    paths = [
        f'<path id="region_{region.label}" data-label="{region.label}" data-name={xml_quoted(region.name)} fill="{colour}" '
        f'd="{"".join(moves(ring[:-1]) + "Z" for rings in region.parts for ring in rings)}">'
        f"<title>{xml_escaped(region.name)}</title></path>"
        for region, colour in zip(drawing.regions, as_hex(drawing.colours), strict=True)
    ]
    thin = (right - left + top - bottom) / 4000
    mesh = "".join(moves(line) for line in drawing.lines)
    return _SVG.format(
        width=number(right - left),
        height=number(top - bottom),
        unit=drawing.texts["units"] if drawing.texts.get("units") in _SVG_UNITS else "",
        notes=xml_escaped(json.dumps(drawing.texts)),
        thin=number(2 * thin),
        paths="\n".join(paths),
        mesh=f'\n<path id="mesh" fill="none" stroke="#2b2b2b" stroke-width="{number(thin)}" d="{mesh}"/>' if mesh else "",
    )


# ---- DXF ----


def _dxf(drawing: _Drawing) -> str:
    """Return the text of a DXF file: pairs of a code that says what comes and a value, each on a line of its own."""
    layers = _layers(drawing.regions)
    left, bottom, right, top = drawing.bounds
    # Comments, as long as lines may be.
    texts = drawing.texts | {f"layer {layers[r.label]}": r.name for r in drawing.regions if layers[r.label] != r.name}
    notes = [f"{name}: {text}".encode("unicode_escape").decode() for name, text in texts.items()]
    pairs: list[tuple[int, object]] = [(999, note[i : i + 250]) for note in notes for i in range(0, len(note), 250)]
    pairs += [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009")]
    pairs += [(9, "$INSUNITS"), (70, _DXF_UNITS.get(drawing.texts.get("units", ""), 0))]
    pairs += [(9, "$EXTMIN"), (10, left), (20, bottom), (30, 0.0), (9, "$EXTMAX"), (10, right), (20, top), (30, 0.0), (0, "ENDSEC")]
    pairs += [(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE"), (70, 1)]
    pairs += [(0, "LTYPE"), (2, "CONTINUOUS"), (70, 0), (3, "Solid line"), (72, 65), (73, 0), (40, 0.0), (0, "ENDTAB")]
    pairs += [(0, "TABLE"), (2, "LAYER"), (70, len(layers) + 1)]
    for i, layer in enumerate([*layers.values(), "mesh"]):
        colour = _DXF_COLOURS[i % len(_DXF_COLOURS)] if i < len(layers) else 8  # gray
        pairs += [(0, "LAYER"), (2, layer), (70, 0), (62, colour), (6, "CONTINUOUS")]
    pairs += [(0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]
    for region in drawing.regions:
        for rings in region.parts:
            for ring in rings:
                pairs += _polyline(layers[region.label], ring)
    for (x0, y0), (x1, y1) in drawing.lines.tolist():
        pairs += [(0, "LINE"), (8, "mesh"), (10, x0), (20, y0), (30, 0.0), (11, x1), (21, y1), (31, 0.0)]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def _polyline(layer: str, ring: Floats) -> Iterator[tuple[int, object]]:
    """Write a closed polyline; 66 says that its corners follow."""
    yield from [(0, "POLYLINE"), (8, layer), (66, 1), (10, 0.0), (20, 0.0), (30, 0.0), (70, 1)]
    for x, y in ring[:-1].tolist():
        yield from [(0, "VERTEX"), (8, layer), (10, x), (20, y), (30, 0.0)]
    yield from [(0, "SEQEND"), (8, layer)]


def _layers(regions: list[_Region]) -> dict[int, str]:
    """Name the layers by what release 12 allows: 31 letters, digits, - and _, large and small letters being alike."""
    allowed = {r.label: ascii_letters(r.name)[:24] or "region" for r in regions}
    lower = [name.lower() for name in [*allowed.values(), "mesh", "0"]]
    return {label: name if lower.count(name.lower()) == 1 else f"{name}_{label}"[-31:] for label, name in allowed.items()}


# ---- GeoJSON ----


def _geojson(drawing: _Drawing) -> str:
    features = [_feature({"label": region.label, "name": region.name}, _multipolygon(region.parts)) for region in drawing.regions]
    if len(drawing.lines):
        features.append(_feature({"name": "mesh"}, {"type": "MultiLineString", "coordinates": drawing.lines.tolist()}))
    return json.dumps({"type": "FeatureCollection", "metadata": drawing.texts, "features": features}, separators=(",", ":")) + "\n"


def _feature(properties: dict[str, Any], geometry: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _multipolygon(parts: list[list[Floats]]) -> dict[str, Any]:
    coordinates = [[ring.tolist() for ring in rings] for rings in parts]
    if len(parts) == 1:
        return {"type": "Polygon", "coordinates": coordinates[0]}
    return {"type": "MultiPolygon", "coordinates": coordinates}


DRAWING_FORMATS: dict[str, Callable[[_Drawing], str]] = {".dxf": _dxf, ".geojson": _geojson, ".svg": _svg_text}
