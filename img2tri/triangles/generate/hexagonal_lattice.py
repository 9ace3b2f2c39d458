r"""The hexagonal lattice inside of the outlines, and the triangles of its depth, which need no triangulation.

In: the network of outlines and the pitch of the lattice. Out: the region of every node, nodes near given points cleared away, and the
triangles of those nodes whose neighbourhood is complete. They are equilateral, and written down directly: the cost of
a mesh is that of the band along its outlines, as the depth comes almost free.

Nodes are numbered row by row, rows of `width` and of `width - 1` nodes taking turns. Then the six neighbours of *every*
node lie at the same distances in the numbering, and work on triangles is work on shifted slices of flat arrays::

         f+w-1   f+w
            o-----o               w = width
           / \   / \
      f-1 o---- f ----o f+1       up triangle   f: (f, f+1, f+w)
           \   / \   /             down triangle f: (f+1, f+w+1, f+w)
            o-----o
          f-w   f-w+1

Points are complex numbers, x + iy, here and in all of the mesh stage: turning, scaling and shifting are one operation each.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from img2tri.types import Bools, Floats, Ints

Complex = NDArray[np.complex128]
Labels = NDArray[np.int32]
ROW = 3**0.5 / 2  # distance of rows, in pitches
ROUNDING = 1e-6  # so that a shift of all points, which changes their last digits, does not add a row
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
    """

    origin: complex
    pitch: float
    width: int
    rows: int

    @classmethod
    def over(cls, points: Complex, pitch: float, shift: complex = 0) -> Lattice:
        """Lay a lattice over all points, with a margin around them, centred up to a shift of at most half a pitch."""
        low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
        columns = int(np.ceil((high - low).real / pitch - ROUNDING)) + 2 * MARGIN
        rows = int(np.ceil((high - low).imag / (ROW * pitch) - ROUNDING)) + 2 * MARGIN
        centre = pitch * complex(columns / 2, ROW * rows / 2)
        return cls((low + high) / 2 - centre + shift * pitch, pitch, columns + 1, rows + 1)

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

    def positions(self, nodes: Ints, out: Complex | None = None) -> Complex:
        """Return the places of nodes, or write them to `out`."""
        places = np.zeros(len(nodes), np.complex128) if out is None else out
        for block in blocks(len(nodes)):
            pair, column = np.divmod(nodes[block], 2 * self.width - 1)
            odd = column >= self.width
            places.real[block] = (column - odd * (self.width - 0.5)) * self.pitch + self.origin.real
            places.imag[block] = (2 * pair + odd) * self.height + self.origin.imag
        return places

    def labels(self, points: Complex, segments: Ints, left: Ints, right: Ints) -> Labels:
        """Find the region of every node: walking along a row, the label changes where the row crosses a segment.

        A sum over the differences of labels is all that it takes: no sorting, no search, no test of points in polygons. For nodes
        *on* a segment either side is returned.
        """
        # The first row at or above each point; a segment crosses the rows from that of its lower to below that of its upper end.
        first = np.ceil((points.imag - self.origin.imag) / self.height).astype(np.int64)
        a, b = segments.T
        rising = first[b] > first[a]
        low, high = np.where(rising, a, b), np.where(rising, b, a)
        change = np.where(rising, right - left, left - right)
        crossed = first[high] - first[low]
        of = np.repeat(np.arange(len(segments)), crossed)
        row = np.arange(len(of)) - np.repeat(np.cumsum(crossed) - crossed, crossed) + first[low[of]]
        p, q = points[low[of]], points[high[of]]
        height = row * self.height + self.origin.imag
        x = p.real + (q.real - p.real) * (height - p.imag) / (q.imag - p.imag)
        column = np.ceil((x - self.origin.real) / self.pitch - 0.5 * (row % 2)).astype(np.int64)
        steps = np.zeros(self.count, np.int32)
        np.add.at(steps, self.start(row) + column, change[of].astype(np.int32))
        return np.cumsum(steps, dtype=np.int32)

    def around(self, centres: Complex, radius: Floats) -> Ints:
        """Return the nodes nearer than `radius` (below one pitch) to the centres; one may be returned twice."""
        place = (centres - self.origin) / self.pitch
        near = []
        for up in (-1, 0, 1):
            row = np.rint(place.imag / ROW).astype(np.int64) + up
            shift = 0.5 * (row % 2)
            for right in (-1, 0, 1):
                column = np.rint(place.real - shift).astype(np.int64) + right
                close = np.abs(column + shift + 1j * ROW * row - place) * self.pitch < radius
                near.append((self.start(row) + column)[close])
        return np.concatenate(near)

    def eroded(self, labels: Labels) -> Labels:
        """Keep the labels of nodes whose six neighbours have the same label; 0 for the rest."""
        w, n = self.width, len(labels)
        inner = labels[w : n - w]
        same = np.ones(len(inner), bool)
        for offset in (-w, 1 - w, -1, 1, w - 1, w):
            same &= labels[w + offset : n - w + offset] == inner
        result = np.zeros_like(labels)
        result[w : n - w] = inner * same
        return result

    def grown(self, marked: Bools, times: int) -> Bools:
        """Mark the neighbours of marked nodes, and theirs, and so on."""
        w, n = self.width, len(marked)
        for _ in range(times):
            wider = marked.copy()
            for offset in (-w, 1 - w, -1, 1, w - 1, w):
                wider[w : n - w] |= marked[w + offset : n - w + offset]
            marked = wider
        return marked

    def depth(self, labels: Labels) -> Depth:
        """Find the triangles whose three nodes have the same label, not 0."""
        w, n = self.width, len(labels)
        f, right, above, opposite = labels[: n - w - 1], labels[1 : n - w], labels[w : n - 1], labels[w + 1 :]
        leaning = (right == above) & (right != 0)
        return Depth(self, labels, leaning & (f == right), leaning & (opposite == right))


