"""A symmetric image -> a symmetric mesh: one half is meshed by the conforming recipe, and mirrored."""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.arrays import ChainIndex, Floats, Ints
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
    mesh, set_back = (made.vertices, made.triangles, made.regions), made.outlines
    for i, axis in enumerate(axes):
        if "xy"[i] in symmetric:
            mesh = mirrored(*mesh, i, axis)
            set_back = set_back and mirrored_outlines(set_back, i, axis)
    return RecipeMesh(*mesh, made.counted, set_back)


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


def mirrored_outlines(outlines: Outlines, i: int, axis: float) -> Outlines:
    """Return outlines with their mirror image beyond the axis, and without what runs along it; points on it are there once."""
    points, chains = outlines.points, outlines.chains
    on = np.abs(points[:, i] - axis) < ON_AXIS
    inner = np.bincount(chains.chain, ~on[chains.indices], len(chains.rings)) > 0
    indices = chains.indices[inner[chains.chain]]
    number = np.arange(len(points))
    number[~on] = len(points) + np.arange(np.count_nonzero(~on))
    other = points[~on]
    other[:, i] = 2 * axis - other[:, i]
    starts = np.concatenate([[0], np.cumsum(np.tile(np.diff(chains.starts)[inner], 2))])
    both = ChainIndex(np.concatenate([indices, number[indices]]), starts, np.tile(chains.rings[inner], 2))
    left, right = outlines.left[inner], outlines.right[inner]
    return Outlines(np.concatenate([points, other]), both, np.concatenate([left, right]), np.concatenate([right, left]), outlines.labels)


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
