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


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_sound_files_are_read():
    outcomes = check("test_hostile_images:mesh_file", list(FORMATS.values()))
    for name, outcome in zip(FORMATS, outcomes, strict=True):
        refused = any(word in name for word in ("int8", "int32", "int64", "interlaced", "palette-4"))  # the last looks like a label map
        assert outcome.kind == ("refused" if refused else "done"), (name, outcome)


def damaged(cuts, flips, seed=1):
    for k, (suffix, data) in enumerate(FORMATS.values()):
        rng = np.random.default_rng([seed, k])
        yield from ((suffix, data[:cut]) for cut in range(0, len(data), max(1, len(data) // cuts)))
        yield from ((suffix, flipped(data, rng)) for _ in range(flips))


@pytest.mark.parametrize(("cuts", "flips"), [(6, 12), pytest.param(1000, 3000, marks=pytest.mark.slow)])
def test_damaged_files_end_in_a_mesh_or_an_error(cuts, flips):
    check("test_hostile_images:mesh_file", list(damaged(cuts, flips)))


COLOURS = [(0, d) for d in (1, 2, 4, 8, 16)] + [(2, 8), (2, 16), (4, 8), (4, 16), (6, 8), (6, 16)]
PALETTE = [chunk(b"PLTE", bytes(range(48)) * 16)]


def test_every_kind_of_png():
    sound = [(".png", png(depth=d, colour=c, interlace=i, rows=bytes(9000) if i else None)) for c, d in COLOURS for i in (0, 1)]
    sound += [(".png", png(depth=d, colour=3, chunks=[chunk(b"PLTE", bytes(range(3 * 2**d))[: 3 * 2**d]), chunk(b"tRNS", b"\0\x80")]))
              for d in (1, 2, 4)]  # fmt: skip
    wrong = [
        png(depth=3), png(depth=0), png(depth=255), png(colour=1), png(colour=7), png(interlace=2), png(0, 24), png(24, 0),
        png(colour=3), png(chunks=PALETTE), png(idat=[]), png(idat=[b""]), png(idat=[b"", zlib.compress(bytes(600))]),
        png(idat=[b"\0"]), png(end=False), png(chunks=[chunk(b"tRNS", b"")]), png(chunks=[chunk(b"tRNS", bytes(999))]),
        png(chunks=[chunk(b"gAMA", bytes(4), crc=0)]), png(chunks=[chunk(b"pHYs", bytes(9))]), png(chunks=[chunk(b"pHYs", b"\xff" * 9)]),
        png(chunks=[chunk(b"eXIf", b"II*\0" + b"\xff" * 40)]), png(chunks=[chunk(b"IHDR", bytes(13))]),
        png(chunks=[chunk(b"\0\0\0\0", b"")]),
        png(chunks=[chunk(b"iCCP", b"a\0\0" + zlib.compress(bytes(10**7)))]),
        png(chunks=[chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(10**8)))]),
    ]  # fmt: skip
    outcomes = check("test_hostile_images:mesh_file", [*sound, *((".png", data) for data in wrong)])
    assert not any("damaged" in outcome.text for outcome in outcomes[: len(sound)])


def bombs():
    info = struct.Struct("<IiiHHIIiiII")
    for side in (2**31 - 1, 16000):
        yield ".png", png(side, side, idat=[zlib.compress(bytes(1000))])
        yield ".png", png(side, side, depth=16, colour=6, idat=[zlib.compress(bytes(1000))])
        yield ".bmp", b"BM" + struct.pack("<IHHI", 100, 0, 0, 54) + info.pack(40, side, side, 1, 24, 0, 0, 0, 0, 0, 0) + bytes(100)
        yield ".pgm", b"P5 %d %d 255\n" % (side, side) + bytes(99)
    head = struct.pack("<HHBBB", 8, 8, 0, 0, 0)
    frame = b"," + struct.pack("<HHHHB", 0, 0, 65535, 65535, 0) + b"\x02\x02\x4c\x01\0;"
    yield ".gif", b"GIF89a" + head + frame
    yield ".gif", b"GIF89a" + struct.pack("<HHBBB", 65535, 65535, 0, 0, 0) + frame
    yield ".png", png(8, 8, idat=[zlib.compress(bytes(2 * 10**8), 9)])


def test_bombs_are_refused_before_they_are_unpacked():
    outcomes = check("test_hostile_images:mesh_file", list(bombs()), memory=children.GIGABYTE)
    assert all(outcome.seconds < 5 for outcome in outcomes)
    assert sum("max_pixels" in outcome.text for outcome in outcomes) >= 8


def test_paths_that_are_no_images():
    os.mkfifo("pipe.png")
    Path("folder.png").mkdir()
    Path("loop.png").symlink_to("loop.png")
    Path("dangling.png").symlink_to("nowhere")
    Path("empty.png").write_bytes(b"")
    Path("text.png").write_text("not an image" * 99)
    np.save("array.npy", DISC)
    names = ["pipe.png", "folder.png", "loop.png", "dangling.png", "empty.png", "text.png", "array.npy"]
    names += ["x" * 300 + ".png", "nul\0.png", "", "/dev/zero", "/dev/null", "/dev/random", "/proc/self/mem"]
    outcomes = check("test_hostile_images:mesh_path", [(name, {}) for name in names])
    read = [outcome.text.partition(":")[0] for outcome in outcomes]
    assert read.pop(6) == f"{len(mesh_image(DISC).triangles)} triangles"  # an array is an image
    assert read == ["FileError"] * (len(names) - 1)


def test_an_image_above_the_limit_of_pillow_is_read(tmp_path):
    import tifffile

    image = np.zeros((10000, 9000), np.uint8)
    image[100:300, 100:400] = 255
    tifffile.imwrite(tmp_path / "large.tif", image, compression="zlib")
    limit = Image.MAX_IMAGE_PIXELS
    assert len(mesh_image(tmp_path / "large.tif").triangles) > 100
    assert limit == Image.MAX_IMAGE_PIXELS
    with pytest.raises(ImageError, match="max_pixels"):
        mesh_image(tmp_path / "large.tif", max_pixels=10**6)


def test_part_of_an_image_is_never_taken_for_the_whole():
    whole = saved(picture("RGB").resize((200, 200)), "JPEG")
    Path("part.jpg").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FileError, match="truncated"):
        mesh_image("part.jpg")


def photo():
    y, x = np.mgrid[:1000, :1500]
    noise = np.random.default_rng(0).normal(0, 30, (1000, 1500))
    return np.clip(128 + 60 * np.sin(x / 200) + 50 * np.cos(y / 130) + noise, 0, 255).astype(np.uint8)


def mesh_photo(options):
    return len(mesh_image(photo(), **options).triangles)


@pytest.mark.slow
def test_a_noisy_photo_comes_back():
    cleaned, default = children.run("test_hostile_images:mesh_photo", [{"min_area": "200px2"}, {}], seconds=300)
    assert cleaned.kind == default.kind == "done"
    assert cleaned.seconds < 30
