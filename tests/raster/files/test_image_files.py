"""Every kind of file comes back value for value, or is refused; never a part of an image."""

from __future__ import annotations

import contextlib
import io
import struct
import sys
import tracemalloc
import zlib

import cv2
import numpy as np
import pytest
import tifffile
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from img2tri.errors import FileError, ImageError, Img2triError, ParameterError
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.reading import read

RNG = np.random.default_rng(1)
GRAY8 = RNG.integers(0, 256, (13, 17), np.uint8)
GRAY16 = RNG.integers(0, 65536, (13, 17), np.uint16)
RGB8 = RNG.integers(0, 256, (13, 17, 3), np.uint8)
RGBA8 = RNG.integers(0, 256, (13, 17, 4), np.uint8)
RGBA16 = RNG.integers(0, 65536, (13, 17, 4), np.uint16)
WAVES = np.rint(120 + 100 * np.sin(np.indices((64, 80)).sum(axis=0) / 9)).astype(np.uint8)  # what JPEG is made for


def same(found, expected):
    assert found.dtype == expected.dtype
    assert found.shape == expected.shape
    assert (found == expected).all()


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(rows, width, height, depth, colour, *extra, level=9):
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))
    data = zlib.compress(b"".join(b"\0" + row for row in rows), level)
    return b"\x89PNG\r\n\x1a\n" + head + b"".join(extra) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def png16(values, colour, *extra):
    return png([row.astype(">u2").tobytes() for row in values], values.shape[1], values.shape[0], 16, colour, *extra)


@pytest.mark.parametrize("values", [GRAY8 > 99, GRAY8, GRAY16, RGB8, RGBA8], ids=["bool", "uint8", "uint16", "RGB", "RGBA"])
@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_what_pillow_wrote_comes_back(values, suffix, tmp_path):
    path = tmp_path / f"image.{suffix}"
    Image.fromarray(values).save(path)
    same(read(path).values, values)


@pytest.mark.parametrize(
    ("suffix", "values"),
    [("bmp", GRAY8), ("bmp", RGB8), ("pgm", GRAY8), ("pgm", GRAY16), ("ppm", RGB8), ("jp2", GRAY16), ("jp2", RGB8), ("webp", RGB8)],
)
def test_other_formats_come_back(suffix, values, tmp_path):
    Image.fromarray(values).save(tmp_path / f"image.{suffix}", **({"lossless": True} if suffix == "webp" else {}))
    same(read(tmp_path / f"image.{suffix}").values, values)


def test_gif_has_a_palette(tmp_path):
    Image.fromarray(GRAY8).save(tmp_path / "image.gif")
    picture = read(tmp_path / "image.gif")
    same(to_gray(picture.values, palette=picture.notes["palette"]), GRAY8)


