"""What pyvista users find on their own objects, by entry point and with no import of img2tri.

::

    plate = pyvista.read("plate.png").img2tri.mesh(edge_length=8, threshold="otsu")
    plate.img2tri.quality().summary()
    plate.img2tri.smooth("cotangent", boundary="free").save("plate.vtp")

pyvista imports this file when ``.img2tri`` is first asked for; importing it registers the two accessors. This room does not import the
pipeline; the methods go through the public names of img2tri, inside, where they are used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.errors import MeshError, ParameterError
from img2tri.types import Frame
from img2tri.views.plugin.dataset_to_cells import from_dataset, image_frame, written_about

if TYPE_CHECKING:
    import pyvista

    import img2tri

_NO_IMAGE = (1, 1)


class ImageAccessor:
    """``ImageData.img2tri``: from an image to a mesh that lies on it."""

    def __init__(self, image: pyvista.ImageData) -> None:
        self._image = image

    def mesh(self, *, height: float | None = None, **options: Any) -> pyvista.PolyData:
        """Mesh the active scalars of the image, or its first ones.

        Parameters
        ----------
        height
            World units, above 0: return the closed solid from the plane of the image upwards. None: the flat mesh.
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

        return img2tri.mesh_image(self._image, **options).to_pyvista(height=height)


class SolidAccessor:
    """``UnstructuredGrid.img2tri``: a mesh for solvers, plotted by its regions."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

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


class MeshAccessor(SolidAccessor):
    """``PolyData.img2tri``: what img2tri can do with a plane mesh of triangles, whoever made it; and plots of solids too."""

    _mesh: pyvista.PolyData

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
        points[:, :2] = mesh.vertices
        smooth.points = points
        if "q" in smooth.cell_data:
            smooth.cell_data["q"] = mesh.quality().arrays["q"]
        return smooth

    def _triangle_mesh(self) -> img2tri.TriangleMesh:
        import img2tri

        made = from_dataset(self._mesh)
        if made.kind != "triangle":
            raise MeshError(f"expected a mesh of triangles, found {made.kind}")
        frame = image_frame(written_about(self._mesh)) or Frame(_NO_IMAGE)
        return img2tri.TriangleMesh(made.points[:, :2], made.cells, made.regions, frame, made.names)


def _register() -> None:
    import pyvista

    pyvista.register_dataset_accessor("img2tri", pyvista.ImageData)(ImageAccessor)
    pyvista.register_dataset_accessor("img2tri", pyvista.PolyData)(MeshAccessor)
    pyvista.register_dataset_accessor("img2tri", pyvista.UnstructuredGrid)(SolidAccessor)


_register()
