"""img2tri: an image in, a triangle mesh out that one can compute on, plot, or print.

The flow, one folder for each step::

    image  -> labels      raster/      a file or an array becomes a label for each pixel
    labels -> outlines    shapes/      the curves that part the regions, as fine as the pixels; then coarsened to points
    points -> triangles   triangles/   triangulation, smoothing, quality
    mesh   -> others      views/       trimesh, pyvista, files, figures

`pipeline` runs them in order; `conforming` and `paper` are its recipes; `mesh` holds the result and `report` judges it.

The words: an *image* has *labels*, one for each pixel; pixels of one label make a *region*. *Outlines* part regions; they are
chains of *segments*, closed to *rings* around components and *holes*. An *interface* is shared by two regions, three or more meet
at a *junction*. *Points* are not yet joined; *vertices* are the corners of *triangles*.

World coordinates have x to the right and y up, the lower-left corner of the image at (0, 0); pixel (row r, column c) of an
image h pixels high is the square from (c, h - r - 1) to (c + 1, h - r) times the spacing.

>>> import numpy as np, img2tri
>>> img2tri.mesh_image(np.ones((20, 30), bool), edge_length=5, spacing=0.1).report.areas[1]["error"]
0.0
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from img2tri.certificate.report import Report
    from img2tri.errors import FileError, ImageError, Img2triError, MeshError, ParameterError
    from img2tri.mesh import TriangleMesh
    from img2tri.pipeline import mesh_image

__version__ = "0.1.0"

_PLACES = {
    "mesh_image": "pipeline",
    "TriangleMesh": "mesh",
    "Report": "certificate.report",
    "Img2triError": "errors",
    "ParameterError": "errors",
    "ImageError": "errors",
    "FileError": "errors",
    "MeshError": "errors",
}

__all__ = ["FileError", "ImageError", "Img2triError", "MeshError", "ParameterError", "Report", "TriangleMesh", "mesh_image"]


def __getattr__(name: str) -> Any:
    """Load public names when they are first used, so that importing img2tri costs nothing."""
    if name not in _PLACES:
        raise AttributeError(f"module 'img2tri' has no attribute {name!r}")
    value = getattr(import_module(f"img2tri.{_PLACES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names."""
    return [*__all__, "__version__"]
