"""DICOM and NIfTI: values as measured, sizes on the right axes, frames and slices where they belong."""

from __future__ import annotations

import contextlib
import gzip
import io
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from img2tri.errors import FileError, ImageError, Img2triError, ParameterError
from img2tri.many.image_sources import each_image
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.otsu_threshold import binarize
from img2tri.raster.labels.rgb_to_labels import label_map
from img2tri.raster.reading import read

RNG = np.random.default_rng(7)
FRAMES = RNG.integers(0, 4000, (4, 6, 9), np.uint16)
VOLUME = RNG.integers(-1000, 1000, (6, 9, 4)).astype(np.int16)


@pytest.fixture
def pydicom():
    pytest.importorskip("pydicom.pixels")
    return pytest.importorskip("pydicom")


@pytest.fixture
def nibabel():
    return pytest.importorskip("nibabel")


def same(found, expected):
    assert found.dtype == expected.dtype
    assert found.shape == expected.shape
    assert (found == expected).all()


def dicom(path, values, photometric="MONOCHROME2", **tags):
    """Write a DICOM file of one frame or more."""
    import pydicom

    data = pydicom.Dataset()
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID = pydicom.uid.SecondaryCaptureImageStorage
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID = "1.2.3.4"
    colours = photometric == "RGB"
    frames = values.ndim - colours == 3
    data.Rows, data.Columns = values.shape[frames : frames + 2]
    data.SamplesPerPixel = 3 if colours else 1
    data.PhotometricInterpretation = photometric
    data.BitsAllocated = data.BitsStored = 8 * values.dtype.itemsize
    data.HighBit = data.BitsStored - 1
    data.PixelRepresentation = int(values.dtype.kind == "i")
    if colours:
        data.PlanarConfiguration = 0
    if frames:
        data.NumberOfFrames = len(values)
    data.PixelData = values.astype(values.dtype.newbyteorder("<")).tobytes()
    for name, value in tags.items():
        setattr(data, name, value)
    data.save_as(path, enforce_file_format=True)
    return data


def nifti(path, values, spacing=(0.7, 0.3, 2.0), unit="mm", slope=None, intercept=0.0, kind=None):
    import nibabel

    kind = kind or nibabel.Nifti1Image
    zooms = [*spacing, 1.0, 1.0][: values.ndim]
    image = kind(values, np.diag([*spacing, 1.0]), dtype=values.dtype)
    image.header.set_zooms(zooms)
    image.header.set_xyzt_units(unit)
    if slope is not None:
        image.header.set_slope_inter(slope, intercept)
    nibabel.save(image, path)


def item(pydicom, **tags):
    data = pydicom.Dataset()
    for name, value in tags.items():
        setattr(data, name, value)
    return pydicom.Sequence([data])


@pytest.mark.usefixtures("pydicom")
@pytest.mark.parametrize("dtype", [np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32])
@pytest.mark.parametrize("name", ["a.dcm", "a.DICOM", "IM000001"])
def test_dicom_keeps_stored_values(name, dtype, tmp_path):
    values = FRAMES[0].astype(dtype)
    dicom(tmp_path / name, values)
    picture = read(tmp_path / name)
    same(picture.values, values)
    assert picture.notes == {"format": "DICOM", "photometric": "MONOCHROME2"}
    assert picture.frame.spacing == (1, 1)


@pytest.mark.usefixtures("pydicom")
def test_dicom_size_is_of_rows_first_and_is_used(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], PixelSpacing=[0.5, 0.25])
    for spacing in (None, "file"):
        picture = read(tmp_path / "a.dcm", spacing=spacing)
        assert picture.frame.spacing == (0.25, 0.5)  # rows are 0.5 apart, along y
        assert picture.frame.bounds == (0, 0, 9 * 0.25, 6 * 0.5)
        assert (picture.notes["spacing"], picture.notes["spacing_from"]) == ("file", "PixelSpacing")
    picture = read(tmp_path / "a.dcm", spacing=2)
    assert picture.frame.spacing == (2, 2)
    assert "spacing" not in picture.notes


