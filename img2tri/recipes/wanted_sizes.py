"""What a user says of edge lengths -> the lengths wanted everywhere, in px."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ParameterError
from img2tri.shapes.sizes.user_size_field import EdgeLength, SizeField, size_field
from img2tri.shapes.trace.dual_edges import DualEdges, pixel_areas
from img2tri.types import Frame

USUAL_TRIANGLES = 2000  # what the default edge length aims at
MOST_TRIANGLES = 100_000_000  # some 2 GB of mesh, and several times that on the way


@dataclass(frozen=True, eq=False)
class Sizes:
    """Edge lengths wanted, in px.

    Attributes
    ----------
    longest
        The greatest length wanted anywhere.
    field
        Lengths over the image; None where it is the greatest everywhere.
    boundary
        Length along all outlines; None: as inside.
    elements_across
        How many edges at least across the thinnest places; None is not looked after.
    segments_per_turn
        How many edges at least to a full turn of an outline; None: `USUAL_SEGMENTS`, as far as `SHORTEST_SHARE` allows.
    shortest
        Edges of outlines are not made shorter than this for the sake of the above, only where tolerance or topology need it.
    gradation
        Growth of lengths per unit of distance.
    """

    longest: float
    gradation: float
    field: SizeField | None = None
    boundary: float | None = None
    elements_across: float | None = None
    segments_per_turn: float | None = None
    shortest: float = 0.0


def wanted_sizes(
    edge_length: EdgeLength | None,
    labels: NDArray[Any],
    dual_edges: DualEdges,
    frame: Frame,
    *,
    gradation: float,
    boundary_edge_length: float | str | None,
    min_edge_length: float | str | None,
    elements_across: float | None,
    segments_per_turn: float | None,
) -> Sizes:
    """Turn what a user says of edge lengths into px.

    Equilateral triangles of the default length fill the regions about `USUAL_TRIANGLES` times.
    """
    if edge_length is None:
        longest, field = max(4.0, math.sqrt(pixel_areas(dual_edges)[1:].sum() / USUAL_TRIANGLES * 4 / math.sqrt(3))), None
    else:
        longest, field = size_field(edge_length, frame, labels, gradation=gradation)
        _check_number(longest, field, float(pixel_areas(dual_edges)[1:].sum()), frame)
    return Sizes(
        longest,
        gradation,
        field,
        None if boundary_edge_length is None else frame.length("boundary_edge_length", boundary_edge_length) / frame.pixel,
        elements_across,
        segments_per_turn,
        0.0 if min_edge_length is None else frame.length("min_edge_length", min_edge_length) / frame.pixel,
    )


def _check_number(longest: float, field: SizeField | None, area: float, frame: Frame) -> None:
    """Refuse lengths that would take more triangles than there is memory for, before any of it is used."""
    lengths = np.clip(longest if field is None else field.grid, 1e-100, 1e100)
    number = 4 / math.sqrt(3) * float((1 / lengths**2).mean()) * (area if field is None else field.grid.size * field.cell**2)
    if number > MOST_TRIANGLES:
        enough = f"; of one length for all, {math.sqrt(area * 4 / math.sqrt(3) / MOST_TRIANGLES) * frame.pixel:.2g} is the least"
        raise ParameterError(f"edge_length: expected at most {MOST_TRIANGLES:,} triangles, found lengths for {number:.2g}{enough}")
