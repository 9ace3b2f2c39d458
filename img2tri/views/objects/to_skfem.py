"""For scikit-fem users: a plane mesh -> `skfem.MeshTri` with its parts by name.

scikit-fem finds facets by numbers of its own, so named edges are handed over as pairs of vertices, and looked up once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Floats, Ints, unique_edges
from img2tri.errors import FileError
from img2tri.views.objects.sets.named_sets import Sets

if TYPE_CHECKING:
    from skfem import MeshTri


def to_skfem(vertices: Floats, triangles: Ints, sets: Sets, *, middles: Floats | None = None) -> MeshTri:
    """Make a `skfem.MeshTri` of a plane mesh.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64.
    sets
        The named parts of the mesh.
    middles
        (e, 2) float64, where the node in the middle of each edge lies, edges as in `img2tri.arrays.unique_edges`; None for straight sides.

    Returns
    -------
    skfem.MeshTri
        Or, with `middles`, a `skfem.MeshTri2`. Subdomains are the regions, boundaries the named sets of edges: ``left``, ``outer``,
        ``hole_1``, ``bone__cartilage``.

    Raises
    ------
    FileError
        If scikit-fem is not installed.
    """
    try:
        from skfem import MeshTri, MeshTri2
    except ImportError as error:
        raise FileError("to_skfem: expected scikit-fem to be installed, found it is not; pip install 'img2tri[fem]'") from error
    mesh = MeshTri(np.ascontiguousarray(vertices.T), np.ascontiguousarray(triangles.T))
    # Facets of scikit-fem are sorted pairs of vertices; one number for each pair finds them.
    key = mesh.facets[0].astype(np.int64) * len(vertices) + mesh.facets[1]
    order = np.argsort(key)
    boundaries = {}
    for name, edges in sets.edges.items():
        wanted = edges.min(axis=1) * len(vertices) + edges.max(axis=1)
        boundaries[name] = order[np.searchsorted(key, wanted, sorter=order)]
    if middles is not None:
        mesh = MeshTri2.from_mesh(mesh)
        edges = unique_edges(triangles)[0]
        facets = order[np.searchsorted(key, edges[:, 0] * len(vertices) + edges[:, 1], sorter=order)]
        places = mesh.doflocs.copy()
        places[:, mesh.dofs.facet_dofs[0, facets]] = middles.T
        mesh = MeshTri2(places, mesh.t)
    return mesh.with_subdomains(dict(sets.regions)).with_boundaries(boundaries)
