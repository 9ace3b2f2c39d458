"""Objects of pyvista -> `img2tri.views.objects.solver_cells.Cells`, so that whatever is in hand there can be written for solvers.

Regions are the cell array ``region``. What is known besides is taken from the field data: names of regions (an integer each, the label),
sets of facets (their nodes), and the text ``img2tri`` with names and the frame of the image. Sets of facets are taken over if each facet is
a side of a cell; otherwise, as after a change of the mesh, all sets are found anew.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.types import Frame
from img2tri.views.formats.vtp_vtu import VTK_TYPES
from img2tri.views.objects.sets.named_sets import interfaces_by_name, pieces_by_name, region_names
from img2tri.views.objects.sets.numbers_in_files import set_tags
from img2tri.views.objects.solver_cells import CELL_SIDES, Cells, flat_cells, solid_cells


def from_dataset(dataset: Any) -> Cells:
    """Make cells of a PolyData or an UnstructuredGrid.

    Parameters
    ----------
    dataset
        The object: triangles in one plane of constant z, or wedges; linear or quadratic; of one kind.

    Returns
    -------
    Cells
        Wedges that do not stand in layers on triangles, as those of img2tri do, have the sets in the field data only.

    Raises
    ------
    MeshError
        If it holds other cells, or triangles in space.

    Examples
    --------
    >>> import pyvista
    >>> plane = pyvista.Plane(i_resolution=2, j_resolution=1).triangulate()
    >>> made = from_dataset(plane)
    >>> made.kind, len(made.cells), made.names, list(made.sides)
    ('triangle', 4, {1: 'region_1'}, ['outer', 'outer_1', 'outer_2', 'outer_3', 'outer_4'])
    """
    points, cells, kind = _arrays(dataset)
    data = dataset.cell_data
    regions = np.asarray(data["region"]) if "region" in data else np.ones(len(cells), np.int64)
    if not np.all(regions == np.round(regions)):
        raise MeshError("region: expected whole numbers, found others")
    regions = regions.astype(np.int64)
    fields = {name: np.asarray(dataset.field_data[name]) for name in dataset.field_data}
    texts = {name: str(values[0]) for name, values in fields.items() if values.dtype.kind == "U" and values.size == 1}
    about = written_about(dataset)
    frame = image_frame(about)
    names = {int(label): str(name) for label, name in about.get("names", {}).items()}
    whole = {name: values for name, values in fields.items() if values.dtype.kind in "iu"}
    names |= {int(values[0]): name for name, values in whole.items() if values.shape == (1,) and values[0] in regions}
    options: dict[str, Any] = {"names": names, "bounds": frame.bounds if frame else None, "field_data": texts}
    arrays = {name: np.asarray(data[name]) for name in data if name != "region"}
    made = _flat_mesh(points, cells, regions, options) if kind.startswith("triangle") else _solid(points, cells, kind, regions, options)
    nodes = {name: np.asarray(dataset.point_data[name]) for name in dataset.point_data}
    made = replace(made, cell_data=_numbers(arrays), point_data=_numbers(nodes))
    widths = {len(side) for side in CELL_SIDES[kind]}
    facets = {name: values for name, values in whole.items() if values.ndim == 2 and values.shape[1] in widths}
    return _with_facets(made, facets) if facets else made


def written_about(dataset: Any) -> dict[str, Any]:
    """Return what img2tri wrote about a mesh into the field data, or nothing."""
    try:
        about = json.loads(str(dataset.field_data["img2tri"][0]))
    except (KeyError, IndexError, ValueError):
        return {}
    return about if isinstance(about, dict) else {}


def image_frame(about: Mapping[str, Any]) -> Frame | None:
    """Return where the image of a mesh lies, if that was written: "frame" with shape, spacing, corner and upward.

    Examples
    --------
    >>> image_frame({"frame": {"shape": [2, 3], "spacing": [1, 1], "corner": [5, 0], "upward": True}}).bounds
    (5.0, 0.0, 8.0, 2.0)
    """
    try:
        given = about["frame"]
        (h, w), (dx, dy), (x, y) = given["shape"], given["spacing"], given["corner"]
        return Frame((int(h), int(w)), (float(dx), float(dy)), (float(x), float(y)), bool(given["upward"]))
    except (KeyError, TypeError, ValueError):
        return None


def _arrays(dataset: Any) -> tuple[Floats, Ints, str]:
    """Return points, cells and their kind."""
    if hasattr(dataset, "is_all_triangles"):
        if not dataset.n_cells or not dataset.is_all_triangles:
            found = "other faces; use .triangulate()" if dataset.n_cells else "no face"
            raise MeshError(f"expected a PolyData of triangles, found {found}")
        return np.asarray(dataset.points, np.float64), np.asarray(dataset.regular_faces, np.int64), "triangle"
    blocks = {int(number): rows for number, rows in dataset.cells_dict.items()} if hasattr(dataset, "cells_dict") else {}
    kinds = {number: kind for kind, number in VTK_TYPES.items()}
    if len(blocks) != 1 or not set(blocks) <= set(kinds):
        raise MeshError(
            f"expected a PolyData of triangles, or an UnstructuredGrid of triangles or wedges only, found {type(dataset).__name__}"
            + (f" with cells of the types {', '.join(map(str, blocks))}" if blocks else "")
        )
    ((number, rows),) = blocks.items()
    return np.asarray(dataset.points, np.float64), np.asarray(rows, np.int64), kinds[number]


def _numbers(arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Leave out what VTK made for itself, and what is no number."""
    return {name: values for name, values in arrays.items() if values.dtype.kind in "biuf" and not name.startswith("vtk")}


