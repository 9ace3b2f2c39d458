"""Labels of pixels that differ from those of the image: runs by block, each in a file, laid over any window."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Ints, runs
from img2tri.tiles.whole_files import write


@dataclass(frozen=True)
class CleanedLabels:
    """What was changed.

    Attributes
    ----------
    folder
        Where the files are.
    block
        Side of the blocks they are for, px.
    """

    folder: Path
    block: int

    def add(self, cell: tuple[int, int], changed: Ints) -> None:
        """Add runs (n, 4) of a block: row, first column, number of pixels, label."""
        buffer = io.BytesIO()
        np.save(buffer, np.concatenate([self._of(cell), changed]))
        write(self._path(cell), buffer.getvalue())

    def over(self, labels: NDArray[Any], rows: slice, columns: slice) -> NDArray[Any]:
        """Return the labels of a window as they are now."""
        found = [self._of(cell) for cell in self._cells(rows, columns)]
        every = np.concatenate(found) if found else np.zeros((0, 4), np.int64)
        row, first, last = every[:, 0] - rows.start, every[:, 1] - columns.start, every[:, 1] + every[:, 2] - columns.start
        first, last = np.maximum(first, 0), np.minimum(last, labels.shape[1])
        seen = (row >= 0) & (row < labels.shape[0]) & (last > first)
        if not seen.any():
            return labels
        row, first, count, label = row[seen], first[seen], (last - first)[seen], every[seen, 3]
        fits = bool((label.astype(labels.dtype) == label).all())  # a background that did not occur may not fit the type
        result = labels.astype(labels.dtype if fits else np.int64, order="C")
        which, place = runs(count)
        result[row[which], first[which] + place] = label[which]  # of several the last counts
        return result

    def _cells(self, rows: slice, columns: slice) -> list[tuple[int, int]]:
        spans = [range(part.start // self.block, (part.stop - 1) // self.block + 1) for part in (rows, columns)]
        return [(i, j) for i in spans[0] for j in spans[1]]

    def _of(self, cell: tuple[int, int]) -> Ints:
        path = self._path(cell)
        return np.asarray(np.load(path)) if path.exists() else np.zeros((0, 4), np.int64)

    def _path(self, cell: tuple[int, int]) -> Path:
        return self.folder / f"cleaned-{cell[0]}-{cell[1]}.npy"
