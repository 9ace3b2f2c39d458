"""The paper, step by step: each section by the function that does it, figures 1 to 3, and the trade-off of section IV as a table.

    python examples/02_paper_step_by_step.py

writes figure_1.png to figure_3.png and two structured ones into out/, and prints what each step made. The recipes "structured" and
"unstructured" of `img2tri.mesh_image` do the same in one call.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from img2tri.paper.boundary_points import arc_length_samples
from img2tri.paper.contours import contour_polygon, external_contours
from img2tri.paper.delaunay import centroid_filter, delaunay
from img2tri.paper.grid import mask_filter, structured_grid
from img2tri.paper.poisson_disk import DISTANCE_PER_EDGE, poisson_disk
from img2tri.paper.structured_unstructured import structured_mesh, unstructured_mesh
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.otsu_threshold import binarize
from img2tri.raster.reading import read
from img2tri.triangles.tools.laplacian_smoothing import uniform
from img2tri.triangles.tools.quality_summary import assess
from img2tri.triangles.tools.topology import adjacency
from img2tri.types import Frame
from img2tri.views.figures.plot import draw

DATA = Path(__file__).resolve().parent.parent / "data"
THRESHOLD = 240  # the paper's T
STEP = 10  # the paper's grid, in pixels
EDGE = 10  # px, for the unstructured mesh: as fine as the grid


def main(out: str | Path = "out") -> dict[str, float]:
    """Walk the paper; return the numbers it ends with."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)

    print("II-A, III-A  read the image; white is what is brighter than T = 240")
    blobs = read(DATA / "blobs.png")
    white, _ = binarize(to_gray(blobs.values), threshold=THRESHOLD)
    print(f"  blobs.png: {white.shape[1]} x {white.shape[0]} pixels, {white.sum()} of them white")

    # The paper's figures 1 and 2 have one shape each.
    first, second = white[:, :245], white[:165, 240:]
    structured = walk_structured(first, folder / "figure_1_structured.png")
    unstructured = walk_unstructured(first, folder / "figure_1.png")

    print("\nFigures 2 and 3  the same for another shape, and for a femur")
    bone, _ = binarize(to_gray(read(DATA / "femur.png").values), threshold=THRESHOLD)
    for name, mask in (("figure_2", second), ("figure_3", bone)):
        mesh = unstructured_mesh(mask, edge_length=EDGE)
        smooth = uniform(mesh.points, mesh.triangles, iterations=10, fixed=mesh.fixed)
        figure(smooth, mesh.triangles, mask, folder / f"{name}.png")
    grid = structured_mesh(bone, step=STEP)
    figure(grid.points, grid.triangles, bone, folder / "figure_3_structured.png")

    return structured | unstructured | compare(bone) | thresholds()


def walk_structured(mask: np.ndarray, path: Path) -> dict[str, float]:
    """Sections II-B, III-B and III-D."""
    print("\nII-B, III-B  structured grid")
    grid = structured_grid(mask.shape, step=STEP)
    points = mask_filter(grid, mask)
    print(f"  {len(grid)} points {STEP} pixels apart, {len(points)} of them on white pixels")

    print("II-D, II-E  Delaunay, and the triangles whose centroid is inside")
    polygon = contour_polygon(external_contours(mask)[0])
    hull = delaunay(points)
    triangles = centroid_filter(points, hull, polygon)
    print(f"  {len(hull)} triangles, {len(triangles)} inside")
    figure(points, triangles, mask, path)
    return {"grid_points": len(grid), "points_on_white": len(points), "structured_triangles": len(triangles)}


