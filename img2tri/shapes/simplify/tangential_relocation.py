"""Tangential relocation: vertices slide along their outline, for the sake of the triangles beside them.

Vertices may slide along an outline without changing its shape. Spread evenly, they lie by chance with respect to the vertices across an
arm, and to the points inside. So the mesh may move them, parallel to the line between their neighbours, which keeps the area (as
boundary vertices are moved in mesh smoothing, e.g. Knupp, "Introducing the target-matrix paradigm", 2012, DOI
10.1007/s00366-011-0230-1). What comes back has to keep the tolerance as any coarse outline does; vertices for which that takes more of
them than there were slide half as far, or stay.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_complex
from img2tri.shapes.simplify.area_preservation import of_regions_off, share_areas
from img2tri.shapes.simplify.clearance import to_segment
from img2tri.shapes.simplify.simplification import SAME_PLACE, Simplification
from img2tri.shapes.simplify.tolerance import SHORTEST_CHORD, enforce_tolerance
from img2tri.shapes.simplify.vertex_offsets import NormalOffsets

SLIDE = 0.15  # of the shorter chord beside a vertex: how far it may slide
STRAIGHT = 35.0  # degrees: vertices at which the outline turns by more stay
RETURNS = 4  # how often vertices go back one by one, at first half of their way; then all do


def slide_limits(s: Simplification, *, shortest: float = 0.0, share: float | None = None, snapped: bool = False) -> Floats:
    """Return how far each point of the coarse outline (n,) may slide, in px; chords do not get shorter than `shortest` by that.

    `share` is that of the shorter chord beside a point, usually `SLIDE`; with `snapped` points slide too that went back to their middles.
    """
    free = NormalOffsets(s, snapped=snapped)
    here = s.places[free.at]
    before, after = here - s.places[free.behind], s.places[free.ahead] - here
    length = np.minimum(np.abs(before), np.abs(after))
    straight = (after * before.conj()).real > np.cos(np.radians(STRAIGHT)) * np.abs(before) * np.abs(after)
    room = np.minimum((SLIDE if share is None else share) * length, (length - max(shortest, SHORTEST_CHORD)) / 2)
    result = np.zeros(len(s.offset))
    result[free.at] = straight * np.maximum(0, room)
    result[s.chains.first] = 0  # what a ring begins and ends with stays
    return np.asarray(result[s.entries])


def relocate(s: Simplification, points: Floats, *, tolerance: float, keep_area: bool = True) -> Simplification:
    """Put the points (n, 2) of the coarse outline where the mesh wants them, as far as may be; areas are kept if asked for."""
    old, way = s.entries, as_complex(points) - s.places[s.entries]
    for attempt in range(RETURNS):
        goes = np.abs(way) > SAME_PLACE
        old, way = old[goes], way[goes]
        places = s.places[old] + way
        new = _nearest(s, old, places)
        # What went back to the middle of its crack edge is not looked at again, see `tolerance`: it stays near its dense point.
        off = np.where(s.snapped_entries[new], np.abs(places - s.dense[new]), _distance_to_outline(s, new, places))
        goes = off <= tolerance
        tried = _relocated(s, old[goes], new[goes], places[goes])
        if keep_area:
            slid = np.zeros(len(s.kept), bool)
            slid[new[goes]] = True
            tried = share_areas(tried, slid, tolerance=tolerance)
        found = enforce_tolerance(tried, tolerance=tolerance, passed=s)
        failed = _mended(tried, found)
        if not failed.any():
            return _with_areas_shared(found, tolerance) if keep_area else found
        # Of a chord in which something had to be done both ends go half as far, and then none.
        first, last = tried.chords
        count = np.concatenate([[0], np.cumsum(failed)])
        back = count[last + 1] > count[first]
        ends = np.zeros(len(failed), bool)
        ends[first[back]] = ends[last[back]] = True
        way = np.where(goes & ~ends[new], way, 0.5 * way * (attempt == 0))
    return s


def _mended(tried: Simplification, found: Simplification) -> Bools:
    """Tell for which entries (k,) something had to be done to keep the tolerance."""
    return np.asarray((found.kept != tried.kept) | (found.snapped_entries != tried.snapped_entries))


def _with_areas_shared(s: Simplification, tolerance: float) -> Simplification:
    """Offset all vertices of regions whose areas those that slid could not keep, if the tolerance allows it without more ado."""
    off = of_regions_off(s)
    if not off.any():
        return s
    tried = share_areas(s, off, tolerance=tolerance)
    found = enforce_tolerance(tried, tolerance=tolerance, passed=s)
    return s if _mended(tried, found).any() else found


def _nearest(s: Simplification, old: Ints, places: Points) -> Ints:
    """Entries whose dense points are nearest to where vertices slide; each keeps to its half of the chords beside it."""
    z, at = s.dense, s.kept.nonzero()[0]
    arc = np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])
    along = z[old + 1] - z[old - 1]
    wanted = arc[old] + ((places - z[old]) * along.conj()).real / np.maximum(np.abs(along), 1e-12)
    after = np.clip(np.searchsorted(arc, wanted), 1, len(arc) - 1)
    nearest = after - (wanted - arc[after - 1] < arc[after] - wanted)
    rank = np.searchsorted(at, old)
    return np.asarray(np.clip(nearest, (at[rank - 1] + old) // 2 + 1, (old + at[rank + 1]) // 2))


def _distance_to_outline(s: Simplification, entries: Ints, places: Points) -> Floats:
    """How far places are from the dense outline near entries."""
    z = s.dense
    return np.minimum(to_segment(places, z[entries - 1], z[entries]), to_segment(places, z[entries], z[entries + 1]))


def _relocated(s: Simplification, old: Ints, new: Ints, places: Points) -> Simplification:
    """Put vertices to other entries and places."""
    kept, offset = s.kept.copy(), s.offset.copy()
    kept[old] = False
    offset[old] = 0
    kept[new] = True
    offset[new] = places - s.dense[new]
    return replace(s, kept=kept, offset=offset)
