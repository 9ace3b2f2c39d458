"""mesh_image: every stage in order. The table of contents of the library.

image -> labels -> outlines -> points -> triangles -> mesh
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypedDict, Unpack

from img2tri.errors import ImageError, ParameterError, choice, finite, flag, integer, shown
from img2tri.mesh import TriangleMesh
from img2tri.paper.recipes import paper_mesh
from img2tri.raster.in_memory.image_hash import image_hash
from img2tri.raster.labels.cropping import crop as cropped
from img2tri.raster.labels.label_maps import label, picked
from img2tri.raster.labels.otsu_threshold import Level
from img2tri.raster.labels.segmentation import segment, without_specks
from img2tri.raster.reading import read
from img2tri.recipes.conforming import conform, trace_outlines, wanted_sizes
from img2tri.shapes.periodic import check_periodic
from img2tri.shapes.polygons import enclosed_areas
from img2tri.shapes.sizes.size_field import EdgeLength
from img2tri.shapes.trace.dual_edges import pixel_areas, pixels_beside
from img2tri.types import Origin, checked_names

RECIPES = ("conforming", "structured", "unstructured")
SMOOTHINGS = ("none", "uniform", "cotangent")
UNITS = ("um", "mm", "cm", "m", "in", "ft")
MOST_PASSES = 100_000
PAPER_THRESHOLD, PAPER_STEP = 240, "10px"
PAPER_SMOOTHING = {"structured": "none", "unstructured": "uniform"}


class PaperOptions(TypedDict, total=False):
    """Options of the paper's recipes only, see `img2tri.paper.recipes`; all follow from `edge_length` if left out."""

    step: float | str
    n_boundary_points: int
    n_interior_points: int
    min_distance: float | str
    min_distance_to_boundary: float | str


