"""mesh_image: every stage in order. The table of contents of the library.

image -> labels -> outlines -> points -> triangles -> mesh
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any, Unpack

from img2tri.errors import ImageError, ParameterError, shown
from img2tri.mesh import TriangleMesh
from img2tri.options.all_options import MeshOptions, checked, of, plain
from img2tri.options.image_options import ReadOptions, SegmentOptions
from img2tri.options.mesh_options import FillOptions, OutlineOptions, SizeOptions
from img2tri.options.paper_options import PaperOptions
from img2tri.options.signature_docs import with_options
from img2tri.paper.defaults import GRID_STEP, PAPER_SMOOTHING, PAPER_THRESHOLD
from img2tri.raster.in_memory.image_hash import image_hash
from img2tri.raster.labels.cropping import crop
from img2tri.raster.labels.meshing_warnings import meshing_warnings
from img2tri.raster.labels.otsu_threshold import Level
from img2tri.raster.labels.rgb_to_labels import colour_names, label_colours
from img2tri.raster.labels.segmentation import Segmentation, segment, without_specks
from img2tri.raster.labels.specks_and_holes import area_in_pixels
from img2tri.raster.metadata.wanted_width import as_wide_as
from img2tri.raster.reading import read
from img2tri.raster.reading_decisions import decisions
from img2tri.recipes.conforming import conform, trace_outlines
from img2tri.recipes.mirrored import conform_symmetric
from img2tri.recipes.wanted_sizes import Sizes, wanted_sizes
from img2tri.shapes.mirror_symmetry import check_symmetric
from img2tri.shapes.periodic.side_chains import check_periodic
from img2tri.shapes.polygons import enclosed_areas
from img2tri.shapes.trace.dual_edges import pixel_areas, pixels_beside
from img2tri.types import Frame, Outlines, Picture, Provenance, RecipeMesh


@with_options
def mesh_image(image: Any, *, progress: Callable[[str, float], None] | None = None, **options: Unpack[MeshOptions]) -> TriangleMesh:
    """Mesh an image: a path or an array in, a triangle mesh out.

    Parameters
    ----------
    image
        A path or a file opened in binary mode; an array (h, w) or (h, w, 3 or 4) of bool, integers or floats, where masked pixels and
        NaN are not meshed; a planar ``pyvista.ImageData``, an ``xarray.DataArray`` or a ``SimpleITK.Image``, on which the mesh then lies.
    {options}
    progress : callable | None, default None
        What is called with the name of a stage and the fraction done, and ends the work if it raises.

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

    The same mesh again:

    >>> mesh_image(disc, **mesh.report.options)
    TriangleMesh: ...
    """
    tell = _teller(progress)
    o = checked(options)

    tell("reading", 0.0)
    whole = as_wide_as(read(image, **of(ReadOptions, o)), o["width"], spacing=o["spacing"])
    picture = crop(whole, o["crop"])
    frame = picture.frame

    tell("labels", 0.1)
    zones = segment(picture, **_with_paper_threshold(o))
    specks, holes = (area_in_pixels(name, o[name], frame) for name in ("min_area", "fill_holes"))
    zones, removed = without_specks(zones, min_area=specks, fill_holes=holes, largest=o["largest"], connectivity=o["connectivity"])
    warned = _forewarn(zones, frame, o, tell)
    check_periodic(o["periodic"], recipe=o["recipe"], smoothing=o["smoothing"])
    check_symmetric(o["symmetric"], picture.values, zones.labels, periodic=o["periodic"], smoothing=o["smoothing"])

    tell("outlines", 0.2)
    outlines, dual_edges = trace_outlines(zones, frame, connectivity=o["connectivity"], **of(OutlineOptions, o))
    _check_found(outlines, zones, o, removed["pixels"])

    tell("points", 0.3)
    within = frame.length("tolerance", o["tolerance"]) / frame.pixel
    sizes = wanted_sizes(labels=zones.labels, dual_edges=dual_edges, frame=frame, **of(SizeOptions, o))
    if o["recipe"] == "conforming":
        # Smoothing with a free boundary gets half of what outlines and mesh may differ by.
        spent = within / 2 if o["smoothing"] == "cotangent" else within
        how: dict[str, Any] = {"corners": o["corners"], "periodic": o["periodic"], "tolerance": spent, **of(FillOptions, o)}
        if o["blocks"]:
            from img2tri.tiles.blocks_in_memory import conform_blocks

            made = conform_blocks(zones, frame, o, outlines.labels, progress=tell)
        elif o["symmetric"]:
            made = conform_symmetric(
                o["symmetric"], outlines, dual_edges, sizes, zones, frame, connectivity=o["connectivity"], progress=tell, **how
            )  # fmt: skip
        else:
            made = conform(outlines, dual_edges, sizes, progress=tell, **how)
    else:
        made = _paper(zones, picture, sizes, o)

    kept = plain(o, field=None if sizes.field is None else sizes.field.grid)
    mesh = TriangleMesh(
        frame.world(made.vertices), made.triangles, outlines.labels[made.regions], frame, _names(o, picture, outlines),
        Provenance(
            o["recipe"], kept, kept | _chosen(o, picture, zones, sizes, within), made.outlines or outlines, *pixels_beside(dual_edges),
            areas=pixel_areas(dual_edges) if zones.gray is None else enclosed_areas(outlines),  # gray values may place the outlines
            counted={**made.counted, "removed": {**removed, **zones.counted}}, notes=[*decisions(picture, zones), *warned],
            colours=label_colours(picture, outlines.labels[1:], quantized=o["colors"] is not None) if _labelled(o) else {},
            tolerance=within if o["recipe"] == "conforming" else None, min_angle=o["min_angle"] if o["recipe"] == "conforming" else None,
        ),
    )  # fmt: skip

    tell("smoothing", 0.9)
    if o["smoothing"] == "cotangent":
        mesh = mesh.smoothed("cotangent", iterations=o["iterations"], boundary="free", tolerance=within / 2 * frame.pixel)
    elif o["smoothing"] == "uniform" and o["recipe"] == "conforming":
        mesh = mesh.smoothed("uniform", iterations=o["iterations"])
    tell("done", 1.0)
    return mesh


def _teller(progress: Callable[[str, float], None] | None) -> Callable[[str, float], None]:
    if progress is not None and not callable(progress):
        raise ParameterError(f"progress: expected what can be called with a stage and a fraction, found {shown(progress)}")
    return progress or (lambda *_: None)


def _forewarn(zones: Segmentation, frame: Frame, o: MeshOptions, tell: Callable[[str, float], None]) -> list[str]:
    """Tell before the work what is hardly meant: as warnings, to who follows the progress, and in the report."""
    told = list(meshing_warnings(zones, connectivity=o["connectivity"], asked=_asked_triangles(zones, frame, o)))
    for warning in told:
        tell(str(warning), 0.1)
        warnings.warn(warning, stacklevel=3)
    return list(map(str, told))


def _asked_triangles(zones: Segmentation, frame: Frame, o: MeshOptions) -> float | None:
    """Return how many triangles of the edge length fill the image; None where the length is left open or differs from place to place."""
    if not isinstance(o["edge_length"], (int, float, str)):
        return None
    length = min(max(frame.length("edge_length", o["edge_length"]) / frame.pixel, 1e-100), 1e100)  # so that its square is a number
    return zones.labels.size * math.prod(frame.spacing) / frame.pixel**2 * 4 / math.sqrt(3) / length**2


def _with_paper_threshold(o: MeshOptions) -> SegmentOptions:
    """Return how regions are found; the paper's level is its own."""
    zones = of(SegmentOptions, o)
    # A threshold of 0 is one: it equals False, but is not it.
    if o["recipe"] != "conforming" and all(o[name] is None or o[name] is False for name in ("threshold", "labels", "colors", "absorb")):
        zones["threshold"] = PAPER_THRESHOLD
    return zones


