"""The moving picture of the README: an image, its outlines, and triangles that fill them.

    python examples/11_animation_of_the_readme.py

draws it into data/pictures.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

import img2tri

DATA = Path(__file__).resolve().parent.parent / "data"
WIDTH, DPI, COLOURS = 7.6, 96, 96  # inches; few colours make a small file
HELD, TRACED, FILLED = 5, 12, 22  # frames of each part
PACE, REST = 70, 2600  # ms of a frame, and of the last one


def order_along_outlines(mesh: img2tri.TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the edges (k, 2, 2) of the boundary, and when each is drawn, 0 to 1: from the left to the right."""
    ends = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(ends, axis=0, return_counts=True)
    lines = mesh.vertices[edges[counts == 1]]
    x = lines[..., 0].mean(axis=1)
    return lines, (x - x.min()) / np.ptp(x)


def frames(image: NDArray[np.uint8], mesh: img2tri.TriangleMesh) -> list[Image.Image]:
    """Draw all frames."""
    h, w = image.shape
    figure = Figure(figsize=(WIDTH, WIDTH * h / w), facecolor="black")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, w), ylim=(0, h), aspect="equal")
    axes.axis("off")
    axes.imshow(image, extent=(0, w, 0, h), cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    q = mesh.quality().arrays["q"]
    corners = mesh.vertices[mesh.triangles]
    triangles = PolyCollection(corners, array=q, cmap="viridis", clim=(0.6, 1.02), edgecolors="#10233a", linewidths=0.35)
    lines, moment = order_along_outlines(mesh)
    outline = LineCollection(lines, colors="#ffb347", linewidths=1.6, capstyle="round")
    axes.add_collection(triangles)
    axes.add_collection(outline)
    middle = corners[..., 0].mean(axis=1)
    place = (middle - middle.min()) / np.ptp(middle)

    found = []
    for frame in range(HELD + TRACED + FILLED + 1):
        traced = np.clip((frame - HELD) / TRACED, 0, 1)
        filled = np.clip((frame - HELD - TRACED) / FILLED, 0, 1)
        outline.set_alpha((moment < traced).astype(float))
        # A triangle comes up over a sixth of the way, so that the front of them is soft.
        triangles.set_alpha(np.clip((1.17 * filled - place) / 0.17, 0, 0.93))
        file = io.BytesIO()
        figure.savefig(file, format="png", dpi=DPI)
        found.append(Image.open(file).convert("RGB"))
    return found


def main(out: str | Path = DATA / "pictures") -> dict[str, int]:
    """Draw the animation; return its number of frames and its size in bytes."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    with Image.open(DATA / "femur_gray.png") as read:
        image = np.rot90(np.asarray(read), 3)
    mesh = img2tri.mesh_image(image, edge_length=15, boundary_edge_length=8, gradation=0.25)
    drawn = frames(image, mesh)
    # One palette for all: the first frames have the grays, the last ones the colours.
    both = Image.fromarray(np.vstack([drawn[0], drawn[HELD + TRACED], drawn[-1]]))
    palette = both.quantize(COLOURS, dither=Image.Dither.NONE)
    first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in drawn)
    times = [PACE] * len(others) + [REST]
    path = folder / "image_to_mesh.gif"
    first.save(path, save_all=True, append_images=others, duration=times, loop=0, optimize=True, disposal=1)
    print(f"{path.name:20s} {path.stat().st_size:7d} bytes")
    with Image.open(path) as read:
        return {"frames": read.n_frames, "bytes": path.stat().st_size}  # frames that are alike have become one


if __name__ == "__main__":
    main()