@pytest.mark.parametrize("compression", [None, "zlib"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"])
def test_tiff_keeps_every_type(dtype, order, compression, tmp_path):
    if dtype.startswith("float"):
        values = RNG.normal(size=(13, 17)).astype(dtype)
    else:
        bounds = np.iinfo(dtype)
        values = RNG.integers(bounds.min, bounds.max, (13, 17), dtype, endpoint=True)
    tifffile.imwrite(tmp_path / "image.tif", values, byteorder=order, compression=compression)
    same(read(tmp_path / "image.tif").values, values)


def test_tiff_half_floats_become_floats(tmp_path):
    values = RNG.normal(size=(13, 17)).astype(np.float16)
    tifffile.imwrite(tmp_path / "image.tif", values)
    same(read(tmp_path / "image.tif").values, values.astype(np.float32))


@pytest.mark.parametrize("bigtiff", [False, True])
@pytest.mark.parametrize("planar", ["contig", "separate"])
def test_tiff_colours_of_16_bit(planar, bigtiff, tmp_path):
    values = RGBA16[..., :3] if planar == "contig" else np.moveaxis(RGBA16[..., :3], 2, 0)
    tifffile.imwrite(tmp_path / "image.tif", values, photometric="rgb", planarconfig=planar, bigtiff=bigtiff)
    same(read(tmp_path / "image.tif").values, RGBA16[..., :3])


def test_tiff_gray_with_alpha_of_16_bit(tmp_path):
    values = RGBA16[..., :2]
    tifffile.imwrite(tmp_path / "image.tif", values, photometric="minisblack", planarconfig="contig", extrasamples=["unassalpha"])
    same(read(tmp_path / "image.tif").values, values[..., [0, 0, 0, 1]])


def test_tiff_of_complex_numbers_is_refused(tmp_path):
    tifffile.imwrite(tmp_path / "image.tif", RNG.normal(size=(13, 17)).astype(np.complex64))
    with pytest.raises(ImageError, match="integer or floating point values, found an array of type complex64"):
        read(tmp_path / "image.tif")


def test_tiff_volume_is_refused(tmp_path):
    tifffile.imwrite(tmp_path / "image.tif", np.zeros((16, 16, 16), np.float64), volumetric=True, tile=(16, 16, 16))
    with pytest.raises(ImageError, match=r"expected shape \(h, w\).*pick one image of a stack"):
        read(tmp_path / "image.tif")


def test_tiff_without_tifffile_says_how_to_install_it(tmp_path, monkeypatch):
    tifffile.imwrite(tmp_path / "image.tif", GRAY16.astype(np.int64))
    monkeypatch.setitem(sys.modules, "tifffile", None)
    with pytest.raises(FileError, match=r"pip install 'img2tri\[tiff\]'"):
        read(tmp_path / "image.tif")


def test_tiff_without_tifffile_needs_it_only_for_odd_types(tmp_path, monkeypatch):
    tifffile.imwrite(tmp_path / "image.tif", GRAY16)
    monkeypatch.setitem(sys.modules, "tifffile", None)
    same(read(tmp_path / "image.tif").values, GRAY16)


@pytest.mark.parametrize("dtype", [np.uint8, np.int64])
def test_pages(dtype, tmp_path):
    pages = RNG.integers(0, 100, (5, 13, 17)).astype(dtype)
    tifffile.imwrite(tmp_path / "stack.tif", pages)
    picture = read(tmp_path / "stack.tif")
    same(picture.values, pages[0])
    assert (picture.notes["page"], picture.notes["pages"]) == (0, 5)
    same(read(tmp_path / "stack.tif", page=3).values, pages[3])
    with pytest.raises(ParameterError, match=r"page: expected 0 to 4 in '.*stack.tif', found 5"):
        read(tmp_path / "stack.tif", page=5)


def test_pages_of_different_types(tmp_path):
    with tifffile.TiffWriter(tmp_path / "mixed.tif") as file:
        file.write(GRAY8)
        file.write(GRAY16.astype(np.float64))
    same(read(tmp_path / "mixed.tif").values, GRAY8)
    same(read(tmp_path / "mixed.tif", page=1).values, GRAY16.astype(np.float64))


def test_frames_of_a_gif(tmp_path):
    frames = [Image.fromarray(mask.astype(np.uint8) * 255) for mask in (RGB8 > 60)[..., :2].transpose(2, 0, 1)]
    frames[0].save(tmp_path / "image.gif", save_all=True, append_images=frames[1:])
    assert read(tmp_path / "image.gif").notes["pages"] == 2
    second = read(tmp_path / "image.gif", page=1).values
    assert (second.reshape(13, 17, -1)[..., 0] == np.asarray(frames[1])).all()


def test_a_single_image_has_page_0_only(tmp_path):
    Image.fromarray(GRAY8).save(tmp_path / "image.png")
    assert "page" not in read(tmp_path / "image.png").notes
    with pytest.raises(ParameterError, match="page: expected 0 to 0"):
        read(tmp_path / "image.png", page=1)


@pytest.mark.parametrize(("colour", "channels"), [(2, [0, 1, 2]), (6, [0, 1, 2, 3]), (4, [0, 3])])
def test_png_colours_of_16_bit(colour, channels, tmp_path):
    values = RGBA16[..., channels]
    (tmp_path / "image.png").write_bytes(png16(values, colour))
    same(read(tmp_path / "image.png").values, RGBA16 if colour == 6 else values if colour == 2 else values[..., [0, 0, 0, 1]])


def test_png_colours_of_16_bit_as_opencv_writes_them(tmp_path):
    cv2.imwrite(str(tmp_path / "image.png"), RGBA16[..., [2, 1, 0]])
    same(read(tmp_path / "image.png").values, RGBA16[..., :3])


@pytest.mark.parametrize("depth", [1, 2, 4, 8])
def test_png_palette_indices_are_kept(depth, tmp_path):
    most = 1 << depth
    values = RNG.integers(0, most, (6, 16), np.uint8)
    packed = np.packbits(np.unpackbits(values[..., None], axis=2)[..., 8 - depth :].reshape(6, -1), axis=1)
    colours = RNG.integers(0, 256, (most, 3), np.uint8)
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in packed], 16, 6, depth, 3, chunk(b"PLTE", colours.tobytes())))
    picture = read(tmp_path / "image.png")
    same(picture.values, values)
    palette = picture.notes["palette"]
    assert palette.shape == (256, 3)
    assert (palette[:most] == colours).all()
    assert not palette[most:].any()


