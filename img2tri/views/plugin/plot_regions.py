"""Regions in pyvista, each in a colour of its own and with its name: a dataset with the cell array "region" -> a plot with a legend.

Colours are those the image has for its labels, else those of img2tri's figures and files. With more regions than a legend can hold, only
colours are shown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.errors import MeshError
from img2tri.views.figures.region_colours import region_colours
from img2tri.views.plugin.dataset_to_cells import written_about
from img2tri.views.plugin.slices import VIEWS, normal_of

if TYPE_CHECKING:
    import pyvista

_LEGEND = 12


def plot_regions(dataset: Any, plotter: pyvista.Plotter | None = None, **options: Any) -> Any:
    """Plot a dataset by its regions.

    Parameters
    ----------
    dataset
        With the cell array "region", as `TriangleMesh.to_pyvista` makes it; names are taken from its field data.
    plotter
        To add it to; None makes one and shows it.
    **options
        Of ``pyvista.Plotter.add_mesh``; edges are shown unless ``show_edges=False``.

    Returns
    -------
    Any
        The plotter that was given; or what ``show`` of the new one returns.

    Raises
    ------
    MeshError
        If there is no cell array "region".
    """
    import pyvista

    if "region" not in dataset.cell_data:
        raise MeshError(f"region: expected this cell array, found {', '.join(dataset.cell_data.keys()) or 'none'}")
    labels, index = np.unique(dataset.cell_data["region"], return_inverse=True)
    about = written_about(dataset)
    names, known = about.get("names", {}), {int(label): colour for label, colour in about.get("colours", {}).items()}
    colours = np.array(region_colours(labels.tolist(), known), np.uint8)
    copy = dataset.copy(deep=False)
    copy.cell_data["region_rgb"] = colours[index]
    axis = normal_of(np.asarray(dataset.points))
    flat = np.ptp(np.asarray(dataset.points)[:, axis]) == 0
    shown = pyvista.Plotter() if plotter is None else plotter
    shown.add_mesh(copy, **{"scalars": "region_rgb", "rgb": True, "show_edges": True, "edge_opacity": 0.4, "lighting": not flat, **options})
    if len(labels) <= _LEGEND:
        entries = [(str(names.get(str(label), f"region {label}")), colour / 255) for label, colour in zip(labels, colours, strict=True)]
        shown.add_legend(entries, face="rectangle", bcolor=None, size=(0.2, 0.04 * len(entries)), loc="upper right")  # type: ignore[arg-type]
    if plotter is not None:
        return plotter
    if flat:
        getattr(shown, VIEWS[axis])()
    return shown.show()
