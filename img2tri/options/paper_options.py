"""The options that only the paper's recipes have: one entry each."""

from __future__ import annotations

from typing import Annotated, TypedDict

from img2tri.options import option as o
from img2tri.options import parsing
from img2tri.options.option import Option


class PaperOptions(TypedDict, total=False):
    """Options of the paper's recipes only, see `img2tri.paper.structured_unstructured`; all follow from `edge_length` if left out."""

    step: Annotated[
        float | str | None,
        Option(
            None,
            "Distance of the points of the grid, a length.",
            none="`edge_length`, or 10 px as in the paper",
            check=o.length,
            sign="L",
            recipes=("structured",),
        ),
    ]
    n_boundary_points: Annotated[
        int | None,
        Option(
            None,
            "Points on each contour.",
            none="as `edge_length` asks for",
            check=o.whole(),
            typed=parsing.whole_number,
            sign="N",
            recipes=("unstructured",),
        ),
    ]
    n_interior_points: Annotated[
        int | None,
        Option(
            None,
            "Points inside each contour.",
            none="as many as fit",
            check=o.whole(),
            typed=parsing.whole_number,
            sign="N",
            recipes=("unstructured",),
        ),
    ]
    min_distance: Annotated[
        float | str | None,
        Option(
            None,
            "Least distance of points inside, a length.",
            none="as `edge_length` asks for",
            check=o.length_or_zero,
            sign="L",
            recipes=("unstructured",),
        ),
    ]
    min_distance_to_boundary: Annotated[
        float | str | None,
        Option(
            None,
            "Least distance of points inside to those on the contour, a length.",
            none="as `edge_length` asks for",
            check=o.length_or_zero,
            sign="L",
            recipes=("unstructured",),
        ),
    ]
