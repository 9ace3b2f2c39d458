r"""The named parts of a mesh: triangles with their regions, and the frame of the image -> what each edge is called.

Regions have the user's names, or such as ``region_3``. Each edge on the boundary of the mesh or between two regions belongs to one set, the
first of these that fits:

1. ``left``, ``right``, ``bottom``, ``top``: it lies on that side of the frame of the image; bottom is where y is least.
2. ``hole_1``, ``hole_2``...: it bounds a hole; the largest hole comes first.
3. ``outer``: it bounds the mesh otherwise. With the sides of the frame, this is all of the outer boundary.
4. ``bone__cartilage``: on either side is a region; the one with the lower label comes first.

Beside the whole there are its pieces, where there are several: ``left_1``, ``left_2``, ``outer_1``..., see
`img2tri.views.objects.sets.split_at_corners` for what is a piece and which comes first. Formats in which a facet has one tag give it
that of the whole.

An edge is a side of a triangle, numbered as in `img2tri.views.objects.half_edge_twins`. A boundary ring is followed by going round its
vertices from twin to twin, so that where a mesh touches itself in one vertex only, its parts stay apart, as they are for the pixels.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from img2tri.arrays import Bools, Floats, Ints
from img2tri.errors import ParameterError
from img2tri.views.objects.body_per_region import unique_names
from img2tri.views.objects.half_edge_twins import half_edge_twins, next_side
from img2tri.views.objects.sets.known_edges import with_known_edges
from img2tri.views.objects.sets.numbers_in_files import FRAME, OUTER, file_numbers, set_tags
from img2tri.views.objects.sets.split_at_corners import connected_pieces, outer_pieces
from img2tri.views.objects.sets.triangles_by_label import grouped

_ON_FRAME = 1e-9  # how far from the frame, relative to the mesh and its place, a vertex still lies on it


@dataclass(frozen=True, eq=False)
class Sets:
    """The named parts of a mesh.

    Attributes
    ----------
    labels
        Name of each region -> its label, by ascending label.
    regions
        Name of each region -> (k,) int64, its triangles.
    sides
        Name of each set of edges -> (k, 2) int64: a triangle, and which of its sides, 0 to 2. An interface is given by the sides of the
        region that comes first in its name.
    edges
        Name of each set of edges -> (k, 2) int64, the vertices at the ends, row for row as in `sides`; directed with that triangle on the
        left.
    tags
        Name of each set of edges -> its number in files.
    part_of
        Name of each piece -> the name of the whole, which is a set too. All other sets have no edge in common.
    between
        Name of each interface -> the labels of its two regions.
    """

    labels: dict[str, int]
    regions: dict[str, Ints]
    sides: dict[str, Ints]
    edges: dict[str, Ints]
    tags: dict[str, int]
    part_of: dict[str, str]
    between: dict[str, tuple[int, int]]

    def __repr__(self) -> str:
        parts = [("regions", self.regions), ("edges", self.sides)]
        return "Sets: " + "; ".join(f"{word} " + ", ".join(f"{name} ({len(rows)})" for name, rows in part.items()) for word, part in parts)


def named_sets(
    vertices: Floats,
    triangles: Ints,
    regions: Ints,
    *,
    bounds: tuple[float, float, float, float] | None = None,
    names: Mapping[int, str] | None = None,
    given: Mapping[str, Ints] | None = None,
) -> Sets:
    """Name the regions of a mesh, and its edges on the boundary and between regions.

    Parameters
    ----------
    vertices, triangles
        (n, 2) float64, and (m, 3) int64, counter-clockwise. More vertices than the triangles use do no harm.
    regions
        (m,) int64.
    bounds
        (left, bottom, right, top) of the image, see `img2tri.types.Frame.bounds`. None: there is no frame, and what would lie on it is
        ``outer``.
    names
        Label -> name. Regions without one are called ``region_3``; a name given twice gets the label behind it.
    given
        Name -> (k, 2) vertices at the ends of edges: sets that are known, as from a file. Their edges are in no other set; of two that have
        edges in common, one within the other is a piece of it, else the first has them.

    Returns
    -------
    Sets
        Only what is there: no set is empty.

    Raises
    ------
    MeshError
        If two triangles run along a side in the same direction.
    ParameterError
        If a region has the name of a set of edges.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    >>> sets = named_sets(*square, np.array([3, 7]), bounds=(0, 0, 1, 2), names={3: "bone"})
    >>> sets
    Sets: regions bone (1), region_7 (1); edges left (1), right (1), bottom (1), outer (1), bone__region_7 (1)
    >>> sets.edges["bone__region_7"].tolist(), sets.tags["bone__region_7"]
    ([[2, 0]], 1011)
    """
    called = region_names(regions, names)
    twins = half_edge_twins(triangles)
    free, following, ring, area = _boundary(vertices, triangles, twins)
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    a, b = start[free], end[free]

    found: dict[str, Ints] = {}
    part_of: dict[str, str] = {}
    kind = np.full(len(free), -1)
    for i, on in enumerate(_on_frame(vertices, a, b, bounds)):
        kind[on] = i
    for i, name in enumerate(FRAME):
        found[name] = free[kind == i]
        pieces = connected_pieces(a[kind == i], b[kind == i], vertices[:, 1 - i // 2])
        part_of |= dict.fromkeys(_split(found, name, pieces), name)
    outer = (kind < 0) & (area[ring] >= 0)
    found[OUTER] = free[outer]
    part_of |= dict.fromkeys(_split(found, OUTER, outer_pieces(vertices, a, b, following, outer, ring, area)[outer]), OUTER)
    holes = np.flatnonzero(area < 0)
    # The area of a hole is negative, so that of the largest one comes first.
    for i, hole in enumerate(holes[np.argsort(area[holes], kind="stable")].tolist(), 1):
        found[f"hole_{i}"] = free[(kind < 0) & (ring == hole)]

    inside = np.flatnonzero(twins >= 0)
    inside = inside[regions[inside // 3] < regions[twins[inside] // 3]]
    numbers = np.searchsorted(list(called), regions)
    pairs, members = grouped(numbers[inside // 3] * len(called) + numbers[twins[inside] // 3])
    between: dict[str, tuple[int, int]] = {}
    labels = list(called)
    for pair, rows in zip(pairs.tolist(), members, strict=True):
        one, other = labels[pair // len(labels)], labels[pair % len(labels)]
        name = f"{called[one]}__{called[other]}"
        name = name if name not in found else f"{name}_{one}_{other}"
        found[name], between[name] = inside[rows], (one, other)

    if given:
        found, part_of = with_known_edges(triangles, twins, regions, given, found, part_of)
    found = {name: found[name] for name in [*(name for name in found if name not in part_of), *part_of] if len(found[name])}
    for label, name in called.items():
        if name in found:
            raise ParameterError(f"names: expected names other than those of sets of edges, found {name!r} for region {label}")
    each, members = grouped(regions)
    return Sets(
        labels={name: label for label, name in called.items()},
        regions={called[label]: rows for label, rows in zip(each.tolist(), members, strict=True)},
        sides={name: np.stack(np.divmod(sides, 3), axis=1) for name, sides in found.items()},
        edges={name: np.stack([start[sides], end[sides]], axis=1) for name, sides in found.items()},
        tags=set_tags(found, file_numbers(list(called)).values()),
        part_of={name: whole for name, whole in part_of.items() if name in found},
        between={name: pair for name, pair in between.items() if name in found},
    )


def _split(found: dict[str, Ints], whole: str, pieces: Ints) -> list[str]:
    """Add the pieces of a set to what was found, if there are several; return their names."""
    count = int(pieces.max(initial=0)) + 1
    if count == 1:
        return []
    sides = found[whole]
    parts = np.split(sides[np.argsort(pieces, kind="stable")], np.cumsum(np.bincount(pieces))[:-1])
    names = [f"{whole}_{i}" for i in range(1, count + 1)]
    found |= dict(zip(names, parts, strict=True))
    return names


def region_names(regions: Ints, names: Mapping[int, str] | None = None) -> dict[int, str]:
    """Return the name of each label that is there, by ascending label.

    Examples
    --------
    >>> region_names(np.array([7, 3, 7]), {3: "bone", 5: "marrow"})
    {3: 'bone', 7: 'region_7'}
    """
    return unique_names(np.unique(regions).tolist(), names or {})


def pieces_by_name(names: Iterable[str]) -> dict[str, str]:
    """Return which sets are pieces of others, as far as their names tell.

    Examples
    --------
    >>> pieces_by_name(["left", "left_1", "left_2", "hole_1"])
    {'left_1': 'left', 'left_2': 'left'}
    """
    names = set(names)
    wholes = {name: name.rpartition("_") for name in sorted(names)}
    return {name: whole for name, (whole, _, number) in wholes.items() if whole in (*FRAME, OUTER) and whole in names and number.isdigit()}


def interfaces_by_name(names: Iterable[str], regions: Mapping[int, str]) -> dict[str, tuple[int, int]]:
    """Return the labels of the regions on both sides of the sets that are interfaces, as far as their names tell.

    Examples
    --------
    >>> interfaces_by_name(["left", "bone__region_7"], {3: "bone", 7: "region_7"})
    {'bone__region_7': (3, 7)}
    """
    labels = {name: label for label, name in regions.items()}
    found = {}
    for name in names:
        parts = name.split("__")
        pairs = [("__".join(parts[:i]), "__".join(parts[i:])) for i in range(1, len(parts))]
        known = [(labels[one], labels[other]) for one, other in pairs if one in labels and other in labels]
        if len(known) == 1:
            found[name] = known[0]
    return found


def boundary_rings(vertices: Floats, triangles: Ints) -> tuple[Ints, Ints, Floats]:
    """Follow the boundary of a mesh.

    Returns
    -------
    sides
        (b,) int64, the sides that have no twin, in ascending order: side 3 t + k is side k of triangle t.
    ring
        (b,) int64, the ring of each; rings are numbered from 0.
    area
        (r,) float64, what each ring encloses: negative for holes, as the mesh is on the left of its sides.

    Examples
    --------
    >>> boundary_rings(np.array([[0, 0], [2, 0], [0, 2.0]]), np.array([[0, 1, 2]]))
    (array([0, 1, 2]), array([0, 0, 0]), array([2.]))
    """
    sides, _, ring, area = _boundary(vertices, triangles, half_edge_twins(triangles))
    return sides, ring, area


def _boundary(vertices: Floats, triangles: Ints, twins: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """Return the sides without a twin, for each the row of the one that follows it, its ring, and what each ring encloses."""
    free = np.flatnonzero(twins < 0)
    following = next_side(free)
    turning = np.flatnonzero(twins[following] >= 0)
    while len(turning):
        following[turning] = next_side(twins[following[turning]])
        turning = turning[twins[following[turning]] >= 0]
    following = np.searchsorted(free, following)
    # Each side looks one, two, four... sides ahead for the lowest number, until it has seen the whole ring.
    step, lowest = following, np.arange(len(free))
    for _ in range(len(free).bit_length()):
        lowest = np.minimum(lowest, lowest[step])
        step = step[step]
    ring = np.unique(lowest, return_inverse=True)[1]
    a, b = (vertices[:, :2] - vertices[0, :2])[np.stack([triangles.ravel()[free], triangles.ravel()[next_side(free)]])]
    area = np.bincount(ring, (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2).astype(np.float64)
    return free, following, ring, area


def _on_frame(vertices: Floats, start: Ints, end: Ints, bounds: tuple[float, float, float, float] | None) -> list[Bools]:
    """Return for each side of the frame which of the edges lie on it."""
    if bounds is None:
        return []
    left, bottom, right, top = bounds
    within = _ON_FRAME * max(np.abs(bounds).max(), right - left, top - bottom)
    places = ((0, left), (0, right), (1, bottom), (1, top))
    return [np.all(np.abs(vertices[:, axis][np.stack([start, end])] - value) <= within, axis=0) for axis, value in places]
