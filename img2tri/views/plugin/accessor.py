"""What pyvista users find on their own objects, by entry point and with no import of img2tri.

::

    plate = pyvista.read("plate.png").img2tri.mesh(edge_length=8, threshold="otsu")
    plate.img2tri.quality().summary()
    plate.img2tri.report.kept
    plate.img2tri.smooth("cotangent", boundary="free").save("plate.vtp")

pyvista imports this file when ``.img2tri`` is first asked for; importing it registers the accessors. This room does not import the
pipeline; the methods go through the public names of img2tri, inside, where they are used.
"""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from img2tri.errors import MeshError, ParameterError
from img2tri.types import Frame
from img2tri.views.plugin.dataset_to_cells import from_dataset, image_frame, written_about
from img2tri.views.plugin.slices import IN_PLANE, laid_down, normal_of, put_down, put_up

if TYPE_CHECKING:
    import pyvista

    import img2tri
    from img2tri.views.objects.sets.named_sets import Sets

D = TypeVar("D")

_NO_IMAGE = (1, 1)


class ImageAccessor:
    """``ImageData.img2tri``: from an image to a mesh that lies on it."""

    def __init__(self, image: pyvista.ImageData) -> None:
        self._image = image

    def mesh(self, *, height: float | None = None, scalars: str | None = None, **options: Any) -> pyvista.PolyData:
        """Mesh an image, or a slice normal to any axis, in its plane.

        Parameters
        ----------
        height
            World units, above 0: return the closed solid from the plane of the image along its normal. None: the flat mesh.
        scalars
            The name of the array to mesh. None: the active scalars, or the first ones.
        **options
            Those of `img2tri.mesh_image`, such as ``edge_length=8`` or ``labels=True``; ``spacing`` and ``origin`` are those of
            the image.

        Returns
        -------
        pyvista.PolyData
            Triangles that lie where the image lies, with the cell arrays "region" and "q".

        Raises
        ------
        ImageError, ParameterError
            As `img2tri.mesh_image`.

        Examples
        --------
        >>> import numpy as np, pyvista
        >>> image = pyvista.ImageData(dimensions=(30, 20, 1), spacing=(0.5, 0.5, 1), origin=(7, 0, 0))
        >>> image["values"] = np.ones(600)
        >>> mesh = image.img2tri.mesh(edge_length=4, threshold=0.5)
        >>> mesh.bounds[:4], round(mesh.area, 9)
        ((6.75, 21.75, -0.25, 9.75), 150.0)
        """
        import img2tri

        flat, axis = laid_down(self._image, scalars)
        made = img2tri.mesh_image(flat, **options)
        return remember(put_up(made.to_pyvista(height=height), axis), made)


