r"""Several regions as several closed bodies: a plane mesh and a height -> one solid per region, for printing in several materials.

Each region is extruded by itself, so each body is closed. Two neighbours then both have the wall between them. It is built of the same
points, and cut in the same two triangles: along the diagonal that rises from the end that comes first by its coordinates, from
whichever side the wall is seen::

    a ------ b        a before b:   a|  /|b  in one body,   b|\  |a  in the other, which looks from behind
    |      / |                       | / |                   | \ |
    |   /    |        so the two walls are one and the same set of triangles, wound the other way round.
    a ------ b
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats, Ints
from img2tri.errors import ParameterError, finite
from img2tri.views.figures.region_colours import region_colours
from img2tri.views.objects.base_plate import GRAY, PLATE, Base, plate_label
from img2tri.views.objects.extruded_surface import extrude
from img2tri.views.objects.flat_or_extruded import Surface, surface

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, eq=False)
class Body:
    """One region with a surface of its own.

    Attributes
    ----------
    label
        Of the region.
    name
        The user's, or such as "region_3"; no two bodies have the same.
    colour
        (red, green, blue), 0 to 255; the same as in figures.
    surface
        Closed, or flat if no height was given.
    """

    label: int
    name: str
    colour: tuple[int, int, int]
    surface: Surface


def bodies(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    height: float | Mapping[int, float] | None,
    z: float = 0.0,
    names: Mapping[int, str] | None = None,
    colours: Mapping[int, tuple[int, int, int]] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    base: Base | None = None,
) -> list[Body]:
    """Make one body of each region.

    Each has the area of its region times `height` as its volume, and every point it shares with a neighbour exactly; where two walls
    meet, their triangles are the same.

    Parameters
    ----------
    height
        Thickness in world units, above 0, or label -> that of the region; None makes flat parts, open, that share the vertices between
        them.
    colours
        Label -> (red, green, blue) of the region, such as those of the image; regions without one get one of
        `img2tri.views.figures.region_colours`.
    names
        Label -> name. Regions without one are called "region_3" and so on; a name given twice gets the label behind it.
    vertices, triangles, regions, z, cell_data, field_data
        As in `img2tri.views.objects.flat_or_extruded.surface`.

    Returns
    -------
    list of Body
        By ascending label.

    Raises
    ------
    MeshError, ParameterError
        As `img2tri.views.objects.flat_or_extruded.surface`.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]
    >>> [(body.name, body.surface.points.shape) for body in bodies(*square, [3, 7], height=1, names={3: "bone"})]
    [('bone', (6, 3)), ('region_7', (6, 3))]
    """
    if base is not None and height is None:
        raise ParameterError("base: expected a height too, found none; a flat mesh has no plate")
    flat = surface(vertices, triangles, regions, z=z + (base.thickness if base else 0), cell_data=cell_data, field_data=field_data)
    order = np.argsort(flat.regions, kind="stable")
    labels, starts = np.unique(flat.regions[order], return_index=True)
    named, shown = unique_names(labels.tolist(), names or {}), region_colours(labels.tolist(), colours)
    plate = [] if base is None else [_plate(flat, base, z, set(named.values()))]
    return plate + [
        Body(label, named[label], (red, green, blue), _body_surface(flat, mine, _own(height, label)))
        for label, (red, green, blue), mine in zip(labels.tolist(), shown, np.split(order, starts[1:]), strict=True)
    ]


def to_scene(
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    *,
    height: float | Mapping[int, float] | None,
    z: float = 0.0,
    names: Mapping[int, str] | None = None,
    colours: Mapping[int, tuple[int, int, int]] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
    field_data: Mapping[str, str] | None = None,
    base: Base | None = None,
) -> trimesh.Scene:
    """Make a `trimesh.Scene` with one closed body for each region; nothing is merged or reordered.

    Parameters and errors are those of `bodies`.

    Returns
    -------
    trimesh.Scene
        Whose ``geometry`` holds a `trimesh.Trimesh` for each region under its name: watertight, in a colour of its own, with
        ``face_attributes["region"]`` and the arrays of `cell_data`, and with label and name in its ``metadata``.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]
    >>> scene = to_scene(*square, [3, 7], height=4, names={3: "bone"})
    >>> {name: (body.is_watertight, float(round(body.volume, 9))) for name, body in scene.geometry.items()}
    {'bone': (True, 2.0), 'region_7': (True, 2.0)}
    """
    import trimesh

    made = bodies(
        vertices,
        triangles,
        regions,
        height=height,
        z=z,
        names=names,
        colours=colours,
        cell_data=cell_data,
        field_data=field_data,
        base=base,
    )
    texts = made[0].surface.field_data
    scene: trimesh.Scene = trimesh.Scene(metadata={**texts, "regions": {body.name: body.label for body in made}})
    for body in made:
        part: Any = trimesh.Trimesh(
            body.surface.points,
            body.surface.faces,
            face_attributes={"region": body.surface.regions, **body.surface.cell_data},
            metadata={**texts, "region": body.label, "name": body.name},
            process=False,
        )
        part.visual.face_colors = [*body.colour, 255]
        scene.add_geometry(part, node_name=body.name, geom_name=body.name)
    return scene


def unique_names(labels: list[int], names: Mapping[int, str]) -> dict[int, str]:
    """Return a name for each label: the given one, or "region_3"; with the label behind it where another region has it too.

    Examples
    --------
    >>> unique_names([1, 2, 3], {1: "bone", 2: "bone"})
    {1: 'bone_1', 2: 'bone_2', 3: 'region_3'}
    """
    wanted = {label: names.get(label, f"region_{label}") for label in labels}
    taken = Counter(wanted.values())
    unique = {}
    for label, name in wanted.items():
        other = name
        while taken[other] > (other == name):
            other += f"_{label}"
        taken[other] += other != name
        unique[label] = other
    return unique


def _body_surface(flat: Surface, mine: Ints, height: float | None) -> Surface:
    """Cut the triangles `mine` out of a flat mesh and give them a thickness."""
    used, inverse = np.unique(flat.faces[mine], return_inverse=True)
    corners = inverse.reshape(-1, 3)
    if height is None:
        points, faces, sources = flat.points[used], corners, np.arange(len(mine))
    else:
        solid = extrude(flat.points[used, :2], corners, height, z=float(flat.points[0, 2]))
        points, faces, sources = solid.points, _alike(solid.points, solid.faces, len(mine)), solid.sources
    from_triangle = mine[sources]
    cells = {name: values[from_triangle] for name, values in flat.cell_data.items()}
    return Surface(points, faces, flat.regions[from_triangle], cells, flat.field_data, closed=height is not None)


def _plate(flat: Surface, base: Base, z: float, taken: set[str]) -> Body:
    """Return the plate the bodies stand on; it has their corners on its upper side."""
    v, t = flat.points[:, :2], flat.faces
    points, beside = base.under(v, t)
    faces, label = np.concatenate([t, beside]), plate_label(flat.regions.astype(np.int64))
    whole = surface(points, faces, np.full(len(faces), label), z=z, height=base.thickness, field_data=flat.field_data)
    return Body(label, PLATE if PLATE not in taken else f"{PLATE}_{label}", GRAY, whole)


def _own(height: float | Mapping[int, float] | None, label: int) -> float | None:
    """Return the height of a region."""
    if not isinstance(height, Mapping):
        return height
    if label not in height:
        raise ParameterError(f"height: expected one for each region, found none for {label}")
    return finite(f"height of {label}", height[label], above=0)


def _alike(points: Floats, faces: Ints, triangles: int) -> Ints:
    """Cut each wall along the diagonal from its end that comes first by x, then y.

    `extrude` makes walls (a, b, B), (a, B, A), cut from a up to B; small letters are at the bottom.
    """
    walls = faces[2 * triangles :].reshape(-1, 6)
    a, b, upper_b, upper_a = walls[:, 0], walls[:, 1], walls[:, 2], walls[:, 5]
    (ax, ay), (bx, by) = points[a, :2].T, points[b, :2].T
    first = (ax < bx) | ((ax == bx) & (ay < by))
    other = np.stack([a, b, upper_a, b, upper_b, upper_a], axis=1)
    return np.concatenate([faces[: 2 * triangles], np.where(first[:, None], walls, other).reshape(-1, 3)])
