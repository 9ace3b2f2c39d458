"""INP, the format of Abaqus and CalculiX: nodes, elements, and NSET, ELSET and SURFACE for every name.

Each region is an ELSET; each set of facets an NSET of its nodes and a SURFACE of its element sides, an interface that of the region that
comes first in its name. The file holds the mesh and nothing else, to be included in an analysis by ``*INCLUDE, INPUT=mesh.inp``, or in a
``*PART``. Names are made to fit, see `img2tri.views.formats.solvers.plain_text`; comments tell where one had to be changed, and the label
of each region. Lines and numbers keep to the limits of Abaqus, 20 characters for a number. Plane elements lie at z = 0, as CalculiX takes
no others and Abaqus looks at x and y alone; the height of a mesh that lies elsewhere is in a comment behind the nodes, and put back by
`img2tri.load` and ``pyvista.read``.

Meshes that are periodic have an ``*EQUATION`` for each node that repeats another: its displacements are those of the other and those of the
node PERIODIC_X, or PERIODIC_Y, which stand for the stretch of the whole; where both sides meet, of both.

With ``deck=True`` it is an analysis that runs as it is, to be filled with the materials and loads of the user: every separate body is held
at its lowest boundary vertices and drawn up at its highest.
"""

from __future__ import annotations

import json

import numpy as np

from img2tri.arrays import Bools, Floats
from img2tri.errors import MeshError, choice
from img2tri.views.formats.number_rows import whole_rows
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, fitted_number, fitted_numbers, in_lines, set_identifiers
from img2tri.views.objects.periodic_solver_nodes import NodePairs, node_pairs
from img2tri.views.objects.sets.named_sets import boundary_rings
from img2tri.views.objects.sets.numbers_in_files import Z_MIN
from img2tri.views.objects.solver_cells import Cells

PLANES = ("stress", "strain")
_SOLID_ELEMENTS = {"wedge": "C3D6", "wedge15": "C3D15", "tetra": "C3D4", "tetra10": "C3D10"}  # nodes in the order of VTK
_IN_PLANE = {"triangle": 3, "triangle6": 6}
# Abaqus's number of each side.
_FACES = {"wedge": np.array([3, 4, 5, 1, 2]), "triangle": np.array([1, 2, 3]), "tetra": np.array([1, 2, 3, 4])}
_OWN = ("HELD", "DRAWN")
_REFERENCE = {"x": "PERIODIC_X", "y": "PERIODIC_Y"}
_END = 0.01  # share of a body's height that is held, and drawn
_STRETCH = 0.001


def inp(made: Cells, *, deck: bool = False, plane: str = "stress") -> dict[str, bytes]:
    """Write a mesh for Abaqus and CalculiX.

    Parameters
    ----------
    made
        The mesh; its texts become comments.
    deck
        False: the mesh alone, to be included. True: an analysis that runs, with an elastic material for each region (modulus 1000,
        Poisson's ratio 0.3, thickness 1: to be replaced) and a stretch of 0.1 % of the height of the mesh.
    plane
        Of flat meshes: "stress" (CPS3, CPS6) or "strain" (CPE3, CPE6). Wedges are C3D6 and C3D15, tetrahedra C3D4 and C3D10.

    Returns
    -------
    dict
        The bytes of the file, under "".

    Raises
    ------
    ParameterError
        If `plane` is another.
    MeshError
        If an analysis is wanted of wedges that do not stand in layers on a plane mesh.
    """
    letters = {"stress": "CPS", "strain": "CPE"}[choice("plane", plane, PLANES)]
    kind = _SOLID_ELEMENTS[made.kind] if made.solid else f"{letters}{_IN_PLANE[made.kind]}"
    named = set_identifiers(made, taken=(*_OWN, *_REFERENCE.values()))
    pairs = node_pairs(made)
    z = 0.0 if made.solid else float(made.points[0, 2])
    lines = ["*HEADING", "img2tri"] if deck else []
    lines += [f"** {MARK}", *comment_lines(made.texts, "** ")]
    lines += comment_lines({"labels": json.dumps({named[name]: label for label, name in made.names.items()})}, "** ")
    lines += comment_lines({plain: f"named {name}" for name, plain in named.items() if plain != name}, "** ")
    parts = ["\n".join([*lines, "*NODE\n"]), _nodes(made.points if made.solid else made.points * (1, 1, 0) + 0.0)]
    parts += [f"{line}\n" for line in comment_lines({"z": repr(z)} if z else {}, "** ")]
    for label, mine in made.members().items():
        parts.append(f"*ELEMENT, TYPE={kind}, ELSET={named[made.names[label]]}\n")
        parts.append(whole_rows(np.column_stack([mine + 1, made.cells[mine] + 1]), ", "))
    faces = next(numbers for first, numbers in _FACES.items() if made.kind.startswith(first))
    for name, sides in made.sides.items():
        nodes = in_lines((np.unique(made.facets(name)) + 1).tolist(), 16)
        parts.append("\n".join([f"*NSET, NSET={named[name]}", *nodes, f"*SURFACE, NAME={named[name]}, TYPE=ELEMENT\n"]))
        parts.append(whole_rows(np.stack([sides[:, 0] + 1, faces[sides[:, 1]]], axis=1), ", S"))
    lines = equations(made, pairs)
    if deck:
        lines += _analysis(made, [named[name] for name in made.names.values()], pairs)
    return {"": "".join([*parts, *(f"{line}\n" for line in lines)]).encode("ascii", "backslashreplace")}


