"""MSH, the format of Gmsh, version 4.1 or 2.2, in text: regions and sets of facets are physical groups with their names.

Physical groups have the numbers of `img2tri.views.objects.sets.numbers_in_files`: those of regions are their labels wherever they can be,
and no set has the number of a region, as many readers go by numbers without their dimension. Nodes and elements are numbered in the order
of the file, which some readers take for granted: nodes as in the mesh, facets before cells, cells by region.

An entity is a piece of a set, or a region; in version 4.1 a piece is in the group of its set and in one of its own. In version 2.2, where
an element has one group, the number of a piece is that of its entity, and a comment has the names of these numbers. Nodes of periodic
meshes are paired in ``$Periodic``, values of cells and nodes are ``$ElementData`` and ``$NodeData``. The format is described in the manual
of Gmsh, "MSH file format". Written here because meshio refuses to write triangles and edges into one file of version 4.1.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import ParameterError
from img2tri.views.formats.number_rows import exact_doubles, real_rows, whole_rows
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, distinct_names, label_table, unquoted
from img2tri.views.objects.periodic_solver_nodes import node_pairs
from img2tri.views.objects.solver_cells import Cells

# Gmsh's number of each type of element, and its order of the nodes where that is not the one of VTK.
GMSH_TYPES = {"triangle": 2, "triangle6": 9, "wedge": 6, "wedge15": 18, "tetra": 4, "tetra10": 11}
GMSH_ORDERS = {"wedge15": [0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10], "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}
_FACET_TYPES = {(1, 2): 1, (1, 3): 8, (2, 3): 2, (2, 4): 3, (2, 6): 9, (2, 8): 16}  # by dimension and number of nodes
VERSIONS = ("4.1", "2.2")


@dataclass(frozen=True, eq=False)
class _Entity:
    """Elements of one kind: its dimension, its number, the numbers of its groups, Gmsh's type, and the nodes (k, c) from 1."""

    dimension: int
    number: int
    groups: tuple[int, ...]
    type: int
    elements: Ints


def msh(made: Cells, *, version: str = "4.1") -> dict[str, bytes]:
    """Write a mesh as MSH.

    Parameters
    ----------
    made
        The mesh; its texts become comments.
    version
        "4.1", or "2.2", which older programs read.

    Returns
    -------
    dict
        The bytes of the file, under "".

    Raises
    ------
    ParameterError
        If the version is another, or an array has more than nine values for each cell or node.
    """
    if version not in VERSIONS:
        raise ParameterError(f"version: expected '4.1' or '2.2', found {version!r}")
    inside, members = 3 if made.solid else 2, made.members()
    called = distinct_names([*made.names.values(), *made.sides], unquoted)
    names = [(inside - 1, made.tags[name], called[name]) for name in made.sides if version == "4.1" or name not in made.part_of]
    ids = made.ids
    names += [(inside, ids[label], called[name]) for label, name in made.names.items()]
    entities = _entities(made, members)
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat"]
    pieces = {called[name]: made.tags[name] for name in made.part_of} if version == "2.2" else {}
    notes = made.texts | label_table(made, called) | ({"pieces": json.dumps(pieces)} if pieces else {})
    lines += ["$Comments", MARK, *comment_lines(notes, ""), "$EndComments"]
    lines += ["$PhysicalNames", str(len(names)), *(f'{d} {number} "{name}"' for d, number, name in names), "$EndPhysicalNames\n"]
    body = _write_version_4(made.points, entities) if version == "4.1" else _write_version_2(made.points, entities)
    # Some readers want values of all elements: facets have those of their cells.
    split = set(made.part_of.values())
    cells = np.concatenate([*(rows[:, 0] for name, rows in made.sides.items() if name not in split), *members.values()])
    data = [_data("ElementData", name, values[cells]) for name, values in made.cell_data.items()]
    data += [_data("NodeData", name, values) for name, values in made.point_data.items()]
    return {"": "".join(["\n".join(lines), *body, _periodic(made, version), *data]).encode()}


