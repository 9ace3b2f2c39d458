"""What the constants of this room are worth: measures of outlines, each better if it is less, that a wrong constant makes worse.

No mesh is made, so nothing here depends on how triangles are. Whoever makes something better may lower the values. That a constant
matters is shown too: halved, doubled or gone, it makes one of the measures worse; a constant that does not is not worth having.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
import specimens
from benchmarks.shapes import blob, gear
from scipy.spatial import Voronoi, cKDTree
from tuning import change

from img2tri import mesh_image
from img2tri.arrays import as_complex, as_rows
from img2tri.raster.labels.segmentation import Segmentation
from img2tri.recipes import conforming
from img2tri.recipes.conforming import _spaced, trace_outlines
from img2tri.recipes.preserved_areas import with_areas_preserved
from img2tri.recipes.wanted_sizes import Sizes
from img2tri.shapes.periodic.paired_outlines import find_periodic_pairs
from img2tri.shapes.simplify.area_preservation import area_errors
from img2tri.shapes.simplify.simplification import space_evenly
from img2tri.shapes.simplify.tangential_relocation import relocate, slide_limits
from img2tri.shapes.simplify.tolerance import deviations
from img2tri.shapes.sizes.outline_sizes import by_curvature, by_thickness, limit_growth
from img2tri.shapes.trace.dual_edges import pixel_areas
from img2tri.shapes.trace.nonsquare_pixels import with_turning_points
from img2tri.types import Frame

RNG = np.random.default_rng(5)
SHIFTS = RNG.uniform(-0.5, 0.5, (3, 2))
Y, X = np.mgrid[:90, :90] + 0.5
NOISE = {name: RNG.normal(0, 1, (90, 90)) for name in ("gray", "scanned")}
LABELS = {
    "blob": blob(128, seed=4, holes=2).astype(int),
    "gear": gear(9, 110, 0.2).astype(int),
    "grains": specimens.polycrystal(90, 14, 3),
    "noise": RNG.integers(0, 2, (24, 27)),
    "crystal": specimens.polycrystal(200, 250, 1),
    **{f"gear {k}": gear(9 + k, 130, 0.13 * k).astype(int) for k in range(5)},
    "specks": np.kron(RNG.integers(1, 4, (14, 14)), np.ones((4, 4), int)),
}


RANDOM = np.random.default_rng(5)
MAPS = [RANDOM.integers(1, RANDOM.integers(3, 6), (RANDOM.integers(5, 9), RANDOM.integers(5, 9))) for _ in range(120)]
TINY = [MAPS[k] for k in (8, 18, 46, 12, 95, 29, 55, 74, 65, 96, 36, 84)]  # where constants show most


def traced(labels, gray=None, level=None, spacing=(1.0, 1.0)):
    return trace_outlines(Segmentation(labels, 0, gray=gray, level=level), Frame(labels.shape, spacing=spacing))


def rms(off):
    return float(np.sqrt(np.mean(np.concatenate([np.ravel(one) for one in off]) ** 2)))


# ---- where outlines lie ----


def discs(radius):
    """Root mean square of the distance between the outlines of discs and circles."""
    off = []
    for shift in SHIFTS:
        n = int(2 * radius) + 12
        x, y = n / 2 + shift
        points = traced(specimens.disc(n, radius, (n - y, x)))[0].points
        off.append(np.hypot(*(points - (x, y)).T) - radius)
    return rms(off)


def ellipses():
    """Root mean square of the distance between the outlines of turned ellipses and these, told by the value of the quadratic form."""
    off = []
    for k, shift in enumerate(SHIFTS):
        turn, x, y = np.exp(1j * (0.3 + k)), 60 + shift[0], 60 + shift[1]
        r, c = np.mgrid[:120, :120] + 0.5
        inner = ((c - x) + 1j * (120 - r - y)) / turn
        z = (as_complex(traced((np.hypot(inner.real / 50, inner.imag / 20) < 1).astype(int))[0].points) - (x + 1j * y)) / turn
        form = np.hypot(z.real / 50, z.imag / 20)
        off.append((form - 1) * form / np.hypot(z.real / 2500, z.imag / 400))
    return rms(off)


def halves(radius):
    """The same for discs that are cut in two, at least 3 px from the cut, and how far from it nodes lie."""
    off, nodes = [], []
    for shift in SHIFTS:
        n = int(2 * radius) + 12
        x, y = n / 2 + shift
        labels = specimens.disc(n, radius, (n - y, x))
        labels = labels * (1 + (np.mgrid[:n, :n][1] + 0.5 > x + 0.3 * radius))
        outlines, dual_edges = traced(labels)
        from_cut = outlines.points[:, 0] - x - 0.3 * radius
        round_part = np.abs(np.hypot(*(outlines.points - (x, y)).T) - radius) < 1.5
        off.append((np.hypot(*(outlines.points - (x, y)).T) - radius)[round_part & (np.abs(from_cut) > 3)])
        at = outlines.points[len(dual_edges.crossed) :]
        nodes.append(np.hypot(*(at - (x, y)).T) - radius)
    return rms(off), rms(nodes)


def walls():
    """How far the outlines between straight grains are from the lines that part them, and their nodes from where these meet."""
    off = []
    for seed in (1, 2, 3):
        seeds = np.random.default_rng(seed).random((9, 2)) * 80
        y, x = np.mgrid[:80, :80] + 0.5
        labels = np.argmin([np.hypot(80 - y - r, x - c) for r, c in seeds], axis=0) + 1
        outlines, _ = traced(labels)
        places = outlines.points[(outlines.points > 4).all(axis=1) & (outlines.points < 76).all(axis=1)]
        apart = np.sort(np.hypot(*(places[:, None] - seeds[None, :, ::-1]).transpose(2, 0, 1)), axis=1)
        off.append((apart[:, 1] - apart[:, 0]) / 2)
    return rms(off)


def cells():
    """How far nodes of small straight grains are from where these meet."""
    off = []
    for seed in range(3):
        seeds = np.random.default_rng(seed).random((150, 2)) * 80
        y, x = np.mgrid[:80, :80] + 0.5
        labels = np.argmin([np.hypot(80 - y - r, x - c) for r, c in seeds], axis=0) + 1
        outlines, dual_edges = traced(labels)
        met = Voronoi(seeds[:, ::-1]).vertices
        met = met[((met > 3) & (met < 77)).all(axis=1)]
        alone = cKDTree(met).query(met, k=2)[0][:, 1] > 3
        far = cKDTree(outlines.points[dual_edges.is_junction]).query(met)[0]
        off.append(far[alone & (far < 1.5)])
    return rms(off)


def framed():
    """How far half discs at the frame are from circles."""
    off = []
    for shift in SHIFTS:
        labels = specimens.disc(60, 24.3, (60.0, 30 + shift[0]))[:60]
        points = traced(labels)[0].points
        round_part = points[points[:, 1] > 0.01]
        off.append(np.hypot(round_part[:, 0] - 30 - shift[0], round_part[:, 1]) - 24.3)
    return rms(off)


def polygons():
    """Corners of turned rectangles that are not found, or found where none is; and how far the others are off."""
    missed, off = 0, []
    for k, angle in enumerate(range(4, 90, 9)):
        sides = (14 + 3 * k, 20 + 2 * k)
        labels = specimens.rectangle(80, sides, angle)
        outlines, dual_edges = traced(labels)
        half = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * np.asarray(sides) / 2
        true = as_complex(half) * np.exp(1j * np.radians(angle)) + 40 * (1 + 1j)
        found = as_complex(outlines.points[dual_edges.is_corner])
        if not len(found):
            missed += 4
            continue
        apart = np.abs(true[:, None] - found[None])
        hit = apart.min(axis=1) < 1.5
        missed += int((~hit).sum()) + max(0, len(found) - int(hit.sum()))
        off.append(apart.min(axis=1)[hit])
    return float(missed), rms(off)


def squares():
    """Corners of squares along rows and columns, of 3 px, that are missed."""
    labels = np.pad(np.kron([[1, 0, 1, 0, 1]], np.ones((3, 3), int)), 3)
    round_shapes = sum(int(traced(specimens.disc(40, r))[1].is_corner.sum()) for r in (4.2, 6.3, 9.1, 13.7))
    return float(12 - traced(labels)[1].is_corner.sum() + round_shapes)


def teeth():
    """Corners of a gear that are missed: 36."""
    return float(abs(36 - int(traced(gear(9, 220, 0.2).astype(int))[1].is_corner.sum())))


def gray():
    """Discs in gray: noisy ones, and hard ones with a little noise."""
    circle = 30.3 - np.hypot(X - 45.2, 90 - Y - 44.7)
    soft = 255 * np.clip(circle + 0.5, 0, 1) + 20 * NOISE["gray"]
    hard = 180 * (circle > 0) + 2 * NOISE["scanned"]
    clean = 255 * np.clip(circle + 0.5, 0, 1)
    result = []
    for values, level in ((clean, 127.5), (soft, 127.5), (hard, 90.0)):
        labels = largest(values > level)
        points = traced(labels, gray=values, level=level)[0].points
        result.append(rms([np.hypot(*(points - (45.2, 44.7)).T) - 30.3]))
    return tuple(result)


def colours():
    """How far from a circle a disc of two flat colours on a third is, drawn by coverage, but where these meet."""
    y, x = (np.mgrid[:480, :480] + 0.5) / 8
    disc = np.hypot(x - 30.2, y - 29.7) < 20.3
    halves = np.where((x > 30.2 + 0.3 * (y - 30))[..., None], (30, 30, 200), (200, 30, 30))
    drawn = np.where(disc[..., None], halves, 255).reshape(60, 8, 60, 8, 3).mean(axis=(1, 3))
    points = mesh_image(np.rint(drawn).astype(np.uint8), colors=3, edge_length=20).origin.outlines.points
    x, y = points[:, 0] - 30.2, 30.3 - points[:, 1]
    off = np.hypot(x, y) - 20.3
    return rms([off[(np.abs(off) < 2) & (np.abs(x - 0.3 * y) > 2.1)]])


def ramps():
    """A disc in gray with a slow and noisy edge, by a level and by the middle of both sides."""
    from scipy.ndimage import gaussian_filter

    values = gaussian_filter(200.0 * (np.hypot(X - 45.2, 90 - Y - 44.7) < 30.3), 1.5) + 6 * NOISE["gray"]
    labels, result = largest(values > 100), []
    for level in (100.0, None):
        points = traced(labels, gray=values, level=level)[0].points
        result.append(rms([np.hypot(*(points - (45.2, 44.7)).T) - 30.3]))
    return tuple(result)


def largest(mask):
    from scipy.ndimage import binary_closing, label

    parts, _ = label(binary_closing(mask))
    return (parts == np.bincount(parts.ravel())[1:].argmax() + 1).astype(int)


# ---- how they are simplified ----


@cache
def dense(name):
    return traced(LABELS[name])


def coarse(name, length=7.0):
    return made_coarse(*dense(name), length, 0.5)


def made_coarse(outlines, dual_edges, length, tolerance):
    pairs = find_periodic_pairs(outlines, dual_edges, None)
    spaced = _spaced(outlines, dual_edges, pairs, Sizes(length, 0.17), tolerance, False, True)
    return with_areas_preserved(spaced, pairs, tolerance=tolerance)


def simplified(name):
    """The number of chords; the mean logarithm of how much longer a chord is than its neighbour; 1 / the shortest; the worst area."""
    s = coarse(name)
    first, last = s.chords
    length = np.abs(s.places[last] - s.places[first])
    ratio = (length[1:] / length[:-1])[last[:-1] == first[1:]]
    return float(len(first)), float(np.abs(np.log(ratio)).mean()), float(1 / length.min()), float(area_errors(s).max())


def enclosed(outlines):
    """Area of each region number."""
    z = as_complex(outlines.points)[outlines.chains.indices]
    swept = np.append((z[:-1].conj() * z[1:]).imag / 2, 0)
    swept[outlines.chains.last] = 0
    of_chain = np.bincount(outlines.chains.chain, swept)
    size = len(outlines.labels)
    return np.bincount(outlines.left, of_chain, size) - np.bincount(outlines.right, of_chain, size)


def area_error(s):
    """The greatest of the regions of more than 16 px, in %."""
    wanted, found = pixel_areas(s.dual_edges)[1:], enclosed(s.coarse())[1:]
    return 100 * float((np.abs(found - wanted) / wanted)[wanted > 16].max(initial=0))


def sharpest(outlines):
    """The least angle between outlines that meet, in degrees."""
    z = as_complex(outlines.points)[outlines.chains.indices]
    chains, opened = outlines.chains, ~outlines.chains.rings
    first, last = chains.first[opened], chains.last[opened]
    node = chains.indices[np.concatenate([first, last])]
    heading = np.angle(np.concatenate([z[first + 1] - z[first], z[last - 1] - z[last]]))
    order = np.lexsort((heading, node))
    node, heading = node[order], heading[order]
    begins = np.flatnonzero(np.diff(node, prepend=-1))
    after = np.append(heading[1:], 0)
    ends = np.append(begins[1:], len(node)) - 1
    after[ends] = heading[begins] + 2 * np.pi
    return float(np.degrees((after - heading).min()))


def tiny(spacing=(1.0, 1.0), count=12):
    """Random maps of a few pixels: chords, 1 / the shortest, the worst area (%), and how much the sharpest meeting lacks of 60 degrees."""
    rows = []
    for labels in TINY[:count]:
        outlines, dual_edges = traced(labels, spacing=spacing)
        s = made_coarse(*with_turning_points(outlines, dual_edges), 3.0, 0.5)
        first, last = s.chords
        shortest = max(np.abs(s.places[last] - s.places[first]).min(), 1e-9)
        rows.append((len(first), 1 / shortest, area_error(s), max(0.0, 60 - sharpest(outlines))))
    found = np.array(rows)
    return float(found[:, 0].sum()), float(found[:, 1].mean()), float(found[:, 2].max()), float(found[:, 3].mean())


def long_chords():
    """Discs in few chords: the number of these, and the worst area (%)."""
    discs = (3.2, 0.2), (8.3, 0.2), (8.3, 0.5), (30.1, 0.5)
    found = [made_coarse(*traced(specimens.disc(int(2 * radius) + 8, radius)), 40.0, tolerance) for radius, tolerance in discs]
    return float(sum(len(s.chords[0]) for s in found)), max(map(area_error, found))


def crystal():
    """The number of chords of many grains, and the mean of 1 / their length."""
    outlines, dual_edges = dense("crystal")
    pairs = find_periodic_pairs(outlines, dual_edges, None)
    s = _spaced(outlines, dual_edges, pairs, Sizes(7.0, 0.17), 0.5, False, True, least_angle=conforming.WEDGE)
    first, last = s.chords
    return float(len(first)), float((1 / np.abs(s.places[last] - s.places[first])).mean())


def checkers():
    """The worst area of the regions of a small checkerboard (%)."""
    s = made_coarse(*traced(specimens.LABELS["checkerboard of two"]), 3.0, 0.5)
    return (100 * float(np.abs(enclosed(s.coarse())[1:] / pixel_areas(s.dual_edges)[1:] - 1).max()),)


def gears():
    """The number of chords of five gears."""
    return (float(sum(len(coarse(f"gear {k}", 6.0).chords[0]) for k in range(5))),)


def ring():
    """How far a disc is from its chords where very long ones are asked for."""
    s = space_evenly(*traced(specimens.disc(30, 11.3)), spacing=100.0)
    return (float(deviations(s, *s.chords).max()),)


def slid():
    """How far outlines are off whose vertices are asked to slide, and the mean of 1 / the limits that are set to that."""
    off, limited = [], []
    for name in ("blob", "gear", "grains"):
        s = coarse(name)
        limits = slide_limits(s, shortest=0.0)
        points = as_complex(s.coarse().points)
        asked = points + 0.8 * limits * np.exp(1j * np.arange(len(points)))
        went = as_complex(relocate(s, as_rows(asked), tolerance=0.5, keep_area=True).coarse().points)
        lines = shapely.linestrings(went[s.coarse().segments[0]].view(np.float64).reshape(-1, 2, 2))
        off.append(shapely.distance(shapely.points(s.outlines.points), shapely.union_all(lines)).max())
        limited.append(1 / limits.mean())
    return float(max(off)), float(np.mean(limited))


def sized():
    """Relative errors of lengths by the thickness of a ring, by the curvature of a disc; the mean of lengths whose growth is limited."""
    outlines, dual_edges = traced(specimens.disc(80, 35.1) - specimens.disc(80, 29.9))
    z = as_complex(outlines.points)[outlines.chains.indices]
    thin = np.minimum(limit_growth(by_thickness(z, dual_edges, 8.0, 2.0), z, outlines.chains, 0.17), 8.0) / 2.6
    outlines, dual_edges = traced(specimens.disc(90, 33.3))
    turn = by_curvature(as_complex(outlines.points)[outlines.chains.indices], outlines.chains, 50.0, 40.0) / (2 * np.pi * 33.3 / 40)
    grains, _ = dense("grains")
    z = as_complex(grains.points)[grains.chains.indices]
    size = np.full(len(z), 40.0)
    size[:3] = 1.0
    return float(np.abs(thin - 1).mean()), float(np.abs(np.log(turn)).mean()), float(limit_growth(size, z, grains.chains, 0.17).mean())


GROUPS = {
    "disc 6": lambda: (discs(6.4),), "disc 10": lambda: (discs(10.3),), "disc 21": lambda: (discs(21.3),),
    "disc 60": lambda: (discs(60.2),),
    "ellipses": lambda: (ellipses(),), "halves": lambda: halves(25.4), "walls": lambda: (walls(),), "framed": lambda: (framed(),),
    "polygons": polygons, "squares": lambda: (squares(),), "teeth": lambda: (teeth(),), "gray": gray, "ramps": ramps,
    "colours": lambda: (colours(),),
    **{name: (lambda name=name: simplified(name)) for name in ("blob", "gear", "grains", "noise", "specks")},
    "gears": gears, "ring": ring, "slid": slid, "sized": sized, "cells": lambda: (cells(),), "long": long_chords,
    "checkers": checkers, "crystal": crystal,
    "tiny": tiny, "oblong": lambda: tiny((1.5, 1.0), 8), "wide": lambda: tiny((3.0, 1.0), 8),
    "nearly": lambda: tiny((1.15, 1.0), 5),
}  # fmt: skip

REACHED = {
    "disc 6": (0.0755,), "disc 10": (0.0515,), "disc 21": (0.0347,), "disc 60": (0.0255,), "ellipses": (0.111,),
    "halves": (0.0463, 0.0505), "walls": (0.059,), "framed": (0.0418,),
    "polygons": (0.0, 0.23), "squares": (0.0,), "teeth": (18.0,), "gray": (0.0040, 0.055, 0.038), "ramps": (0.138, 0.158),
    "colours": (0.0155,),
    "blob": (85, 0.03), "gear": (118, 0.12), "grains": (172, 0.115), "noise": (650, 0.25, 2.8), "specks": (540, 0.2),
    "gears": (745,), "ring": (1.1,), "slid": (0.5, 2.3), "sized": (0.03, 0.031, 31.5), "cells": (0.34,), "long": (120, 0.03),
    "tiny": (1460, 2.5, 0.06, 5.0), "oblong": (1140, 4.7, 0.08, 8.2), "wide": (1270, 2.6, 0.04, 20.5), "nearly": (580, 2.4, 0.06, 4.8),
    "checkers": (5.6,), "crystal": (2110, 0.41),
}  # fmt: skip

MATTERS = [
    ("BOUND", 0.5, "disc 21", 0), ("NARROW", 0.5, "disc 6", 0), ("WIDTH", 0.5, "disc 21", 0), ("WIDE", 0.5, "disc 60", 0),
    ("RING_SCALES", 2, "gray", 0), ("BENDS", 0.5, "disc 60", 0), ("MOST_BEND", 0.5, "disc 60", 0), ("BEND", 0.5, "disc 21", 0),
    ("ROUNDEST", 0.5, "disc 6", 0), ("LENGTHS", 0.5, "polygons", 0), ("OUT_OF_BLOCK", 0.5, "polygons", 0),
    ("SHORTEST_SIDE", 2, "polygons", 0), ("SLOPPY", 0, "polygons", 0), ("SKIPPED", 2, "polygons", 1), ("SAME_CORNER", 2, "squares", 0),
    ("SHORTEST_ALIGNED", 2, "squares", 0), ("HARD", 0.5, "gray", 0), ("SURE", 0.5, "ramps", 0),
    ("SURE_AREA", 0.5, "gray", 0), ("SHARP_EDGE", 2, "gray", 1), ("DIAGONAL", 0, "gray", 0), ("WINDOW", 2, "gear", 1),
    ("SMALLEST_WIDE", 2, "disc 10", 0), ("SLIGHT", 4, "tiny", 3),
    ("FEWEST", 8, "walls", 0),
    ("MISFIT", 0.5, "blob", 1), ("MOST_OFFSET", 2, "gear", 0), ("RING", 0.5, "ring", 0), ("ROOM_TO_EVEN", 0.5, "gear", 0),
    ("LEAST_ANGLE", 1.42, "grains", 0), ("GAP", 2, "specks", 0), ("LEANS", 0, "gears", 0), ("ENOUGH", 1.053, "gears", 0),
    ("SLIDE", 0.5, "slid", 1), ("STRAIGHT", 0.5, "slid", 1), ("EMPTY", 2, "sized", 0), ("OPPOSITE", 2, "sized", 0),
    ("EVERY", 2, "sized", 0), ("BESIDE", 0.5, "sized", 1), ("PASSES", 0.5, "sized", 2),
    # Where regions meet, chords are few or pixels many: tiny maps, small grains, discs in few chords.
    ("SHORTEST_CHORD", 0.5, "oblong", 1), ("SNAPPED_SLACK", 0, "tiny", 2), ("FADE", 0, "specks", 1), ("FREE_ENDS", 0.5, "tiny", 3),
    ("SHORTEST_WIDE", 0.5, "tiny", 3), ("NODE_WEIGHT", 2, "gear", 1), ("LACKING_AREA", 0.1, "wide", 0), ("GREAT", 2, "long", 1),
    ("SAME_CROSSINGS", 0, "polygons", 0), ("SMALL_REGION", 2, "tiny", 2), ("SHRINKINGS", 0, "sized", 0), ("ON_LINE", 0, "squares", 0),
    ("AMID", 8, "cells", 0), ("LEAST_WEDGE", 0.5, "tiny", 3), ("SHORTEST_PART", 2, "specks", 1), ("LONG", 0.9, "nearly", 0),
    ("SHORT", 0.5, "wide", 0), ("STILL_OFF", 2, "long", 1), ("AREA_ERROR", 10, "gear", 3), ("RESPACINGS", 0.5, "specks", 1),
    ("EXCHANGE_ROUNDS", 0, "tiny", 2), ("MOST_AREA_ROUNDS", 0.5, "oblong", 2), ("EXCHANGES", 0, "tiny", 2),
    ("MOST_EXCHANGED", 0, "tiny", 2), ("LEAST_ROOM", 0, "wide", 1), ("SMALLER", 2, "tiny", 2),
    ("STRANGE", 2, "colours", 0), ("LASTING", 0.5, "gears", 0), ("FOR_ALL", 0, "wide", 0),
    ("LEAST_STEP", 2, "disc 60", 0), ("ARC_BLUR", 2, "blob", 1),
    ("SHORTEST_NARROW", 2, "tiny", 3),
    ("MOST_SHIFT", 0.5, "checkers", 0), ("BLUNT", 0, "checkers", 0), ("INNER", 0.5, "oblong", 1), ("UNSURE", 0, "wide", 1),
    ("BASE", 0.5, "disc 60", 0), ("WEDGE", 1.4, "crystal", 0), ("OFFSETS", 0.25, "walls", 0), ("FARTHEST_LINE", 5, "walls", 0),
    ("JUNCTIONS_APART", 0, "crystal", 0), ("PLENTY", 100, "crystal", 1),
]  # fmt: skip


@cache
def measured(group):
    dense.cache_clear()
    return GROUPS[group]()


@pytest.mark.parametrize("group", GROUPS)
def test_what_was_reached_is_kept(group):
    found = measured(group)
    assert all(value <= most for value, most in zip(found, REACHED[group], strict=False)), found


@pytest.mark.parametrize(("constant", "factor", "group", "measure"), MATTERS, ids=[name for name, *_ in MATTERS])
def test_a_constant_matters(constant, factor, group, measure, monkeypatch):
    before = measured(group)[measure]
    change(monkeypatch, constant, factor)
    dense.cache_clear()
    try:
        assert GROUPS[group]()[measure] > 1.035 * before
    finally:
        dense.cache_clear()
