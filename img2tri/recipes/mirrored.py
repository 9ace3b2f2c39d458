"""A symmetric image -> a symmetric mesh: one half is meshed by the conforming recipe, and mirrored."""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.errors import ParameterError
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes.conforming import conform
from img2tri.recipes.wanted_sizes import Sizes
from img2tri.shapes.mirror_symmetry import half_outlines
from img2tri.shapes.sizes.user_size_field import SizeField
from img2tri.shapes.trace.dual_edges import DualEdges
from img2tri.types import Frame, Outlines, RecipeMesh

ROUNDING = 1e-7  # px: by so much the outlines of a symmetric image may differ from their mirror image
ON_AXIS = 1e-9  # px: vertices nearer to an axis are on it
SAME_LENGTH = 0.05  # relative: what lengths of a field may differ by from those on the other side


def conform_symmetric(
    symmetric: str,
    outlines: Outlines,
    dual_edges: DualEdges,
    sizes: Sizes,
    zones: Segmentation,
    frame: Frame,
    *,
    connectivity: int,
    **fill: Any,
) -> RecipeMesh:
    """Mesh a symmetric image like `conform`, to a mesh that is its own mirror image, vertex by vertex, with vertices exactly on the axis.

    Parameters
    ----------
    symmetric
        "x": left and right are mirror images; "y": top and bottom; "xy": both.
    outlines, dual_edges, sizes
        Of the whole image.
    zones, frame, connectivity
        What the outlines were traced from.
    **fill
        Options of `conform`.
    """
    if sizes.field is not None:
        _check_field(symmetric, sizes.field, frame)
    half, half_edges, axes = half_outlines(
        symmetric, outlines, dual_edges, zones.labels, frame, background=zones.background, connectivity=connectivity
    )
    # Outlines of the other half are the mirror image of these up to rounding, which must not cost the tolerance.
    made = conform(half, half_edges, sizes, **(fill | {"tolerance": max(fill["tolerance"] - ROUNDING, fill["tolerance"] / 2)}))
    mesh = made.vertices, made.triangles, made.regions
    for i, axis in enumerate(axes):
        if "xy"[i] in symmetric:
            mesh = mirrored(*mesh, i, axis)
    return RecipeMesh(*mesh, made.counted)


def mirrored(vertices: Floats, triangles: Ints, regions: Ints, i: int, axis: float) -> tuple[Floats, Ints, Ints]:
    """Return a mesh with its mirror image beyond the axis, on which coordinate i is `axis`; vertices on the axis are there once.

    Examples
    --------
    >>> mirrored(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.array([[0, 1, 2]]), np.array([1]), 0, 1.0)[1]
    array([[0, 1, 2],
           [2, 1, 3]])
    """
    vertices = vertices.copy()
    on = np.abs(vertices[:, i] - axis) < ON_AXIS
    vertices[on, i] = axis
    other = vertices[~on]
    other[:, i] = 2 * axis - other[:, i]
    number = np.arange(len(vertices))
    number[~on] = len(vertices) + np.arange(len(other))
    turned = number[triangles][:, ::-1]
    return np.concatenate([vertices, other]), np.concatenate([triangles, turned]), np.concatenate([regions, regions])


def _check_field(symmetric: str, field: SizeField, frame: Frame) -> None:
    """Refuse lengths that are not the same on both sides, of which one would be taken for both."""
    h, w = frame.shape
    rows, columns = (part.ravel() for part in np.meshgrid(np.linspace(0, h, 41), np.linspace(0, w, 41), indexing="ij"))
    found = field(frame.plane(rows, columns))
    for direction in symmetric:
        other = field(frame.plane(rows, w - columns) if direction == "x" else frame.plane(h - rows, columns))
        if (np.abs(found - other) > SAME_LENGTH * np.minimum(found, other)).any():
            raise ParameterError(
                f"edge_length: expected lengths that are the same on both sides with symmetric={symmetric!r}, found up to "
                f"{float((found / other).max()):.3g} times as long ones; mirror them, or leave symmetric= out"
            )
