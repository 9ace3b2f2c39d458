"""The options of the command line: arguments as typed -> a namespace, with numbers as numbers.

Only what makes a text a number, a pair or a list is checked here; what values may be is for `img2tri.mesh_image` to say.
"""

from __future__ import annotations

import re
from argparse import SUPPRESS, ArgumentParser, ArgumentTypeError, BooleanOptionalAction, Namespace, RawDescriptionHelpFormatter
from collections.abc import Sequence
from typing import NoReturn

from img2tri import __version__

# Options that go on to mesh_image, by its own names. Those not given are not in the namespace.
MESH_OPTIONS = (
    "recipe", "threshold", "labels", "background", "invert", "connectivity", "outline", "corners", "edge_length", "gradation",
    "min_edge_length", "boundary_edge_length", "elements_across", "segments_per_turn", "min_angle", "tolerance", "keep_area", "smoothing",
    "periodic", "interior",
    "iterations", "spacing", "origin", "page", "crop", "min_area", "largest", "max_pixels", "names", "seed",
    "step", "n_boundary_points", "n_interior_points", "min_distance", "min_distance_to_boundary",
)  # fmt: skip

EXAMPLES = """examples:
  img2tri mesh femur.png -o femur.stl -o femur.vtu --plot femur_mesh.png
  img2tri mesh slice.png -o bone.stl --threshold otsu --spacing 0.5 --height 5
  img2tri mesh grains.png -o grains.vtu --labels --edge-length 2%
  img2tri mesh scans/*.png -o "meshes/{stem}.ply" --report "meshes/{stem}.json"
  img2tri view-report femur.png -o femur.html --edge-length 8
  img2tri quality femur.stl
"""
MESH = """Mesh images: the white zone, or every label of a label map.

Lengths are in world units (8), pixels (8px) or percent of the image diagonal
(2%). A pixel is 1 world unit unless --spacing says otherwise. A value that
begins with a minus is joined by =, as in --origin=-5,-5.
"""
PAGE = """Mesh an image and write a page about it: the mesh over the image, to zoom into, a
histogram of its quality, its certificate, and the command that makes it again.
One file, which needs nothing else to be looked at. Options are those of mesh.
"""
QUALITY = """Print a table of the quality of plane meshes.

q is 2 r / R, 1 for an equilateral triangle and 0 for a flat one; the other
measures have the names and definitions of Verdict. Angles are in degrees.
"""


def parse(argv: Sequence[str]) -> Namespace:
    """Read the arguments of ``img2tri``; `command` is the first of them.

    Raises
    ------
    SystemExit
        With status 0 for --help and --version; with 2 and one line on stderr for what cannot be understood.

    Examples
    --------
    >>> given = parse(["mesh", "grains.png", "--labels", "1,2", "--spacing", "0.5"])
    >>> given.images, given.labels, given.spacing, "edge_length" in given
    (['grains.png'], [1, 2], 0.5, False)
    """
    given = _parser().parse_args(_unambiguous(argv))
    if "names" in given:
        given.names = dict(given.names)
    return given


def _unambiguous(argv: Sequence[str]) -> list[str]:
    """Join ``--labels`` and its list, if one follows; argparse would take the name of an image for it."""
    joined: list[str] = []
    for argument in argv:
        if joined and joined[-1] == "--labels":
            joined[-1] = "--labels=all"
            if re.fullmatch(r"-?\d+(,-?\d+)*", argument):
                joined[-1] = f"--labels={argument}"
                continue
        joined.append(argument)
    return joined


