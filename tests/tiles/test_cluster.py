"""An image by tiles on a Dask cluster of real processes: the same bytes, and a worker that dies costs a retry."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest
from scipy import ndimage

from img2tri import mesh_tiles
from img2tri.tiles.parts.load_parts import load_tiles

distributed = pytest.importorskip("distributed")


@pytest.mark.filterwarnings("ignore")
def test_two_workers_of_which_one_is_killed_give_the_same_bytes(tmp_path):
    mask = ndimage.gaussian_filter(np.random.default_rng(0).standard_normal((600, 4500)), 12) > 0.1
    np.save(tmp_path / "mask.npy", mask)
    alone = mesh_tiles(tmp_path / "mask.npy", tmp_path / "alone.zarr", edge_length=12.0)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path / "dask") as cluster,
        distributed.Client(cluster) as client,
    ):
        killed = []

        def kill(stage, _):
            if stage == "mesh" and not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        both = mesh_tiles(tmp_path / "mask.npy", tmp_path / "both.zarr", edge_length=12.0, client=client, progress=kill)
    assert killed
    assert both.n_triangles == alone.n_triangles
    one, other = load_tiles(alone.path), load_tiles(both.path)
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))
