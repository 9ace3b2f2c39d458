"""Breaks that slide along their outline, for the sake of the triangles beside them.

Where along an outline its breaks lie is no matter of the outline: spread evenly they are placed by chance with respect to the breaks
across an arm, and to the points inside. So the mesh may move them, parallel to the line between their neighbours, which keeps
the area. What comes back is settled as any coarse outline is; where that takes more breaks than there were, they go back.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.shapes.place.padded_chains import Points
from img2tri.shapes.simplify.area_preservation import keep_areas
from img2tri.shapes.simplify.clearance import to_segment
from img2tri.shapes.simplify.simplification import SAME, Draft
from img2tri.shapes.simplify.tolerance import SHORT, settle
from img2tri.shapes.simplify.vertex_offsets import Sideways
from img2tri.types import Floats, Ints

SLIDE = 0.15  # of the shorter piece beside a break: how far it may slide
STRAIGHT = 35.0  # degrees: breaks at which the outline turns by more stay
ROUNDS = 4  # how often breaks go back one by one; then all do


def rooms(d: Draft, *, shortest: float = 0.0) -> Floats:
    """Return how far each point of the coarse outline (n,) may slide, in px; pieces do not get shorter than `shortest` by that."""
    free = Sideways(d)
    here = d.places[free.at]
    before, after = here - d.places[free.behind], d.places[free.ahead] - here
    length = np.minimum(np.abs(before), np.abs(after))
    straight = (after * before.conj()).real > np.cos(np.radians(STRAIGHT)) * np.abs(before) * np.abs(after)
    result = np.zeros(len(d.moved))
    result[free.at] = straight * np.maximum(0, np.minimum(SLIDE * length, (length - max(shortest, SHORT)) / 2))
    result[d.outlines.starts[:-1]] = 0  # what a ring begins and ends with stays
    return np.asarray(result[d.entries])


def slid(d: Draft, points: Floats, *, tolerance: float, keep_area: bool = True) -> Floats:
    """Return where the points (n, 2) of the coarse outline may be, which the mesh wants at these places; areas are kept if asked for."""
    entries, places = d.entries, points[:, 0] + 1j * points[:, 1]
    goes = np.abs(places - d.places[entries]) > SAME
    old, places = entries[goes], places[goes]
    new = _nearest(d, old, places)
    goes = _astray(d, new, places) <= tolerance
    for _ in range(ROUNDS):
        old, new, places = old[goes], new[goes], places[goes]
        tried = _placed(d, old, new, places)
        if keep_area:
            tried = keep_areas(tried, tolerance=tolerance, whole=True)
        found = settle(tried, tolerance=tolerance)
        failed = (found.breaks != tried.breaks) | (found.reset != tried.reset)[d.outlines.indices]
        if not failed.any():
            return found.coarse().points
        # A piece in which something had to be done takes both its ends back.
        first, last = tried.pieces
        count = np.concatenate([[0], np.cumsum(failed)])
        back = count[last + 1] > count[first]
        ends = np.zeros(len(failed), bool)
        ends[first[back]] = ends[last[back]] = True
        goes = ~ends[new]
    return d.coarse().points


def _nearest(d: Draft, old: Ints, places: Points) -> Ints:
    """Entries whose dense points are nearest to where breaks slide; each keeps to its half of the pieces beside it."""
    z, at = d.dense[d.outlines.indices], np.flatnonzero(d.breaks)
    arc = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    along = z[old + 1] - z[old - 1]
    wanted = arc[old] + ((places - z[old]) * along.conj()).real / np.maximum(np.abs(along), 1e-12)
    after = np.clip(np.searchsorted(arc, wanted), 1, len(arc) - 1)
    nearest = after - (wanted - arc[after - 1] < arc[after] - wanted)
    rank = np.searchsorted(at, old)
    return np.asarray(np.clip(nearest, (at[rank - 1] + old) // 2 + 1, (old + at[rank + 1]) // 2))


def _astray(d: Draft, entries: Ints, places: Points) -> Floats:
    """How far places are from the dense outline near entries."""
    z = d.dense[d.outlines.indices]
    return np.minimum(to_segment(places, z[entries - 1], z[entries]), to_segment(places, z[entries], z[entries + 1]))


def _placed(d: Draft, old: Ints, new: Ints, places: Points) -> Draft:
    """Put breaks to other entries and places; all pieces are to be tested again."""
    breaks, moved = d.breaks.copy(), d.moved.copy()
    breaks[old] = False
    moved[old] = 0
    breaks[new] = True
    moved[new] = places - d.dense[d.outlines.indices[new]]
    unknown = np.full(len(moved), -1)
    return replace(d, breaks=breaks, moved=moved, measured=unknown, tested=unknown)
