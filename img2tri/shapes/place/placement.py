"""Links -> dense outlines: where between two pixel centres the outline passes.

Any place is right as far as topology goes (see `links`), so all places can be chosen well: by the gray values where there
are any (`levels`), exactly at corners (`corners`), and by smoothing along the arc within what these leave open (`fitting`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.shapes.place.constrained_smoothing import Sliding, keep_areas, swept, widest_fit
from img2tri.shapes.place.corners import find_corners
from img2tri.shapes.place.iso_crossings import crossings_by_level
from img2tri.shapes.place.padded_chains import Points, cross
from img2tri.shapes.trace.crack_edges import Cracks
from img2tri.shapes.trace.dual_edges import REACH, Links, cut, lay_out
from img2tri.types import Floats, Frame, Outlines


def place(
    cracks: Cracks, frame: Frame, *, gray: NDArray[Any] | None = None, level: float | None = None, corners: bool = True
) -> tuple[Outlines, Links]:
    """Return the dense outlines, in the plane of `frame`, and the links their points lie on.

    Parameters
    ----------
    cracks
        From `find_cracks`.
    frame
        Where the image lies.
    gray, level
        (h, w) gray values and the level of the outline among them, see `levels`; None: the label map is all there is.
    corners
        True: corners stay sharp; False: they are rounded as all else is.
    """
    links = lay_out(cracks, frame)
    if not len(links.crack):
        return links.outlines(links.middle), links
    shift, slack = _known(links, frame, gray, level)
    if corners:
        bends, sharp = find_corners(_sliding(links, links.middle, shift, slack), links.head, REACH * links.pixel)
        at = cracks.head[links.crack[bends]]
        once = np.diff(np.searchsorted(np.sort(cracks.tail), np.stack([at, at + 1])), axis=0)[0] == 1
        bends, sharp, at = bends[once], sharp[once], at[once]
    if corners and len(bends):
        links = cut(links, bends, frame)
        shift, slack = _known(links, frame, gray, level)
    points = _settle_nodes(links)
    if corners:
        points[len(links.crack) + np.searchsorted(links.node, at)] = sharp
    sliding = _sliding(links, points, shift, slack)
    free = _with_free_ends(sliding, links)
    shift = widest_fit(free)
    # From here on the nodes on the frame stay, too.
    ends = sliding.axis != free.axis
    points[ends] += (shift * free.axis)[ends]
    sliding, shift = replace(sliding, points=np.where(ends, points, sliding.points)), np.where(ends, 0.0, shift)
    shift = keep_areas(sliding, shift, _wanted(sliding, links, slack))
    return links.outlines(sliding.points + shift * links.axis), links


def _known(links: Links, frame: Frame, gray: NDArray[Any] | None, level: float | None) -> tuple[Floats, Floats]:
    """Where each point lies on its link as far as is known, and how far it may be shifted from there."""
    if gray is None:
        return np.zeros(len(links.middle)), np.full(len(links.middle), REACH)
    return crossings_by_level(gray, level, links.middle, links.axis, frame)


def _sliding(links: Links, points: Points, shift: Floats, slack: Floats) -> Sliding:
    """Points shifted to where they are known to lie, with the ranges that are left to them."""
    low, high = np.maximum(-slack, -REACH - shift), np.minimum(slack, REACH - shift)
    return Sliding(points + shift * links.axis, links.axis, low, high, slack, links.indices, links.starts, links.rings)


def _with_free_ends(s: Sliding, links: Links) -> Sliding:
    """Let the nodes on the frame of the image slide along it, as the crossing next to each does on its link."""
    first, last = links.ends
    beside = np.concatenate([s.indices[s.starts[:-1] + 1], s.indices[s.starts[1:] - 2]])
    node = np.concatenate([first, last])
    ends = np.concatenate([~s.rings, ~s.rings]) & (links.room[node] == 0) & (s.axis[beside] != 0)
    axis = s.axis.copy()
    axis[node[ends]] = s.axis[beside[ends]]
    return replace(s, axis=axis)


def _wanted(s: Sliding, links: Links, slack: Floats) -> Floats:
    """Area each chain has to sweep: through the places that are known, and along the sides of pixels where none are.

    So regions of a mask keep the areas of their pixels.
    """
    one, other = links.indices[:-1], links.indices[1:]
    corner = np.concatenate([links.head, links.middle[len(links.crack) :]])  # that of the pixels after each point
    detour = cross(corner[one] - s.points[one], s.points[other] - s.points[one]) / 2
    unknown = (slack[one] == REACH) & (slack[other] == REACH) & (np.diff(links.chain) == 0)
    return np.asarray(swept(s.points, s) + np.bincount(links.chain[:-1], detour * unknown, len(links.rings)))


def _settle_nodes(links: Links, passes: int = 4) -> Points:
    """Move each node to where the chains that meet there lead, within its block."""
    z, at = links.middle.copy(), links.indices
    movable = links.room != 0
    if not movable.any():
        return z
    ends = np.concatenate([links.starts[:-1][~links.rings], links.starts[1:][~links.rings] - 1])
    beside = at[ends + np.repeat([1, -1], len(ends) // 2)]
    meeting = np.maximum(np.bincount(at[ends], minlength=len(z)), 1)
    inner = np.ones(len(at), bool)
    inner[links.starts[:-1]] = inner[links.starts[1:] - 1] = False
    inner = np.flatnonzero(inner)
    for _ in range(passes):
        mean = (np.bincount(at[ends], z[beside].real, len(z)) + 1j * np.bincount(at[ends], z[beside].imag, len(z))) / meeting
        z[at[inner]] = (z[at[inner - 1]] + 2 * z[at[inner]] + z[at[inner + 1]]) / 4
        off = mean - links.middle
        off = np.clip(off.real, -links.room.real, links.room.real) + 1j * np.clip(off.imag, -links.room.imag, links.room.imag)
        z[movable] = (links.middle + off)[movable]
    return np.where(movable, z, links.middle)


def place_on_sides(cracks: Cracks, frame: Frame) -> tuple[Outlines, Links]:
    """Return the outlines that run exactly along the sides of pixels.

    Only where a checkerboard would make an outline touch itself, the tips of its pixels are cut off half-way along their sides.
    """
    links = lay_out(cracks, frame)
    n, along = len(links.crack), links.head - links.middle[: len(links.crack)]
    at = links.indices
    # After each crossing comes the corner of pixels its crack ends at, if the outline turns there, and no other passes it.
    crossing = np.flatnonzero((at[:-1] < n) & (at[1:] < n) & (links.chain[:-1] == links.chain[1:]))
    one, other = at[crossing], at[crossing + 1]
    turns = np.abs(cross(along[one], along[other])) > 0
    passes = np.searchsorted(np.sort(cracks.tail), cracks.head[links.crack[one]][:, None] + [0, 1])
    bends = one[turns & (np.diff(passes, axis=1)[:, 0] == 1)]
    links = cut(links, bends, frame)
    links = replace(links, axis=np.zeros_like(links.axis), room=np.zeros_like(links.room))
    return links.outlines(links.middle), links