class MeshAccessor:
    """``.img2tri`` on meshes, flat or solid, of triangles, wedges or tetrahedra: what img2tri knows of them."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh
        self._made: tuple[img2tri.TriangleMesh, Any] | None = None

    @property
    def report(self) -> Any:
        """The certificate, see `img2tri.TriangleMesh.report`.

        A flat mesh is judged as it is, also if it was changed since it was made. A copy, or a mesh read from a file, knows how it was made
        if it was from a file: its image is then meshed again.

        Raises
        ------
        MeshError
            If the image is not known, or a solid was changed.
        """
        made, state = self._made or (_made_again(written_about(self._mesh)), None)
        if state == _state(self._mesh):
            return made.report
        try:
            present = self._triangle_mesh()
        except MeshError:
            if state is None and _stands_on(self._mesh, made):
                return made.report
            raise MeshError("report: expected a solid as it was made, found it changed; mesh_image(...).report judges its mesh") from None
        return replace(present, frame=made.frame, origin=made.origin).report

    def sets(self) -> Sets:
        """Name the parts: regions, and sets of facets, which are edges of flat meshes and faces of solids.

        Returns
        -------
        Sets
            As `img2tri.TriangleMesh.sets`; ``edges`` of solids has the nodes of faces. The closed surface of a solid has its regions only.

        Raises
        ------
        MeshError
            If it is no mesh of triangles, wedges or tetrahedra.
        """
        from img2tri.views.objects.sets.named_sets import Sets, region_names

        flat = self._flat()
        if hasattr(flat, "is_all_triangles") and flat.n_cells and np.ptp(np.asarray(flat.points)[:, 2]) > 0:
            regions = np.asarray(flat.cell_data["region"] if "region" in flat.cell_data else np.ones(flat.n_cells)).astype(np.int64)
            names = region_names(regions, {int(label): str(name) for label, name in written_about(flat).get("names", {}).items()})
            members = {name: np.flatnonzero(regions == label) for label, name in names.items()}
            return Sets({name: label for label, name in names.items()}, members, {}, {}, {}, {}, {})
        made = from_dataset(flat)
        facets = {name: made.facets(name) for name in made.sides}
        members = {made.names[label]: rows for label, rows in made.members().items()}
        return Sets({name: label for label, name in made.names.items()}, members, made.sides, facets, made.tags, made.part_of, made.between)

    def plot(self, plotter: pyvista.Plotter | None = None, **options: Any) -> Any:
        """Plot the mesh, each region in a colour of its own and with its name: ``mesh.to_pyvista(height=3).img2tri.plot()``.

        Parameters
        ----------
        plotter
            To add it to; None makes one and shows it.
        **options
            Of ``pyvista.Plotter.add_mesh``.

        Raises
        ------
        MeshError
            If there is no cell array "region".
        """
        from img2tri.views.plugin.plot_regions import plot_regions

        return plot_regions(self._mesh, plotter, **options)

    def quality(self) -> Any:
        """Measure the triangles: angles, areas, edge lengths, ratios, by their Verdict names, and q = 2 r / R.

        Returns
        -------
        Quality
            With arrays, ``summary()`` and, printed, a table, as `img2tri.TriangleMesh.quality` gives it.

        Raises
        ------
        MeshError
            If it is not a mesh of triangles in a plane of constant z.

        Examples
        --------
        >>> import pyvista
        >>> plane = pyvista.Plane(i_resolution=2, j_resolution=2).triangulate()
        >>> float(round(plane.img2tri.quality().summary()["min_angle"]["min"], 9))
        45.0
        """
        return self._triangle_mesh().quality()

    def _flat(self) -> Any:
        """Return the mesh with its plane normal to z, if it is a PolyData in a plane."""
        if not hasattr(self._mesh, "is_all_triangles") or not self._mesh.n_cells or not self._mesh.is_all_triangles:
            return self._mesh
        return put_down(self._mesh, normal_of(np.asarray(self._mesh.points)))

    def _triangle_mesh(self) -> img2tri.TriangleMesh:
        import img2tri

        made = from_dataset(self._flat())
        if made.kind != "triangle":
            raise MeshError(f"expected a mesh of triangles, found {made.kind}")
        frame = image_frame(written_about(self._mesh)) or Frame(_NO_IMAGE)
        return img2tri.TriangleMesh(made.points[:, :2], made.cells, made.regions, frame, made.names)


class SurfaceAccessor(MeshAccessor):
    """``PolyData.img2tri``: besides, what img2tri can do with a mesh of triangles in a plane, whoever made it."""

    _mesh: pyvista.PolyData

    def smooth(
        self,
        method: str = "cotangent",
        *,
        iterations: int = 10,
        boundary: str = "fixed",
        tolerance: float | str | None = None,
        guard: bool = True,
    ) -> pyvista.PolyData:
        """Return a copy of the mesh with its vertices smoothed; its arrays are kept, and ``q``, if it is there, measured anew.

        Parameters
        ----------
        tolerance
            With a free boundary, how far a vertex of it may move: in world units, or, of a mesh that img2tri made and whose image it
            knows, "0.5px" or "2%" of the image diagonal. None is "0.5px".
        method, iterations, boundary, guard
            As in `img2tri.TriangleMesh.smoothed`. Interfaces between regions, the cell array "region", count as boundary.

        Raises
        ------
        MeshError, ParameterError
            If it is not a mesh of triangles in a plane of constant z, or an option has a value it cannot have.

        Examples
        --------
        >>> import pyvista
        >>> plane = pyvista.Plane(i_resolution=2, j_resolution=2).triangulate()
        >>> plane.points[4] += (0.1, 0.2, 0)
        >>> plane.img2tri.smooth("uniform").points[4].round(6).tolist()
        [0.0, 0.0, 0.0]
        """
        mesh = self._triangle_mesh()
        if mesh.frame.shape == _NO_IMAGE and boundary != "fixed" and not isinstance(tolerance, (int, float)):
            raise ParameterError(f"tolerance: expected a number for a mesh that knows no image and so no pixel, found {tolerance!r}")
        tolerance = "0.5px" if tolerance is None else tolerance
        mesh = mesh.smoothed(method, iterations=iterations, boundary=boundary, tolerance=tolerance, guard=guard)
        smooth = self._mesh.copy()
        points = np.array(smooth.points, np.float64)
        points[:, IN_PLANE[normal_of(points)]] = mesh.vertices
        smooth.points = points
        if "q" in smooth.cell_data:
            smooth.cell_data["q"] = mesh.quality().arrays["q"]
        return remember(smooth, replace(mesh, origin=self._made[0].origin)) if self._made else smooth


def remember(dataset: D, made: Any) -> D:
    """Let a dataset know the `img2tri.TriangleMesh` it was made of, for its report; return it."""
    if made.origin is not None:
        known: Any = dataset
        known.img2tri._made = made, _state(dataset)
    return dataset


def _state(dataset: Any) -> tuple[int, ...]:
    """Return what changes whenever points, cells or regions of a dataset do."""
    cells = dataset.GetPolys() if hasattr(dataset, "GetPolys") else dataset.GetCells()
    region = dataset.GetCellData().GetAbstractArray("region")
    return dataset.GetPoints().GetMTime(), cells.GetMTime(), 0 if region is None else region.GetMTime()


def _made_again(about: dict[str, Any]) -> img2tri.TriangleMesh:
    """Mesh the image of a mesh again, by what the mesh says about itself."""
    import img2tri

    source, options = about.get("source"), about.get("options")
    if not isinstance(options, dict) or not os.path.exists(str(source)):
        raise MeshError(
            "report: expected a mesh whose image is known, found a copy, or a mesh from elsewhere, of no file that is there; what "
            ".img2tri.mesh and to_pyvista return knows its image, and so does mesh_image(...)"
        )
    made = img2tri.mesh_image(source, **options)
    if made.origin is None or made.origin.settings["image_sha256"] != about.get("image_sha256"):
        raise MeshError(f"report: expected the image this mesh was made from, found another in {source}; mesh it anew")
    return made


def _stands_on(dataset: Any, made: img2tri.TriangleMesh) -> bool:
    """Tell whether all vertices of a mesh are there in a solid."""
    x, y = np.asarray(dataset.points)[:, :2].T
    return bool(np.isin(made.vertices[:, 0] + 1j * made.vertices[:, 1], x + 1j * y).all())


def _register() -> None:
    import pyvista

    pyvista.register_dataset_accessor("img2tri", pyvista.ImageData)(ImageAccessor)
    pyvista.register_dataset_accessor("img2tri", pyvista.PolyData)(SurfaceAccessor)
    pyvista.register_dataset_accessor("img2tri", pyvista.UnstructuredGrid)(MeshAccessor)


_register()
