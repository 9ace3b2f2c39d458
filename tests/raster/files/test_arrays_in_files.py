"""Arrays in files, .npy, .npz, .nrrd, .mha, HDF5 and zarr: value for value, one plane of volumes, clear words for what is missing."""

from __future__ import annotations

import bz2
import contextlib
import gzip
import io
import sys
import zlib

import numpy as np
import pytest

from img2tri import mesh_image
from img2tri.errors import FileError, ImageError, Img2triError, ParameterError
from img2tri.raster.reading import read

RNG = np.random.default_rng(3)
TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]
LABELS = np.zeros((12, 17), np.uint8)
LABELS[2:7, 3:9], LABELS[7:11, 3:15] = 1, 5
STACK = np.stack([LABELS, LABELS[::-1], LABELS * 2])


def some(dtype, shape=(12, 17)):
    return (RNG.random(shape) * 100).astype(dtype)


def same(found, expected):
    assert found.dtype == expected.dtype.newbyteorder("=")
    assert (found == expected).all()


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("dtype", TYPES)
def test_npy_value_for_value(dtype, order, tmp_path):
    values = some(dtype).astype(order + dtype)
    np.save(tmp_path / "a.npy", values)
    same(read(tmp_path / "a.npy").values, values)
    np.savez(tmp_path / "a.npz", one=values)
    same(read(tmp_path / "a.npz").values, values)
    np.savez_compressed(tmp_path / "b.npz", one=values, two=values * 0)
    same(read(f"{tmp_path / 'b.npz'}:/one").values, values)
    same(read(io.BytesIO((tmp_path / "a.npy").read_bytes())).values, values)


def test_npy_of_volumes_and_colours(tmp_path):
    for order in "CF":
        np.save(tmp_path / "a.npy", np.asarray(STACK, order=order))
        for page in range(3):
            picture = read(tmp_path / "a.npy", page=page)
            same(picture.values, STACK[page])
            assert (picture.notes["pages"], picture.notes["page"]) == (3, page)
    with pytest.raises(ParameterError, match="page: expected 0 to 2"):
        read(tmp_path / "a.npy", page=3)
    colours = some("u1", (12, 17, 3))
    np.save(tmp_path / "b.npy", colours)
    same(read(tmp_path / "b.npy").values, colours)
    np.save(tmp_path / "c.npy", LABELS[None, :, :, None])
    same(read(tmp_path / "c.npy").values, LABELS)
    assert mesh_image(tmp_path / "a.npy", labels=True, page=2).report.notes[0] == "page 2 of 3 was taken, counted from 0"


def test_npy_is_checked_before_room_is_made(tmp_path):
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6)})
    (tmp_path / "a.npy").write_bytes(head.getvalue())
    with pytest.raises(ImageError, match="max_pixels"):
        read(tmp_path / "a.npy")
    np.save(tmp_path / "b.npy", np.array([{"a": 1}, None], object), allow_pickle=True)
    with pytest.raises(ImageError, match="type object"):
        read(tmp_path / "b.npy")
    whole = io.BytesIO()
    np.save(whole, LABELS)
    for count in (7, 50, 128, 200):
        (tmp_path / "c.npy").write_bytes(whole.getvalue()[:count])
        with pytest.raises(FileError, match="damaged or truncated"):
            read(tmp_path / "c.npy")


def nrrd(values, *, encoding="raw", endian="little", more=""):
    names = {"u1": "uchar", "i1": "int8", "u2": "ushort", "i2": "short", "u4": "uint", "i4": "int", "u8": "uint64", "i8": "int64"}
    name = {"f4": "float", "f8": "double"}.get(values.dtype.str[1:]) or names[values.dtype.str[1:]]
    sizes = " ".join(map(str, values.shape[::-1]))
    head = (
        f"NRRD0005\n# a comment\ntype: {name}\ndimension: {values.ndim}\nsizes: {sizes}\nendian: {endian}\nencoding: {encoding}\n{more}\n"
    )
    raw = values.astype(values.dtype.newbyteorder("<" if endian == "little" else ">")).tobytes()
    pack = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}[encoding]
    return head.encode() + pack(raw)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize(("encoding", "endian"), [("raw", "little"), ("raw", "big"), ("gzip", "little"), ("bzip2", "big")])