@pytest.mark.usefixtures("pydicom")
def test_dicom_size_on_the_detector_is_second_choice(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], ImagerPixelSpacing=[0.2, 0.1])
    assert read(tmp_path / "a.dcm").frame.spacing == (0.1, 0.2)
    assert read(tmp_path / "a.dcm").notes["spacing_from"] == "ImagerPixelSpacing"
    dicom(tmp_path / "b.dcm", FRAMES[0], ImagerPixelSpacing=[0.2, 0.1], PixelSpacing=[1, 2])
    assert read(tmp_path / "b.dcm").frame.spacing == (2, 1)


@pytest.mark.usefixtures("pydicom")
@pytest.mark.parametrize("noted", [None, [0, 1], [1, -1]])
def test_dicom_without_a_size(noted, tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], PixelSpacing=noted)
    assert read(tmp_path / "a.dcm").frame.spacing == (1, 1)
    with pytest.raises(ParameterError, match="spacing: 'file' expected a resolution"):
        read(tmp_path / "a.dcm", spacing="file")


@pytest.mark.usefixtures("pydicom")
def test_dicom_is_rescaled_to_what_was_measured(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], RescaleSlope=1, RescaleIntercept=-1024)
    same(read(tmp_path / "a.dcm").values, FRAMES[0] - 1024.0)
    assert binarize(read(tmp_path / "a.dcm").values)[1].how == "otsu"  # measured values are gray, not labels
    dicom(tmp_path / "a.dcm", FRAMES[0].astype(np.int16), RescaleSlope=0.5, RescaleIntercept=3)
    same(read(tmp_path / "a.dcm").values, FRAMES[0] * 0.5 + 3)
    dicom(tmp_path / "a.dcm", FRAMES[0], RescaleSlope=1, RescaleIntercept=0, WindowCenter=40, WindowWidth=400)
    same(read(tmp_path / "a.dcm").values, FRAMES[0])


def test_dicom_lookup_table(pydicom, tmp_path):
    table = RNG.integers(0, 1000, 4000, np.uint16)
    lut = item(pydicom, LUTDescriptor=[4000, 0, 16], LUTData=table.astype("<u2").tobytes())
    dicom(tmp_path / "a.dcm", FRAMES[0], ModalityLUTSequence=lut)
    same(read(tmp_path / "a.dcm").values, table[FRAMES[0]])


@pytest.mark.usefixtures("pydicom")
def test_dicom_monochrome1_is_not_inverted(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], "MONOCHROME1")
    picture = read(tmp_path / "a.dcm")
    same(picture.values, FRAMES[0])
    assert picture.notes["photometric"] == "MONOCHROME1"


@pytest.mark.usefixtures("pydicom")
@pytest.mark.parametrize("frames", [1, 3])
def test_dicom_colours(frames, tmp_path):
    values = RNG.integers(0, 256, (frames, 6, 9, 3), np.uint8)
    dicom(tmp_path / "a.dcm", values if frames > 1 else values[0], "RGB", RescaleSlope=2, RescaleIntercept=0)
    for page in range(frames):
        same(read(tmp_path / "a.dcm", page=page).values, values[page])


@pytest.mark.usefixtures("pydicom")
@pytest.mark.parametrize("bits", [8, 16])
def test_dicom_palette(bits, tmp_path):
    values = (FRAMES[0] % 7).astype(np.uint8)
    colours = RNG.integers(0, 1 << bits, (256, 3), np.uint16)
    tags = {}
    for i, name in enumerate(("Red", "Green", "Blue")):
        tags[f"{name}PaletteColorLookupTableDescriptor"] = [256, 0, bits]
        tags[f"{name}PaletteColorLookupTableData"] = colours[:, i].astype(np.uint8 if bits == 8 else "<u2").tobytes()
    dicom(tmp_path / "a.dcm", values, "PALETTE COLOR", **tags)
    picture = read(tmp_path / "a.dcm")
    same(picture.values, values)
    same(picture.notes["palette"], (colours[:7] >> (bits - 8)).astype(np.uint8))
    assert to_gray(picture.values, palette=picture.notes["palette"]).dtype == np.uint8


