"""Pieces that are kept while the work is under way: on disk, each a file that is whole or not there, or in memory.

Files are what a run leaves for the next, and one worker for another.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from img2tri.arrays import Ints
from img2tri.tiles.block_plan import Cell, Plan, colour
from img2tri.tiles.seams.piece_seams import Piece, without
from img2tri.tiles.whole_files import write

ARRAYS = ("vertices", "triangles", "regions", "seam", "beyond")
Lost = dict[Cell, Ints]
"""Which triangles of neighbours a piece has replaced."""


class PieceStore(Protocol):
    """Where the pieces of blocks are kept."""

    def facts(self, cell: Cell) -> dict[str, Any] | None:
        """Return what is known of a piece; None if it is not there."""

    def keep(self, cell: Cell, piece: Piece, lost: Lost, facts: dict[str, Any]) -> None:
        """Keep the piece of a block."""

    def piece(self, cell: Cell) -> Piece:
        """Return a piece as it was kept."""

    def lost(self, cell: Cell, other: Cell) -> Ints:
        """Return which triangles of another piece that of `cell` has replaced."""


@dataclass(frozen=True)
class PiecesInMemory:
    """Pieces kept in this process."""

    kept: dict[Cell, tuple[Piece, Lost, dict[str, Any]]] = field(default_factory=dict)

    def facts(self, cell: Cell) -> dict[str, Any] | None:
        """Return what is known of a piece; None if it is not there."""
        return self.kept[cell][2] if cell in self.kept else None

    def keep(self, cell: Cell, piece: Piece, lost: Lost, facts: dict[str, Any]) -> None:
        """Keep the piece of a block."""
        self.kept[cell] = piece, lost, facts

    def piece(self, cell: Cell) -> Piece:
        """Return a piece as it was kept."""
        return self.kept[cell][0]

    def lost(self, cell: Cell, other: Cell) -> Ints:
        """Return which triangles of another piece that of `cell` has replaced."""
        return self.kept[cell][1].get(other, np.zeros(0, np.int64))


@dataclass(frozen=True)
class PieceFolder:
    """Pieces kept as files of a folder."""

    folder: Path

    def facts(self, cell: Cell) -> dict[str, Any] | None:
        """Return what is known of a piece; None if it is not there."""
        if not self._path(cell).exists():
            return None
        with np.load(self._path(cell)) as file:
            facts: dict[str, Any] = json.loads(file["facts"].tobytes())
        return facts

    def keep(self, cell: Cell, piece: Piece, lost: Lost, facts: dict[str, Any]) -> None:
        """Keep the piece of a block."""
        buffer = io.BytesIO()
        arrays: dict[str, Any] = {name: getattr(piece, name) for name in ARRAYS}
        arrays["facts"] = np.frombuffer(json.dumps(facts, sort_keys=True).encode(), np.uint8)
        arrays |= {_lost_name(other): numbers for other, numbers in lost.items()}
        np.savez(buffer, **arrays)
        # For people: what a run has done so far can be looked at.
        write(self.folder / f"report-{cell[0]}-{cell[1]}.json", json.dumps(facts, sort_keys=True, indent=2).encode())
        write(self._path(cell), buffer.getvalue())

    def piece(self, cell: Cell) -> Piece:
        """Return a piece as it was kept."""
        with np.load(self._path(cell)) as file:
            return Piece(*(file[name] for name in ARRAYS))

    def lost(self, cell: Cell, other: Cell) -> Ints:
        """Return which triangles of another piece that of `cell` has replaced."""
        with np.load(self._path(cell)) as file:
            return np.asarray(file[_lost_name(other)] if _lost_name(other) in file else np.zeros(0, np.int64))

    def _path(self, cell: Cell) -> Path:
        return self.folder / f"piece-{cell[0]}-{cell[1]}.npz"


def _lost_name(cell: Cell) -> str:
    return f"lost_{cell[0]}_{cell[1]}"


def load_piece(store: PieceStore, plan: Plan, cell: Cell, before: int = 4) -> tuple[Piece, Ints]:
    """Return a piece without the triangles that neighbours of colours lower than `before` have replaced, and the numbers of those left."""
    piece = store.piece(cell)
    gone = np.zeros(len(piece.triangles), bool)
    for other in plan.neighbours(cell):
        if colour(cell) < colour(other) < before:
            gone[store.lost(other, cell)] = True
    return (without(piece, gone) if gone.any() else piece), np.flatnonzero(~gone)