def test_png_palette_with_alpha(tmp_path):
    colours = RNG.integers(0, 256, (4, 3), np.uint8)
    values = RNG.integers(0, 4, (6, 16), np.uint8)
    extra = chunk(b"PLTE", colours.tobytes()), chunk(b"tRNS", bytes([0, 128]))
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in values], 16, 6, 8, 3, *extra))
    palette = read(tmp_path / "image.png").notes["palette"]
    assert (palette[:4, :3] == colours).all()
    assert palette[:, 3].tolist() == [0, 128] + [255] * 254


def test_palette_tiff(tmp_path):
    img = Image.fromarray(GRAY8 % 7)
    img.putpalette(RGB8.reshape(-1)[:768].tolist() + [0] * (768 - RGB8.size if RGB8.size < 768 else 0))
    img.save(tmp_path / "image.tif")
    picture = read(tmp_path / "image.tif")
    same(picture.values, GRAY8 % 7)
    assert (picture.notes["palette"][:7] == RGB8.reshape(-1, 3)[:7]).all()


def test_palette_tiff_of_16_bit(tmp_path):
    colormap = RNG.integers(0, 65536, (3, 65536), np.uint16)
    tifffile.imwrite(tmp_path / "image.tif", GRAY16, photometric="palette", colormap=colormap)
    picture = read(tmp_path / "image.tif")
    same(picture.values, GRAY16)
    assert (picture.notes["palette"] == colormap.T >> 8).all()


@pytest.mark.parametrize("depth", [2, 4])
def test_png_gray_of_few_bits_is_scaled_to_8(depth, tmp_path):
    most = (1 << depth) - 1
    values = RNG.integers(0, most + 1, (6, 16), np.uint8)
    packed = np.packbits(np.unpackbits(values[..., None], axis=2)[..., 8 - depth :].reshape(6, -1), axis=1)
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in packed], 16, 6, depth, 0))
    same(read(tmp_path / "image.png").values, values * np.uint8(255 // most))


def test_one_gray_value_stands_for_transparent(tmp_path):
    values = RNG.integers(0, 4, (6, 16), np.uint8)
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in values], 16, 6, 8, 0, chunk(b"tRNS", b"\0\2")))
    found = read(tmp_path / "image.png").values
    same(found, np.dstack([values, values, values, np.where(values == 2, 0, 255).astype(np.uint8)]))


def test_one_colour_stands_for_transparent(tmp_path):
    values = RNG.integers(0, 2, (6, 16, 3), np.uint8)
    key = chunk(b"tRNS", np.array([1, 0, 1], ">u2").tobytes())
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in values], 16, 6, 8, 2, key))
    clear = (values == (1, 0, 1)).all(axis=2)
    same(read(tmp_path / "image.png").values, np.dstack([values, np.where(clear, 0, 255).astype(np.uint8)]))


def test_one_gray_value_of_16_bit_stands_for_transparent(tmp_path):
    values = GRAY16 % 5
    (tmp_path / "image.png").write_bytes(png16(values, 0, chunk(b"tRNS", b"\0\3")))
    same(read(tmp_path / "image.png").values, np.dstack([values, values, values, np.where(values == 3, 0, 65535).astype(np.uint16)]))


