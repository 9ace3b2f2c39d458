"""A solid of several regions in pyvista, turned with the mouse in a browser by trame.

    pip install trame trame-vtk trame-vuetify trame-pyvista
    python examples/12_solid_in_trame.py --serve

opens a page with the solid, each region in its colour, with its name; without ``--serve`` it only prints what there is to see.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import img2tri

DATA = Path(__file__).resolve().parent.parent / "data"


def main(out: str | Path = "out", *, serve: bool = False) -> dict[str, float]:
    """Make wedges of a part of the polycrystal; return how many, their volume, and that of the part."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    grains = np.asarray(Image.open(DATA / "polycrystal.png"))[:200, :200]
    mesh = img2tri.mesh_image(grains, labels=True, background=None, edge_length=12)
    solid = mesh.to_pyvista(height=30, solid=True, layers=3)
    solid.save(folder / "grains.vtu")
    if serve:
        view(solid)
    print(f"{solid.n_cells:,} wedges, {len(np.unique(solid['region']))} grains")
    return {"wedges": solid.n_cells, "grains": len(np.unique(solid["region"])), "volume": float(solid.volume), "wanted": 200.0 * 200 * 30}


def view(solid) -> None:
    """Serve a page with the solid until it is interrupted."""
    import pyvista
    from trame.app import get_server
    from trame.ui.vuetify3 import SinglePageLayout
    from trame_pyvista.ui import plotter_ui

    plotter = solid.img2tri.plot(pyvista.Plotter(off_screen=True))
    plotter.view_isometric()
    server = get_server(client_type="vue3")
    with SinglePageLayout(server) as layout, layout.content:
        plotter_ui(plotter)
    server.start()


if __name__ == "__main__":
    main(serve="--serve" in sys.argv)