def test_nrrd_value_for_value(dtype, encoding, endian, tmp_path):
    values = some(dtype, (3, 12, 17))
    path = tmp_path / "a.nrrd"
    path.write_bytes(nrrd(values, encoding=encoding, endian=endian))
    for page in range(3):
        same(read(path, page=page).values, values[page])


def test_pynrrd_and_this_read_the_same(tmp_path):
    pynrrd = pytest.importorskip("nrrd")
    header = {
        "space": "left-posterior-superior",
        "space directions": np.diag([0.5, 0.7, 2.0]),
        "space origin": [1, 2, 3],
        "encoding": "gzip",
    }
    pynrrd.write(str(tmp_path / "a.nrrd"), STACK, header, index_order="C")
    picture = read(tmp_path / "a.nrrd", page=1)
    same(picture.values, STACK[1])
    assert picture.frame.spacing == (0.5, 0.7)


def test_a_segmentation_of_3d_slicer(tmp_path):
    more = (
        "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,0.8,0) (0,0,3)\nspace origin: (1,2,3)\n"
        "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Name:=femur\nSegment1_LabelValue:=5\nSegment1_Name:=tibia, left\n"
        "Segment2_LabelValue:=9\nSegment2_Name:=not in this slice\n"
    )
    (tmp_path / "a.seg.nrrd").write_bytes(nrrd(STACK, more=more))
    mesh = mesh_image(tmp_path / "a.seg.nrrd", labels=True)
    assert mesh.names == {1: "femur", 5: "tibia, left"}
    assert mesh.frame.spacing == (0.5, 0.8)
    assert mesh.report.settings["units"] == "mm"
    assert mesh_image(tmp_path / "a.seg.nrrd", labels=True, names={1: "bone"}).names == {1: "bone"}
    assert mesh_image(tmp_path / "a.seg.nrrd", labels=True, spacing=1).frame.spacing == (1, 1)
    again = mesh_image(tmp_path / "a.seg.nrrd", **mesh.report.options)
    assert (again.vertices == mesh.vertices).all()
    assert again.names == mesh.names


def test_nrrd_with_its_values_beside_it_and_in_other_units(tmp_path):
    values = some("u2")
    (tmp_path / "a.raw").write_bytes(values.tobytes())
    head = nrrd(values, more='data file: a.raw\nspacings: 3 4\nspace units: "um" "um"\n')
    (tmp_path / "a.nhdr").write_bytes(head[: head.index(b"\n\n") + 2])
    picture = read(tmp_path / "a.nhdr", spacing="file")
    same(picture.values, values)
    assert picture.frame.spacing == (3, 4)
    assert picture.notes["units"] == "um"
    (tmp_path / "b.nhdr").write_bytes(head.replace(b"a.raw", b"../a.raw"))
    with pytest.raises(FileError, match="not one file beside it"):
        read(tmp_path / "b.nhdr")


def test_nrrd_of_colours(tmp_path):
    colours = some("u1", (12, 17, 3))
    (tmp_path / "a.nrrd").write_bytes(nrrd(colours, more="kinds: RGB-color domain domain\n"))
    same(read(tmp_path / "a.nrrd").values, colours)
    narrow = some("u1", (2, 12, 3))
    (tmp_path / "b.nrrd").write_bytes(nrrd(narrow))
    same(read(tmp_path / "b.nrrd", page=1).values, narrow[1])


