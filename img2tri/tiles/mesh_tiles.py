"""mesh_tiles: an image larger than memory -> a mesh in parts, block by block, on one process or a Dask cluster.

    survey    what holds for the whole: level, default edge length, a hash of the pixels          first_pass
    mesh      each block in its window, fitted to its neighbours', colour by colour               mesh_block, join_blocks
    check     every seam edge has its partner; numbers of vertices                                vertex_numbers
    save      parts, one after the other                                                          save_parts

Pieces are kept beside the output while the work is under way. A second run goes on where the first ended.
"""

from __future__ import annotations

import json
import math
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from img2tri.arrays import Ints, as_rows
from img2tri.errors import FileError, Img2triError, integer
from img2tri.options.all_options import plain
from img2tri.tiles.block_plan import Cell, Plan, colour
from img2tri.tiles.first_pass import decided, fingerprint, first_plan, look
from img2tri.tiles.mesh_block import mesh_block
from img2tri.tiles.piece_files import PieceFolder, PieceStore, load_piece, write
from img2tri.tiles.pixel_source import PixelSource, open_source
from img2tri.tiles.save_parts import FORMATS, Part, save_parts
from img2tri.tiles.seams.piece_seams import Piece, Sides, join_pieces
from img2tri.tiles.vertex_numbers import global_numbers, numbered_vertices, seam_of
from img2tri.tiles.window_regions import read_regions
from img2tri.triangles.min_angle_tangents import smallest_angles

