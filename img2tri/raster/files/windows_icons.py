"""Windows icons: how large the images in them are -> checked before Pillow decodes one, which it does as soon as it opens the file."""

from __future__ import annotations

import struct

from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import check_page

ICON_START = b"\0\0\1\0"
PNG_START = b"\x89PNG\r\n\x1a\n"


def check_icon(source: Source, max_pixels: int) -> None:
    """Refuse an icon that holds an image of more than `max_pixels`; what is no icon or a damaged one is left to others.

    The directory of an icon says little of its images: a side is one byte. What counts is the head of each image, a PNG or a bitmap::

        0 1 n | side side . . . . . . bytes of it, place of it | the next ...
    """
    with source.open() as file:
        head = file.read(6)
        if head[:4] != ICON_START:
            return
        directory = file.read(16 * int.from_bytes(head[4:6], "little"))
        for entry in range(0, len(directory) - 15, 16):
            file.seek(int.from_bytes(directory[entry + 12 : entry + 16], "little"))
            start = file.read(24)
            if len(start) == 24:
                width, height = struct.unpack(">16xII", start) if start[:8] == PNG_START else struct.unpack("<4xii12x", start)
                check_page(source, 0, 1, abs(width), abs(height), max_pixels)
