"""What is known of the blocks of a mesh -> the report of a part, and of the whole."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from img2tri.options.all_options import plain
from img2tri.tiles.block_plan import Plan
from img2tri.tiles.seams.piece_seams import Piece, Sides
from img2tri.triangles.min_angle_tangents import smallest_angles

MOST_AREA_ERROR, FEW_PIXELS = 0.01, 16  # of the whole, but of no fewer pixels, as in the certificate of a mesh in memory
Figures = dict[str, Any]


def block_facts(piece: Piece, plan: Plan) -> Figures:
    """Count, and measure angles (degrees) and areas (world units) of the piece of a block, all its neighbours being there."""
    a, b, c = piece.vertices[piece.triangles].T
    area = ((b - a).conj() * (c - a)).imag / 2 * plan.frame.pixel**2
    angles = smallest_angles(piece.vertices, piece.triangles)
    labels, which = np.unique(piece.regions, return_inverse=True)
    return {
        "n_triangles": len(piece.triangles),
        "boundary_edges": len(Sides.of(piece.triangles, len(piece.vertices)).bare()[0]) - len(piece.seam),
        "smallest_angle": float(angles.min(initial=180.0)),
        "narrow": int((angles < plan.options["min_angle"] - 1e-9).sum()),
        "areas": dict(zip(labels.tolist(), np.bincount(which, area, len(labels)).tolist(), strict=True)),
    }


def added_up(blocks: Sequence[Figures]) -> Figures:
    """Add up what `block_facts` has found."""
    areas: dict[int, float] = {}
    for block in blocks:
        for label, area in block["areas"].items():
            areas[label] = areas.get(label, 0.0) + area
    sums = {name: sum(block[name] for block in blocks) for name in ("n_triangles", "boundary_edges", "narrow")}
    return sums | {"smallest_angle": min(block["smallest_angle"] for block in blocks), "areas": areas}


def whole_report(plan: Plan, source: str, blocks: Sequence[Figures], meshed: Sequence[Figures], vertices: int, seam_edges: int) -> Figures:
    """Add up what is known, compare the whole with the image, and warn of each promise that is not kept.

    Parameters
    ----------
    plan, source
        How the image was meshed, and its name.
    blocks, meshed
        What is known of each block, in order, as it was meshed and as it is in the whole; see `mesh_block` and `block_facts`.
    vertices, seam_edges
        Counts in the whole mesh.
    """
    of_mesh = added_up(meshed)
    report: Figures = {
        "options": plain(plan.options, field=plan.lengths),
        "level": plan.level,
        "source": source,
        "shape": plan.frame.shape,
        "frame": {name: getattr(plan.frame, name) for name in ("shape", "spacing", "corner", "upward")},
        "block": plan.block,
        "n_vertices": vertices,
        "seam_edges": seam_edges,
        "distance": max(block["distance"] for block in blocks) * plan.frame.pixel,
        "replaced": sum(block["replaced"] for block in blocks),
        **of_mesh,
    }
    pixels = sum(block["pixels"] for block in blocks)
    image, mesh = pixels * math.prod(plan.frame.spacing), sum(of_mesh["areas"].values())
    report["area"] = {"mesh": mesh, "image": image, "error": mesh / image - 1}
    if not plan.options["labels"]:
        # Components less holes: vertices - edges + triangles.
        edges = (3 * report["n_triangles"] + report["boundary_edges"]) // 2
        report["euler"] = {"mesh": vertices - edges + report["n_triangles"], "image": sum(block["euler"] for block in blocks)}
    return report | {"warnings": _warnings(report, plan, pixels)}


def _warnings(report: Figures, plan: Plan, pixels: int) -> list[str]:
    """One line for each promise that is not kept."""
    warnings = []
    if "euler" in report and report["euler"]["mesh"] != report["euler"]["image"]:
        warnings.append(f"components less holes: {report['euler']['mesh']}, expected {report['euler']['image']}")
    if report["distance"] > plan.options["tolerance"] * (1 + 1e-9):
        warnings.append(f"the mesh is {report['distance']:.4g} off the outlines, tolerance {plan.options['tolerance']:.4g}")
    if report["narrow"]:
        warnings.append(
            f"{report['narrow']} triangles below {plan.options['min_angle']:g} degrees, the worst {report['smallest_angle']:.4g}"
        )
    if abs(report["area"]["error"]) > MOST_AREA_ERROR and pixels > FEW_PIXELS:
        warnings.append(f"the area is off by {100 * report['area']['error']:.2g} %")
    return warnings