def walk_unstructured(mask: np.ndarray, path: Path) -> dict[str, float]:
    """Sections II-C to II-E and III-C to III-E."""
    print("\nII-C, III-C  unstructured: the contour, points along it, points inside")
    (contour,) = external_contours(mask)
    polygon = contour_polygon(contour)
    boundary = arc_length_samples(contour, round(polygon.length / EDGE))
    distance = DISTANCE_PER_EDGE * EDGE
    interior = poisson_disk(polygon, boundary, min_distance=distance, min_distance_to_boundary=distance)
    print(f"  contour of {len(contour)} corners, {polygon.length:.0f} pixels long: {len(boundary)} points along it")
    print(f"  {len(interior)} points inside, more than {distance:g} pixels apart; no more fit")

    print("II-D, II-E  Delaunay, and the triangles whose centroid is inside")
    points = np.concatenate([boundary, interior])
    hull = delaunay(points)
    triangles = centroid_filter(points, hull, polygon)
    print(f"  {len(hull)} triangles, {len(triangles)} inside")

    print("II-E, III-E  Laplacian smoothing, 10 times: each point inside to the mean of its neighbours")
    neighbours = adjacency(triangles, len(points))
    fixed = np.arange(len(points)) < len(boundary)
    smooth = uniform(points, triangles, iterations=10, fixed=fixed)
    before, after = (assess(p, triangles, ["q", "min_angle"]).summary() for p in (points, smooth))
    print(f"  {neighbours.nnz / len(points):.2f} neighbours on average")
    print(f"  mean q {before['q']['mean']:.3f} -> {after['q']['mean']:.3f}")
    print(f"  worst 1 % of the smallest angles {before['min_angle']['p1']:.1f} -> {after['min_angle']['p1']:.1f} degrees")
    figure(smooth, triangles, mask, path)
    return {"boundary_points": len(boundary), "interior_points": len(interior), "unstructured_triangles": len(triangles)} | {
        "q_before_smoothing": before["q"]["mean"],
        "q_after_smoothing": after["q"]["mean"],
    }


def figure(points: np.ndarray, triangles: np.ndarray, mask: np.ndarray, path: Path) -> None:
    """Draw the mesh in red over its image, as the paper's figures do."""
    # The paper counts rows and columns, with whole numbers at the centres of pixels; in the world y points up.
    frame = Frame(mask.shape)
    vertices = frame.xy(points[:, 1] + 0.5, points[:, 0] + 0.5)
    draw(vertices, triangles[:, ::-1], frame=frame, image=mask, path=path)


HEAD = f"{'':16}{'triangles':>10}{'mean q':>9}{'1 % angle':>11}{'worst':>8}{'area':>10}{'time':>10}"


def compare(mask: np.ndarray) -> dict[str, float]:
    """Section IV: structured against unstructured, from coarse to fine."""
    print("\nIV  the femur: grid step, or edge length, against quality, number of triangles and time")
    print(HEAD)
    numbers = {}
    for length in (20, 10, 5):
        for recipe in ("structured", "unstructured"):
            row = measured(mask, recipe, length)
            print(line(f"{recipe} {length}", row))
            numbers |= {f"femur_{recipe}_{length}_{key}": value for key, value in row.items() if key != "ms"}
    return numbers


def thresholds() -> dict[str, float]:
    """Section IV: what the threshold does, on a femur in levels of gray: marrow 70, trabecular bone 150, cortical bone 230."""
    print("\nIV  the gray femur: the threshold decides what the white zone is; holes in it are filled")
    print(HEAD)
    gray = to_gray(read(DATA / "femur_gray.png").values)
    numbers = {}
    for threshold in (35, 110, 190):
        mask, _ = binarize(gray, threshold=threshold)
        for recipe in ("structured", "unstructured"):
            row = measured(mask, recipe, 10)
            print(line(f"{recipe} T={threshold}", row))
            numbers |= {f"threshold_{threshold}_{recipe}_area_error": row["area_error"]}
    return numbers


def measured(mask: np.ndarray, recipe: str, length: float) -> dict[str, float]:
    """Mesh a mask and judge the mesh; the area is compared with that of the white pixels."""
    start = time.perf_counter()
    if recipe == "structured":
        mesh = structured_mesh(mask, step=length)
        points = mesh.points
    else:
        mesh = unstructured_mesh(mask, edge_length=length)
        points = uniform(mesh.points, mesh.triangles, iterations=10, fixed=mesh.fixed)
    seconds = time.perf_counter() - start
    quality = assess(points, mesh.triangles, ["q", "min_angle", "area"])
    summary = quality.summary()
    return {
        "triangles": len(mesh.triangles),
        "q": summary["q"]["mean"],
        "p1_angle": summary["min_angle"]["p1"],
        "worst_angle": summary["min_angle"]["min"],
        "area_error": float(quality.arrays["area"].sum() / mask.sum() - 1),
        "ms": 1e3 * seconds,
    }


def line(name: str, row: dict[str, float]) -> str:
    """One line of the table."""
    angles = f"{row['p1_angle']:>11.1f}{row['worst_angle']:>8.1f}"
    return f"{name:18}{row['triangles']:>8}{row['q']:>9.3f}{angles}{100 * row['area_error']:>8.1f} %{row['ms']:>7.1f} ms"


if __name__ == "__main__":
    main()
