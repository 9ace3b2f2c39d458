"""A `TriangleMesh` as pictures: what a figure or a page needs to know of it, collected.

Here the mesh, its certificate and its image come together; drawing is done by `img2tri.views.figures` and `img2tri.views.page`.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from img2tri.options import reproducing
from img2tri.raster.reading import read
from img2tri.triangles.tools.quality_summary import measure
from img2tri.views.formats.atomic_write import store, writable
from img2tri.views.page.html_page import page

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def figure(mesh: Any, image: Any, path: str | os.PathLike[str] | None, *, colour_by: str | None, ax: Axes | None = None) -> Figure:
    """Draw a mesh over its image, see `TriangleMesh.plot`."""
    from img2tri.views.figures.plot import draw

    q = measure(mesh.vertices, mesh.triangles, ["q"])["q"]
    values = meshed_part(mesh, image)
    unit = (mesh.origin.settings.get("units") if mesh.origin else None) or ""
    about = {"regions": mesh.regions, "values": q, "frame": mesh.frame, "image": values, "unit": unit}
    about |= {"names": mesh.names, "colours": mesh.colours}
    return draw(mesh.vertices, mesh.triangles, colour_by=colour_by, path=path, ax=ax, **about)


def save_page(mesh: Any, path: str | os.PathLike[str], image: Any) -> None:
    """Write a page about a mesh, see `TriangleMesh.save`."""
    target = writable(path, [".html"])
    store(target, page_about(mesh, meshed_part(mesh, image)).encode())


def page_about(mesh: Any, values: Any, *, title: str | None = None, command: str | None = None) -> str:
    """Return a page about a mesh, over the `values` of its image; without an origin it has no certificate."""
    settings, report = (mesh.origin.settings, mesh.report.to_json()) if mesh.origin else ({}, "{}")
    about = {"frame": mesh.frame, "regions": mesh.regions, "names": mesh.names, "unit": settings.get("units") or "", "image": values}
    about["colours"] = mesh.colours
    if command is None:
        command = "" if mesh.origin is None else _again(settings.get("source"), mesh.origin.options)
    named = Path(settings.get("source") or "mesh").name if title is None else title
    measured: dict[str, Any] = measure(mesh.vertices, mesh.triangles, ["q", "min_angle"])
    return page(mesh.vertices, mesh.triangles, **measured, **about, report=report, title=named, command=command)


def _again(source: str | None, options: dict[str, Any]) -> str:
    """Say how the mesh is made again: by a command if its image was a file, else in Python."""
    array = source in (None, "array")
    return reproducing.python("image", options, literal=False) if array else reproducing.command(str(source), options)


def meshed_part(mesh: Any, image: Any) -> Any:
    """Return the values of an image, of the part that was meshed."""
    values = None if image is None else read(image).values
    kept = mesh.origin.settings.get("crop") if mesh.origin and values is not None else None
    if kept and values is not None and values.shape[:2] == tuple(kept["of"]):
        return values[slice(*kept["rows"]), slice(*kept["columns"])]
    return values
