"""NRRD (3D Slicer) and MetaImage (ITK, ITK-SNAP) -> values, the size of a pixel, and the names of segments.

Both are a few lines of text and then the values, x running fastest, so a plane is an image as it is displayed, its first row at the top;
a page is one slice across z. Each axis keeps the spacing noted for it, and nothing is turned by where the file says its axes point: a
volume whose axes are oblique is sliced along its own.

NRRD: https://teem.sourceforge.net/nrrd/format.html. MetaImage: https://itk.org/Wiki/ITK/MetaIO/Documentation.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from img2tri.errors import FileError, ImageError
from img2tri.raster.files.byte_sources import Source
from img2tri.raster.files.decoded_image import DecodedImage, check_page, plane_height
from img2tri.raster.files.volumes import planes_of, read_plane
from img2tri.raster.metadata.geotiff_imagej_ome import LENGTH_UNITS
from img2tri.raster.metadata.pixel_size import positive_size

NRRD_START, METAIMAGE_STARTS = b"NRRD000", (b"ObjectType", b"NDims", b"Comment")
LONGEST_HEADER = 2**20
VOXEL_TYPES = {
    "i1": ("signed char", "int8", "int8_t", "MET_CHAR"),
    "u1": ("uchar", "unsigned char", "uint8", "uint8_t", "MET_UCHAR"),
    "i2": ("short", "short int", "signed short", "int16", "int16_t", "MET_SHORT"),
    "u2": ("ushort", "unsigned short", "uint16", "uint16_t", "MET_USHORT"),
    "i4": ("int", "signed int", "int32", "int32_t", "MET_INT", "MET_LONG"),
    "u4": ("uint", "unsigned int", "uint32", "uint32_t", "MET_UINT", "MET_ULONG"),
    "i8": ("longlong", "long long", "int64", "int64_t", "MET_LONG_LONG"),
    "u8": ("ulonglong", "unsigned long long", "uint64", "uint64_t", "MET_ULONG_LONG"),
    "f4": ("float", "MET_FLOAT"),
    "f8": ("double", "MET_DOUBLE"),
}
KINDS_OF_COLOURS = ("rgb-color", "rgba-color", "3-color", "4-color", "vector", "list", "3-vector", "4-vector")


def decode_nrrd(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one slice of a NRRD file; of a segmentation of 3D Slicer its notes hold the names of segments."""
    with source.open() as file:
        fields, keys = _nrrd_header(file)
        sizes = [int(n) for n in fields["sizes"].split()]
        dtype = _dtype(fields["type"], source).newbyteorder(">" if fields.get("endian", "little") == "big" else "<")
        encoding = {"raw": "raw", "gzip": "gzip", "gz": "gzip", "bzip2": "bzip2", "bz2": "bzip2"}.get(fields["encoding"].lower())
        if encoding is None:
            raise FileError(f"image: {str(source)!r} has values in the encoding {fields['encoding']!r}; save it as raw or gzip")
        kinds = [kind.lower() for kind in fields.get("kinds", "").split()]
        layers = bool(kinds) and kinds[0] in KINDS_OF_COLOURS and len(sizes) > 2
        if "data file" in fields:
            with _beside(source, fields["data file"]) as data:
                values, notes = _plane(data, source, dtype, sizes, page, max_pixels, encoding, layers=layers)
        else:
            values, notes = _plane(file, source, dtype, sizes, page, max_pixels, encoding, layers=layers)
    notes = {"format": "NRRD"} | notes
    names = {int(keys[f"Segment{i}_LabelValue"]): name for i, name in _numbered(keys) if keys.get(f"Segment{i}_LabelValue", "").isdigit()}
    if names:
        notes["names"] = names
    unit, scale = _unit(fields.get("space units", ""))
    lengths = [scale * length for length in _nrrd_lengths(fields, layers=layers)]
    size = positive_size(lengths[0], lengths[1]) if len(lengths) > 1 else None
    return DecodedImage(values, notes, size, unit, height=plane_height(page, lengths[2:]))


