"""MSH and BDF read back: the bytes of a file -> cells of one kind, with regions, names, and the facets of each set.

What img2tri writes is read completely. Of the files of other programs, those in text are read whose cells of highest dimension are all
triangles, all wedges or all tetrahedra, linear or quadratic.
"""

from __future__ import annotations

import json
import re
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats, Ints
from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, commented, labels_of, unescaped
from img2tri.views.formats.solvers import bdf, msh

# Number of nodes of each of Gmsh's types of element.
_NODES = (0, 2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13)
_GMSH = {number: kind for kind, number in msh.GMSH_TYPES.items()}
_NASTRAN = {("CTRIA3", 3): "triangle", ("CTRIA6", 6): "triangle6", ("CPENTA", 6): "wedge", ("CPENTA", 15): "wedge15"}
_NASTRAN |= {("CTETRA", 4): "tetra", ("CTETRA", 10): "tetra10"}


# Dimension, physical groups, Gmsh's type, and rows that hold the number of an element and those of its nodes.
_Blocks = list[tuple[int, tuple[int, ...], int, Ints]]


def parse_msh(data: bytes) -> Found:
    """Read MSH 2.2 or 4.1 in text.

    Raises
    ------
    MeshError
        If there are no cells of a kind that is read, or several kinds.
    ValueError, KeyError, IndexError
        If the file is damaged, in binary, or no MSH.
    """
    text = data.decode()
    sections = dict(re.findall(r"^\$(\w+)\s*\n(.*?)^\$End\1\s*$", text, re.DOTALL | re.MULTILINE))
    version, binary, _ = sections["MeshFormat"].split()
    if version not in msh.VERSIONS or binary != "0":
        raise ValueError(f"expected MSH 2.2 or 4.1 in text, found {version} in {'text' if binary == '0' else 'binary'}")
    texts = commented(sections.get("Comments", ""), "")
    pieces = {int(number): name for name, number in json.loads(texts.pop("pieces", "{}")).items()}
    numbers, points, blocks = _read_version_4(sections) if version == "4.1" else _read_version_2(sections, pieces)
    place = np.full(int(numbers.max(initial=0)) + 1, -1)
    place[numbers] = np.arange(len(numbers))
    names = {
        (int(dimension), int(group)): name
        for dimension, group, name in re.findall(r'^\s*(\d+)\s+(\d+)\s+"(.*)"\s*$', sections.get("PhysicalNames", ""), re.MULTILINE)
    }
    top = max((dimension for dimension, *_ in blocks), default=0)
    names |= {(top - 1, number): name for number, name in pieces.items()}
    inside = [(_GMSH.get(number, ""), groups[0], rows) for dimension, groups, number, rows in blocks if dimension == top]
    kind, table = _one_kind([(kind, np.insert(rows, 1, group, axis=1)) for kind, group, rows in inside])
    facets = defaultdict(list)
    for dimension, groups, _, rows in blocks:
        for group in groups:
            if dimension == top - 1 and (dimension, group) in names:
                facets[names[dimension, group]].append(place[rows[:, 1:]])
    alike = {name: np.concatenate(parts) for name, parts in facets.items() if len({part.shape[1] for part in parts}) == 1}
    called = {group: name for (dimension, group), name in names.items() if dimension == top}
    found = _assembled(points, table, place, kind, msh.GMSH_ORDERS, called, alike, texts)
    cells = {name: values[:, 1:] for name, values in _data(sections_of(text, "ElementData"), np.sort(table[:, 0])).items()}
    nodes = {name: values[:, 1:] for name, values in _data(sections_of(text, "NodeData"), numbers).items()}
    return replace(found, cell_data=_columns(cells), point_data=_columns(nodes))


def sections_of(text: str, name: str) -> list[str]:
    """Return what is in all sections of a name; there may be several of data."""
    return re.findall(rf"^\${name}\s*\n(.*?)^\$End{name}\s*$", text, re.DOTALL | re.MULTILINE)