MOST_AREA_ERROR, FEW_PIXELS = 0.01, 16  # of the whole, but of no fewer pixels, as in the certificate of a mesh in memory
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
    """

    path: Path
    n_vertices: int
    n_triangles: int
    n_parts: int
    report: dict[str, Any]


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
    found = dict(_done(client, "survey", look, cells, (image, plan), lambda share: tell("survey", 0.1 * share)))
    in_order = [found[cell] for cell in cells]
    plan = decided(plan, image, in_order)
    folder = _workplace(target, fingerprint(plan, in_order))
    store = PieceFolder(folder)

    facts: dict[Cell, dict[str, Any]] = {}
    cells = list(plan.cells())
    for one in range(4):
        those = [cell for cell in cells if colour(cell) == one]
        done = len(facts)

        def share(part: float, before: int = done, now: int = len(those)) -> None:
            tell("mesh", 0.1 + 0.8 * (before + part * now) / len(cells))

        facts.update(_done(client, "mesh", _block, those, (image, plan, store), share))

    tell("seams", 0.9)
    seams = [seam_of(load_piece(store, plan, cell)[0], plan, cell) for cell in cells]
    numbers_of, total = numbered_vertices(seams)
    starts = np.cumsum([0, *(seam.triangles for seam in seams)])

    tell("save", 0.95)
    report: dict[str, Any] = {
        "options": plain(plan.options, field=plan.lengths),
        "level": plan.level, "source": image.name, "shape": plan.frame.shape, "block": plan.block,
        "n_vertices": total, "n_triangles": 0, "seam_edges": sum(len(seam.edges) for seam in seams) // 2, "smallest_angle": 180.0,
        "narrow": 0, "distance": max(f["distance"] for f in facts.values()) * plan.frame.pixel,
        "replaced": sum(f["replaced"] for f in facts.values()), "areas": {}, "boundary_edges": 0,
    }  # fmt: skip
    count, number_of = 0, {cell: k for k, cell in enumerate(cells)}

    def parts() -> Iterator[Part]:
        nonlocal count
        for name, some in _tiles(plan, tile):
            pieces, numbers, blocks = [], [], []
            for cell in some:
                k = number_of[cell]
                pieces.append(load_piece(store, plan, cell)[0])
                numbers.append(global_numbers(seams[k].count, seams[k].numbers, *numbers_of[k]))
                blocks.append((starts[k], seams[k].triangles))
            count += 1
            yield _part(name, pieces, numbers, np.array(blocks), plan, report)
        _judge(report, list(facts.values()), plan)

    save_parts(target, parts(), report)
    shutil.rmtree(folder)
    tell("done", 1.0)
    return TiledMesh(target, total, report["n_triangles"], count, report)


def _block(image: PixelSource, plan: Plan, store: PieceStore, cell: Cell) -> dict[str, Any]:
    return mesh_block(plan, partial(read_regions, image, plan), store, cell)


def _done(
    client: Any,
    name: str,
    function: Callable[..., Any],
    cells: list[Cell],
    shared: tuple[Any, ...],
    share: Callable[[float], object],
) -> Iterator[tuple[Cell, Any]]:
    """Run a function for each block, here or on a cluster; yield what it returns as it comes."""
    if client is None:
        for k, cell in enumerate(cells):
            share(k / len(cells))
            yield cell, function(*shared, cell)
        return
    from distributed import as_completed

    kept = client.scatter(shared, broadcast=True, hash=False)
    futures = {client.submit(_call, function, kept, cell, key=f"{name}-{cell[0]}-{cell[1]}-{id(kept)}", pure=False): cell for cell in cells}
    try:
        for k, future in enumerate(as_completed(futures)):
            share(k / len(cells))
            try:
                yield futures[future], future.result()
            except Img2triError:
                raise
            except Exception as problem:  # a worker that is lost again and again, or a cluster that closes
                i, j = futures[future]
                raise FileError(f"block in row {i}, column {j}: {type(problem).__name__}: {problem}; what is done stays") from problem
    finally:
        client.cancel(list(futures))


def _call(function: Callable[..., Any], shared: tuple[Any, ...], cell: Cell) -> Any:
    return function(*shared, cell)


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


def _tiles(plan: Plan, tile: int) -> Iterator[tuple[str, list[Cell]]]:
    """Blocks by tile, with the name of each."""
    side = max(1, round(tile / plan.block))
    rows, columns = plan.grid
    for i in range(0, rows, side):
        for j in range(0, columns, side):
            inside = [(a, b) for a in range(i, min(rows, i + side)) for b in range(j, min(columns, j + side))]
            yield f"{i // side}-{j // side}", inside


def _part(name: str, pieces: list[Piece], numbers: list[Ints], blocks: Ints, plan: Plan, report: dict[str, Any]) -> Part:
    """Join the blocks of a tile, and add what is known of it to the report."""
    piece = join_pieces(pieces) if len(pieces) > 1 else pieces[0]
    number = numbers[0]
    if len(pieces) > 1:
        number = np.zeros(len(piece.vertices), np.int64)
        for one, its in zip(pieces, numbers, strict=True):
            number[np.searchsorted(piece.vertices, one.vertices)] = its
    a, b, c = piece.vertices[piece.triangles].T
    area = ((b - a).conj() * (c - a)).imag / 2 * plan.frame.pixel**2
    angles = smallest_angles(piece.vertices, piece.triangles)
    report["n_triangles"] += len(piece.triangles)
    report["boundary_edges"] += len(Sides.of(piece.triangles, len(piece.vertices)).bare()[0]) - len(piece.seam)
    report["smallest_angle"] = min(report["smallest_angle"], float(angles.min(initial=180.0)))
    report["narrow"] += int((angles < plan.options["min_angle"] - 1e-9).sum())
    labels, which = np.unique(piece.regions, return_inverse=True)
    for label, found in zip(labels.tolist(), np.bincount(which, area, len(labels)).tolist(), strict=True):
        report["areas"][label] = report["areas"].get(label, 0.0) + found
    return Part(name, plan.frame.world(as_rows(piece.vertices)), piece.triangles, piece.regions, number, blocks)


def _judge(report: dict[str, Any], facts: list[dict[str, Any]], plan: Plan) -> None:
    """Compare the whole with the image, and warn of each promise that is not kept."""
    frame, warnings = plan.frame, []
    image, mesh = sum(f["pixels"] for f in facts) * math.prod(frame.spacing), sum(report["areas"].values())
    report["area"] = {"mesh": mesh, "image": image, "error": mesh / image - 1}
    if not plan.options["labels"]:
        # Components less holes: vertices - edges + triangles.
        edges = (3 * report["n_triangles"] + report["boundary_edges"]) // 2
        report["euler"] = {"mesh": report["n_vertices"] - edges + report["n_triangles"], "image": sum(f["euler"] for f in facts)}
        if report["euler"]["mesh"] != report["euler"]["image"]:
            warnings.append(f"components less holes: {report['euler']['mesh']}, expected {report['euler']['image']}")
    if report["distance"] > plan.options["tolerance"] * (1 + 1e-9):
        warnings.append(f"the mesh is {report['distance']:.4g} off the outlines, tolerance {plan.options['tolerance']:.4g}")
    if report["narrow"]:
        warnings.append(
            f"{report['narrow']} triangles below {plan.options['min_angle']:g} degrees, the worst {report['smallest_angle']:.4g}"
        )
    if abs(report["area"]["error"]) > MOST_AREA_ERROR and sum(f["pixels"] for f in facts) > FEW_PIXELS:
        warnings.append(f"the area is off by {100 * report['area']['error']:.2g} %")
    report["warnings"] = warnings
