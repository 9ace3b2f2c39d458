"""BDF, the bulk data of Nastran: GRID, CTRIA3 / CTRIA6 or CPENTA, a property for each region, a SET1 of nodes for each set of facets.

The property of an element has the number of its region's label, or, as the format counts from 1, the next free one for labels below 1;
the cards of properties and materials are left to the user. A SET1 has the number of its tag. Nastran knows no names; they are in the
comments that HyperMesh writes and reads, ``$HMNAME COMP`` before the elements of a region and ``$HMSET`` before a set. Coordinates have
16 characters, in fixed columns.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, fitted_number, in_lines, numbered
from img2tri.views.objects.solver_cells import Cells

# Card of each kind, and its order of the nodes where that is not the one of VTK: upright edges come before those of the top.
_CARDS = {"triangle": "CTRIA3", "triangle6": "CTRIA6", "wedge": "CPENTA", "wedge15": "CPENTA"}
NASTRAN_ORDERS = {"wedge15": [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11]}
_FIELDS = 8  # of 8 characters each in a line, between name and continuation


def bdf(made: Cells) -> dict[str, bytes]:
    """Write a mesh as the bulk data of Nastran; its texts become comments.

    Returns
    -------
    dict
        The bytes of the file, under "".
    """
    lines = [f"$ {MARK}", *comment_lines(made.texts, "$ "), "CEND", "BEGIN BULK", *_grid_cards(made.points)]
    cells = made.cells[:, NASTRAN_ORDERS.get(made.kind, slice(None))] + 1
    for label, name in made.names.items():
        mine, number = np.flatnonzero(made.regions == label), made.ids[label]
        lines.append(f"$HMNAME COMP {number:>19}{_quoted(name)}")
        numbers = [f"{i:<8}" for i in (mine + 1).tolist()]
        lines += numbered(_template(_CARDS[made.kind], cells.shape[1]), cells[mine], numbers, f"{number:<8}")
    for name in made.sides:
        lines.append(f"$HMSET {made.tags[name]:>8} {1:>8} {_quoted(name)}")
        nodes = (np.unique(made.facets(name)) + 1).tolist()
        first, rest = nodes[: _FIELDS - 1], nodes[_FIELDS - 1 :]
        lines.append(f"{'SET1':<8}{made.tags[name]:<8}" + "".join(f"{node:<8}" for node in first))
        lines += [f"{'+':<8}{line}" for line in in_lines([f"{node:<8}" for node in rest], _FIELDS, "")]
    return {"": ("\n".join(line.rstrip() for line in [*lines, "ENDDATA"]) + "\n").encode("ascii", "backslashreplace")}


def _grid_cards(points: Floats) -> list[str]:
    """Write points in the large format: two lines each, for the fields of 16 characters."""
    x, y, z = ([fitted_number(value, 16) for value in column] for column in points.T.tolist())
    return [f"GRID*   {i:<16}{'':16}{a:<16}{b}\n*       {c}" for i, (a, b, c) in enumerate(zip(x, y, z, strict=True), 1)]


def _template(card: str, nodes: int) -> str:
    """Return the line, or lines, of an element; `numbered` fills in its number, its property and its nodes."""
    fields = ["{}", "{}", *["{:<8}"] * nodes]
    lines = ["".join(fields[i : i + _FIELDS]) for i in range(0, len(fields), _FIELDS)]
    return f"{card:<8}" + f"\n{'+':<8}".join(lines)


def _quoted(name: str) -> str:
    """Return a name in double quotes."""
    return '"' + " ".join(name.replace('"', "'").split()) + '"'
