"""Many images -> their meshes, in order; the table of contents of this room."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Unpack, cast

from img2tri.errors import Img2triError, MeshError, ParameterError, finite
from img2tri.many.dask_cluster import Cluster
from img2tri.many.image_sources import OneImage, each_image
from img2tri.many.in_order import in_order
from img2tri.many.local_workers import Workers, local_workers
from img2tri.mesh import TriangleMesh
from img2tri.options.all_options import MeshOptions, checked
from img2tri.options.signature_docs import with_options
from img2tri.pipeline import mesh_image

if TYPE_CHECKING:
    from distributed import Client

Result = tuple[str, TriangleMesh | Exception]


@with_options
def mesh_images(
    images: Any,
    *,
    client: Client | None = None,
    workers: int | None = None,
    progress: Callable[[int], Any] | None = None,
    **options: Unpack[MeshOptions],
) -> Iterator[Result]:
    """Mesh many images: an iterator of (name, mesh), in order, several at a time.

    Images are taken and meshed only as far ahead as the workers need to be kept busy; small ones go in batches. A mesh is the same, bit for
    bit, wherever it is made. An image that cannot be meshed gives its error in place of a mesh, and does not stop the others. A worker
    that is lost costs a retry; an image that takes two with it gives a `MeshError`. Whoever stops iterating, or is interrupted, ends the
    work.

    Parameters
    ----------
    images
        Paths, folders, patterns such as ``"scans/*.png"``; arrays; a stack, of which each page or plane (first axis) is an image: a file of
        several pages, an array (n, h, w) or (n, h, w, 3 or 4), a zarr or dask array; a zarr group; a mapping or iterable of these.
    {options}
    client : distributed.Client | None, default None
        A Dask cluster, on whose workers images are meshed, and which must see the files; needs ``img2tri[dask]``. Workers with one thread
        each are best. None: processes of this machine.
    workers : int | None, default None
        So many processes of this machine; 1 is this process itself, where nothing needs to be pickled. None: one for each core.
    progress : callable | None, default None
        What is called with the number of images done.

    Yields
    ------
    name : str
        The path, followed by ``[page]`` in a file of several; the number of a plane or entry; the key of a mapping.
    mesh : TriangleMesh | Exception
        The mesh, or why there is none: an `Img2triError` or a MemoryError.

    Raises
    ------
    ParameterError
        If an option has a value it cannot have.

    Notes
    -----
    `spacing` may have three numbers (dx, dy, dz) for a stack: its planes lie dz apart, ``mesh.frame.z``, and so do files and objects made
    of the meshes. Other processes import the main module: a script that calls this needs ``if __name__ == "__main__":``.

    Examples
    --------
    >>> import numpy as np
    >>> stack = np.hypot(*np.mgrid[-20:20, -20:20]) < np.array([10, 0, 15])[:, None, None]
    >>> for name, mesh in mesh_images(stack, spacing=(1, 1, 2.5), edge_length=4, workers=1):
    ...     print(name, mesh if isinstance(mesh, Exception) else mesh.frame.z)
    0 0.0
    1 image: expected pixels to mesh, found none above the threshold 0.5 (mask); try another threshold=, or invert=True
    2 5.0
    """
    step, spacing = _step(options.get("spacing"))
    values = checked(options if step is None else cast(MeshOptions, options | {"spacing": spacing}), function="mesh_images")
    given = cast(MeshOptions, {name: value for name, value in values.items() if name in options})
    where: Workers = local_workers(workers) if client is None else _cluster(client, workers)
    if where.window > 1:
        _check_sent(given)
    ones = each_image(images, step=step, page=options.get("page"))
    return _meshes(partial(_meshed, given), ones, where, progress)


def _meshes(
    function: Callable[[OneImage], Result], ones: Iterator[OneImage], where: Workers, progress: Callable[[int], Any] | None
) -> Iterator[Result]:
    with closing(in_order(function, ones, where, lost=_lost, progress=progress)) as results:
        yield from results


def _meshed(options: MeshOptions, one: OneImage) -> Result:
    """Mesh one of many: what is run by workers."""
    try:
        mesh = mesh_image(one.image, **cast(MeshOptions, options | one.options))
    except (Img2triError, MemoryError) as error:
        return one.name, error
    return one.name, mesh if one.z is None else replace(mesh, frame=replace(mesh.frame, z=one.z))


def _lost(one: OneImage) -> Result:
    """Say what became of an image that took its worker with it."""
    return one.name, MeshError(f"{one.name}: the process that meshed it ended twice; if memory ran out, fewer workers need less")


def _step(spacing: Any) -> tuple[float | None, Any]:
    """Part the third number off a spacing of three."""
    if isinstance(spacing, (str, bytes)) or not isinstance(spacing, Sequence) or len(spacing) != 3:
        return None, spacing
    return finite("spacing", spacing[2], above=0), tuple(spacing[:2])


def _cluster(client: Client, workers: int | None) -> Workers:
    if workers is not None:
        raise ParameterError(f"workers: expected None with a client, whose cluster has its own, found {workers!r}")
    if not hasattr(client, "submit"):
        raise ParameterError(f"client: expected a distributed.Client, found {client!r}")
    return Cluster(client)


def _check_sent(options: MeshOptions) -> None:
    """Refuse options that cannot go to another process."""
    for name, value in options.items():
        try:
            pickle.dumps(value)
        except Exception as problem:
            raise ParameterError(
                f"{name}: expected what can be sent to other processes, found {type(value).__name__} ({problem}); workers=1 sends nothing"
            ) from problem