def test_one_colour_of_16_bit_stands_for_transparent(tmp_path):
    values = RGBA16[..., :3]
    (tmp_path / "image.png").write_bytes(png16(values, 2, chunk(b"tRNS", values[3, 4].astype(">u2").tobytes())))
    clear = (values == values[3, 4]).all(axis=2)
    same(read(tmp_path / "image.png").values, np.dstack([values, np.where(clear, 0, 65535).astype(np.uint16)]))


def test_gray_with_alpha(tmp_path):
    Image.fromarray(RGBA8[..., :2]).save(tmp_path / "image.png")
    same(read(tmp_path / "image.png").values, RGBA8[..., [0, 0, 0, 1]])


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("channels", [1, 3])
def test_colours_multiplied_by_alpha_are_divided_by_it(channels, dtype, tmp_path):
    full = 1 if dtype is np.float32 else np.iinfo(dtype).max
    step = 1e-6 if dtype is np.float32 else 1
    colours = RNG.integers(0, 256, (13, 17, channels)) / 255
    alpha = RNG.integers(100, 256, (13, 17, 1)) / 255
    alpha[0], alpha[1] = 0, 1
    values = np.dstack([colours * alpha, alpha]) * full
    values = values.astype(dtype) if dtype is np.float32 else np.rint(values).astype(dtype)
    kind = "rgb" if channels == 3 else "minisblack"
    tifffile.imwrite(tmp_path / "image.tif", values, photometric=kind, planarconfig="contig", extrasamples=["assocalpha"])
    found = read(tmp_path / "image.tif").values
    assert found.dtype == dtype
    assert (found[..., 3] == values[..., -1]).all()
    assert abs(found[1:, :, :3] / full - colours[1:]).max() <= 2.6 * step / full
    assert not found[0, :, :3].any()


@pytest.mark.parametrize("mode", ["L", "RGB", "CMYK"])
def test_jpeg(mode, tmp_path):
    Image.fromarray(WAVES).convert(mode).save(tmp_path / "image.jpg", quality=95)
    found = read(tmp_path / "image.jpg").values
    assert found.shape == (WAVES.shape if mode == "L" else (*WAVES.shape, 3))
    assert abs(found.reshape(64, 80, -1).mean(axis=2) - WAVES).max() < 6


def test_a_colour_space_without_colours_is_refused(tmp_path):
    Image.new("LAB", (5, 5)).save(tmp_path / "image.tif")
    with pytest.raises(ImageError, match="found the colour space LAB"):
        read(tmp_path / "image.tif")


def test_a_drawing_is_refused(tmp_path):
    Image.fromarray(RGB8).save(tmp_path / "image.eps")
    with pytest.raises(FileError, match=r"is a drawing \(EPS\), not pixels"):
        read(tmp_path / "image.eps")


TURNED = {  # how EXIF says the first row and the first column of the file are to be seen
    1: lambda a: a,
    2: np.fliplr,
    3: lambda a: np.rot90(a, 2),
    4: np.flipud,
    5: lambda a: np.fliplr(np.rot90(a, -1)),
    6: lambda a: np.rot90(a, -1),
    7: lambda a: np.fliplr(np.rot90(a, 1)),
    8: lambda a: np.rot90(a, 1),
}


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["png", "jpg", "tif", "float.tif", "16.png"])
def test_orientation(kind, orientation, tmp_path):
    path = tmp_path / f"image.{kind}"
    values = {"float.tif": WAVES.astype(np.float64), "16.png": RGBA16[..., :3]}.get(kind, WAVES)
    exif = Image.Exif()
    exif[274] = orientation
    exif[282], exif[283], exif[296] = 100.0, 50.0, 3
    if kind == "float.tif":
        tags = [(274, "H", 1, orientation, True)]
        tifffile.imwrite(path, values, extratags=tags, resolution=(100, 50), resolutionunit="CENTIMETER")
    elif kind == "16.png":
        size = chunk(b"pHYs", struct.pack(">IIB", 10000, 5000, 1))
        path.write_bytes(png16(values, 2, size, chunk(b"eXIf", exif.tobytes()[6:])))
    elif kind == "tif":
        Image.fromarray(values).save(path, tiffinfo={274: orientation, 282: 100.0, 283: 50.0, 296: 3})
    else:
        Image.fromarray(values).save(path, exif=exif, dpi=(254, 127))
    picture = read(path, spacing="file")
    stored = np.asarray(Image.open(path)) if kind == "jpg" else values
    same(picture.values, TURNED[orientation](stored))
    assert picture.notes.get("orientation", 1) == orientation
    assert picture.frame.shape == picture.values.shape[:2]
    assert picture.frame.spacing == pytest.approx((0.1, 0.2) if orientation < 5 else (0.2, 0.1), rel=1e-3)


