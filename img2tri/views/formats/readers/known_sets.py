"""Named sets of edges that a file holds beyond those that are found anew: the nodes of sets -> the edges of each.

Sets of edges that are sides of triangles are kept as they are. Of sets of nodes, as NSET of Abaqus, those are that consist of the ends of
edges on the boundary and between regions; others have no place in a plane mesh, and a warning names them.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import numpy as np

from img2tri.arrays import Ints, unique_edges
from img2tri.errors import Img2triWarning
from img2tri.views.formats.readers.flat_mesh import FlatMesh
from img2tri.views.formats.solvers.plain_text import unquoted
from img2tri.views.formats.solvers.vtu_vtkhdf import array_name
from img2tri.views.objects.region_borders import bordering


def known_sets(flat: FlatMesh, found: Mapping[str, Ints]) -> dict[str, Ints]:
    """Return the edges (k, 2) of each set that a file holds and that is not among those `found` of the mesh.

    A set that has the name of a region gets ``_edges`` behind it.
    """
    n, regions = len(flat.vertices), {flat.names.get(label, f"region_{label}") for label in np.unique(flat.regions).tolist()}
    edges, sides = unique_edges(flat.triangles)
    border = edges[bordering(sides, flat.regions)]
    known, all_keys = {name: _keys(rows, n) for name, rows in found.items()}, _keys(edges, n)
    kept, lost = {}, []
    for name, rows in (flat.facets if flat.listed is None else _of_ours(flat.facets, flat.listed)).items():
        if rows.shape[1] == 1:
            ends = border[np.isin(border, rows).all(axis=1)]
            rows, whole = ends, np.array_equal(np.unique(ends), np.unique(rows))
        else:
            whole = bool(np.isin(_keys(rows, n), all_keys).all())
        if not whole:
            lost.append(name)
        elif name not in known or not np.array_equal(known[name], _keys(rows, n)):
            kept[name if name not in regions else f"{name}_edges"] = rows
    if lost:
        message = f"sets: expected edges of triangles, found others in {', '.join(lost)}, for which a plane mesh has no place; left out"
        warnings.warn(message, Img2triWarning, stacklevel=3)
    return kept


def _of_ours(facets: Mapping[str, Ints], listed: list[str]) -> dict[str, Ints]:
    """Return the sets that are listed, by their names; formats have some in other letters."""
    found = {name: next((word for word in (name, unquoted(name), array_name(name)) if word in facets), None) for name in listed}
    return {name: facets[word] for name, word in found.items() if word is not None}


def _keys(edges: Ints, n: int) -> Ints:
    """Return a number for each edge, in ascending order, whatever its direction."""
    ends = np.sort(edges.reshape(-1, 2), axis=1)
    return np.unique(ends[:, 0] * n + ends[:, 1])