def decode_metaimage(source: Source, page: int, max_pixels: int) -> DecodedImage:
    """Decode one slice of a MetaImage, .mha or .mhd with its values in another file."""
    with source.open() as file:
        fields: dict[str, str] = {}
        while "ElementDataFile" not in fields:
            name, _, value = _line(file).partition("=")
            fields[name.strip()] = value.strip()
        sizes = [int(n) for n in fields["DimSize"].split()]
        big = fields.get("BinaryDataByteOrderMSB", fields.get("ElementByteOrderMSB", "False")).lower() == "true"
        dtype = _dtype(fields["ElementType"], source).newbyteorder(">" if big else "<")
        channels = int(fields.get("ElementNumberOfChannels", 1))
        if channels > 1:
            sizes = [channels, *sizes]
        encoding = "gzip" if fields.get("CompressedData", "False").lower() == "true" else "raw"
        if fields["ElementDataFile"] == "LOCAL":
            values, notes = _plane(file, source, dtype, sizes, page, max_pixels, encoding, layers=channels > 1)
        else:
            with _beside(source, fields["ElementDataFile"]) as data:
                data.seek(max(0, int(fields.get("HeaderSize", 0))))
                values, notes = _plane(data, source, dtype, sizes, page, max_pixels, encoding, layers=channels > 1)
    spacing = [float(n) for n in fields.get("ElementSpacing", fields.get("ElementSize", "")).split()]
    size = positive_size(*spacing[:2]) if len(spacing) > 1 else None
    return DecodedImage(values, {"format": "MetaImage"} | notes, size, height=plane_height(page, spacing[2:]))


def _plane(
    file: BinaryIO, source: Source, dtype: np.dtype[Any], sizes: list[int], page: int, max_pixels: int, encoding: str, *, layers: bool
) -> tuple[np.ndarray[Any, Any], dict[str, Any]]:
    """Read one slice; sizes are those of the axes, the fastest first."""
    if layers and sizes[0] not in (1, 3, 4):
        raise ImageError(f"image: expected one value or a colour per pixel, found {sizes[0]} in {str(source)!r}")
    planes = planes_of((*sizes[:0:-1], sizes[0]) if not layers else (*reversed(sizes[1:]), sizes[0]), source)
    if not layers and planes.colours:
        # A narrow volume, no colours.
        planes = type(planes)(planes.shape, planes.shape[-2], planes.shape[-1], 0)
    notes = check_page(source, page, planes.pages, planes.width, planes.height, max_pixels)
    return read_plane(file, source, dtype, planes, page, encoding), notes


def _nrrd_header(file: BinaryIO) -> tuple[dict[str, str], dict[str, str]]:
    """Read fields, ``name: value``, and keys, ``name:=value``, up to the empty line before the values."""
    fields: dict[str, str] = {}
    keys: dict[str, str] = {}
    _line(file)
    while line := _line(file):
        if line.startswith("#"):
            continue
        name, sign, value = re.match(r"([^:]*)(:=|: ?)(.*)", line).groups()  # type: ignore[union-attr]
        (keys if sign == ":=" else fields)[name if sign == ":=" else name.strip().lower()] = value.strip()
    return {"encoding": "raw"} | ({"data file": fields["datafile"]} if "datafile" in fields else {}) | fields, keys


def _line(file: BinaryIO) -> str:
    line = file.readline(LONGEST_HEADER)
    if not line or file.tell() > LONGEST_HEADER:
        raise ValueError("its header does not end")
    return line.decode("utf-8", "replace").rstrip("\r\n")


def _numbered(keys: dict[str, str]) -> list[tuple[str, str]]:
    """Return the numbers and names of the segments of 3D Slicer."""
    return [(match[1], name) for key, name in keys.items() if name and (match := re.fullmatch(r"Segment(\d+)_Name", key))]


def _dtype(name: str, source: Source) -> np.dtype[Any]:
    found = next((code for code, names in VOXEL_TYPES.items() if name in names), None)
    if found is None:
        raise ImageError(f"image: expected integers or floats in {str(source)!r}, found values of type {name!r}")
    return np.dtype(found)


def _beside(source: Source, name: str) -> BinaryIO:
    """Open the file with the values, which lies beside the header."""
    if source.path is None or Path(name).name != name or "%" in name or name.upper().startswith("LIST"):
        raise FileError(f"image: {str(source)!r} has its values in {name!r}, which is not one file beside it; save it as a single file")
    return Source(name, source.path.parent / name).open()


def _nrrd_lengths(fields: dict[str, str], *, layers: bool) -> list[float]:
    """Return the lengths of the directions of the axes, or their spacings."""
    if "space directions" in fields:
        vectors = re.findall(r"none|\(([^)]*)\)", fields["space directions"])
        return [math.hypot(*map(float, vector.split(","))) for vector in vectors if vector]
    return [float(n) for n in fields.get("spacings", "").split()][layers:]


def _unit(noted: str) -> tuple[str, float]:
    """Return the unit of the first axis, millimetres if none is named, and how many of it the file's are."""
    match = re.search(r'"([^"]+)"', noted)
    return LENGTH_UNITS.get(match[1].lower(), ("mm", 1.0)) if match else ("mm", 1.0)
