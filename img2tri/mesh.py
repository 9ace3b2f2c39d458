"""TriangleMesh, the one frozen value users hold: data, and one-line methods that call triangles/ and views/; see `mesh_exports` too."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError, choice
from img2tri.mesh_exports import MeshExports
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions
from img2tri.types import Frame, Provenance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from img2tri.certificate.report import Report
    from img2tri.triangles.tools.quality_summary import Quality


@dataclass(frozen=True, eq=False, repr=False)
class TriangleMesh(MeshExports):
    """A planar triangle mesh with regions.

    Attributes
    ----------
    vertices, triangles, regions
        (n, 2) float64, world coordinates; (m, 3) int64, counter-clockwise; (m,) int64, the image's own label of each triangle, 1
        for one white zone.
    frame
        Where the image lies.
    names
        The user's names of regions.
    edge_sets
        Name -> (k, 2) int64, vertices at the ends of edges: named sets that `load` found in a file; they are in `sets` too.
    origin
        How the mesh was made and what it is to be judged by; None for meshes not made by `mesh_image`.

    Examples
    --------
    >>> import numpy as np
    >>> mesh = TriangleMesh(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]]), np.array([1]))
    >>> mesh
    TriangleMesh: 1 triangle, 3 vertices, 1 region, 0 <= x <= 1, 0 <= y <= 1
    """

    vertices: Floats
    triangles: Ints
    regions: Ints
    frame: Frame = field(default_factory=lambda: Frame((1, 1)))
    names: Mapping[int, str] = field(default_factory=dict)
    origin: Provenance | None = None
    edge_sets: Mapping[str, Ints] = field(default_factory=dict)

    def __post_init__(self) -> None:
        vertices, triangles = check_mesh(self.vertices, self.triangles)
        arrays = {"vertices": vertices, "triangles": triangles, "regions": check_regions(self.regions, triangles)}
        for name, array in arrays.items():
            view = array.view()
            view.flags.writeable = False
            object.__setattr__(self, name, view)

    def __repr__(self) -> str:
        (x0, y0), (x1, y1) = self.vertices.min(axis=0), self.vertices.max(axis=0)
        counts = ((len(self.triangles), "triangle"), (len(self.vertices), "vertices"), (len(set(self.regions.tolist())), "region"))
        text = ", ".join(f"{n} {word}{'s' if n != 1 and word != 'vertices' else ''}" for n, word in counts)
        return f"TriangleMesh: {text}, {x0:g} <= x <= {x1:g}, {y0:g} <= y <= {y1:g}"

    def _repr_html_(self) -> str:
        from img2tri.views.figures.notebook import html

        return html(self.vertices, self.triangles, self.regions, upward=self.frame.upward, colours=self.colours)

    @cached_property
    def report(self) -> Report:
        """The certificate: what this mesh keeps of what was promised, measured on its triangles when first asked for."""
        from img2tri.certificate.report import certify

        if self.origin is None:
            raise MeshError("report: expected a mesh made by mesh_image, found one made from arrays; there is no image to judge it by")
        return certify(self.vertices, self.triangles, self.regions, self.frame, self.origin)

    def quality(self) -> Quality:
        """Measure the triangles: angles, areas, edge lengths, ratios, by their Verdict names, and q = 2 r / R."""
        from img2tri.triangles.tools.quality_summary import assess

        return assess(self.vertices, self.triangles)

    @cached_property
    def periodic_pairs(self) -> dict[str, Ints]:
        """Vertices (k, 2) at the same place on opposite sides, "x": left and right, "y": bottom and top; as far as asked for.

        Where only one of the sides is meshed its vertices have no partner.
        """
        import numpy as np

        from img2tri.arrays import unique_edges
        from img2tri.shapes.periodic.paired_mesh_vertices import vertex_pairs

        settings = self.origin.settings if self.origin else {}
        edges, sides = unique_edges(self.triangles)
        boundary = edges[np.bincount(sides.ravel()) == 1]
        return vertex_pairs(self.vertices, self.frame.bounds, settings.get("periodic"), boundary)

    def sample(self, image: Any, on: str = "triangles", *, method: str | None = None) -> NDArray[Any]:
        """Carry an image on the same grid to triangles or vertices; what `save` and objects take as ``data``.

        Parameters
        ----------
        image
            (h, w) or (h, w, k) numbers on the grid of the image the mesh was made from, or the path of such an image.
        on
            "triangles" or "vertices".
        method
            "mean": of each triangle the mean over its area, exact; at vertices linear between the centres of pixels. "nearest": the pixel
            at the centroid or vertex, for labels. None: "nearest" for bool, else "mean". See `img2tri.recipes.sampling`.
        """
        from img2tri.recipes.sampling import sample

        return sample(image, self.vertices, self.triangles, self.frame, self.origin, on=on, method=method)

    def smoothed(
        self,
        method: str = "cotangent",
        *,
        iterations: int = 10,
        boundary: str = "fixed",
        tolerance: float | str = "0.5px",
        guard: bool = True,
    ) -> TriangleMesh:
        """Return the mesh with its vertices smoothed.

        Parameters
        ----------
        method, iterations
            "uniform": each vertex inside to the mean of its neighbours, as in the paper; evens lengths out, also those meant to
            differ. "cotangent": leaves the inside of a flat mesh as it is, and with ``boundary="free"`` rounds the
            boundary off. More passes smooth further.
        boundary
            "fixed", or "free" (cotangent only): boundary and interfaces are rounded off, the inside follows harmonically.
        tolerance, guard
            How far a vertex of the boundary may move, as a length. Whether no triangle may be turned over, nor the worst angle fall.
        """
        from img2tri.triangles.tools.cotangent_smoothing import cotangent
        from img2tri.triangles.tools.laplacian_smoothing import uniform

        choice("method", method, ("uniform", "cotangent"))
        within = self.frame.length("tolerance", tolerance)
        if method == "uniform":
            choice("boundary", boundary, ("fixed",))
            moved = uniform(self.vertices, self.triangles, iterations=iterations, regions=self.regions, guard=guard)
        else:
            bounds = self._bounds()
            moved = cotangent(
                self.vertices, self.triangles, iterations=iterations, boundary=boundary, tolerance=within,
                bounds=bounds, regions=self.regions, guard=guard,
            )  # fmt: skip
        return replace(self, vertices=moved)

    def plot(
        self, image: Any = None, path: str | os.PathLike[str] | None = None, *, colour_by: str | None = "quality", ax: Axes | None = None
    ) -> Figure:
        """Draw the mesh over its image, with a histogram of its quality beside it.

        Parameters
        ----------
        image, path
            What was meshed, a path or an array; None draws the mesh alone. Where to save the figure (.png, .svg, .pdf).
        colour_by
            "quality", "region", or None for red edges as in the paper's figures.
        ax
            Axes of a figure of yours to draw in, without the histogram; None makes a figure, which a notebook shows.
        """
        from img2tri.mesh_pictures import figure

        return figure(self, image, path, colour_by=colour_by, ax=ax)


def load_mesh(path: str | os.PathLike[str]) -> TriangleMesh:
    """Read a mesh back from a file that `TriangleMesh.save`, or another program, wrote; ``img2tri.load`` is its public name.

    Parameters
    ----------
    path
        A file that ends in .stl, .ply, .obj, .off, .glb, .3mf, .vtp, .vtu, .vtkhdf, .msh, .bdf, .inp, .mesh or .xdmf, with triangles in
        one plane of constant z; or a mesh in parts, .zarr, .pvtu or .vtkhdf, that `mesh_tiles` wrote and that fits in memory.

    Returns
    -------
    TriangleMesh
        With regions, names, the place of the image and its sides, so that `sets` are those that were saved, as far as the format holds
        them; named sets of edges that other programs made are kept in `edge_sets`. Files of .stl and .off have triangles alone, .ply, .obj,
        .glb and .3mf regions too. Quadratic triangles become those of their corners. There is no `report`: its image is not in the file.

    Raises
    ------
    FileError
        If the suffix is not known, or the file is missing, damaged or of another kind.
    MeshError
        If it holds other cells, or triangles in space, such as a solid; ``img2tri quality`` measures these.
    """
    from img2tri.tiles.parts.load_parts import in_parts, load_with_frame
    from img2tri.views.formats.readers.flat_mesh import flat_mesh
    from img2tri.views.formats.readers.known_sets import known_sets

    if in_parts(path):
        vertices, triangles, regions, frame = load_with_frame(path)
        return TriangleMesh(vertices, triangles, regions, frame, {})
    flat = flat_mesh(path)
    mesh = TriangleMesh(flat.vertices, flat.triangles, flat.regions, flat.frame, flat.names)
    known = known_sets(flat, mesh.sets().edges) if flat.facets else {}
    return replace(mesh, edge_sets=known) if known else mesh