def mha(values, *, compressed=False, big=False, spacing="0.5 0.7 2", channels=0):
    kinds = {"u1": "UCHAR", "i1": "CHAR", "u2": "USHORT", "i2": "SHORT", "u4": "UINT", "i4": "INT", "u8": "ULONG_LONG", "i8": "LONG_LONG"}
    kind = {"f4": "FLOAT", "f8": "DOUBLE"}.get(values.dtype.str[1:]) or kinds[values.dtype.str[1:]]
    sizes = values.shape[:-1] if channels else values.shape
    raw = values.astype(values.dtype.newbyteorder(">" if big else "<")).tobytes()
    head = (
        f"ObjectType = Image\nNDims = {len(sizes)}\nBinaryData = True\nBinaryDataByteOrderMSB = {big}\nCompressedData = {compressed}\n"
        f"TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = {spacing}\nDimSize = {' '.join(map(str, sizes[::-1]))}\n"
        + (f"ElementNumberOfChannels = {channels}\n" if channels else "")
        + f"ElementType = MET_{kind}\nElementDataFile = LOCAL\n"
    )
    return head.encode() + (zlib.compress(raw) if compressed else raw)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize(("compressed", "big"), [(False, False), (True, False), (False, True)])
def test_metaimage_value_for_value(dtype, compressed, big, tmp_path):
    values = some(dtype, (3, 12, 17))
    (tmp_path / "a.mha").write_bytes(mha(values, compressed=compressed, big=big))
    for page in range(3):
        picture = read(tmp_path / "a.mha", page=page)
        same(picture.values, values[page])
        assert picture.frame.spacing == (0.5, 0.7)


def test_metaimage_of_colours_and_beside_its_values(tmp_path):
    colours = some("u1", (12, 17, 3))
    (tmp_path / "a.mha").write_bytes(mha(colours, channels=3, spacing="1 1"))
    same(read(tmp_path / "a.mha").values, colours)
    head = mha(LABELS, spacing="1 2").partition(b"LOCAL")[0]
    (tmp_path / "b.mhd").write_bytes(head + b"b.raw\n")
    (tmp_path / "b.raw").write_bytes(LABELS.tobytes())
    same(read(tmp_path / "b.mhd").values, LABELS)


@pytest.mark.parametrize("name", ["a.nrrd", "a.mha"])
def test_damaged_volumes(name, tmp_path):
    good = (nrrd if name == "a.nrrd" else mha)(STACK, **({"encoding": "gzip"} if name == "a.nrrd" else {"compressed": True}))
    path = tmp_path / name
    for cut in range(10, len(good) - 24, 7):
        path.write_bytes(good[:cut])
        with pytest.raises(FileError):
            read(path, page=2)
    for at in range(0, len(good) - 1, 3):
        path.write_bytes(good[:at] + bytes([good[at] ^ 0x55]) + good[at + 1 :])
        with contextlib.suppress(Img2triError):
            read(path)


def test_a_small_file_does_not_fill_the_memory(tmp_path):
    bomb = gzip.compress(bytes(2**26))
    head = b"NRRD0005\ntype: uchar\ndimension: 2\nsizes: 100000 100000\nencoding: gzip\n\n"
    (tmp_path / "a.nrrd").write_bytes(head + bomb)
    with pytest.raises(ImageError, match="max_pixels"):
        read(tmp_path / "a.nrrd")
    with pytest.raises(FileError, match="fewer values"):
        read(_smaller(tmp_path, bomb))


def _smaller(folder, bomb):
    path = folder / "b.nrrd"
    path.write_bytes(b"NRRD0005\ntype: uchar\ndimension: 2\nsizes: 10000 10000\nencoding: gzip\n\n" + bomb)
    return path