@pytest.mark.usefixtures("pydicom")
def test_dicom_frames_are_pages(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES)
    for page in range(4):
        picture = read(tmp_path / "a.dcm", page=page)
        same(picture.values, FRAMES[page])
        assert (picture.notes["page"], picture.notes["pages"]) == (page, 4)
    with pytest.raises(ParameterError, match=r"page: expected 0 to 3 in '.*a.dcm', found 4"):
        read(tmp_path / "a.dcm", page=4)


def test_dicom_frames_may_each_have_a_size_and_a_scale(pydicom, tmp_path):
    shared = item(pydicom, PixelMeasuresSequence=item(pydicom, PixelSpacing=[0.5, 0.25]))
    own = pydicom.Sequence(
        [
            item(pydicom, PixelValueTransformationSequence=item(pydicom, RescaleSlope=slope, RescaleIntercept=-1))[0]
            for slope in (1, 2, 3, 4)
        ]
    )
    tags = {"SharedFunctionalGroupsSequence": shared, "PerFrameFunctionalGroupsSequence": own}
    dicom(tmp_path / "a.dcm", FRAMES, **tags)
    for page in range(4):
        picture = read(tmp_path / "a.dcm", page=page)
        same(picture.values, FRAMES[page] * (page + 1.0) - 1)
        assert picture.frame.spacing == (0.25, 0.5)


def test_dicom_frames_lie_at_their_heights_in_the_patient(pydicom, tmp_path):
    tilted = item(pydicom, PlaneOrientationSequence=item(pydicom, ImageOrientationPatient=[1, 0, 0, 0, 0.6, 0.8]))
    normal = np.array([0, -0.8, 0.6])
    heights = [0.0, 2.5, 5.5, 7.0]
    own = [
        item(pydicom, PlanePositionSequence=item(pydicom, ImagePositionPatient=(np.array([3, 4, 5]) + z * normal).tolist()))[0]
        for z in heights
    ]
    tags = {"SharedFunctionalGroupsSequence": tilted, "PerFrameFunctionalGroupsSequence": pydicom.Sequence(own)}
    dicom(tmp_path / "a.dcm", FRAMES, **tags)
    assert np.allclose([one.z for one in each_image(tmp_path / "a.dcm")], heights)
    assert [one.z for one in each_image(tmp_path / "a.dcm", step=4.0)] == [0, 4, 8, 12]
    dicom(tmp_path / "b.dcm", FRAMES, SpacingBetweenSlices=1.5)
    assert [one.z for one in each_image(tmp_path / "b.dcm")] == [0, 1.5, 3, 4.5]
    dicom(tmp_path / "c.dcm", FRAMES)
    assert [one.z for one in each_image(tmp_path / "c.dcm")] == [None] * 4


@pytest.mark.usefixtures("pydicom")
def test_dicom_masks_of_one_bit(tmp_path):
    mask = FRAMES[:2] > 2000
    packed = np.packbits(mask.ravel(), bitorder="little")
    data = np.append(packed, np.zeros(len(packed) % 2, np.uint8))
    dicom(tmp_path / "a.dcm", mask.astype(np.uint8), BitsAllocated=1, BitsStored=1, HighBit=0, PixelData=data.tobytes())
    for page in range(2):
        assert (binarize(read(tmp_path / "a.dcm", page=page).values)[0] == mask[page]).all()


def test_dicom_compressed(pydicom, tmp_path):
    data = dicom(tmp_path / "a.dcm", FRAMES)
    data.compress(pydicom.uid.RLELossless)
    data.save_as(tmp_path / "a.dcm")
    same(read(tmp_path / "a.dcm", page=2).values, FRAMES[2])


def test_dicom_compressed_in_a_way_pydicom_needs_help_for(pydicom, tmp_path):
    if pydicom.pixels.get_decoder(pydicom.uid.JPEGLSLossless).is_available:
        pytest.skip("there is a plugin")
    data = dicom(tmp_path / "a.dcm", FRAMES[0])
    data.file_meta.TransferSyntaxUID = pydicom.uid.JPEGLSLossless
    data.PixelData = pydicom.encaps.encapsulate([b"\xff\xd8\xff\xd9"])
    data["PixelData"].VR = "OB"
    data.save_as(tmp_path / "a.dcm")
    with pytest.raises(FileError, match=r"is compressed \(JPEG-LS Lossless.*\), for which pydicom needs a plugin: .*pylibjpeg"):
        read(tmp_path / "a.dcm")


