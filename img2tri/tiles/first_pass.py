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

from img2tri import __version__
from img2tri.errors import ImageError, ParameterError
from img2tri.options.all_options import OPTIONS, checked, plain
from img2tri.raster.labels.otsu_threshold import otsu_class
from img2tri.tiles.block_plan import Cell, Plan, planned, refuse_by_blocks
from img2tri.tiles.pixel_source import PixelSource
from img2tri.types import Frame

REFUSED = {
    "crop": "slice the array instead",
    "min_area": "components may span tiles; clean the label map before",
    "largest": "components may span tiles; clean the label map before",
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
    """Find what there is to know of one block."""
    rows, columns = plan.window(cell, 0)
    values = source.read(rows, columns)
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise ImageError(
            f"image: expected finite values, found others in rows {rows.start} to {rows.stop}, columns {columns.start} to {columns.stop}"
        )
    found: dict[str, Any] = {"hash": source.digest(values), "least": values.min().item(), "greatest": values.max().item()}
    found["ends"] = int(((values == values.min()) | (values == values.max())).sum()) == values.size
    if plan.options["labels"]:
        picked = plan.options["labels"]
        meshed = np.isin(values, picked) if picked is not True else values != plan.options["background"]
        found["meshed"] = int(np.broadcast_to(meshed, values.shape).sum())
    elif values.dtype.kind in "bu" and values.dtype.itemsize <= 2:
        counts = np.bincount(values.reshape(-1).astype(np.uint16))
        found["counts"] = {int(i): int(counts[i]) for i in np.flatnonzero(counts)}
    elif plan.options["threshold"] not in (None, "otsu"):
        found["meshed"] = int((values > plan.options["threshold"]).sum())
    else:
        raise ParameterError(f"threshold: expected a number for an image by tiles of {values.dtype}, found {plan.options['threshold']!r}")
    return found


def first_plan(source: PixelSource, options: dict[str, Any]) -> Plan:
    """Return the plan as far as it is known before the pixels are."""
    o = checked_options(options)
    spacing = o["spacing"]
    if spacing == "file":
        raise ParameterError("spacing: expected numbers for an image by tiles, found 'file'")
    dx, dy = (1.0, 1.0) if spacing is None else (float(spacing),) * 2 if np.ndim(spacing) == 0 else (float(spacing[0]), float(spacing[1]))
    corner = (0.0, 0.0) if isinstance(o["origin"], str) else (float(o["origin"][0]), float(o["origin"][1]))
    frame = Frame(source.shape, (dx, dy), corner, upward=o["origin"] != "upper")
    return replace(planned(frame, o, math.prod(source.shape)), options=o)


def decided(plan: Plan, source: PixelSource, found: list[dict[str, Any]]) -> Plan:
    """Decide what holds for the whole image, from what was found in each block, in the order of the blocks."""
    o, frame = dict(plan.options), plan.frame
    level, gray, place, how = None, False, None, None
    if o["labels"]:
        meshed = sum(f["meshed"] for f in found)
    else:
        level, gray, place, how = _level(np.dtype(source.array.dtype), o["threshold"], found)
        if "counts" in found[0]:
            meshed = sum(
                n for f in found for value, n in f["counts"].items() if (level is None and value) or (level is not None and value > level)
            )
        else:
            meshed = sum(f["meshed"] for f in found)
        meshed = math.prod(frame.shape) - meshed if o["invert"] else meshed
    if not meshed:
        at = "" if level is None else f" above the threshold {level:g} ({how}); try another threshold=, or invert=True"
        raise ImageError(f"image: expected pixels to mesh, found none{at or ', only background; see background='}")
    return planned(frame, o, meshed, level=level, gray=gray, place=place)


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
    decides = [__version__, plan.frame.shape, plan.block, plan.margin, plan.level, plan.gray, plan.place, plain(plan.options)]
    text = json.dumps([decides, [f["hash"] for f in found]], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
