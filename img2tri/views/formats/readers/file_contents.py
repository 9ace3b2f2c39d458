"""What a file holds: the record all readers return, with what they have in common."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.views.objects.sets.numbers_in_files import LARGEST_LABEL


@dataclass(frozen=True, eq=False)
class Found:
    """What a file holds.

    Attributes
    ----------
    points
        (p, 3) float64.
    cells, kind
        As in `img2tri.views.objects.solver_cells.Cells`.
    regions
        (m,) int64, the label of each cell: that in the name of its group or in the table of labels, else the number of its group or
        property; 0 without one.
    names
        Label -> name of the region; those without a name are missing.
    facets
        Name of each set -> the nodes of its facets, (k, 2 to 8) int64, or, where a format knows sets of nodes only, its nodes (k, 1).
    cell_data, point_data
        Name -> (m,) or (m, c) values of cells, (p,) or (p, c) of points.
    texts
        Name -> text, what img2tri wrote about the mesh.
    """

    points: Floats
    cells: Ints
    kind: str
    regions: Ints
    names: dict[int, str]
    facets: dict[str, Ints]
    cell_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)


def commented(lines: str, mark: str) -> dict[str, str]:
    r"""Return the texts in comments as `img2tri.views.formats.solvers.plain_text.comment_lines` writes them.

    Examples
    --------
    >>> commented("$ units: mm\n$ img2tri: {}\n$    , long", "$ ")
    {'units': 'mm', 'img2tri': '{}, long'}
    """
    whole = lines.replace("\n" + mark + "   ", "")
    return dict(re.findall(rf"^{re.escape(mark)}([\w ]+?): (.*)$", whole, re.MULTILINE))


def labels_of(numbers: Ints, names: Mapping[int, str], texts: Mapping[str, str]) -> tuple[Ints, dict[int, str]]:
    """Return the labels of cells from the numbers of their groups, and the names by label.

    Labels that cannot be such numbers are in a table, or in the name of a region that has none of its own.

    Examples
    --------
    >>> labels_of(np.array([5, 4]), {5: "region_-1", 4: "bone"}, {"labels": '{"bone": -7}'})
    (array([-1, -7]), {-1: 'region_-1', -7: 'bone'})
    """
    try:
        known = {str(name): int(label) for name, label in json.loads(texts.get("labels", "{}")).items()}
    except (ValueError, AttributeError, TypeError):
        known = {}
    each, which = np.unique(numbers, return_inverse=True)
    labels = {}
    for number in each.tolist():
        name = names.get(number, "")
        own = re.fullmatch(r"region_(-?\d+)", name)
        labels[number] = known.get(name, int(own[1]) if own and not 1 <= int(own[1]) <= LARGEST_LABEL else number)
    called = {labels[number]: name for number, name in names.items() if number in labels}
    return np.array([labels[number] for number in each.tolist()], np.int64)[which.ravel()], called


def parts_of_fields(fields: Mapping[str, NDArray[Any]], regions: Ints, texts: Mapping[str, str]) -> tuple[dict[int, str], dict[str, Ints]]:
    """Return the names of regions and the facets of sets from the field data of VTK: an integer each, the label, and rows of nodes.

    The names as the user wrote them are in what img2tri wrote about the mesh; VTK has them without some characters.
    """
    try:
        about = json.loads(texts.get("img2tri", "{}"))
        given = {int(label): str(name) for label, name in about.get("names", {}).items()}
    except (ValueError, AttributeError, TypeError):
        given = {}
    whole = {name: values for name, values in fields.items() if values.dtype.kind in "iu"}
    there = set(np.unique(regions).tolist())
    names = {int(values.ravel()[0]): name for name, values in whole.items() if values.size == 1 and int(values.ravel()[0]) in there}
    names |= {label: name for label, name in given.items() if label in there}
    return names, {name: values.astype(np.int64) for name, values in whole.items() if values.ndim == 2 and values.shape[1] > 1}


def unescaped(text: str) -> str:
    """Turn what was written in ASCII back into the letters it stands for."""
    return re.sub(r"\\x[0-9a-f]{2}|\\u[0-9a-f]{4}|\\U[0-9a-f]{8}", lambda code: chr(int(code[0][2:], 16)), text)