def test_dicom_without_a_header_is_known_by_its_suffix(pydicom, tmp_path):
    for implicit in (True, False):
        data = dicom(tmp_path / "a.dcm", FRAMES[0], PixelSpacing=[1, 2])
        bare = pydicom.Dataset()
        bare.update({element.tag: element for element in data})
        bare.save_as(tmp_path / "a.dcm", implicit_vr=implicit, little_endian=True, enforce_file_format=False)
        assert (tmp_path / "a.dcm").read_bytes()[128:132] != b"DICM"
        same(read(tmp_path / "a.dcm").values, FRAMES[0])
        assert read(tmp_path / "a.dcm").frame.spacing == (2, 1)


def test_dicom_without_an_image(pydicom, tmp_path):
    data = dicom(tmp_path / "a.dcm", FRAMES[0])
    del data.PixelData
    data.save_as(tmp_path / "a.dcm")
    (tmp_path / "b.dcm").write_text("this is no image, whatever its name says")
    assert pydicom
    for name in ("a.dcm", "b.dcm"):
        with pytest.raises(FileError, match=rf"image: '.*{name}' is (no DICOM file with an image in it|damaged or truncated)"):
            read(tmp_path / name)


@pytest.mark.usefixtures("pydicom")
def test_dicom_with_more_pixels_than_allowed(tmp_path):
    dicom(tmp_path / "a.dcm", FRAMES[0], Rows=60000, Columns=60000)
    with pytest.raises(ImageError, match=r"max_pixels=268435456 pixels, found 60000 x 60000"):
        read(tmp_path / "a.dcm")


@pytest.mark.usefixtures("nibabel")
@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"])
@pytest.mark.parametrize("name", ["a.nii", "a.NII.GZ"])
def test_nifti_keeps_stored_values_and_lies_as_it_is_numbered(name, dtype, tmp_path):
    values = VOLUME.astype(dtype)
    nifti(tmp_path / "a.nii", values)
    if name.endswith("GZ"):
        (tmp_path / name).write_bytes(gzip.compress((tmp_path / "a.nii").read_bytes()))
    for page in (0, 3):
        picture = read(tmp_path / name, page=page)
        same(picture.values, values[:, ::-1, page].T)
        i, j = np.indices((6, 9))
        row, column = picture.frame.row_column(np.stack([(i + 0.5) * 0.7, (j + 0.5) * 0.3], axis=-1))
        assert (picture.values[row.astype(int), column.astype(int)] == values[:, :, page]).all()
        assert picture.notes == {"format": "NIfTI", "pages": 4, "page": page, "axes": "RAS", "spacing": "file", "units": "mm"}


@pytest.mark.usefixtures("nibabel")
@pytest.mark.parametrize(("unit", "scale"), [("mm", 1), ("meter", 1000), ("micron", 0.001), ("unknown", 1)])
def test_nifti_size_is_in_millimetres_and_is_used(unit, scale, tmp_path):
    nifti(tmp_path / "a.nii", VOLUME, unit=unit)
    for spacing in (None, "file"):
        assert read(tmp_path / "a.nii", spacing=spacing).frame.spacing == (0.7 * scale, 0.3 * scale)
    assert read(tmp_path / "a.nii", spacing=(3, 4)).frame.spacing == (3, 4)


