"""mesh_tiles: an image larger than memory -> a mesh in parts, block by block, on one process or a Dask cluster.

    survey    what holds for the whole: level, default edge length, a hash of the pixels          first_pass
    clean     specks dropped, holes filled, the largest components kept, if that is asked for     cleaning
    mesh      each block in its window, fitted to its neighbours', colour by colour               mesh_block, join_blocks
    seams     every seam edge has its partner; numbers of vertices                                vertex_numbers
    save      each part by the worker that joins its blocks                                       tile_part, part_files

Pieces are kept beside the output while the work is under way. A second run goes on where the first ended.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from img2tri.arrays import Floats, Ints
from img2tri.errors import FileError, integer
from img2tri.tiles.block_plan import Cell, Plan, colour
from img2tri.tiles.cleaning.clean_blocks import clean_blocks
from img2tri.tiles.first_pass import decided, fingerprint, first_plan, look
from img2tri.tiles.mesh_block import mesh_block
from img2tri.tiles.parts.overview_cells import OverviewCells, overview, overview_cells, overview_grid
from img2tri.tiles.parts.part_files import FORMATS, PartFiles, part_files
from img2tri.tiles.parts.tile_part import PartPlan, planned_parts, tile_part
from img2tri.tiles.parts.vertex_numbers import Seam, numbered_vertices, seam_of
from img2tri.tiles.parts.whole_report import added_up, block_facts, whole_report
from img2tri.tiles.piece_files import PieceFolder, PieceStore, load_piece
from img2tri.tiles.pixel_source import PixelSource, open_source
from img2tri.tiles.run_tasks import done
from img2tri.tiles.whole_files import write
from img2tri.tiles.window_regions import read_regions
from img2tri.types import Frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TilesProgress = Callable[[str, float], object]


@dataclass(frozen=True)
class TiledMesh:
    """A mesh in parts on disk.

    Attributes
    ----------
    path
        Where it is.
    n_vertices, n_triangles, n_parts
        Counts; a vertex on a seam counts once.
    report
        What is known of the whole, as plain data: options, counts, the worst angle, areas, the farthest edge from the outlines, seams,
        components less holes of a mask; `warnings` has one line for each promise that is not kept.
    frame
        Where the image lies.
    labels, angles
        The overview: rows and columns of cells, each at least two edges wide, with the label that has the largest area in it, and its
        smallest angle in degrees, NaN where there is no triangle.
    """

    path: Path
    n_vertices: int
    n_triangles: int
    n_parts: int
    report: dict[str, Any]
    frame: Frame
    labels: Ints
    angles: Floats

    def plot(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """Draw an overview: regions, and where the worst angles are; no edges, of which there may be too many.

        Parameters
        ----------
        path
            Where to write it, .png, .svg or .pdf; None: nowhere.
        """
        from img2tri.views.figures.overview import draw_overview

        return draw_overview(self.labels, self.angles, self.frame, path)


def mesh_tiles(
    source: Any,
    out: str | os.PathLike[str],
    *,
    tile: int = 2048,
    client: Any = None,
    progress: TilesProgress | None = None,
    **options: Any,
) -> TiledMesh:
    """Mesh an image that is larger than memory, in parts.

    Memory follows the block, 2048 px, not the image. The mesh is the same, bit for bit, whatever `tile`, the number of workers and the
    order of their work; it is another one than that of `mesh_image` near the borders of blocks, and as good.

    Parameters
    ----------
    source
        A path (.zarr and OME-Zarr, .npy, .h5, tiled .tif), or an array with ``shape``, ``dtype`` and slicing: `numpy.memmap`, zarr, h5py,
        dask, xarray. A mask, gray values or labels, (h, w), or colours (h, w, 3). Pixels that are NaN,
        masked or GDAL's "no data" are not meshed.
    out
        Where to write: ``mesh.zarr``, ``mesh.pvtu`` or ``mesh.vtkhdf``.
    tile
        About how many px of the image a part covers either way; whole blocks.
    client
        Of a Dask cluster, ``distributed.Client``, whose workers can read `source` and write beside `out`. None: this process does it all.
    progress
        What is called with the name of a stage and the fraction done, and ends the work if it raises.
    **options
        Those of `mesh_image`, but for those that take the image as a whole: an error says so.

    Returns
    -------
    TiledMesh

    Raises
    ------
    FileError, ImageError, ParameterError, MeshError
        As `mesh_image`; errors name the rows and columns. What is done stays, and the next run goes on from there.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> disc = np.hypot(*np.mgrid[-20:20, -20:20] + 0.5) < 15
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = mesh_tiles(disc, Path(folder) / "disc.zarr", edge_length=4)
    >>> made.n_parts, made.report["smallest_angle"] >= 30
    (1, True)
    """
    target, tile = Path(out), integer("tile", tile, least=1)
    if target.suffix.lower() not in FORMATS:
        raise FileError(f"{target}: expected a name that ends in {', '.join(FORMATS)}, found {target.suffix or 'none'!r}")
    if not target.parent.is_dir():
        raise FileError(f"{target}: expected an existing folder, found none at {target.parent}; make it first")
    tell = progress or (lambda *_: None)
    image, plan = first_plan(open_source(source), options)

    tell("survey", 0.0)
    cells = list(plan.cells())
    found = dict(done(client, "survey", look, _by_name(cells), (image, plan), lambda share: tell("survey", 0.1 * share)))
    in_order = [found[name] for name in _by_name(cells)]
    undecided, plan = plan, decided(plan, image, in_order)
    folder = _workplace(target, fingerprint(plan, in_order))
    cleaned, removed, more = clean_blocks(client, image, plan, folder, lambda _: tell("survey", 0.1))
    plan = decided(undecided, image, in_order, more, cleaned)
    store = PieceFolder(folder)

    facts: dict[str, dict[str, Any]] = {}
    cells = list(plan.cells())
    for one in range(4):
        those, before = _by_name(cell for cell in cells if colour(cell) == one), len(facts)

        def share(part: float, before: int = before, now: int = len(those)) -> None:
            tell("mesh", 0.1 + 0.8 * (before + part * now) / len(cells))

        facts.update(done(client, "mesh", _block, those, (image, plan, store), share))

    tell("seams", 0.9)
    seams = dict(done(client, "seams", _seam, _by_name(cells), (plan, store), lambda share: tell("seams", 0.9 + 0.05 * share)))
    numbering, total = numbered_vertices([seams[name][0] for name in _by_name(cells)])
    of_cell = dict(zip(cells, numbering, strict=True))
    known = {cell: seams[name][1] for name, cell in _by_name(cells).items()}
    seam_edges = sum(len(seam.edges) for seam, _ in seams.values()) // 2
    blocks = [facts[name] for name in _by_name(cells)]
    report = whole_report(plan, image.name, blocks, list(known.values()), total, seam_edges) | {"removed": removed}

    tell("save", 0.95)
    parts = {part.name: part for part in planned_parts(plan, tile, of_cell)}
    files = part_files(target, folder)
    tasks = {name: (part, added_up([known[cell] for cell in part.cells])) for name, part in parts.items()}
    try:
        files.begin(list(parts.values()))
        drawn = dict(done(client, "save", _save, tasks, (plan, store, files), lambda share: tell("save", 0.95 + 0.05 * share)))
        files.finish(list(parts.values()), report)
    except OSError as problem:
        raise FileError(f"{target}: cannot be written: {problem.strerror or problem}; what is done stays, run it again then") from problem
    shutil.rmtree(folder)
    tell("done", 1.0)
    seen = overview([drawn[name] for name in parts], overview_grid(plan)[1])
    return TiledMesh(target, total, report["n_triangles"], len(parts), report, plan.frame, *seen)


def _by_name(cells: Iterable[Cell]) -> dict[str, Cell]:
    """Blocks by the names of their tasks: row and column."""
    return {f"{i}-{j}": (i, j) for i, j in cells}


def _block(image: PixelSource, plan: Plan, store: PieceStore, cell: Cell) -> dict[str, Any]:
    return mesh_block(plan, partial(read_regions, image, plan), store, cell)


def _seam(plan: Plan, store: PieceStore, cell: Cell) -> tuple[Seam, dict[str, Any]]:
    piece = load_piece(store, plan, cell)[0]
    return seam_of(piece, plan, cell), block_facts(piece, plan)


def _save(plan: Plan, store: PieceStore, files: PartFiles, task: tuple[PartPlan, dict[str, Any]]) -> OverviewCells:
    wanted, facts = task
    part = tile_part(plan, store, wanted)
    files.write(part, wanted, facts)
    return overview_cells(part, plan)


def _workplace(target: Path, hashed: str) -> Path:
    """Make the folder for pieces; pieces of other options, pixels or versions go."""
    folder = target.with_name(f".{target.name}.work")
    note = folder / "made-from.json"
    if folder.exists() and not (note.exists() and json.loads(note.read_text())["sha256"] == hashed):
        shutil.rmtree(folder)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as problem:
        raise FileError(f"{folder}: cannot be made: {problem.strerror}") from problem
    write(note, json.dumps({"sha256": hashed}).encode())
    return folder
