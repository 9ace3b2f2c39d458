"""MESH, the format of Medit and of FreeFem: vertices, edges, triangles and tetrahedra, each with a number.

The number of a triangle of a flat mesh, or a tetrahedron of a solid one, is that of its region; the number of an edge, or a triangle on the
surface or between regions, the tag of its set, or of its piece where the set has several. FreeFem finds them as labels: ``int1d(Th, 1001)``
is over the left side. Names are in comments at the beginning, FreeFem knows none. A solid has to be of tetrahedra, flat or solid of linear
cells: the format knows no others. A flat mesh has two coordinates, as FreeFem wants it; its height is in a comment.
"""

from __future__ import annotations

import numpy as np

from img2tri.errors import ParameterError
from img2tri.views.formats.number_rows import real_rows, whole_rows
from img2tri.views.formats.solvers.plain_text import MARK, comment_lines, distinct_names, label_table
from img2tri.views.objects.solver_cells import Cells


def medit(made: Cells) -> dict[str, bytes]:
    """Write a mesh as MESH; its texts become comments.

    Returns
    -------
    dict
        The bytes of the file, under "".

    Raises
    ------
    ParameterError
        If the cells are wedges, or quadratic.
    """
    if made.kind not in ("triangle", "tetra"):
        wanted = 'cells="tetrahedra"' if made.solid else "order=1"
        raise ParameterError(f"cells: expected triangles or tetrahedra of first order for .mesh, found {made.kind}; give {wanted}")
    split = set(made.part_of.values())
    sets = [name for name in made.sides if name not in split]
    ids = made.ids
    numbers = {name: ids[label] for label, name in made.names.items()} | made.tags
    height = {} if made.solid or not made.points[0, 2] else {"z": repr(float(made.points[0, 2]))}
    called = distinct_names(numbers, lambda name: " ".join(name.split()))
    lines = ["MeshVersionFormatted 2", f"# {MARK}", *comment_lines(made.texts | height | label_table(made, called), "# ")]
    lines += [f"# {number} {called[name]}".encode("ascii", "backslashreplace").decode() for name, number in numbers.items()]
    points = made.points if made.solid else made.points[:, :2]
    parts = ["\n".join(lines), f"\nDimension {points.shape[1]}\nVertices\n{len(points)}\n", real_rows(points, after=" 0")]
    facets = [np.column_stack([made.facets(name) + 1, np.full(len(made.sides[name]), made.tags[name])]) for name in sets]
    labels, which = np.unique(made.regions, return_inverse=True)
    cells = np.column_stack([made.cells + 1, np.array([ids[label] for label in labels.tolist()])[which]])
    for word, rows in zip(("Triangles", "Tetrahedra") if made.solid else ("Edges", "Triangles"), (facets, [cells]), strict=True):
        parts += [f"{word}\n{sum(map(len, rows))}\n", *map(whole_rows, rows)]
    return {"": "".join([*parts, "End\n"]).encode()}
