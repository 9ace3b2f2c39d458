"""BDF, the bulk data of Nastran: GRID, CTRIA3 / CTRIA6 or CPENTA, a property for each region, a SET1 of nodes for each set of facets.

The property of an element has the number of its region's label, or, as the format counts from 1, the next free one for labels below 1;
the cards of properties and materials are left to the user. A SET1 has the number of its tag. Nastran knows no names; they are in the
comments that HyperMesh writes and reads, ``$HMNAME COMP`` before the elements of a region and ``$HMSET`` before a set. Coordinates have
16 characters, in fixed columns; numbers of properties and sets that have more than 8 digits are in the large format too.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Floats
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, distinct_names, fitted_numbers, label_table, unquoted
from img2tri.views.objects.solver_cells import Cells

# Card of each kind, and its order of the nodes where that is not the one of VTK: upright edges come before those of the top.
_CARDS = {"triangle": "CTRIA3", "triangle6": "CTRIA6", "wedge": "CPENTA", "wedge15": "CPENTA", "tetra": "CTETRA", "tetra10": "CTETRA"}
NASTRAN_ORDERS = {"wedge15": [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11]}
_WIDTH = 8  # characters of a field
_FIELDS = 8  # in a line, between name and continuation


def bdf(made: Cells) -> dict[str, bytes]:
    """Write a mesh as the bulk data of Nastran; its texts become comments.

    Returns
    -------
    dict
        The bytes of the file, under "".
    """
    called = distinct_names([*made.names.values(), *made.sides], unquoted)
    lines = [f"$ {MARK}", *comment_lines(made.texts | label_table(made, called), "$ "), "CEND", "BEGIN BULK", *_grid_cards(made.points)]
    cells = made.cells[:, NASTRAN_ORDERS.get(made.kind, slice(None))] + 1
    ids = made.ids
    for label, mine in made.members().items():
        number = ids[label]
        lines.append(f'$HMNAME COMP {number:>19}"{called[made.names[label]]}"')
        table = np.column_stack([mine + 1, np.full(len(mine), number), cells[mine]])
        lines += map(_template(_CARDS[made.kind], table.shape[1], number).__mod__, map(tuple, table.tolist()))
    for name in made.sides:
        tag, nodes = made.tags[name], (np.unique(made.facets(name)) + 1).tolist()
        lines.append(f'$HMSET {tag:>8} {1:>8} "{called[name]}"')
        lines.append(_template("SET1", 1 + len(nodes), tag) % (tag, *nodes))
    return {"": ("\n".join(line.rstrip() for line in [*lines, "ENDDATA"]) + "\n").encode("ascii", "backslashreplace")}


def _grid_cards(points: Floats) -> list[str]:
    """Write points in the large format: two lines each, for the fields of 16 characters."""
    columns = (fitted_numbers(column, 2 * _WIDTH) for column in points.T)
    template = f"GRID*   %-16d{'':16}%-16s%-16s\n*       %s"
    return list(map(template.__mod__, ((i, x, y, z) for i, (x, y, z) in enumerate(zip(*columns, strict=True), 1))))


def _template(card: str, count: int, largest: int) -> str:
    """Return the lines of a card of `count` whole numbers, to be filled in: columns of 8 characters, or of 16 where one needs them."""
    wide = largest >= 10**_WIDTH
    width, each, mark = (2 * _WIDTH, _FIELDS // 2, "*") if wide else (_WIDTH, _FIELDS, "")
    lines = [f"%-{width}d" * min(each, count - i) for i in range(0, count, each)]
    return f"{card + mark:<{_WIDTH}}" + f"\n{mark or '+':<{_WIDTH}}".join(lines)