class _Parser(ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say what is wrong in one line, without the usage of all options before it."""
        self.exit(2, f"img2tri: {message.removeprefix('argument ')}; see {self.prog} --help\n")


def _parser() -> ArgumentParser:
    parser = _Parser(
        prog="img2tri",
        description="From an image to a triangle mesh one can compute on, plot or print.",
        epilog=EXAMPLES,
        formatter_class=_formatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"img2tri {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, title="commands")
    mesh = commands.add_parser(
        "mesh",
        help="mesh images",
        usage="img2tri mesh IMAGE... -o MESH [options]",
        description=MESH,
        epilog=EXAMPLES,
        formatter_class=_formatter,
        allow_abbrev=False,
    )
    _add_files(mesh)
    _add_mesh_options(mesh)
    page = commands.add_parser(
        "view-report",
        help="a page about a mesh",
        usage="img2tri view-report IMAGE -o PAGE [options]",
        description=PAGE,
        formatter_class=_formatter,
        allow_abbrev=False,
    )
    page.add_argument("image", metavar="IMAGE", help="PNG, TIFF, JPEG, BMP and others")
    page.add_argument("-o", "--output", required=True, metavar="PAGE", help=".html")
    page.add_argument("--quiet", action="store_true", help="print errors only")
    _add_mesh_options(page)
    quality = commands.add_parser(
        "quality", help="judge meshes", description=QUALITY, formatter_class=_formatter, allow_abbrev=False
    )
    quality.add_argument("meshes", nargs="+", metavar="MESH", help=".stl, .ply, .obj, .off, .glb, .vtp, .vtu, .msh or .bdf")
    return parser


def _formatter(prog: str) -> RawDescriptionHelpFormatter:
    return RawDescriptionHelpFormatter(prog, max_help_position=30)


def _add_files(parser: ArgumentParser) -> None:
    """Add the images and the files that ``img2tri mesh`` makes of them."""
    parser.add_argument("images", nargs="+", metavar="IMAGE", help="PNG, TIFF, JPEG, BMP and others")

    about = "With several images, names hold {stem}, which becomes the name of the image without folder and suffix."
    add = parser.add_argument_group("files to write", about).add_argument
    formats = (
        "to print or look at: .stl .ply .obj .off .3mf .glb .vtp .vtu; for solvers: .msh .inp .bdf .xdmf .vtkhdf; outlines: .svg .dxf "
        ".geojson; may be given several times"
    )
    add("-o", "--output", dest="outputs", action="append", default=[], metavar="MESH", help=formats)
    add("--height", type=_number, metavar="H", help="world units: write the closed solid from z = 0 to H, for printing; else flat")
    add("--plot", metavar="FIGURE", help=".png, .svg or .pdf: the mesh over its image, and a histogram")
    colours = ("quality", "region", "none")
    add("--colour-by", choices=colours, default="quality", help="what the figure shows; none: red edges (default quality)")
    add("--report", metavar="REPORT", help=".json: what the mesh keeps of what was promised; a warning for each promise that it does not")
    add("--quiet", action="store_true", help="print errors and warnings only")


def _add_mesh_options(parser: ArgumentParser) -> None:
    """Add the options of mesh_image. One without a default here is left to mesh_image."""
    add = parser.add_argument_group("what is meshed", argument_default=SUPPRESS).add_argument
    add("--threshold", type=_number_or_word, metavar="T", help="gray level, above which is white, or otsu (default: the middle of "
        "two values, else otsu; the paper's recipes 240)")  # fmt: skip
    add("--invert", action="store_true", help="mesh what is dark")
    add("--connectivity", type=_whole, metavar="4|8", help="pixels hang together through sides, or also through corners (default 4)")
    add("--labels", type=_labels, metavar="[LIST]", help="every value is a region of its own; with a list such as 1,2,3 these are")
    add("--background", type=_background, metavar="N", help="the value that is not meshed, or none (default 0)")
    add("--name", dest="names", action="append", type=_name, metavar="N=NAME", help="name of a region, as in 1=bone; several times")
    add("--crop", type=_numbers, metavar="L,B,R,T", help="mesh only this part: left, bottom, right, top in world units")
    add("--min-area", metavar="A", help="drop specks and fill holes smaller than this, in world units squared or as 20px2")
    add("--largest", action="store_true", help="keep only the largest component of each region")
    add("--page", type=_whole, metavar="N", help="which image of a file with several, from 0 (default 0)")
    add("--max-pixels", type=_whole, metavar="N", help="refuse larger images (default 268435456)")

    add = parser.add_argument_group("where it lies", argument_default=SUPPRESS).add_argument
    add("--spacing", type=_pair, metavar="S", help="size of a pixel in world units, as 0.5 or 0.5,0.7, or file: what the file says, "
        "in mm (default 1)")  # fmt: skip
    add("--origin", type=_pair, metavar="O", help="lower: (0, 0) is the lower-left corner, y up; upper: the upper-left one, y down; "
        "x,y: place of the lower-left corner (default lower)")  # fmt: skip

    add = parser.add_argument_group("how it is meshed", argument_default=SUPPRESS).add_argument
    add("--recipe", metavar="R", help="conforming, or the paper's: structured, unstructured (default conforming)")
    add("--outline", metavar="O", help="smooth: where the edge is likely to be; pixel: along the sides of pixels (default smooth)")
    add("--corners", metavar="C", help="auto: sharp as far as --min-angle allows; keep: always; round: smoothed (default auto)")
    add("--edge-length", type=_lengths, metavar="L", help="wanted length of edges, or one for each region, as in 1=4,2=8px (default: "
        "some 2000 triangles, at least 4px)")  # fmt: skip
    add("--boundary-edge-length", metavar="L", help="length along outlines; fine there, coarse inside")
    add("--min-edge-length", metavar="L", help="outlines get no shorter edges for the sake of the next two options")
    add("--elements-across", type=_number, metavar="N", help="at least so many edges across the thinnest places")
    add("--segments-per-turn", type=_number, metavar="N", help="at least so many edges to a full turn of an outline")
    add("--gradation", type=_number, metavar="G", help="how much lengths may grow per unit of distance (default 0.3)")
    add("--min-angle", type=_number, metavar="A", help="least angle of a triangle, 0 to 33 degrees (default 30)")
    add("--tolerance", metavar="L", help="greatest distance between outlines and mesh (default 0.5px)")
    add("--keep-area", action=BooleanOptionalAction, help="move vertices outwards on curved outlines, so that areas are kept, or leave "
        "them on the outlines (default --keep-area)")  # fmt: skip
    add("--periodic", metavar="D", help="x, y or xy: opposite sides, whose pixels have to be the same, get vertices at the same places")
    add("--interior", metavar="I", help="lattice: even triangles; poisson: scattered points, as in the paper (default lattice)")
    add("--smoothing", metavar="S", help="none, uniform or cotangent (default none; uniform for unstructured)")
    add("--iterations", type=_whole, metavar="N", help="passes of smoothing (default 10)")

    add = parser.add_argument_group("the paper's recipes only", "All follow from --edge-length.", argument_default=SUPPRESS).add_argument
    add("--step", metavar="L", help="structured: distance of the points of the grid")
    add("--n-boundary-points", type=_whole, metavar="N", help="unstructured: points on each contour")
    add("--n-interior-points", type=_whole, metavar="N", help="unstructured: points inside each contour (default: as many as fit)")
    add("--min-distance", metavar="L", help="unstructured: least distance of points inside")
    add("--min-distance-to-boundary", metavar="L", help="unstructured: least distance of points inside to those on the contour")
    add("--seed", type=_whole, metavar="N", help="of the points inside (default 0)")


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"expected a number, found {text!r}") from None


def _whole(text: str) -> int:
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
    return tuple(map(_number, text.split(",")))


def _pair(text: str) -> float | str | tuple[float, ...]:
    return _numbers(text) if "," in text else _number_or_word(text)


def _lengths(text: str) -> str | dict[int, str]:
    return dict(map(_name, text.split(","))) if "=" in text else text


def _labels(text: str) -> bool | list[int]:
    return True if text == "all" else list(map(_whole, text.split(",")))


def _background(text: str) -> int | None:
    return None if text.lower() == "none" else _whole(text)


def _name(text: str) -> tuple[int, str]:
    number, _, name = text.partition("=")
    if not name:
        raise ArgumentTypeError(f"expected the number of a region, =, and what it gets, as in 1=bone, found {text!r}")
    return _whole(number), name