def mesh_image(
    image: Any,
    *,
    recipe: str = "conforming",
    threshold: float | str | None = None,
    labels: bool | Iterable[int] | None = None,
    background: int | None = 0,
    invert: bool = False,
    connectivity: int = 4,
    outline: str = "smooth",
    corners: str = "auto",
    edge_length: EdgeLength | None = None,
    gradation: float = 0.17,
    min_edge_length: float | str | None = None,
    boundary_edge_length: float | str | None = None,
    elements_across: float | None = None,
    segments_per_turn: float | None = None,
    min_angle: float = 30.0,
    tolerance: float | str = "0.5px",
    keep_area: bool = True,
    periodic: str | None = None,
    interior: str = "lattice",
    smoothing: str | None = None,
    iterations: int = 10,
    spacing: float | Sequence[float] | str | None = None,
    origin: str | Sequence[float] = "lower",
    units: str | None = None,
    page: int = 0,
    crop: Sequence[float] | None = None,
    min_area: float | str | None = None,
    largest: bool = False,
    max_pixels: int = 2**28,
    names: dict[int, str] | None = None,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
    **paper: Unpack[PaperOptions],
) -> TriangleMesh:
    """Mesh an image: a path or an array in, a triangle mesh out.

    Parameters
    ----------
    image
        A path or a file opened in binary mode; an array (h, w) or (h, w, 3 or 4) of bool, integers or floats; or a planar
        ``pyvista.ImageData``, on which the mesh then lies.
    recipe
        "conforming": every region with its own outline, holes and all, to the promises below. "structured" and
        "unstructured" are the paper's, with what it gets wrong counted in the report.
    threshold
        A number on the image's own scale: strictly greater is foreground. "otsu". None: images of two values are split in
        the middle, others by Otsu; in the paper's recipes 240.
    labels, background
        None: one white zone, region 1. True: each value of the image is a region of its own. A list: these values are. The
        background is the label that is not meshed; None: all are.
    invert, connectivity, outline, corners
        Mesh the dark zone. Pixels hang together through their sides (4), or also through their corners (8).
        "smooth": through the places between the pixels where the edge is likely to be. "pixel": exactly along their sides.
        "auto": corners are kept sharp, as far as `min_angle` allows. "keep": always, even where that forces smaller
        angles, which the report then lists. "round": they are smoothed as all else is.
    edge_length
        Wanted length of edges, in world units, or "8px", or "2%" of the image diagonal. None: such that some 2000 triangles
        fill the image, at least 4 px. Smaller is finer and slower. Or a field: lengths by label, ``{1: 4, 2: "8px"}``; an array
        (h, w) of lengths, one for each pixel; a function of places (k, 2) that returns lengths (k,).
    gradation
        By how much the length may grow per unit of distance. Smaller gives better triangles, and more.
    min_edge_length, boundary_edge_length
        Outlines get no shorter edges than the first for the sake of the options here, only where tolerance, topology or angles
        need it. The second is the length of edges along all outlines; fine there, coarse inside.
    elements_across
        At least so many edges across the thinnest places, 2 or 3 for bending. None does not look after it.
    segments_per_turn
        At least so many edges to a full turn of an outline, so that small holes stay round. None: as the tolerance needs.
    min_angle
        Degrees, 0 to 32. The least angle of a triangle; above 30 more triangles are needed.
    tolerance
        The greatest distance between the outlines and the edges of the mesh, like `edge_length`. Larger lets sharp detail go.
    keep_area
        True: vertices on curved outlines are moved outwards so that the straight edges enclose the area the curve encloses,
        which makes computations on the mesh several times as exact. False: they lie on the outline.
    periodic, interior
        "x": left and right side of the image, whose labels have to be the same, get vertices at the same heights, see
        `TriangleMesh.periodic_pairs`; "y": bottom and top; "xy": both. Points inside: "lattice", for the best triangles, or
        "poisson", scattered as in the paper.
    smoothing, iterations
        Kind, and passes: "none"; "uniform", each vertex to the mean of its neighbours; "cotangent", rounding off what is left of the pixels
        on boundary and interfaces within the tolerance, the interior following. None: what the recipe does, which is
        "uniform" for "unstructured".
    spacing
        Size of a pixel in world units: a number, (dx, dy), or "file". None is 1.
    origin
        "lower": (0, 0) is the lower-left corner of the image, y points up. "upper": y points down from the upper-left
        corner. (x, y): the place of the lower-left corner.
    units
        What a world unit is: "um", "mm", "cm", "m", "in" or "ft", for files that can tell. None: "mm" with `spacing` from a file.
    page, max_pixels
        Which image of a file; the most pixels a file may have.
    crop
        (left, bottom, right, top) in world units: only that part of the image is meshed, where it lies.
    min_area
        Specks smaller than this are dropped and holes filled, in world units squared or "20px2"; in label maps they become
        part of the neighbour they share most with. None removes nothing. What was removed is in the report.
    largest
        True: only the largest component of each region is kept.
    names, seed, progress
        Names for regions, such as ``{1: "bone"}``; the seed of all that is random; what is called with the name of a stage and the
        fraction done, and ends the work if it raises.
    **paper
        Options of the paper's recipes: step, n_boundary_points, n_interior_points, min_distance, min_distance_to_boundary.

    Returns
    -------
    TriangleMesh
        Frozen; see its `report` for how it keeps the promises.

    Raises
    ------
    FileError, ImageError, ParameterError
        The file, the image or an option is not as it must be.

    Examples
    --------
    >>> import numpy as np
    >>> disc = np.hypot(*np.mgrid[-20:20, -20:20] + 0.5) < 15
    >>> mesh = mesh_image(disc, edge_length=4)
    >>> mesh.report.kept, mesh.quality().summary()["min_angle"]["min"] >= 30
    (True, True)
    """
    tell = progress or (lambda *_: None)
    choice("recipe", recipe, RECIPES)
    choice("units", "mm" if units is None else units, UNITS)
    names = checked_names(names)
    labels = labels if labels is None or isinstance(labels, bool) else picked(labels)
    background = None if background is None else label("background", background)
    choice("outline", outline, ("smooth", "pixel"))
    choice("corners", corners, ("auto", "keep", "round"))
    choice("interior", interior, ("lattice", "poisson"))
    smoothing = None if smoothing is None else choice("smoothing", smoothing, SMOOTHINGS)
    invert, keep_area, largest = flag("invert", invert), flag("keep_area", keep_area), flag("largest", largest)
    iterations, seed = integer("iterations", iterations, most=MOST_PASSES), integer("seed", seed, most=2**64 - 1)
    min_angle = finite("min_angle", min_angle, least=0, most=32)
    _check_paper_options(recipe, paper)
    if not isinstance(connectivity, int) or connectivity not in (4, 8):
        raise ParameterError(f"connectivity: expected 4 or 8, found {shown(connectivity)}")

    tell("reading", 0.0)
    picture = cropped(read(image, spacing=spacing, origin=origin, page=page, max_pixels=max_pixels), crop)
    frame = picture.frame

    tell("labels", 0.1)
    if recipe != "conforming" and threshold is None and not labels:
        threshold = PAPER_THRESHOLD
    zones = segment(picture, threshold=threshold, labels=labels, background=background, invert=invert)
    speck = None if min_area is None else frame.area("min_area", min_area) / math.prod(frame.spacing)
    zones, removed = without_specks(zones, min_area=speck, largest=largest, connectivity=connectivity)
    check_periodic(periodic, zones.labels, recipe=recipe, smoothing=smoothing)

    tell("outlines", 0.2)
    outlines, links = trace_outlines(zones, frame, connectivity=connectivity, corners=corners, outline=outline, periodic=periodic)
    if len(outlines.labels) == 1:
        raise ImageError(f"image: expected pixels to mesh, found none{_advice(zones.threshold, removed['pixels'])}")
    for named in names:
        if named not in outlines.labels[1:]:
            raise ParameterError(f"names: expected labels of the image, found {named}; it has {outlines.labels[1:21].tolist()}")

    tell("points", 0.3)
    within = frame.length("tolerance", tolerance) / frame.pixel
    sizes = wanted_sizes(
        edge_length, zones.labels, links, frame, gradation=gradation, boundary=boundary_edge_length, shortest=min_edge_length,
        elements_across=elements_across, segments_per_turn=segments_per_turn,
    )  # fmt: skip
    if recipe == "conforming":
        # Smoothing with a free boundary gets half of what outlines and mesh may differ by.
        spent = within / 2 if smoothing == "cotangent" else within
        made = conform(
            outlines, links, sizes, tolerance=spent, min_angle=min_angle, corners=corners,
            keep_area=keep_area, periodic=periodic, interior=interior, seed=seed, progress=tell,
        )  # fmt: skip
    else:
        if edge_length is None and recipe == "structured":
            paper = {"step": PAPER_STEP, **paper}
        passes = iterations if (smoothing or PAPER_SMOOTHING[recipe]) == "uniform" else 0
        made = paper_mesh(
            zones.labels, frame, recipe=recipe, background=zones.background, edge_length=sizes.longest,
            iterations=passes, seed=seed, **paper,
        )  # fmt: skip

    chosen = zones.threshold
    settings = {
        "threshold": chosen and chosen.value,
        "threshold_from": chosen and chosen.how,
        "labels": labels,
        "background": zones.background,
        "invert": invert,
        "connectivity": connectivity,
        "outline": outline,
        "corners": corners,
        "edge_length": sizes.longest * frame.pixel if sizes.field is None else "field",
        "gradation": gradation,
        "min_edge_length": min_edge_length,
        "boundary_edge_length": boundary_edge_length,
        "elements_across": elements_across,
        "segments_per_turn": segments_per_turn,
        "min_angle": min_angle,
        "tolerance": within * frame.pixel,
        "keep_area": keep_area,
        "periodic": periodic,
        "interior": interior,
        "crop": picture.notes.get("crop"),
        "min_area": min_area,
        "largest": largest,
        "smoothing": smoothing,
        "iterations": iterations,
        "spacing": frame.spacing,
        "units": units or ("mm" if picture.notes.get("spacing") == "file" else None),
        "seed": seed,
        "names": names,
        "source": picture.source,
        "image_sha256": image_hash(picture.values),
        **paper,
    }
    mesh = TriangleMesh(
        frame.world(made.vertices), made.triangles, outlines.labels[made.regions], frame, names,
        Origin(
            recipe, settings, outlines, *pixels_beside(links),
            areas=pixel_areas(links) if zones.gray is None else enclosed_areas(outlines),  # gray values may place the outlines
            counted={**made.counted, "removed": removed},
            tolerance=within if recipe == "conforming" else None, min_angle=min_angle if recipe == "conforming" else None,
        ),
    )  # fmt: skip

    tell("smoothing", 0.9)
    if smoothing == "cotangent":
        mesh = mesh.smoothed("cotangent", iterations=iterations, boundary="free", tolerance=within / 2 * frame.pixel)
    elif smoothing == "uniform" and recipe == "conforming":
        mesh = mesh.smoothed("uniform", iterations=iterations)
    tell("done", 1.0)
    return mesh


def _check_paper_options(recipe: str, paper: PaperOptions) -> None:
    """Refuse options that are unknown, or of another recipe."""
    unknown = sorted(set(paper) - set(PaperOptions.__annotations__))
    if unknown:
        raise TypeError(f"mesh_image() got an unexpected keyword argument {unknown[0]!r}")
    known: set[str] = {"conforming": set(), "structured": {"step"}, "unstructured": set(PaperOptions.__annotations__) - {"step"}}[recipe]
    for name in sorted(set(paper) - known):
        raise ParameterError(f"{name}: not an option of recipe {recipe!r}; leave it out, or choose another recipe")


def _advice(level: Level | None, removed: int) -> str:
    """Say in an error where it was looked."""
    if removed:
        return f"; {removed} were removed as too small; lower min_area="
    if level is None:
        return ", only background; see background="
    return f" above the threshold {level.value:g} ({level.how}); try another threshold=, or invert=True"
