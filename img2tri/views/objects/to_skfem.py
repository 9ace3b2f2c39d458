"""For scikit-fem users: a plane mesh -> `skfem.MeshTri` with its parts by name.

scikit-fem finds facets by numbers of its own, so named edges are handed over as pairs of vertices, and looked up once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.errors import FileError
from img2tri.views.objects.named_sets import Sets

if TYPE_CHECKING:
    from skfem import MeshTri


def to_skfem(vertices: Floats, triangles: Ints, sets: Sets) -> MeshTri:
    """Make a `skfem.MeshTri` of a plane mesh.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64.
    sets
        The named parts of the mesh.

    Returns
    -------
    skfem.MeshTri
        Subdomains are the regions, boundaries the named sets of edges: ``left``, ``outer``, ``hole_1``, ``bone__cartilage``.

    Raises
    ------
    FileError
        If scikit-fem is not installed.
    """
    try:
        from skfem import MeshTri
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
    return mesh.with_subdomains(dict(sets.regions)).with_boundaries(boundaries)
