"""One block of an image -> a piece of the mesh that fits those of its neighbours: the work of one task."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, cast

import numpy as np

from img2tri.arrays import Bools, Ints, Points, as_complex, as_rows
from img2tri.errors import Img2triError, MeshError
from img2tri.options.all_options import MeshOptions, of
from img2tri.options.mesh_options import FillOptions, OutlineOptions, SizeOptions
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes.conforming import conform, trace_outlines
from img2tri.recipes.wanted_sizes import wanted_sizes
from img2tri.tiles.block_plan import MARGIN_EDGES, SMOOTHED, Cell, Plan, colour
from img2tri.tiles.outline_posts import find_posts
from img2tri.tiles.piece_files import Lost, PieceStore, load_piece
from img2tri.tiles.seams.both_meshes import Territory
from img2tri.tiles.seams.join_blocks import merge
from img2tri.tiles.seams.outline_check import DenseOutlines
from img2tri.tiles.seams.piece_seams import Piece, SeamError, join_pieces
from img2tri.tiles.window_regions import WindowRegions
from img2tri.triangles.min_angle_tangents import smallest_angles
from img2tri.triangles.tools.topology import curve_edges
from img2tri.types import Frame, Outlines

GROSS = 1.0  # px beside twice the tolerance: what no outline of the mesh is off those of the image
POSTED = 0.75  # margins: how far from borders of blocks posts of outlines are
MARGIN_SCALES = (1, 2, 4)  # of the margin: where pieces do not fit, more is looked at and replaced


def mesh_block(plan: Plan, zones: WindowRegions, store: PieceStore, cell: Cell) -> dict[str, Any]:
    """Mesh a block, keep its piece, and return what is known of it; at once if it is there already.

    Parameters
    ----------
    plan, cell
        How the image is meshed, and which block.
    zones
        Function of rows and columns that returns the regions there.
    store
        Where the pieces of its neighbours are, and its own is kept.

    Raises
    ------
    Img2triError
        Names the block.
    """
    found = store.facts(cell)
    if found is not None:
        return found
    rows, columns = plan.window(cell, 0)
    try:
        piece, lost, facts = _fitting(plan, zones, store, cell)
        store.keep(cell, piece, lost, facts)
    except Img2triError as error:
        where = f"rows {rows.start} to {rows.stop}, columns {columns.start} to {columns.stop}"
        raise type(error)(f"{where}: {error}") from error
    return facts


def _fitting(plan: Plan, zones: WindowRegions, store: PieceStore, cell: Cell) -> tuple[Piece, Lost, dict[str, Any]]:
    near = [other for other in plan.neighbours(cell) if colour(other) < colour(cell)]
    loaded = [load_piece(store, plan, other, colour(cell)) for other in near]
    within = plan.frame.length("tolerance", plan.options["tolerance"]) / plan.frame.pixel
    problem: SeamError | None = None
    for scale in MARGIN_SCALES:
        rows, columns = plan.window(cell, scale * plan.margin + SMOOTHED)
        window = zones(rows, columns)
        mesh, outlines = window_mesh(window, plan, rows, columns)
        territory = plan.territory(cell, scale)
        parts = [_near(piece, territory) for piece, _ in loaded]
        finished = join_pieces([piece for piece, _ in parts])
        try:
            piece, replaced = merge(mesh, finished, territory, outlines, tolerance=within, min_angle=plan.options["min_angle"])
            distance = _distance(piece, outlines)
            if distance > GROSS + 2 * within:
                raise SeamError(f"an edge of the mesh is {distance:.3g} px off the outlines of the image")
        except SeamError as error:
            problem = SeamError(str(error), error.at)  # without its traceback, which would hold this window while the next is meshed
            del window, mesh, outlines, parts, finished
            continue
        lost: Lost = {}
        first = 0
        for other, (_, numbers), (_, kept) in zip(near, loaded, parts, strict=True):
            gone = replaced[first : first + len(kept)]
            first += len(kept)
            if gone.any():
                lost[other] = numbers[kept[gone]]
        facts = {
            "cell": list(cell),
            "scale": scale,
            "replaced": int(replaced.sum()),
            "distance": distance,
            "n_triangles": len(piece.triangles),
            "smallest_angle": float(smallest_angles(piece.vertices, piece.triangles).min(initial=180.0)),
            **_pixels(window, plan, cell, rows, columns),
        }
        return piece, lost, facts
    assert problem is not None, "there is a scale"
    at = f" at {as_rows(plan_world(plan, problem.at[:1]))[0].round(2).tolist()}" if len(problem.at) else ""
    raise MeshError(
        f"the mesh of this block and those of its neighbours could not be joined{at}: {problem}; "
        "try another edge_length or tolerance, or mesh_image(..., crop=) for the parts"
    ) from problem


def _near(piece: Piece, territory: Territory) -> tuple[Piece, Ints]:
    """Return the part of a finished piece that is near a block, and which triangles these are. Its own edge is too far away to matter."""
    close = territory.outside(piece.vertices) < 2 * territory.margin
    kept = np.flatnonzero(close[piece.triangles].all(axis=1))
    used = np.flatnonzero(close)
    local = np.cumsum(close) - 1
    seam = close[piece.seam].all(axis=1)
    part = Piece(piece.vertices[used], local[piece.triangles[kept]], piece.regions[kept], local[piece.seam[seam]], piece.beyond[seam])
    return part, kept


def _pixels(window: Segmentation, plan: Plan, cell: Cell, rows: slice, columns: slice) -> dict[str, Any]:
    """Count what the certificate of the whole is to be compared with: pixels, and the Euler number of a mask, by bit quads (Gray 1971)."""
    own = plan.window(cell, 0)
    (h, w), top, left = ((s.stop - s.start for s in own), own[0].start - rows.start, own[1].start - columns.start)
    labels = window.labels[top : top + h + 1, left : left + w + 1]
    if labels.dtype != bool:
        meshed = labels != window.background if window.background is not None else np.ones(labels.shape, bool)
        return {"pixels": int(meshed[:h, :w].sum()), "euler": None}
    m = labels
    across, down = m[:h, :-1] & m[:h, 1:], m[:-1, :w] & m[1:, :w]
    a, b, c, d = m[:-1, :-1], m[:-1, 1:], m[1:, :-1], m[1:, 1:]
    quads = int((a & b & c & d).sum())
    if plan.options["connectivity"] == 8:
        quads -= int(((a & d & ~b & ~c) | (b & c & ~a & ~d)).sum())
    pixels = int(m[:h, :w].sum())
    return {"pixels": pixels, "euler": pixels - int(across.sum()) - int(down.sum()) + quads}


def _distance(piece: Piece, outlines: DenseOutlines) -> float:
    """How far the boundary and interface edges of a piece are from the outlines of the image, px; edges of the seam are none."""
    n = len(piece.vertices)
    edges = curve_edges(piece.triangles, piece.regions) if len(piece.triangles) else np.zeros((0, 2), np.int64)
    inner = np.sort(piece.seam, axis=1)
    edges = edges[~np.isin(edges.min(axis=1) * n + edges.max(axis=1), inner[:, 0] * n + inner[:, 1])]
    return float(outlines.off(piece.vertices, edges).max(initial=0.0))


def plan_world(plan: Plan, places: Points) -> Points:
    """Places of the plane in the world."""
    world = plan.frame.world(as_rows(places))
    return np.asarray(world[:, 0] + 1j * world[:, 1])


def window_mesh(zones: Segmentation, plan: Plan, rows: slice, columns: slice) -> tuple[Piece, DenseOutlines]:
    """Mesh a window, and return the mesh in the plane of the whole image, with its dense outlines."""
    whole, o = plan.frame, cast(MeshOptions, plan.options)
    if zones.background is not None and not (zones.labels != zones.background).any():
        return Piece.empty(), DenseOutlines(np.zeros(0, np.complex128), np.zeros((0, 2), np.int64))
    frame = Frame(zones.labels.shape, whole.spacing, (0.0, 0.0), whole.upward)
    outlines, dual_edges = trace_outlines(zones, frame, connectivity=o["connectivity"], **of(OutlineOptions, o))
    lengths = of(SizeOptions, o)
    if isinstance(lengths["edge_length"], np.ndarray):
        lengths["edge_length"] = lengths["edge_length"][rows, columns]
    sizes = wanted_sizes(labels=zones.labels, dual_edges=dual_edges, frame=frame, **lengths)
    if sizes.field is not None:
        sizes = replace(sizes, longest=max(sizes.longest, plan.margin / MARGIN_EDGES))  # one lattice for all windows
    within = frame.length("tolerance", o["tolerance"]) / frame.pixel
    # The origin of the plane is where row 0 begins, or where the last row ends.
    shift = complex(*whole.plane(rows.stop if whole.upward else rows.start, columns.start))
    several = plan.grid != (1, 1)
    made = conform(
        outlines, dual_edges, sizes, corners=o["corners"], tolerance=within,
        node=-shift if several else None, posts=partial(_posts, plan, rows, columns, shift) if several else None, **of(FillOptions, o),
    )  # fmt: skip
    outlines = made.outlines or outlines
    none = np.zeros((0, 2), np.int64)
    piece = Piece(as_complex(made.vertices) + shift, made.triangles, outlines.labels[made.regions], none, none[:, 0])
    return piece, DenseOutlines(as_complex(outlines.points) + shift, outlines.segments[0])


def _posts(plan: Plan, rows: slice, columns: slice, shift: complex, outlines: Outlines) -> Bools:
    """Find posts on both sides of the borders of blocks that a window sees."""
    away = POSTED * plan.margin
    lines = []
    for part, (seen, pixels) in enumerate(((columns, plan.frame.shape[1]), (rows, plan.frame.shape[0]))):
        borders = np.arange(plan.block, pixels, plan.block)
        borders = borders[(borders > seen.start) & (borders < seen.stop)]
        places = plan.frame.plane(borders, np.zeros(len(borders))) if part else plan.frame.plane(np.zeros(len(borders)), borders)
        at = places[:, 1] - shift.imag if part else places[:, 0] - shift.real
        lines.append(np.concatenate([at - away, at + away]).tolist())
    return find_posts(outlines, shift, (lines[0], lines[1]), 2 * away)
