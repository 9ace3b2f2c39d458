r"""Dense outlines set back to the middles of their crack edges near some places, where pixels are not square.

Where pixels are square the middle of a crack edge is half a pixel away at most, so that within the tolerance every outline can go back to
the middles, where it turns by right angles at most. Where a pixel is twenty times as high as wide, its outline may lie ten times
that from there: the tip of a single pixel is a needle, and no chord within the tolerance of it is blunt enough. So there the dense
outline itself goes back, the whole way at the places and less and less around them::

            /\                  ____
           /  \      ->        /    \
          /    \              /      \

Any place on the dual edges is right as far as pixels and topology go, so this costs smoothness alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, ChainIndex, Floats, Points, as_complex, as_rows
from img2tri.shapes.place.area_exchange import exchange_areas
from img2tri.shapes.place.constrained_smoothing import BoundedChains, swept_areas
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.trace.dual_edges import BOUND, DualEdges, pixel_areas

GIVES = 8.0  # times as far from the places areas are given back
LEAST_WAY = 1e-6  # px: what is nearer to its middle is there


def set_back_near(s: Simplification, places: Points, *, within: float, alike: Callable[[Floats, ChainIndex], Floats]) -> Simplification:
    """Set the dense outlines back near some places: all the way within half of `within` px of them, and less and less up to that.

    What lies so near to the places, or would lie there, is set back, so that neighbours go the same way.

    What regions lose by that the rest of their outlines nearby gives back. Vertices of what was set back are no longer offset; corners stay
    corners, those of pixels. `alike` makes shares of the points of some chains the same on opposite sides of a periodic image.
    """
    from scipy.spatial import cKDTree

    points, dual_edges = as_complex(s.outlines.points), s.dual_edges
    near = cKDTree(as_rows(places))
    distance = [np.asarray(near.query(as_rows(z), distance_upper_bound=within)[0]) for z in (points, dual_edges.blunt_middle)]
    share = alike(np.clip(2 - 2 * np.minimum(np.minimum(*distance), within) / within, 0, 1), s.chains)
    way = share * (dual_edges.blunt_middle - points)
    moves = np.abs(way) > LEAST_WAY
    back = np.where(moves, points + way, points)
    far = np.asarray(near.query(as_rows(points), distance_upper_bound=GIVES * within)[0]) == np.inf
    points = back + _given_back(points, back, moves | s.pinned | far, dual_edges) * dual_edges.vector
    moved = moves[s.chains.indices]
    return replace(
        s,
        outlines=replace(s.outlines, points=as_rows(points)),
        dense=points[s.chains.indices],
        offset=np.where(moved, 0, s.offset),
        snapped=s.snapped & ~moves,
    )


def _given_back(before: Points, after: Points, held: Bools, dual_edges: DualEdges) -> Floats:
    """Return by which shares of their dual edges the points that are not held move for regions to have the areas they had before."""
    slides = dual_edges.slides
    shift = np.where(slides, ((after - dual_edges.middle) / np.where(slides, dual_edges.vector, 1)).real, 0.0)
    room = np.where(slides & ~held, BOUND, 0.0)
    low, high = np.minimum(-room - shift, 0) * (room > 0), np.maximum(room - shift, 0) * (room > 0)
    s = BoundedChains(after, dual_edges.vector, low, high, room, dual_edges.chains)
    wanted = swept_areas(before, s)
    return exchange_areas(s, np.zeros(len(after)), wanted, *dual_edges.regions, pixel_areas(dual_edges))
