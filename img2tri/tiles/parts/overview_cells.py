"""A part of a mesh -> its cells of the overview picture: the label with the largest area, and the smallest angle, in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Floats, Ints, as_complex
from img2tri.tiles.block_plan import MARGIN_EDGES, Plan
from img2tri.tiles.parts.tile_part import Part
from img2tri.triangles.min_angle_tangents import smallest_angles

ACROSS = 1000  # cells at most
EDGES_IN_CELL = 2.0  # so that no cell inside of the mesh is without triangles


@dataclass(frozen=True, eq=False)
class OverviewCells:
    """Cells of an overview that have triangles.

    Attributes
    ----------
    cells
        (c,) int64, row by row.
    labels, areas
        (c,) the label with the largest area there, and that area.
    angles
        (c,) float64, the smallest angle, degrees.
    """

    cells: Ints
    labels: Ints
    areas: Floats
    angles: Floats


def overview_grid(plan: Plan) -> tuple[float, tuple[int, int]]:
    """Return the side of a cell, in pixels of the image, and the rows and columns of cells."""
    h, w = plan.frame.shape
    side = max(max(h, w) / ACROSS, EDGES_IN_CELL * plan.margin / MARGIN_EDGES)
    return side, (int(np.ceil(h / side)), int(np.ceil(w / side)))


def overview_cells(part: Part, plan: Plan) -> OverviewCells:
    """Sum up the triangles of a part by cells; a triangle is where its middle is."""
    side, (rows, columns) = overview_grid(plan)
    z = as_complex(part.vertices)
    a, b, c = z[part.triangles].T
    middle = part.vertices[part.triangles].mean(axis=1)
    (dx, dy), (x, y) = plan.frame.spacing, plan.frame.corner
    row = (middle[:, 1] - y) / dy
    row = plan.frame.shape[0] - row if plan.frame.upward else row
    at = np.clip(row // side, 0, rows - 1) * columns + np.clip((middle[:, 0] - x) / dx // side, 0, columns - 1)
    labels, code = np.unique(part.regions, return_inverse=True)
    size = max(1, len(labels))
    key, which = np.unique(at.astype(np.int64) * size + code, return_inverse=True)
    area = np.asarray(np.bincount(which, ((b - a).conj() * (c - a)).imag / 2, len(key)), np.float64)
    angle = np.full(len(key), 180.0)
    np.minimum.at(angle, which, smallest_angles(z, part.triangles))
    return _largest(OverviewCells(key // size, labels[key % size], area, angle))


def overview(parts: Sequence[OverviewCells], shape: tuple[int, int]) -> tuple[Ints, Floats]:
    """Join the cells of all parts: labels (h, w), and smallest angles (h, w), NaN where there are no triangles."""
    every = _largest(OverviewCells(*(np.concatenate([getattr(p, name) for p in parts]) for name in ("cells", "labels", "areas", "angles"))))
    labels, angles = np.zeros(shape, np.int64), np.full(shape, np.nan)
    labels.reshape(-1)[every.cells], angles.reshape(-1)[every.cells] = every.labels, every.angles
    return labels, angles


def _largest(some: OverviewCells) -> OverviewCells:
    """Keep of each cell the label with the largest area, and the smallest of all angles."""
    order = np.lexsort((some.labels, -some.areas, some.cells))
    first = np.flatnonzero(np.diff(some.cells[order], prepend=-1))
    angles = np.minimum.reduceat(some.angles[order], first) if len(first) else some.angles
    best = order[first]
    return OverviewCells(some.cells[best], some.labels[best], some.areas[best], angles)
