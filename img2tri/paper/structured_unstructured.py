"""The paper's two recipes, from the stages in shapes/ and triangles/: a mask in, triangles out.

- `structured_mesh` (II-B, III-B, III-D): square grid -> points on white pixels -> Delaunay -> centroid filter.
- `unstructured_mesh` (II-C to II-E, III-C to III-E, `put_together` in the listing), contour by contour: points spread evenly along the
  contour -> Poisson-disk points inside -> Delaunay -> centroid filter. The ten passes of smoothing that follow are
  `img2tri.triangles.tools.laplacian_smoothing.uniform`, with the points of the contour `fixed`.

They do what the paper does, and are mended only where its listing cannot end, repeats a point, or is slow. So holes are filled, half a
pixel is lost all around, corners are cut, and a triangle may stick out of the shape. Both work in image coordinates,
(x, y) = (column, row) with whole numbers at the centres of pixels, y down; `paper_mesh` puts the result in its place in the world.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from shapely import MultiPolygon, get_parts

from img2tri.arrays import Bools, Floats, Ints
from img2tri.errors import ImageError, MeshError, choice, finite, integer
from img2tri.paper.boundary_points import arc_length_samples
from img2tri.paper.contours import contour_polygon, external_contours
from img2tri.paper.defaults import GRID_STEP
from img2tri.paper.delaunay import centroid_filter, delaunay, without_unused
from img2tri.paper.grid import MOST_POINTS, mask_filter, structured_grid
from img2tri.paper.poisson_disk import DISTANCE_PER_EDGE, poisson_disk
from img2tri.triangles.tools.laplacian_smoothing import uniform
from img2tri.triangles.tools.topology import curve_vertices
from img2tri.types import Frame, RecipeMesh


@dataclass(frozen=True, eq=False)
class PaperMesh:
    """What a recipe of the paper makes of a mask.

    Attributes
    ----------
    points
        (n, 2) float64, image coordinates (column, row), whole numbers at the centres of pixels; all are in use.
    triangles
        (m, 3) int64, counter-clockwise if x is drawn to the right and y *up*.
    fixed
        (n,) bool, the points that smoothing leaves alone: those spread along contours; for a grid those on the edge of the mesh.
    counted
        What was counted on the way, as plain data. Lists have an entry for each contour, in the order they are meshed.
    """

    points: Floats
    triangles: Ints
    fixed: Bools
    counted: dict[str, Any]


def structured_mesh(mask: ArrayLike, *, step: float = GRID_STEP, pixel: tuple[float, float] = (1.0, 1.0)) -> PaperMesh:
    """Mesh a mask with a square grid, as in sections II-B and III-B of the paper.

    Parameters
    ----------
    mask
        (h, w); anything but 0 is white.
    step
        Distance between the points of the grid; the edge of the mesh keeps up to that much away from the outline.
    pixel
        Width and height of a pixel in the unit of `step`.

    Raises
    ------
    ImageError
        When no triangle comes out: nothing is white, or the white zone is small against `step`.

    Notes
    -----
    The polygon of the centroid filter is that of the outer contours, so a hole is bridged by triangles between the points around it.

    Examples
    --------
    >>> mesh = structured_mesh(np.ones((31, 31), bool), step=10)
    >>> len(mesh.points), len(mesh.triangles)
    (16, 18)
    """
    white = np.asarray(mask) != 0
    length = finite("step", step, above=0)
    points = mask_filter(structured_grid(white.shape, step=(length / pixel[0], length / pixel[1])), white)
    polygons = [contour_polygon(contour) for contour in external_contours(white)]
    try:
        hull = delaunay(points)
    except MeshError as error:
        raise ImageError(
            f"mask: expected a white zone with a triangle of grid points, found none at step {length:g}; make step smaller ({error})"
        ) from error
    inside = centroid_filter(points, hull, MultiPolygon([part for polygon in polygons for part in get_parts(polygon)]))
    if len(inside) == 0:
        raise ImageError(f"mask: expected a white zone wider than step, found no triangle at step {length:g}; make it smaller")
    used, triangles = without_unused(points, inside)
    counted = {"grid_points": len(points), "unused_points": len(points) - len(used), "triangles_dropped": len(hull) - len(inside)}
    return PaperMesh(points[used], triangles, curve_vertices(triangles, len(used)), counted)


def unstructured_mesh(
    mask: ArrayLike,
    *,
    edge_length: float = GRID_STEP,
    n_boundary_points: int | None = None,
    n_interior_points: int | None = None,
    min_distance: float | None = None,
    min_distance_to_boundary: float | None = None,
    seed: int = 0,
    pixel: tuple[float, float] = (1.0, 1.0),
) -> PaperMesh:
    """Mesh each outer contour of a mask with points of its own, as `put_together` of the paper does; without the smoothing.

    Parameters
    ----------
    mask
        (h, w); anything but 0 is white.
    edge_length
        Mean length of edges to aim at; what follows from it is below.
    n_boundary_points
        How many points on each contour, at least 3. None: its length over `edge_length`.
    n_interior_points
        How many points inside of each contour are wanted; None: as many as fit. How many fitted is in ``counted``.
    min_distance
        Least distance between points inside. None: 0.77 `edge_length`, with which the mean edge of a full region is that length.
    min_distance_to_boundary
        Least distance between points inside and points on the contour. None: 0.77 `edge_length`; between 0.6 and 1.0 there is
        little difference, less leaves needles at the boundary, more a ring of large triangles along it.
    seed
        Of the points inside; same seed, same points.
    pixel
        Width and height of a pixel in the unit of the lengths.

    Raises
    ------
    ImageError
        When no triangle comes out: nothing is white, or no contour encloses anything.
    ParameterError
        When an option has a value it cannot have.

    Examples
    --------
    >>> disc = np.hypot(*np.mgrid[-20:20, -20:20] + 0.5) < 15
    >>> mesh = unstructured_mesh(disc, edge_length=5, n_interior_points=10)
    >>> mesh.counted["boundary_points"], mesh.counted["interior_points"], mesh.counted["interior_points_wanted"]
    ([19], [10], 10)
    """
    length = finite("edge_length", edge_length, above=0)
    contour_mesh = partial(
        _contour_mesh,
        edge_length=length,
        n_boundary=None if n_boundary_points is None else integer("n_boundary_points", n_boundary_points, least=3, most=MOST_POINTS),
        n_interior=None if n_interior_points is None else integer("n_interior_points", n_interior_points, most=MOST_POINTS),
        min_distance=DISTANCE_PER_EDGE * length if min_distance is None else min_distance,
        min_distance_to_boundary=DISTANCE_PER_EDGE * length if min_distance_to_boundary is None else min_distance_to_boundary,
    )
    first = integer("seed", seed)
    contours = external_contours(mask)
    tried = [contour_mesh(contour * pixel, seed=first + i) for i, contour in enumerate(contours)]
    parts = [part for part in tried if part is not None]
    if not parts:
        raise ImageError(f"mask: expected a white zone that encloses an area, found none among its {len(contours)} contours")
    counted: dict[str, Any] = {name: [part.counted[name] for part in parts] for name in parts[0].counted}
    counted |= {"interior_points_wanted": n_interior_points}
    counted |= {"contours": len(contours), "contours_without_triangles": len(contours) - len(parts)}
    mesh = _together(parts)
    return replace(mesh, points=mesh.points / pixel, counted=counted)


def _contour_mesh(
    contour: Floats,
    *,
    edge_length: float,
    n_boundary: int | None,
    n_interior: int | None,
    min_distance: float,
    min_distance_to_boundary: float,
    seed: int,
) -> PaperMesh | None:
    """Take one turn of the loop in `put_together`; None when no triangle is left."""
    polygon = contour_polygon(contour)
    if polygon.is_empty:
        return None
    perimeter = np.hypot(*(contour - np.roll(contour, 1, axis=0)).T).sum()
    boundary = arc_length_samples(contour, n_boundary or max(3, round(perimeter / edge_length)))
    # Where the contour runs out and back along a line, two of its points may be in one place.
    boundary = boundary[np.sort(np.unique(boundary, axis=0, return_index=True)[1])]
    distances = {"min_distance": min_distance, "min_distance_to_boundary": min_distance_to_boundary}
    interior = poisson_disk(polygon, boundary, n_points=n_interior, seed=seed, **distances)
    points = np.concatenate([boundary, interior])
    try:
        hull = delaunay(points)
    except MeshError:  # three points on one line
        return None
    inside = centroid_filter(points, hull, polygon)
    used, triangles = without_unused(points, inside)
    counted = {
        "boundary_points": len(boundary),
        "interior_points": len(interior),
        "unused_points": len(points) - len(used),
        "triangles_dropped": len(hull) - len(inside),
    }
    return PaperMesh(points[used], triangles, used < len(boundary), counted) if len(triangles) else None


def paper_mesh(
    labels: NDArray[Any],
    frame: Frame,
    *,
    recipe: str,
    edge_length: float,
    background: int | None = 0,
    iterations: int = 0,
    seed: int = 0,
    step: float | str | None = None,
    n_boundary_points: int | None = None,
    n_interior_points: int | None = None,
    min_distance: float | str | None = None,
    min_distance_to_boundary: float | str | None = None,
) -> RecipeMesh:
    """Mesh a label map by a recipe of the paper, each label as a white zone of its own, and put the meshes in their place.

    Neighbouring regions do not share vertices then: the paper knows of one white zone only.

    Parameters
    ----------
    labels
        (h, w) bool or integer label map.
    frame
        Where the image lies; the mesh is in its plane.
    recipe
        "structured" or "unstructured".
    edge_length
        In px; the default of `step`, and of all that `unstructured_mesh` derives from it.
    background
        The label that is not meshed, or None.
    iterations
        Passes of uniform smoothing that leave exactly the points of the contours in place; the paper makes 10, and none for a grid.
    step, min_distance, min_distance_to_boundary
        World units, or "8px", or "2%" of the diagonal of the image.
    n_boundary_points, n_interior_points, seed
        As for `unstructured_mesh`.

    Raises
    ------
    ImageError, ParameterError
        As the recipe does.
    """
    lengths = {"step": step, "min_distance": min_distance, "min_distance_to_boundary": min_distance_to_boundary}
    px = {k: None if v is None else frame.length(k, v, zero=k != "step") / frame.pixel for k, v in lengths.items()}
    pixel = (frame.spacing[0] / frame.pixel, frame.spacing[1] / frame.pixel)
    values = [value for value in np.unique(labels).tolist() if value != background]
    meshes = [
        structured_mesh(labels == value, step=px["step"] or edge_length, pixel=pixel)
        if choice("recipe", recipe, ("structured", "unstructured")) == "structured"
        else unstructured_mesh(
            labels == value,
            edge_length=edge_length,
            n_boundary_points=n_boundary_points,
            n_interior_points=n_interior_points,
            min_distance=px["min_distance"],
            min_distance_to_boundary=px["min_distance_to_boundary"],
            seed=seed,
            pixel=pixel,
        )
        for value in values
    ]
    if not meshes:
        raise ImageError("image: expected pixels to mesh, found only background")
    mesh = _together(meshes)
    column, row = mesh.points.T + 0.5  # whole numbers are the centres of pixels
    triangles = mesh.triangles[:, ::-1] if frame.upward else mesh.triangles  # turning y round turns the triangles round
    vertices = frame.plane(row, column)
    if iterations:
        vertices = uniform(vertices, triangles, iterations=iterations, fixed=mesh.fixed)
    regions = np.repeat(np.arange(1, len(values) + 1), [len(part.triangles) for part in meshes])
    counted = meshes[0].counted if len(meshes) == 1 else {str(v): part.counted for v, part in zip(values, meshes, strict=True)}
    return RecipeMesh(vertices, triangles, regions, counted)


def _together(parts: list[PaperMesh]) -> PaperMesh:
    """Put meshes that share nothing side by side, without what was counted."""
    starts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    return PaperMesh(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
        np.concatenate([part.fixed for part in parts]),
        {},
    )
