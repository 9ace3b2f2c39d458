"""Poisson-disk points inside a region: the region and its boundary points in, points at least a distance apart out.

Section II-C of the paper, Algorithm 1, `poisson_disk_sampling` in its listing: throw a dart at random; keep it if it hits the region
further than `min_distance` from all kept points and further than `min_distance_to_boundary` from all boundary points. The listing
compares each dart with every point, and never ends when the points wanted do not fit. Here

- a background grid, whose cells hold one point at most, leaves 24 cells to look at, and darts are settled in batches;
- darts are thrown only where there may be room (`active_cells`): after each round, squares that have none are dropped and the others
  split in four. When no square is left the region is full: that is proved then, not guessed from many misses.

The second is the idea of Ebeida, Mitchell, Patney, Davidson and Owens, "A simple algorithm for maximal Poisson-disk sampling in high
dimensions", Computer Graphics Forum 31 (2012), https://doi.org/10.1111/j.1467-8659.2012.03059.x.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from shapely import MultiPolygon, Polygon

from img2tri.arrays import Floats, Ints, Points
from img2tri.errors import ParameterError, finite, integer
from img2tri.paper.active_cells import ROUND_OFF, Domain, Squares

DISTANCE_PER_EDGE = 0.77  # min_distance for edges of length 1: in a full region the mean edge is 1.3 times the distance
MOST_DISTANCE = 1e100  # distances whose squares are numbers too
BATCHES = 4  # in which the cells get their first dart: the fewer at a time, the fewer get in each other's way
DEPTH = 20  # how often a cell is split at most: down to a millionth of min_distance
MOST_CELLS = 2**25  # of the grid, which then takes 0.7 GB
CHUNK = 2**12  # darts looked at together: their surroundings fit in the cache


def poisson_disk(
    region: Polygon | MultiPolygon | ArrayLike,
    boundary_points: ArrayLike,
    *,
    min_distance: float,
    min_distance_to_boundary: float,
    n_points: int | None = None,
    seed: int = 0,
) -> Floats:
    """Throw darts into a region, keeping those far enough from each other and from the boundary points.

    Both distances are kept exactly: no two points are `min_distance` or less apart, none is `min_distance_to_boundary` or less
    from a boundary point. It always ends: with `n_points` points, or with as many as fit by chance before the region is full.

    Parameters
    ----------
    region
        A valid polygon or multipolygon, holes included; or the corners (k, 2) of one ring.
    boundary_points
        (b, 2), points to keep away from; may be empty.
    min_distance
        Least distance between points. In a full region neighbours are 1 to 2 times that apart, on average 1.3 times.
        Less than an eighth of ``sqrt(area / n_points)`` is taken as that much, so that the grid grows with `n_points` only.
    min_distance_to_boundary
        Least distance to the boundary points; 0 for none. The boundary itself is kept away from only as far as its points reach.
    n_points
        How many points are wanted; None for as many as fit.
    seed
        Same seed, same points.

    Returns
    -------
    (n, 2) float64
        In the order in which the darts were kept. Its length says how many fitted.

    Raises
    ------
    ParameterError
        When an option has a value it cannot have, or `min_distance` is so small that the grid would not fit in memory.

    Notes
    -----
    Algorithm 1 of the paper, with its d_min, d_boundary and num_samples. A full region has 0.69 points per square of `min_distance`.

    Examples
    --------
    >>> square = [[0, 0], [10, 0], [10, 10], [0, 10]]
    >>> len(poisson_disk(square, square, min_distance=1, min_distance_to_boundary=1, n_points=20))
    20
    >>> len(poisson_disk(square, square, min_distance=30, min_distance_to_boundary=1, n_points=20))
    1
    """
    domain = Domain.of(region, boundary_points, finite("min_distance_to_boundary", min_distance_to_boundary, least=0, most=MOST_DISTANCE))
    distance = finite("min_distance", min_distance, least=0, most=MOST_DISTANCE)
    wanted = math.inf if n_points is None else integer("n_points", n_points)
    rng = np.random.default_rng(integer("seed", seed))
    if wanted == 0 or domain.polygon.area == 0:
        return np.zeros((0, 2))
    grid = _Grid.over(domain, max(distance, math.sqrt(domain.polygon.area / wanted) / 8))
    points = np.concatenate([np.zeros(0, np.complex128), *_rounds(domain, grid, rng, wanted)])
    return np.stack([points.real, points.imag], axis=1)


def _rounds(domain: Domain, grid: _Grid, rng: np.random.Generator, wanted: float) -> Iterator[Points]:
    """Throw round after round, giving out the darts kept, until there are enough or there is no room left."""
    squares = Squares.one(grid.size * 2**grid.levels)
    for _ in range(grid.levels):
        squares = domain.with_room(squares.split())
    # The squares are the cells of the grid, and parts of these from the second round on.
    for depth in range(DEPTH + 1):
        batches = BATCHES if depth == 0 else 1
        turns = rng.integers(batches, size=len(squares))
        for turn in range(batches):
            # One dart into each square.
            chosen = squares.only(turns == turn)
            darts = domain.places(chosen, rng.random(len(chosen)) + 1j * rng.random(len(chosen)))
            cells = grid.cells(chosen, depth)
            good = np.flatnonzero(domain.accepts(darts, chosen))
            good = rng.permutation(good[grid.uncovered(darts[good], cells[good])])
            kept = good[grid.independent(darts[good], cells[good])]
            kept = kept[: int(min(wanted, len(kept)))]
            grid.points[cells[kept]] = darts[kept]
            wanted -= len(kept)
            yield darts[kept]
            if wanted == 0:
                return
        # A cell that holds a point has no room. The others in four; of these, what one disc covers or is out of bounds has none.
        squares = squares.only(np.isinf(grid.points[grid.cells(squares, depth)])).split()
        squares = squares.only(grid.uncovered(domain.places(squares, 0.5 + 0.5j), grid.cells(squares, depth + 1), squares.size / 2))
        squares = domain.with_room(squares)
        if len(squares) == 0:
            return


@dataclass(frozen=True, eq=False)
class _Grid:
    """The background grid: square cells with a margin of two empty ones on all sides, row by row.

    A cell is min_distance / sqrt(2) wide: two points in one would be too close, and a disc reaches into the second at most.

    `points` holds the place of the point in each cell, infinity for none; `claims` the numbers of darts while they are settled;
    `steps` leads from a cell to the 24 around it, nearest first. A square of ``2**levels`` cells a side covers the region.
    """

    points: Points
    claims: NDArray[np.int32]
    steps: Ints
    stride: int
    levels: int
    size: float
    distance: float

    @classmethod
    def over(cls, domain: Domain, distance: float) -> _Grid:
        left, bottom, right, top = domain.polygon.bounds
        width, height = right - left, top - bottom
        least = math.sqrt(2 * width * height / MOST_CELLS)
        if distance < least:
            raise ParameterError(f"min_distance: expected at least {least:.3g} for a region {width:g} x {height:g}, found {distance:g}")
        size = distance / math.sqrt(2)
        wide, high = int(width / size) + 2, int(height / size) + 2  # one more for rounding, one for a point on the upper bound
        stride, n = wide + 4, (wide + 4) * (high + 4)
        around = sorted(((j, i) for j in range(-2, 3) for i in range(-2, 3) if (j, i) != (0, 0)), key=lambda s: s[0] ** 2 + s[1] ** 2)
        steps = np.array([j * stride + i for j, i in around])
        levels = math.ceil(math.log2(max(wide, high)))
        return cls(np.full(n, np.inf, np.complex128), np.full(n, -1, np.int32), steps, stride, levels, size, distance)

    def cells(self, squares: Squares, depth: int) -> Ints:
        """Name the cell that each square, split `depth` times, is part of."""
        return ((squares.row >> depth) + 2) * self.stride + (squares.column >> depth) + 2

    def uncovered(self, centres: Points, cells: Ints, half: float = 0.0) -> Ints:
        """Find the squares of side 2 * half, in `cells` without points, that no disc covers altogether; for half = 0, the places."""
        slack = ROUND_OFF if half else 1.0
        found = [np.zeros(0, np.int64)]
        for start in range(0, len(cells), CHUNK):
            left = np.arange(start, min(start + CHUNK, len(cells)))
            for steps in (self.steps[:4], self.steps[4:12], self.steps[12:]):  # the nearest decide most
                around = cells[left] + steps[:, None]
                dx = np.abs(self.points.real[around] - centres.real[left]) + half
                dy = np.abs(self.points.imag[around] - centres.imag[left]) + half
                left = left[np.sqrt(dx * dx + dy * dy).min(axis=0) * slack > self.distance]
            found.append(left)
        return np.concatenate(found)

    def independent(self, darts: Points, cells: Ints) -> Ints:
        """Find the darts of a batch that stay when they come one after another, and each drives off later ones that are too close."""
        # Only one dart in each cell is let in, the first: of several numbers written to one place the last stays.
        number = np.arange(len(darts))
        self.claims[cells[::-1]] = number[::-1]
        out = self.claims[cells] != number
        # Pairs of darts that are too close, found once from either side.
        pairs = [np.zeros((2, 0), np.int64)]
        for start in range(0, len(darts), CHUNK):
            some = start + np.flatnonzero(~out[start : start + CHUNK])
            other = self.claims[cells[some] + self.steps[self.steps > 0][:, None]]
            step, k = np.nonzero(other >= 0)
            one, two = some[k], other[step, k].astype(np.int64)
            gap = darts[two] - darts[one]
            near = np.sqrt(gap.real**2 + gap.imag**2) <= self.distance
            pairs.append(np.stack([one[near], two[near]]))
        self.claims[cells] = -1
        earlier, later = np.sort(np.concatenate(pairs, axis=1), axis=0)
        # A dart stays when no earlier one still in play is too close; the later ones too close to it are out then.
        while len(earlier):
            stays = ~out
            stays[later] = False
            out[later[stays[earlier]]] = True
            in_play = ~(out[earlier] | out[later])
            earlier, later = earlier[in_play], later[in_play]
        return np.flatnonzero(~out)
