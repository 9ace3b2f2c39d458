"""Any bytes as an image: a mesh or an error of img2tri, in bounded time and memory; never another exception, a crash, a hang."""

from __future__ import annotations

import io
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from img2tri import mesh_image
from img2tri.errors import FileError, ImageError

pytest.importorskip("resource")
import children
import specimens

DISC = specimens.disc(24, 8.0).astype(bool)
LIMIT = 2 * children.GIGABYTE


def mesh_file(case):
    """Read and mesh a file of these bytes; what is read must then be a picture like any other."""
    name, data = case
    path = Path(f"hostile-{os.getpid()}{name}")
    path.write_bytes(data)
    try:
        mesh = mesh_image(path, edge_length="8px", max_pixels=2**20)
    finally:
        path.unlink()
    return f"{len(mesh.triangles)} triangles"


def mesh_path(case):
    path, options = case
    return f"{len(mesh_image(path, **options).triangles)} triangles"


# ---- what files are made of ----


def chunk(kind, data, crc=None):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data) if crc is None else crc)


def png(width=24, height=24, depth=8, colour=0, interlace=0, chunks=(), rows=None, idat=None, end=True):
    """A PNG by hand, so that everything in it can be wrong."""
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}.get(colour, 1)
    if idat is None:
        if rows is None:
            rows = b"".join(b"\0" + bytes((r * 7 + i) % 251 for i in range((width * channels * depth + 7) // 8)) for r in range(height))
        idat = [zlib.compress(rows)]
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlace)
    parts = [b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", head), *chunks, *(chunk(b"IDAT", part) for part in idat)]
    return b"".join(parts) + (chunk(b"IEND", b"") if end else b"")


def saved(image, kind, **options):
    file = io.BytesIO()
    image.save(file, kind, **options)
    return file.getvalue()


def picture(mode="L"):
    y, x = np.mgrid[:24, :24]
    gray = np.where(DISC, 160 + 3 * x, 20 + 2 * y).astype(np.uint8)
    if mode in ("I;16", "I", "F"):
        return Image.fromarray({"I;16": gray.astype(np.uint16) * 250, "I": gray.astype(np.int32) * 99999, "F": gray / np.float32(7)}[mode])
    return Image.fromarray(np.dstack([gray, gray[::-1], gray.T])).convert(mode)


def formats():
    """One small sound file of each kind: name -> (suffix, bytes)."""
    import tifffile

    frames = [picture("P").rotate(20 * k) for k in range(4)]
    made = {
        "png-gray": saved(picture(), "PNG"),
        "png-rgba": saved(picture("RGBA"), "PNG"),
        "png-1": saved(picture("1"), "PNG"),
        "png-16": saved(picture("I;16"), "PNG"),
        "png-palette-trns": saved(picture("P"), "PNG", transparency=3),
        "png-palette-4": saved(picture().quantize(11), "PNG", bits=4),
        "png-trns-gray": saved(picture(), "PNG", transparency=40),
        "png-rgb-16": png(depth=16, colour=2),
        "png-interlaced": png(interlace=1, rows=bytes(3000)),
        "jpg-gray": saved(picture(), "JPEG"),
        "jpg-rgb-progressive": saved(picture("RGB"), "JPEG", progressive=True),
        "jpg-cmyk": saved(picture("CMYK"), "JPEG"),
        "gif": saved(picture("P"), "GIF"),
        "gif-animated": saved(frames[0], "GIF", save_all=True, append_images=frames[1:]),
        "bmp": saved(picture("RGB"), "BMP"),
        "bmp-1": saved(picture("1"), "BMP"),
        "tif": saved(picture(), "TIFF"),
        "tif-lzw": saved(picture("RGB"), "TIFF", compression="tiff_lzw"),
        "tif-1-group4": saved(picture("1"), "TIFF", compression="group4"),
        "tif-pages": saved(picture(), "TIFF", save_all=True, append_images=[picture().rotate(90)]),
        "tif-float": saved(picture("F"), "TIFF"),
        "ppm": saved(picture("RGB"), "PPM"),
        "webp": saved(picture("RGB"), "WEBP"),
        "tga": saved(picture("RGB"), "TGA"),
        "ico": saved(picture("RGBA"), "ICO"),
        "jp2": saved(picture(), "JPEG2000"),
    }
    for dtype in ("int8", "uint32", "int64", "float64", "float16", "uint16"):
        file = io.BytesIO()
        tifffile.imwrite(file, np.asarray(picture()).astype(dtype), compression="zlib" if dtype == "int64" else None)
        made[f"tif-{dtype}"] = file.getvalue()
    file = io.BytesIO()
    tifffile.imwrite(file, np.asarray(picture("RGB")).astype(np.uint16) * 200, photometric="rgb", bigtiff=True)
    made["tif-rgb-16-big"] = file.getvalue()
    return {name: (suffix_of(name), data) for name, data in made.items()}


def suffix_of(name):
    return "." + name.partition("-")[0]


FORMATS = formats()


def check(function, cases, **limits):
    """Run all cases; none may end in anything but a mesh or an error of img2tri."""
    outcomes = children.run(function, cases, **({"memory": LIMIT} | limits))
    wrong = [(case[0], outcome) for case, outcome in zip(cases, outcomes, strict=True) if outcome.kind not in ("done", "refused")]
    assert not wrong, f"{len(wrong)} of {len(cases)}: {wrong[:3]}"
    return outcomes


def flipped(data, rng):
    """A few bits or bytes changed, a piece cut out or doubled."""
    bytes_ = bytearray(data)
    how = rng.integers(4)
    at = int(rng.integers(len(bytes_)))
    if how == 0:
        for i in rng.integers(0, len(bytes_), int(rng.integers(1, 5))):
            bytes_[i] ^= 1 << int(rng.integers(8))
    elif how == 1:
        for i in rng.integers(0, min(len(bytes_), 120), int(rng.integers(1, 4))):
            bytes_[i] = int(rng.choice([0, 1, 127, 128, 255, int(rng.integers(256))]))
    elif how == 2:
        del bytes_[at : at + int(rng.integers(1, 40))]
    else:
        bytes_[at:at] = bytes_[at : at + int(rng.integers(1, 40))]
    return bytes(bytes_)
