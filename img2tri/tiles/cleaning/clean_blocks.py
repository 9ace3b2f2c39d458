"""Specks dropped, holes filled, the largest components kept in an image by blocks, as `specks_and_holes` does in memory.

In each turn blocks give their components as a graph, the graph of the whole decides what becomes of each, and blocks write down the pixels
that change. What is held of the whole grows with the number of components, not with pixels.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from img2tri.arrays import Ints
from img2tri.raster.labels.specks_and_holes import Removed, added, area_in_pixels, cleaning_steps, numbers_after
from img2tri.tiles.block_plan import Cell, Plan
from img2tri.tiles.cleaning.cleaned_labels import CleanedLabels
from img2tri.tiles.cleaning.component_graph import BlockGraph, block_graph, whole_graph
from img2tri.tiles.pixel_source import PixelSource
from img2tri.tiles.run_tasks import done
from img2tri.tiles.whole_files import write
from img2tri.tiles.window_regions import read_regions


def clean_blocks(
    client: Any, image: PixelSource, plan: Plan, folder: Path, tell: Callable[[float], object]
) -> tuple[CleanedLabels | None, Removed, int]:
    """Clean the label map of an image, if options ask for it.

    Parameters
    ----------
    client
        Of a Dask cluster; None: this process.
    image, plan
        The image, and how its labels are found.
    folder
        Where what changes is kept; what an earlier run has finished is used again.
    tell
        Told the fraction done of each turn.

    Returns
    -------
    cleaned
        What has changed; None if nothing has.
    removed
        As from `clean`.
    more : int
        How many pixels more are in regions.
    """
    o, background = plan.options, _background(plan)
    specks, holes = (area_in_pixels(name, o[name], plan.frame) for name in ("min_area", "fill_holes"))
    steps = cleaning_steps(min_area=specks, fill_holes=holes, largest=o["largest"], background=background)
    removed, more, note = Removed(specks=0, holes=0, pixels=0, listed=[]), 0, folder / "cleaned.json"
    cleaned = CleanedLabels(folder, plan.block)
    if note.exists():
        removed, more = json.loads(note.read_text())
        return (cleaned if removed["pixels"] else None), removed, more
    for path in folder.glob("cleaned-*"):
        path.unlink()
    cells = {f"{i}-{j}": (i, j) for i, j in plan.cells()}
    changing = bool(steps)
    plan = replace(plan, cleaned=cleaned)
    while changing:
        changing = False
        for what, least in steps:
            found = dict(done(client, "components", _components, cells, (image, plan), tell))
            parts, at_frame, of_block = whole_graph({cell: found[name] for name, cell in cells.items()}, background, o["connectivity"])
            number = numbers_after(parts, what, least, background, o["connectivity"], partial(np.copy, at_frame))
            if (number == parts.number).all():
                continue
            changing, removed = True, added(removed, parts, number, plan.frame.shape[1])
            more += int(parts.area[(parts.number == 0) & (number != 0)].sum() - parts.area[(parts.number != 0) & (number == 0)].sum())
            tasks = {}
            for name, cell in cells.items():
                gone = np.flatnonzero((number != parts.number)[of_block[cell]])
                if len(gone):
                    tasks[name] = (cell, gone, parts.values[number[of_block[cell][gone]]])
            for _ in done(client, "clean", _written_down, tasks, (image, plan), tell):
                pass
    write(note, json.dumps([removed, more]).encode())
    return (cleaned if removed["pixels"] else None), removed, more


def _background(plan: Plan) -> int | None:
    found: int | None = plan.options["background"] if plan.options["labels"] else 0
    return found


def _components(image: PixelSource, plan: Plan, cell: Cell) -> BlockGraph:
    rows, columns = plan.window(cell, 0)
    zones = read_regions(image, plan, rows, columns)
    return block_graph(zones.labels, zones.background, plan.options["connectivity"], rows, columns, plan.frame.shape)[0]


def _written_down(image: PixelSource, plan: Plan, task: tuple[Cell, Ints, Ints]) -> None:
    """Write down the runs of the components of a block that get other labels."""
    cell, gone, became = task
    rows, columns = plan.window(cell, 0)
    zones = read_regions(image, plan, rows, columns)
    _, parts = block_graph(zones.labels, zones.background, plan.options["connectivity"], rows, columns, plan.frame.shape)
    new = np.zeros(len(parts.area), np.int64)
    changes = np.zeros(len(parts.area), bool)
    new[gone], changes[gone] = became, True
    run = np.flatnonzero(changes[parts.component])
    row, column = np.divmod(parts.start[run], zones.labels.shape[1])
    label = new[parts.component[run]]
    assert plan.cleaned is not None
    plan.cleaned.add(cell, np.stack([rows.start + row, columns.start + column, parts.length[run], label], axis=1))
