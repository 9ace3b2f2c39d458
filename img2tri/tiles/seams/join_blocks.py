"""A new mesh joined to finished pieces: what it adds to them, with no vertex hanging and no triangle twice.

Where the new mesh and the finished pieces agree, it goes on beyond their border as it is. Where they do not, its triangles near the border
give way, and the gap is triangulated: the border stays, outlines are spliced, points between keep clear, all is smoothed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, as_rows
from img2tri.tiles.seams.block_core import core_put_back, core_set_aside
from img2tri.tiles.seams.both_meshes import Both, Territory, together
from img2tri.tiles.seams.gap_attempts import ALIKE, EATEN, MOST_ATTEMPTS, SEGMENT_LENGTHS, WIDTHS, Attempt
from img2tri.tiles.seams.gap_triangulation import Gap, GapWalls, gap_filled, improved, longest_sides
from img2tri.tiles.seams.joint_check import check_joint
from img2tri.tiles.seams.outline_check import DenseOutlines, check_outlines
from img2tri.tiles.seams.outline_splices import Ways, splice
from img2tri.tiles.seams.piece_seams import Piece, SeamError, Sides, evened, find_stubs, taken
from img2tri.triangles.min_angle_tangents import smallest_angles

LOOSE_CLEARANCE = 0.66  # of the longest edge at a vertex: loose points nearer to the border are left out
SAMPLES = 4  # places along each edge of the border, to measure distances to
# Of the margin: from where on stubs, walls and triangles of the gap do not count. It is open at its ends, beyond what is taken.
WALLED, STUBS, FILLED, MET, LOST, TAKEN = 0.85, 0.8, 0.7, 0.6, 0.5, 0.35
AROUND = 1.0  # margins: how far around places where a way of filling the gap did not do the next one is tried first
CORE = 1.5  # margins: a triangle of the new mesh farther from finished pieces and borders of its block stays as it is


def merge(
    mesh: Piece, finished: Piece, territory: Territory, outlines: DenseOutlines, *, tolerance: float, min_angle: float
) -> tuple[Piece, Bools]:
    """Return what a new mesh adds to finished pieces, and which of their triangles (m,) it replaces, which are few.

    Parameters
    ----------
    mesh
        The new mesh, which reaches beyond its block on all sides by more than the margin.
    finished
        The pieces it must fit, joined.
    territory
        Where it may take triangles.
    outlines
        Of the image.
    tolerance, min_angle
        As promised of the whole mesh; px, degrees.

    Raises
    ------
    SeamError
        If outlines do not correspond, or no good triangles were found for the gap, whatever its width.
    """
    labels = np.unique(np.concatenate([mesh.regions, finished.regions, finished.beyond]))
    outside = territory.outside(mesh.vertices)
    reached = max(0.0, -float(territory.outside(finished.vertices).min(initial=0.0)))
    core = np.asarray((outside < -reached - CORE * territory.margin)[mesh.triangles].all(axis=1))
    joint = partial(_joined, finished=finished, labels=labels, outlines=outlines, tolerance=tolerance, min_angle=min_angle)
    attempt = Attempt(0, [], TAKEN * territory.margin)
    while True:
        try:
            piece, lost = joint(mesh, core, territory=territory, attempt=attempt)
            return core_put_back(mesh, core, piece), lost
        except SeamError as error:
            if attempt.count >= MOST_ATTEMPTS:
                raise
            attempt = _next_attempt(joint, mesh, core, territory, attempt.raised(error.at))


def _next_attempt(joint: Callable[..., object], mesh: Piece, core: Bools, territory: Territory, attempt: Attempt) -> Attempt:
    """Find a way that does where those before did not, looking at what is around these places only."""
    while attempt.troubles and attempt.count < MOST_ATTEMPTS:
        near = territory.around(np.concatenate(attempt.troubles), AROUND * territory.margin)
        far = (near.outside(mesh.vertices) > CORE * territory.margin)[mesh.triangles].all(axis=1)
        try:
            joint(mesh, core | far, territory=near, attempt=attempt)
            break
        except SeamError as error:
            attempt = attempt.raised(error.at)
    return attempt


def _joined(
    mesh: Piece,
    core: Bools,
    *,
    finished: Piece,
    labels: Ints,
    territory: Territory,
    attempt: Attempt,
    outlines: DenseOutlines,
    tolerance: float,
    min_angle: float,
) -> tuple[Piece, Bools]:
    """Join the mesh but for its core to finished pieces in one of the ways; return what it adds, and which triangles it replaces."""
    band, cut = core_set_aside(mesh, core)
    middle = finished.vertices[finished.triangles].mean(axis=1)
    far = territory.outside(finished.vertices)[finished.triangles].max(axis=1) > LOST * territory.margin
    lost = attempt.near(territory.margin * np.asarray(EATEN), middle) & ~far
    both = together(band, finished, lost, labels, territory, cut, attempt.of(ALIKE, band.vertices))
    return _merged(both, labels, territory, attempt, outlines, tolerance, min_angle), lost


def _merged(
    both: Both,
    labels: Ints,
    territory: Territory,
    attempt: Attempt,
    outlines: DenseOutlines,
    tolerance: float,
    min_angle: float,
) -> Piece:
    z, new, codes = both.z, both.new, both.new_codes
    sides = Sides.of(new, len(z))
    goes_on = both.beyond > 0
    covered = both.covered(z[new].mean(axis=1))
    stays = ~covered & _clear(both, goes_on & ~_agreed(both, sides), attempt)
    triangles, code = new[stays], codes[stays]
    # The border of the finished pieces where no triangle that stays is on the other side.
    rim = goes_on & ~_met(both.border, triangles, len(z))
    touched: Bools = np.asarray(both.moved[triangles].any(axis=1))
    gaping = bool((rim & (both.outside[both.border].max(axis=1) < FILLED * territory.margin)).any())
    if gaping:
        z, made, made_code = gap_filled(_gap(both, sides, stays, covered, rim, territory, attempt, tolerance))
        triangles, code = np.concatenate([triangles, made]), np.concatenate([code, made_code])
        touched = np.append(touched, np.ones(len(made), bool))
    if touched.any():
        fixed = np.zeros(len(both.z), bool)
        fixed[both.old] = True
        fixed[both.cut] = True
        # An angle that the image's own corners force is no fault of the seam.
        own = new[~both.moved[new].any(axis=1)]
        least = min(min_angle, float(smallest_angles(both.z, own).min(initial=180.0)))
        z, triangles, code = improved(z, triangles, code, touched, fixed, np.concatenate([both.border, both.cut]), least - 1e-9)
        check_outlines(z, triangles, code, both, MET * territory.margin, outlines, tolerance)
    near = rim & (both.outside[both.border].max(axis=1) < MET * territory.margin)
    lonely = ~_met(both.border[near], triangles, len(z))
    if lonely.any():
        raise SeamError("an edge of the finished pieces has no triangle beyond", z[both.border[near][lonely, 0]])
    met = both.border[goes_on][:, ::-1]
    middle = z[triangles].mean(axis=1)
    eligible = territory.outside(z)[triangles].max(axis=1) < MET * territory.margin
    radii = np.asarray(EATEN)
    first = (territory.takes(middle) | attempt.near(territory.margin * (radii + 0.1) * (radii > 0), middle)) & eligible
    takes = evened(triangles, code, first, eligible, met, len(z))
    lonely = ~_met(both.border[both.fresh], triangles[takes], len(z))
    if lonely.any():
        raise SeamError("what was given up is not filled", z[both.border[both.fresh][lonely, 0]])
    piece = taken(z, triangles, labels[code - 1], takes, met, labels[both.own[goes_on] - 1])
    check_joint(piece, both, labels, MET * territory.margin)
    return piece


def _met(border: Ints, triangles: Ints, n: int) -> Bools:
    """Tell which border edges have one of the triangles on their right."""
    return np.isin(border[:, 0] * n + border[:, 1], triangles[:, [1, 2, 0]] * n + triangles)


def _agreed(both: Both, sides: Sides) -> Bools:
    """Tell which border edges the new mesh has too, with a triangle of the right region beyond."""
    n, low, high = len(both.z), both.border.min(axis=1), both.border.max(axis=1)
    keys = sides.low * n + sides.high
    if not len(keys):
        return np.zeros(len(low), bool)
    at = np.minimum(np.searchsorted(keys, low * n + high), len(keys) - 1)
    left, right = sides.codes(both.new_codes)
    there = np.where(both.border[:, 0] == low, right[at], left[at])
    return np.asarray((keys[at] == low * n + high) & (there == both.beyond))


def _clear(both: Both, rim: Bools, attempt: Attempt) -> Bools:
    """Tell which new triangles have no vertex in finished pieces, nor too near to a border they do not fit."""
    z, new = both.z, both.new
    own = np.unique(new)
    gone = np.zeros(len(z), bool)
    gone[own] = _distance(both, rim, z[own]) < attempt.of(WIDTHS, z[own]) * longest_sides(z, new)[own]
    shared = np.zeros(len(z), bool)
    shared[both.old] = True
    loose = own[~shared[own]]
    gone[loose] |= both.covered(z[loose])
    return np.asarray(~gone[new].any(axis=1))


def _distance(both: Both, rim: Bools, places: Points) -> Floats:
    """Distance of places from the edges of a rim, measured to samples."""
    from scipy.spatial import cKDTree

    if not rim.any():
        return np.full(len(places), np.inf)
    a, b = both.z[both.border[rim]].T
    samples = np.concatenate([(a[:, None] + np.arange(SAMPLES) / SAMPLES * (b - a)[:, None]).ravel(), b])
    return np.asarray(cKDTree(as_rows(samples)).query(as_rows(places))[0])


def _gap(
    both: Both, sides: Sides, stays: Bools, covered: Bools, rim: Bools, territory: Territory, attempt: Attempt, tolerance: float
) -> Gap:
    """Find the walls of the gap, and the points in it."""
    z, n, margin = both.z, len(both.z), territory.margin
    pinned = np.zeros(n, bool)
    pinned[both.new[stays]] = True
    held = np.append(stays, False)
    left, right = sides.codes(both.new_codes)

    # The border of the finished pieces, and that of the triangles that stay.
    walls = [GapWalls(both.border[rim], np.zeros(rim.sum(), np.int64), both.beyond[rim])]
    keys = both.border * n + both.border[:, ::-1]
    one = (held[sides.left] != held[sides.right]) & ~np.isin(sides.low * n + sides.high, keys)
    segments = np.stack([sides.low, sides.high], axis=1)[one]
    walls.append(GapWalls(segments, np.where(held[sides.left], 0, left)[one], np.where(held[sides.right], 0, right)[one]))

    # Outlines through it.
    ways = Ways.of(sides, both.new_codes, n)
    stubs = find_stubs(z, both.border, both.beyond)
    # The outlines of both differ, but the middle of a triangle beside them tells on which side of the border one is.
    known = np.append(stays | covered, False)
    settled = (known[sides.left] | known[sides.right])[ways.edge]
    on_rim = np.zeros(n, bool)
    on_rim[both.border[rim]] = True
    wanted = on_rim[stubs.at] & ~pinned[stubs.at] & (both.outside[stubs.at] < STUBS * margin)
    stubs = stubs.chosen(wanted)
    added, segments, low, high = splice(z, ways, stubs, attempt.of(SEGMENT_LENGTHS, z[stubs.at]), pinned, settled, tolerance)
    walls.append(GapWalls(segments, low, high))

    # Loose points, clear of the border.
    loose = np.zeros(n, bool)
    loose[both.new[~stays]] = True
    loose[both.old] = False
    loose[ways.start] = loose[ways.stop] = False
    loose = np.flatnonzero(loose & ~pinned)
    loose = loose[(_distance(both, rim, z[loose]) > LOOSE_CLEARANCE * longest_sides(z, both.new)[loose]) & ~both.covered(z[loose])]

    every = GapWalls.together(walls)
    z = np.concatenate([z, added])
    near = np.asarray((np.concatenate([both.outside, territory.outside(added)])[every.segments] < WALLED * margin).all(axis=1))
    return Gap(
        z, every.chosen(near), loose,
        inside=lambda places: territory.outside(places) < FILLED * margin, met=lambda places: territory.outside(places) < MET * margin,
    )  # fmt: skip
