"""Pieces on disk, each a file that is whole or not there: what a run leaves for the next, and one worker for another."""

from __future__ import annotations

import io
import json
import os
import secrets
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from img2tri.arrays import Ints
from img2tri.errors import FileError
from img2tri.tiles.block_plan import Cell, Plan, colour
from img2tri.tiles.seams.piece_seams import Piece, without

ARRAYS = ("vertices", "triangles", "regions", "seam", "beyond")


def write(path: Path, data: bytes) -> None:
    """Write a file beside its place, and then put it there."""
    temporary = path.with_name(f".{path.name}-{secrets.token_hex(6)}")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as problem:
        raise FileError(f"{path}: cannot be written: {problem.strerror or problem}; what is done stays, run it again then") from problem
    finally:
        with suppress(OSError):
            temporary.unlink()


def packed(piece: Piece, facts: dict[str, Any], **more: Ints) -> bytes:
    """Turn a piece and what is known of it into bytes."""
    buffer = io.BytesIO()
    arrays = {name: getattr(piece, name) for name in ARRAYS}
    np.savez(buffer, facts=np.frombuffer(json.dumps(facts, sort_keys=True).encode(), np.uint8), **arrays, **more)  # type: ignore[arg-type]
    return buffer.getvalue()


def piece_path(folder: Path, cell: Cell) -> Path:
    """Where the piece of a block is kept."""
    return folder / f"piece-{cell[0]}-{cell[1]}.npz"


def facts_of(path: Path) -> dict[str, Any]:
    """Return what is known of a piece."""
    with np.load(path) as file:
        facts: dict[str, Any] = json.loads(file["facts"].tobytes())
    return facts


def lost_name(cell: Cell) -> str:
    """Return the name under which a piece keeps which triangles of a neighbour it has replaced."""
    return f"lost_{cell[0]}_{cell[1]}"


def load_piece(folder: Path, plan: Plan, cell: Cell, before: int = 4) -> tuple[Piece, Ints]:
    """Return a piece without the triangles that neighbours of colours lower than `before` have replaced, and the numbers of those left."""
    with np.load(piece_path(folder, cell)) as file:
        piece = Piece(*(file[name] for name in ARRAYS))
    left = np.ones(len(piece.triangles), bool)
    for other in plan.neighbours(cell):
        if colour(cell) < colour(other) < before:
            with np.load(piece_path(folder, other)) as file:
                if lost_name(cell) in file:
                    left[file[lost_name(cell)]] = False
    if not left.all():
        piece = without(piece, ~left)
    return piece, np.flatnonzero(left)