@pytest.mark.parametrize("orientation", [0, 9, 400])
def test_a_senseless_orientation_is_ignored(orientation, tmp_path):
    exif = Image.Exif()
    exif[274] = orientation
    Image.fromarray(GRAY8).save(tmp_path / "image.png", exif=exif)
    same(read(tmp_path / "image.png").values, GRAY8)


def test_broken_exif_is_ignored(tmp_path):
    (tmp_path / "image.png").write_bytes(png([r.tobytes() for r in GRAY8], 17, 13, 8, 0, chunk(b"eXIf", b"not EXIF at all")))
    same(read(tmp_path / "image.png").values, GRAY8)


def whole_files():
    def saved(**options):
        file = io.BytesIO()
        Image.fromarray(WAVES).save(file, **options)
        return file.getvalue()

    def tiff(values, **options):
        file = io.BytesIO()
        tifffile.imwrite(file, values, **options)
        return file.getvalue()

    return {
        "jpg": saved(format="JPEG"),
        "progressive.jpg": saved(format="JPEG", progressive=True),
        "png": saved(format="PNG"),
        "16.png": png16(RGBA16[..., :3], 2),
        "gif": saved(format="GIF"),
        "bmp": saved(format="BMP"),
        "webp": saved(format="WEBP"),
        "tif": saved(format="TIFF"),
        "lzw.tif": saved(format="TIFF", compression="tiff_lzw"),
        "float.tif": tiff(WAVES.astype(np.float64)),
        "zlib.tif": tiff(WAVES.astype(np.int64), compression="zlib"),
    }


@pytest.mark.parametrize("kind", whole_files())
def test_a_truncated_file_never_gives_part_of_an_image(kind, tmp_path):
    whole = whole_files()[kind]
    path = tmp_path / f"image.{kind}"
    path.write_bytes(whole)
    values = read(path).values
    for part in np.linspace(0, 1, 41)[:-1]:
        path.write_bytes(whole[: int(part * len(whole))])
        if part <= 0.9 or kind in ("jpg", "progressive.jpg"):
            with pytest.raises(FileError, match=r"image: .*(damaged or truncated|not an image|is empty)"):
                read(path)
        else:
            with contextlib.suppress(FileError):  # only what follows the pixels may be missing
                same(read(path).values, values)


@pytest.mark.parametrize("kind", ["png", "jpg", "tif", "float.tif", "gif"])
def test_damaged_files_give_no_other_error(kind, tmp_path):
    whole = whole_files()[kind]
    path = tmp_path / "damaged"

    @settings(max_examples=60, deadline=None, derandomize=True)
    @given(st.lists(st.tuples(st.integers(0, len(whole) - 1), st.integers(0, 255)), min_size=1, max_size=6))
    def check(changes):
        data = bytearray(whole)
        for place, value in changes:
            data[place] = value
        path.write_bytes(data)
        with contextlib.suppress(Img2triError):
            assert read(path).values.size

    check()


def test_errors_of_paths(tmp_path):
    with pytest.raises(FileError, match=r"there is no file 'nowhere\.png'"):
        read("nowhere.png")
    with pytest.raises(FileError, match="expected a file, found the folder"):
        read(tmp_path)
    (tmp_path / "text.png").write_text("this is no image, whatever its name says")
    with pytest.raises(FileError, match=r"text.png' is not an image in a known format"):
        read(tmp_path / "text.png")
    (tmp_path / "empty.png").touch()
    with pytest.raises(FileError, match=r"empty.png' is empty"):
        read(tmp_path / "empty.png")
    with pytest.raises(FileError, match="cannot be opened"):
        read("null\0byte.png")
    with pytest.raises(OSError, match="there is no file"):
        read("nowhere.png")


