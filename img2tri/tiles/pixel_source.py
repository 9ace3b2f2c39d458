"""Where pixels come from: anything with a shape, a type, and slices, read window by window.

A path is opened anew by each worker: zarr and OME-Zarr (its finest level), HDF5, ``.npy`` by memory map, and TIFF by tifffile. So no pixel
crosses the network but from where it is stored to where it is needed.
"""

from __future__ import annotations

import hashlib
import os
import weakref
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools
from img2tri.errors import FileError, ImageError, ParameterError, shown
from img2tri.raster.metadata.nodata import GDAL_NODATA, either, gdal_nodata, present

SOURCE_SUFFIXES = (".zarr", ".npy", ".h5", ".hdf5", ".tif", ".tiff")


@dataclass(frozen=True)
class PixelSource:
    """An image that is read window by window.

    Attributes
    ----------
    given
        A path, or an array with ``shape``, ``dtype`` and slicing.
    box
        First row and column, rows and columns of the part that is the image; None: all.
    """

    given: Any
    box: tuple[int, int, int, int] | None = None

    def __getstate__(self) -> dict[str, Any]:
        return {"given": self.given, "box": self.box}

    @cached_property
    def array(self) -> Any:
        """What is sliced."""
        return _opened(Path(self.given)) if isinstance(self.given, (str, os.PathLike)) else self.given

    @property
    def name(self) -> str:
        """For people."""
        return str(self.given) if isinstance(self.given, (str, os.PathLike)) else "array"

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w)."""
        return (int(self.array.shape[0]), int(self.array.shape[1])) if self.box is None else self.box[2:]

    @property
    def channels(self) -> int:
        """How many values a pixel has."""
        return int(self.array.shape[2]) if len(self.array.shape) == 3 else 1

    def read(self, rows: slice, columns: slice) -> tuple[NDArray[Any], Bools | None]:
        """Read a window: its values, and which pixels (h, w) are not there, NaN, masked or "no data"; None: all are.

        Raises
        ------
        FileError
            If it cannot be read, or is not what the shape says; it names the rows and columns.
        """
        where = f"rows {rows.start} to {rows.stop}, columns {columns.start} to {columns.stop}"
        expected = (rows.stop - rows.start, columns.stop - columns.start, *self.array.shape[2:])
        top, left = (0, 0) if self.box is None else self.box[:2]
        try:
            found = self.array[slice(top + rows.start, top + rows.stop), slice(left + columns.start, left + columns.stop)]
            values, missing = present(found if hasattr(found, "mask") else np.ascontiguousarray(found))
        except Exception as problem:  # whatever a store raises, it is this window that cannot be read
            raise FileError(f"{self.name}: {where}: cannot be read: {type(problem).__name__}: {problem}") from problem
        if values.shape != expected:
            raise FileError(f"{self.name}: {where}: expected pixels of shape {expected}, as its own shape says, found {values.shape}")
        noted = getattr(self.array, "nodata", None)
        return values, either(missing, gdal_nodata({GDAL_NODATA: noted}, values))


def digest(values: NDArray[Any], missing: Bools | None) -> str:
    """Return a hash of pixels."""
    found = hashlib.blake2b(values.tobytes(), digest_size=16)
    found.update(b"" if missing is None else missing.tobytes())
    return found.hexdigest()


def open_source(given: Any) -> PixelSource:
    """Open an image, and check that it is one of one value per pixel, or of colours.

    Raises
    ------
    FileError, ImageError, ParameterError
        If there is no such file, or it is no such image.

    Examples
    --------
    >>> open_source(np.zeros((3, 4), bool)).shape
    (3, 4)
    """
    if isinstance(given, PixelSource):
        return given
    if not isinstance(given, (str, os.PathLike)) and not all(hasattr(given, name) for name in ("shape", "dtype", "__getitem__")):
        raise ParameterError(f"source: expected a path, or an array with shape, dtype and slicing, found {shown(given)}")
    source = PixelSource(given)
    shape, dtype = tuple(source.array.shape), np.dtype(source.array.dtype)
    if len(shape) not in (2, 3) or (len(shape) == 3 and shape[2] != 3) or 0 in shape:
        raise ImageError(
            f"{source.name}: expected an image (h, w) of one value per pixel, or (h, w, 3) of colours, found shape {shape}; "
            "give one plane or channel, or the colours without alpha"
        )
    if dtype.kind not in "biuf":
        raise ImageError(f"{source.name}: expected bool, integers or floats, found {dtype}")
    return source


def _opened(path: Path) -> Any:
    suffix = path.suffix.lower()
    if suffix not in SOURCE_SUFFIXES:
        raise FileError(f"{path}: expected a name that ends in {', '.join(SOURCE_SUFFIXES)}, found {suffix or 'none'!r}; or give an array")
    if not path.exists():
        raise FileError(f"{path}: no such file")
    try:
        return _READERS.get(suffix, _tiff)(path)
    except ImportError as problem:
        raise FileError(f"{path}: needs {problem.name}; pip install {problem.name}") from problem
    except FileError:
        raise
    except Exception as problem:  # whatever the reader of a format raises
        raise FileError(f"{path}: cannot be read: {type(problem).__name__}: {problem}") from problem


def _zarr(path: Path) -> Any:
    import zarr

    node: Any = zarr.open(path, mode="r")
    while not hasattr(node, "dtype"):
        # OME-Zarr names its levels, the finest first.
        attributes = dict(node.attrs)
        scales = attributes.get("ome", attributes).get("multiscales")
        names = [scales[0]["datasets"][0]["path"]] if scales else sorted(node.array_keys())
        if len(names) != 1:
            raise FileError(f"{path}: expected one array, found {names}; give the path of one")
        node = node[names[0]]
    return _Plane(node)


def _hdf5(path: Path) -> Any:
    import h5py

    found: list[Any] = []
    file = h5py.File(path, "r")
    file.visititems(lambda _, node: found.append(node) if hasattr(node, "dtype") and node.ndim == 2 else None)
    if len(found) != 1:
        raise FileError(f"{path}: expected one data set (h, w), found {[node.name for node in found]}; open it with h5py and give that")
    return found[0]


def _npy(path: Path) -> Any:
    return np.load(path, mmap_mode="r")


def _tiff(path: Path) -> Any:
    import tifffile
    import zarr

    with tifffile.TiffFile(path) as file:
        tag = file.pages[0].tags.get(GDAL_NODATA)  # type: ignore[union-attr]
        colours = file.pages[0].samplesperpixel > 1  # type: ignore[union-attr]
    store: Any = tifffile.imread(path, aszarr=True, level=0)
    plane = _Plane(zarr.open(store, mode="r"), colours, None if tag is None else str(tag.value))
    weakref.finalize(plane, store.close)
    return plane


@dataclass(frozen=True)
class _Plane:
    """The last two axes of an array whose others have length 1, or three with colours."""

    node: Any
    colours: bool = False
    nodata: str | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        shape, last = tuple(self.node.shape), 3 if self.colours else 2
        return shape[-last:] if all(n == 1 for n in shape[:-last]) else shape

    @property
    def dtype(self) -> Any:
        return self.node.dtype

    def __getitem__(self, window: tuple[slice, slice]) -> Any:
        return self.node[(0,) * (len(self.node.shape) - len(self.shape)) + window]


_READERS = {".zarr": _zarr, ".npy": _npy, ".h5": _hdf5, ".hdf5": _hdf5}