def _data(sections: list[str], numbers: Ints) -> dict[str, Floats]:
    """Return the rows of each array, in the order of `numbers`, if it has one for each of them."""
    found = {}
    for section in sections:
        lines = section.splitlines()
        texts = int(lines[0])
        name, at = lines[1].strip().strip('"'), 1 + texts
        at += 1 + int(lines[at])
        whole = [int(line) for line in lines[at + 1 : at + 1 + int(lines[at])]]
        rows = np.array(" ".join(lines[at + 1 + len(whole) :]).split(), np.float64).reshape(whole[2], 1 + whole[1])
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        mine = rows[np.isin(rows[:, 0], numbers)]
        if np.array_equal(mine[:, 0], numbers):
            found[name] = mine
    return found


def _columns(arrays: dict[str, Floats]) -> dict[str, NDArray[Any]]:
    return {name: values[:, 0] if values.shape[1] == 1 else values for name, values in arrays.items()}


def parse_bdf(data: bytes) -> Found:
    """Read the bulk data of Nastran: GRID, triangles or wedges, SET1, and names in the comments of HyperMesh.

    Raises
    ------
    MeshError
        If there are no cells of a kind that is read, or several kinds.
    ValueError, KeyError, IndexError
        If the file is damaged, or no bulk data.
    """
    text = data.decode()
    places: dict[int, list[float]] = {}
    rows: dict[str, list[list[int]]] = defaultdict(list)
    sets: dict[int, list[int]] = {}
    for card, *fields in _cards(text):
        if card == "GRID":
            places[int(fields[0])] = [_real(field) for field in fields[2:5]]
        elif card in {name for name, _ in _NASTRAN}:
            row = [int(field) for field in fields if field]
            rows[_NASTRAN[card, len(row) - 2]].append(row)
        elif card == "SET1":
            sets[int(fields[0])] = [int(field) for field in fields[1:] if field]
    kind, table = _one_kind([(kind, np.array(row)) for kind, row in rows.items()])
    numbers = np.array(sorted(places))
    place = np.full(int(numbers.max(initial=0)) + 1, -1)
    place[numbers] = np.arange(len(numbers))
    called = {int(number): unescaped(name) for number, name in re.findall(r'^\$HMNAME COMP\s+(\d+)\s*"(.*?)"', text, re.MULTILINE)}
    known = {int(number): unescaped(name) for number, name in re.findall(r'^\$HMSET\s+(\d+)\s+1\s*"(.*?)"', text, re.MULTILINE)}
    nodes = {known[number]: place[members][:, None] for number, members in sets.items() if number in known}
    points = np.array([places[number] for number in numbers.tolist()])
    return _assembled(points, table, place, kind, bdf.NASTRAN_ORDERS, called, nodes, commented(text, "$ "))


def by_text(data: bytes, suffix: str) -> tuple[Floats, Ints, Ints]:
    """Read points (p, 3), triangles (k, 3) and regions (k,) of .msh or .bdf.

    Raises
    ------
    MeshError
        If the cells are no linear triangles.
    ValueError, KeyError, IndexError
        If the file is damaged, or of another kind.
    """
    found = READERS[suffix](data)
    if found.kind != "triangle":
        raise MeshError(f"expected triangles of three nodes, found {found.kind}")
    return found.points, found.cells, found.regions


def _assembled(
    points: Floats, table: Ints, place: Ints, kind: str, orders: dict[str, list[int]], names: dict[int, str], facets: dict[str, Ints],
    texts: dict[str, str],
) -> Found:  # fmt: skip
    """Put together what was read; `table` has for each cell its number, that of its region, and those of its nodes, in `orders`."""
    table = table[np.argsort(table[:, 0], kind="stable")]
    cells = place[table[:, 2:]][:, np.argsort(orders[kind]) if kind in orders else slice(None)]
    if any(rows.min(initial=0) < 0 for rows in (cells, *facets.values())):
        raise ValueError("it has cells with nodes that are not there")
    labels, called = labels_of(table[:, 1], names, texts)
    return Found(points, cells, kind, labels, called, facets, texts=texts)


def _one_kind(parts: list[tuple[str, NDArray[Any]]]) -> tuple[str, NDArray[Any]]:
    """Return the kind of all cells, and the cells."""
    kinds = {kind for kind, _ in parts}
    if len(kinds) != 1 or "" in kinds:
        raise MeshError("expected cells that are all triangles, all wedges or all tetrahedra, found " + ("others" if kinds else "none"))
    return kinds.pop(), np.concatenate([rows for _, rows in parts])


