"""The first pass over an image: what has to be known of the whole before any part of it can be meshed.

In: a source. Out: a frozen `Plan`, with the level that parts foreground and background, and the default edge length, and a hash of all
pixels. Each block gives a few numbers, which are added up.

Otsu's level comes from the sum of the histograms of all blocks, and is the same as that of the image in memory.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri import __version__
from img2tri.arrays import Bools
from img2tri.errors import ImageError, ParameterError, finite
from img2tri.options.all_options import OPTIONS, checked, plain
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.cropping import frame_within
from img2tri.raster.labels.otsu_threshold import otsu_class
from img2tri.raster.labels.segmentation import check_thresholdable
from img2tri.tiles.block_plan import Cell, Plan, planned, refuse_by_blocks
from img2tri.tiles.cleaning.cleaned_labels import CleanedLabels
from img2tri.tiles.pixel_source import PixelSource, digest
from img2tri.tiles.window_regions import rgb_to_labels
from img2tri.types import Frame

REFUSED = {
    "colors": "colours are counted in the whole image; labels=True takes each as it is, or mesh_image(..., blocks=True)",
    "absorb": "neighbours may be far away; clean the label map before, or mesh_image(..., blocks=True)",
    "page": "give the path of one plane, or an array",
}


def checked_options(options: dict[str, Any]) -> dict[str, Any]:
    """Return every option with its value, or say which an image by tiles cannot have."""
    o: dict[str, Any] = dict(checked(options, function="mesh_tiles"))
    for name, why in REFUSED.items():
        if o[name] != OPTIONS[name].default:
            raise ParameterError(f"{name}: expected to be left out for an image by tiles, found {o[name]!r}; {why}")
    refuse_by_blocks(o)
    if not (isinstance(o["labels"], bool) or o["labels"] is None) and o["background"] is None:
        raise ParameterError("background: expected a label for an image by tiles with a list of labels, found None")
    return o


def look(source: PixelSource, plan: Plan, cell: Cell) -> dict[str, Any]:
    """Find what there is to know of one block; of pixels that are there, `least` and what follows."""
    o, (rows, columns) = plan.options, plan.window(cell, 0)
    values, missing = source.read(rows, columns)
    found: dict[str, Any] = {"hash": digest(values, missing), "missing": 0 if missing is None else int(missing.sum())}
    if o["labels"]:
        return found | _labels_there(values, missing, o)
    if o["threshold"] is None and not found["missing"]:
        try:
            check_thresholdable(values)
        except ImageError as error:
            found["looks like labels"] = str(error)
    gray = values if values.ndim == 2 else to_gray(values)
    seen = gray.reshape(-1) if missing is None else gray[~missing]
    if not len(seen):
        return found
    found |= {"least": seen.min().item(), "greatest": seen.max().item()}
    if not np.isfinite([found["least"], found["greatest"]]).all():
        raise ImageError(
            f"image: expected finite values, found others in rows {rows.start} to {rows.stop}, columns {columns.start} to {columns.stop}"
        )
    found["ends"] = bool(((seen == seen.min()) | (seen == seen.max())).all())
    if gray.dtype.kind in "bu" and gray.dtype.itemsize <= 2:
        counts = np.bincount(seen.astype(np.uint16))
        found["counts"] = {int(i): int(counts[i]) for i in np.flatnonzero(counts)}
    elif o["threshold"] not in (None, "otsu"):
        found["meshed"] = int((seen > o["threshold"]).sum())
    else:
        raise ParameterError(f"threshold: expected a number for an image by tiles of {values.dtype}, found {o['threshold']!r}")
    return found


def _labels_there(values: NDArray[Any], missing: Bools | None, o: dict[str, Any]) -> dict[str, Any]:
    """Find what there is to know of labels."""
    if values.dtype.kind == "f" and (values != np.floor(values)).any():
        raise ImageError(
            f"labels: expected whole numbers, found {values[values != np.floor(values)][0]:g}; give a threshold for gray values"
        )
    if values.ndim == 3 and (values.dtype.kind != "u" or values.dtype.itemsize > 2):
        raise ImageError(f"labels: expected colours of uint8 or uint16, found {values.dtype}; scale them to 0..255 first")
    found: dict[str, Any] = {"hues": values.ndim == 3 and bool((values != values[..., :1]).any())}
    # Colours that are gray ones in this block are numbers of colours if the whole image has others.
    for hues in (False, True) if values.ndim == 3 else (False,):
        numbers = rgb_to_labels(values, hues=hues)
        meshed = np.isin(numbers, o["labels"]) if o["labels"] is not True else numbers != o["background"]
        meshed = np.broadcast_to(meshed, numbers.shape)
        found["meshed as colours" if hues else "meshed"] = int((meshed if missing is None else meshed & ~missing).sum())
    return found


def first_plan(source: PixelSource, options: dict[str, Any]) -> tuple[PixelSource, Plan]:
    """Return the part of an image to be meshed, and the plan as far as it is known before the pixels are."""
    o = checked_options(options)
    spacing = o["spacing"]
    if spacing == "file":
        raise ParameterError("spacing: expected numbers for an image by tiles, found 'file'")
    dx, dy = (1.0, 1.0) if spacing is None else (float(spacing),) * 2 if np.ndim(spacing) == 0 else (float(spacing[0]), float(spacing[1]))
    if o["width"] is not None:
        if spacing is not None:
            raise ParameterError(f"width: expected to be left out with the size of a pixel, which says it too, found spacing {spacing!r}")
        dx = dy = finite("width", o["width"], above=0) / source.shape[1]
    corner = (0.0, 0.0) if isinstance(o["origin"], str) else (float(o["origin"][0]), float(o["origin"][1]))
    whole = Frame(source.shape, (dx, dy), corner, upward=o["origin"] != "upper")
    frame, rows, columns = (whole, (0, 0), (0, 0)) if o["crop"] is None else frame_within(whole, o["crop"])
    part = source if o["crop"] is None else replace(source, box=(rows[0], columns[0], *frame.shape))
    return part, replace(planned(frame, o, math.prod(frame.shape)), options=o)


def decided(plan: Plan, source: PixelSource, found: list[dict[str, Any]], more: int = 0, cleaned: CleanedLabels | None = None) -> Plan:
    """Decide what holds for the whole image, from what was found in each block, in the order of the blocks.

    `more` pixels are in regions than in the image, as some were cleaned.
    """
    o, frame = plan.options, plan.frame
    gaps = any(f["missing"] for f in found)
    if o["labels"]:
        if gaps and o["background"] is None:
            raise ParameterError(
                "background: expected a label that pixels which are not there get, found None; give one that the image does not have, "
                "or mesh_image(..., blocks=True)"
            )
        hues, level = any(f["hues"] for f in found), None
        meshed, at = sum(f["meshed as colours" if hues else "meshed"] for f in found), ", only background; see background="
        made = planned(frame, o, meshed + more, gaps=gaps, hues=hues, cleaned=cleaned)
    else:
        if all("looks like labels" in f for f in found):
            raise ImageError(found[0]["looks like labels"])
        there = [f for f in found if "least" in f]
        if not there:
            raise ImageError("image: expected pixels that are there, found only NaN and no data")
        level, gray, place, how = _level(np.dtype(source.array.dtype), o["threshold"], there)
        if "counts" in there[0]:
            white = 0 if level is None else level
            meshed = sum(n for f in there for value, n in f["counts"].items() if value > white)
        else:
            meshed = sum(f["meshed"] for f in there)
        meshed = math.prod(frame.shape) - sum(f["missing"] for f in found) - meshed if o["invert"] else meshed
        made = planned(frame, o, meshed + more, level=level, gray=gray, place=place, gaps=gaps, cleaned=cleaned)
        at = f" above the threshold {level or 0:g} ({how}); try another threshold=, or invert=True"
    if meshed + more <= 0:
        at += f"; {-more} were removed as too small; lower min_area=" if more else ""
        raise ImageError(f"image: expected pixels to mesh, found none{at}")
    return made


def _level(dtype: np.dtype[Any], threshold: Any, found: list[dict[str, Any]]) -> tuple[float | None, bool, float | None, str]:
    """Find the level, whether gray values place the outlines, and at which value."""
    if dtype.kind == "b":
        return None, False, None, "mask"
    least, greatest = min(f["least"] for f in found), max(f["greatest"] for f in found)
    if "counts" in found[0]:
        two = all(set(f["counts"]) <= {least, greatest} for f in found)
    else:
        two = all(f["ends"] and {f["least"], f["greatest"]} <= {least, greatest} for f in found)
    if threshold not in (None, "otsu"):
        whole = dtype.kind in "iu"
        return float(threshold), not two, float(np.floor(threshold)) + 0.5 if whole else float(threshold), "given"
    if threshold is None and two:
        return (0.0, False, None, "uniform") if least == greatest else (float(least) / 2 + float(greatest) / 2, False, None, "middle")
    if least == greatest:
        raise ImageError(f"threshold: 'otsu' expected at least two values in the image, found only {least}")
    counts = np.zeros(65536)
    for f in found:
        for value, number in f["counts"].items():
            counts[value] += number
    return float(otsu_class(counts, counts * np.arange(len(counts)))), not two, None, "otsu"


def fingerprint(plan: Plan, found: list[dict[str, Any]]) -> str:
    """Return a hash of the options, the pixels and the version: what decides the bytes of the mesh."""
    decided_here = [plan.level, plan.gray, plan.place, plan.gaps, plan.hues]
    decides = [__version__, plan.frame.shape, plan.block, plan.margin, *decided_here, plain(plan.options, field=plan.lengths)]
    text = json.dumps([decides, [f["hash"] for f in found]], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
