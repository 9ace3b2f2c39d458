"""Coarse outlines -> coarse outlines that enclose what the dense ones enclose, region by region, and still keep the tolerance.

What `preserve_areas` does for one region may have to be given up for the sake of clearance, and may take area from a neighbour. So it
is done again for the regions that are still off, as long as that helps; the best of all rounds is taken.
"""

from __future__ import annotations

import math

from img2tri.shapes.periodic.paired_outlines import PeriodicPairs
from img2tri.shapes.simplify.area_preservation import area_errors, preserve_areas
from img2tri.shapes.simplify.simplification import Simplification

AREA_ERROR = 1e-4  # relative, of a region: above it vertices are offset for its sake, at first
FOR_ALL = 1  # rounds for all regions
STILL_OFF = 0.0003  # relative, of a region: above it this is done again
MOST_AREA_ROUNDS = 24  # of all; the best is taken


def with_areas_preserved(coarse: Simplification, pairs: PeriodicPairs, *, tolerance: float) -> Simplification:
    """Offset the vertices of coarse outlines until each region of more than a few pixels has its area, as far as the tolerance allows."""
    best, least = coarse, math.inf
    for attempt in range(MOST_AREA_ROUNDS + 1):
        error, first = float(area_errors(coarse).max()), attempt < FOR_ALL
        if error < least:
            best, least = coarse, error
        if attempt == MOST_AREA_ROUNDS or error <= (AREA_ERROR if first else STILL_OFF):
            break
        moved = preserve_areas(coarse, tolerance=tolerance, above=0.0 if first else STILL_OFF / 2)
        coarse = pairs.enforce_tolerance(moved, tolerance=tolerance, passed=coarse)
    return best
