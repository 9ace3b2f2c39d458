"""TIFF tags of GeoTIFF, ImageJ and OME-TIFF -> how large a pixel is, in which unit, and where the image lies.

The three dialects write what the resolution tags of TIFF cannot say. They are told by their tags alone, whichever library read them:

- GeoTIFF has the scale and a tie point, or a matrix, in units of its coordinate system (OGC 19-008r4, GeoTIFF 1.1). Both may refer to
  the corner or the centre of the first pixel. An image that is turned has no scale along the axes.
- ImageJ has lines such as ``unit=um`` in the description; the resolution tags then are pixels per that unit.
- OME-TIFF has XML in the description, with ``PhysicalSizeX`` and its unit, micrometres if none is given (OME 2016-06).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from img2tri.raster.metadata.pixel_size import X_RESOLUTION, Y_RESOLUTION, PixelSize, millimetres, positive_size, ratio

DESCRIPTION = 270  # tags of TIFF
PIXEL_SCALE, TIE_POINT, MATRIX, GEO_KEYS = 33550, 33922, 34264, 34735  # of GeoTIFF
MODEL_TYPE, RASTER_TYPE, LINEAR_UNITS = 1024, 1025, 3076  # keys of GeoTIFF
PROJECTED, PIXEL_IS_POINT = 1, 2
GEO_UNITS = {9001: "m", 9002: "ft", 9003: "ft", 0: "m"}

# Names of units -> unit of img2tri, and how many of it.
LENGTH_UNITS = {
    "um": ("um", 1.0), "µm": ("um", 1.0), "μm": ("um", 1.0), "micron": ("um", 1.0), "microns": ("um", 1.0), "micrometer": ("um", 1.0),
    "\\u00b5m": ("um", 1.0), "nm": ("um", 1e-3), "å": ("um", 1e-4), "angstrom": ("um", 1e-4), "pm": ("um", 1e-6), "mm": ("mm", 1.0),
    "millimeter": ("mm", 1.0), "cm": ("cm", 1.0), "m": ("m", 1.0), "meter": ("m", 1.0), "km": ("m", 1000.0), "inch": ("in", 1.0),
    "in": ("in", 1.0), "ft": ("ft", 1.0),
}  # fmt: skip


@dataclass(frozen=True)
class FilePlace:
    """Where a file says its image lies.

    Attributes
    ----------
    size
        (dx, dy), the size of a pixel; None: the file does not say.
    unit
        What it is in; None: the file does not say, as for degrees.
    corner
        (x, y) of the lower-left corner of the image; None: the file does not say.
    """

    size: PixelSize | None = None
    unit: str | None = "mm"
    corner: tuple[float, float] | None = None


def place_of_tiff(tags: Mapping[int, Any], height: int) -> FilePlace:
    r"""Return where a TIFF of `height` rows says its image lies: GeoTIFF before ImageJ and OME, these before the resolution tags.

    Examples
    --------
    >>> place_of_tiff({33550: (30.0, 30.0, 0.0), 33922: (0, 0, 0, 500000.0, 4649776.0, 0)}, 60)
    FilePlace(size=(30.0, 30.0), unit='m', corner=(500000.0, 4647976.0))
    >>> place_of_tiff({270: "ImageJ=1.54\nunit=um\n", 282: (1000, 103), 283: (1000, 103)}, 60)
    FilePlace(size=(0.103, 0.103), unit='um', corner=None)
    """
    description = _description(tags)
    if GEO_KEYS in tags or PIXEL_SCALE in tags or MATRIX in tags:
        return _geotiff(tags, height)
    if description.startswith("ImageJ="):
        found = _imagej(description, tags)
    elif "<OME" in description:
        found = _ome(description)
    else:
        found = None
    return found or FilePlace(millimetres(tags))


def _description(tags: Mapping[int, Any]) -> str:
    """Return the description of a TIFF, in UTF-8 as all write it today, though the format and so Pillow know of ASCII only."""
    noted = tags.get(DESCRIPTION, "")
    raw = noted if isinstance(noted, bytes) else str(noted).encode("latin-1", "ignore")
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _geotiff(tags: Mapping[int, Any], height: int) -> FilePlace:
    keys = [int(n) for n in tags.get(GEO_KEYS, ())]
    known = {keys[i]: keys[i + 3] for i in range(4, len(keys) - 3, 4) if keys[i + 1] == 0}
    if MATRIX in tags and len(tags[MATRIX]) >= 8:
        dx, turn, _, x, other, dy, _, y = (float(n) for n in tags[MATRIX][:8])
        size = positive_size(dx, -dy) if turn == other == 0 else None
    elif PIXEL_SCALE in tags and len(tags.get(TIE_POINT, ())) >= 6:
        dx, dy = (float(n) for n in tags[PIXEL_SCALE][:2])
        column, row, _, x, y, _ = (float(n) for n in tags[TIE_POINT][:6])
        x, y, size = x - column * dx, y + row * dy, positive_size(dx, dy)
    else:
        size = None
    unit = GEO_UNITS.get(known.get(LINEAR_UNITS, 0)) if known.get(MODEL_TYPE, PROJECTED) == PROJECTED else None
    if size is None:
        return FilePlace(None, unit)
    half = 0.5 if known.get(RASTER_TYPE) == PIXEL_IS_POINT else 0.0
    return FilePlace(size, unit, (x - half * size[0], y + (half - height) * size[1]))


def _imagej(description: str, tags: Mapping[int, Any]) -> FilePlace | None:
    match = re.search(r"^unit=(.+)$", description, re.MULTILINE)
    length = LENGTH_UNITS.get(match[1].strip().lower()) if match else None
    if length is None or X_RESOLUTION not in tags or Y_RESOLUTION not in tags:
        return None
    x, y = ratio(tags[X_RESOLUTION]), ratio(tags[Y_RESOLUTION])
    return FilePlace(_rounded(length[1] / x, length[1] / y), length[0]) if x > 0 and y > 0 else None


def _ome(description: str) -> FilePlace | None:
    sizes, units = [], []
    for axis in "XY":
        size = re.search(rf'\bPhysicalSize{axis}="([^"]+)"', description)
        unit = re.search(rf'\bPhysicalSize{axis}Unit="([^"]+)"', description)
        length = LENGTH_UNITS.get(unit[1].lower()) if unit else LENGTH_UNITS["um"]
        if size is None or length is None:
            return None
        sizes.append(float(size[1]) * length[1])
        units.append(length[0])
    found = positive_size(*sizes)
    return FilePlace(_rounded(*found), units[0]) if found and units[0] == units[1] else None


def _rounded(dx: float, dy: float) -> PixelSize:
    """Return the numbers meant: 0.103 for 1 / 9.70873786, which a file keeps as a fraction of two whole numbers."""
    return float(f"{dx:.9g}"), float(f"{dy:.9g}")