def _nodes(points: Floats) -> str:
    columns = (fitted_numbers(column, 20) for column in points.T)
    return "".join(map("%d, %s, %s, %s\n".__mod__, zip(range(1, len(points) + 1), *columns, strict=True)))


def equations(made: Cells, pairs: list[NodePairs]) -> list[str]:
    """Return the nodes that stand for the stretch of a periodic mesh, and the equations that tie nodes to those they repeat.

    Where both sides meet, a corner would be tied twice; it is tied once, to the corner opposite, by the stretch along both axes.
    """
    if not pairs:
        return []
    reference = {axis: len(made.points) + i for i, axis in enumerate(made.periodic, 1)}
    low = made.points.min(axis=0)
    lines = []
    for axis, node in reference.items():
        lines += [f"*NODE, NSET={_REFERENCE[axis]}", f"{node}, " + ", ".join(fitted_number(float(x), 20) for x in low)]
    joined = {axis: np.concatenate([np.zeros((0, 2), np.int64), *(p.nodes for p in pairs if p.axis == axis)]) for axis in made.periodic}
    first, last = joined[made.periodic[0]], joined[made.periodic[-1]]
    tied = [(first, [reference[made.periodic[0]]])]
    if len(made.periodic) == 2:
        twice = np.isin(last[:, 0], first[:, 0])
        beyond = dict(first.tolist())
        corners = np.array([(node, beyond[other]) for node, other in last[twice].tolist()], np.int64).reshape(-1, 2)
        tied = [(first[~np.isin(first[:, 0], last[twice, 0])], [reference["x"]]), (last[~twice], [reference["y"]])]
        tied.append((corners, list(reference.values())))
    for nodes, others in tied:
        for freedom in range(1, 4 if made.solid else 3):
            ends = "".join(f", {other}, {freedom}, -1." for other in others)
            template = f"{2 + len(others)}\n%d, {freedom}, 1., %d, {freedom}, -1.{ends}"
            lines += ["*EQUATION", *map(template.__mod__, map(tuple, (nodes + 1).tolist()))] if len(nodes) else []
    return lines


def _analysis(made: Cells, regions: list[str], pairs: list[NodePairs]) -> list[str]:
    """Return material, section and one step of loading; nodes that repeat others follow them."""
    lines = []
    for name in regions:
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", "1000., 0.3", f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
        lines += [] if made.solid else ["1."]
    held, drawn = _held_and_drawn(made)
    free = np.ones(len(held), bool)
    free[[node for pair in pairs for node in pair.nodes[:, 0].tolist()]] = False
    last, up = 3 if made.solid else 2, fitted_number(_STRETCH * float(np.ptp(made.points[:, 1])), 20)
    lines += ["*NSET, NSET=HELD", *in_lines((np.flatnonzero(held & free) + 1).tolist(), 16)]
    stretched = "y" in made.periodic
    if not stretched:
        lines += ["*NSET, NSET=DRAWN", *in_lines((np.flatnonzero(drawn & free) + 1).tolist(), 16)]
    pulled = _REFERENCE["y"] if stretched else "DRAWN"
    # A cell that is stretched as a whole is held in one node, so that its ends may draw in.
    lines += ["*STEP", "*STATIC", "*BOUNDARY"]
    lines += [f"{np.flatnonzero(held & free)[0] + 1}, 1, {last}, 0."] if stretched else [f"HELD, 1, {last}, 0."]
    lines += [f"{pulled}, 1, 1, 0.", f"{pulled}, 2, 2, {up}"]
    lines += [f"{pulled}, 3, 3, 0."] if stretched and made.solid else []
    lines += [f"{_REFERENCE['x']}, 2, {last}, 0."] if "x" in made.periodic else []
    return [
        *lines, "*NODE FILE", "U, RF", "*EL FILE", "S", f"*NODE PRINT, NSET={pulled}, TOTALS=YES", "RF", "*END STEP",
    ]  # fmt: skip


def _held_and_drawn(made: Cells) -> tuple[Bools, Bools]:
    """Return the nodes at the lower end of each body, which is within one outer ring of the boundary, and those at its upper end."""
    if made.solid and (Z_MIN not in made.sides or made.kind.startswith("tetra")):
        raise MeshError(
            "deck: expected wedges in layers, so that their ends are known, found others; leave out cells=, or write the mesh alone"
        )
    flat = made.cells[: len(made.sides[Z_MIN]), :3] if made.solid else made.cells[:, :3]
    corners, y = flat.ravel(), made.points[:, 1]
    sides, ring, area = boundary_rings(made.points, flat)
    on = corners[sides]
    low, high = np.full(len(area), np.inf), np.full(len(area), -np.inf)
    np.minimum.at(low, ring, y[on])
    np.maximum.at(high, ring, y[on])
    share = (y[on] - low[ring]) / (high - low)[ring]
    held, drawn = on[(area[ring] >= 0) & (share <= _END)], on[(area[ring] >= 0) & (share >= 1 - _END)]
    # In a solid, what stands above these nodes too: it has the same x and y.
    place = made.points[:, 0] + 1j * y
    below = np.isin(place, place[held])
    return below, np.isin(place, place[drawn]) & ~below
