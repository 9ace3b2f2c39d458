"""The pictures of the README: a femur with its mesh, a polycrystal by regions, and what an outline is beside the pixels it comes from.

    python examples/10_pictures_of_the_readme.py

draws them into data/pictures.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

import img2tri
from img2tri.views.figures.region_colours import palette

DATA = Path(__file__).resolve().parent.parent / "data"
DPI, COLOURS = 144, 128  # few colours make small files
INK, WARM = "#12324f", "#f28e1c"


def lines(mesh: img2tri.TriangleMesh) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return all edges (k, 2) of a mesh, each once, and which of them lie between two regions or on the boundary."""
    ends = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, which = np.unique(ends, axis=0, return_inverse=True)
    region = np.repeat(mesh.regions, 3)
    low, high = np.full(len(edges), region.max() + 1), np.full(len(edges), region.min() - 1)
    np.minimum.at(low, which, region)
    np.maximum.at(high, which, region)
    return edges, (low != high) | (np.bincount(which) == 1)


def panel(figure: Figure, place: tuple[float, float, float, float], window: tuple[float, float, float, float]) -> Axes:
    """Return a part of the figure that shows (left, bottom, right, top) of the world."""
    axes = figure.add_axes(place)
    axes.set(xlim=window[::2], ylim=window[1::2], aspect="equal", xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set_visible(False)
    return axes


def draw_lines(axes: Axes, mesh: img2tri.TriangleMesh, *, thin: float, thick: float, inner: str, outer: str) -> None:
    """Draw thin edges inside regions, thick ones between them and on the boundary."""
    edges, outlines = lines(mesh)
    ends = mesh.vertices[edges]
    axes.add_collection(LineCollection(ends[~outlines], colors=inner, linewidths=thin, capstyle="round"))
    axes.add_collection(LineCollection(ends[outlines], colors=outer, linewidths=thick, capstyle="round"))


def under(axes: Axes, image: NDArray[np.uint8], **options) -> None:
    """Draw an image where its mesh lies."""
    h, w = image.shape[:2]
    axes.imshow(image, extent=(0, w, 0, h), interpolation="nearest", **options)


def femur() -> Figure:
    """Draw a femur lying: on the left the image as it is, to the right its mesh over it, fine along the outline."""
    image = np.rot90(np.asarray(Image.open(DATA / "femur_gray.png")), 3)
    h, w = image.shape
    mesh = img2tri.mesh_image(image, edge_length=16, boundary_edge_length=7, gradation=0.25)
    figure = Figure(figsize=(8.8, 8.8 * h / w), facecolor="black")
    axes = panel(figure, (0, 0, 1, 1), (0, 0, w, h))
    under(axes, image, cmap="gray", vmin=0, vmax=255)
    edges, outlines = lines(mesh)
    ends = mesh.vertices[edges]
    shown = np.clip((ends[..., 0].mean(axis=1) / w - 0.16) / 0.22, 0, 1)[:, None]
    for part, colour, width in ((~outlines, (0.03, 0.22, 0.42), 0.75), (outlines, (0.98, 0.58, 0.12), 1.5)):
        colours = np.hstack([np.tile(colour, (part.sum(), 1)), shown[part]])
        axes.add_collection(LineCollection(ends[part], colors=colours, linewidths=width, capstyle="round"))
    return figure


def polycrystal() -> Figure:
    """Draw all grains, and some from near: neighbours have their interface in common, and it runs between their pixels."""
    image = np.asarray(Image.open(DATA / "polycrystal.png"))
    h, w = image.shape
    mesh = img2tri.mesh_image(image, labels=True, background=None, edge_length=13)
    shades = palette(int(image.max()) + 1)
    near = (108.0, 158.0, 168.0, 218.0)
    figure = Figure(figsize=(8.8, 4.36), facecolor="white")
    for place, window, thin, thick in (
        ((0.004, 0.008, 0.488, 0.984), (0, 0, w, h), 0.35, 1.5),
        ((0.508, 0.008, 0.488, 0.984), near, 0.9, 2.2),
    ):
        axes = panel(figure, place, window)
        under(axes, shades[image])
        draw_lines(axes, mesh, thin=thin, thick=thick, inner="#ffffff", outer=INK)
    return figure


def outlines() -> Figure:
    """Draw teeth of a gear from near: along the sides of pixels, and as it is by default."""
    image = np.asarray(Image.open(DATA / "gear.png"))
    window = (250.0, 188.0, 310.0, 228.0)
    figure = Figure(figsize=(8.8, 3.2), facecolor="white")
    for left, title, options in (
        (0.004, 'outline="pixel"', {"outline": "pixel", "edge_length": 6}),
        (0.508, "by default", {"edge_length": 6}),
    ):
        axes = panel(figure, (left, 0.01, 0.488, 0.9), window)
        under(axes, np.where(image[..., None] > 0, np.array([236, 226, 208]), np.array([120, 132, 146])).astype(np.uint8))
        draw_lines(axes, img2tri.mesh_image(image, **options), thin=0.8, thick=2.6, inner=INK, outer=WARM)
        axes.set_title(title, fontsize=10, family="monospace" if "=" in title else None, pad=5)
    return figure


def saved(figure: Figure, path: Path) -> None:
    """Write a picture in few colours."""
    file = io.BytesIO()
    figure.savefig(file, dpi=DPI, facecolor=figure.get_facecolor())
    Image.open(file).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def main(out: str | Path = DATA / "pictures") -> dict[str, int]:
    """Draw all pictures; return the size of each file."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    sizes = {}
    for draw in (femur, polycrystal, outlines):
        path = folder / f"{draw.__name__}.png"
        saved(draw(), path)
        sizes[path.name] = path.stat().st_size
        print(f"{path.name:20s} {sizes[path.name]:7d} bytes")
    return sizes


if __name__ == "__main__":
    main()