@pytest.mark.usefixtures("nibabel")
def test_nifti_without_a_size(tmp_path, capfd):
    nifti(tmp_path / "a.nii", VOLUME)
    raw = bytearray((tmp_path / "a.nii").read_bytes())
    raw[80:84] = np.float32(0).tobytes()  # pixdim[1]
    (tmp_path / "a.nii").write_bytes(raw)
    assert read(tmp_path / "a.nii").frame.spacing == (1, 1)
    with pytest.raises(ParameterError, match="spacing: 'file' expected a resolution"):
        read(tmp_path / "a.nii", spacing="file")
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("nibabel")
def test_nifti_labels_stay_integers(tmp_path):
    labels = (abs(VOLUME) % 5).astype(np.int16)
    nifti(tmp_path / "a.nii", labels, slope=1.0, intercept=0.0)
    assert (label_map(read(tmp_path / "a.nii").values).values == labels[:, ::-1, 0].T).all()
    assert read(tmp_path / "a.nii").values.dtype == np.int16


def test_nifti_slope_is_applied(nibabel, tmp_path):
    header = nibabel.Nifti1Header()
    header.set_data_dtype(np.int16)
    header.set_data_shape((6, 9))
    header["scl_slope"], header["scl_inter"], header["vox_offset"], header["magic"] = 2, -1024, 352, b"n+1"
    stored = VOLUME[:, :, 0]
    (tmp_path / "a.nii").write_bytes(header.binaryblock + b"\0" * 4 + stored.tobytes(order="F"))
    same(read(tmp_path / "a.nii").values, stored[:, ::-1].T * 2.0 - 1024)


@pytest.mark.usefixtures("nibabel")
def test_nifti_pages_run_through_slices_then_times(tmp_path):
    values = RNG.integers(0, 9, (3, 4, 2, 5)).astype(np.uint8)
    nifti(tmp_path / "a.nii", values)
    for k in range(2):
        for t in range(5):
            picture = read(tmp_path / "a.nii", page=k + 2 * t)
            same(picture.values, values[:, ::-1, k, t].T)
            assert picture.notes["pages"] == 10
    with pytest.raises(ParameterError, match="page: expected 0 to 9"):
        read(tmp_path / "a.nii", page=10)


@pytest.mark.usefixtures("nibabel")
def test_nifti_of_two_axes_is_one_page(tmp_path):
    nifti(tmp_path / "a.nii", VOLUME[:, :, 0])
    same(read(tmp_path / "a.nii").values, VOLUME[:, ::-1, 0].T)
    assert "page" not in read(tmp_path / "a.nii").notes
    with pytest.raises(ParameterError, match="page: expected 0 to 0"):
        read(tmp_path / "a.nii", page=1)


@pytest.mark.usefixtures("nibabel")
def test_nifti_of_one_axis_is_refused(tmp_path):
    nifti(tmp_path / "a.nii", VOLUME[:, 0, 0])
    with pytest.raises(ImageError, match=r"expected an array of at least two axes in '.*a.nii', found shape \(6,\)"):
        read(tmp_path / "a.nii")


def test_nifti_2_and_content_without_a_suffix(nibabel, tmp_path):
    for kind in (nibabel.Nifti1Image, nibabel.Nifti2Image):
        nifti(tmp_path / "a.nii", VOLUME, kind=kind)
        (tmp_path / "a.nii").rename(tmp_path / "scan")
        picture = read(tmp_path / "scan", page=2)
        same(picture.values, VOLUME[:, ::-1, 2].T)
        assert picture.frame.spacing == (0.7, 0.3)


@pytest.mark.usefixtures("nibabel")
def test_nifti_colours(tmp_path):
    values = np.zeros((6, 9, 2), [("R", "u1"), ("G", "u1"), ("B", "u1")])
    for name in "RGB":
        values[name] = RNG.integers(0, 256, values.shape)
    nifti(tmp_path / "a.nii", values)
    expected = np.stack([values[name][:, ::-1, 1].T for name in "RGB"], axis=2)
    same(read(tmp_path / "a.nii", page=1).values, expected)


def test_nifti_axes_are_noted_and_not_turned(nibabel, tmp_path):
    affine = np.array([[0, 0, 3.0, 0], [-0.7, 0, 0, 0], [0, -0.3, 0, 0], [0, 0, 0, 1]])
    nibabel.save(nibabel.Nifti1Image(VOLUME, affine), tmp_path / "a.nii")
    picture = read(tmp_path / "a.nii")
    assert picture.notes["axes"] == "PIR"
    assert picture.frame.spacing == (0.7, 0.3)
    same(picture.values, VOLUME[:, ::-1, 0].T)


