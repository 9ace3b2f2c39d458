"""Rounding off the pixel steps that remain in the boundary and the interfaces of a mesh.

In: a mesh and how far its curves may move. Out: new places for the vertices of its curves; the inside is not touched.

Each pass solves, for all curves at once, the implicit step

    minimise  sum of m (x - y)^2  +  t^2 sum of m kappa^2,    that is    (M + t^2 L' M^-1 L) x = M y,

y being where the vertices are, m the length of curve around each, kappa = M^-1 L x the curvature, L the cotangent Laplacian of a
curve (weights 1 / length, which leave vertices on a straight line where they are, however spaced). This is the implicit fairing of
Desbrun et al. (SIGGRAPH 1999, DOI 10.1145/311535.311576), stable for any t, with the squared Laplacian, which parts steps from form more
sharply; with kappa left out at the ends of a curve an end is free to slide, where L itself would bend it. What a second step would
change is taken back from the first (S y + S (y - S y)): of a wave of length w a pass takes (1 + (w / width)^4)^-2 of the height.

Then each curve is shifted along its normals so that the areas on both of its sides are kept, and every vertex is drawn back to within
its own limit of where it was at first. That limit is `tolerance`, or less where two curves are closer to each other than twice that:
then under half of their distance, so that they cannot touch, whatever lies between them.
"""

from __future__ import annotations

import math

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, as_complex, cross, runs
from img2tri.errors import MeshError, ParameterError, finite, integer
from img2tri.triangles.tools.topology import directed_curves

Bounds = tuple[float, float, float, float]


def fair_curves(
    vertices: Floats,
    triangles: Ints,
    *,
    tolerance: float,
    width: float | None = None,
    iterations: int = 10,
    regions: Ints | None = None,
    bounds: Bounds | None = None,
) -> Floats:
    """Smooth the boundary and interface curves of a mesh.

    Guarantees: no vertex further than `tolerance` from where it was; junctions and the corners of the frame where they were; the
    frame flat, its vertices moved along it at most; no two curves touching that did not. The areas of the regions are kept as
    far as these limits allow. Whether the triangles survive is for the caller to see.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    tolerance
        World units. Larger rounds off more, corners too.
    width
        World units. Of waves of this length along the curve each pass takes a quarter, of waves of twice the length 1/300. None takes
        24 times the tolerance, or four times the mean length of the curves' edges if that is more: pixel steps are gone, a
        disc twelve tolerances across is still round.
    iterations
        Number of passes.
    regions : (m,) int64, optional
        With them, interfaces are curves too.
    bounds
        (left, bottom, right, top) of the image: what lies on this frame stays on it. None: no frame, all of the boundary may move.

    Returns
    -------
    vertices : (n, 2) float64

    Raises
    ------
    ParameterError
        An option that is not a number of its kind; bounds without an inside.
    """
    tolerance = finite("tolerance", tolerance, least=0)
    passes = integer("iterations", iterations)
    edges = directed_curves(triangles, regions)
    if len(edges) == 0 or passes == 0:
        return vertices.copy()
    used, local = np.unique(edges, return_inverse=True)
    start, local = vertices[used], local.reshape(-1, 2)
    lengths = np.linalg.norm(start[local[:, 1]] - start[local[:, 0]], axis=1)
    mean = float(lengths.mean())
    if not 1e-100 < mean < 1e100:
        raise MeshError(f"vertices: expected edges of a length between 1e-100 and 1e100 on the boundary, found {mean:g} on average")
    width = max(24 * tolerance, 4 * mean) if width is None else finite("width", width, above=0)

    limits = _limits(start, local, min(tolerance, mean))
    beside, above = _frame(start, bounds)
    on_frame = (start[local[:, 0]] == start[local[:, 1]]) & np.stack([beside, above], axis=1)[local].all(axis=1)
    curves = _Curves(start, local[~on_frame.any(axis=1)], beside, above, (width / (2 * math.pi)) ** 2)
    # A curve beside the frame must not reach it: half of the way at most. What lies on the frame has no way to go.
    low, high = np.full(2, -np.inf), np.full(2, np.inf)
    if bounds is not None:
        low, high = (start + bounds[:2]) / 2, (start + bounds[2:]) / 2
    x = start
    for _ in range(passes):
        move = curves.keep_areas(x, curves.smooth(x)) - start
        far = np.linalg.norm(move, axis=1)
        move *= np.divide(limits, far, out=np.ones_like(far), where=far > limits)[:, None]
        x = np.where(curves.free, np.clip(start + move, low, high), start)
    result = vertices.copy()
    result[used] = x
    return result


def _frame(points: Floats, bounds: Bounds | None) -> tuple[Bools, Bools]:
    """Tell which points lie on the left or right side of the frame, and which on its bottom or top."""
    if bounds is None:
        return np.zeros(len(points), bool), np.zeros(len(points), bool)
    left, bottom, right, top = (finite("bounds", value) for value in bounds)
    if not (left < right and bottom < top):
        raise ParameterError(f"bounds: expected (left, bottom, right, top) with left < right and bottom < top, found {bounds!r}")
    near = 1e-9 * math.hypot(right - left, top - bottom)
    x, y = points.T
    return (np.abs(x - left) <= near) | (np.abs(x - right) <= near), (np.abs(y - bottom) <= near) | (np.abs(y - top) <= near)


