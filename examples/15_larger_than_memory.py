"""An image that stays on disk, meshed in parts by a small cluster of processes on this machine.

    python examples/15_larger_than_memory.py

A mask of 2500 x 2500 pixels is written to zarr block by block, as an instrument would. Two workers mesh it. The parts are
read back one by one, and as a whole.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import zarr
from distributed import Client, LocalCluster
from matplotlib.figure import Figure

from img2tri import mesh_tiles
from img2tri.tiles.parts.load_parts import load_tiles


def main(out: str | Path = "out") -> dict[str, float]:
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    mask = zarr.create_array(out / "mask.zarr", shape=(2500, 2500), chunks=(500, 500), dtype=bool, overwrite=True)
    for row in range(0, 2500, 500):
        y, x = np.mgrid[row : row + 500, 0:2500]
        mask[row : row + 500] = np.sin(x / 90) * np.sin(y / 110 + x / 400) > 0.2

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        made = mesh_tiles(out / "mask.zarr", out / "mesh.zarr", edge_length=30, client=client)
    print(f"{made.n_triangles:,} triangles in {made.n_parts} parts, {made.report['seam_edges']} edges on seams")
    print(f"the worst angle is {made.report['smallest_angle']:.1f} degrees; {made.report['warnings'] or 'every promise is kept'}")

    parts = zarr.open_group(made.path, mode="r")["parts"]
    in_parts = sum(part["triangles"].shape[0] for _, part in parts.groups())
    vertices, triangles, _ = load_tiles(made.path)
    figure = Figure(figsize=(8, 8))
    axes = figure.add_subplot(aspect="equal", title="the whole, read from its parts")
    axes.triplot(*vertices[:, :2].T, triangles, linewidth=0.3)
    figure.savefig(out / "mesh.png", dpi=130)
    return {
        "warnings": len(made.report["warnings"]),
        "in_parts": in_parts,
        "triangles": len(triangles),
        "vertices": len(vertices),
        "area_error": made.report["area"]["error"],
    }


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
