"""The options of reading an image and finding its regions: one entry each.

A group is what one stage gets. Groups are dictionaries with typed keys, so that editors and mypy know every option of `mesh_image`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated, TypedDict

from img2tri.options import option as o
from img2tri.options import parsing
from img2tri.options.option import Option

UNITS = ("um", "mm", "cm", "m", "in", "ft")


class ReadOptions(TypedDict, total=False):
    """Options of `raster.reading.read`."""

    spacing: Annotated[
        float | Sequence[float] | str | None,
        Option(
            None,
            'Size of a pixel in world units: a number, a pair (dx, dy), or "file", what the file says, in its unit.',
            none="1, or what a DICOM, NIfTI, NRRD or MetaImage file says",
            typed=parsing.pair_or_word,
            sign="S",
        ),
    ]
    origin: Annotated[
        str | Sequence[float],
        Option(
            "lower",
            '"lower": (0, 0) is the lower-left corner of the image, y points up; "upper": the upper-left corner, y points down; '
            "(x, y): the place of the lower-left corner, in world units.",
            typed=parsing.pair_or_word,
            sign="O",
        ),
    ]
    page: Annotated[
        int,
        Option(
            0,
            "Which image of a file with several, from 0: a page, a frame, a slice of a volume.",
            check=o.whole(),
            typed=parsing.whole_number,
            sign="N",
        ),
    ]
    max_pixels: Annotated[
        int,
        Option(
            2**28,
            "The most pixels a file may have; larger ones are refused before they fill the memory.",
            check=o.whole(least=1, most=2**63 - 1),
            typed=parsing.whole_number,
            sign="N",
        ),
    ]


class WidthOptions(TypedDict, total=False):
    """Options of `raster.metadata.wanted_width.as_wide_as`."""

    width: Annotated[
        float | None,
        Option(
            None,
            "Width of the whole image in world units; the size of a pixel follows. In place of `spacing`.",
            none="as `spacing` says",
            check=o.real(above=0),
            typed=parsing.number,
            sign="W",
        ),
    ]


class PartOptions(TypedDict, total=False):
    """Options of `raster.labels.cropping.crop`."""

    crop: Annotated[
        Sequence[float] | None,
        Option(
            None,
            "Mesh only this part of the image, where it lies: (left, bottom, right, top) in world units.",
            none="all of it",
            typed=parsing.comma_separated,
            sign="L,B,R,T",
        ),
    ]


class SegmentOptions(TypedDict, total=False):
    """Options of `raster.labels.segmentation.segment`."""

    threshold: Annotated[
        float | str | Sequence[float] | None,
        Option(
            None,
            "Gray level on the image's own scale; strictly greater is white and meshed. \"otsu\": Otsu's level.\n\n"
            '"alpha": the silhouette, all that is opaque. Rising levels, as in [110, 190]: the values between two are a region, label 0 up '
            "to the first, 1 up to the second, and so on.",
            none="the silhouette if pixels are transparent, half-way if it has two values, else Otsu's level; 240 in the paper's recipes",
            check=o.one_level_or_more,
            typed=parsing.numbers_or_word,
            sign="T",
        ),
    ]
    labels: Annotated[
        bool | Iterable[int] | None,
        Option(
            None,
            "True: every value of the image is a region of its own. A list of values: these are.",
            none="one white zone, region 1",
            check=o.all_or_some,
            typed=parsing.all_or_labels,
            sign="[LIST]",
        ),
    ]
    background: Annotated[
        int | None,
        Option(
            0,
            "The label that is not meshed; None: all are meshed.",
            check=o.one_label,
            typed=parsing.label_or_none,
            sign="N",
        ),
    ]
    colors: Annotated[
        int | Sequence[int | str | Sequence[int]] | None,
        Option(
            None,
            "Each pixel gets one of a few flat colours: how many to find besides the background, or a list of them.\n\n"
            "For drawings, screenshots and label maps whose edges are anti-aliased, blurred or JPEG. Each colour is a region, its label "
            "0xRRGGBB or the gray value; where a pixel is a mix of two, the mix places the edge. In a list colours are such numbers, "
            "'#rrggbb' or (r, g, b).",
            none="colours are not looked for",
            check=o.count_or_colours,
            typed=parsing.typed_colours,
            sign="N|LIST",
        ),
    ]
    absorb: Annotated[
        int | Iterable[int] | None,
        Option(
            None,
            "Labels whose pixels are given to their nearest neighbours first: watershed lines, borders, pixels that were not indexed.\n\n"
            "So regions parted by thin lines touch, and have interfaces. The image is a label map then, as with `labels`.",
            none="every label keeps its pixels",
            check=o.one_label_or_more,
            typed=parsing.whole_numbers,
            sign="LIST",
        ),
    ]
    invert: Annotated[bool, Option(False, "Mesh what is dark.", check=o.yes_or_no)]


class SpeckOptions(TypedDict, total=False):
    """Options of `raster.labels.segmentation.without_specks`."""

    min_area: Annotated[
        float | str | None,
        Option(
            None,
            "Drop specks and fill holes smaller than this, in world units squared, or in pixels as 20px2.\n\n"
            "In label maps they become part of the neighbour they share most with. What was removed is in the report.",
            none="nothing is removed",
            check=o.area,
            sign="A",
        ),
    ]
    fill_holes: Annotated[
        bool | float | str | None,
        Option(
            None,
            "Fill holes, and drop nothing: True fills all, an area, in world units squared or in pixels as 20px2, those smaller than it.",
            none="holes stay, but for those smaller than `min_area`",
            check=o.yes_or_area,
            typed=parsing.yes_or_text,
            sign="[A]",
        ),
    ]
    largest: Annotated[bool, Option(False, "Keep only the largest component of each region.", check=o.yes_or_no)]
    connectivity: Annotated[
        int,
        Option(
            4,
            "Pixels hang together through their sides (4), or also through their corners (8).",
            check=o.four_or_eight,
            typed=parsing.whole_number,
            sign="4|8",
        ),
    ]


class NameOptions(TypedDict, total=False):
    """What meshes and files carry along."""

    names: Annotated[
        dict[int, str] | None,
        Option(
            None,
            "Names of regions by label, as in 1=bone.",
            none="those of a segmentation of 3D Slicer, else a region is called by its label",
            check=o.names_by_label,
            typed=parsing.label_and_value,
            sign="N=NAME",
            flag="--name",
        ),
    ]
    units: Annotated[
        str | None,
        Option(
            None,
            f"What a world unit is, for files that can tell: {', '.join(UNITS)}.",
            none="that of the file with `spacing` from it, mostly mm; else unknown",
            check=o.one_of(*UNITS),
            sign="U",
        ),
    ]
