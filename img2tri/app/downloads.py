"""The mesh as the bytes of a file: a suffix -> its name and what is in it; several files as one ZIP.

Formats are written by name, so they are written in a folder of their own that is gone at once; nothing stays.
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from img2tri.errors import ParameterError, choice
from img2tri.mesh import TriangleMesh
from img2tri.views.figures.plot import SUFFIXES as FIGURES
from img2tri.views.formats.save_load import SURFACE_FORMATS
from img2tri.views.formats.solvers.save_for_solvers import EXPORTS
from img2tri.views.formats.svg_dxf_geojson import DRAWING_FORMATS

_PLAIN = (".json", ".html")  # the report, and the page
_MESHES = tuple(dict.fromkeys((*SURFACE_FORMATS, *EXPORTS)))
ALL_KINDS = tuple(dict.fromkeys((*_MESHES, *DRAWING_FORMATS, *_PLAIN, *(f"figure{suffix}" for suffix in FIGURES))))
WITH_HEIGHT = tuple(_MESHES)


def download(mesh: TriangleMesh, stem: str, kind: str, *, height: float | None = None, image: Any = None) -> tuple[str, bytes]:
    """Return the name and the bytes of a file.

    Parameters
    ----------
    mesh, stem
        What is in it, and its name without suffix.
    kind
        A suffix of `TriangleMesh.save`, as ".stl"; ".json" for the report; "figure.png", "figure.svg" or "figure.pdf" for what
        `TriangleMesh.plot` draws.
    height
        World units: a solid, where the format can hold one.
    image
        What was meshed, drawn below the mesh in pages and figures.
    """
    choice("format", kind, ALL_KINDS)
    if height is not None and kind not in WITH_HEIGHT:
        raise ParameterError(f"height: expected to be left out for {kind}, found {height!r}")
    if kind == ".json":
        return stem + kind, (mesh.report.to_json() + "\n").encode()
    with TemporaryDirectory(prefix="img2tri-") as folder:
        path = Path(folder) / (stem + kind.removeprefix("figure"))
        if kind.startswith("figure"):
            mesh.plot(image, path)
        elif kind == ".html":
            mesh.save(path, image=image)
        else:
            solid = height is not None and kind == ".mesh"  # which knows no wedges
            mesh.save(path, height=height, cells="tetrahedra" if solid else None)
        files = sorted(Path(folder).iterdir())
        if len(files) == 1:
            return path.name, path.read_bytes()
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in files:
                archive.write(file, file.name)
        return f"{stem}{kind}.zip", packed.getvalue()
