"""Our recipes against the paper's own listing, on the same image with the same parameters: ratios of times, and how times grow.

    pytest -m benchmark -s tests/benchmarks/test_listing.py

The listing needs about a minute here: it looks for the neighbours of each point among all triangles, ten times over.
"""

from __future__ import annotations

import time

import cv2
import numpy as np
import pytest
from benchmarks import listing
from benchmarks.shapes import blob

from img2tri.paper.contours import contour_polygon, external_contours
from img2tri.paper.poisson_disk import DISTANCE_PER_EDGE, poisson_disk
from img2tri.paper.structured_unstructured import paper_mesh, unstructured_mesh
from img2tri.types import Frame

pytestmark = pytest.mark.benchmark
EDGE = 8


def seconds(function, repeats=1):
    """What the function returns, and its shortest time."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        result = function()
        times.append(time.perf_counter() - start)
    return result, min(times)


def ours(mask, **options):
    return paper_mesh(mask, Frame(mask.shape), recipe="unstructured", edge_length=EDGE, iterations=10, **options)


def test_the_listing_is_a_thousand_times_slower(tmp_path):
    path = tmp_path / "blob.png"
    cv2.imwrite(str(path), blob(512) * np.uint8(255))
    _, binary = listing.read_image(str(path))
    # As many points inside as the listing still finds in good time: 85 in 100 of those that fit.
    full = unstructured_mesh(binary, edge_length=EDGE).counted
    (n_boundary,), n_interior = full["boundary_points"], round(0.85 * full["interior_points"][0])
    distance = DISTANCE_PER_EDGE * EDGE

    rng = np.random.default_rng(0)
    [(_, triangles, _)], theirs = seconds(lambda: listing.put_together(binary, n_boundary, n_interior, distance, distance, rng))
    same = {"n_boundary_points": n_boundary, "n_interior_points": n_interior}
    ours(binary, **same)
    made, mine = seconds(lambda: ours(binary, **same), repeats=7)
    _, whole = seconds(lambda: ours(binary), repeats=7)

    print(f"\nblob(512), edge length {EDGE}: {n_boundary} points on the contour, {n_interior} inside")
    print(f"  the listing          {theirs:9.3f} s   {len(triangles)} triangles")
    print(f"  ours, same points    {mine:9.4f} s   {len(made.triangles)} triangles   {theirs / mine:7.0f} times as fast")
    print(f"  ours, until full     {whole:9.4f} s   {theirs / whole:36.0f} times as fast")
    assert len(made.triangles) == pytest.approx(len(triangles), rel=0.02)
    assert theirs > 1000 * mine


def test_time_grows_with_the_number_of_triangles():
    print(f"\nunstructured, edge length {EDGE}, until full")
    per_triangle = []
    for n in (512, 1024, 2048, 4096):
        mask = blob(n)
        ours(mask)
        made, mine = seconds(lambda mask=mask: ours(mask), repeats=3)
        per_triangle.append(mine / len(made.triangles))
        print(f"  {n:5} x {n:<5} {len(made.triangles):8} triangles {mine:8.3f} s   {1e6 * per_triangle[-1]:6.2f} us per triangle")
    assert per_triangle[-1] < 2 * per_triangle[0]


def test_poisson_points_per_second():
    print("\npoisson_disk, until full")
    for n, edge in ((512, 8), (1024, 4), (2048, 3), (4096, 3)):
        (contour,) = external_contours(blob(n, holes=0))
        polygon, distance = contour_polygon(contour), DISTANCE_PER_EDGE * edge
        options = {"min_distance": distance, "min_distance_to_boundary": distance}
        points, mine = seconds(lambda p=polygon, c=contour, o=options: poisson_disk(p, c, **o), repeats=3)
        print(f"  {len(points):8} points {mine:8.3f} s   {len(points) / mine:10.0f} points per second")
    assert len(points) / mine > 100_000