@pytest.mark.parametrize("bitmap", [False, True])
def test_a_bomb_in_an_icon_is_refused_before_it_is_decoded(tmp_path, bitmap):
    inside = png([b"\0"], 50_000, 50_000, 8, 0)
    if bitmap:
        inside = struct.pack("<IiiHHIIiiII", 40, 50_000, -100_000, 1, 32, 0, 0, 0, 0, 0, 0)
    small = png([b"\0\1\2"] * 2, 2, 2, 8, 0)
    entries = [struct.pack("<BBBBHHII", 2, 2, 0, 0, 1, 8, len(data), place) for data, place in ((small, 38), (inside, 38 + len(small)))]
    (tmp_path / "bomb.ico").write_bytes(struct.pack("<HHH", 0, 1, 2) + b"".join(entries) + small + inside)
    tracemalloc.start()
    with pytest.raises(ImageError, match=r"expected at most max_pixels=268435456 pixels, found 50000 x (50000|100000) in"):
        read(tmp_path / "bomb.ico")
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()


def test_icons_are_read(tmp_path):
    Image.fromarray(np.arange(256, dtype=np.uint8).reshape(16, 16)).save(tmp_path / "small.ico", sizes=[(16, 16)])
    assert read(tmp_path / "small.ico").values.shape[:2] == (16, 16)
    (tmp_path / "cut.ico").write_bytes((tmp_path / "small.ico").read_bytes()[:20])
    with pytest.raises(FileError):
        read(tmp_path / "cut.ico")


def test_a_bomb_is_refused_before_it_is_decoded(tmp_path):
    (tmp_path / "bomb.png").write_bytes(png([b"\0"], 50_000, 50_000, 8, 0))
    limit = Image.MAX_IMAGE_PIXELS
    with pytest.raises(ImageError, match=r"max_pixels=268435456 pixels, found 50000 x 50000 in '.*'; raise max_pixels"):
        read(tmp_path / "bomb.png")
    assert limit == Image.MAX_IMAGE_PIXELS


@pytest.mark.parametrize("dtype", [np.uint8, np.float64])
def test_max_pixels(dtype, tmp_path):
    tifffile.imwrite(tmp_path / "image.tif", GRAY8.astype(dtype))
    assert read(tmp_path / "image.tif", max_pixels=13 * 17).values.shape == (13, 17)
    with pytest.raises(ImageError, match="max_pixels=220 "):
        read(tmp_path / "image.tif", max_pixels=13 * 17 - 1)
    with pytest.raises(ParameterError, match="max_pixels: expected a whole number of at least 1, found 0"):
        read(tmp_path / "image.tif", max_pixels=0)


def test_the_limit_of_pillow_is_set_aside_and_kept(tmp_path, monkeypatch):
    Image.fromarray(GRAY8).save(tmp_path / "image.png")
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 4)
    same(read(tmp_path / "image.png").values, GRAY8)
    assert Image.MAX_IMAGE_PIXELS == 4


def test_tiff_of_many_bands_is_refused(tmp_path):
    tifffile.imwrite(tmp_path / "image.tif", np.zeros((13, 17, 5), np.float64), photometric="minisblack", planarconfig="contig")
    with pytest.raises(ImageError, match=r"expected at most 4 values per pixel, found 5 in '.*image\.tif'"):
        read(tmp_path / "image.tif")


def test_an_icon_larger_than_it_claims_is_refused(tmp_path):
    large = png([b"\0"], 20_000, 20_000, 8, 0)
    part = b"ic07" + struct.pack(">I", 8 + len(large)) + large  # which claims 128 x 128
    (tmp_path / "image.icns").write_bytes(b"icns" + struct.pack(">I", 8 + len(part)) + part)
    with pytest.raises(ImageError, match=r"expected at most max_pixels=20000 pixels, found more in '.*image\.icns'"):
        read(tmp_path / "image.icns", max_pixels=20_000)


def test_a_file_that_asks_for_more_memory_than_there_is(tmp_path, monkeypatch):
    def full(_img):
        raise MemoryError

    Image.fromarray(GRAY8).save(tmp_path / "image.png")
    monkeypatch.setattr("PIL.ImageFile.ImageFile.load", full)
    with pytest.raises(FileError, match=r"image\.png' is damaged, or needs more memory than there is"):
        read(tmp_path / "image.png")
