"""INP read back: the bytes of a file of Abaqus or CalculiX -> cells of one kind, with regions, names, and the facets of each set.

What img2tri writes is read completely. Of the files of other programs those are read whose elements are all triangles, all wedges or all
tetrahedra, and lines beside triangles, with no parts or instances. Each ELSET of ``*ELEMENT`` is a region, or, where sets of ``*ELSET``
have each element once, each of these; sets of lines are sets of edges.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import numpy as np

from img2tri.arrays import Ints
from img2tri.errors import MeshError
from img2tri.views.formats.readers.file_contents import Found, commented, unescaped
from img2tri.views.objects.solver_cells import CELL_SIDES, FLAT_KINDS, SOLID_KINDS

# Families of elements of Abaqus; behind their letters stands the number of nodes, then at most letters for variants.
_FLAT_ELEMENTS = re.compile(r"(?:CPS|CPE|CPEG|CAX|M3D|DC2D|DCAX|STRI|SFM3D|R3D|S)([36])[A-Z]*")
_SOLID_ELEMENTS_READ = re.compile(r"(?:C3D|DC3D|AC3D)(6|15|4|10)[A-Z]*")
_SOLID_KINDS_READ = {**SOLID_KINDS, 4: "tetra", 10: "tetra10"}
_LINES = re.compile(r"(?:T2D|T3D|B2|B3|B)[123]\d?[A-Z]*")
# Our number of each side, in the order of Abaqus.
_ABAQUS_SIDES = {"triangle": (0, 1, 2), "wedge": (3, 4, 0, 1, 2), "tetra": (0, 1, 2, 3)}


def is_abaqus(data: bytes) -> bool:
    """Tell an INP of Abaqus, whose first line is a keyword or a comment, from one of AVS, which begins with numbers or ``#``.

    Examples
    --------
    >>> is_abaqus(b"** mesh"), is_abaqus(b"# AVS"), is_abaqus(b"8 1 0 0 0")
    (True, False, False)
    """
    return data.lstrip()[:1] == b"*"


def parse_inp(data: bytes) -> Found:
    r"""Read nodes, elements, SURFACE and NSET.

    Labels of regions are those in the comments of img2tri; of others they are numbers from 1 on.

    Raises
    ------
    MeshError
        If there are no cells of a kind that is read, or several kinds.
    ValueError, KeyError, IndexError
        If the file is damaged, or no INP.

    Examples
    --------
    >>> found = parse_inp(b"*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=S3, ELSET=wing\n1, 1, 2, 3\n")
    >>> found.cells.tolist(), found.kind, found.names
    ([[0, 1, 2]], 'triangle', {1: 'wing'})
    """
    text = data.decode().replace("\r\n", "\n")
    said = commented(text, "** ")
    called = {plain: unescaped(line.removeprefix("named ")) for plain, line in said.items() if line.startswith("named ")}
    blocks = list(_keyword_blocks(text))
    rows = [[*map(float, line.strip(" ,").split(",")), 0.0][:4] for key, _, lines in blocks if key == "NODE" for line in lines]
    nodes = np.array(rows).reshape(-1, 4)
    numbers = nodes[:, 0].astype(np.int64)

    whole = [(options, lines) for key, options, lines in blocks if key == "ELEMENT"]
    parts = [(options.get("ELSET", ""), lines) for options, lines in whole if not _LINES.fullmatch(options["TYPE"].upper())]
    kind, width = _kind({options["TYPE"].upper() for options, _ in whole} - {o["TYPE"].upper() for o, _ in whole if _is_line(o)})
    tables = [np.array(_whole_numbers(lines)).reshape(-1, 1 + width) for _, lines in parts]
    labels = _labels_of_sets([name for name, _ in parts], json.loads(said.get("labels", "{}")))
    order = np.argsort(np.concatenate(tables)[:, 0], kind="stable")
    elements = np.concatenate(tables)[order]
    regions = np.repeat([labels[name] for name, _ in parts], [len(table) for table in tables])[order]
    cells = _rows_of(numbers, elements[:, 1:])
    sets = _members(blocks)
    if "labels" not in said:
        regions, labels = _by_sets(sets, elements[:, 0], regions, labels)

    explicit = {options["ELSET"] for key, options, _ in blocks if key == "ELSET"}
    listed = {number for name in explicit for number in sets[name]}
    lines_of = {row[0]: row[1:3] for options, lines in whole if _is_line(options) for row in _integer_rows(lines)}
    facets = {
        name: _rows_of(numbers, np.array([lines_of[number] for number in mine]))
        for name, mine in sets.items()
        if mine and all(number in lines_of for number in mine) and (name in explicit or not listed.issuperset(mine))
    }
    for key, options, lines in blocks:
        if key == "NSET":
            facets[options["NSET"]] = _rows_of(numbers, np.array(_listed(options, lines), np.int64)[:, None])
    for key, options, lines in blocks:
        if key == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            single = [f"{number},{side}" for line in lines for number, side in _one_by_one(line, sets)]
            facets |= _facets(options["NAME"], single, elements[:, 0], cells, kind)
    names = {label: called.get(name, name) for name, label in labels.items() if name}
    facets = {called.get(name, name): part for name, part in facets.items() if not name.startswith("PERIODIC_")}
    texts = {name: text for name, text in said.items() if not text.startswith("named ")}
    # Nodes that stand for the stretch of a periodic mesh, after all others, are no part of the mesh.
    points = nodes[: 1 + int(cells.max()), 1:]
    points[:, 2] += float(texts.pop("z", 0))  # plane elements are written at 0
    return Found(points, cells, kind, regions, names, facets, texts=texts)


def _keyword_blocks(text: str) -> Iterator[tuple[str, dict[str, str], list[str]]]:
    """Cut an INP into keywords, their options, and their lines of data."""
    keyword, data = "", list[str]()
    for line in [*text.splitlines(), "*"]:
        if line.startswith("*") and not line.startswith("**"):
            key, *options = keyword.split(",")
            pairs = (option.partition("=") for option in options)
            yield key.strip().upper(), {name.strip().upper(): value.strip() for name, _, value in pairs}, data
            keyword, data = line[1:], []
        elif line.strip() and not line.startswith("**"):
            data.append(line)


def _whole_numbers(lines: list[str]) -> list[int]:
    return [int(word) for line in lines for word in line.split(",") if word.strip()]


def _integer_rows(lines: list[str]) -> list[list[int]]:
    return [_whole_numbers([line]) for line in lines]


def _is_line(options: dict[str, str]) -> bool:
    return _LINES.fullmatch(options["TYPE"].upper()) is not None


def _listed(options: dict[str, str], lines: list[str]) -> list[int]:
    """Return the numbers in a set: as listed, or from the first to the last in steps."""
    if "GENERATE" not in options:
        return [int(word) for line in lines for word in line.split(",") if word.strip().isdigit()]
    return [number for first, last, *step in _integer_rows(lines) for number in range(first, last + 1, *step)]


def _members(blocks: list[tuple[str, dict[str, str], list[str]]]) -> dict[str, list[int]]:
    """Return the numbers of the elements in each set, also of sets that are named in others."""
    sets: dict[str, list[int]] = {}
    for key, options, lines in blocks:
        if key == "ELEMENT" and "ELSET" in options:
            sets.setdefault(options["ELSET"], []).extend(row[0] for row in _integer_rows(lines) if row)
        elif key == "ELSET":
            named = [word.strip() for line in lines for word in line.split(",") if word.strip() in sets]
            sets.setdefault(options["ELSET"], []).extend([*_listed(options, lines), *(number for name in named for number in sets[name])])
    return sets


def _by_sets(sets: dict[str, list[int]], numbers: Ints, regions: Ints, labels: dict[str, int]) -> tuple[Ints, dict[str, int]]:
    """Return the regions and labels of elements: those of sets that have each element once and say more than the blocks of elements."""
    mine = {name: np.flatnonzero(np.isin(numbers, rows)) for name, rows in sets.items() if name not in labels}
    mine = {name: rows for name, rows in mine.items() if len(rows)}
    if not mine or not np.array_equal(np.sort(np.concatenate(list(mine.values()))), np.arange(len(numbers))):
        return regions, labels
    found = np.empty_like(regions)
    for label, rows in enumerate(mine.values(), 1):
        found[rows] = label
    return found, {name: label for label, name in enumerate(mine, 1)}


def _one_by_one(line: str, sets: dict[str, list[int]]) -> list[tuple[str, str]]:
    """Return the elements and sides of a line of a surface: an element, or a set of them, and a side."""
    who, _, side = (word.strip() for word in line.partition(","))
    return [(str(number), side) for number in sets[who]] if who in sets else [(who, side)]


def _kind(types: set[str]) -> tuple[str, int]:
    """Return the kind of cells that all these types of elements are, and its number of nodes."""
    kinds = set()
    for name in types:
        flat, solid = _FLAT_ELEMENTS.fullmatch(name), _SOLID_ELEMENTS_READ.fullmatch(name)
        kinds.add(
            (FLAT_KINDS[int(flat[1])], int(flat[1])) if flat else (_SOLID_KINDS_READ[int(solid[1])], int(solid[1])) if solid else ("", 0)
        )
    if len(kinds) != 1 or ("", 0) in kinds:
        raise MeshError("expected cells that are all triangles, all wedges or all tetrahedra, found " + ("others" if kinds else "none"))
    return kinds.pop()


def _labels_of_sets(sets: list[str], known: dict[str, int]) -> dict[str, int]:
    """Return the label of each set of elements: that which is known, or the next free number."""
    labels = {name: int(known[name]) for name in sets if name in known}
    for name in sets:
        labels.setdefault(name, max(0, *labels.values()) + 1 if labels else 1)
    return labels


def _rows_of(numbers: Ints, wanted: Ints) -> Ints:
    """Look up in which rows the nodes have these numbers."""
    order = np.argsort(numbers)
    found = order[np.searchsorted(numbers, wanted, sorter=order).clip(max=len(numbers) - 1)]
    if (numbers[found] != wanted).any():
        raise ValueError("it has cells with nodes that are not there")
    return np.asarray(found, np.int64)


def _facets(name: str, lines: list[str], numbers: Ints, cells: Ints, kind: str) -> dict[str, Ints]:
    """Return the nodes of the sides of elements that make a surface, if all are given one by one, and alike."""
    rows = [re.fullmatch(r"\s*(\d+)\s*,\s*S(\d)\s*,?\s*", line, re.IGNORECASE) for line in lines]
    order = next(sides for first, sides in _ABAQUS_SIDES.items() if kind.startswith(first))
    sides = [(int(row[1]), CELL_SIDES[kind][order[int(row[2]) - 1]]) for row in rows if row]
    if len(sides) < len(rows) or len({len(nodes) for _, nodes in sides}) != 1:
        return {}
    cell = _rows_of(numbers, np.array([number for number, _ in sides]))
    return {name: cells[cell[:, None], np.array([nodes for _, nodes in sides])]}
