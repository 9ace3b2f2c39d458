"""The certificate: what a finished mesh keeps of what was promised, in numbers.

In: the finished mesh and its `Provenance`. Out: a `Report`. Nothing is taken over from the making of the mesh: distances, areas,
topology and angles are measured on its triangles, and compared with the outlines and the pixels of the image.

Lengths in a report are world units, angles degrees, areas world units squared.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from img2tri.arrays import Floats, Ints
from img2tri.certificate.edge_sides import EdgeSides
from img2tri.certificate.min_angle_check import angles_below
from img2tri.certificate.outline_distance import SegmentSet, hausdorff, wrong_pixels
from img2tri.certificate.region_areas import AREA_TOLERANCE, displaced, moments, region_areas, region_numbers, regions_off
from img2tri.certificate.topology_and_defects import DEFECTS, defects, neighbours, topology
from img2tri.types import Frame, Provenance

PLACES = 20  # listed at most
PRINTED = 5  # warnings and notes in a report as it is printed


@dataclass(frozen=True)
class Report:
    """What a mesh keeps of what was promised.

    Attributes
    ----------
    recipe, options
        How the mesh was made: all options as plain data, with which ``mesh_image(image, **options)`` makes it again. Of edge lengths
        given as an array or a function there is only the hash of their grid.
    settings, counted
        The options with what was chosen where they leave the choice; what was counted on the way.
    n_vertices, n_triangles
        Counts.
    hausdorff, hausdorff_at, tolerance
        Two-sided distance between the outlines and the boundary and interface edges of the mesh, where, and what it may be.
    areas
        For each label the area in the mesh and in the image, and the relative error.
    areas_off
        Places of the labels of more than 16 pixels whose area is off by more than 1 %; empty where that is not promised: by the
        recipes of the paper, and with ``keep_area=False``.
    displaced
        Labels whose triangles lie elsewhere than their pixels.
    topology
        For each label (components, holes) as found in the mesh and as expected from the image.
    unknown_labels
        Labels of the mesh that the image does not have.
    neighbours_missing, neighbours_extra
        Pairs of labels that touch in the image but not in the mesh, and the other way round.
    wrong_pixels, wrong_pixels_at
        Number of pixel centres beside the outlines that lie in a wrong region, farther than the tolerance from its edge; the
        first of them.
    inverted, degenerate, nonmanifold_edges, pinched_vertices, duplicate_vertices, unused_vertices
        Number of defects; 0 in a valid mesh.
    smallest_angle, smallest_angle_at
        The worst angle and where it is.
    min_angle, narrow, narrow_at
        The least angle promised, the number of triangles with a smaller one, and places of the first of them.
    removed
        What was cleaned away: how many ``specks``, ``holes`` and ``pixels``, and the largest of them, ``listed``; how many pixels
        were ``missing`` in the image, and ``absorbed`` by neighbours.
    notes
        One sentence for each thing that was decided while reading the image and might have been meant otherwise.
    warnings
        One line for each promise that is not kept, with its place.
    """

    recipe: str
    options: dict[str, Any]
    settings: dict[str, Any]
    counted: dict[str, Any]
    n_vertices: int
    n_triangles: int
    hausdorff: float
    hausdorff_at: tuple[float, float]
    tolerance: float | None
    areas: dict[int, dict[str, float]]
    areas_off: dict[int, tuple[float, float]]
    displaced: list[int]
    topology: dict[int, dict[str, tuple[int, int]]]
    unknown_labels: list[int]
    neighbours_missing: list[tuple[int, int]]
    neighbours_extra: list[tuple[int, int]]
    wrong_pixels: int
    wrong_pixels_at: list[tuple[float, float]]
    inverted: int
    degenerate: int
    nonmanifold_edges: int
    pinched_vertices: int
    duplicate_vertices: int
    unused_vertices: int
    smallest_angle: float
    smallest_angle_at: tuple[float, float]
    min_angle: float | None
    narrow: int
    narrow_at: list[tuple[float, float]]
    removed: dict[str, Any]
    notes: list[str]
    warnings: list[str]

    def __repr__(self) -> str:
        kept = "every promise kept" if self.kept else f"{len(self.warnings)} not kept of what was promised"
        changed = sum(entry["found"] != entry["expected"] for entry in self.topology.values())
        area = max((abs(entry["error"]) for entry in self.areas.values()), default=0.0)
        rows = {
            "distance": f"{self.hausdorff:.4g}" + (f" of at most {self.tolerance:.4g}" if self.tolerance else ""),
            "smallest angle": f"{self.smallest_angle:.1f}" + (f" of at least {self.min_angle:g} degrees" if self.min_angle else " degrees"),
            "areas": f"within {100 * area:.2g} % of those of the image",
            "topology": f"{changed} of {len(self.topology)} regions differ from the image" if changed else "as in the image",
            "defects": str(sum(getattr(self, name) for name in DEFECTS)),
        }
        lines = [f"Report: {self.n_triangles} triangles, {self.n_vertices} vertices, {kept}"]
        lines += [f"{name:<16}{words}" for name, words in rows.items()]
        lines += [f"{word:<16}{line}" for word, told in (("not kept", self.warnings), ("noted", self.notes)) for line in told[:PRINTED]]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Return the table of promises for a notebook."""
        from img2tri.views.page.html_tables import certificate, from_json, verdict, warnings

        facts = from_json(self.to_json())
        return f"<p>{verdict(facts)}</p>{certificate(facts, [])}{warnings(facts, [])}"

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain data."""
        return dataclasses.asdict(self)

    def to_json(self, indent: int | None = 2) -> str:
        """Return the report as JSON."""
        return json.dumps(self.to_dict(), indent=indent, default=_plain)

    @property
    def kept(self) -> bool:
        """Whether every promise is kept."""
        return not self.warnings


def certify(
    vertices: Floats,
    triangles: Ints,
    regions: Ints,
    frame: Frame,
    origin: Provenance,
    *,
    progress: Callable[[str, float], None] | None = None,
) -> Report:
    """Judge a mesh by the image it was made from.

    Parameters
    ----------
    vertices, triangles, regions
        The mesh: (n, 2) float64 in world coordinates, (m, 3) int64, (m,) int64 labels of the image.
    frame, origin
        Where the image lies, and what the mesh is to be judged by.
    progress
        What is called with the name of what is measured next and the fraction done, and ends the work if it raises.
    """
    tell = progress or (lambda *_: None)
    tell("distances", 0.0)
    plane, outlines = (vertices - frame.corner) / frame.pixel, origin.outlines
    number, unknown = region_numbers(regions, outlines.labels)
    sides = EdgeSides.of(triangles)
    parting = sides.curves(regions)
    border = sides.among(parting)
    curves = SegmentSet(plane, border.edges)
    distance, farthest = hausdorff(SegmentSet(outlines.points, outlines.segments[0]), curves)
    tell("pixels", 0.3)
    wrong = wrong_pixels(plane, triangles, number, curves, origin)
    tell("angles", 0.5)
    worst, angle = angles_below(vertices, triangles, origin.min_angle or 0.0)
    narrow = worst[angle < (origin.min_angle or 0.0) - 1e-9]
    places = vertices[triangles[np.append(narrow[:PLACES], worst[np.argmin(angle)])]].mean(axis=1)
    tell("topology", 0.6)
    missing, extra = neighbours(number, border, outlines)
    found = moments(plane, triangles, number, len(origin.areas))
    promised = origin.tolerance is not None and origin.options.get("keep_area", True)
    off = regions_off(found, curves, origin) if promised else {}
    facts: dict[str, Any] = {
        "removed": origin.counted.get("removed", {}),
        "notes": origin.notes,
        "hausdorff": distance * frame.pixel,
        "hausdorff_at": _place(frame.world(farthest)),
        "tolerance": None if origin.tolerance is None else origin.tolerance * frame.pixel,
        "areas": region_areas(found, origin, frame.pixel),
        "areas_off": {label: _place(frame.world(at)) for label, at in off.items()},
        "displaced": displaced(found, origin),
        "topology": topology(triangles, number, sides, parting, outlines),
        "unknown_labels": unknown,
        "neighbours_missing": missing,
        "neighbours_extra": extra,
        "wrong_pixels": len(wrong),
        "wrong_pixels_at": [_place(p) for p in frame.world(wrong[:PLACES])],
        **defects(vertices, triangles, regions, border),
        "smallest_angle": float(angle.min()),
        "smallest_angle_at": _place(places[-1]),
        "min_angle": origin.min_angle,
        "narrow": len(narrow),
        "narrow_at": [_place(p) for p in places[:-1]],
    }
    return Report(
        origin.recipe, origin.options, origin.settings, origin.counted, len(vertices), len(triangles), **facts, warnings=_warnings(facts)
    )  # fmt: skip


def _warnings(facts: dict[str, Any]) -> list[str]:
    """One line for each promise that is not kept."""
    lines = [f"{name}: {facts[name]}" for name in DEFECTS if facts[name]]
    lines += [f"label {v} is in the mesh, not in the image" for v in facts["unknown_labels"]]
    lines += [
        f"label {v}: {_count(t['found'][0], 'component')} with {_count(t['found'][1], 'hole')}, "
        f"expected {t['expected'][0]} with {t['expected'][1]}"
        for v, t in facts["topology"].items()
        if t["found"] != t["expected"]
    ]
    lines += [f"labels {a} and {b} touch in the image, not in the mesh" for a, b in facts["neighbours_missing"]]
    lines += [f"labels {a} and {b} touch in the mesh, not in the image" for a, b in facts["neighbours_extra"]]
    if facts["tolerance"] is not None:
        if facts["hausdorff"] > facts["tolerance"] * (1 + 1e-9):
            apart, at = facts["hausdorff"], facts["hausdorff_at"]
            lines.append(f"outline and mesh are {apart:.4g} apart at {at}, tolerance {facts['tolerance']:.4g}")
        lines += [
            f"label {v}: area {100 * facts['areas'][v]['error']:+.2g} % off, at {at}; promised is {100 * AREA_TOLERANCE:g} %"
            for v, at in facts["areas_off"].items()
        ]
        lines += [f"label {v} lies elsewhere than in the image" for v in facts["displaced"]]
    if facts["wrong_pixels"]:
        lines.append(f"{facts['wrong_pixels']} pixel centres lie in a wrong region, the first at {facts['wrong_pixels_at'][0]}")
    if facts["narrow"]:
        at = facts["smallest_angle_at"]
        lines.append(f"{facts['narrow']} triangles below {facts['min_angle']:g} degrees, the worst {facts['smallest_angle']:.4g} at {at}")
    return lines


def _count(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def _plain(value: Any) -> Any:
    """Turn what JSON does not know into what it does: numpy numbers into plain ones, all else into words."""
    plain = value.item() if isinstance(value, np.generic) else str(value)
    return float(plain) if isinstance(plain, np.generic) else plain  # numpy's long double has no plain form


def _place(xy: Floats) -> tuple[float, float]:
    return round(float(xy[0]), 6), round(float(xy[1]), 6)
