"""The conforming recipe: label map -> outlines -> points -> triangles, every region with its own outline.

Outlines are made first, as fine as the pixels; then coarsened to the wanted spacing, kept clear of each other; then filled.
Where a triangle comes out with too small an angle, the outlines there are made finer, and the mesh is made again: at the
end of this road all outlines run through the middles between pixels, where they turn by right angles at most.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from img2tri.raster.zones import Zones
from img2tri.records import Floats, Frame, Ints, Made, Outlines
from img2tri.shapes.areas import area_error, keep_areas
from img2tri.shapes.coarsening import refine, settle
from img2tri.shapes.cracks import find_cracks
from img2tri.shapes.drafts import draft
from img2tri.shapes.links import Links
from img2tri.shapes.placing import place, place_on_sides

AREA_ROUNDS, AREA_ERROR = 4, 1e-4  # how often breaks are moved for the sake of areas, and the relative error that is left
ATTEMPTS = 12  # rounds of refining the outlines; two are the most that ordinary images take


def trace_outlines(
    zones: Zones, frame: Frame, *, connectivity: int = 4, corners: str = "auto", outline: str = "smooth"
) -> tuple[Outlines, Links]:
    """Trace the outlines of all regions of a label map, as fine as the pixels.

    Parameters
    ----------
    zones
        The label map, and the gray values that place its outlines, if there are any.
    frame
        Where the image lies; the outlines are in its plane.
    connectivity
        4: a checkerboard joins its lower label, so that a binary foreground joins through sides; 8: its higher one.
    corners
        "round" smooths them as all else.
    outline
        "smooth", or "pixel": exactly along the sides of pixels.
    """
    cracks = find_cracks(zones.labels, background=zones.background, upward=frame.upward, connectivity=connectivity)
    if outline == "pixel":
        return place_on_sides(cracks, frame)
    return place(cracks, frame, gray=zones.gray, level=zones.level, corners=corners != "round")


def conform(
    outlines: Outlines,
    links: Links,
    *,
    edge_length: float,
    tolerance: float = 0.5,
    min_angle: float = 30.0,
    corners: str = "auto",
    keep_area: bool = True,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> Made:
    """Mesh all regions of an image, given its dense outlines; lengths in px."""
    from img2tri.triangles.delaunay import NetworkError
    from img2tri.triangles.filling import fill

    tell = progress or (lambda *_: None)
    tell("spacing", 0.3)
    coarse = settle(draft(outlines, links, spacing=edge_length, keep_corners=corners == "keep"), tolerance=tolerance)
    for _ in range(AREA_ROUNDS if keep_area else 0):
        if area_error(coarse) <= AREA_ERROR:
            break
        coarse = settle(keep_areas(coarse, tolerance=tolerance), tolerance=tolerance)
    for attempt in range(ATTEMPTS):
        tell("triangles", 1 - 0.6 * 0.7**attempt)
        chains = coarse.coarse()
        segments, left, right = chains.segments
        try:
            vertices, triangles, regions = fill(
                chains.points, segments, left, right, edge_length=edge_length, min_angle=min_angle, seed=seed
            )
            narrow = _smallest_angles(vertices, triangles) < min_angle - 1e-9
            if not narrow.any() or attempt == ATTEMPTS - 1:
                break
            doubtful = vertices[triangles[narrow]].reshape(-1, 2)
        except NetworkError as error:
            if attempt == ATTEMPTS - 1:
                raise
            doubtful = chains.points[segments[error.segments if len(error.segments) else slice(None)]].reshape(-1, 2)
        before = coarse
        coarse = refine(coarse, doubtful[:, 0] + 1j * doubtful[:, 1], within=1.0 + 0.5 * attempt, tolerance=tolerance)
        coarse = settle(coarse, tolerance=tolerance)
        if (coarse.breaks == before.breaks).all() and (coarse.reset == before.reset).all():
            break
    return Made(vertices, triangles, regions, {"rounds": attempt + 1, "reset": int(coarse.reset.sum())})


def _smallest_angles(vertices: Floats, triangles: Ints) -> Floats:
    """Smallest angle of each triangle in degrees."""
    z = (vertices[:, 0] + 1j * vertices[:, 1])[triangles]
    side = np.roll(z, -1, axis=1) - z
    angle = np.pi - np.abs(np.angle(side * np.roll(side, 1, axis=1).conj()))
    return np.asarray(np.degrees(angle.min(axis=1)))