def _read_version_4(sections: dict[str, str]) -> tuple[Ints, Floats, _Blocks]:
    """Return the numbers of the nodes, their places, and the blocks of elements."""
    words = iter(map(float, sections.get("Entities", "0 0 0 0").split()))
    group = {}
    for dimension, count in enumerate([int(next(words)) for _ in range(4)]):
        for _ in range(count):
            number = int(next(words))
            for _ in range(6 if dimension else 3):
                next(words)
            groups = [int(next(words)) for _ in range(int(next(words)))]
            for _ in range(int(next(words)) if dimension else 0):
                next(words)
            group[dimension, number] = tuple(groups) or (0,)
    values = np.array(sections["Nodes"].split(), np.float64)
    count, at, numbers, points = int(values[0]), 4, [np.zeros(0, np.int64)], [np.zeros((0, 3))]
    for _ in range(count):
        dimension, _, parametric, n = values[at : at + 4].astype(np.int64)
        width = 3 + int(parametric) * int(dimension)
        numbers.append(values[at + 4 : at + 4 + n].astype(np.int64))
        points.append(values[at + 4 + n : at + 4 + n * (1 + width)].reshape(n, width)[:, :3])
        at += 4 + n * (1 + width)
    whole = np.array(sections["Elements"].split(), np.int64)
    count, at, blocks = int(whole[0]), 4, []
    for _ in range(count):
        dimension, entity, kind, n = whole[at : at + 4].tolist()
        rows = whole[at + 4 : at + 4 + n * (1 + _NODES[kind])].reshape(n, 1 + _NODES[kind])
        blocks.append((dimension, group.get((dimension, entity), (0,)), kind, rows))
        at += 4 + rows.size
    order = np.argsort(all_numbers := np.concatenate(numbers), kind="stable")
    return all_numbers[order], np.concatenate(points)[order], blocks


def _read_version_2(sections: dict[str, str], pieces: Collection[int]) -> tuple[Ints, Floats, _Blocks]:
    """Return the numbers of the nodes, their places, and the blocks of elements; entities that are `pieces` are groups too."""
    nodes = np.array(sections["Nodes"].split()[1:], np.float64).reshape(-1, 4)
    rows: dict[tuple[int, tuple[int, ...]], list[list[int]]] = defaultdict(list)
    for line in sections["Elements"].splitlines()[1:]:
        numbers = [int(word) for word in line.split()]
        tags = numbers[3 : 3 + numbers[2]]
        groups = (tags[0] if tags else 0, *(tag for tag in tags[1:2] if tag in pieces))
        rows[numbers[1], groups].append([numbers[0], *numbers[3 + numbers[2] :]])
    blocks: _Blocks = [(_DIMENSIONS[kind], groups, kind, np.array(elements)) for (kind, groups), elements in rows.items()]
    return nodes[:, 0].astype(np.int64), nodes[:, 1:], blocks


_DIMENSIONS = {**dict.fromkeys((15,), 0), **dict.fromkeys((1, 8), 1), **dict.fromkeys((2, 3, 9, 10, 16), 2)}
_DIMENSIONS |= {kind: 3 for kind in range(1, len(_NODES)) if kind not in _DIMENSIONS}


def _cards(text: str) -> Iterator[list[str]]:
    """Cut bulk data into cards: the name without a star, and its fields, those of continuation lines included."""
    card: list[str] = []
    for line in text.splitlines():
        if not line.strip() or line.startswith("$"):
            continue
        if "," in line:
            fields = [field.strip() for field in line.split(",")][:9]
        else:
            width = 16 if line[:8].rstrip().endswith("*") else 8
            fields = [line[:8].strip(), *(line[i : i + width].strip() for i in range(8, 72, width))]
        if fields[0].strip("+*") == "" or fields[0].startswith("+"):
            card += fields[1:]
        else:
            if card:
                yield card
            card = [fields[0].rstrip("*").upper(), *fields[1:]]
    if card:
        yield card


def _real(text: str) -> float:
    """Read a number as Nastran writes it: an exponent may follow behind a D, or no letter at all; nothing is 0."""
    return float(re.sub(r"(?<=[\d.])D?([+-]?\d+)$", r"E\1", text) if re.search(r"[\d.](D|[+-]\d)", text) else text or 0)


READERS = {".msh": parse_msh, ".bdf": parse_bdf}
