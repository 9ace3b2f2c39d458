r"""The hexagonal lattice inside of the outlines, and the triangles of its core, which need no triangulation.

In: the segments of the outlines and the pitch of the lattice. Out: the region of every node, the nodes near given points, and the
triangles of those nodes whose neighbourhood is complete: the *core*. They are equilateral, and written down directly, as a template: the
cost of a mesh is that of the strip along its outlines, as the core comes almost free.

Nodes are numbered row by row, rows of `width` and of `width - 1` nodes taking turns. Then the six neighbours of *every*
node lie at the same distances in the numbering, and work on triangles is work on shifted slices of flat arrays::

         f+w-1   f+w
            o-----o               w = width
           / \   / \
      f-1 o---- f ----o f+1       up triangle   f: (f, f+1, f+w)
           \   / \   /             down triangle f: (f+1, f+w+1, f+w)
            o-----o
          f-w   f-w+1
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints, Points, blocks, runs

Codes = NDArray[np.int32]  # of regions: small numbers, 0 for what is not meshed
ROW = 3**0.5 / 2  # distance of rows, in pitches
ROW_ROUNDING = 1e-6  # so that a shift of all points, which changes their last digits, does not add a row
MARGIN = 3  # empty nodes around everything, so that no slice runs from one end of a row into the next


@dataclass(frozen=True)
class Lattice:
    """Where the nodes of a hexagonal lattice lie.

    Attributes
    ----------
    origin
        Node 0, the lower left one.
    pitch
        Distance of neighbouring nodes.
    width
        Number of nodes in the even rows; odd rows have one less and lie half a pitch further right.
    rows
        Number of rows.
    node
        Where places are counted from, one of its nodes: that which windows of one image have in common, or node 0.
    """

    origin: complex
    pitch: float
    width: int
    rows: int
    node: complex

    @classmethod
    def over(cls, points: Points, pitch: float, shift: complex = 0, node: complex | None = None) -> Lattice:
        """Lay a lattice over all points, with a margin around them: centred up to a shift of at most half a pitch, or with a node there."""
        low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
        if node is not None:
            # As many pitches, and pairs of rows, from there.
            below = 2 * int(np.ceil(((node - low).imag / (ROW * pitch) + MARGIN) / 2))
            origin = node - pitch * complex(int(np.ceil((node - low).real / pitch)) + MARGIN, ROW * below)
            size = high - origin
            width, rows = int(np.ceil(size.real / pitch)) + MARGIN + 1, int(np.ceil(size.imag / (ROW * pitch))) + MARGIN + 1
            return cls(origin, pitch, width, rows, node)
        columns = int(np.ceil((high - low).real / pitch - ROW_ROUNDING)) + 2 * MARGIN
        rows = int(np.ceil((high - low).imag / (ROW * pitch) - ROW_ROUNDING)) + 2 * MARGIN
        centre = pitch * complex(columns / 2, ROW * rows / 2)
        origin = (low + high) / 2 - centre + shift * pitch
        return cls(origin, pitch, columns + 1, rows + 1, origin)

    @property
    def height(self) -> float:
        """Distance of rows."""
        return ROW * self.pitch

    @property
    def count(self) -> int:
        """Number of nodes, those of a last odd row filled up."""
        return (self.rows + 1) // 2 * (2 * self.width - 1)

    def start(self, row: Ints) -> Ints:
        """Return the first node of each row."""
        return row // 2 * (2 * self.width - 1) + row % 2 * self.width

    def positions(self, nodes: Ints, out: Points | None = None) -> Points:
        """Return the places of nodes, or write them to `out`."""
        places = np.zeros(len(nodes), np.complex128) if out is None else out
        for block in blocks(len(nodes)):
            pair, column = np.divmod(nodes[block], 2 * self.width - 1)
            odd = column >= self.width
            places.real[block] = (column - odd * (self.width - 0.5)) * self.pitch + self.origin.real
            places.imag[block] = (2 * pair + odd) * self.height + self.origin.imag
        return places

    def codes(self, points: Points, segments: Ints, left: Ints, right: Ints) -> Codes:
        """Find the region of every node: walking along a row, the code changes where the row crosses a segment (a scan conversion).

        A sum over the differences of codes is all that it takes: no sorting, no search, no test of points in polygons. For nodes
        *on* a segment either side is returned.
        """
        # The first row at or above each point; a segment crosses the rows from that of its lower to below that of its upper end.
        first = np.ceil((points.imag - self.origin.imag) / self.height).astype(np.int64)
        a, b = segments.T
        rising = first[b] > first[a]
        low, high = np.where(rising, a, b), np.where(rising, b, a)
        change = np.where(rising, right - left, left - right)
        crossed = first[high] - first[low]
        of, row = runs(crossed)
        row += first[low[of]]
        p, q = points[low[of]], points[high[of]]
        height = row * self.height + self.origin.imag
        x = p.real + (q.real - p.real) * (height - p.imag) / (q.imag - p.imag)
        column = np.ceil((x - self.origin.real) / self.pitch - 0.5 * (row % 2)).astype(np.int64)
        steps = np.zeros(self.count, np.int32)
        np.add.at(steps, self.start(row) + column, change[of].astype(np.int32))
        return np.cumsum(steps, dtype=np.int32)

    def near(self, centres: Points, radius: Floats) -> tuple[Ints, Ints]:
        """Return the nodes nearer than `radius` (below one pitch) to the centres, and to which of them; one may be near several."""
        around, found = np.arange(-1, 2)[:, None], [np.zeros((2, 0), np.int64)]
        for block in blocks(len(centres), 1 << 12):
            place = (centres[block] - self.origin) / self.pitch
            row = np.rint(place.imag / ROW).astype(np.int64) + around
            shift = 0.5 * (row % 2)
            column = np.rint(place.real - shift).astype(np.int64) + around[:, None]
            across, up = column + (shift - place.real), ROW * row - place.imag
            close = (across**2 + up**2 < (radius[block] / self.pitch) ** 2).nonzero()
            found.append(np.stack([(self.start(row) + column)[close], block.start + close[2]]))
        nodes, of = np.concatenate(found, axis=1)
        return nodes, of

    @property
    def neighbours(self) -> tuple[int, ...]:
        """How far the six neighbours of a node lie from it in the numbering."""
        w = self.width
        return -w, 1 - w, -1, 1, w - 1, w

    def eroded(self, codes: Codes) -> Codes:
        """Keep the codes of nodes whose six neighbours have the same code; 0 for the rest (morphological erosion)."""
        w, n = self.width, len(codes)
        inner = codes[w : n - w]
        same = np.ones(len(inner), bool)
        for step in self.neighbours:
            same &= codes[w + step : n - w + step] == inner
        result = np.zeros_like(codes)
        result[w : n - w] = inner * same
        return result

    def dilated(self, marked: Bools, times: int) -> Bools:
        """Mark the neighbours of marked nodes, and theirs, and so on (morphological dilation)."""
        w, n = self.width, len(marked)
        for _ in range(times):
            wider = marked.copy()
            for step in self.neighbours:
                wider[w : n - w] |= marked[w + step : n - w + step]
            marked = wider
        return marked

    def core(self, codes: Codes) -> Core:
        """Find the triangles whose three nodes have the same code, not 0."""
        w, n = self.width, len(codes)
        f, right, above, opposite = codes[: n - w - 1], codes[1 : n - w], codes[w : n - 1], codes[w + 1 :]
        shared = (right == above) & (right != 0)  # by the up and the down triangle of f
        return Core(self, codes, shared & (f == right), shared & (opposite == right))


@dataclass(frozen=True)
class Core:
    """The equilateral triangles of a lattice.

    Attributes
    ----------
    lattice, codes
        The lattice, and the region of its nodes.
    up, down
        Bool, whether up and down triangle f exist (see the drawing of the module).
    """

    lattice: Lattice
    codes: Codes
    up: Bools
    down: Bools

    def nodes(self) -> Bools:
        """Mark the nodes that are corners of triangles."""
        w, n = self.lattice.width, len(self.codes)
        used = np.zeros(n, bool)
        for triangles, corners in ((self.up, (0, 1, w)), (self.down, (1, w + 1, w))):
            for corner in corners:
                used[corner : corner + len(triangles)] |= triangles
        return used

    def rim(self) -> Ints:
        """Find the edges (k, 2) between these triangles and the rest, as pairs of nodes with the triangles on their left."""
        w = self.lattice.width
        edges = []
        # Every edge of the lattice has an up triangle on one side and a down triangle on the other: ends of the edge
        # as seen by the up triangle, and which down triangle is beyond.
        for start, stop, beyond in ((0, 1, -w), (1, w, 0), (w, 0, -1)):
            up, down = self.up[w:], self.down[w + beyond : len(self.down) + beyond]
            f = (up != down).nonzero()[0] + w
            edge = np.stack([f + start, f + stop], axis=1)
            turned = ~self.up[f]
            edge[turned] = edge[turned, ::-1]
            edges.append(edge)
        return np.concatenate(edges)

    def write(self, numbers: Ints, triangles: Ints, regions: Ints) -> None:
        """Write the triangles, with `numbers` for the nodes, and their regions into arrays of the right length."""
        w, done = self.lattice.width, 0
        for block in blocks(len(self.up)):
            for exist, corners in ((self.up, (0, 1, w)), (self.down, (1, w + 1, w))):
                f = exist[block].nonzero()[0] + block.start
                rows = slice(done, done + len(f))
                for k, corner in enumerate(corners):
                    triangles[rows, k] = numbers[f + corner]
                regions[rows] = self.codes[f + 1]
                done += len(f)

    def __len__(self) -> int:
        return int(np.count_nonzero(self.up)) + int(np.count_nonzero(self.down))
