"""The conforming recipe: label map -> outlines -> points -> triangles, every region with its own outline.

Outlines are made first, as fine as the pixels; then simplified to the wanted spacing, kept clear of each other; then filled.
Where a triangle comes out with too small an angle, the outlines there are made finer, and the mesh is made again: at the
end of this road all outlines run through the middles between pixels, where they turn by right angles at most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, as_rows
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes.preserved_areas import with_areas_preserved
from img2tri.recipes.wanted_sizes import Sizes
from img2tri.shapes.periodic.paired_outlines import FILLINGS, PeriodicPairs, find_periodic_pairs
from img2tri.shapes.periodic.side_chains import cut_alike
from img2tri.shapes.place.placement import place_on_pixel_sides, place_outlines
from img2tri.shapes.simplify.parted_junctions import part_junctions
from img2tri.shapes.simplify.set_back import set_back_near
from img2tri.shapes.simplify.sharp_turns import sharp_turns
from img2tri.shapes.simplify.simplification import LEAST_ANGLE, Simplification, space_evenly
from img2tri.shapes.simplify.tangential_relocation import relocate, slide_limits
from img2tri.shapes.simplify.tolerance import split_near
from img2tri.shapes.simplify.vertex_offsets import offset_vertices
from img2tri.shapes.sizes.outline_sizes import by_chords, by_curvature, by_thickness, limit_growth
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import DualEdges
from img2tri.shapes.trace.nonsquare_pixels import with_turning_points
from img2tri.types import Frame, Outlines, RecipeMesh

if TYPE_CHECKING:
    from img2tri.triangles.generate.constrained_delaunay import PslgError

Mesh = tuple[Floats, Ints, Ints]
"""Vertices (n, 2), triangles (m, 3) and regions (m,)."""

Posts = Callable[[Outlines], Bools]  # of dense outlines: which entries (k,) of their chains have to be vertices
USUAL_SEGMENTS, SHORTEST_SHARE = 20, 1 / 3  # to a full turn by default; chords get no shorter for that than this share of the length wanted
LASTING = 15  # dense points, 11 to 15 px: what turns within fewer is a corner
RESPACINGS = 2  # how often outlines are spaced anew around places that need shorter chords
LEAST_PIECE = 1e-3  # px; outlines are never cut so fine, so that this is as good as 0
WEDGE = 36.0  # degrees, at which chords may meet: a little more than any `min_angle`
WAY_BACK = 0.7  # px: no point is farther from the middle of its dual edge, or of its block
CONFETTI = 3000  # outlines: so many are seldom wanted
ENDLESS = 0.02  # px: where segments of opposite sides get so short, each side would divide the other again and again
SLIDE_AGAIN = 0.3  # of the shorter chord beside a vertex: how far it may slide for the sake of the worst angles
ATTEMPTS = 12  # rounds of refining the outlines; two are the most that ordinary images take
SPLITTINGS, SPLITTINGS_NOT_SQUARE = 6, 3  # of these: rounds in which they are split and snapped within the tolerance, and nothing else


def trace_outlines(
    zones: Segmentation, frame: Frame, *, connectivity: int = 4, corners: str = "auto", outline: str = "smooth", periodic: str | None = None
) -> tuple[Outlines, DualEdges]:
    """Trace the outlines of all regions of a label map, as fine as the pixels.

    Parameters
    ----------
    zones
        The label map, and the gray values that place its outlines, if there are any.
    frame
        Where the image lies; the outlines are in its plane.
    connectivity
        4: a checkerboard joins its lower label, so that a binary foreground joins through sides; 8: its higher one.
    corners
        "round" smooths them as all else.
    outline
        "smooth", or "pixel": exactly along the sides of pixels.
    periodic
        "x", "y" or "xy": the points on these opposite sides are put at the same places; see `img2tri.shapes.periodic`.
    """
    crack_edges = find_crack_edges(
        zones.labels, background=zones.background, upward=frame.upward, connectivity=connectivity, changes=zones.changes
    )
    crack_edges = cut_alike(crack_edges, periodic)
    if outline == "pixel":
        return place_on_pixel_sides(crack_edges, frame)
    outlines, dual_edges = place_outlines(crack_edges, frame, gray=zones.gray, level=zones.level, corners=corners != "round")
    return find_periodic_pairs(outlines, dual_edges, periodic).alike(outlines), dual_edges


def conform(
    outlines: Outlines,
    dual_edges: DualEdges,
    sizes: Sizes,
    *,
    tolerance: float,
    min_angle: float,
    corners: str,
    keep_area: bool,
    interior: str,
    seed: int,
    periodic: str | None = None,
    node: complex | None = None,
    posts: Posts | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> RecipeMesh:
    """Mesh all regions of an image, given its dense outlines; lengths in px.

    Of a window that is to fit others, `node` is a place all have in their lattices, and `posts` tells which entries are vertices in all.
    """
    from img2tri.triangles.generate.constrained_delaunay import PslgError

    stretched = abs(dual_edges.pixel.real) != abs(dual_edges.pixel.imag)
    outlines, dual_edges = with_turning_points(outlines, dual_edges, on_frame=periodic is None)
    tell = progress or (lambda *_: None)
    count = len(outlines.left)
    tell("spacing" if count < CONFETTI else f"spacing {count:,} outlines; min_area would drop specks", 0.3)
    pairs = find_periodic_pairs(outlines, dual_edges, periodic)
    posted = np.zeros(len(outlines.chains.indices), bool) if posts is None else posts(outlines)
    # Outlines of stretched pixels got theirs with the turning points; opposite sides have to have their vertices alike.
    tips = None
    if not stretched and not len(pairs.one):
        turns, tips = sharp_turns(outlines, tolerance=tolerance)
        posted = posted | turns
    coarse = _spaced(outlines, dual_edges, pairs, sizes, tolerance, corners == "keep", keep_area, posted, tips, WEDGE)
    if keep_area:
        coarse = with_areas_preserved(coarse, pairs, tolerance=tolerance)
    demands = _Demands(tolerance, min_angle, keep_area, interior, seed, node)
    yielding, began = tolerance, 0
    for attempt in range(ATTEMPTS):
        tell("triangles", 1 - 0.6 * 0.7**attempt)
        mesh, chains, doubtful = _filled(coarse, pairs, sizes, demands)
        if not len(doubtful) or attempt + 1 == ATTEMPTS:
            break
        before: Simplification = coarse
        passed: Simplification | None = coarse
        places, reach = as_complex(doubtful), 1.0 + 0.5 * (attempt - began)
        if stretched and began:
            coarse, passed = set_back_near(coarse, places, within=2 * reach, alike=pairs.greatest), None
        coarse = split_near(coarse, places, within=reach, tolerance=yielding)
        coarse = pairs.enforce_tolerance(coarse, tolerance=tolerance, passed=passed)
        if stretched and began and keep_area:
            coarse = with_areas_preserved(coarse, pairs, tolerance=tolerance)
        same = all((getattr(coarse, part) == getattr(before, part)).all() for part in ("kept", "offset", "dense"))
        if same and (began if stretched else yielding >= WAY_BACK):
            break
        if same or attempt + 1 == (SPLITTINGS_NOT_SQUARE if stretched else SPLITTINGS):
            # Outlines of square pixels are rather left behind than too sharp, and the report tells; others can go back themselves.
            yielding, began = yielding if stretched else max(tolerance, WAY_BACK), attempt + 1
    if isinstance(mesh, PslgError):
        raise mesh
    pairs.check(chains, mesh[0])
    counted = {"rounds": attempt + 1, "reset": int(coarse.snapped.sum())}
    if sizes.shortest:
        first, last = coarse.chords
        counted["below_min_edge_length"] = int((abs(coarse.places[last] - coarse.places[first]) < sizes.shortest).sum())
    return RecipeMesh(*mesh, counted, None if coarse.outlines is outlines else coarse.outlines)


@dataclass(frozen=True)
class _Demands:
    """What is asked of the mesh between outlines, see `img2tri.options.mesh_options.FillOptions`; the tolerance in px."""

    tolerance: float
    min_angle: float
    keep_area: bool
    interior: str
    seed: int
    node: complex | None


def _filled(coarse: Simplification, pairs: PeriodicPairs, sizes: Sizes, demands: _Demands) -> tuple[Mesh | PslgError, Outlines, Floats]:
    """Fill coarse outlines, with a lattice or with scattered points.

    Return vertices, triangles and regions, or why there are none; the outlines, opposite sides divided alike; and places (k, 2) where
    these are at fault: at the corners of triangles with too small an angle, or where no mesh could be made.
    """
    from img2tri.triangles.generate.constrained_delaunay import PslgError
    from img2tri.triangles.min_angle_tangents import narrower

    chains = coarse.coarse()
    try:
        for _ in range(FILLINGS):
            if demands.interior == "lattice":
                made = _with_lattice(coarse, chains, pairs, sizes, demands)
            else:
                from img2tri.recipes.poisson_interior import scattered

                made = scattered(chains, sizes.longest, sizes.field, min_angle=demands.min_angle, seed=demands.seed)
            filled, chains = chains, pairs.divided_alike(chains, made[0])
            if chains is filled or _shortest(chains) < ENDLESS:
                break
    except PslgError as error:
        segments = chains.segments[0]
        return error, chains, chains.points[segments[error.segments if len(error.segments) else slice(None)]].reshape(-1, 2)
    vertices, triangles, regions, irregular = made
    sharp = narrower(as_complex(vertices), triangles[:irregular], demands.min_angle - 1e-9)
    # Where opposite sides still differ, the points last added to them are at fault too.
    doubtful = [vertices[triangles[:irregular][sharp]].reshape(-1, 2), chains.points[len(filled.points) :]]
    return (vertices, triangles, regions), chains, np.concatenate(doubtful)


def _shortest(chains: Outlines) -> float:
    """Return the length of the shortest segment."""
    one, other = as_complex(chains.points)[chains.segments[0]].T
    return float(np.abs(other - one).min())


def _with_lattice(
    coarse: Simplification, chains: Outlines, pairs: PeriodicPairs, sizes: Sizes, demands: _Demands
) -> tuple[Floats, Ints, Ints, int]:
    """Begin a mesh, ask the outlines where their points may be that it wants elsewhere, and finish it, see `filling.finish`."""
    from img2tri.triangles.generate.filling import begin, finish

    segments, left, right = chains.segments
    limits = slide_limits(coarse, shortest=sizes.shortest)
    begun = begin(
        chains.points, segments, left, right, edge_length=sizes.longest, gradation=sizes.gradation, size=sizes.field,
        limits=limits, seed=demands.seed, node=demands.node,
    )  # fmt: skip
    # Opposite sides divided alike add points after those of the outlines; only the latter have their places there.
    own, added = np.split(begun.wanted, [len(limits)])
    how: dict[str, Any] = {"tolerance": demands.tolerance, "keep_area": demands.keep_area}
    placed = relocate(coarse, own, **how)
    places = np.concatenate([placed.coarse().points, added])
    if len(pairs.one):
        return finish(begun, places, min_angle=demands.min_angle)  # opposite sides would be divided unlike by what follows
    return finish(
        begun, places, min_angle=demands.min_angle,
        limits=slide_limits(placed, shortest=sizes.shortest, share=SLIDE_AGAIN, snapped=True),
        settle=lambda wanted: relocate(placed, wanted, **how).coarse().points,
    )  # fmt: skip


def _spaced(
    outlines: Outlines,
    dual_edges: DualEdges,
    pairs: PeriodicPairs,
    sizes: Sizes,
    tolerance: float,
    keep_corners: bool,
    keep_area: bool,
    posts: Bools | None = None,
    tips: Points | None = None,
    least_angle: float = LEAST_ANGLE,
) -> Simplification:
    """Simplify the outlines to the lengths wanted, spaced evenly.

    A first simplification shows where chords have to be shorter than wanted; a second, and if need be a third, spaces them evenly
    around these places.
    """
    z = as_complex(outlines.points)[outlines.chains.indices]
    wanted = pairs.shared(limit_growth(_wanted(z, dual_edges, sizes), z, outlines.chains, sizes.gradation))

    def spaced(known: Simplification | None) -> Simplification:
        new = space_evenly(outlines, dual_edges, spacing=wanted, keep_corners=keep_corners, posts=posts, tips=tips, least_angle=least_angle)
        new = part_junctions(new, spacing=wanted, tolerance=tolerance)
        new = offset_vertices(new, tolerance=tolerance, keep_area=keep_area)
        return pairs.enforce_tolerance(new, tolerance=tolerance, passed=None if len(pairs.one) else known)

    coarse = spaced(None)
    for _ in range(RESPACINGS):
        shorter = pairs.shared(limit_growth(by_chords(coarse, wanted), z, outlines.chains, sizes.gradation))
        if (shorter > 0.99 * wanted).all():
            break
        wanted = shorter
        coarse = spaced(coarse)
    return coarse


def _wanted(z: Points, dual_edges: DualEdges, sizes: Sizes) -> Floats:
    """Lengths wanted at the dense points of the outlines, before their growth is limited."""
    longest = sizes.longest if sizes.boundary is None else min(sizes.longest, sizes.boundary)
    wanted = np.full(len(z), longest)
    if sizes.field is not None:
        wanted = np.minimum(wanted, sizes.field.on_outlines(as_rows(z)))
    if sizes.elements_across is not None:
        wanted = np.minimum(wanted, by_thickness(z, dual_edges, longest, sizes.elements_across))
    if sizes.segments_per_turn is not None:
        wanted = by_curvature(z, dual_edges.chains, wanted, sizes.segments_per_turn, lasting=LASTING)
    else:
        wanted = np.maximum(by_curvature(z, dual_edges.chains, wanted, USUAL_SEGMENTS, lasting=LASTING), SHORTEST_SHARE * wanted)
    return np.asarray(np.maximum(wanted, max(sizes.shortest, LEAST_PIECE)))
