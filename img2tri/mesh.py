"""TriangleMesh, the one frozen value users hold: data, and one-line methods that call triangles/ and views/."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from img2tri import __version__
from img2tri.errors import MeshError, ParameterError, choice
from img2tri.triangles.tools.mesh_checks import check_mesh, check_regions
from img2tri.types import Floats, Frame, Ints, Provenance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import PolyData, UnstructuredGrid
    from shapely import MultiPolygon, Polygon
    from skfem import MeshTri
    from trimesh import Scene, Trimesh

    from img2tri.certificate.report import Report
    from img2tri.recipes.second_order import SecondOrder
    from img2tri.triangles.tools.quality_summary import Quality
    from img2tri.views.objects.named_sets import Sets
    from img2tri.views.objects.solver_cells import Cells


@dataclass(frozen=True, eq=False, repr=False)
class TriangleMesh:
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

        return html(self.vertices, self.triangles, self.regions, upward=self.frame.upward)

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

    def outlines(self) -> dict[int, Polygon | MultiPolygon]:
        """Return the outlines of the image, as fine as the pixels, as one polygon for each label; together a coverage."""
        from img2tri.shapes.polygons import region_polygons

        if self.origin is None:
            raise MeshError("outlines: expected a mesh made by mesh_image, found one made from arrays")
        o = self.origin.outlines
        return region_polygons(replace(o, points=self.frame.world(o.points)))

    @cached_property
    def periodic_pairs(self) -> dict[str, Ints]:
        """Vertices (k, 2) at the same place on opposite sides, "x": left and right, "y": bottom and top; as far as asked for."""
        from img2tri.shapes.periodic.vertex_pairs import vertex_pairs

        settings = self.origin.settings if self.origin else {}
        return vertex_pairs(self.vertices, self.frame.bounds, settings.get("periodic"))

    def second_order(self) -> SecondOrder:
        """Return quadratic triangles, their sides curved along the outlines: corners, and a node in the middle of each side."""
        from img2tri.recipes.second_order import second_order

        return second_order(self.vertices, self.triangles, self.regions, self.frame, self.origin)

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
        from img2tri.triangles.tools.laplacian_smoothing import cotangent, uniform

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

    def to_trimesh(self, height: float | None = None, *, split: bool = False) -> Trimesh | Scene:
        """Return a ``trimesh.Trimesh`` at z = 0, or with `height` (world units) the closed solid from z = 0 to z = height.

        Face attributes: ``region`` and ``q``. With `split` (and a height), a ``trimesh.Scene`` with a closed body for each region;
        neighbours share their walls.
        """
        if split:
            from img2tri.views.objects.body_per_region import to_scene

            return to_scene(self.vertices, self.triangles, self.regions, height=height, names=self.names, **self._data())
        from img2tri.views.objects.to_trimesh import to_trimesh

        return to_trimesh(self.vertices, self.triangles, self.regions, height=height, **self._data())

    def to_pyvista(
        self, height: float | None = None, *, solid: bool = False, layers: int = 1, order: int = 1
    ) -> PolyData | UnstructuredGrid:
        """Return a ``pyvista.PolyData`` at z = 0, or with `height` (world units) the closed surface from z = 0 to z = height.

        Cell arrays: ``region`` and ``q``. With `solid`, an UnstructuredGrid of wedges in `layers`; with ``order=2``, one of
        quadratic triangles, or wedges.
        """
        if height is not None and order == 2 and not solid:
            raise ParameterError("order: expected 1 for the surface of a solid, found 2; solid=True gives quadratic wedges")
        if solid or order != 1 or layers != 1:
            from img2tri.views.objects.to_pyvista import to_elements

            if solid and height is None:
                raise ParameterError("height: expected a length with solid=True, found None")
            return to_elements(self.vertices, self.triangles, self.regions, height=height, layers=layers, order=order, **self._data())
        from img2tri.views.objects.to_pyvista import to_pyvista

        return to_pyvista(self.vertices, self.triangles, self.regions, height=height, **self._data())

    def sets(self) -> Sets:
        """Name the parts: regions, sides of the frame, outer boundary, holes, interfaces ``A__B``."""
        from img2tri.views.objects.named_sets import named_sets

        return named_sets(self.vertices, self.triangles, self.regions, bounds=self._bounds(), names=self.names)

    def to_skfem(self) -> MeshTri:
        """Return a ``skfem.MeshTri`` with regions as subdomains and named edges as boundaries; needs ``img2tri[fem]``."""
        from img2tri.views.objects.to_skfem import to_skfem

        return to_skfem(self.vertices, self.triangles, self.sets())

    def save(
        self,
        path: str | os.PathLike[str],
        height: float | None = None,
        *,
        layers: int | None = None,
        order: int = 1,
        version: str | None = None,
        deck: bool | None = None,
        plane: str | None = None,
        image: Any = None,
    ) -> None:
        """Write the mesh in the format the suffix names. An older file is replaced in one step, or left as it is.

        Parameters
        ----------
        path
            For printing and looking at: .stl, .ply, .obj, .off, .3mf, .glb, .vtp, .vtu. For solvers, with named sets: .msh, .inp,
            .bdf, .xdmf, .vtu, .vtkhdf. The outlines of the image: .svg, .dxf, .geojson. A page to look at: .html.
        height
            World units: write a solid from z = 0 to there, closed surfaces for printing, wedges for solvers.
        layers, order
            For solvers: layers of wedges; 2 for quadratic elements.
        version, deck, plane
            Of .msh, "4.1" or "2.2"; of .inp, whether an analysis that runs is written, in plane "stress" or "strain".
        image
            Of .html: what was meshed, a path or an array, to be seen below the mesh.
        """
        from img2tri.mesh_pictures import save_page
        from img2tri.views.formats import svg_dxf_geojson as vectors
        from img2tri.views.formats.save_load import save
        from img2tri.views.formats.solvers.save_for_solvers import EXPORTS, export

        suffix = Path(path).suffix.lower()
        if image is not None and suffix != ".html":
            raise ParameterError(f"image: expected to be left out for {suffix}, which holds no image; it is for .html")
        if suffix == ".html" and height is None:
            save_page(self, path, image)
        elif suffix in vectors.DRAWING_FORMATS:
            if height is not None:
                raise ParameterError(f"height: expected None for {suffix}, which is a drawing, found {height!r}")
            about = {"bounds": self._bounds(), "upward": self.frame.upward, "field_data": self._data()["field_data"]}
            vectors.save_outlines(path, self.outlines(), names=self.names, **about)
        elif suffix in EXPORTS and not (suffix == ".vtu" and height is not None and layers is None):
            export(path, self._cells(height, layers or 1, order), version=version, deck=deck, plane=plane)
        else:
            given = {"layers": layers, "version": version, "deck": deck, "plane": plane, "order": None if order == 1 else order}
            for name, value in given.items():
                if value is not None:
                    raise ParameterError(f"{name}: expected to be left out for {suffix}, found {value!r}; it is for {', '.join(EXPORTS)}")
            save(path, self.vertices, self.triangles, self.regions, height=height, names=self.names, **self._data())

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

    def _cells(self, height: float | None, layers: int, order: int) -> Cells:
        """Return the elements solvers compute on, with their named sets."""
        from img2tri.views.objects.solver_cells import elements

        if order not in (1, 2):
            raise ParameterError(f"order: expected 1 or 2, found {order!r}")
        curved = self.second_order() if order == 2 else None
        nodes, triangles = (curved.nodes, curved.triangles) if curved else (self.vertices, self.triangles)
        about = {"names": self.names, "bounds": self._bounds(), **self._data()}
        return elements(nodes, triangles, self.regions, corners=len(self.vertices), height=height, layers=layers, **about)

    def _bounds(self) -> tuple[float, float, float, float] | None:
        """Return the frame of the image, if the mesh has one."""
        return self.frame.bounds if self.frame.shape != (1, 1) or self.origin else None

    def _data(self) -> dict[str, Any]:
        """Collect what objects and files carry along: the height of the plane, q of each triangle, how the mesh was made."""
        from img2tri.triangles.tools.quality_summary import measure

        about: dict[str, Any] = {"version": __version__, "names": {str(label): name for label, name in self.names.items()}}
        if self.origin is not None:
            f = self.frame
            about |= {"recipe": self.origin.recipe, **self.origin.settings, "names": about["names"], "options": self.origin.options}
            about["frame"] = {"shape": f.shape, "spacing": f.spacing, "corner": f.corner, "upward": f.upward}
        texts = {"img2tri": json.dumps(about, default=str)} | ({"units": about["units"]} if about.get("units") else {})
        return {"z": self.frame.z, "cell_data": measure(self.vertices, self.triangles, ["q"]), "field_data": texts}
