"""A Labels layer of napari in, a mesh over it as a Surface layer out.

    pip install 'napari[pyside6]'
    python examples/13_labels_in_napari.py --show

paint on the layer, press M, and the mesh follows; without ``--show`` it only makes the layer's data.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import img2tri

DATA = Path(__file__).resolve().parent.parent / "data"


def surface(labels: np.ndarray, **options) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices (n, 2) as (row, column) of pixel centres, as napari has them, triangles, and the region of each vertex.

    A vertex on an interface is there once for each of its regions, so that colours do not run over it.
    """
    mesh = img2tri.mesh_image(labels, labels=True, **options)
    rows, columns = mesh.frame.row_column(mesh.vertices)
    pairs = np.stack([mesh.triangles, np.broadcast_to(mesh.regions[:, None], mesh.triangles.shape)], axis=-1).reshape(-1, 2)
    own, corner = np.unique(pairs, axis=0, return_inverse=True)
    places = np.stack([rows, columns], axis=1)[own[:, 0]] - 0.5  # pixel (0, 0) has its centre at (0, 0) there
    return places, corner.reshape(-1, 3), own[:, 1].astype(float)


def main(out: str | Path = "out", *, show: bool = False) -> dict[str, float]:
    """Mesh a part of the polycrystal; return how many triangles, and the area they cover."""
    Path(out).mkdir(parents=True, exist_ok=True)
    labels = np.asarray(Image.open(DATA / "polycrystal.png"))[:160, :240].astype(np.int32)
    vertices, triangles, regions = surface(labels, background=None, edge_length=10)
    if show:
        view(labels)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    areas = abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    print(f"{len(triangles):,} triangles over {len(np.unique(regions))} labels")
    return {"triangles": len(triangles), "area": float(areas.sum()), "pixels": labels.size, "regions": len(np.unique(regions))}


def view(labels: np.ndarray) -> None:
    """Show the labels; M meshes them as they are painted."""
    import napari

    viewer = napari.Viewer()
    layer = viewer.add_labels(labels, name="labels")

    @viewer.bind_key("m")
    def mesh(viewer) -> None:
        data = surface(layer.data, background=None, edge_length=10)
        if "mesh" in viewer.layers:
            viewer.layers["mesh"].data = data
        else:
            viewer.add_surface(data, name="mesh", colormap="turbo", opacity=0.6, shading="none")
        viewer.layers["mesh"].wireframe.visible = True

    mesh(viewer)
    napari.run()


if __name__ == "__main__":
    main(show="--show" in sys.argv)
