"""The options of outlines, edge lengths and triangles: one entry each, in groups as in `img2tri.options.image_options`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, TypedDict

from img2tri.options import option as o
from img2tri.options import parsing
from img2tri.options.option import Option

if TYPE_CHECKING:
    from img2tri.shapes.sizes.user_size_field import EdgeLength

RECIPES = ("conforming", "structured", "unstructured")
SMOOTHINGS = ("none", "uniform", "cotangent")
MOST_PASSES = 100_000


class RecipeOptions(TypedDict, total=False):
    """Which recipe makes the mesh."""

    recipe: Annotated[
        str,
        Option(
            "conforming",
            '"conforming": every region with its own outline, holes and all; "structured" and "unstructured": as in the paper, with what '
            "these get wrong counted in the report.",
            check=o.one_of(*RECIPES),
            sign="R",
        ),
    ]


class OutlineOptions(TypedDict, total=False):
    """Options of `recipes.conforming.trace_outlines`."""

    outline: Annotated[
        str,
        Option(
            "smooth",
            '"smooth": through the places between the pixels where the edge is likely to be; "pixel": exactly along their sides.',
            check=o.one_of("smooth", "pixel"),
            sign="O",
        ),
    ]
    corners: Annotated[
        str,
        Option(
            "auto",
            '"auto": corners are kept sharp as far as `min_angle` allows; "keep": always, and smaller angles are listed in the report; '
            '"round": they are smoothed as all else is.',
            check=o.one_of("auto", "keep", "round"),
            sign="C",
        ),
    ]
    periodic: Annotated[
        str | None,
        Option(
            None,
            '"x", "y" or "xy": the image repeats in these directions, after as many pixels as it has; opposite sides get vertices at the '
            "same places.\n\nSee `TriangleMesh.periodic_pairs`. What is meshed on one side only, as its labels differ, has no partner.",
            none="sides are meshed each by itself",
            sign="D",
        ),
    ]


class SymmetryOptions(TypedDict, total=False):
    """Options of `recipes.mirrored.conform_symmetric`."""

    symmetric: Annotated[
        str | None,
        Option(
            None,
            '"x", "y" or "xy": left and right, bottom and top, or both are mirror images in the mesh as in the image; vertices lie '
            "exactly on the axis. An image that is not its own mirror image is refused.",
            none="the mesh of a symmetric image is not quite symmetric",
            check=o.one_of("x", "y", "xy"),
            sign="D",
            recipes=("conforming",),
        ),
    ]


class BlockOptions(TypedDict, total=False):
    """Options of `tiles.blocks_in_memory.conform_blocks`."""

    blocks: Annotated[
        bool,
        Option(
            False,
            "Mesh the image in blocks of 2048 px, each fitted to its neighbours: the same bits as `mesh_tiles`.\n\n"
            "A change of the image then changes the mesh in its block and those around only. Takes up to twice the time; images of one "
            "block are as without.",
            check=o.yes_or_no,
        ),
    ]


class SizeOptions(TypedDict, total=False):
    """Options of `recipes.wanted_sizes.wanted_sizes`."""

    edge_length: Annotated[
        EdgeLength | None,
        Option(
            None,
            "Wanted length of edges, in world units, px or % of the image diagonal; or one for each label, as in 1=4,2=8px.\n\n"
            'Smaller is finer and slower. In Python: a number, "8px", "2%"; lengths by label, ``{1: 4, 2: "8px"}``; an array (h, w) of '
            "lengths, one for each pixel; a function of places (k, 2) that returns lengths (k,).",
            none="some 2000 triangles fill the image, at least 4 px",
            check=o.edge_lengths,
            typed=parsing.length_by_label,
            sign="L",
            kind="float | str | dict | array | callable | None",
        ),
    ]
    gradation: Annotated[
        float,
        Option(
            0.17,
            "By how much the length may grow per unit of distance; smaller gives better triangles, and more of them.",
            check=o.real(least=0.001, most=100),
            typed=parsing.number,
            sign="G",
        ),
    ]
    min_edge_length: Annotated[
        float | str | None,
        Option(
            None,
            "The other options of lengths make no edge of an outline shorter than this; tolerance, topology and angles may.",
            none="as short as these ask for",
            check=o.length,
            sign="L",
        ),
    ]
    boundary_edge_length: Annotated[
        float | str | None,
        Option(None, "Length of edges along all outlines; fine there, coarse inside.", none="as inside", check=o.length, sign="L"),
    ]
    elements_across: Annotated[
        float | None,
        Option(
            None,
            "At least so many edges across the thinnest places; 2 or 3 for bending.",
            none="not looked after",
            check=o.real(above=0),
            typed=parsing.number,
            sign="N",
        ),
    ]
    segments_per_turn: Annotated[
        float | None,
        Option(
            None,
            "At least so many edges to a full turn of an outline, so that curves stay round; what turns within some 12 px is taken for a "
            "corner.\n\nThe default costs a few per cent of triangles, more where an image is made of curves; 3 turns it off.",
            none="20, but edges no shorter for that than a third of the length wanted",
            check=o.real(least=3),
            typed=parsing.number,
            sign="N",
        ),
    ]


class ToleranceOptions(TypedDict, total=False):
    """How far outlines and mesh may be apart."""

    tolerance: Annotated[
        float | str,
        Option(
            "0.5px",
            "The greatest distance between the outlines and the edges of the mesh, a length; larger lets sharp detail go.",
            check=o.length,
            sign="L",
        ),
    ]


class FillOptions(TypedDict, total=False):
    """Options of `recipes.conforming.conform`, beside `corners` and `periodic`."""

    min_angle: Annotated[
        float,
        Option(
            30.0,
            "The least angle of a triangle, 0 to 32 degrees; above 30 more triangles are needed.",
            check=o.real(least=0, most=32),
            typed=parsing.number,
            sign="A",
        ),
    ]
    keep_area: Annotated[
        bool,
        Option(
            True,
            "Vertices on curved outlines lie a little outwards, so that straight edges enclose the area of the curve; else they lie on it."
            "\n\nComputations on the mesh are several times as exact with it.",
            check=o.yes_or_no,
        ),
    ]
    interior: Annotated[
        str,
        Option(
            "lattice",
            'Points inside: "lattice", for the best triangles; "poisson", scattered as in the paper.',
            check=o.one_of("lattice", "poisson"),
            sign="I",
        ),
    ]
    seed: Annotated[
        int,
        Option(
            0,
            "For scattered points, all that is random. The same seed gives the same mesh.",
            check=o.whole(most=2**64 - 1),
            typed=parsing.whole_number,
            sign="N",
        ),
    ]


class SmoothOptions(TypedDict, total=False):
    """Options of the smoothing that comes last, see `TriangleMesh.smoothed`."""

    smoothing: Annotated[
        str | None,
        Option(
            None,
            '"none"; "uniform": each vertex to the mean of its neighbours; "cotangent": rounds off what is left of the pixels on boundary '
            "and interfaces within the tolerance, the interior following.",
            none='"uniform" for the recipe "unstructured", else "none"',
            check=o.one_of(*SMOOTHINGS),
            sign="S",
        ),
    ]
    iterations: Annotated[
        int,
        Option(10, "Passes of smoothing.", check=o.whole(most=MOST_PASSES), typed=parsing.whole_number, sign="N"),
    ]