def _paper(zones: Segmentation, picture: Picture, sizes: Sizes, o: MeshOptions) -> RecipeMesh:
    """Mesh by a recipe of the paper."""
    from img2tri.paper.structured_unstructured import paper_mesh

    paper = of(PaperOptions, o)
    if o["recipe"] == "structured" and o["edge_length"] is None and paper["step"] is None:
        paper["step"] = f"{GRID_STEP}px"
    passes = o["iterations"] if (o["smoothing"] or PAPER_SMOOTHING[o["recipe"]]) == "uniform" else 0
    return paper_mesh(
        zones.labels, picture.frame, recipe=o["recipe"], background=zones.background, edge_length=sizes.longest, iterations=passes,
        seed=o["seed"], **paper,
    )  # fmt: skip


def _chosen(o: MeshOptions, picture: Picture, zones: Segmentation, sizes: Sizes, within: float) -> dict[str, Any]:
    """Collect what was chosen where the options leave the choice, as plain data."""
    frame = picture.frame
    return {
        "threshold": zones.threshold and zones.threshold.value,
        "threshold_from": zones.threshold and zones.threshold.how,
        "background": zones.background,
        "edge_length": sizes.longest * frame.pixel if sizes.field is None else "field",
        "tolerance": within * frame.pixel,
        "crop": picture.notes.get("crop"),
        "spacing": frame.spacing,
        "units": o["units"] or picture.notes.get("units"),
        "source": picture.source,
        "image_sha256": image_hash(picture.values),
    }


def _check_found(outlines: Outlines, zones: Segmentation, o: MeshOptions, removed: int) -> None:
    """Refuse an image with nothing to mesh, and names of labels it does not have."""
    if len(outlines.labels) == 1:
        also = "".join(f", and {name}=" for name in ("absorb", "colors") if o[name] is not None)
        raise ImageError(f"image: expected pixels to mesh, found none{_advice(zones.threshold, removed)}{also}")
    for named in o["names"] or {}:
        if named not in outlines.labels[1:]:
            raise ParameterError(f"names: expected labels of the image, found {named}; it has {outlines.labels[1:21].tolist()}")


def _names(o: MeshOptions, picture: Picture, outlines: Outlines) -> dict[int, str]:
    """Return the names of regions as given, or as the file has them for labels that are there; labels that are colours are named so."""
    if not _labelled(o):
        return o["names"] or {}
    named = colour_names(picture, outlines.labels[1:], quantized=o["colors"] is not None)
    if o["names"] is None and o["labels"]:
        named |= {label: name for label, name in picture.notes.get("names", {}).items() if label in outlines.labels[1:]}
    return named | (o["names"] or {})


def _labelled(o: MeshOptions) -> bool:
    """Tell whether the labels of regions are values of pixels, or colours."""
    return bool(o["labels"]) or o["colors"] is not None


def _advice(level: Level | None, removed: int) -> str:
    """Say in an error where it was looked."""
    if removed:
        return f"; {removed} were removed as too small; lower min_area="
    if level is None:
        return ", only background; see background="
    value = f"{level.value:g}" if isinstance(level.value, (int, float)) else shown(level.value)
    return f" above the threshold {value} ({level.how}); try another threshold=, or invert=True"
