"""What every block of an image is meshed by: options as numbers, the grid of blocks, and their order.

The image is cut into square blocks whose size follows from the options alone, never from the tile size, the number of workers, or chunks of
the source: so that none of these changes the mesh. Blocks have one of four colours, so that none touches one of its own::

    0 1 0 1      All blocks of a colour may be meshed at the same time. Each fits what
    2 3 2 3      its neighbours of lower colours have made.
    0 1 0 1
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from img2tri.arrays import Bools, Floats, Points
from img2tri.errors import ParameterError
from img2tri.options.all_options import OPTIONS
from img2tri.recipes.wanted_sizes import USUAL_TRIANGLES
from img2tri.tiles.cleaning.cleaned_labels import CleanedLabels
from img2tri.tiles.seams.both_meshes import Territory
from img2tri.tiles.seams.join_blocks import TAKEN
from img2tri.types import Frame

BLOCK_SIDE = 2048  # px, the least side of a block
MARGIN_EDGES = 8.0  # edge lengths: how far beyond its block a mesh is looked at, to fit those of the neighbours
SMOOTHED = 32  # px more, so that the ends of outlines at the frame of a window do not matter
LEAST_BLOCK = 4.0  # margins
DEFAULT_SHORTEST, DEFAULT_LONGEST = 4.0, 64.0  # px
LENGTH_OPTIONS = ("tolerance", "min_edge_length", "boundary_edge_length")
REFUSED_BY_BLOCKS = {
    "recipe": "the paper's recipes take the image as a whole",
    "periodic": "opposite sides are never in one window",
    "interior": "scattered points take the image as a whole",
    "smoothing": "smoothing moves all vertices at once",
    "symmetric": "both halves are never in one window",
}

Cell = tuple[int, int]


@dataclass(frozen=True)
class Plan:
    """How an image is meshed block by block.

    Attributes
    ----------
    frame
        Where the image lies.
    block
        Side of a block, px.
    margin
        px, in the plane.
    level, gray
        Values strictly greater are foreground; None for label maps. Whether gray values place the outlines, at `place`, or at the middle
        between both sides if that is None.
    cleaned
        Pixels whose labels are others than the image has, as specks were dropped or holes filled; None: none.
    gaps, hues
        Whether pixels are missing anywhere, and whether labels are colours other than gray ones.
    options
        All options in use, lengths as numbers in world units.
    """

    frame: Frame
    block: int
    margin: float
    level: float | None = None
    gray: bool = False
    place: float | None = None
    options: dict[str, Any] = field(default_factory=dict)
    gaps: bool = False
    hues: bool = False
    cleaned: CleanedLabels | None = None

    @property
    def lengths(self) -> Floats | None:
        """Edge lengths for each pixel, if they were given so."""
        given = self.options["edge_length"]
        return given if isinstance(given, np.ndarray) else None

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of blocks."""
        h, w = self.frame.shape
        return -(-h // self.block), -(-w // self.block)

    def cells(self) -> Iterator[Cell]:
        """All blocks, row by row."""
        rows, columns = self.grid
        return ((i, j) for i in range(rows) for j in range(columns))

    def in_order(self) -> Iterator[Cell]:
        """All blocks, colour by colour."""
        return (cell for one in range(4) for cell in self.cells() if colour(cell) == one)

    def neighbours(self, cell: Cell) -> list[Cell]:
        """Return the up to eight blocks around a block."""
        rows, columns = self.grid
        i, j = cell
        near = [(a, b) for a in range(i - 1, i + 2) for b in range(j - 1, j + 2)]
        return [(a, b) for a, b in near if (a, b) != cell and 0 <= a < rows and 0 <= b < columns]

    def window(self, cell: Cell, halo: float) -> tuple[slice, slice]:
        """Rows and columns of a block and so many px around it."""
        (h, w), (i, j), grown = self.frame.shape, cell, math.ceil(halo)
        rows = slice(max(0, i * self.block - grown), min(h, (i + 1) * self.block + grown))
        return rows, slice(max(0, j * self.block - grown), min(w, (j + 1) * self.block + grown))

    def territory(self, cell: Cell, scale: float) -> Territory:
        """Where the piece of a block may take triangles."""
        rows, columns = self.window(cell, 0)
        corners = self.frame.plane([rows.start, rows.stop], [columns.start, columns.stop])
        (x0, x1), (y0, y1) = np.sort(corners[:, 0]).tolist(), np.sort(corners[:, 1]).tolist()
        # Where the image ends, nothing lies outside.
        below, above = (cell[0] == 0, cell[0] == self.grid[0] - 1)[:: -1 if self.frame.upward else 1]
        x0, x1 = (-math.inf if cell[1] == 0 else x0), (math.inf if cell[1] == self.grid[1] - 1 else x1)
        y0, y1 = (-math.inf if below else y0), (math.inf if above else y1)
        margin = scale * self.margin
        step = self.frame.plane([0, self.block], [0, self.block])
        width, height = float(abs(step[1, 0] - step[0, 0])), float(abs(step[1, 1] - step[0, 1]))
        top = float(self.frame.plane(0, 0)[1])

        def outside(z: Points) -> Floats:
            across, up = np.maximum(x0 - z.real, z.real - x1), np.maximum(y0 - z.imag, z.imag - y1)
            return np.asarray(np.maximum(across, up))

        def takes(z: Points) -> Bools:
            # Its own block, and what blocks of lower colours have left.
            a = np.clip(np.abs(z.imag - top) // height, 0, self.grid[0] - 1).astype(np.int64)
            b = np.clip(z.real // width, 0, self.grid[1] - 1).astype(np.int64)
            lower = colour((a, b)) < colour(cell)
            return np.asarray(((a == cell[0]) & (b == cell[1]) | lower) & (outside(z) < TAKEN * margin))

        return Territory(outside, takes, margin)


def colour(cell: Any) -> Any:
    """One of four colours of a block, or of arrays of rows and columns."""
    return cell[0] % 2 * 2 + cell[1] % 2


def block_size(margin: float) -> int:
    """Return the side of a block, px: so large that a block has more inside than margins.

    Examples
    --------
    >>> block_size(64.0), block_size(600.0)
    (2048, 4096)
    """
    side = BLOCK_SIDE
    while side < LEAST_BLOCK * margin:
        side *= 2
    return side


def refuse_by_blocks(o: dict[str, Any]) -> None:
    """Refuse what an image cannot have that is meshed block by block."""
    for name, why in REFUSED_BY_BLOCKS.items():
        if o[name] != OPTIONS[name].default:
            raise ParameterError(f"{name}: expected to be left out for an image by blocks, found {o[name]!r}; {why}")
    if callable(o["edge_length"]):
        raise ParameterError(
            "edge_length: expected one length, lengths by label, or an array (h, w) of lengths for an image by blocks, found a function; "
            "give its values at all pixels, or mesh the image as a whole"
        )


def planned(frame: Frame, options: dict[str, Any], meshed: int, **decided: Any) -> Plan:
    """Return how an image is meshed of which so many pixels are; lengths become numbers in world units.

    `decided` are what else a plan has. The default edge length is that of an image in memory, but never so long that blocks of several
    would have to be larger.
    """
    o = dict(options)
    for name in LENGTH_OPTIONS:
        o[name] = None if o[name] is None else frame.length(name, o[name])
    if isinstance(o["edge_length"], dict):
        o["edge_length"] = {label: frame.length("edge_length", length) for label, length in o["edge_length"].items()}
        longest = max(o["edge_length"].values()) / frame.pixel
    elif isinstance(o["edge_length"], np.ndarray):
        if o["edge_length"].shape != frame.shape:
            raise ParameterError(
                f"edge_length: expected an array of shape {frame.shape}, that of the image, found {o['edge_length'].shape}"
            )
        longest = float(np.max(o["edge_length"])) / frame.pixel
    elif o["edge_length"] is not None:
        o["edge_length"] = frame.length("edge_length", o["edge_length"])
        longest = o["edge_length"] / frame.pixel
    else:
        area = meshed * math.prod(frame.spacing) / frame.pixel**2
        longest = max(DEFAULT_SHORTEST, math.sqrt(area / USUAL_TRIANGLES * 4 / math.sqrt(3)))
        if max(frame.shape) > BLOCK_SIDE:
            longest = min(longest, DEFAULT_LONGEST)
            o["edge_length"] = longest * frame.pixel
    margin = MARGIN_EDGES * longest
    return Plan(frame, block_size(margin), margin, options=o, **decided)
