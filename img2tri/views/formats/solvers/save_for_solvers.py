"""A mesh as a file for solvers: the suffix names the format, and one table names who writes it and with which options.

What each format holds of regions, sets of facets and their names::

    suffix    regions                   sets of facets                    names
    .msh      physical groups           physical groups of facets         of all groups
    .inp      ELSET                     NSET and SURFACE                  of all
    .bdf      property numbers          SET1 of nodes                     comments
    .xdmf     tags                      tags, in a file of their own      Information
    .mesh     labels of cells           labels of facets                  comments
    .vtu      cell array `region`       field data, nodes of facets       of the arrays
    .vtkhdf   cell array `region`       field data, nodes of facets       of the arrays

Arrays of the user, values of cells or nodes, are in .msh, .xdmf, .vtu and .vtkhdf; the others have no place for them. Coordinates are
float64 in all of them, as far as the columns of .inp and .bdf have room.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import NamedTuple

from img2tri.errors import ParameterError
from img2tri.views.formats.array_names import check_array_names
from img2tri.views.formats.atomic_write import known_suffix, store, writable
from img2tri.views.formats.solvers.bdf import bdf
from img2tri.views.formats.solvers.inp import inp
from img2tri.views.formats.solvers.medit import medit
from img2tri.views.formats.solvers.msh import msh
from img2tri.views.formats.solvers.vtu_vtkhdf import vtkhdf, vtu
from img2tri.views.formats.solvers.xdmf import xdmf
from img2tri.views.objects.solver_cells import Cells


class Export(NamedTuple):
    """Who writes a format: a mesh -> what comes behind the stem of each file, and its bytes; its options; whether it holds arrays."""

    write: Callable[..., dict[str, bytes]]
    options: tuple[str, ...] = ()
    arrays: bool = True


EXPORTS = {
    ".msh": Export(msh, ("version",)),
    ".inp": Export(inp, ("deck", "plane"), arrays=False),
    ".bdf": Export(bdf, arrays=False),
    ".xdmf": Export(xdmf, ("timed",)),
    ".mesh": Export(medit, arrays=False),
    ".vtu": Export(vtu),
    ".vtkhdf": Export(vtkhdf),
}


def export(
    path: str | os.PathLike[str],
    made: Cells,
    *,
    version: str | None = None,
    deck: bool | None = None,
    plane: str | None = None,
    timed: bool | None = None,
) -> None:
    """Write a mesh with its named parts in the format the suffix of `path` names.

    The same mesh gives the same bytes. An older file is replaced in one step, or left as it is if anything goes wrong.

    Parameters
    ----------
    path
        Where to write: .msh, .inp, .bdf, .xdmf, .mesh, .vtu or .vtkhdf. Beside ``femur.xdmf``, ``femur_facets.xdmf`` is written too.
    made
        The mesh, see `img2tri.views.objects.solver_cells`.
    version
        Of .msh: "4.1", which is the default, or "2.2".
    deck
        Of .inp: True writes an analysis that runs, False, which is the default, the mesh alone.
    plane
        Of .inp: "stress", which is the default, or "strain".
    timed
        Of .xdmf: True adds a time, which pyvista needs to read it; the default is False.

    Raises
    ------
    FileError
        If the suffix is not known, or the file cannot be written.
    ParameterError
        If an option has a value it cannot have, or is given for a format that does not know it; if there are arrays the format has no
        place for.

    Examples
    --------
    >>> from img2tri.views.objects.solver_cells import flat_cells
    >>> export("plate.bdf", flat_cells([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), deck=True)
    Traceback (most recent call last):
    ...
    img2tri.errors.ParameterError: deck: expected only with .inp, found True for plate.bdf
    """
    suffix = known_suffix(path, EXPORTS)
    writable(path, EXPORTS)
    given = {"version": version, "deck": deck, "plane": plane, "timed": timed}
    options = {name: value for name, value in given.items() if value is not None}
    for name, value in options.items():
        if name not in EXPORTS[suffix].options:
            homes = " or ".join(other for other, form in EXPORTS.items() if name in form.options)
            raise ParameterError(f"{name}: expected only with {homes}, found {value!r} for {os.fspath(path)}")
    arrays = [*made.cell_data, *made.point_data]
    if arrays and not EXPORTS[suffix].arrays:
        homes = ", ".join(other for other, form in EXPORTS.items() if form.arrays)
        raise ParameterError(f"data: expected no arrays for {suffix}, which has no place for them, found {', '.join(arrays)}; use {homes}")
    check_array_names(arrays, suffix)
    stem, dot = os.path.splitext(os.fspath(path))
    files = EXPORTS[suffix].write(made, **options)
    targets = {ending: writable(f"{stem}{ending}{dot}", EXPORTS) for ending in files}
    # The file the user named comes last: where it is, the others are too.
    for ending in sorted(files, reverse=True):
        store(targets[ending], files[ending])
