r"""What every format for solvers starts from: a mesh in space made of cells of one kind, with its named parts.

Triangles, wedges or tetrahedra, linear or quadratic, with their nodes in the order of VTK. A set of edges of the plane mesh is a set of
*facets* here: the edges themselves, or the walls above them; solids have the sets ``z_min`` and ``z_max`` besides. A facet is a side of a
cell. Sides 0, 1 and 2 stand on the sides of the triangle, see `img2tri.arrays.unique_edges`; wedges have the bottom as side 3 and the top
as side 4::

        2                        5
       / \                      /|\
      5   4                    3-|-4        walls 0 (0 1 4 3), 1 (1 2 5 4), 2 (2 0 3 5)
     /     \                   | 2 |        bottom 3 (0 2 1), top 4 (3 4 5)
    0---3---1                  |/ \|        all as seen from outside
                               0---1

Tetrahedra have the sides (0 2 1), (0 1 3), (1 2 3) and (2 0 3).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.views.objects.flat_or_extruded import surface
from img2tri.views.objects.sets.named_sets import named_sets
from img2tri.views.objects.sets.numbers_in_files import Z_MAX, Z_MIN, file_numbers, set_tags
from img2tri.views.objects.sets.triangles_by_label import grouped

# The nodes of each side of each kind, corners first.
CELL_SIDES: dict[str, tuple[tuple[int, ...], ...]] = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "triangle6": ((0, 1, 3), (1, 2, 4), (2, 0, 5)),
    "wedge": ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5), (0, 2, 1), (3, 4, 5)),
    "wedge15": (
        (0, 1, 4, 3, 6, 13, 9, 12), (1, 2, 5, 4, 7, 14, 10, 13), (2, 0, 3, 5, 8, 12, 11, 14), (0, 2, 1, 8, 7, 6), (3, 4, 5, 9, 10, 11),
    ),
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "tetra10": ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (2, 0, 3, 6, 7, 9)),
}  # fmt: skip
FLAT_KINDS = {3: "triangle", 6: "triangle6"}
SOLID_KINDS = {6: "wedge", 15: "wedge15"}


@dataclass(frozen=True, eq=False)
class Cells:
    """A mesh as solvers see it.

    Attributes
    ----------
    points
        (p, 3) float64, world units.
    cells
        (m, k) int64, the nodes of each cell in the order of VTK.
    kind
        "triangle", "triangle6", "wedge", "wedge15", "tetra" or "tetra10".
    regions
        (m,) int64, the label of each cell.
    names
        Label -> name of the region, by ascending label.
    sides
        Name of each set of facets -> (k, 2) int64: a cell, and which of its sides.
    tags
        Name of each set of facets -> its number, which no region has.
    cell_data
        Name -> (m,) or (m, c) other values of each cell.
    texts
        Name -> text: "units" and whatever else is known about the whole. ASCII.
    point_data
        Name -> (p,) or (p, c) values of each node.
    part_of, between
        Of the sets, as in `img2tri.views.objects.sets.named_sets.Sets`.
    periodic
        "x", "y" or "xy" if left and right, or bottom and top, are at the same places; else "".
    """

    points: Floats
    cells: Ints
    kind: str
    regions: Ints
    names: dict[int, str]
    sides: dict[str, Ints]
    tags: dict[str, int]
    cell_data: dict[str, NDArray[Any]]
    texts: dict[str, str]
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    part_of: dict[str, str] = field(default_factory=dict)
    between: dict[str, tuple[int, int]] = field(default_factory=dict)
    periodic: str = ""

    @property
    def solid(self) -> bool:
        """Whether the cells have a volume."""
        return not self.kind.startswith("triangle")

    @property
    def ids(self) -> dict[int, int]:
        """Label -> its number in files, at least 1 and within 32 bits, see `img2tri.views.objects.sets.numbers_in_files`."""
        return file_numbers(self.names)

    @property
    def wholes(self) -> list[str]:
        """The sets that are no piece of another: no facet is in two of them."""
        return [name for name in self.sides if name not in self.part_of]

    def members(self) -> dict[int, Ints]:
        """Label of each region -> its cells, in ascending order."""
        each, members = grouped(self.regions)
        parts = dict(zip(each.tolist(), members, strict=True))
        return {label: parts.get(label, each[:0]) for label in self.names}

    def facets(self, name: str) -> Ints:
        """Return the nodes (k, 2 to 8) of the facets of a set, row for row as in `sides`; corners first."""
        cell, side = self.sides[name].T
        # Walls and ends of wedges differ in their number of nodes; no set holds both.
        width = len(CELL_SIDES[self.kind][side[0]])
        local = np.array([nodes if len(nodes) == width else (0,) * width for nodes in CELL_SIDES[self.kind]])
        return np.asarray(self.cells[cell[:, None], local[side]])


def flat_cells(
    points: ArrayLike,
    elements: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    names: Mapping[int, str] | None = None,
    bounds: tuple[float, float, float, float] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    point_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    periodic: str | None = None,
    edge_sets: Mapping[str, Ints] | None = None,
) -> Cells:
    """Make cells of a plane mesh.

    Parameters
    ----------
    points
        (p, 2) float64 in world units: the vertices and, for elements of six nodes, those in the middle of edges.
    elements
        (m, 3) int64, counter-clockwise triangles, or (m, 6): these, then the nodes between 0 and 1, 1 and 2, 2 and 0, see
        `img2tri.views.objects.extruded_wedges.quadratic`.
    regions, z, cell_data, field_data
        As in `img2tri.views.objects.flat_or_extruded.surface`.
    point_data
        Name -> numbers of each vertex, (n,) or (n, c), or of each node. Nodes in the middle of edges get the mean of the ends.
    names, bounds
        As in `img2tri.views.objects.sets.named_sets.named_sets`.
    periodic
        "x", "y" or "xy" for meshes that repeat themselves.
    edge_sets
        Name -> (k, 2) vertices of edges: sets that are known, see `img2tri.views.objects.sets.named_sets.named_sets`.

    Raises
    ------
    MeshError, ParameterError
        As these two.

    Examples
    --------
    >>> made = flat_cells([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], [-1, 4], bounds=(0, 0, 2, 1))
    >>> made.kind, list(made.sides), made.facets("left").tolist(), made.ids
    ('triangle', ['left', 'bottom', 'top', 'outer', 'region_-1__region_4'], [[3, 0]], {-1: 5, 4: 4})
    """
    nodes = np.asarray(elements)
    if nodes.ndim != 2 or nodes.shape[1] not in FLAT_KINDS:
        raise MeshError(f"elements: expected rows of 3 or 6 nodes, found shape {nodes.shape}")
    made = surface(points, nodes[:, :3], regions, z=z, cell_data=cell_data, field_data=field_data)
    if nodes.max() >= len(made.points) or nodes.min() < 0:
        raise MeshError(f"elements: expected indices from 0 to {len(made.points) - 1}, found {nodes.min()} to {nodes.max()}")
    nodes = nodes.astype(np.int64)
    sets = named_sets(made.points[:, :2], made.faces, made.regions.astype(np.int64), bounds=bounds, names=names, given=edge_sets)
    return Cells(
        made.points, nodes, FLAT_KINDS[nodes.shape[1]], made.regions.astype(np.int64),
        names={label: name for name, label in sets.labels.items()}, sides=sets.sides, tags=sets.tags, cell_data=made.cell_data,
        texts=made.field_data, point_data={name: _at_nodes(name, v, nodes, len(made.points)) for name, v in (point_data or {}).items()},
        part_of=sets.part_of, between=sets.between, periodic=periodic or "",
    )  # fmt: skip


def _at_nodes(name: str, values: ArrayLike, nodes: Ints, n: int) -> NDArray[Any]:
    """Return values of each node; those in the middle of edges get the mean of the ends."""
    array = np.asarray(values)
    vertices = int(nodes[:, :3].max()) + 1
    if array.dtype.kind not in "biuf" or array.ndim not in (1, 2) or len(array) not in (vertices, n):
        raise MeshError(f"{name}: expected numbers for each of {vertices} vertices, found shape {array.shape} of {array.dtype}")
    if len(array) == n:
        return array
    every = np.zeros((n, *array.shape[1:]))
    every[:vertices] = array
    for k in range(3):
        every[nodes[:, 3 + k]] = (every[nodes[:, k]] + every[nodes[:, (k + 1) % 3]]) / 2
    return every


def solid_cells(flat: Cells, points: Floats, cells: Ints) -> Cells:
    """Make cells of the wedges that stand on a plane mesh.

    Parameters
    ----------
    flat
        The plane mesh, of three or six nodes.
    points, cells
        The wedges in layers from the bottom up, each in the order of the triangles, see `img2tri.views.objects.extruded_wedges`.

    Returns
    -------
    Cells
        With the region, the values and the sets of `flat` in each layer, and the sets ``z_min`` and ``z_max``.

    Raises
    ------
    MeshError
        If there are not as many wedges in each layer as triangles.

    Examples
    --------
    >>> from img2tri.views.objects.extruded_wedges import wedges
    >>> triangle = [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]
    >>> solid = solid_cells(flat_cells(*triangle), *wedges(*triangle, height=1, layers=2)[:2])
    >>> {name: len(sides) for name, sides in solid.sides.items()}, solid.tags  # doctest: +ELLIPSIS
    ({'outer': 6, 'outer_1': 2, 'outer_2': 2, 'outer_3': 2, 'z_min': 1, 'z_max': 1}, ...)
    """
    m, layers = len(flat.cells), len(cells) // len(flat.cells)
    if len(cells) != layers * m or cells.shape[1] not in SOLID_KINDS:
        raise MeshError(f"cells: expected wedges of 6 or 15 nodes, {m} in each layer, found shape {cells.shape}")
    above = m * np.arange(layers)
    sides = {
        name: np.stack([np.add.outer(above, rows[:, 0]).ravel(), np.tile(rows[:, 1], layers)], axis=1) for name, rows in flat.sides.items()
    }
    every = np.arange(m)
    sides[Z_MIN] = np.stack([every, np.full(m, 3)], axis=1)
    sides[Z_MAX] = np.stack([every + above[-1], np.full(m, 4)], axis=1)
    # Each node has the values of the node below it; those half-way up come last, vertex by vertex.
    below = np.tile(np.arange(len(flat.points)), layers + 1)
    below = np.concatenate([below, np.arange(len(points) - len(below)) % max(1, (len(points) - len(below)) // layers)])
    return replace(
        flat, points=points, cells=cells, kind=SOLID_KINDS[cells.shape[1]], regions=np.tile(flat.regions, layers), sides=sides,
        tags=set_tags(sides, flat.ids.values()), cell_data={name: _repeated(v, layers) for name, v in flat.cell_data.items()},
        point_data={name: v[below] for name, v in flat.point_data.items()},
    )  # fmt: skip


def _repeated(values: NDArray[Any], times: int) -> NDArray[Any]:
    return np.tile(values, (times,) + (1,) * (values.ndim - 1))
