"""Volumes and stacks -> one plane of them: which axes are the image, and only as many bytes as that needs.

Formats that store arrays know more axes than an image has. Axes of length one are dropped; a last axis of 3 or 4 after two others is
colours; the two before are rows and columns; all others are pages, the last of them running fastest.
"""

from __future__ import annotations

import bz2
import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.in_memory.array_checks import Pixels

BYTES_AT_ONCE = 2**20


@dataclass(frozen=True)
class Planes:
    """The planes of an array.

    Attributes
    ----------
    shape
        Of the array, axes of length one dropped.
    height, width
        Of each plane.
    colours
        3 or 4 where the last axis is colours, else 0.
    """

    shape: tuple[int, ...]
    height: int
    width: int
    colours: int

    @property
    def pages(self) -> int:
        """How many planes there are."""
        return math.prod(self.shape[: self.first])

    @property
    def first(self) -> int:
        """How many axes come before rows and columns."""
        return len(self.shape) - 2 - bool(self.colours)

    @property
    def plane(self) -> tuple[int, ...]:
        """The shape of one plane."""
        return self.shape[self.first :]

    def index(self, page: int) -> tuple[int, ...]:
        """Return the indices of a page along the first axes."""
        return tuple(int(i) for i in np.unravel_index(page, self.shape[: self.first])) if self.first else ()


def planes_of(shape: tuple[int, ...], source: Source) -> Planes:
    """Return the planes of an array of some shape, or say that it has none.

    Examples
    --------
    >>> from img2tri.raster.files.byte_sources import Source
    >>> planes_of((1, 7, 20, 30), Source("a.npy")).pages, planes_of((20, 30, 3), Source("a.npy")).pages
    (7, 1)
    """
    if len(shape) < 2 or min(shape) < 1:
        raise ImageError(f"image: expected an array of at least two axes in {str(source)!r}, found shape {shape}")
    kept = list(shape)
    while len(kept) > 2 and 1 in kept:
        kept.remove(1)
    colours = kept[-1] if len(kept) > 2 and kept[-1] in (3, 4) else 0
    height, width = kept[-3:-1] if colours else kept[-2:]
    return Planes(tuple(kept), height, width, colours)


def read_plane(file: BinaryIO, source: Source, dtype: np.dtype[np.generic], planes: Planes, page: int, encoding: str = "raw") -> Pixels:
    """Read one plane of an array whose values follow each other from here on, uncompressed, or compressed as a whole.

    What comes before is read and thrown away part by part, so that a small file cannot fill the memory.
    """
    count = math.prod(planes.plane) * dtype.itemsize
    skip, held = page * count, bytearray()
    for part in _parts(file, encoding):
        passed = min(skip, len(part))
        skip -= passed
        held += part[passed : passed + count - len(held)]
        if len(held) == count:
            return np.frombuffer(bytes(held), dtype).reshape(planes.plane)
    raise FileError(f"image: {str(source)!r} is damaged or truncated: it has fewer values than its header says")


def _parts(file: BinaryIO, encoding: str) -> Iterator[bytes]:
    """Yield what follows in a file, unpacked, in parts of bounded size."""
    if encoding == "raw":
        while part := file.read(BYTES_AT_ONCE):
            yield part
    elif encoding == "gzip":
        unzip = zlib.decompressobj(zlib.MAX_WBITS | 32)  # with the header of gzip or of zlib
        packed = file.read(BYTES_AT_ONCE)
        while packed and not unzip.eof:
            yield unzip.decompress(packed, BYTES_AT_ONCE)
            packed = unzip.unconsumed_tail or file.read(BYTES_AT_ONCE)
        yield unzip.flush()
    else:
        unpack = bz2.BZ2Decompressor()
        while not unpack.eof:
            packed = file.read(BYTES_AT_ONCE) if unpack.needs_input else b""
            if unpack.needs_input and not packed:
                return
            yield unpack.decompress(packed, BYTES_AT_ONCE)
