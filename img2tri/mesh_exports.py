"""What a mesh becomes for others: objects of trimesh, pyvista and scikit-fem, and files. The methods of `img2tri.TriangleMesh` for it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from img2tri import __version__
from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError, ParameterError, choice, finite
from img2tri.types import Frame, Provenance

if TYPE_CHECKING:
    from pyvista import PolyData, UnstructuredGrid
    from shapely import MultiPolygon, Polygon
    from skfem import MeshTri
    from trimesh import Scene, Trimesh

    from img2tri.recipes.second_order import SecondOrder
    from img2tri.views.objects.base_plate import Base
    from img2tri.views.objects.sets.named_sets import Sets
    from img2tri.views.objects.solver_cells import Cells

CELLS = ("wedges", "tetrahedra")


class MeshExports:
    """The methods by which a mesh is handed on; the attributes are those of `img2tri.TriangleMesh`."""

    vertices: Floats
    triangles: Ints
    regions: Ints
    frame: Frame
    names: Mapping[int, str]
    edge_sets: Mapping[str, Ints]
    origin: Provenance | None

    @property
    def points(self) -> Floats:
        """The vertices with their height, (n, 3), as trimesh and pyvista have them."""
        return np.column_stack([self.vertices, np.full(len(self.vertices), self.frame.z)])

    @property
    def faces(self) -> Ints:
        """The triangles, under the name trimesh has for them."""
        return self.triangles

    @property
    def area(self) -> float:
        """The area of all triangles, in world units."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        return float(np.sum(ux * vy - uy * vx) / 2)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """(left, bottom, right, top) of the mesh."""
        (left, bottom), (right, top) = self.vertices.min(axis=0).tolist(), self.vertices.max(axis=0).tolist()
        return left, bottom, right, top

    @property
    def colours(self) -> dict[int, tuple[int, int, int]]:
        """Label -> (red, green, blue) of the regions that have a colour in the image: those of its palette, or RGB labels."""
        return self.origin.colours if self.origin else {}

    def to_trimesh(
        self, height: float | Mapping[int, float] | None = None, *, split: bool = False, base: float | None = None
    ) -> Trimesh | Scene:
        """Return a ``trimesh.Trimesh`` at z = 0, or with `height` (world units) the closed solid from z = 0 to z = height.

        Face attributes: ``region`` and ``q``. A `height` for each label makes one closed body of several heights; `base`, world units,
        adds a plate below that joins loose parts. With `split` (and a height), a ``trimesh.Scene`` with a closed body for each region;
        neighbours share their walls.
        """
        if split:
            from img2tri.views.objects.body_per_region import to_scene

            about = {"names": self.names, "colours": self.colours, "base": self._base(base), **self._data()}
            return to_scene(self.vertices, self.triangles, self.regions, height=height, **about)
        from img2tri.views.objects.flat_or_extruded import surface
        from img2tri.views.objects.to_trimesh import to_trimesh

        return to_trimesh(surface(self.vertices, self.triangles, self.regions, height=height, base=self._base(base), **self._data()))

    def to_pyvista(
        self,
        height: float | Mapping[int, float] | None = None,
        *,
        solid: bool = False,
        layers: int = 1,
        order: int = 1,
        cells: str | None = None,
        base: float | None = None,
    ) -> PolyData | UnstructuredGrid:
        """Return a ``pyvista.PolyData`` at z = 0, or with `height` (world units) the closed surface from z = 0 to z = height.

        Cell arrays: ``region`` and ``q``. With `solid`, an UnstructuredGrid of wedges in `layers`, or with ``cells="tetrahedra"`` of
        these; with ``order=2``, one of quadratic elements whose sides follow the outlines. Grids have the named sets in their field data.
        """
        from img2tri.views.plugin.accessor import remember

        if height is not None and order == 2 and not solid:
            raise ParameterError("order: expected 1 for the surface of a solid, found 2; solid=True gives quadratic wedges")
        if solid and height is None:
            raise ParameterError("height: expected a length with solid=True, found None")
        if solid or order != 1 or layers != 1:
            if base is not None:
                raise ParameterError(f"base: expected to be left out with cells, found {base!r}; it is for closed surfaces")
            from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid

            return remember(to_grid(self._cells(height, layers, order, cells)), self)
        if cells is not None:
            raise ParameterError(f"cells: expected to be left out without solid=True, found {cells!r}")
        from img2tri.views.objects.flat_or_extruded import surface
        from img2tri.views.objects.to_pyvista import to_pyvista

        made = surface(self.vertices, self.triangles, self.regions, height=height, base=self._base(base), **self._data())
        return remember(to_pyvista(made), self)

    def sets(self) -> Sets:
        """Name the parts: regions, sides of the frame, outer boundary, holes, interfaces ``A__B``, and pieces such as ``left_1``."""
        from img2tri.views.objects.sets.named_sets import named_sets

        return named_sets(self.vertices, self.triangles, self.regions, bounds=self._bounds(), names=self.names, given=self.edge_sets)

    def to_skfem(self, *, order: int = 1) -> MeshTri:
        """Return a ``skfem.MeshTri`` with regions as subdomains and named edges as boundaries; needs ``img2tri[fem]``.

        With ``order=2``, a ``skfem.MeshTri2``, whose sides follow the outlines of the image.
        """
        from img2tri.views.objects.to_skfem import to_skfem

        middles = self.second_order().nodes[len(self.vertices) :] if _order(order) == 2 else None
        return to_skfem(self.vertices, self.triangles, self.sets(), middles=middles)

    def save(
        self,
        path: str | os.PathLike[str],
        height: float | Mapping[int, float] | None = None,
        *,
        layers: int | None = None,
        order: int = 1,
        cells: str | None = None,
        data: Mapping[str, ArrayLike] | None = None,
        base: float | None = None,
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
            .bdf, .xdmf, .mesh, .vtu, .vtkhdf. The outlines of the image: .svg, .dxf, .geojson. A page to look at: .html.
        height
            World units: write a solid from z = 0 to there, closed surfaces for printing, wedges for solvers. For printing also label ->
            height of each region.
        base
            World units, for printing: the thickness of a plate below the solid, which joins loose parts; the solid stands on it.
        layers, order, cells
            For solvers: layers of wedges; 2 for quadratic elements; "tetrahedra" for these instead of wedges.
        data
            Name -> an array of one or more numbers for each triangle, or for each vertex, to be written too. Of formats that have no place
            for them, an error.
        version, deck, plane
            Of .msh, "4.1" or "2.2"; of .inp, whether an analysis that runs is written, in plane "stress" or "strain".
        image
            Of .html: what was meshed, a path or an array, to be seen below the mesh.
        """
        from img2tri.views.formats import svg_dxf_geojson as vectors
        from img2tri.views.formats.atomic_write import known_suffix
        from img2tri.views.formats.save_load import SURFACE_FORMATS, save
        from img2tri.views.formats.solvers.save_for_solvers import EXPORTS, export

        suffix = known_suffix(path, (*SURFACE_FORMATS, *EXPORTS, *vectors.DRAWING_FORMATS, ".html"))
        if image is not None and suffix != ".html":
            raise ParameterError(f"image: expected to be left out for {suffix}, which holds no image; it is for .html")
        whole = suffix == ".vtu" and height is not None and layers is None and cells is None and order == 1
        if suffix in EXPORTS and not whole:
            if base is not None:
                raise ParameterError(f"base: expected to be left out for {suffix} with cells, found {base!r}; it is for closed surfaces")
            made = self._cells(height, layers or 1, order, cells, data=data, quality=suffix in (".vtu", ".vtkhdf"))
            export(path, made, version=version, deck=deck, plane=plane)
            return
        given: dict[str, Any] = {"layers": layers, "version": version, "deck": deck, "plane": plane, "cells": cells}
        given["order"] = None if order == 1 else order
        for name, value in given.items():
            if value is not None:
                raise ParameterError(f"{name}: expected to be left out for {suffix}, found {value!r}; it is for {', '.join(EXPORTS)}")
        if suffix == ".html" or suffix in vectors.DRAWING_FORMATS:
            for name, value in (("height", height), ("data", data), ("base", base)):
                if value is not None:
                    raise ParameterError(f"{name}: expected None for {suffix}, which is a drawing, found {value!r}")
        if suffix == ".html":
            from img2tri.mesh_pictures import save_page

            save_page(self, path, image)
        elif suffix in vectors.DRAWING_FORMATS:
            about = {"bounds": self._bounds(), "upward": self.frame.upward, "field_data": self._data()["field_data"]}
            about["colours"] = self.colours
            vectors.save_outlines(path, self.outlines(), names=self.names, **about)
        else:
            about = self._data(data=data, quality=SURFACE_FORMATS[suffix].arrays)
            about |= {"names": self.names, "colours": self.colours, "base": self._base(base)}
            save(path, self.vertices, self.triangles, self.regions, height=height, **about)

    def _cells(self, height: float | Mapping[int, float] | None, layers: int, order: int, cells: str | None = None, **values: Any) -> Cells:
        """Return the elements solvers compute on, with their named sets; `values` as of `_data`."""
        from img2tri.views.objects.extruded_wedges import wedges
        from img2tri.views.objects.solver_cells import flat_cells, solid_cells
        from img2tri.views.objects.tetrahedra import tetrahedra

        nodes, elements, n, middles = self.vertices, self.triangles, len(self.vertices), None
        if _order(order) == 2:
            curved = self.second_order()
            nodes, elements, middles = curved.nodes, curved.triangles, curved.nodes[n:]
        shape = choice("cells", cells or "wedges", CELLS)
        periodic = self.origin.settings.get("periodic") if self.origin else None
        about = self._data(**values)
        about |= {"periodic": periodic, "edge_sets": self.edge_sets}
        flat = flat_cells(nodes, elements, self.regions, names=self.names, bounds=self._bounds(), **about)
        if height is None:
            for name, value in (("layers", None if layers == 1 else layers), ("cells", cells)):
                if value is not None:
                    raise ParameterError(f"{name}: expected to be left out for a flat mesh, found {value!r}; give a height too")
            return flat
        if isinstance(height, Mapping):
            raise ParameterError("height: expected one length for cells, found one for each region; these are for surfaces, to be printed")
        points, rows, _ = wedges(nodes[:n], self.triangles, height=height, layers=layers, order=order, z=self.frame.z, middles=middles)
        solid = solid_cells(flat, points, rows)
        return tetrahedra(solid) if shape == "tetrahedra" else solid

    def _base(self, thickness: float | None) -> Base | None:
        """Return the plate below a solid: under the image, or where that is not known, the mesh."""
        from img2tri.views.objects.base_plate import Base

        return None if thickness is None else Base(finite("base", thickness, above=0), self._bounds() or self.bounds)

    def _bounds(self) -> tuple[float, float, float, float] | None:
        """Return the frame of the image, if the mesh has one."""
        return self.frame.bounds if self.frame.shape != (1, 1) or self.origin else None

    def _data(self, *, data: Mapping[str, ArrayLike] | None = None, quality: bool = True) -> dict[str, Any]:
        """Collect what objects and files carry along: the height of the plane, q of each triangle and other values, how it was made."""
        from img2tri.triangles.tools.quality_summary import measure

        about: dict[str, Any] = {"version": __version__, "names": {str(label): name for label, name in self.names.items()}}
        if self.edge_sets:
            about["edge_sets"] = list(self.edge_sets)
        if self.origin is not None:
            f = self.frame
            about |= {"recipe": self.origin.recipe, **self.origin.settings, "names": about["names"], "options": self.origin.options}
            about |= {"colours": {str(label): colour for label, colour in self.colours.items()}} if self.colours else {}
            about["frame"] = {"shape": f.shape, "spacing": f.spacing, "corner": f.corner, "upward": f.upward}
        texts = {"img2tri": json.dumps(about, default=str)} | ({"units": about["units"]} if about.get("units") else {})
        cell_data: dict[str, Any] = dict(measure(self.vertices, self.triangles, ["q"])) if quality else {}
        point_data: dict[str, Any] = {}
        for name, values in (data or {}).items():
            array = np.asarray(values)
            if array.ndim < 1 or len(array) not in (len(self.triangles), len(self.vertices)):
                raise ParameterError(
                    f"data: expected {len(self.triangles)} values, one for each triangle, or {len(self.vertices)}, one for each vertex, "
                    f"found shape {array.shape} for {name!r}"
                )
            (cell_data if len(array) == len(self.triangles) else point_data)[name] = array
        return {"z": self.frame.z, "cell_data": cell_data, "field_data": texts} | ({"point_data": point_data} if point_data else {})

    def second_order(self) -> SecondOrder:
        """Return quadratic triangles, their sides curved along the outlines: corners, and a node in the middle of each side."""
        from img2tri.recipes.second_order import second_order

        return second_order(self.vertices, self.triangles, self.regions, self.frame, self.origin)

    def outlines(self) -> dict[int, Polygon | MultiPolygon]:
        """Return the outlines of the image, as fine as the pixels, as one polygon for each label; together a coverage."""
        from img2tri.shapes.polygons import region_polygons

        if self.origin is None:
            raise MeshError("outlines: expected a mesh made by mesh_image, found one made from arrays")
        o = self.origin.outlines
        return region_polygons(replace(o, points=self.frame.world(o.points)))


def _order(order: int) -> int:
    if order not in (1, 2) or isinstance(order, bool):
        raise ParameterError(f"order: expected 1 or 2, found {order!r}")
    return order
