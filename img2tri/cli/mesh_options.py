"""The options of meshing, under the names of `img2tri.mesh_image`, and how texts become numbers, pairs and lists.

Only what makes a text a number, a pair or a list is checked here; what values may be is for mesh_image to say.
"""

from __future__ import annotations

from argparse import SUPPRESS, ArgumentParser, ArgumentTypeError, BooleanOptionalAction

# Options that go on to mesh_image, by its own names. Those not given are not in the namespace.
MESH_OPTIONS = (
    "recipe", "threshold", "labels", "background", "invert", "connectivity", "outline", "corners", "edge_length", "gradation",
    "min_edge_length", "boundary_edge_length", "elements_across", "segments_per_turn", "min_angle", "tolerance", "keep_area", "smoothing",
    "periodic", "interior",
    "iterations", "spacing", "origin", "units", "page", "crop", "min_area", "largest", "max_pixels", "names", "seed",
    "step", "n_boundary_points", "n_interior_points", "min_distance", "min_distance_to_boundary",
)  # fmt: skip


def add_mesh_options(parser: ArgumentParser) -> None:
    """Add the options of mesh_image. One without a default here is left to mesh_image."""
    add = parser.add_argument_group("what is meshed", argument_default=SUPPRESS).add_argument
    add("--threshold", type=_number_or_word, metavar="T", help="gray level, above which is white, or otsu (default: the middle of "
        "two values, else otsu; the paper's recipes 240)")  # fmt: skip
    add("--invert", action="store_true", help="mesh what is dark")
    add("--connectivity", type=whole, metavar="4|8", help="pixels hang together through sides, or also through corners (default 4)")
    add("--labels", type=_labels, metavar="[LIST]", help="every value is a region of its own; with a list such as 1,2,3 these are")
    add("--background", type=_background, metavar="N", help="the value that is not meshed, or none (default 0)")
    add("--name", dest="names", action="append", type=_name, metavar="N=NAME", help="name of a region, as in 1=bone; several times")
    add("--crop", type=_numbers, metavar="L,B,R,T", help="mesh only this part: left, bottom, right, top in world units")
    add("--min-area", metavar="A", help="drop specks and fill holes smaller than this, in world units squared or as 20px2")
    add("--largest", action="store_true", help="keep only the largest component of each region")
    add("--page", type=whole, metavar="N", help="which image of a file with several, from 0 (default 0)")
    add("--max-pixels", type=whole, metavar="N", help="refuse larger images (default 268435456)")

    add = parser.add_argument_group("where it lies", argument_default=SUPPRESS).add_argument
    add("--spacing", type=_pair, metavar="S", help="size of a pixel in world units, as 0.5 or 0.5,0.7, or file: what the file says, "
        "in mm (default 1)")  # fmt: skip
    add("--origin", type=_pair, metavar="O", help="lower: (0, 0) is the lower-left corner, y up; upper: the upper-left one, y down; "
        "x,y: place of the lower-left corner (default lower)")  # fmt: skip
    add("--units", metavar="U", help="what a world unit is: um, mm, cm, m, in or ft, for files that can tell")

    add = parser.add_argument_group("how it is meshed", argument_default=SUPPRESS).add_argument
    add("--recipe", metavar="R", help="conforming, or the paper's: structured, unstructured (default conforming)")
    add("--outline", metavar="O", help="smooth: where the edge is likely to be; pixel: along the sides of pixels (default smooth)")
    add("--corners", metavar="C", help="auto: sharp as far as --min-angle allows; keep: always; round: smoothed (default auto)")
    add("--edge-length", type=_lengths, metavar="L", help="wanted length of edges, or one for each region, as in 1=4,2=8px (default: "
        "some 2000 triangles, at least 4px)")  # fmt: skip
    add("--boundary-edge-length", metavar="L", help="length along outlines; fine there, coarse inside")
    add("--min-edge-length", metavar="L", help="outlines get no shorter edges for the sake of the next two options")
    add("--elements-across", type=number, metavar="N", help="at least so many edges across the thinnest places")
    add("--segments-per-turn", type=number, metavar="N", help="at least so many edges to a full turn of an outline")
    add("--gradation", type=number, metavar="G", help="how much lengths may grow per unit of distance (default 0.17)")
    add("--min-angle", type=number, metavar="A", help="least angle of a triangle, 0 to 32 degrees (default 30)")
    add("--tolerance", metavar="L", help="greatest distance between outlines and mesh (default 0.5px)")
    add("--keep-area", action=BooleanOptionalAction, help="move vertices outwards on curved outlines, so that areas are kept, or leave "
        "them on the outlines (default --keep-area)")  # fmt: skip
    add("--periodic", metavar="D", help="x, y or xy: opposite sides, whose pixels have to be the same, get vertices at the same places")
    add("--interior", metavar="I", help="lattice: even triangles; poisson: scattered points, as in the paper (default lattice)")
    add("--smoothing", metavar="S", help="none, uniform or cotangent (default none; uniform for unstructured)")
    add("--iterations", type=whole, metavar="N", help="passes of smoothing (default 10)")

    add = parser.add_argument_group("the paper's recipes only", "All follow from --edge-length.", argument_default=SUPPRESS).add_argument
    add("--step", metavar="L", help="structured: distance of the points of the grid")
    add("--n-boundary-points", type=whole, metavar="N", help="unstructured: points on each contour")
    add("--n-interior-points", type=whole, metavar="N", help="unstructured: points inside each contour (default: as many as fit)")
    add("--min-distance", metavar="L", help="unstructured: least distance of points inside")
    add("--min-distance-to-boundary", metavar="L", help="unstructured: least distance of points inside to those on the contour")
    add("--seed", type=whole, metavar="N", help="of the points inside (default 0)")


def number(text: str) -> float:
    """Return the number a text is."""
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"expected a number, found {text!r}") from None


def whole(text: str) -> int:
    """Return the whole number a text is."""
    try:
        return int(text)
    except ValueError:
        raise ArgumentTypeError(f"expected a whole number, found {text!r}") from None


def _number_or_word(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(number, text.split(",")))


def _pair(text: str) -> float | str | tuple[float, ...]:
    return _numbers(text) if "," in text else _number_or_word(text)


def _lengths(text: str) -> str | dict[int, str]:
    return dict(map(_name, text.split(","))) if "=" in text else text


def _labels(text: str) -> bool | list[int]:
    return True if text == "all" else list(map(whole, text.split(",")))


def _background(text: str) -> int | None:
    return None if text.lower() == "none" else whole(text)


def _name(text: str) -> tuple[int, str]:
    label, _, name = text.partition("=")
    if not name:
        raise ArgumentTypeError(f"expected the number of a region, =, and what it gets, as in 1=bone, found {text!r}")
    return whole(label), name
