"""A file, an array or a ``pyvista.ImageData`` -> a `Picture`: the values as they are, and where they lie in the world.

Nothing is scaled, thresholded or turned into gray here, so label numbers, 16-bit values and palette indices survive.
Files are decoded by Pillow rather than by ``cv2.imread``, which hides much of what matters: it hands out a partial image for a
truncated JPEG, ignores the orientation a camera noted, and replaces palette indices, which may be labels, by colours. DICOM and
NIfTI come through pydicom and nibabel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from img2tri.errors import ParameterError, finite, integer, shown
from img2tri.raster.files.byte_sources import is_file, source_of
from img2tri.raster.files.decoded_image import DecodedImage
from img2tri.raster.in_memory.array_checks import as_array, pixels
from img2tri.raster.in_memory.pillow_object import is_pillow
from img2tri.raster.in_memory.pyvista_image import from_image_data, is_image_data
from img2tri.raster.in_memory.simpleitk_image import from_simpleitk, is_simpleitk
from img2tri.raster.in_memory.xarray_image import from_data_array, is_data_array, knows_its_place
from img2tri.raster.metadata.nodata import either, present
from img2tri.raster.metadata.wanted_width import FINEST
from img2tri.types import Frame, Picture

Pair = tuple[float, float]

CARRY_SPACING = ("DICOM", "NIfTI", "NRRD", "MetaImage")  # formats made to say how large a pixel is


def read(
    image: Any,
    *,
    spacing: float | Sequence[float] | str | None = None,
    origin: str | Sequence[float] = "lower",
    page: int = 0,
    max_pixels: int = 2**28,
) -> Picture:
    """Read an image, and say where its pixels lie.

    Parameters
    ----------
    image
        A path (str or PathLike), or a file opened in binary mode, which is read to its end; an array (h, w) or (h, w, 3 or 4)
        of bool, integers or floats, where masked pixels and NaN are not there, or any object numpy can turn into one; a planar
        ``pyvista.ImageData``, whose active scalars are taken (its first ones if none are active), an ``xarray.DataArray`` with
        coordinates or a ``SimpleITK.Image``, which lie where they say; a ``PIL.Image``. A `Picture` was read before, with its own
        options, and is returned as it is.
    spacing
        The size of a pixel in world units: a number, a pair (dx, dy), or "file", which takes the size or resolution noted in a
        TIFF, PNG, JPEG, DICOM or NIfTI file: in millimetres, in the unit of an ImageJ or OME-TIFF, or in that of the coordinate
        system of a GeoTIFF, which then lies at its place unless `origin` is given. None is "file" for DICOM, NIfTI, NRRD and
        MetaImage, if they note a size; 1 for all else, whatever the file says, since many carry a resolution of 72 dpi nobody chose.
        Objects that know their place always keep it.
    origin
        "lower": x points right and y up, the lower-left corner of the image is at (0, 0). "upper": y points down, as in image
        coordinates, the corner of the first pixel is at (0, 0). A pair (x, y): as "lower", with the corner there.
    page
        Which image of a file with several, from 0: a page, a frame, a slice across the third axis of a NIfTI, NRRD or MetaImage file,
        across the first axes of an array in a .npy, HDF5 or zarr file.
    max_pixels
        A file that claims more pixels than this is refused before it is decoded, so that a small file cannot fill the memory; so
        is an open file that gives more than 8 bytes for each, and 1 MiB.

    Returns
    -------
    Picture
        Its `notes` hold what was found in a file: "format"; "pages" where there are several, and the "page" taken;
        "orientation" (EXIF, 2 to 8) where the image had to be turned; "palette", (n, 3 or 4) uint8, where the values are
        indices into it; "spacing", "file" or the kind of object, where it was not given in numbers, then with "units";
        "missing", how many pixels are not there; "min_is_white" for TIFFs whose gray values are stored so. For DICOM and NIfTI
        see `files.dicom` and `files.nifti`.

    Raises
    ------
    FileError
        If the file is missing, a folder, not an image, damaged or truncated; if it needs a library that is not installed.
    ImageError
        If the values are not those of an image: wrong shape or type, no pixels, infinite values, too many pixels or bytes.
    ParameterError
        If `spacing`, `origin`, `page` or `max_pixels` is not as described, or a file is opened as text.

    Examples
    --------
    >>> import numpy as np
    >>> picture = read(np.zeros((20, 30)), spacing=0.5)
    >>> picture.frame.bounds
    (0.0, 0.0, 15.0, 10.0)
    """
    if isinstance(image, Picture):
        return image
    page, max_pixels = integer("page", page), integer("max_pixels", max_pixels, least=1)
    placed = _placed_object(image, page)
    if placed is not None:
        asked = {"spacing": spacing is not None, "origin": not _is_lower(origin), "page": page > 0 and "page" not in placed.notes}
        if any(asked.values()):
            what = f"{type(image).__module__.partition('.')[0]}.{type(image).__name__}"
            raise ParameterError(f"spacing, origin, page: a {what} has its own place; leave them out, or change the object")
        return placed
    corner, upward = _corner(origin)
    if is_file(image):
        from img2tri.raster.files.format_detection import decode  # Pillow is loaded for files only

        file = source_of(image, max_pixels=max_pixels)
        found, name = decode(file, page, max_pixels), str(file)
    else:
        if page:
            raise ParameterError(f"page: expected 0 for an array, which is one image, found {shown(page)}")
        found, name = _of_array(image), "array"
    array, masked = present(as_array(found.values))
    values, notes, missing = pixels(array), dict(found.notes), either(masked, found.missing)
    if spacing is None and found.size is not None and notes.get("format") in CARRY_SPACING:
        spacing = "file"
    size = _spacing(spacing, found.size, name)
    if isinstance(spacing, str):
        notes |= {"spacing": spacing} | ({"units": found.unit} if found.unit else {})
        if found.corner is not None and _is_lower(origin):
            corner = found.corner
    if missing is not None:
        notes["missing"] = int(np.count_nonzero(missing))
    h, w = values.shape[:2]
    height = (found.height or 0.0) if isinstance(spacing, str) else 0.0  # of a slice in its volume, with the spacing of the file
    frame = Frame((h, w), size, corner, upward, height)
    _check_precision(frame)
    return Picture(values, frame, name, notes, missing)


def _placed_object(image: Any, page: int) -> Picture | None:
    """Read an object of another library that knows where it lies; None for all else."""
    if is_image_data(image):
        return from_image_data(image)
    if is_simpleitk(image):
        return from_simpleitk(image, page)
    return from_data_array(image) if is_data_array(image) and knows_its_place(image) else None


def _of_array(image: Any) -> DecodedImage:
    """Take an array, or an object that is one without a place of its own."""
    if is_pillow(image):
        from img2tri.raster.files.pillow_images import of_pillow

        return of_pillow(image)
    if is_data_array(image):
        picture = from_data_array(image)
        return DecodedImage(picture.values, picture.notes, missing=picture.missing)
    return DecodedImage(image, {})


def _check_precision(frame: Frame) -> None:
    if math.ulp(max(map(abs, frame.bounds))) > FINEST * frame.pixel:
        raise ParameterError(
            f"origin: expected a corner within {FINEST / math.ulp(1.0) * frame.pixel:.0e} of 0 for pixels of {frame.pixel:g}, "
            f"found {frame.corner}; "
            "beyond, numbers of 64 bits have no places for the vertices. Move the mesh afterwards"
        )


def _is_lower(origin: object) -> bool:
    return isinstance(origin, str) and origin == "lower"


def _spacing(spacing: float | Sequence[float] | str | None, noted: Pair | None, source: str) -> Pair:
    if spacing is None:
        return 1.0, 1.0
    if isinstance(spacing, str):
        if spacing != "file":
            raise ParameterError(f"spacing: expected a number, a pair (dx, dy), 'file' or None, found {spacing!r}")
        if noted is None:
            raise ParameterError(f"spacing: 'file' expected a resolution with a unit in {source!r}, found none; give the size of a pixel")
        return noted
    dx, dy = _pair("spacing", spacing) if _is_sequence(spacing) else (spacing, spacing)
    size = finite("spacing", dx, above=0), finite("spacing", dy, above=0)
    if not 1e-100 <= min(size) <= max(size) <= 1e100:
        # Squares of lengths and their sums must be numbers too.
        raise ParameterError(f"spacing: expected numbers from 1e-100 to 1e100, found {shown(spacing)}; choose another unit")
    return size


def _corner(origin: str | Sequence[float]) -> tuple[Pair, bool]:
    if isinstance(origin, str) and origin in ("lower", "upper"):
        return (0.0, 0.0), origin == "lower"
    if not _is_sequence(origin):
        raise ParameterError(f"origin: expected 'lower', 'upper' or a pair (x, y), found {shown(origin)}")
    x, y = _pair("origin", origin)
    return (finite("origin", x), finite("origin", y)), True


def _is_sequence(value: object) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, (str, bytes)) and getattr(value, "ndim", 1) == 1


def _pair(name: str, value: Any) -> tuple[Any, Any]:
    if len(value) != 2:
        raise ParameterError(f"{name}: expected a pair of numbers, found {len(value)}: {shown(value)}")
    first, second = value
    return first, second
