r"""What every format for solvers starts from: a mesh in space made of cells of one kind, with its named parts.

Triangles or wedges, linear or quadratic, with their nodes in the order of VTK. A set of edges of the plane mesh is a set of *facets* here:
the edges themselves, or the walls above them; solids have the sets ``z_min`` and ``z_max`` besides. A facet is a side of a cell. Sides 0, 1
and 2 stand on the sides of the triangle, see `img2tri.arrays.unique_edges`; wedges have the bottom as side 3 and the top as side 4::

        2                        5
       / \                      /|\
      5   4                    3-|-4        walls 0 (0 1 4 3), 1 (1 2 5 4), 2 (2 0 3 5)
     /     \                   | 2 |        bottom 3 (0 2 1), top 4 (3 4 5)
    0---3---1                  |/ \|        all as seen from outside
                               0---1
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.views.objects.flat_or_extruded import surface
from img2tri.views.objects.named_sets import named_sets

# The nodes of each side of each kind, corners first.
CELL_SIDES: dict[str, tuple[tuple[int, ...], ...]] = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "triangle6": ((0, 1, 3), (1, 2, 4), (2, 0, 5)),
    "wedge": ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5), (0, 2, 1), (3, 4, 5)),
    "wedge15": (
        (0, 1, 4, 3, 6, 13, 9, 12), (1, 2, 5, 4, 7, 14, 10, 13), (2, 0, 3, 5, 8, 12, 11, 14), (0, 2, 1, 8, 7, 6), (3, 4, 5, 9, 10, 11),
    ),
}  # fmt: skip
FLAT_KINDS = {3: "triangle", 6: "triangle6"}
SOLID_KINDS = {6: "wedge", 15: "wedge15"}
Z_MIN, Z_MAX = "z_min", "z_max"


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
        "triangle", "triangle6", "wedge" or "wedge15".
    regions
        (m,) int64, the label of each cell.
    names
        Label -> name of the region, by ascending label.
    sides
        Name of each set of facets -> (k, 2) int64: a cell, and which of its sides.
    tags
        Name of each set of facets -> its number.
    cell_data
        Name -> (m,) other values of each cell.
    texts
        Name -> text: "units" and whatever else is known about the whole. ASCII.
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

    @property
    def solid(self) -> bool:
        """Whether the cells have a volume."""
        return self.kind.startswith("wedge")

    @property
    def ids(self) -> dict[int, int]:
        """Label -> a number of at least 1, as formats want it that count from 1.

        Labels of 1 and more are their own numbers; the others get the next free ones, in ascending order.
        """
        others = [label for label in self.names if label < 1]
        return {label: label for label in self.names} | {label: max(0, *self.names) + i for i, label in enumerate(others, 1)}

    def facets(self, name: str) -> Ints:
        """Return the nodes (k, 2 to 8) of the facets of a set, row for row as in `sides`; corners first."""
        cell, side = self.sides[name].T
        first = 3 * (side.min() // 3)  # walls and ends of solids differ in their number of nodes; no set holds both
        local = np.array(CELL_SIDES[self.kind][first : first + 3])[side - first]
        return np.asarray(self.cells[cell[:, None], local])


def elements(
    nodes: Floats, triangles: Ints, regions: ArrayLike, *, corners: int, height: float | None, layers: int, z: float = 0.0, **about: Any
) -> Cells:
    """Return the elements of a plane mesh, or with `height` wedges in so many `layers`; triangles of 6 nodes are quadratic.

    The first `corners` of the nodes are vertices; `about` is as for `flat_cells`.
    """
    from img2tri.views.objects.wedges import wedges

    flat = flat_cells(nodes, triangles, regions, z=z, **about)
    if height is None:
        return flat
    order, middles = (1, None) if triangles.shape[1] == 3 else (2, nodes[corners:])
    points, cells, _ = wedges(nodes[:corners], triangles[:, :3], height=height, layers=layers, order=order, z=z, middles=middles)
    return solid_cells(flat, points, cells)


def flat_cells(
    points: ArrayLike,
    elements: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    z: float = 0.0,
    names: Mapping[int, str] | None = None,
    bounds: tuple[float, float, float, float] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
) -> Cells:
    """Make cells of a plane mesh.

    Parameters
    ----------
    points
        (p, 2) float64 in world units: the vertices and, for elements of six nodes, those in the middle of edges.
    elements
        (m, 3) int64, counter-clockwise triangles, or (m, 6): these, then the nodes between 0 and 1, 1 and 2, 2 and 0, see
        `img2tri.views.objects.wedges.quadratic`.
    regions, z, cell_data, field_data
        As in `img2tri.views.objects.flat_or_extruded.surface`.
    names, bounds
        As in `img2tri.views.objects.named_sets.named_sets`.

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
    labels = made.regions.astype(np.int64)
    sets = named_sets(made.points[:, :2], made.faces, labels, bounds=bounds, names=names)
    called = {label: name for name, label in sets.labels.items()}
    kind = FLAT_KINDS[nodes.shape[1]]
    return Cells(
        made.points, nodes.astype(np.int64), kind, labels, called, sets.sides, sets.tags, made.cell_data, made.field_data
    )  # fmt: skip


def solid_cells(flat: Cells, points: Floats, cells: Ints) -> Cells:
    """Make cells of the wedges that stand on a plane mesh.

    Parameters
    ----------
    flat
        The plane mesh, of three or six nodes.
    points, cells
        The wedges in layers from the bottom up, each in the order of the triangles, as `img2tri.views.objects.wedges.wedges` returns them.

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
    >>> from img2tri.views.objects.wedges import wedges
    >>> triangle = [[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]
    >>> solid = solid_cells(flat_cells(*triangle), *wedges(*triangle, height=1, layers=2)[:2])
    >>> {name: len(sides) for name, sides in solid.sides.items()}, solid.tags
    ({'outer': 6, 'z_min': 1, 'z_max': 1}, {'outer': 5, 'z_min': 6, 'z_max': 7})
    """
    m, layers = len(flat.cells), len(cells) // len(flat.cells)
    if len(cells) != layers * m or cells.shape[1] not in SOLID_KINDS:
        raise MeshError(f"cells: expected wedges of 6 or 15 nodes, {m} in each layer, found shape {cells.shape}")
    above = m * np.arange(layers)
    sides = {
        name: np.stack([np.add.outer(above, rows[:, 0]).ravel(), np.tile(rows[:, 1], layers)], axis=1) for name, rows in flat.sides.items()
    }
    every, last = np.arange(m), max((5, *flat.tags.values()))
    sides[Z_MIN] = np.stack([every, np.full(m, 3)], axis=1)
    sides[Z_MAX] = np.stack([every + above[-1], np.full(m, 4)], axis=1)
    return replace(
        flat, points=points, cells=cells, kind=SOLID_KINDS[cells.shape[1]], regions=np.tile(flat.regions, layers), sides=sides,
        tags=flat.tags | {Z_MIN: last + 1, Z_MAX: last + 2}, cell_data={name: np.tile(v, layers) for name, v in flat.cell_data.items()},
    )  # fmt: skip
