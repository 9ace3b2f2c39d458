"""Many images: a stack of slices, meshed by the workers of a Dask cluster; needs ``img2tri[dask]``.

The cluster here is of two processes of this machine; with ``Client("tcp://scheduler:8786")`` it is any other. Without a client,
`mesh_images` takes processes of this machine, and needs no Dask.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import img2tri

SLICES, SPACING = 12, (0.2, 0.2, 0.5)  # mm: size of a pixel, and from slice to slice


def slices() -> np.ndarray:
    """Draw a ball with a hole through it, slice by slice; the last slice misses it."""
    z = (np.arange(SLICES) - 4.5) * SPACING[2]
    y, x = (np.mgrid[-40:40, -40:40] + 0.5) * SPACING[0]
    ball = x**2 + y**2 + z[:, None, None] ** 2 < 3.2**2
    return ball & (np.hypot(x, y) > 0.8)


def main(out: str | Path = "out") -> dict[str, float]:
    """Mesh all slices, and add up the volume of what they show."""
    from distributed import Client, LocalCluster

    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    volume, missed, heights = 0.0, [], []
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
        for name, mesh in img2tri.mesh_images(slices(), client=client, spacing=SPACING, edge_length=0.8):
            if isinstance(mesh, Exception):
                missed.append(name)
                print(f"slice {name}: {mesh}")
                continue
            area = sum(entry["mesh"] for entry in mesh.report.areas.values())
            volume += area * SPACING[2]
            heights.append(mesh.frame.z)
            mesh.save(folder / f"slice{name}.vtp")
            if len(heights) == 4:
                mesh.plot(None, folder / "slice.png")
            print(f"slice {name} at z = {mesh.frame.z:.1f} mm: {len(mesh.triangles)} triangles, {area:.2f} mm2")
    truth = 4 / 3 * np.pi * (3.2**2 - 0.8**2) ** 1.5  # a ball with a hole along its axis
    print(f"volume {volume:.1f} mm3, of the ball with its hole {truth:.1f}")
    return {"volume": volume, "truth": truth, "missed": len(missed), "top": max(heights)}


if __name__ == "__main__":
    main()
