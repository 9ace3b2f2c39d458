"""``img2tri tiles``: its arguments, and one image larger than memory meshed in parts, by this process, by several, or on a Dask cluster."""

from __future__ import annotations

from argparse import Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from img2tri.cli.file_names import mesh_options
from img2tri.cli.option_arguments import add_mesh_options
from img2tri.cli.printing import Bar, complain, tell
from img2tri.errors import ParameterError, integer
from img2tri.options.parsing import whole_number

TILES = """Mesh one image larger than memory, in parts: zarr, .npy, HDF5 or tiled TIFF to
mesh.zarr, mesh.pvtu or mesh.vtkhdf. The mesh is the same whatever --tile and the
number of workers. A run that was stopped is continued by the same command.
Needs img2tri[dask].
"""


def add_tiles(commands: Any) -> None:
    """Add the command to those of the parser."""
    tiles = commands.add_parser(
        "tiles",
        help="mesh one image larger than memory",
        usage="img2tri tiles IMAGE -o MESH [options]",
        description=TILES,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    tiles.add_argument("image", metavar="IMAGE", help=".zarr, .npy, .h5 or .tif, one value per pixel")
    tiles.add_argument("-o", "--output", required=True, metavar="MESH", help=".zarr, .pvtu or .vtkhdf")
    tiles.add_argument("--tile", type=whole_number, default=2048, metavar="N", help="px of the image that a part covers (default 2048)")
    tiles.add_argument("--workers", type=whole_number, default=1, metavar="N", help="processes on this machine (default 1: this one)")
    tiles.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster, such as tcp://10.0.0.1:8786")
    tiles.add_argument("--plot", metavar="PICTURE", help="an overview of regions and worst angles, .png, .svg or .pdf")
    tiles.add_argument("--quiet", action="store_true", help="print errors only")
    add_mesh_options(tiles)


def run_tiles(arguments: Namespace) -> int:
    """Run ``img2tri tiles``; 0 is its exit status if all went well."""
    from img2tri.tiles.mesh_tiles import mesh_tiles

    workers = integer("workers", arguments.workers, least=1)
    with _client(workers, arguments.scheduler) as client, Bar([arguments.image], quiet=arguments.quiet) as bar:
        made = mesh_tiles(
            arguments.image, arguments.output, tile=arguments.tile, client=client, progress=partial(bar, 0), **mesh_options(arguments)
        )
    if arguments.plot:
        made.plot(arguments.plot)
    if not arguments.quiet:
        report = made.report
        tell(
            [
                f"{'triangles':<12}{made.n_triangles:,}, {made.n_vertices:,} vertices, {made.n_parts:,} parts",
                f"{'seams':<12}{report['seam_edges']:,} edges, all of them fit",
                f"{'angles':<12}{report['smallest_angle']:.4g} degrees at least",
                f"{'outlines':<12}{report['distance']:.4g} off at most",
                f"{'saved':<12}{', '.join(str(name) for name in (arguments.output, arguments.plot) if name)}",
            ]
        )
    for warning in made.report["warnings"]:
        complain(warning)
    return 0


@contextmanager
def _client(workers: int, scheduler: str | None) -> Iterator[Any]:
    """Make a client of a cluster that runs, of one of processes started here, or none."""
    if workers == 1 and scheduler is None:
        yield None
        return
    if workers > 1 and scheduler is not None:
        raise ParameterError("--workers: expected to be left out with --scheduler, whose workers are there already")
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise ParameterError("--workers: expected dask to be installed, found it missing; pip install 'img2tri[dask]'") from None
    if scheduler is not None:
        with Client(scheduler) as client:
            yield client
        return
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        yield client
