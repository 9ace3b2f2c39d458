"""The options of the command line: arguments as typed -> a namespace, with numbers as numbers.

Only what makes a text a number, a pair or a list is checked here; what values may be is for `img2tri.mesh_image` to say.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter, _SubParsersAction
from collections.abc import Sequence
from typing import NoReturn

from img2tri import __version__
from img2tri.cli.commands.app_command import add_app
from img2tri.cli.commands.tiles_command import add_tiles
from img2tri.cli.option_arguments import add_mesh_options
from img2tri.cli.save_arguments import add_save_options
from img2tri.options.all_options import nearest
from img2tri.options.parsing import whole_number

COMMANDS = ("mesh", "tiles", "view-report", "quality", "app")
LABEL = r"(-?\d+|0x[\da-fA-F]+|#[\da-fA-F]{6})"
LABELS = rf"{LABEL}(,{LABEL})*"
OPEN = {"--labels": LABELS, "--fill-holes": r"[\d.]+(px2)?"}  # options that mean all without a value, and what their values look like
IMAGES = "files, folders of images, patterns such as scans/*.png; PNG, TIFF, JPEG, BMP and others; - for stdin"
EXAMPLES = """examples:
  img2tri mesh femur.png -o femur.stl -o femur.vtu --plot femur_mesh.png
  img2tri mesh slice.png -o bone.stl --threshold otsu --spacing 0.5 --height 5
  img2tri mesh grains.png -o grains.vtu --labels --edge-length 2%
  img2tri mesh scans/*.png --out-dir meshes --format stl --workers 4
  img2tri mesh scans/*.png -o "meshes/{stem}.ply" --report "reports/{stem}.json"
  cat femur.png | img2tri mesh - -o - --format stl > femur.stl
  img2tri view-report femur.png -o femur.html --edge-length 8
  img2tri tiles slide.zarr -o slide.pvtu --workers 4
  img2tri app femur.png
  img2tri quality femur.stl
"""
MESH = """Mesh images: the white zone, or every label of a label map.

Lengths are in world units (8), pixels (8px) or percent of the image diagonal
(2%). A pixel is 1 world unit unless --spacing says otherwise. A value that
begins with a minus is joined by =, as in --origin=-5,-5.

Of several images, one that fails does not stop the others; the last line says
which did, and the exit status is 2.
"""
PAGE = """Mesh an image and write a page about it: the mesh over the image, to zoom into, a
histogram of its quality, its certificate, and the command that makes it again.
One file, which needs nothing else to be looked at. Options are those of mesh.
"""
QUALITY = """Print a table of the quality of meshes, plane or solid.

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
    parser = _parser()
    given, unknown = parser.parse_known_args(_with_values(argv))
    if unknown:
        _refuse(unknown, parser, given.command)
    if "names" in given:
        given.names = dict(given.names)
    return given


def _refuse(unknown: Sequence[str], parser: ArgumentParser, command: str) -> NoReturn:
    """Say which option there is not, which is nearest, and where the options of the command are listed."""
    mine = _commands(parser)[command]
    wrong = next((text for text in unknown if text.startswith("-")), unknown[0]).partition("=")[0]
    hint = nearest(wrong, [flag for action in mine._actions for flag in action.option_strings])
    mine.error(f"{wrong}: there is no such option" + (hint.replace("'", "") if wrong.startswith("-") else ""))


def _commands(parser: ArgumentParser) -> dict[str, ArgumentParser]:
    """Return the parsers of the commands by their names."""
    choices = next(action.choices for action in parser._actions if isinstance(action, _SubParsersAction))
    return dict(choices)


def _with_values(argv: Sequence[str]) -> list[str]:
    """Join options that may be without a value and their value, if one follows; argparse would take the name of an image for it."""
    joined: list[str] = []
    for argument in argv:
        flag = joined[-1].removesuffix("=all") if joined else ""
        if flag in OPEN and joined[-1].endswith("=all") and re.fullmatch(OPEN[flag], argument):
            joined[-1] = f"{flag}={argument}"
        else:
            joined.append(f"{argument}=all" if argument in OPEN else argument)
    return joined


class _Parser(ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say what is wrong in one line, without the usage of all options before it."""
        wrong = re.match(r"argument COMMAND: invalid choice: '(.*?)'", message)
        if wrong:
            message = f"{wrong[1]!r}: there is no such command{nearest(wrong[1], COMMANDS)}"
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
        usage="img2tri mesh IMAGE... -o MESH [options]\n       img2tri mesh IMAGE... --out-dir FOLDER [options]",
        description=MESH,
        epilog=EXAMPLES,
        formatter_class=_formatter,
        allow_abbrev=False,
    )
    _add_files(mesh)
    add_mesh_options(mesh)
    page = commands.add_parser(
        "view-report",
        help="a page about a mesh",
        usage="img2tri view-report IMAGE -o PAGE [options]",
        description=PAGE,
        formatter_class=_formatter,
        allow_abbrev=False,
    )
    page.add_argument("image", metavar="IMAGE", help=IMAGES)
    page.add_argument("-o", "--output", required=True, metavar="PAGE", help=".html, or - for stdout")
    page.add_argument("--quiet", action="store_true", help="print errors only")
    add_mesh_options(page)
    add_tiles(commands)
    add_app(commands)
    quality = commands.add_parser("quality", help="judge meshes", description=QUALITY, formatter_class=_formatter, allow_abbrev=False)
    quality.add_argument(
        "meshes",
        nargs="+",
        metavar="MESH",
        help=".stl .ply .obj .off .glb .3mf .vtp .vtu .vtkhdf .msh .bdf .inp .mesh .xdmf, flat or solid; - for stdin",
    )
    quality.add_argument("--format", metavar="F", help="of a mesh on stdin, such as stl")
    return parser


def _formatter(prog: str) -> RawDescriptionHelpFormatter:
    return RawDescriptionHelpFormatter(prog, max_help_position=30)


def _add_files(parser: ArgumentParser) -> None:
    """Add the images and the files that ``img2tri mesh`` makes of them."""
    parser.add_argument("images", nargs="+", metavar="IMAGE", help=IMAGES)

    about = (
        "With several images, names hold {stem}, which becomes the name of the image without folder and suffix, stdin for -.\n"
        "When a mesh goes to stdout, what is else printed there goes to stderr."
    )
    add = parser.add_argument_group("files to write", about).add_argument
    formats = (
        "to print or look at: .stl .ply .obj .off .3mf .glb .vtp .vtu; for solvers: .msh .inp .bdf .xdmf .mesh .vtkhdf; outlines: .svg "
        ".dxf .geojson; - for stdout, with --format; may be given several times"
    )
    add("-o", "--output", dest="outputs", action="append", default=[], metavar="MESH", help=formats)
    add("--out-dir", metavar="FOLDER", help="write {stem} with the suffix of each --format to this folder, made if its parent is there")
    about_format = "of files in --out-dir (default ply) or of -o -, such as stl; for --out-dir may be given several times"
    add("--format", dest="formats", action="append", default=[], metavar="F", help=about_format)
    add("--plot", metavar="FIGURE", help=".png, .svg or .pdf: the mesh over its image, and a histogram")
    colours = ("quality", "region", "none")
    add("--colour-by", choices=colours, default="quality", help="what the figure shows; none: red edges (default quality)")
    add("--report", metavar="REPORT", help=".json: what the mesh keeps of what was promised; a warning for each promise that it does not")
    about = ".csv or .parquet: a row for each image, with counts, angles, areas, distance, seconds, what was chosen; one line on screen"
    add("--summary", metavar="TABLE", help=about)
    add("--resume", action="store_true", help="skip images that --summary says are whole, with the same options, from the same bytes")
    add("--quiet", action="store_true", help="print errors and warnings only")
    add_save_options(parser.add_argument_group("how meshes are saved"))

    add = parser.add_argument_group("how it is run").add_argument
    about_workers = "mesh so many images at once, in processes of their own (default 1: in this one); the files are the same"
    add("--workers", type=whole_number, metavar="N", help=about_workers)
    add("--scheduler", metavar="ADDRESS", help="of a Dask cluster that sees the files, as tcp://host:8786; needs img2tri[dask]")
    add("--scheduler-file", metavar="FILE", help="that a Dask scheduler wrote")
