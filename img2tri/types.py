"""The small frozen records the rooms hand to each other: where an image lies, what was read, what its outlines are.

Points not yet joined to triangles are `points`; the corners of triangles are `vertices`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from img2tri.arrays import ChainIndex, Floats, Ints
from img2tri.errors import ParameterError, finite, shown


@dataclass(frozen=True)
class Frame:
    """Where an image lies in the world.

    Pixel (row r, column c) is the square [r, r + 1] x [c, c + 1] of the image; h x w pixels cover exactly h * dy by w * dx.

    Attributes
    ----------
    shape
        (h, w), rows and columns.
    spacing
        (dx, dy), the size of a pixel in world units.
    corner
        (x, y) of the lower-left corner of the image with `upward`, else of the corner of row 0, column 0.
    upward
        True: y grows from the last row to the first (x right, y up). False: y grows with the row, as in image coordinates.
    z
        Height of the plane the mesh lies in; other than 0 only for images that know it.
    """

    shape: tuple[int, int]
    spacing: tuple[float, float] = (1.0, 1.0)
    corner: tuple[float, float] = (0.0, 0.0)
    upward: bool = True
    z: float = 0.0

    def xy(self, rows: ArrayLike, columns: ArrayLike) -> Floats:
        """Turn (row, column) into (x, y): the one place where image coordinates become world coordinates.

        Examples
        --------
        The centre of the first pixel of an image of 2 rows and 3 columns:

        >>> Frame((2, 3)).xy([0.5], [0.5])
        array([[0.5, 1.5]])
        """
        return self.world(self.plane(rows, columns))

    def plane(self, rows: ArrayLike, columns: ArrayLike) -> Floats:
        """Turn (row, column) into the plane all geometry is done in: the world, moved to the origin and measured in pixels.

        Its unit is `pixel`, so that tolerances mean the same for every image, and a mesh scales exactly with `spacing`.
        """
        r, c = np.asarray(rows, np.float64), np.asarray(columns, np.float64)
        up = self.shape[0] - r if self.upward else r
        return np.stack([c * (self.spacing[0] / self.pixel), up * (self.spacing[1] / self.pixel)], axis=-1)

    def world(self, points: Floats) -> Floats:
        """Turn points of the plane into world coordinates."""
        return np.asarray(points) * self.pixel + self.corner

    def row_column(self, points: Floats) -> tuple[Floats, Floats]:
        """Turn (x, y) into (row, column), the inverse of `xy`."""
        c = (points[..., 0] - self.corner[0]) / self.spacing[0]
        up = (points[..., 1] - self.corner[1]) / self.spacing[1]
        return (self.shape[0] - up if self.upward else up), c

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """(left, bottom, right, top) of the image in the world: `bottom` is the least y."""
        (h, w), (dx, dy), (x, y) = self.shape, self.spacing, self.corner
        return x, y, x + w * dx, y + h * dy

    @property
    def pixel(self) -> float:
        """The smaller side of a pixel: the unit "px"."""
        return min(self.spacing)

    @property
    def diagonal(self) -> float:
        """The diagonal of the image: 100 of the unit "%"."""
        return math.hypot(self.shape[0] * self.spacing[1], self.shape[1] * self.spacing[0])

    def length(self, name: str, value: float | str, *, zero: bool = False) -> float:
        """Turn a length given by a user into world units: a number, "8px" (smaller pixel side) or "2%" (of the diagonal).

        Examples
        --------
        >>> Frame((30, 40), spacing=(0.5, 0.5)).length("edge_length", "8px")
        4.0
        >>> Frame((30, 40), spacing=(0.5, 0.5)).length("edge_length", "2%")
        0.5
        """
        return _quantity(name, value, {"": 1.0, "px": self.pixel, "%": self.diagonal / 100}, "8, '8px' or '2%'", zero)

    def area(self, name: str, value: float | str, *, zero: bool = True) -> float:
        """Turn an area given by a user into world units: a number, or "4px2" (pixels).

        Examples
        --------
        >>> Frame((30, 40), spacing=(0.5, 0.5)).area("min_area", "4px2")
        1.0
        """
        return _quantity(name, value, {"": 1.0, "px2": self.spacing[0] * self.spacing[1]}, "4 or '4px2'", zero)


def _quantity(name: str, value: float | str, units: dict[str, float], example: str, zero: bool) -> float:
    if isinstance(value, str):
        match = re.fullmatch(r"\s*([-+.\deE]+?)\s*(px2|px|%|)\s*", value)
        if match is None or match[2] not in units:
            raise ParameterError(f"{name}: expected a number with a unit, like {example}, found {value!r}")
        try:
            number: object = float(match[1])
        except ValueError:
            number = value
        scale = units[match[2]]
    else:
        number, scale = value, 1.0
    return scale * (finite(name, number, least=0) if zero else finite(name, number, above=0))


def checked_names(names: Mapping[int, str] | None) -> dict[int, str]:
    """Return a copy of the names of regions, or say why they are none.

    Examples
    --------
    >>> checked_names({1: "bone"})
    {1: 'bone'}
    """
    if names is None:
        return {}
    if not isinstance(names, Mapping):
        raise ParameterError(f"names: expected names by label, like {{1: 'bone'}}, found {shown(names)}")
    for label, name in names.items():
        if isinstance(label, bool) or not hasattr(label, "__index__") or not (isinstance(name, str) and name):
            raise ParameterError(f"names: expected whole numbers with names, like {{1: 'bone'}}, found {label!r}: {name!r}")
        if re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff]", name):
            raise ParameterError(f"names: expected letters that can be written, found {name!r}")
    return {int(label): name for label, name in names.items()}


@dataclass(frozen=True, eq=False)
class Picture:
    """An image as read: its values and its place.

    Attributes
    ----------
    values
        (h, w) bool, int or float, or (h, w, 3 or 4) with colours; as the file or array has them, no scaling.
    frame
        Where it lies.
    source
        What it was read from, for people: a path or "array".
    notes
        What was decided while reading (page, orientation, palette), for the report.
    missing
        (h, w) bool, the pixels that are not there: no data, NaN, masked. None: all are.
    """

    values: NDArray[Any]
    frame: Frame
    source: str = "array"
    notes: dict[str, Any] = field(default_factory=dict)
    missing: NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class ColourMix:
    """The colours of an image of which every pixel is one of a few flat colours, or a mix of two: what places the edges between them.

    Attributes
    ----------
    values
        (h, w, c), the pixels.
    labels
        (k,) int64, rising, the labels of the flat colours.
    colours
        (k, c) float64, the colours.
    background
        The label of what is not meshed; one without a colour if there is none.
    missing
        (h, w) bool, the pixels that are not there. None: all are.
    """

    values: NDArray[Any]
    labels: NDArray[np.int64]
    colours: NDArray[np.float64]
    background: int
    missing: NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class Outlines:
    """The outlines of all regions as one network of chains, each shared by the two regions it parts.

    A chain runs between two nodes (junctions, points on the frame, corners of the image) or is a ring of its own. It has
    one region on its left and one on its right, as seen along the chain where x points right and y up.

    Attributes
    ----------
    points
        (n, 2) float64, in the plane (see `Frame.plane`) or the world; each appears once.
    chains
        The points of each chain.
    left, right
        (c,) int64, the numbers of the regions on either side; 0 is what is not meshed, inside or outside of the image.
    labels
        (r,) int64, the image's own label of each region number; entry 0 only keeps the place.
    """

    points: Floats
    chains: ChainIndex
    left: Ints
    right: Ints
    labels: Ints

    @property
    def segments(self) -> tuple[Ints, Ints, Ints]:
        """All segments (s, 2) of all chains in order, and the region numbers (s,) on their left and right."""
        head = self.chains.heads
        indices, chain = self.chains.indices, self.chains.chain[head]
        return np.stack([indices[head], indices[head + 1]], axis=1), self.left[chain], self.right[chain]


@dataclass(frozen=True, eq=False)
class Provenance:
    """How a mesh was made, and what it is to be judged by.

    Attributes
    ----------
    recipe
        "conforming", "structured" or "unstructured".
    options
        All options as given or by default, as plain data: ``mesh_image(image, **options)`` makes the same mesh again.
    settings
        The options, and what was chosen where they leave the choice, as plain data for JSON.
    outlines
        The dense outlines of the image, in the plane of the frame.
    pixels
        (k, 2) float64, centres of the pixels beside the outlines, in the plane.
    pixel_regions
        (k,) int64, the region numbers of these pixels.
    areas
        (r,) float64, the area of the pixels of each region number, in the plane; entry 0 is not used.
    tolerance, min_angle
        What was promised: in px, in degrees; None where the recipe promises nothing.
    counted
        What the recipe counted on the way, for the report.
    notes
        What was decided while reading, in sentences for the report.
    """

    recipe: str
    options: dict[str, Any]
    settings: dict[str, Any]
    outlines: Outlines
    pixels: Floats
    pixel_regions: Ints
    areas: Floats
    tolerance: float | None = None
    min_angle: float | None = None
    counted: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    colours: dict[int, tuple[int, int, int]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class RecipeMesh:
    """What a recipe makes of a label map, in the plane of the frame.

    Attributes
    ----------
    vertices, triangles
        (n, 2) float64 and (m, 3) int64, counter-clockwise.
    regions
        (m,) int64, region numbers.
    counted
        What was counted on the way, for the report.
    outlines
        The dense outlines, where these were set back for the sake of angles; None: they are what they were.
    """

    vertices: Floats
    triangles: Ints
    regions: Ints
    counted: dict[str, Any] = field(default_factory=dict)
    outlines: Outlines | None = None
