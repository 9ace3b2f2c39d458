"""Files that are open already: the same values as by their path, and bounds on what is read."""

from __future__ import annotations

import gzip
import io
import itertools
import os
import threading
import zipfile

import numpy as np
import pytest
import tifffile
from PIL import Image

from img2tri import mesh_image
from img2tri.errors import FileError, ImageError, ParameterError
from img2tri.raster.files.byte_sources import Source, source_of
from img2tri.raster.reading import read

GRAY = np.arange(24 * 30, dtype=np.uint8).reshape(24, 30)
DISC = (np.hypot(*np.mgrid[-20:20, -20:20]) < 15).astype(np.uint8) * 255


def png(values=GRAY):
    file = io.BytesIO()
    Image.fromarray(values).save(file, "PNG")
    return file.getvalue()


def deep_png(path):
    import cv2

    cv2.imwrite(str(path), np.dstack([GRAY, GRAY[::-1], GRAY[:, ::-1]]).astype(np.uint16) * 200)


def nifti(path):
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(np.arange(30 * 24 * 3, dtype=np.int16).reshape(30, 24, 3), np.diag([0.5, 0.7, 1, 1]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)


def dicom(path):
    pydicom = pytest.importorskip("pydicom")
    pytest.importorskip("pydicom.pixels")
    data = pydicom.Dataset()
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = pydicom.uid.SecondaryCaptureImageStorage
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID = "1.2.3.4"
    data.Rows, data.Columns = GRAY.shape
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 8, 8, 7, 0
    data.PixelSpacing = [0.5, 0.7]
    data.PixelData = GRAY.tobytes()
    data.save_as(path, enforce_file_format=True)


WRITE = {
    "gray.png": lambda path: Image.fromarray(GRAY).save(path, dpi=(254, 254)),
    "palette.png": lambda path: Image.fromarray(GRAY).quantize(7).save(path),
    "deep.png": deep_png,
    "a.jpg": lambda path: Image.fromarray(GRAY).save(path),
    "a.gif": lambda path: Image.fromarray(GRAY).save(path),
    "a.webp": lambda path: Image.fromarray(GRAY).convert("RGB").save(path),
    "a.tif": lambda path: Image.fromarray(GRAY).save(path, compression="tiff_lzw"),
    "pages.tif": lambda path: Image.fromarray(GRAY).save(path, save_all=True, append_images=[Image.fromarray(GRAY[::-1])]),
    "double.tif": lambda path: tifffile.imwrite(path, GRAY / 7, compression="zlib"),
    "deep.tif": lambda path: tifffile.imwrite(path, np.dstack([GRAY] * 3).astype(np.uint16) * 99, photometric="rgb"),
    "a.dcm": dicom,
    "a.nii": nifti,
    "a.nii.gz": nifti,
}


@pytest.mark.parametrize("name", WRITE)
@pytest.mark.parametrize("nameless", [False, True])
def test_an_open_file_is_read_as_by_its_path(name, nameless, tmp_path):
    path = tmp_path / name
    WRITE[name](path)
    page = 1 if "pages" in name or "nii" in name else 0
    spacing = "file" if name in ("gray.png", "a.dcm", "a.nii", "a.nii.gz") else None
    expected = read(path, page=page, spacing=spacing)
    if nameless:  # the format is found by its content
        found = read(io.BytesIO(path.read_bytes()), page=page, spacing=spacing)
        assert found.source == "<file>"
    else:
        with path.open("rb") as file:
            found = read(file, page=page, spacing=spacing)
            assert not file.closed
        assert found.source == str(path)
    assert found.values.dtype == expected.values.dtype
    assert (found.values == expected.values).all()
    assert found.frame == expected.frame
    assert str(found.notes) == str(expected.notes)


def test_a_pipe():
    ends = os.pipe()
    with os.fdopen(ends[0], "rb", buffering=0) as file, os.fdopen(ends[1], "wb") as other:
        writer = threading.Thread(target=lambda: [other.write(png(np.tile(GRAY, (40, 40)))), other.close()])
        writer.start()
        values = read(file).values
        writer.join()
    assert (values == np.tile(GRAY, (40, 40))).all()


def test_a_member_of_an_archive_from_where_a_file_stands(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("scans/a.png", png())
        with archive.open("scans/b.png", "w") as file:
            file.write(png(GRAY[::-1]))
    with zipfile.ZipFile(tmp_path / "a.zip") as archive, archive.open("scans/b.png") as file:
        picture = read(file)
    assert (picture.values == GRAY[::-1]).all()
    assert picture.source == "scans/b.png"
    file = io.BytesIO(b"before" + png())
    file.seek(6)
    assert (read(file).values == GRAY).all()
    with pytest.raises(FileError, match="'<file>' is empty"):
        read(file)


def test_an_open_file_makes_the_same_mesh(tmp_path):
    Image.fromarray(DISC).save(tmp_path / "disc.png")
    with (tmp_path / "disc.png").open("rb") as file:
        mesh = mesh_image(file, edge_length=5)
    expected = mesh_image(tmp_path / "disc.png", edge_length=5)
    assert mesh.vertices.tobytes() == expected.vertices.tobytes()
    assert mesh.origin.settings == expected.origin.settings


class Endless:
    """Gives zeros for ever, and counts them."""

    given = 0

    def read(self, size):
        self.given += size
        return bytes(size)


@pytest.mark.parametrize("max_pixels", [1, 2**20])
def test_no_more_is_read_than_an_image_may_need(max_pixels):
    file = Endless()
    with pytest.raises(ImageError, match=rf"at most {8 * max_pixels + 2**20} bytes, 8 for each of max_pixels={max_pixels}, found more"):
        read(file, max_pixels=max_pixels)
    assert file.given <= 8 * max_pixels + 2 * 2**20


def test_max_pixels_holds_for_open_files():
    assert read(io.BytesIO(png()), max_pixels=720).values.shape == GRAY.shape
    with pytest.raises(ImageError, match=r"at most max_pixels=719 pixels, found 30 x 24 in '<file>'"):
        read(io.BytesIO(png()), max_pixels=719)
    with pytest.raises(ParameterError, match="max_pixels: expected a whole number of at least 1"):
        source_of(io.BytesIO(png()), max_pixels=0)


class Odd:
    def __init__(self, *answers):
        self.answers = itertools.chain(answers)

    def read(self, _):
        answer = next(self.answers, b"")
        if isinstance(answer, Exception):
            raise answer
        return answer


@pytest.mark.parametrize(
    ("file", "kind", "message"),
    [
        (io.StringIO("P2 1 1 1 0"), ParameterError, "opened in binary mode, as by open"),
        (Odd("text"), ParameterError, "found a Odd that gives str"),
        (Odd(np.zeros(3)), ParameterError, "found a Odd that gives ndarray"),
        (Odd(), FileError, "'<file>' is empty"),
        (Odd(None), FileError, "'<file>' is empty"),
        (Odd(b"no image"), FileError, "'<file>' is not an image in a known format"),
        (Odd(png()[:-30]), FileError, "'<file>' is damaged or truncated"),
        (Odd(gzip.compress(b"no image")), FileError, "'<file>' is not an image in a known format"),
        (Odd(b"\x1f\x8b is not gzip"), FileError, "'<file>' is not an image in a known format"),
        (Odd(OSError(5, "Input/output error")), FileError, "'<file>' cannot be read .*Input/output error"),
        (Odd(b"P5", zipfile.BadZipFile("Bad CRC-32")), FileError, "cannot be read .*Bad CRC-32"),
    ],
)
def test_what_is_no_binary_file_is_refused(file, kind, message):
    with pytest.raises(kind, match=message):
        read(file)


def test_a_closed_file_is_refused(tmp_path):
    with (tmp_path / "a.png").open("wb") as file:
        file.write(png())
    with pytest.raises(FileError, match="cannot be read"):
        read(file)


def test_a_source_is_taken_as_it_is():
    held = source_of(io.BytesIO(png()))
    assert source_of(held) is held
    assert (read(held).values == read(held).values).all()
    assert source_of("a.png") == Source("a.png", source_of("a.png").path)