@pytest.mark.usefixtures("nibabel")
def test_nifti_of_complex_numbers_is_refused(tmp_path):
    nifti(tmp_path / "a.nii", VOLUME.astype(np.complex64))
    with pytest.raises(ImageError, match="found an array of type complex64"):
        read(tmp_path / "a.nii")


@pytest.mark.usefixtures("nibabel")
def test_nifti_with_more_pixels_than_allowed(tmp_path):
    nifti(tmp_path / "a.nii", VOLUME)
    assert read(tmp_path / "a.nii", max_pixels=54).values.size == 54  # of a slice, not of the file
    with pytest.raises(ImageError, match="max_pixels=53 pixels, found 6 x 9"):
        read(tmp_path / "a.nii", max_pixels=53)


@pytest.mark.parametrize(
    ("name", "start", "extra"),
    [("a.dcm", b"", "dicom"), ("a.nii", b"", "nifti"), ("x", b"\0" * 128 + b"DICM", "dicom"), ("x", b"\0" * 344 + b"n+1\0", "nifti")],
)
def test_what_to_install_is_said(name, start, extra, tmp_path, monkeypatch):
    for library in ("pydicom", "pydicom.pixels", "nibabel"):
        monkeypatch.setitem(sys.modules, library, None)
    (tmp_path / name).write_bytes(start + b"\0")
    with pytest.raises(FileError, match=rf"pip install 'img2tri\[{extra}\]'"):
        read(tmp_path / name)


@pytest.mark.usefixtures("pydicom", "nibabel")
def test_other_files_need_neither(tmp_path, monkeypatch):
    for library in ("pydicom", "pydicom.pixels", "nibabel"):
        monkeypatch.setitem(sys.modules, library, None)
    Image.fromarray(np.zeros((40, 50), np.uint8)).save(tmp_path / "a.png")
    assert read(tmp_path / "a.png").values.shape == (40, 50)


def whole_file(kind, folder):
    import pydicom

    path = folder / f"image.{kind.split()[0]}"
    if kind == "dcm":
        dicom(path, FRAMES, PixelSpacing=[1, 2], RescaleSlope=2, RescaleIntercept=1)
    elif kind == "dcm RLE":
        data = dicom(path, FRAMES)
        data.compress(pydicom.uid.RLELossless)
        data.save_as(path)
    elif kind == "dcm JPEG":
        waves = np.rint(120 + 100 * np.sin(np.indices((64, 80)).sum(axis=0) / 9)).astype(np.uint8)
        file = io.BytesIO()
        Image.fromarray(waves).save(file, "JPEG")
        data = dicom(path, waves)
        data.file_meta.TransferSyntaxUID = pydicom.uid.JPEGBaseline8Bit
        data.PixelData = pydicom.encaps.encapsulate([file.getvalue()])
        data["PixelData"].VR = "OB"
        data.save_as(path)
    else:
        nifti(path, VOLUME)
    return path


KINDS = ["dcm", "dcm RLE", "dcm JPEG", "nii", "nii.gz"]


@pytest.mark.usefixtures("pydicom", "nibabel")
@pytest.mark.parametrize("kind", KINDS)
def test_a_truncated_file_never_gives_part_of_an_image(kind, tmp_path):
    path = whole_file(kind, tmp_path)
    whole, last = path.read_bytes(), 0 if "JPEG" in kind else 3
    values = read(path, page=last).values
    for part in np.linspace(0, 1, 60)[:-1]:
        path.write_bytes(whole[: int(part * len(whole))])
        with contextlib.suppress(FileError):
            same(read(path, page=last).values, values)
            assert part > 0.9
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FileError, match=r"image: .*(damaged or truncated|is no DICOM)"):
        read(path, page=last)


@pytest.mark.usefixtures("pydicom", "nibabel")
@pytest.mark.parametrize("kind", KINDS)
def test_damaged_files_give_no_other_error(kind, tmp_path):
    path = whole_file(kind, tmp_path)
    whole = path.read_bytes()

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