def _limits(points: Floats, edges: Ints, reach: float) -> Floats:
    """Return how far each point may move: `reach`, or 0.45 of the distance of a point and an edge (not its own) that are near each other.

    Segments in motion meet first in a point of one and some place on the other. If that point and both ends of the edge have moved by
    at most 0.45 of their distance, they have not met. Near pairs, closer than 2 `reach`, come from a search tree over samples of the
    edges, which miss no place of an edge by more than half their distance.
    """
    from scipy.spatial import cKDTree

    limits = np.full(len(points), reach)
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    lengths = np.linalg.norm(b - a, axis=1)
    apart = max(2 * reach, float(lengths.mean()))
    number = np.ceil(lengths / apart).astype(np.int64)
    owner, place = runs(number)
    along = (place + 0.5) / number[owner]
    samples = a[owner] + along[:, None] * (b - a)[owner]
    near = cKDTree(points).sparse_distance_matrix(cKDTree(samples), 2 * reach + apart / 2, output_type="ndarray")
    pairs = np.unique(near["i"] * len(edges) + owner[near["j"]])
    p, e = np.divmod(pairs, len(edges))
    foreign = (edges[e] != p[:, None]).all(axis=1)
    p, e = p[foreign], e[foreign]
    # Distance of point p from edge e: drop the foot, keep it between the ends.
    along = (b - a)[e]
    foot = np.clip(np.einsum("ij,ij->i", points[p] - a[e], along) / np.einsum("ij,ij->i", along, along), 0, 1)
    gap = 0.45 * np.linalg.norm(points[p] - a[e] - foot[:, None] * along, axis=1)
    for who in (p, edges[e, 0], edges[e, 1]):
        np.minimum.at(limits, who, gap)
    return limits


class _Curves:
    """The curves of a mesh without what lies on the frame, and the matrices of the implicit step.

    A curve bends where it passes, so at vertices with two of its edges. Where it ends on the frame it may slide along it; junctions,
    corners of the frame and points where a curve only touches the frame are held.
    """

    def __init__(self, points: Floats, edges: Ints, beside: Bools, above: Bools, time: float) -> None:
        from scipy.sparse import coo_array, csr_array, diags_array
        from scipy.sparse.csgraph import connected_components
        from scipy.sparse.linalg import splu

        k = len(points)
        self.edges = edges
        i, j = edges.T
        degree = np.bincount(edges.ravel(), minlength=k)
        framed = beside | above
        bends = (degree == 2) & ~framed
        slides = (degree == 1) & framed & ~(beside & above)
        self.free = np.stack([bends | (slides & above), bends | (slides & beside)], axis=1)

        lengths = np.linalg.norm(points[j] - points[i], axis=1)
        lengths = np.maximum(lengths, 1e-6 * lengths.max(initial=0.0))  # where vertices coincide
        self.masses = np.bincount(edges.ravel(), np.repeat(lengths / 2, 2), minlength=k).astype(np.float64)
        self.masses[degree == 0] = 1.0
        w = 1 / lengths
        L = coo_array((np.concatenate([w, w, -w, -w]), (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))), shape=(k, k))
        self.bending = csr_array(time**2 * (L.T @ diags_array(bends / self.masses) @ L))
        system = self.bending + diags_array(self.masses)
        self.rows = [np.flatnonzero(self.free[:, c]) for c in range(2)]
        parts = [system[r][:, r].tocsc() for r in self.rows]
        self.solvers = [splu(part, "MMD_AT_PLUS_A", options={"SymmetricMode": True}) if part.shape[0] else None for part in parts]

        # Curves are joined through vertices where they bend; held ones are ends.
        inner = bends[i] & bends[j]
        links = coo_array((np.ones(int(inner.sum())), (i[inner], j[inner])), shape=(k, k))
        _, self.curve = connected_components(links, directed=False)
        self.owner = np.where(bends[i], self.curve[i], self.curve[j])

    def smooth(self, x: Floats) -> Floats:
        """Take one implicit step from x, each coordinate by itself as it has its own free vertices, and take its shrinkage back."""
        result = x.copy()
        pull = -(self.bending @ (x - x.mean(axis=0)))  # far from the origin sums would cancel
        for c, (rows, solver) in enumerate(zip(self.rows, self.solvers, strict=True)):
            if solver is not None:
                step = solver.solve(pull[rows, c])
                result[rows, c] += step - solver.solve(self.masses[rows] * step)
        return result

    def keep_areas(self, before: Floats, after: Floats) -> Floats:
        """Shift the bending vertices of each curve along its normals by one distance, so that the area swept from before to after is 0.

        Each edge sweeps the quadrilateral between its places::

            after   3 <------ 2
                    |         |      area = (p2 - p0) x (p3 - p1) / 2, positive to the left of the edge
            before  0 ------> 1
        """
        i, j = self.edges.T
        swept = np.bincount(
            self.owner, cross(as_complex(after[j] - before[i]), as_complex(after[i] - before[j])) / 2, minlength=len(before)
        )
        # The gradient of the area to the left at a vertex is half the edge around it, turned by 90 degrees; halfway, the area is
        # linear in the shift of a circle.
        middle = (before + after) / 2
        along = np.zeros_like(middle)
        np.add.at(along, i, middle[j] / 2)
        np.add.at(along, j, -middle[i] / 2)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        size = np.where(self.free.all(axis=1), np.linalg.norm(normal, axis=1), 0.0)
        reach = np.bincount(self.curve, size, minlength=len(before))
        shift = np.divide(-swept, reach, out=np.zeros_like(reach), where=reach > 0)[self.curve]
        return after + normal * np.divide(shift, size, out=np.zeros_like(size), where=size > 0)[:, None]
