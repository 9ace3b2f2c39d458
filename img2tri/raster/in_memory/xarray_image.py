"""An ``xarray.DataArray`` -> `Picture`, lying where its coordinates say.

The object is recognised by what it has, so xarray is never imported here. Its coordinates are the centres of the pixels, evenly spaced.
Where y rises with the row the frame does so, and nothing is upside down; where x falls with the column, columns are turned round::

    dims ("y", "x"), y 30 20 10      row 0 is at the top, y up              dims ("y", "x"), y 10 20 30      row 0 is at the bottom
"""

from __future__ import annotations

from typing import Any

import numpy as np

from img2tri.arrays import Floats
from img2tri.errors import ImageError
from img2tri.raster.in_memory.array_checks import Pixels, as_array, pixels
from img2tri.raster.metadata.geotiff_imagej_ome import LENGTH_UNITS
from img2tri.raster.metadata.nodata import either, equal_to, present
from img2tri.types import Frame, Picture

X_NAMES, Y_NAMES = ("x", "lon", "longitude", "easting", "column", "cols"), ("y", "lat", "latitude", "northing", "row", "rows")
BANDS = ("band", "bands", "channel", "channels", "c", "rgb", "rgba")
EVEN_STEPS = 1e-3  # of a spacing: how far coordinates may be off even spaces, which 32 bits need


def is_data_array(image: Any) -> bool:
    """Tell whether `image` is an ``xarray.DataArray``, without importing xarray."""
    return all(hasattr(type(image), name) for name in ("dims", "coords", "to_numpy", "attrs", "isel"))


def knows_its_place(image: Any) -> bool:
    """Tell whether a DataArray has numbers for coordinates along both axes of the image."""
    names = [name for name in image.dims if str(name).lower() not in BANDS and image.sizes[name] > 1]
    return any(name in image.coords for name in names)


def from_data_array(image: Any) -> Picture:
    """Read a ``xarray.DataArray`` of two dimensions, besides those of length one and one of colours.

    Parameters
    ----------
    image
        With the dimensions (y, x), or (x, y) by their names. Without coordinates pixels are 1 large, and y points up. The attribute
        ``_FillValue`` (or ``nodata``) and NaN are pixels that are not there; ``units`` of x is the unit of lengths.

    Returns
    -------
    Picture
        With the spacing and place of the coordinates.

    Raises
    ------
    ImageError
        If it has more dimensions, or coordinates that are not evenly spaced numbers.
    """
    image = image.squeeze(drop=True) if image.ndim > 2 else image
    names = [name for name in image.dims if str(name).lower() not in BANDS]
    if image.ndim not in (2, 3) or len(names) != 2:
        raise ImageError(f"image: expected a DataArray of dimensions such as (y, x), found {image.dims}; pick one with isel")
    if str(names[0]).lower() in X_NAMES and str(names[1]).lower() not in X_NAMES:
        names = names[::-1]
    image = image.transpose(*names, ...)
    values, masked = present(as_array(image.to_numpy()))
    noted = image.attrs.get("_FillValue", image.attrs.get("nodata"))
    missing = either(masked, None if noted is None else equal_to(values, noted))
    (dy, y), (dx, x) = (_even(image, name) for name in names)
    if dx < 0:
        values, missing, dx, x = values[:, ::-1], None if missing is None else missing[:, ::-1], -dx, x + dx * (values.shape[1] - 1)
    h, w = values.shape[:2]
    upward = dy < 0
    lowest = y + dy * (h - 1) if upward else y
    frame = Frame((h, w), (dx, abs(dy)), (x - dx / 2, lowest - abs(dy) / 2), upward)
    notes: dict[str, Any] = {"format": "DataArray"}
    if knows_its_place(image):
        unit = LENGTH_UNITS.get(str(image.coords[names[1]].attrs.get("units", "")).lower()) if names[1] in image.coords else None
        notes |= {"spacing": "DataArray"} | ({"units": unit[0]} if unit and unit[1] == 1.0 else {})
    return Picture(
        _contiguous(values), frame, f"DataArray {image.name!r}", notes, None if missing is None else np.ascontiguousarray(missing)
    )


def _contiguous(values: Pixels) -> Pixels:
    return pixels(np.ascontiguousarray(values))


def _even(image: Any, name: Any) -> tuple[float, float]:
    """Return the step and the first of the coordinates along an axis; without any, rows fall and columns rise by 1 from 1/2 on."""
    count = image.sizes[name]
    if name not in image.coords:
        return (1.0, 0.5) if name == image.dims[1] else (-1.0, count - 0.5)
    places = np.asarray(image.coords[name])
    if places.ndim != 1 or places.dtype.kind not in "iuf" or not np.isfinite(places).all():
        raise ImageError(
            f"image: expected numbers for the coordinates {name!r} of a DataArray, found {places.dtype}; drop them with drop_vars"
        )
    places = places.astype(np.float64)
    if count == 1:
        return 1.0, float(places[0])
    step = float(places[-1] - places[0]) / (count - 1)
    if step == 0 or _uneven(places, step):
        raise ImageError(f"image: expected evenly spaced coordinates {name!r}, found others; resample with interp first")
    return step, float(places[0])


def _uneven(places: Floats, step: float) -> bool:
    return bool((abs(places - places[0] - step * np.arange(len(places))) > EVEN_STEPS * abs(step)).any())
