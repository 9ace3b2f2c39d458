"""img2tri: an image in, a triangle mesh out that one can compute on, plot, or print.

The flow, one folder for each stage; each is functions from plain data to plain data, and can be used alone::

    image  -> labels      raster/      a file or an array becomes a label for each pixel
    labels -> outlines    shapes/      the curves that part the regions, as fine as the pixels; then simplified to the wanted edge length
    points -> triangles   triangles/   a mesh is generated between them; tools for any mesh
    mesh   -> others      views/       objects of other libraries, files, figures

The house around the stages:

    pipeline      `mesh_image`, every stage in order: the place to begin reading
    many/         `mesh_images`: many images, on the cores of this machine or on a Dask cluster
    options/      every option of `mesh_image`, written once: type, default, unit, words, check
    recipes/      ways through the stages; only recipes hand data from one stage to the next
    paper/        the paper this library began with: every function of its listing, and its two recipes
    certificate/  `Report`: what a finished mesh keeps of what was promised, measured
    mesh          `TriangleMesh`, the result, with methods for all that can be done with it; `mesh_exports` hands it on,
                  `mesh_pictures` shows it
    tiles/        `mesh_tiles`: one image larger than memory, in parts, on one process or a Dask cluster
    app/          the viewer with knobs, in a browser and in notebooks
    types         records handed between stages; `Frame`, one of them, turns pixels into world coordinates, and "8px" or "2%" into lengths
    arrays        what all files share: chains as arrays of indices, edges, sorting, the plane as complex numbers; `errors` likewise
    cell_lists    which of many places are near each other; `scipy_kernels` loads SciPy in parts
    triangle_angles  the angle at each corner of each triangle, for measures and figures alike
    cli/          the command line, ``img2tri``; ``python -m img2tri`` begins in `__main__`

The words one has to know:

    region        the pixels of one label, and what becomes of them; 0 is the number of all that is not meshed
    crack edge    the side shared by two pixels of different labels (Kovalevsky 1989): outlines begin as chains of these
    dual edge     the line between the centres of these two pixels; the outline crosses it somewhere in between, at its *crossing*
    chain         crossings one after the other, with one region on the left and one on the right, shared by both; it ends at two
                  nodes, or is a closed *ring*
    node          where three or more regions meet (a junction), or an outline meets the frame of the image
    outlines      all chains. *Dense*: a point for each crossing, smoothed; this is what a mesh is judged by. *Simplified*: only
                  some vertices are kept, with straight *chords* that stay within the tolerance of the *arcs* they replace
    size field    how long edges should be at each place; its growth is limited
    PSLG          planar straight-line graph: the simplified outlines as points and segments that triangles have to respect
    template      the part of a hexagonal lattice that fills the inside; the *strip* between it and the outlines is triangulated
    certificate   the numbers that say how well a mesh keeps its promises, measured on its triangles alone

World coordinates have x to the right and y up, the lower-left corner of the image at (0, 0); pixel (row r, column c) of an
image h pixels high is the square from (c, h - r - 1) to (c + 1, h - r) times the spacing. Inside the library lengths are pixels.

>>> import numpy as np, img2tri
>>> img2tri.mesh_image(np.ones((20, 30), bool), edge_length=5, spacing=0.1).report.areas[1]["error"]
0.0
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from img2tri.app.explore import explore
    from img2tri.certificate.report import Report
    from img2tri.errors import (
        ConfettiWarning,
        ConnectivityWarning,
        FileError,
        ImageError,
        Img2triError,
        Img2triWarning,
        MeshError,
        ParameterError,
        SizeWarning,
    )
    from img2tri.many.mesh_images import mesh_images
    from img2tri.mesh import TriangleMesh
    from img2tri.mesh import load_mesh as load
    from img2tri.pipeline import mesh_image
    from img2tri.tiles.mesh_tiles import mesh_tiles

__version__ = "0.1.0"

_PLACES = {
    "mesh_image": "pipeline",
    "mesh_tiles": "tiles.mesh_tiles",
    "explore": "app.explore",
    "mesh_images": "many.mesh_images",
    "load": "mesh:load_mesh",
    "TriangleMesh": "mesh",
    "Report": "certificate.report",
    "Img2triError": "errors",
    "ParameterError": "errors",
    "ImageError": "errors",
    "FileError": "errors",
    "MeshError": "errors",
    "Img2triWarning": "errors",
    "SizeWarning": "errors",
    "ConnectivityWarning": "errors",
    "ConfettiWarning": "errors",
}

__all__ = [
    "ConfettiWarning",
    "ConnectivityWarning",
    "FileError",
    "ImageError",
    "Img2triError",
    "Img2triWarning",
    "MeshError",
    "ParameterError",
    "Report",
    "SizeWarning",
    "TriangleMesh",
    "explore",
    "load",
    "mesh_image",
    "mesh_images",
    "mesh_tiles",
]


def __getattr__(name: str) -> Any:
    """Load public names when they are first used, so that importing img2tri costs nothing."""
    if name not in _PLACES:
        raise AttributeError(f"module 'img2tri' has no attribute {name!r}")
    place, _, other = _PLACES[name].partition(":")
    value = getattr(import_module(f"img2tri.{place}"), other or name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names."""
    return [*__all__, "__version__"]
