"""MESH, the format of Medit and FreeFem, read back: the bytes of a file -> triangles or tetrahedra, with regions, names and facets."""

from __future__ import annotations

import re

import numpy as np

from img2tri.arrays import Ints
from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, commented, labels_of, unescaped
from img2tri.views.objects.sets.named_sets import pieces_by_name

_SIZES = {"Vertices": 0, "Edges": 2, "Triangles": 3, "Tetrahedra": 4}


def parse_medit(data: bytes) -> Found:
    """Read the vertices, edges, triangles and tetrahedra of a file in text.

    Raises
    ------
    MeshError
        If there are neither triangles nor tetrahedra.
    ValueError, IndexError
        If the file is damaged, or of another kind.

    Examples
    --------
    >>> parse_medit(b"MeshVersionFormatted 2 Dimension 2 Vertices 3 0 0 0 1 0 0 0 1 0 Triangles 1 1 2 3 7 End").regions.tolist()
    [7]
    """
    text = data.decode()
    words = re.sub(r"#.*", "", text).split()
    dimension = int(words[words.index("Dimension") + 1])
    parts = {}
    for name, size in _SIZES.items():
        if name in words:
            at, width = words.index(name), (size or dimension) + 1
            count = int(words[at + 1])
            parts[name] = np.array(words[at + 2 : at + 2 + count * width], np.float64).reshape(count, width)
    solid = len(parts.get("Tetrahedra", ())) > 0
    cells = parts.get("Tetrahedra" if solid else "Triangles", np.zeros((0, 4)))
    if not len(cells):
        raise MeshError("expected triangles or tetrahedra, found none")
    texts = commented(text, "# ")
    points = np.pad(parts["Vertices"][:, :-1], ((0, 0), (0, 3 - dimension)))
    points[:, dimension:] = float(texts.pop("z", 0))
    nodes = cells[:, :-1].astype(np.int64) - 1
    if nodes.min() < 0 or nodes.max() >= len(points):
        raise ValueError("it has cells with nodes that are not there")
    called = {int(number): unescaped(name) for number, name in re.findall(r"^# (\d+) (.*)$", text, re.MULTILINE)}
    labels, names = labels_of(cells[:, -1].astype(np.int64), called, texts)
    rows = parts.get("Triangles" if solid else "Edges", np.zeros((0, 3))).astype(np.int64)
    return Found(points, nodes, "tetra" if solid else "triangle", labels, names, _facets(rows, called), texts=texts)


def _facets(rows: Ints, names: dict[int, str]) -> dict[str, Ints]:
    """Return the nodes of each set; what is in pieces is there as a whole too."""
    facets = {names[number]: rows[rows[:, -1] == number, :-1] - 1 for number in np.unique(rows[:, -1]).tolist() if number in names}
    wholes = pieces_by_name(names.values())
    for whole in dict.fromkeys(wholes.values()):
        parts = [facets[name] for name, of in wholes.items() if of == whole and name in facets]
        if parts and whole not in facets:
            facets[whole] = np.concatenate(parts)
    return facets
