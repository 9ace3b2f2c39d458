"""Smoothing by uniform and by cotangent weights, side by side: what each is good for, in two figures and two tables.

    python examples/04_smoothing.py

writes smoothing_inside.png and smoothing_boundary.png into out/.

1. The inside. A mesh fine along its boundary and coarse within. Uniform weights draw each vertex to the mean of its neighbours: the
   triangles get better, and every edge gets another length than it was given; unguarded, the worst angle falls. Cotangent weights leave a
   flat mesh exactly as it is, whatever its grading.
2. The boundary. A femur by the paper's recipe, its boundary running along the steps of the pixels. Uniform weights do not touch it.
   Cotangent weights with a free boundary round the steps off, no vertex going further than half a pixel, and the inside follows.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from img2tri import TriangleMesh, mesh_image
from img2tri.arrays import unique_edges
from img2tri.triangles.generate.constrained_delaunay import ruppert
from img2tri.triangles.tools.topology import boundary_edges

DATA = Path(__file__).resolve().parent.parent / "data"


def main(out: str | Path = "out") -> dict[str, float]:
    """Smooth two meshes in all ways; return the numbers of the tables."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)

    print("1  the inside: a graded mesh of the blob with holes, boundary fixed")
    blob = graded(mesh_image(DATA / "blob_with_holes.png"))
    uniform, cotangent = blob.smoothed("uniform"), blob.smoothed("cotangent")
    ways = {"as made": blob, "uniform": uniform, "unguarded": blob.smoothed("uniform", guard=False), "cotangent": cotangent}
    numbers = table(ways, blob, "blob")
    panels({"uniform weights": uniform, "cotangent weights": cotangent}, blob, (80, 220, 90, 220), folder / "smoothing_inside.png")

    print("\n2  the boundary: the femur by the paper's recipe, along the steps of the pixels")
    femur = mesh_image(DATA / "femur.png", recipe="unstructured", edge_length=5, smoothing="none")
    uniform = femur.smoothed("uniform")
    free = uniform.smoothed("cotangent", boundary="free", tolerance="0.5px")
    numbers |= table({"as made": femur, "uniform": uniform, "then free": free}, femur, "femur")
    ways = {"uniform weights": uniform, "then cotangent weights, boundary free": free}
    panels(ways, femur, (160, 230, 825, 890), folder / "smoothing_boundary.png")
    return numbers


def graded(mesh: TriangleMesh) -> TriangleMesh:
    """Fill the boundary of a mesh again, by no more triangles than angles of 30 degrees need: small ones along it, large ones within."""
    edges = boundary_edges(mesh.triangles)
    used, segments = np.unique(edges, return_inverse=True)
    inside, outside = np.ones(len(edges), int), np.zeros(len(edges), int)
    made = ruppert(mesh.vertices[used], segments.reshape(-1, 2), inside, outside, 30.0, 0.0)
    return TriangleMesh(made.vertices, made.triangles, made.regions)


def table(meshes: dict[str, TriangleMesh], first: TriangleMesh, name: str) -> dict[str, float]:
    """Print one line for each mesh; return the same numbers by name."""
    print(f"{'':12}{'mean q':>8}{'worst angle':>13}{'edges change by':>17}{'boundary moves':>16}{'boundary bends':>16}")
    numbers = {}
    for title, mesh in meshes.items():
        quality = mesh.quality().summary()
        row = {
            "mean_q": quality["q"]["mean"],
            "worst_angle": quality["min_angle"]["min"],
            "edge_factor": edge_factor(mesh, first),
            "boundary_move": float(np.linalg.norm(mesh.vertices - first.vertices, axis=1)[boundary_edges(mesh.triangles)].max()),
            "boundary_bend": bend(mesh),
        }
        print(f"{title:12}{row['mean_q']:8.3f}{row['worst_angle']:13.2f}{'x':>11}{row['edge_factor']:6.3f}", end="")
        print(f"{row['boundary_move']:13.2f} px{row['boundary_bend']:12.1f} deg")
        numbers |= {f"{name}_{title.replace(' ', '_')}_{key}": value for key, value in row.items()}
    return numbers


def edge_factor(mesh: TriangleMesh, first: TriangleMesh) -> float:
    """Return the factor by which an edge got longer or shorter, as a geometric mean over all."""
    edges = unique_edges(mesh.triangles)[0]
    before, after = (np.linalg.norm(np.diff(m.vertices[edges], axis=1)[:, 0], axis=1) for m in (first, mesh))
    return float(np.exp(np.abs(np.log(after / before)).mean()))


def bend(mesh: TriangleMesh) -> float:
    """Return the angle by which the boundary turns at half of its vertices at most, in degrees."""
    edges = boundary_edges(mesh.triangles)
    # The edge that goes on where this one ends; each vertex of the boundary starts one.
    following = edges[np.argsort(edges[:, 0])][np.searchsorted(np.sort(edges[:, 0]), edges[:, 1])]
    one, next_ = (np.diff(mesh.vertices[e], axis=1)[:, 0] @ [1, 1j] for e in (edges, following))
    return float(np.degrees(np.median(np.abs(np.angle(next_ / one)))))


def panels(meshes: dict[str, TriangleMesh], first: TriangleMesh, window: tuple[float, float, float, float], path: Path) -> None:
    """Draw a part of two meshes beside each other, over the mesh that both started from in gray."""
    left, right, bottom, top = window
    figure = Figure(figsize=(12, 6 * (top - bottom) / (right - left) + 0.5), layout="constrained")
    for axes, (title, mesh) in zip(figure.subplots(1, 2), meshes.items(), strict=True):
        axes.triplot(*first.vertices.T, first.triangles, color="0.75", linewidth=0.8)
        axes.triplot(*mesh.vertices.T, mesh.triangles, color="#c22", linewidth=0.8)
        axes.set(title=title, xlim=(left, right), ylim=(bottom, top), aspect="equal", xticks=[], yticks=[])
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
