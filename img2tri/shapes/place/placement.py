"""Dual edges -> dense outlines: where between two pixel centres the outline passes.

Any place within the bounds is right as far as topology goes (see `dual_edges`), so all places can be chosen well: by the gray values
where there are any (`iso_crossings`), exactly at corners (`outline_corners`), and by smoothing along the arc within what these leave open
(`constrained_smoothing`); nodes where the chains that meet there lead (`node_placement`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex, cross
from img2tri.shapes.place.area_exchange import exchange_areas
from img2tri.shapes.place.constrained_smoothing import (
    SHORTEST_NARROW,
    SHORTEST_WIDE,
    BoundedChains,
    restore_swept_areas,
    swept_areas,
    widest_fitting_spline,
)
from img2tri.shapes.place.known_crossings import OutlineLevel, known_crossings
from img2tri.shapes.place.node_placement import bend_to_nodes, meeting_places, open_wedges
from img2tri.shapes.place.outline_corners import find_corners
from img2tri.shapes.place.straight_chains import straightened
from img2tri.shapes.trace.crack_edges import CrackEdges, cut_chains
from img2tri.shapes.trace.dual_edges import BOUND, DualEdges, lay_out, pixel_areas
from img2tri.types import ColourMix, Frame, Outlines

PLENTY = 30  # points of the long outlines of a region: so many spare short ones
LEAST_ACROSS = 1e-9  # px^2, of a dual edge that meets a line
MIXED_CROSSINGS = 2  # crossings to either side of a corner whose pixels may be mixed of more than two sides


def place_outlines(
    crack_edges: CrackEdges, frame: Frame, *, gray: NDArray[Any] | ColourMix | None = None, level: OutlineLevel = None, corners: bool = True
) -> tuple[Outlines, DualEdges]:
    """Return the dense outlines, in the plane of `frame`, and the dual edges their points lie on.

    Parameters
    ----------
    crack_edges
        From `find_crack_edges`.
    frame
        Where the image lies.
    gray, level
        (h, w) gray values, or what pixels are mixed of, and the level of the outline, see `known_crossings`; None: the label map is all
        there is.
    corners
        True: corners stay sharp; False: they are rounded as all else is.
    """
    if frame.spacing[0] != frame.spacing[1]:
        # Steps of pixels are alike in both directions only where pixels are square: there outlines are smoothed, and stretched then.
        placed, squares = place_outlines(crack_edges, Frame(frame.shape, upward=frame.upward), gray=gray, level=level, corners=corners)
        stretched = lay_out(squares.crack_edges, frame)
        points = as_complex(placed.points * (np.array(frame.spacing) / frame.pixel))
        return stretched.outlines(_opened_stretched(points, stretched)), stretched
    dual_edges = lay_out(crack_edges, frame)
    if not len(dual_edges.crossed):
        return dual_edges.outlines(dual_edges.middle), dual_edges
    shift, slack = known_crossings(dual_edges, frame, gray, level)
    at, sharp = np.zeros(0, np.int64), np.zeros(0, np.complex128)
    if corners:
        bends, at, sharp = _corners(dual_edges, shift, slack)
    if len(at):
        crack_edges = cut_chains(crack_edges, dual_edges.crossed[bends])
        del dual_edges, shift, slack  # outlines are the largest that there is: not to have them twice
        dual_edges = lay_out(crack_edges, frame)
        shift, slack = known_crossings(dual_edges, frame, gray, level)
    points, movable = dual_edges.middle.copy(), dual_edges.bounds != 0
    if len(at):
        node = len(dual_edges.crossed) + np.searchsorted(dual_edges.node_corner, at)
        points[node], movable[node] = sharp, False
        shift, slack = _on_sides_of_corners(node, points, dual_edges, shift, slack)
    bounded = _with_free_ends(_bounded(dual_edges, points, shift, slack), dual_edges)
    shift, ends = straightened(bounded, *widest_fitting_spline(bounded))
    # From here on the nodes on the frame stay where they slid to, and all others where their chains lead.
    nodes = meeting_places(replace(bounded, points=bounded.points + shift * bounded.axis), ends, movable, dual_edges.bounds)
    bounded = replace(bounded, points=np.where(dual_edges.slides, bounded.points, nodes), axis=dual_edges.vector)
    shift = bend_to_nodes(bounded, np.where(dual_edges.slides, shift, 0.0), ends, dual_edges.bounds != 0)
    wanted = _wanted_areas(bounded, dual_edges, slack)
    shift = restore_swept_areas(bounded, shift, np.where(_spared(bounded, *dual_edges.regions), np.nan, wanted))
    areas, free = pixel_areas(dual_edges), bounded
    if dual_edges.is_junction.any():
        bounded, shift = open_wedges(bounded, shift, dual_edges.blunt_middle, dual_edges.is_junction, dual_edges.bounds)
        wanted = _wanted_areas(bounded, dual_edges, slack)
    shift = exchange_areas(bounded, shift, wanted, *dual_edges.regions, areas)
    if dual_edges.is_junction.any():
        # Regions whose crossings all lie beside junctions get what they lack by these, though wedges close a little.
        shift = exchange_areas(replace(free, points=bounded.points), shift, wanted, *dual_edges.regions, areas)
    return dual_edges.outlines(bounded.points + shift * dual_edges.vector), dual_edges


def _opened_stretched(points: Points, dual_edges: DualEdges) -> Points:
    """Return the points of outlines that were smoothed where pixels are square, sharp wedges opened as they are where these are not.

    Also at the frame of the image, where the end of a chain slides no farther from the crossing beside it than that is away.
    """
    vector, at, chains = dual_edges.vector, dual_edges.chains.indices, dual_edges.chains
    if not len(at):
        return points
    bound = np.full(len(vector), BOUND)
    s = BoundedChains(dual_edges.middle, vector, -bound, bound, bound, chains)
    wanted, points = swept_areas(points, s), points.copy()
    for entry, step in ((chains.first, 1), (chains.last, -1)):
        node, beside = at[entry], at[entry + step]
        ends = ~chains.rings & (dual_edges.bounds[node] == 0) & (points[node] != dual_edges.middle[node]) & (vector[beside] != 0)
        node, beside = node[ends], beside[ends]
        along = vector[beside] / np.abs(vector[beside])
        off = (points[node] - points[beside]) * along.conj()
        points[node] = points[beside] + (np.clip(off.real, -np.abs(off.imag), np.abs(off.imag)) + 1j * off.imag) * along
    shift = np.where(vector != 0, ((points - dual_edges.middle) / np.where(vector != 0, vector, 1)).real, 0.0)
    s = replace(s, points=np.where(vector != 0, dual_edges.middle, points))
    opened, shift = open_wedges(s, shift, dual_edges.blunt_middle, dual_edges.is_junction, dual_edges.bounds)
    # What the crossings that are not beside junctions cannot give back, all do.
    for free in (opened, replace(s, points=opened.points)):
        shift = exchange_areas(free, shift, wanted, *dual_edges.regions, pixel_areas(dual_edges))
    return opened.points + shift * vector


def _corners(dual_edges: DualEdges, shift: Floats, slack: Floats) -> tuple[Ints, Ints, Points]:
    """Find corners where just one outline passes: the crossings before them, the corners of pixels these lead to, and their places."""
    bends, sharp = find_corners(_bounded(dual_edges, dual_edges.middle, shift, slack), dual_edges.corner_after, BOUND * dual_edges.pixel)
    at, tails = dual_edges.crack_edges.head[dual_edges.crossed[bends]], np.sort(dual_edges.crack_edges.tail)
    once = np.diff(np.searchsorted(tails, np.stack([at, at + 1])), axis=0)[0] == 1
    return bends[once], at[once], sharp[once]


def _bounded(dual_edges: DualEdges, points: Points, shift: Floats, slack: Floats) -> BoundedChains:
    """Points shifted to where they are known to lie, with the bounds that are left to them."""
    low, high = np.maximum(-slack, -BOUND - shift), np.minimum(slack, BOUND - shift)
    return BoundedChains(points + shift * dual_edges.vector, dual_edges.vector, low, high, slack, dual_edges.chains)


def _on_sides_of_corners(corners: Ints, points: Points, dual_edges: DualEdges, shift: Floats, slack: Floats) -> tuple[Floats, Floats]:
    """Return shifts and slack (n,) of crossings where those beside corners begin on the sides of the corner, as unsure as in a mask.

    Gray values of pixels beside a corner are mixed of both its sides, and tell where neither is. A side passes through the corner and the
    first crossing that is sure; corners are ends of chains.
    """
    indices, chain, vector = dual_edges.chains.indices, dual_edges.chains.chain, dual_edges.vector
    is_corner, new_shift, new_slack = np.zeros(len(points), bool), shift.copy(), slack.copy()
    is_corner[corners] = True
    for ends, step in ((dual_edges.chains.first, 1), (dual_edges.chains.last, -1)):
        at = ends[is_corner[indices[ends]]]
        beside = np.clip(at[:, None] + step * np.arange(1, MIXED_CROSSINGS + 2), 0, len(indices) - 1)
        own = chain[beside] == chain[at, None]
        corner, unsure, sure = points[indices[at], None], indices[beside[:, :-1]], indices[beside[:, -1:]]
        side = dual_edges.middle[sure] + shift[sure] * vector[sure] - corner
        across = cross(vector[unsure], side)
        known = own[:, -1:] & (np.abs(across) > LEAST_ACROSS) & (slack[unsure] < BOUND)
        t = -cross(dual_edges.middle[unsure] - corner, side) / np.where(known, across, 1)
        new_shift[unsure[known]] = np.clip(t[known], -BOUND, BOUND)
        new_slack[unsure[own[:, :-1]]] = BOUND
    return new_shift, new_slack


def _with_free_ends(s: BoundedChains, dual_edges: DualEdges) -> BoundedChains:
    """Let the nodes on the frame of the image slide along it, as the crossing next to each does on its dual edge."""
    first, last = dual_edges.chains.ends
    beside = np.concatenate([s.chains.indices[s.chains.first + 1], s.chains.indices[s.chains.last - 1]])
    node = np.concatenate([first, last])
    ends = np.concatenate([~s.chains.rings, ~s.chains.rings]) & (dual_edges.bounds[node] == 0) & s.slides[beside]
    axis = s.axis.copy()
    axis[node[ends]] = s.axis[beside[ends]]
    return replace(s, axis=axis)


def _wanted_areas(s: BoundedChains, dual_edges: DualEdges, slack: Floats) -> Floats:
    """Area each chain has to sweep: through the places that are known, and along the sides of pixels where none are.

    So regions of a mask keep the areas of their pixels.
    """
    one, other = dual_edges.chains.indices[:-1], dual_edges.chains.indices[1:]
    corner = np.concatenate([dual_edges.corner_after, dual_edges.middle[len(dual_edges.crossed) :]])  # that of the pixels after each point
    detour = cross(corner[one] - s.points[one], s.points[other] - s.points[one]) / 2
    unknown = (slack[one] == BOUND) & (slack[other] == BOUND) & (np.diff(dual_edges.chains.chain) == 0)
    return np.asarray(swept_areas(s.points, s) + np.bincount(dual_edges.chains.chain[:-1], detour * unknown, len(dual_edges.chains.rings)))


def _spared(s: BoundedChains, left: Ints, right: Ints) -> Bools:
    """Tell which chains (c,) are too short to be smoothed, between regions that have plenty of long outlines.

    For their own area they would be bent all the way to their bounds; the regions get it by their other chains, see `area_exchange`.
    """
    points = np.diff(s.chains.starts)
    short = ~s.chains.rings & (points <= SHORTEST_NARROW)
    others = np.bincount(np.concatenate([left, right]), np.tile(np.where(points > SHORTEST_WIDE, points, 0), 2))
    return np.asarray(short & (others[left] >= PLENTY) & (others[right] >= PLENTY))


def place_on_pixel_sides(crack_edges: CrackEdges, frame: Frame) -> tuple[Outlines, DualEdges]:
    """Return the outlines that run exactly along the sides of pixels.

    Only where a checkerboard would make an outline touch itself, the tips of its pixels are cut off half-way along their sides, which
    are shifted so that no area is lost, see `DualEdges.fair_middle`.
    """
    dual_edges = lay_out(crack_edges, frame)
    n, along = len(dual_edges.crossed), dual_edges.corner_after - dual_edges.middle[: len(dual_edges.crossed)]
    at = dual_edges.chains.indices
    # After each crossing comes the corner of pixels its crack edge ends at, if the outline turns there, and no other passes it.
    crossing = np.flatnonzero((at[:-1] < n) & (at[1:] < n) & (dual_edges.chains.chain[:-1] == dual_edges.chains.chain[1:]))
    one, other = at[crossing], at[crossing + 1]
    turns = np.abs(cross(along[one], along[other])) > 0
    passes = np.searchsorted(np.sort(crack_edges.tail), crack_edges.head[dual_edges.crossed[one]][:, None] + [0, 1])
    bends = one[turns & (np.diff(passes, axis=1)[:, 0] == 1)]
    dual_edges = lay_out(cut_chains(crack_edges, dual_edges.crossed[bends]), frame)
    fair = dual_edges.fair_middle
    vector = np.zeros_like(dual_edges.vector)
    shifted = np.concatenate(dual_edges.beside_touching)
    vector[shifted] = dual_edges.vector[shifted]
    dual_edges = replace(dual_edges, vector=vector, bounds=np.zeros_like(dual_edges.bounds))
    return dual_edges.outlines(fair), dual_edges