def _entities(made: Cells, members: dict[int, Ints]) -> list[_Entity]:
    """Return the entities, facets first."""
    inside, entities, ids = 3 if made.solid else 2, list[_Entity](), made.ids
    split = set(made.part_of.values())
    for name in made.sides:
        if name in split:
            continue
        elements = made.facets(name) + 1
        groups = (made.tags[made.part_of[name]], made.tags[name]) if name in made.part_of else (made.tags[name],)
        kind = _FACET_TYPES[inside - 1, elements.shape[1]]
        entities.append(_Entity(inside - 1, made.tags[name], groups, kind, elements))
    cells = made.cells[:, GMSH_ORDERS.get(made.kind, slice(None))] + 1
    for label, mine in members.items():
        number = ids[label]
        entities.append(_Entity(inside, number, (number,), GMSH_TYPES[made.kind], cells[mine]))
    return entities


def _numbered(elements: Ints, first: int, *others: int) -> Ints:
    """Put the number of each element, counted from `first`, and what is the same for all in front of its nodes."""
    k = len(elements)
    return np.column_stack([np.arange(first, first + k), *(np.full(k, other) for other in others), elements])


def _write_version_2(points: Floats, entities: list[_Entity]) -> list[str]:
    n, first, parts = len(points), 1, []
    for e in entities:
        parts.append(whole_rows(_numbered(e.elements, first, e.type, 2, e.groups[0], e.number)))
        first += len(e.elements)
    numbers, places = whole_rows(np.arange(1, n + 1)[:, None]).split("\n"), real_rows(points).split("\n")
    nodes = "".join(f"{number} {place}\n" for number, place in zip(numbers[:-1], places[:-1], strict=True))
    return [f"$Nodes\n{n}\n", nodes, f"$EndNodes\n$Elements\n{first - 1}\n", *parts, "$EndElements\n"]


def _write_version_4(points: Floats, entities: list[_Entity]) -> list[str]:
    """Write all nodes in one block, of the first cells, so that they keep their order."""
    n, first, columns = len(points), 1, np.ascontiguousarray(points.T)
    parts = ["$Entities\n", " ".join(str(sum(e.dimension == d for e in entities)) for d in range(4)), "\n"]
    for e in entities:
        corners = [column[e.elements.ravel() - 1] for column in columns]
        box = " ".join(repr(float(x)) for x in (*map(np.min, corners), *map(np.max, corners)))
        parts.append(f"{e.number} {box} {len(e.groups)} {' '.join(map(str, e.groups))} 0\n")
    home = next(e for e in entities if e.dimension == entities[-1].dimension)
    parts += ["$EndEntities\n$Nodes\n", f"1 {n} 1 {n}\n{home.dimension} {home.number} 0 {n}\n"]
    parts += [whole_rows(np.arange(1, n + 1)[:, None]), real_rows(points)]
    total = sum(len(e.elements) for e in entities)
    parts += ["$EndNodes\n$Elements\n", f"{len(entities)} {total} 1 {total}\n"]
    for e in entities:
        parts += [f"{e.dimension} {e.number} {e.type} {len(e.elements)}\n", whole_rows(_numbered(e.elements, first))]
        first += len(e.elements)
    return [*parts, "$EndElements\n"]


def _periodic(made: Cells, version: str) -> str:
    """Pair the nodes of opposite sides, piece by piece: dimension, entity, the one it repeats, and both nodes of each pair.

    Version 4.1 has the length of an affine map before them, which is 0.
    """
    pairs = node_pairs(made)
    if not pairs:
        return ""
    affine = "0\n" if version == "4.1" else ""
    links = "".join(f"{2 if made.solid else 1} {p.tag} {p.master}\n{affine}{len(p.nodes)}\n{whole_rows(p.nodes + 1)}" for p in pairs)
    return f"$Periodic\n{len(pairs)}\n{links}$EndPeriodic\n"


def _data(section: str, name: str, values: NDArray[Any]) -> str:
    """Write values of all elements, or nodes: texts, a time, then step, components and count; and a line for each."""
    array = exact_doubles(name, values.reshape(len(values), -1))
    width = next((c for c in (1, 3, 9) if c >= array.shape[1]), 0)
    if not width:
        raise ParameterError(f"{name}: expected at most 9 values each for .msh, found {array.shape[1]}; take it apart")
    array = np.pad(array, ((0, 0), (0, width - array.shape[1])))
    numbers, texts = whole_rows(np.arange(1, len(array) + 1)[:, None]).split("\n"), real_rows(array).split("\n")
    lines = "".join(f"{number} {text}\n" for number, text in zip(numbers[:-1], texts[:-1], strict=True))
    return f'${section}\n1\n"{unquoted(name)}"\n1\n0.0\n3\n0\n{width}\n{len(array)}\n{lines}$End{section}\n'