@pytest.fixture
def h5(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["raw/labels"] = LABELS
        file["raw/stack"] = STACK[:, None]
        file["table"] = np.arange(5)
        file["words"] = np.array([[b"a", b"b"]])
    with h5py.File(tmp_path / "one.h5", "w") as file:
        file["m"] = LABELS
    return tmp_path


def test_hdf5(h5):
    same(read(h5 / "one.h5").values, LABELS)
    same(read(f"{h5 / 'a.h5'}:/raw/labels").values, LABELS)
    for page in range(3):
        same(read(f"{h5 / 'a.h5'}:/raw/stack", page=page).values, STACK[page])
    same(read(io.BytesIO((h5 / "one.h5").read_bytes())).values, LABELS)
    with pytest.raises(FileError, match="expected the name of an array.*it has /raw/labels, /raw/stack, /words"):
        read(h5 / "a.h5")
    with pytest.raises(FileError, match="expected the name of an array"):
        read(f"{h5 / 'a.h5'}:/nothing")
    with pytest.raises(ImageError, match="array of type"):
        read(f"{h5 / 'a.h5'}:/words")
    with pytest.raises(ImageError, match="max_pixels"):
        read(h5 / "one.h5", max_pixels=100)
    assert set(mesh_image(f"{h5 / 'a.h5'}:/raw/labels", labels=True).regions) == {1, 5}


@pytest.mark.filterwarnings("ignore::Warning:zarr")
@pytest.mark.parametrize("version", [2, 3])
def test_zarr(version, tmp_path):
    zarr = pytest.importorskip("zarr")
    zarr.save_array(str(tmp_path / "one.zarr"), LABELS, zarr_format=version)
    same(read(tmp_path / "one.zarr").values, LABELS)
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w", zarr_format=version)
    for name, values in (("labels", LABELS), ("stack", STACK)):
        group.create_array(name, shape=values.shape, dtype=values.dtype)[...] = values
    same(read(f"{tmp_path / 'a.zarr'}:/labels").values, LABELS)
    same(read(f"{tmp_path / 'a.zarr'}:/stack", page=2).values, STACK[2])
    with pytest.raises(FileError, match="/labels, /stack"):
        read(tmp_path / "a.zarr")


@pytest.mark.parametrize(("library", "extra", "content"), [("h5py", "hdf5", b"\x89HDF\r\n\x1a\n" + bytes(99))])
def test_a_missing_library_is_named(library, extra, content, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    (tmp_path / "a.bin").write_bytes(content)
    with pytest.raises(FileError, match=rf"{library} reads; install it with  pip install 'img2tri\[{extra}\]'"):
        read(tmp_path / "a.bin")


def test_zarr_missing_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "zarr", None)
    (tmp_path / "zarr.json").write_text("{}")
    with pytest.raises(FileError, match=r"zarr reads; install it with  pip install 'img2tri\[zarr\]'"):
        read(tmp_path)


def test_what_no_library_here_reads_says_so(tmp_path):
    (tmp_path / "a.nc").write_bytes(b"CDF\x01" + bytes(99))
    with pytest.raises(FileError, match="netCDF 3; open it with xarray"):
        read(tmp_path / "a.nc")


def test_tiff_compressed_by_lerc_is_not_called_damaged(tmp_path):
    import tifffile

    tifffile.imwrite(tmp_path / "a.tif", LABELS, metadata=None)
    data = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        entry = file.pages[0].tags[259].valueoffset
    data[entry : entry + 2] = (34887).to_bytes(2, "little")
    (tmp_path / "a.tif").write_bytes(data)
    if "imagecodecs" in sys.modules:
        pytest.skip("imagecodecs is there")
    with pytest.raises(FileError, match=r"compressed by LERC, which imagecodecs reads; install it with  pip install 'img2tri\[codecs\]'"):
        read(tmp_path / "a.tif")


def test_names_of_arrays_are_parted_from_names_of_files(tmp_path):
    np.savez(tmp_path / "a.npz", one=LABELS, two=LABELS * 3)
    same(read(f"{tmp_path / 'a.npz'}:/two").values, LABELS * 3)
    with pytest.raises(FileError, match="it has one, two"):
        read(tmp_path / "a.npz")
    with pytest.raises(FileError, match="no file"):
        read(f"{tmp_path / 'a.png'}:/two")
