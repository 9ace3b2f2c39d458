"""One VTKHDF file into which any number of processes write at once, each in its own place.

HDF5 lets only one process write a file, unless all of it is built for MPI. But how long each array gets is known before any is written:
so a file is made with its arrays in one stretch each and not filled, and the bytes of each part are written at their offset in the file, as
into any other file. Which process writes what, and when, makes no difference to the bytes.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from img2tri.tiles.parts.tile_part import Part

TRIANGLE = 5  # VTK's number of this kind of cell
# Name: type, columns (0: no second axis), and of which of (parts, vertices, triangles) so many rows each.
LAYOUT: dict[str, tuple[type, int, str, int]] = {
    "Points": (np.float64, 3, "vertices", 1),
    "PointData/number": (np.int64, 0, "vertices", 1),
    "Connectivity": (np.int64, 0, "triangles", 3),
    "Types": (np.uint8, 0, "triangles", 1),
    "CellData/region": (np.int64, 0, "triangles", 1),
}


@dataclass(frozen=True)
class VtkhdfFile:
    """A file that is being written.

    Attributes
    ----------
    path
        Where it is.
    """

    path: Path

    def begin(self, sizes: Sequence[tuple[int, int]]) -> None:
        """Make a file with room for parts of so many vertices and triangles."""
        import h5py

        vertices, triangles = (np.array([size[k] for size in sizes], np.int64) for k in (0, 1))
        total = {"vertices": int(vertices.sum()), "triangles": int(triangles.sum())}
        with h5py.File(self.path, "w") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"] = (2, 0)
            root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
            for name, counts in {"NumberOfPoints": vertices, "NumberOfCells": triangles, "NumberOfConnectivityIds": 3 * triangles}.items():
                root.create_dataset(name, data=counts, track_times=False)
            for name, (dtype, columns, of, times) in LAYOUT.items():
                _reserved(root, name, (times * total[of], *([columns] if columns else [])), dtype)
            # Each part has one offset more than it has triangles.
            _reserved(root, "Offsets", (total["triangles"] + len(sizes),), np.int64)

    def write(self, part: Part, place: tuple[int, int, int]) -> None:
        """Write a part before which there are so many parts, vertices and triangles."""
        import h5py

        parts, vertices, triangles = place
        m = len(part.triangles)
        first = {"vertices": vertices, "triangles": triangles}
        values: dict[str, NDArray[Any]] = {
            "Points": np.concatenate([part.vertices, np.zeros((len(part.vertices), 1))], axis=1),
            "PointData/number": part.numbers,
            "Connectivity": part.triangles.ravel(),
            "Types": np.full(m, TRIANGLE),
            "CellData/region": part.regions,
        }
        with h5py.File(self.path, "r", locking=False) as file:
            at = {name: file["VTKHDF"][name].id.get_offset() for name in (*LAYOUT, "Offsets")}
        with open(self.path, "r+b") as out:
            for name, (dtype, columns, of, times) in LAYOUT.items():
                row = np.dtype(dtype).itemsize * max(1, columns)
                _write_at(out.fileno(), at[name] + row * times * first[of], values[name].astype(dtype))
            _write_at(out.fileno(), at["Offsets"] + 8 * (triangles + parts), np.arange(0, 3 * m + 1, 3, dtype=np.int64))

    def note(self, name: str, text: str) -> None:
        """Add a text to what is known of the whole."""
        import h5py

        with h5py.File(self.path, "r+") as file:
            file["VTKHDF"].attrs[name] = text


def _reserved(root: Any, name: str, shape: tuple[int, ...], dtype: type) -> None:
    """Make an array that has its place in the file but no values yet."""
    import h5py

    create = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    create.set_layout(h5py.h5d.CONTIGUOUS)
    create.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    create.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    create.set_obj_track_times(False)
    links = h5py.h5p.create(h5py.h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    h5py.h5d.create(root.id, name.encode(), h5py.h5t.py_create(np.dtype(dtype)), h5py.h5s.create_simple(shape), create, links)


def _write_at(file: int, offset: int, values: NDArray[Any]) -> None:
    """Write bytes into a file at a place, all of them."""
    data = memoryview(np.ascontiguousarray(values).tobytes())
    while len(data):
        done = os.pwrite(file, data, offset)
        data, offset = data[done:], offset + done
