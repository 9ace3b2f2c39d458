"""MSH, the format of Gmsh, version 4.1 or 2.2, in text: regions and sets of facets are physical groups with their names.

Physical groups and elementary entities have the same numbers: a region that of its label, or, as the format counts from 1, the next free
one for labels below 1; a set of facets its tag. Cells keep their order. The format is described in the Gmsh manual, "MSH file format".
Written here because meshio refuses to write triangles and edges into one file of version 4.1.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.errors import ParameterError
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, numbered
from img2tri.views.formats.stl_ply_obj_off import rows
from img2tri.views.objects.solver_cells import Cells

# Gmsh's number of each type of element, and its order of the nodes where that is not the one of VTK.
GMSH_TYPES = {"triangle": 2, "triangle6": 9, "wedge": 6, "wedge15": 18}
GMSH_ORDERS = {"wedge15": [0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10]}
_FACET_TYPES = {(1, 2): 1, (1, 3): 8, (2, 3): 2, (2, 4): 3, (2, 6): 9, (2, 8): 16}  # by dimension and number of nodes
VERSIONS = ("4.1", "2.2")


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
        If the version is another.
    """
    if version not in VERSIONS:
        raise ParameterError(f"version: expected '4.1' or '2.2', found {version!r}")
    groups = _groups(made)
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat"]
    lines += ["$Comments", MARK, *comment_lines(made.texts, ""), "$EndComments"]
    names = ['{} {} "{}"'.format(*key, _unquoted(name)) for key, (name, *_) in groups.items()]
    lines += ["$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames"]
    lines += _write_version_4(made.points, groups) if version == "4.1" else _write_version_2(made.points, groups)
    return {"": ("\n".join(lines) + "\n").encode()}


_Groups = dict[tuple[int, int], tuple[str, Ints, Ints]]


def _groups(made: Cells) -> _Groups:
    """Return (dimension, number) -> name, elements and their numbers; numbers of nodes begin with 1.

    Facets come first. The cells are numbered after them in the order of the mesh, whatever their group.
    """
    inside, count = 3 if made.solid else 2, 0
    groups: _Groups = {}
    for name in made.sides:
        facets = made.facets(name) + 1
        groups[inside - 1, made.tags[name]] = name, facets, count + 1 + np.arange(len(facets))
        count += len(facets)
    cells = made.cells[:, GMSH_ORDERS.get(made.kind, slice(None))] + 1
    for label, name in made.names.items():
        mine = np.flatnonzero(made.regions == label)
        groups[inside, made.ids[label]] = name, cells[mine], count + 1 + mine
    return groups


def _type(dimension: int, elements: Ints, inside: int) -> int:
    """Return Gmsh's number of the type of some elements; `inside` is the dimension of the cells."""
    nodes = elements.shape[1]
    if dimension < inside:
        return _FACET_TYPES[dimension, nodes]
    return GMSH_TYPES[{(2, 3): "triangle", (2, 6): "triangle6", (3, 6): "wedge", (3, 15): "wedge15"}[inside, nodes]]


def _write_version_2(points: Floats, groups: _Groups) -> list[str]:
    lines = ["$Nodes", str(len(points)), *numbered("{} {!r} {!r} {!r}", points, np.arange(1, len(points) + 1)), "$EndNodes"]
    lines += ["$Elements", str(sum(len(elements) for _, elements, _ in groups.values()))]
    inside = max(groups)[0]
    for (dimension, group), (_, elements, numbers) in groups.items():
        template = "{} {} 2 {} {}" + " {}" * elements.shape[1]
        lines += numbered(template, elements, numbers, _type(dimension, elements, inside), group, group)
    return [*lines, "$EndElements"]


def _write_version_4(points: Floats, groups: _Groups) -> list[str]:
    """Nodes belong to the first entity that has them, facets before cells: so those on a boundary are known to be there."""
    owner = np.full(len(points), len(groups))
    for i, (_, elements, _) in reversed(list(enumerate(groups.values()))):
        owner[elements.ravel() - 1] = i
    order = np.argsort(owner, kind="stable")
    counts = np.bincount(owner, minlength=len(groups))[: len(groups)]
    mine = np.split(order[: counts.sum()], np.cumsum(counts)[:-1])
    inside, total = max(groups)[0], sum(len(elements) for _, elements, _ in groups.values())

    lines = ["$Entities", " ".join(str(sum(dimension == d for dimension, _ in groups)) for d in range(4))]
    for (_, group), (_, elements, _) in groups.items():
        corners = points[elements.ravel() - 1]
        box = " ".join(repr(float(x)) for x in (*corners.min(axis=0), *corners.max(axis=0)))
        lines.append(f"{group} {box} 1 {group} 0")
    lines += ["$EndEntities", "$Nodes", f"{len(groups)} {counts.sum()} 1 {len(points)}"]
    for (dimension, group), nodes in zip(groups, mine, strict=True):
        lines += [f"{dimension} {group} 0 {len(nodes)}", *map(str, (nodes + 1).tolist()), *rows("{!r} {!r} {!r}", points[nodes])]
    lines += ["$EndNodes", "$Elements", f"{len(groups)} {total} 1 {total}"]
    for (dimension, group), (_, elements, numbers) in groups.items():
        lines.append(f"{dimension} {group} {_type(dimension, elements, inside)} {len(elements)}")
        lines += numbered("{}" + " {}" * elements.shape[1], elements, numbers)
    return [*lines, "$EndElements"]


def _unquoted(name: str) -> str:
    """Return a name as it can stand in double quotes."""
    return " ".join(name.replace('"', "'").split())