def _flat_mesh(points: Floats, cells: Ints, regions: Ints, options: dict[str, Any]) -> Cells:
    z = points[:, 2]
    if not np.ptp(z) <= 1e-6 * np.ptp(points[:, :2], axis=0).max():
        raise MeshError(f"expected triangles in a plane of constant z, found z from {z.min():g} to {z.max():g}")
    p, q, r = (points[cells[:, i], :2] for i in range(3))
    twice = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
    # Seen from above, the mesh has to be on the left of its boundary.
    turned = cells if twice.sum() >= 0 else cells[:, [0, 2, 1, 5, 4, 3][: cells.shape[1]]]
    return flat_cells(points[:, :2], turned, regions, z=float(z[0]), **options)


def _solid(points: Floats, cells: Ints, kind: str, regions: Ints, options: dict[str, Any]) -> Cells:
    """Find the layers of wedges: as many at the bottom as there are triangles, each other one upon the one before."""
    if kind.startswith("tetra"):
        return Cells(points, cells, kind, regions, region_names(regions, options["names"]), {}, {}, {}, options["field_data"])
    base, top, z = cells[:, :3], cells[:, 3:6], points[:, 2]
    m = int(np.all(z[base] == z.min(), axis=1).sum())
    layered = m > 0 and len(cells) % m == 0 and np.array_equal(base[m:], top[:-m]) and np.array_equal(regions[m:], regions[:-m])
    if layered:
        return solid_cells(flat_cells(points[:, :2], base[:m], regions[:m], **options), points, cells)
    return Cells(points, cells, kind, regions, region_names(regions, options["names"]), {}, {}, {}, options["field_data"])


def _with_facets(made: Cells, facets: dict[str, NDArray[Any]]) -> Cells:
    """Give cells the sets of facets that are known of them, if all are sides of cells."""
    sides = {name: _sides(made, nodes) for name, nodes in facets.items()}
    if any(rows is None for rows in sides.values()):
        return made
    known = {name: rows for name, rows in sides.items() if rows is not None}
    part_of, between = pieces_by_name(known), interfaces_by_name(known, made.names)
    return replace(made, sides=known, tags=set_tags(known, made.ids.values()), part_of=part_of, between=between)


def _sides(made: Cells, nodes: NDArray[Any]) -> Ints | None:
    """Return the cell and the side each facet is, the first where two cells have it, or None if one of them is no side."""
    width = nodes.shape[1]
    numbers = [i for i, side in enumerate(CELL_SIDES[made.kind]) if len(side) == width]
    corners = width if made.kind in ("triangle", "wedge", "tetra") else (width + 1) // 2
    local = np.array([CELL_SIDES[made.kind][i] for i in numbers])[:, :corners]
    own = np.sort(made.cells[:, local].reshape(-1, corners), axis=1)
    each, which = np.unique(np.concatenate([own, np.sort(nodes[:, :corners], axis=1)]), axis=0, return_inverse=True)
    mine, wanted = np.split(which.ravel(), [len(own)])
    place = np.full(len(each), -1)
    place[mine[::-1]] = np.arange(len(own))[::-1]
    found = place[wanted]
    return None if (found < 0).any() else np.stack([found // len(numbers), numbers[0] + found % len(numbers)], axis=1)
