"""INP, the format of Abaqus and CalculiX: nodes, elements, and NSET, ELSET and SURFACE for every name.

Each region is an ELSET; each set of facets an NSET of its nodes and a SURFACE of its element sides, an interface that of the region that
comes first in its name. The file holds the mesh and nothing else, to be included in an analysis by ``*INCLUDE, INPUT=mesh.inp``, or in a
``*PART``. Names are made to fit, see `img2tri.views.formats.solvers.plain_text`; comments tell where one had to be changed, and the label
of each region. Lines and numbers keep to the limits of Abaqus, 20 characters for a number. Plane elements lie at z = 0, whatever the height
of the mesh, as CalculiX takes no others.

With ``deck=True`` it is an analysis that runs as it is, to be filled with the materials and loads of the user: every separate body is held
at its lowest boundary vertices and drawn up at its highest.
"""

from __future__ import annotations

import json
from itertools import chain

import numpy as np

from img2tri.arrays import Bools, Floats
from img2tri.errors import MeshError, choice
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, fitted_number, identifiers, in_lines, numbered
from img2tri.views.objects.named_sets import boundary_rings
from img2tri.views.objects.solver_cells import Z_MIN, Cells

PLANES = ("stress", "strain")
_SOLID_ELEMENTS = {"wedge": "C3D6", "wedge15": "C3D15"}  # nodes in the order of VTK
_IN_PLANE = {"triangle": 3, "triangle6": 6}
_FACES = {True: np.array([3, 4, 5, 1, 2]), False: np.array([1, 2, 3])}  # Abaqus's number of each side, of wedges and triangles
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
        Of flat meshes: "stress" (CPS3, CPS6) or "strain" (CPE3, CPE6). Wedges are C3D6 and C3D15.

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
    named = identifiers(chain(made.names.values(), made.sides), taken=("HELD", "DRAWN"))
    lines = ["*HEADING", "img2tri"] if deck else []
    lines += [f"** {MARK}", *comment_lines(made.texts, "** ")]
    lines += comment_lines({"labels": json.dumps({named[name]: label for label, name in made.names.items()})}, "** ")
    lines += comment_lines({plain: f"named {name}" for name, plain in named.items() if plain != name}, "** ")
    lines += ["*NODE", *_nodes(made.points if made.solid else made.points * (1, 1, 0) + 0.0)]
    for label, name in made.names.items():
        mine = np.flatnonzero(made.regions == label)
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={named[name]}")
        lines += numbered("{}" + ", {}" * made.cells.shape[1], made.cells[mine] + 1, mine + 1)
    for name, sides in made.sides.items():
        lines += [f"*NSET, NSET={named[name]}", *in_lines((np.unique(made.facets(name)) + 1).tolist(), 16)]
        numbers = _FACES[made.solid][sides[:, 1]]
        lines += [f"*SURFACE, NAME={named[name]}, TYPE=ELEMENT", *numbered("{}, S{}", numbers[:, None], sides[:, 0] + 1)]
    if deck:
        lines += _analysis(made, [named[name] for name in made.names.values()])
    return {"": ("\n".join(lines) + "\n").encode("ascii", "backslashreplace")}


def _nodes(points: Floats) -> list[str]:
    texts = [[fitted_number(x, 20) for x in column] for column in points.T.tolist()]
    return [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(zip(*texts, strict=True), 1)]


def _analysis(made: Cells, regions: list[str]) -> list[str]:
    """Return material, section and one step of loading."""
    lines = []
    for name in regions:
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", "1000., 0.3", f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
        lines += [] if made.solid else ["1."]
    held, drawn = _held_and_drawn(made)
    up = fitted_number(_STRETCH * float(np.ptp(made.points[:, 1])), 20)
    return [
        *lines,
        "*NSET, NSET=HELD", *in_lines((np.flatnonzero(held) + 1).tolist(), 16),
        "*NSET, NSET=DRAWN", *in_lines((np.flatnonzero(drawn) + 1).tolist(), 16),
        "*STEP", "*STATIC",
        "*BOUNDARY", f"HELD, 1, {3 if made.solid else 2}, 0.", "DRAWN, 1, 1, 0.", f"DRAWN, 2, 2, {up}",
        "*NODE FILE", "U, RF", "*EL FILE", "S", "*NODE PRINT, NSET=DRAWN, TOTALS=YES", "RF",
        "*END STEP",
    ]  # fmt: skip


def _held_and_drawn(made: Cells) -> tuple[Bools, Bools]:
    """Return the nodes at the lower end of each body, which is within one outer ring of the boundary, and those at its upper end."""
    if made.solid and Z_MIN not in made.sides:
        raise MeshError("deck: expected wedges in layers, so that their ends are known, found others; write the mesh alone")
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
