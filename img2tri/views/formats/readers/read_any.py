"""Any file img2tri writes, read back with all it holds: a path -> `img2tri.views.formats.readers.file_contents.Found`, whatever the format.

Plane meshes and solids, triangles, wedges and tetrahedra; regions, their names, named sets, values of cells and points, and what img2tri
wrote about the mesh, as far as the format holds them. `img2tri.views.formats.save_load.load` wants a plane mesh only.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from img2tri.errors import FileError, MeshError
from img2tri.views.formats.atomic_write import known_suffix
from img2tri.views.formats.readers.file_contents import Found
from img2tri.views.formats.readers.read_3mf import parse_3mf
from img2tri.views.formats.readers.read_inp import parse_inp
from img2tri.views.formats.readers.read_medit import parse_medit
from img2tri.views.formats.readers.read_msh_bdf import parse_bdf, parse_msh
from img2tri.views.formats.readers.read_stl_ply_obj_off_glb import by_trimesh
from img2tri.views.formats.readers.read_vtkhdf import parse_vtkhdf
from img2tri.views.formats.readers.read_vtp_vtu import parse_vtp_vtu
from img2tri.views.formats.readers.read_xdmf import parse_xdmf


def _surface(path: Path) -> Found:
    points, faces, regions = by_trimesh(path.read_bytes(), path.suffix.lower())
    labels = np.ones(len(faces), np.int64) if regions is None else np.asarray(regions).astype(np.int64)
    return Found(np.asarray(points, np.float64), np.asarray(faces, np.int64), "triangle", labels, {}, {})


def _of_bytes(parse: Callable[[bytes], Found]) -> Callable[[Path], Found]:
    return lambda path: parse(path.read_bytes())


FILE_READERS: dict[str, Callable[[Path], Found]] = {
    **dict.fromkeys((".stl", ".ply", ".obj", ".off", ".glb"), _surface),
    **dict.fromkeys((".vtp", ".vtu"), _of_bytes(parse_vtp_vtu)),
    ".3mf": _of_bytes(parse_3mf),
    ".msh": _of_bytes(parse_msh),
    ".bdf": _of_bytes(parse_bdf),
    ".inp": _of_bytes(parse_inp),
    ".mesh": _of_bytes(parse_medit),
    ".xdmf": parse_xdmf,
    ".vtkhdf": parse_vtkhdf,
}


def read_file(path: str | os.PathLike[str]) -> Found:
    """Read a mesh with all that its format holds.

    Parameters
    ----------
    path
        A file that ends in .stl, .ply, .obj, .off, .glb, .3mf, .vtp, .vtu, .msh, .bdf, .inp, .mesh, .xdmf or .vtkhdf.

    Raises
    ------
    FileError
        If the suffix is not known, or the file is missing, damaged or of another kind.
    MeshError
        If it holds cells of other kinds, or several.
    """
    suffix = known_suffix(path, FILE_READERS)
    try:
        found = FILE_READERS[suffix](Path(path))
    except OSError as problem:
        raise FileError(f"{path}: cannot be read: {problem.strerror or problem}") from problem
    except MeshError as problem:
        raise MeshError(f"{path}: {problem}") from None
    except Exception as problem:
        # Whatever a damaged file makes a reader stumble over, it is the file that cannot be read.
        raise FileError(f"{path}: cannot be read as {suffix}: {str(problem) or type(problem).__name__}") from problem
    if not len(found.cells):
        raise MeshError(f"{path}: expected cells, found none")
    return found