@dataclass(frozen=True)
class Depth:
    """The equilateral triangles of a lattice.

    Attributes
    ----------
    lattice, labels
        The lattice, and the region of its nodes.
    up, down
        Bool, whether up and down triangle f exist (see the drawing of the module).
    """

    lattice: Lattice
    labels: Labels
    up: Bools
    down: Bools

    def nodes(self) -> Bools:
        """Mark the nodes that are corners of triangles."""
        w, n = self.lattice.width, len(self.labels)
        used = np.zeros(n, bool)
        for triangles, corners in ((self.up, (0, 1, w)), (self.down, (1, w + 1, w))):
            for corner in corners:
                used[corner : corner + len(triangles)] |= triangles
        return used

    def front(self) -> Ints:
        """Find the edges (k, 2) between these triangles and the rest, as pairs of nodes with the triangles on their left."""
        w = self.lattice.width
        edges = []
        # Every edge of the lattice has an up triangle on one side and a down triangle on the other: ends of the edge
        # as seen by the up triangle, and which down triangle is beyond.
        for start, stop, beyond in ((0, 1, -w), (1, w, 0), (w, 0, -1)):
            up, down = self.up[w:], self.down[w + beyond : len(self.down) + beyond]
            f = np.flatnonzero(up != down) + w
            edge = np.stack([f + start, f + stop], axis=1)
            turned = ~self.up[f]
            edge[turned] = edge[turned, ::-1]
            edges.append(edge)
        return np.concatenate(edges)

    def write(self, numbers: Ints, triangles: Ints, regions: Ints) -> None:
        """Write the triangles, with `numbers` for the nodes, and their labels into arrays of the right length."""
        w, done = self.lattice.width, 0
        for block in blocks(len(self.up)):
            for exist, corners in ((self.up, (0, 1, w)), (self.down, (1, w + 1, w))):
                f = np.flatnonzero(exist[block]) + block.start
                rows = slice(done, done + len(f))
                for k, corner in enumerate(corners):
                    triangles[rows, k] = numbers[f + corner]
                regions[rows] = self.labels[f + 1]
                done += len(f)

    def __len__(self) -> int:
        return int(np.count_nonzero(self.up)) + int(np.count_nonzero(self.down))


def blocks(count: int, size: int = 1 << 15) -> Iterator[slice]:
    """Cut a large array into blocks that fit the cache: fetching memory for all of it, again and again, takes longer than the work."""
    return (slice(start, min(start + size, count)) for start in range(0, count, size))
